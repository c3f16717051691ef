//! Scenes of any number of triangles, and of the kinds that tell structures apart.

use anyhow::{Context, Result};
use glam::{DAffine3, DMat3, DVec2, DVec3};
use lancer_core::Rgb;
use lancer_core::sampling::Uniform;
use lancer_core::scene::load::{Loaded, UNNAMED};
use lancer_core::scene::{Camera, MaterialId, Mesh, PointLight, Scene};
use lancer_lesson::scenes::{NamedScene, Source};

/// A kind of scene.
#[derive(Clone, Copy)]
pub struct Family {
    /// Its name in figures, benches and on the command line.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// A mesh of about that many triangles.
    pub mesh: fn(u32) -> Mesh,
    /// From where it is seen: the direction to the eye, and whether the eye is inside.
    view: View,
}

#[derive(Clone, Copy)]
enum View {
    /// From outside, the whole of it.
    Framed,
    /// From a point, towards another.
    From(DVec3, DVec3),
}

/// All kinds.
pub const FAMILIES: [Family; 4] = [
    Family {
        name: "soup",
        about: "small triangles, evenly spread over a cube",
        mesh: soup,
        view: View::Framed,
    },
    Family { name: "scan", about: "a bumpy closed surface", mesh: scan, view: View::Framed },
    Family {
        name: "town",
        about: "houses of all heights in a grid of streets: faces across the axes",
        mesh: town,
        view: View::From(DVec3::new(0.15, 0.4, 1.35), DVec3::new(0.5, 0.02, 0.5)),
    },
    Family {
        name: "stadium",
        about: "a teapot with most of the triangles, in the middle of a stadium a thousand times as large",
        mesh: stadium,
        view: View::From(DVec3::new(6e-4, 1.4e-3, 2.6e-3), DVec3::new(1e-4, 5e-4, 0.0)),
    },
];

/// The kind of that name.
///
/// # Panics
/// If there is none.
pub fn family(name: &str) -> Family {
    let found = FAMILIES.into_iter().find(|family| family.name == name);
    found.unwrap_or_else(|| panic!("no kind of scene is called {name:?}"))
}

/// All kinds as scenes of the course, of 10,000 triangles unless another number is asked for.
pub const SCENES: [NamedScene; 4] = [named("soup"), named("scan"), named("town"), named("stadium")];

const fn named(name: &'static str) -> NamedScene {
    let variants = "a number of triangles, such as stadium:100000";
    NamedScene { name, source: Source::Generated { variants, make: sized } }
}

/// The scene of that kind, with about `count` triangles.
fn sized(name: &str, count: Option<&str>) -> Result<Loaded> {
    let count = count.map_or(Some(10_000), |text| {
        text.parse().ok().filter(|count| (100..=10_000_000).contains(count))
    });
    let count = count
        .with_context(|| format!("{name}: the number of triangles is one from 100 to 10000000"))?;
    let scene = family(name).scene(count);
    let material_names = vec![UNNAMED.to_owned()];
    Ok(Loaded { scene, material_names, warnings: Vec::new(), headlight: true })
}

impl Family {
    /// The scene of about `count` triangles, seen and lit.
    pub fn scene(self, count: u32) -> Scene {
        let mut scene = Scene::of_mesh((self.mesh)(count));
        scene.camera = match self.view {
            View::Framed => Camera::framing(scene.bounding_sphere().expect("triangles")),
            View::From(eye, look_at) => Camera { eye, look_at, ..scene.camera },
        };
        scene.lights.push(PointLight::beside(&scene.camera));
        scene.ambient = Rgb::splat(0.25);
        scene
    }
}

/// Triangles evenly spread over a cube, as large as the distance to their neighbours.
fn soup(count: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let size = f64::from(count).cbrt().recip();
    for k in 0..count {
        let mut random = Uniform::new(3, k, 0);
        let mut point = || DVec3::from_array(std::array::from_fn(|_| random.number()));
        let (corner, b, c) = (point(), point() - 0.5, point() - 0.5);
        mesh.positions.extend([corner, corner + size * b, corner + size * c]);
        mesh.push_face(MaterialId(0), &[[3 * k, 3 * k + 1, 3 * k + 2]]);
    }
    mesh
}

