//! Models with a published recipe and a level of detail: shapes whose number of primitives grows by a
//! known factor, for testing and comparing indexes.
//!
//! The sphere flake, the tetrahedral pyramid and the gears follow Haines, *A Proposal for Standard
//! Graphics Environments*, IEEE CG&A 7(11), 1987, in arrangements of our own.

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_3, FRAC_PI_4, TAU};

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::geometry::{Sphere, triangulate};
use crate::scene::{MaterialId, Mesh, SphereObject};

/// A closed sphere of radius 1 around the origin: an icosahedron whose faces are split in four `level`
/// times, 20 · 4^level triangles.
pub fn icosphere(level: u32) -> Mesh {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut positions = Vec::new();
    for (a, b) in [(-1.0, -golden), (1.0, -golden), (-1.0, golden), (1.0, golden)] {
        positions.push(DVec3::new(0.0, a, b));
        positions.push(DVec3::new(a, b, 0.0));
        positions.push(DVec3::new(b, 0.0, a));
    }
    for p in &mut positions {
        *p = p.normalize();
    }
    // The faces are the triples at mutual edge distance, turned outwards.
    let edge = 4.0 / (1.0 + golden * golden);
    let joined =
        |i: usize, j: usize| (positions[i].distance_squared(positions[j]) - edge).abs() < 1e-9;
    let mut triangles = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if joined(i, j) && joined(j, k) && joined(i, k) {
                    let [a, b, c] = [positions[i], positions[j], positions[k]];
                    let outwards = (b - a).cross(c - a).dot(a) > 0.0;
                    let face = if outwards { [i, j, k] } else { [i, k, j] };
                    triangles.push(face.map(|v| v as u32));
                }
            }
        }
    }
    for _ in 0..level {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let mut mesh = Mesh { positions, ..Mesh::default() };
    for triangle in triangles {
        mesh.push_face(MaterialId(0), &[triangle]);
    }
    mesh
}

/// The cube [−1, 1]³, each of its faces one polygon of two triangles.
pub fn cube() -> Mesh {
    let corner = |k: u32| DVec3::from([k & 1, k >> 1 & 1, k >> 2].map(f64::from)) * 2.0 - 1.0;
    let mut mesh = Mesh { positions: (0..8).map(corner).collect(), ..Mesh::default() };
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    for [a, b, c, d] in quads {
        mesh.push_face(MaterialId(0), &[[a, b, c], [a, c, d]]);
    }
    mesh
}

/// A sphere of radius ½ at the origin with nine spheres of a third of its size on it, nine on each of
/// those, and so on `level` times: (9^(level+1) − 1) / 8 spheres.
pub fn sphere_flake(level: u32, material: MaterialId) -> Vec<SphereObject> {
    // Six around the equator, three around the pole; a child's own pole points away from its parent.
    let directions: Vec<DVec3> = (0..6)
        .map(|k| (f64::from(k) * FRAC_PI_3, 0.0))
        .chain((0..3).map(|k| ((2.0 * f64::from(k) + 0.5) * FRAC_PI_3, FRAC_PI_4)))
        .map(|(around, up): (f64, f64)| {
            DVec3::new(around.cos() * up.cos(), up.sin(), around.sin() * up.cos())
        })
        .collect();
    let mut spheres = Vec::new();
    let mut generation = vec![(DVec3::ZERO, 0.5, DVec3::Y)];
    for remaining in (0..=level).rev() {
        let mut next = Vec::new();
        for (center, radius, pole) in generation {
            let shape = Sphere { center, radius };
            spheres.push(SphereObject { shape, material });
            if remaining > 0 {
                let (x, z) = pole.any_orthonormal_pair();
                let turn = DMat3::from_cols(x, pole, z);
                next.extend(directions.iter().map(|&direction| {
                    let out = turn * direction;
                    (center + out * (radius * 4.0 / 3.0), radius / 3.0, out)
                }));
            }
        }
        generation = next;
    }
    spheres
}

/// A regular tetrahedron of edge 2√2 around the origin, replaced by four of half its size at its
/// corners, `level` times: 4^(level+1) triangles, all of the same size, that touch at their corners.
pub fn tetrahedra(level: u32, material: MaterialId) -> Mesh {
    let corners = [
        DVec3::new(1.0, 1.0, 1.0),
        DVec3::new(-1.0, -1.0, 1.0),
        DVec3::new(-1.0, 1.0, -1.0),
        DVec3::new(1.0, -1.0, -1.0),
    ];
    let mut centers = vec![DVec3::ZERO];
    let mut half = 1.0;
    for _ in 0..level {
        half *= 0.5;
        centers = centers.iter().flat_map(|&c| corners.map(|corner| c + half * corner)).collect();
    }
    let mut mesh = Mesh::default();
    for center in centers {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners.map(|corner| center + half * corner));
        for face in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
            mesh.push_face(material, &[face.map(|v| first + v)]);
        }
    }
    mesh
}

