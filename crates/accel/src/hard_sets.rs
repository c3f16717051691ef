//! Sets on which builders recurse for ever, divide by zero or take quadratic time.

use glam::DVec3;
use lancer_core::scene::{MaterialId, Mesh, Scene};

pub(crate) fn triangles(corners: impl IntoIterator<Item = [DVec3; 3]>) -> Scene {
    let mut mesh = Mesh::default();
    for (k, corners) in (0..).step_by(3).zip(corners) {
        mesh.positions.extend(corners);
        mesh.push_face(MaterialId(0), &[[k, k + 1, k + 2]]);
    }
    Scene::of_mesh(mesh)
}

/// The sets, with `many` triangles where the number matters.
pub(crate) fn hard_sets(many: usize) -> Vec<(&'static str, Scene)> {
    let unit = [DVec3::X, DVec3::Y, DVec3::Z];
    let tiny = |k: usize| {
        let corner = DVec3::new((k % 317) as f64, (k / 317) as f64, 0.0);
        [corner, corner + 1e-3 * DVec3::X, corner + 1e-3 * DVec3::Y]
    };
    let scaled = |scale: f64| (0..1000).map(move |k| tiny(k).map(|corner| scale * corner));
    let huge = [DVec3::new(-1e9, 1e9, -1e9), DVec3::splat(1e9), DVec3::X];
    vec![
        ("none", triangles([])),
        ("one", triangles([unit])),
        ("points", triangles((0..many).map(|_| [DVec3::ONE; 3]))),
        ("identical", triangles((0..many).map(|_| unit))),
        ("coplanar", triangles((0..many).map(tiny))),
        ("extents of 1e-30", triangles(scaled(1e-30))),
        ("extents of 1e30", triangles(scaled(1e30))),
        ("one huge", triangles((0..many).map(tiny).chain([huge]))),
        // Every box contains the origin: wherever they are divided, both parts overlap.
        (
            "overlapping",
            triangles((0..many).map(|k| {
                let turn = k as f64 * 2.4;
                let out = DVec3::new(turn.cos(), turn.sin(), k as f64 / many as f64);
                [out, -out, DVec3::Z * out.z]
            })),
        ),
        // Each box is a little smaller than the one around it, and shares a corner with it.
        (
            "nested",
            triangles((0..many).map(|k| unit.map(|corner| 0.999_f64.powi(k as i32) * corner))),
        ),
    ]
}
