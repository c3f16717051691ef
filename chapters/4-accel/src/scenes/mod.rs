//! Scenes of any number of triangles: of the kinds that tell structures apart, and buildings.

mod atrium;
mod kitchen;
mod shapes;

use anyhow::{Context, Result};
use glam::{DAffine3, DVec3};
use lancer_core::Rgb;
use lancer_core::sampling::Uniform;
use lancer_core::scene::load::{Loaded, UNNAMED};
use lancer_core::scene::{Camera, MaterialId, Mesh, PointLight, Scene};
use lancer_lesson::scenes::{NamedScene, Source};

pub use shapes::teapot;
use shapes::{push_quad, surface};

/// A kind of scene.
#[derive(Clone, Copy)]
pub struct Family {
    /// Its name in figures, benches and on the command line.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// How many triangles it has unless another number is asked for.
    pub usual: u32,
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
    /// The same in a room, with a wider angle.
    Within(DVec3, DVec3),
}

/// The kinds that tell structures apart.
pub const FAMILIES: [Family; 4] = [
    Family {
        name: "soup",
        about: "small triangles, evenly spread over a cube",
        usual: 10_000,
        mesh: soup,
        view: View::Framed,
    },
    Family {
        name: "scan",
        about: "a bumpy closed surface",
        usual: 10_000,
        mesh: scan,
        view: View::Framed,
    },
    Family {
        name: "town",
        about: "houses of all heights in a grid of streets: faces across the axes",
        usual: 10_000,
        mesh: town,
        view: View::From(DVec3::new(0.15, 0.4, 1.35), DVec3::new(0.5, 0.02, 0.5)),
    },
    Family {
        name: "stadium",
        about: "a teapot with most of the triangles, in the middle of a stadium a thousand times as large",
        usual: 10_000,
        mesh: stadium,
        view: View::From(DVec3::new(6e-4, 1.4e-3, 2.6e-3), DVec3::new(1e-4, 5e-4, 0.0)),
    },
];

/// Buildings seen from within: long thin triangles, and dense detail in large empty rooms. No plate shows them;
/// trees are built, and judged, by them.
pub const BUILDINGS: [Family; 2] = [
    Family {
        name: "kitchen",
        about: "a furnished kitchen",
        usual: 57_000,
        mesh: kitchen::kitchen,
        view: View::Within(kitchen::EYE, kitchen::LOOK_AT),
    },
    Family {
        name: "atrium",
        about: "a hall of two storeys between colonnades",
        usual: 66_000,
        mesh: atrium::atrium,
        view: View::Within(atrium::EYE, atrium::LOOK_AT),
    },
];

/// The kind of that name.
///
/// # Panics
/// If there is none.
pub fn family(name: &str) -> Family {
    let found = FAMILIES.into_iter().chain(BUILDINGS).find(|family| family.name == name);
    found.unwrap_or_else(|| panic!("no kind of scene is called {name:?}"))
}

/// All kinds as scenes of the course.
pub const SCENES: [NamedScene; 6] = [
    named("soup"),
    named("scan"),
    named("town"),
    named("stadium"),
    named("kitchen"),
    named("atrium"),
];

const fn named(name: &'static str) -> NamedScene {
    let variants = "a number of triangles, such as stadium:100000";
    NamedScene { name, source: Source::Generated { variants, make: sized } }
}

/// The scene of that kind, with about `count` triangles.
fn sized(name: &str, count: Option<&str>) -> Result<Loaded> {
    let family = family(name);
    let count = count.map_or(Some(family.usual), |text| {
        text.parse().ok().filter(|count| (100..=10_000_000).contains(count))
    });
    let count = count
        .with_context(|| format!("{name}: the number of triangles is one from 100 to 10000000"))?;
    let scene = family.scene(count);
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
            View::Within(eye, look_at) => Camera { eye, look_at, fov: 62.0, ..scene.camera },
        };
        scene.lights.push(PointLight::beside(&scene.camera));
        scene.ambient = Rgb::splat(0.25);
        scene
    }
}

/// A mesh of about `count` triangles, whose curved parts are cut the finer the larger `detail` is.
fn refined(count: u32, mesh: impl Fn(f64) -> Mesh) -> Mesh {
    let mut detail = 1.0;
    for _ in 0..6 {
        let mesh = mesh(detail);
        let growth = f64::from(count) / mesh.triangles.len() as f64;
        if (0.98..1.02).contains(&growth) {
            return mesh;
        }
        // Both ways of a surface are cut finer; what is flat is not, so that a step is too short at worst.
        detail = (detail * growth.sqrt()).max(0.05);
    }
    mesh(detail)
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

#[cfg(test)]
mod tests {
    use lancer_accel::Wide;
    use lancer_accel::structures::STRUCTURES;
    use lancer_core::geometry::{Interval, Ray};
    use lancer_core::intersector::Intersector;

    use super::*;

    #[test]
    fn every_kind_is_a_scene_of_the_course() {
        let families = FAMILIES.iter().chain(&BUILDINGS).map(|family| family.name);
        assert!(SCENES.iter().map(|scene| scene.name).eq(families));
        for scene in SCENES {
            assert!(scene.open(Some("300")).is_ok() && scene.open(Some("99")).is_err());
        }
    }

    #[test]
    fn scenes_have_about_as_many_triangles_as_asked_for() {
        // A building has its walls and furniture in any case.
        let cases = FAMILIES.map(|family| (family, 300)).into_iter();
        for (family, least) in cases.chain(BUILDINGS.map(|family| (family, 20_000))) {
            for count in [least, family.usual, 100_000] {
                let scene = family.scene(count);
                let ratio = scene.mesh.triangles.len() as f64 / f64::from(count);
                assert!((0.8..1.25).contains(&ratio), "{} {count}: {ratio}", family.name);
                assert!(scene.camera.check().is_ok());
            }
        }
    }

    #[test]
    fn buildings_are_closed_around_the_eye() {
        for family in BUILDINGS {
            let scene = family.scene(20_000);
            let index = Wide::build(&scene);
            let mut random = Uniform::new(11, 0, 0);
            for _ in 0..100_000 {
                let ray = Ray::new(scene.camera.eye, random.direction());
                let hit = index.closest_hit(&ray, Interval::POSITIVE);
                assert!(hit.is_some(), "{}: {ray:?}", family.name);
            }
        }
    }

    /// What distinguishes them from scans: sizes over four decades, and a tenth of the triangles ten times as long as
    /// they are high, or more.
    #[test]
    fn triangles_of_buildings_are_long_and_of_all_sizes() {
        for family in BUILDINGS {
            let scene = family.scene(family.usual);
            let size = scene.bounding_sphere().expect("triangles").radius;
            let triangles = scene.mesh.triangles.len();
            let (mut decades, mut long) = ([0; 4], 0);
            for [a, b, c] in (0..triangles).map(|k| scene.mesh.corners(k)) {
                let longest =
                    [b - a, c - b, a - c].map(DVec3::length).into_iter().fold(0.0, f64::max);
                let height = (b - a).cross(c - a).length() / longest;
                decades[(-(longest / size).log10()).clamp(0.0, 3.0) as usize] += 1;
                long += usize::from(longest > 10.0 * height);
            }
            let shares = decades.map(|count| f64::from(count) / triangles as f64);
            assert!(shares.iter().all(|share| *share > 1e-3), "{}: {shares:?}", family.name);
            assert!(10 * long > triangles, "{}: {long} of {triangles}", family.name);
        }
    }

    /// What is said of an index's memory is what the worst kind of scene takes but for buildings, within a quarter.
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