/// `level`³ gears of radius 1 in layers, each meshing with its neighbours: per gear two concave faces of
/// 96 corners and 96 flat sides, 380 triangles.
pub fn gears(level: u32, material: MaterialId) -> Mesh {
    const TEETH: u32 = 24;
    const THICKNESS: f64 = 0.25;
    let outline: Vec<DVec3> = (0..TEETH)
        .flat_map(|tooth| {
            // Root, flank up, tip, flank down; tips are narrower than gaps, so that gears can turn.
            [(0.00, 0.88), (0.30, 0.88), (0.40, 1.0), (0.85, 1.0)].map(|(part, radius)| {
                let angle = (f64::from(tooth) + part) / f64::from(TEETH) * TAU;
                DVec3::new(angle.cos() * radius, 0.0, angle.sin() * radius)
            })
        })
        .collect();
    let corners = outline.len() as u32;
    let mut cap = Vec::new();
    triangulate(&outline, &mut cap);

    let mut gear = Mesh::default();
    gear.positions.extend(outline.iter().map(|&p| p - DVec3::Y * (0.5 * THICKNESS)));
    gear.positions.extend(outline.iter().map(|&p| p + DVec3::Y * (0.5 * THICKNESS)));
    let turned = cap.iter().map(|&[a, b, c]| [a + corners, c + corners, b + corners]);
    gear.push_face(material, &turned.collect::<Vec<_>>());
    gear.push_face(material, &cap);
    for a in 0..corners {
        let b = (a + 1) % corners;
        gear.push_face(material, &[[a, a + corners, b + corners], [a, b + corners, b]]);
    }

    let mut mesh = Mesh::default();
    let middle = 0.5 * f64::from(level.saturating_sub(1));
    for k in 0..level.pow(3) {
        let cell = [k % level, k / level % level, k / level.pow(2)].map(f64::from);
        let center = (DVec3::from(cell) - middle) * DVec3::new(1.9, 0.6, 1.9);
        // Every second gear is turned by half a tooth, so that teeth meet gaps.
        let odd = (cell[0] + cell[2]) % 2.0;
        let turn = DQuat::from_rotation_y(odd * TAU / f64::from(2 * TEETH));
        mesh.append(&gear, DAffine3::from_rotation_translation(turn, center), 0);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six times the volume enclosed by a closed mesh whose faces point outwards.
    fn six_volumes(mesh: &Mesh) -> f64 {
        (0..mesh.triangles.len())
            .map(|i| {
                let [a, b, c] = mesh.corners(i);
                a.dot(b.cross(c))
            })
            .sum()
    }

    fn is_closed(mesh: &Mesh) -> bool {
        let edges: std::collections::HashSet<(u32, u32)> = mesh
            .triangles
            .iter()
            .flat_map(|t| {
                let [a, b, c] = t.vertices;
                [(a, b), (b, c), (c, a)]
            })
            .collect();
        edges.len() == 3 * mesh.triangles.len()
            && edges.iter().all(|&(a, b)| edges.contains(&(b, a)))
    }

    #[test]
    fn icospheres_are_closed_and_approach_the_sphere() {
        for level in 0..5 {
            let mesh = icosphere(level);
            assert_eq!(mesh.triangles.len(), 20 * 4usize.pow(level));
            assert!(is_closed(&mesh));
        }
        // An inscribed mesh lacks volume of the order of the squared edge length.
        let lack = 1.0 - six_volumes(&icosphere(4)) / (8.0 * std::f64::consts::PI);
        assert!(lack > 0.0 && lack < 5e-3, "{lack}");
    }

    #[test]
    fn a_cube_is_closed_and_faces_outwards() {
        assert!(is_closed(&cube()) && cube().faces.len() == 6);
        assert_eq!(six_volumes(&cube()), 6.0 * 8.0);
    }

    #[test]
    fn a_flake_has_the_published_number_of_spheres_that_touch_their_parent() {
        assert_eq!([0, 1, 2, 3].map(|l| sphere_flake(l, MaterialId(0)).len()), [1, 10, 91, 820]);
        let flake = sphere_flake(1, MaterialId(0));
        for child in &flake[1..] {
            let gap = child.shape.center.length() - child.shape.radius - flake[0].shape.radius;
            assert!(gap.abs() < 1e-15, "{gap}");
        }
    }

    #[test]
    fn tetrahedra_fill_half_of_the_volume_per_level() {
        // The cube [-1, 1]³ holds a regular tetrahedron of a third of its volume.
        for level in 0..5 {
            let mesh = tetrahedra(level, MaterialId(0));
            assert_eq!(mesh.triangles.len(), 4usize.pow(level + 1));
            assert!(is_closed(&mesh));
            let volume = six_volumes(&mesh) / 6.0;
            assert!((volume - 8.0 / 3.0 * 0.5_f64.powi(level as i32)).abs() < 1e-12);
        }
    }

    #[test]
    fn gears_are_closed_and_keep_their_faces() {
        for level in 1..4 {
            let mesh = gears(level, MaterialId(0));
            let count = level.pow(3) as usize;
            assert_eq!((mesh.faces.len(), mesh.triangles.len()), (98 * count, 380 * count));
            assert!(is_closed(&mesh));
            assert!(six_volumes(&mesh) > 0.0);
        }
        // A tooth spans 15 degrees: four triangles from the axis, of radii (.88, .88), (.88, 1), (1, 1), (1, .88).
        let sine = |part: f64| (part / 24.0 * TAU).sin();
        let area =
            12.0 * (0.88 * 0.88 * sine(0.30) + 0.88 * sine(0.10) + sine(0.45) + 0.88 * sine(0.15));
        assert!((six_volumes(&gears(1, MaterialId(0))) / 6.0 - 0.25 * area).abs() < 1e-12);
    }
}
