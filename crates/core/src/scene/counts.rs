use glam::DVec3;

use super::Scene;

/// The size of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Vertices of the mesh that a face uses.
    pub vertices: usize,
    /// Polygons.
    pub faces: usize,
    /// Triangles the polygons were cut into.
    pub triangles: usize,
    /// Triangles of no area among them.
    pub zero_area: usize,
    /// Spheres.
    pub spheres: usize,
}

impl Scene {
    /// Counts what the scene is made of.
    pub fn counts(&self) -> Counts {
        let mesh = &self.mesh;
        Counts {
            vertices: mesh.positions.len(),
            faces: mesh.faces.len(),
            triangles: mesh.triangles.len(),
            zero_area: (0..mesh.triangles.len()).filter(|&i| is_zero_area(mesh.corners(i))).count(),
            spheres: self.spheres.len(),
        }
    }
}

/// Whether a triangle's corners are on one line, up to the rounding of their coordinates.
pub(super) fn is_zero_area([a, b, c]: [DVec3; 3]) -> bool {
    let (u, v) = (b - a, c - a);
    u.cross(v).length() <= 4.0 * f64::EPSILON * u.length() * v.length()
}
