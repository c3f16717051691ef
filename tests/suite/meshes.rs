//! Closed meshes around the origin, and rays aimed at what their triangles share.

use glam::{DAffine3, DVec3};
use lancer_core::generate::{cube, icosphere};
use lancer_core::geometry::Ray;
use lancer_core::scene::{MaterialId, Mesh};

use crate::random::Random;

/// Where f64 still resolves 1e-10, and Embree's own far offset.
pub const OFFSETS: [DVec3; 3] =
    [DVec3::ZERO, DVec3::new(148376.0, 1234.0, -223423.0), DVec3::new(1e6, 1e6, 1e6)];

pub fn moved(mesh: &Mesh, offset: DVec3) -> Mesh {
    let mut result = Mesh::default();
    result.append(mesh, DAffine3::from_translation(offset), 0);
    result
}

/// The closed meshes of the watertight promise, all around the origin.
pub fn closed_meshes() -> Vec<(&'static str, Mesh)> {
    vec![
        ("icosphere", icosphere(4)),
        ("spiky", spiky(16)),
        ("slivers", prism(2000)),
        ("cube", cube()),
    ]
}

fn from_triangles(positions: Vec<DVec3>, triangles: &[[u32; 3]]) -> Mesh {
    let mut mesh = Mesh { positions, ..Mesh::default() };
    for &triangle in triangles {
        mesh.push_face(MaterialId(0), &[triangle]);
    }
    mesh
}

/// A sphere of n rows and columns whose radii jump between 1 and 6 (the shape of pbrt's test).
pub fn spiky(n: u32) -> Mesh {
    let mut random = Random::new(5);
    let mut positions = vec![DVec3::Y * 3.0, DVec3::NEG_Y * 3.0];
    for row in 1..n {
        for column in 0..n {
            let (theta, phi) = (
                std::f64::consts::PI * f64::from(row) / f64::from(n),
                std::f64::consts::TAU * f64::from(column) / f64::from(n),
            );
            let radius = random.between(1.0, 6.0);
            let (sin, cos) = theta.sin_cos();
            positions.push(radius * DVec3::new(sin * phi.cos(), cos, sin * phi.sin()));
        }
    }
    let at = |row: u32, column: u32| 2 + (row - 1) * n + column % n;
    let mut triangles = Vec::new();
    for column in 0..n {
        triangles.push([0, at(1, column + 1), at(1, column)]);
        triangles.push([1, at(n - 1, column), at(n - 1, column + 1)]);
        for row in 1..n - 1 {
            let [a, b] = [at(row, column), at(row, column + 1)];
            let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    from_triangles(positions, &triangles)
}

/// A tall prism with n sides: 4 n triangles, the walls and the caps' fans all slivers.
fn prism(n: u32) -> Mesh {
    let mut positions = vec![DVec3::Y * 3.0, DVec3::NEG_Y * 3.0];
    for k in 0..n {
        let phi = std::f64::consts::TAU * f64::from(k) / f64::from(n);
        for y in [3.0, -3.0] {
            positions.push(DVec3::new(phi.cos(), y, phi.sin()));
        }
    }
    let top = |k: u32| 2 + 2 * (k % n);
    let mut triangles = Vec::new();
    for k in 0..n {
        let (a, b) = (top(k), top(k + 1));
        triangles.extend([[0, b, a], [1, a + 1, b + 1], [a, b, b + 1], [a, b + 1, a + 1]]);
    }
    from_triangles(positions, &triangles)
}

/// What a ray is aimed at.
#[derive(Clone, Copy, Debug)]
pub enum Target {
    Vertex,
    Edge,
}

/// A ray from around the middle of the mesh, at `offset`, towards something that triangles share.
pub fn aimed_ray(mesh: &Mesh, offset: DVec3, target: Target, random: &mut Random) -> Ray {
    let [a, b, _] = mesh.corners(random.below(mesh.triangles.len()));
    let point = match target {
        Target::Vertex => a,
        Target::Edge => a + random.unit() * (b - a),
    };
    let origin = offset + random.in_cube(0.3);
    Ray::new(origin, point - origin)
}