/// A sphere with bumps of two sizes, in triangles of about the same size.
fn scan(count: u32) -> Mesh {
    let rows = (f64::from(count) / 4.0).sqrt().round().max(2.0);
    surface([2.0 * rows, rows], |turn, part| {
        let (around, down) = (turn * std::f64::consts::TAU, part * std::f64::consts::PI);
        let direction =
            DVec3::new(around.cos() * down.sin(), down.cos(), around.sin() * down.sin());
        let bump = |k: f64, p: DVec3| (k * p.x).sin() * (k * p.y).sin() * (k * p.z).sin();
        direction * (1.0 + 0.15 * bump(5.0, direction) + 0.03 * bump(23.0, direction))
    })
}

/// Houses on square plots, in rows along streets, on the unit square.
fn town(count: u32) -> Mesh {
    // Ten triangles a house, two the ground: nobody sees a floor from below.
    let side = (f64::from(count.saturating_sub(2)) / 10.0).sqrt().round().max(1.0) as u32;
    let mut mesh = Mesh::default();
    let ground = [DVec3::ZERO, DVec3::Z, DVec3::ONE - DVec3::Y, DVec3::X];
    push_quad(&mut mesh, ground);
    let plot = f64::from(side).recip();
    for k in 0..side * side {
        let mut random = Uniform::new(4, k, 0);
        let mut between = |low: f64, high: f64| low + (high - low) * random.number();
        let corner = plot * DVec3::new(f64::from(k % side), 0.0, f64::from(k / side));
        // Most houses are low.
        let height = 0.06 * between(0.3, 1.0) * between(0.2, 1.0).powi(2) + 0.3 * plot;
        let low = corner + plot * DVec3::new(between(0.1, 0.2), 0.0, between(0.1, 0.2));
        let high = corner + plot * DVec3::new(between(0.7, 0.9), 0.0, between(0.7, 0.9));
        push_house(&mut mesh, low, high + height * DVec3::Y);
    }
    mesh
}

/// Four walls and a flat roof.
fn push_house(mesh: &mut Mesh, low: DVec3, high: DVec3) {
    let at = |x: bool, y: bool, z: bool| {
        DVec3::new(
            if x { high.x } else { low.x },
            if y { high.y } else { low.y },
            if z { high.z } else { low.z },
        )
    };
    let around = [(false, false), (false, true), (true, true), (true, false)];
    for k in 0..4 {
        let ((x0, z0), (x1, z1)) = (around[k], around[(k + 1) % 4]);
        push_quad(mesh, [at(x0, false, z0), at(x1, false, z1), at(x1, true, z1), at(x0, true, z0)]);
    }
    push_quad(mesh, around.map(|(x, z)| at(x, true, z)));
}

fn push_quad(mesh: &mut Mesh, corners: [DVec3; 4]) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    let [a, b, c, d] = [first, first + 1, first + 2, first + 3];
    mesh.push_face(MaterialId(0), &[[a, b, c], [a, c, d]]);
}

/// « Théière dans un stade »: a teapot of a thousandth of the size of the stadium that it stands in.
fn stadium(count: u32) -> Mesh {
    let stands = (count / 4).max(64);
    let rows = (f64::from(stands) / 8.0).sqrt().round().max(2.0);
    // An oval bowl: a profile of seats that rises outwards in steps.
    let steps = rows.min(24.0);
    let mut mesh = surface([(4.0 * rows * rows / steps).round(), steps], |turn, part| {
        let around = turn * std::f64::consts::TAU;
        let out = 0.55 + 0.45 * part;
        DVec3::new(-0.7 * out * around.cos(), 0.25 * part * part, out * around.sin())
    });
    push_quad(
        &mut mesh,
        [(-1, -1), (-1, 1), (1, 1), (1, -1)].map(|(x, z)| DVec3::new(x.into(), 0.0, z.into())),
    );
    let pot = teapot(count.saturating_sub(mesh.triangles.len() as u32));
    mesh.append(&pot, DAffine3::from_scale(DVec3::splat(1e-3)), 0);
    mesh
}

/// A teapot as high as 1: a pot and a lid of revolution, a spout and a handle.
pub fn teapot(count: u32) -> Mesh {
    // The pot has two parts of five, lid, spout and handle one each.
    let rows = |part: f64| (f64::from(count) * part / 4.0).sqrt().round().max(2.0);
    let pot = [(0.45, 0.0), (0.62, 0.12), (0.7, 0.35), (0.6, 0.6), (0.42, 0.78)];
    let lid = [(0.44, 0.77), (0.25, 0.86), (0.06, 0.89), (0.1, 0.95), (0.0, 1.0)];
    let mut mesh = revolved(&pot, rows(0.4));
    let mut add = |part: Mesh| mesh.append(&part, DAffine3::IDENTITY, 0);
    add(revolved(&lid, rows(0.2)));
    add(tube(&[(0.6, 0.25), (0.85, 0.3), (0.9, 0.55), (1.05, 0.75)], [0.14, 0.05], rows(0.2)));
    add(tube(&[(-0.6, 0.65), (-1.05, 0.7), (-1.0, 0.3), (-0.65, 0.2)], [0.05, 0.05], rows(0.2)));
    mesh
}

/// A profile of (radius, height), turned around the vertical axis.
fn revolved(profile: &[(f64, f64)], rows: f64) -> Mesh {
    surface([2.0 * rows, rows], |turn, part| {
        let around = turn * std::f64::consts::TAU;
        let DVec2 { x: radius, y: height } = along(profile, part);
        DVec3::new(radius * around.cos(), height, radius * around.sin())
    })
}

/// A tube around a way in the plane z = 0, with its radii at both ends.
fn tube(way: &[(f64, f64)], radii: [f64; 2], rows: f64) -> Mesh {
    surface([rows, 2.0 * rows], |turn, part| {
        let around = turn * std::f64::consts::TAU;
        let ahead = (along(way, part + 1e-3) - along(way, part - 1e-3)).normalize();
        let frame = DMat3::from_cols(ahead.extend(0.0), ahead.perp().extend(0.0), DVec3::Z);
        let radius = radii[0] + (radii[1] - radii[0]) * part;
        along(way, part).extend(0.0)
            + frame * DVec3::new(0.0, radius * around.cos(), radius * around.sin())
    })
}

/// The point of a Bézier curve, `part` of the way along.
fn along(points: &[(f64, f64)], part: f64) -> DVec2 {
    let mut points: Vec<DVec2> = points.iter().map(|&point| DVec2::from(point)).collect();
    while points.len() > 1 {
        points = points.windows(2).map(|pair| pair[0].lerp(pair[1], part)).collect();
    }
    points[0]
}

/// A surface over [0, 1]², cut into `across` by `down` quadrilaterals and those into triangles; it closes
/// at the ends of its first coordinate.
fn surface([across, down]: [f64; 2], point: impl Fn(f64, f64) -> DVec3) -> Mesh {
    let (across, down) = (across.max(3.0) as u32, down.max(1.0) as u32);
    let mut mesh = Mesh::default();
    for row in 0..=down {
        for column in 0..across {
            let (turn, part) =
                (f64::from(column) / f64::from(across), f64::from(row) / f64::from(down));
            mesh.positions.push(point(turn, part));
        }
    }
    for row in 0..down {
        for column in 0..across {
            let [here, next] = [column, (column + 1) % across].map(|k| row * across + k);
            let [below, beside] = [here + across, next + across];
            mesh.push_face(MaterialId(0), &[[here, next, beside], [here, beside, below]]);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use lancer_accel::structures::STRUCTURES;

    use super::*;

    #[test]
    fn every_kind_is_a_scene_of_the_course() {
        assert_eq!(SCENES.map(|scene| scene.name), FAMILIES.map(|family| family.name));
        for scene in SCENES {
            assert!(scene.open(Some("300")).is_ok() && scene.open(Some("99")).is_err());
        }
    }

    #[test]
    fn scenes_have_about_as_many_triangles_as_asked_for() {
        for family in FAMILIES {
            for count in [300, 10_000, 100_000] {
                let scene = family.scene(count);
                let ratio = scene.mesh.triangles.len() as f64 / f64::from(count);
                assert!((0.8..1.25).contains(&ratio), "{} {count}: {ratio}", family.name);
                assert!(scene.camera.check().is_ok());
            }
        }
    }

    /// What is said of an index's memory is what the worst kind of scene takes, within a quarter.
    #[test]
    fn indexes_take_the_memory_they_are_said_to_take() {
        let scenes = FAMILIES.map(|family| family.scene(30_000));
        for structure in STRUCTURES.into_iter().filter(|structure| structure.name != "linear") {
            let parts = scenes.iter().map(|scene| {
                let expected = structure.expected_bytes(scene.primitives().len());
                structure.build(scene).bytes as f64 / expected as f64
            });
            let most = parts.fold(0.0, f64::max);
            assert!((0.75..1.25).contains(&most), "{}: {most}", structure.name);
        }
    }
}
