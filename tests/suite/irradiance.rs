//! What lamps send to a receiver, against closed forms: mean and spread of every way to draw it, and what each of the
//! usual slips makes of them.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::{DMat3, DVec3};
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::intersector::{Intersector, LinearScan};
use lancer_core::method::Strategy;
use lancer_core::sampling::{
    Estimate, Patch, PixelSampling, Sample, Uniform, cosine_hemisphere_density,
};
use lancer_core::scene::{Material, MaterialId, Mesh, Scene};
use lancer_core::world::World;
use lancer_distributed::{Distributed, PathSettings, PathTracer, RayCounts, Settings};

use crate::statistics::{Z, agrees, independent, replicated};

/// A rectangular lamp of radiance 1 over a receiver at the origin.
struct Case {
    name: &'static str,
    /// The receiver's normal.
    n: DVec3,
    /// A corner and the two edges from it; the lamp shines along their product.
    lamp: [DVec3; 3],
    /// The irradiance, by Lambert's polygon cut at the horizon.
    irradiance: f64,
    /// The exact relative standard deviations of one sample: of the lamp by area, of the lamp by solid angle, of the
    /// hemisphere by its cosine.
    spread: [f64; 3],
}

/// A level square or rectangle that shines down, by its centre and sides.
fn level(center: DVec3, x: f64, y: f64) -> [DVec3; 3] {
    let (across, along) = (x * DVec3::X, y * DVec3::Y);
    [center - 0.5 * (across + along), along, across]
}

fn tilted(degrees: f64) -> DVec3 {
    DMat3::from_rotation_y(degrees.to_radians()) * DVec3::Z
}

/// The lamp of the Cornell box as seen from `receiver`, whose normal is `n`.
fn cornell(receiver: DVec3) -> [DVec3; 3] {
    [DVec3::new(-0.23, 0.99, -0.18) - receiver, 0.46 * DVec3::X, 0.38 * DVec3::Z]
}

fn cases() -> Vec<Case> {
    let z = DVec3::Z;
    let square = level(z, 1.0, 1.0);
    let wall = [DVec3::new(1.0, -0.5, -1.0), 2.0 * DVec3::Z, DVec3::Y];
    let case = |name, n, lamp, irradiance, spread| Case { name, n, lamp, irradiance, spread };
    let at = DVec3::new;
    vec![
        case("R1", z, square, 0.752274688454107, [0.174225, 0.0432797, 1.78217]),
        case("R2", tilted(30.0), square, 0.651488990825281, [0.230177, 0.161081, 1.95504]),
        case("R3", tilted(60.0), square, 0.376137344227054, [0.483733, 0.467481, 2.7115]),
        case("R4", tilted(80.0), square, 0.164592344981967, [0.92583, 0.95312, 4.25287]),
        case("R5", tilted(110.0), square, 0.00527400279461842, [2.935, 3.206, 24.38]),
        case(
            "R6",
            z,
            level(at(1.5, 0.0, 1.0), 1.0, 1.0),
            0.104637075190907,
            [0.518085, 0.123277, 5.38737],
        ),
        case("R7", z, level(0.1 * z, 2.0, 2.0), 3.11610061840345, [6.49142, 0.482509, 0.0904475]),
        case(
            "R8",
            z,
            level(at(0.3, 0.2, 1.0), 0.01, 0.01),
            7.83131555006401e-5,
            [0.0036843, 0.00092107, 200.3],
        ),
        case(
            "R9",
            z,
            level(at(0.0, 1.0, 1.0), 4.0, 0.1),
            0.0504944903005609,
            [0.598689, 0.138331, 7.8241],
        ),
        case("R10", z, wall, 0.223346625828318, [1.126, 1.291, 3.6146]),
        case(
            "C1",
            DVec3::Y,
            cornell(at(0.0, -1.0, 0.01)),
            0.0434892920927439,
            [0.0095397, 0.0023849, 8.440],
        ),
        case(
            "C2",
            DVec3::Y,
            cornell(at(0.8, -1.0, 0.8)),
            0.0252840005847290,
            [0.104461, 0.0260557, 11.10],
        ),
        case(
            "C3",
            z,
            cornell(at(0.0, 0.5, -1.0)),
            0.0548115816120914,
            [0.239758, 0.0239057, 7.504],
        ),
        case(
            "C4",
            DVec3::X,
            cornell(at(-1.0, 0.9, 0.01)),
            0.0167476822193879,
            [0.39918, 0.0068556, 13.66],
        ),
        case(
            "C5",
            DVec3::X,
            cornell(at(-1.0, -0.5, 0.5)),
            0.0213844007834744,
            [0.065619, 0.097479, 12.08],
        ),
    ]
}

/// Whether the receiver samples the lamp by area: its farthest point is at most 1.3 times as far as its nearest.
fn is_seen_evenly(case: &Case) -> bool {
    let [corner, first, second] = case.lamp;
    let foot = |edge: DVec3| (-corner.dot(edge) / edge.length_squared()).clamp(0.0, 1.0) * edge;
    let nearest = (corner + foot(first) + foot(second)).length();
    let corners = [corner, corner + first, corner + second, corner + first + second];
    let farthest = corners.map(DVec3::length).into_iter().fold(0.0, f64::max);
    farthest <= 1.3 * nearest
}

fn quad(mesh: &mut Mesh, material: u32, [corner, first, second]: [DVec3; 3]) {
    let k = mesh.positions.len() as u32;
    mesh.positions.extend([corner, corner + first, corner + first + second, corner + second]);
    mesh.push_face(MaterialId(material), &[[k, k + 1, k + 2], [k, k + 2, k + 3]]);
}

/// A white receiver, too small to be in anybody's way, and the lamp.
fn scene(case: &Case) -> Scene {
    let mut scene = Scene::of_mesh(Mesh::default());
    let (x, y) = case.n.any_orthonormal_pair();
    let side = 1e-4;
    quad(&mut scene.mesh, 0, [-0.5 * side * (x + y), side * x, side * y]);
    quad(&mut scene.mesh, 1, case.lamp);
    scene.materials = vec![
        Material::matte(Rgb::ONE),
        Material { emission: Rgb::ONE, ..Material::matte(Rgb::ZERO) },
    ];
    scene
}

/// How the light is found.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Distributed,
    Path(Strategy),
}

/// The irradiance of the receiver by one sample: π times the radiance of the white surface.
fn with_estimator<T>(case: &Case, way: Way, run: impl Fn(&dyn Fn(&Sample) -> f64) -> T) -> T {
    let scene = scene(case);
    let index = LinearScan::new(&scene);
    let world = World { scene: &scene, index: &index };
    let (side, _) = case.n.any_orthonormal_pair();
    let ray = Ray::new(1e-3 * (case.n + 0.5 * side), -(case.n + 0.5 * side).normalize());
    let hit = index.closest_hit(&ray, Interval::POSITIVE);
    let rays = || RayCounts::default();
    match way {
        Way::Distributed => {
            let method = Distributed::new(world, Settings::default());
            run(&|sample| PI * method.shade(&ray, hit, None, sample, &mut rays()).x)
        }
        Way::Path(strategy) => {
            let settings = PathSettings { max_depth: Some(0), strategy, ..PathSettings::default() };
            let method = PathTracer::new(world, settings);
            run(&|sample| PI * method.shade(&ray, hit, None, sample, &mut rays()).x)
        }
    }
}

/// algo:distributed and algo:path, by each strategy, from 64 scramblings of 256 samples. A hemisphere that rarely meets the
/// lamp is not asked: its means are far from normal.
#[test]
fn means_are_the_closed_forms() {
    let paths = [Strategy::Lamp, Strategy::Lobe, Strategy::Mis].map(Way::Path);
    for case in cases() {
        for way in [&[Way::Distributed], &paths[..]].concat() {
            if way == Way::Path(Strategy::Lobe) && case.spread[2] > 9.0 {
                continue;
            }
            let estimate = with_estimator(&case, way, |f| replicated(256, 7, f));
            let truth = case.irradiance;
            assert!(agrees(&estimate, truth), "{} {way:?}: {estimate:?}, {truth}", case.name);
        }
    }
}

/// The standard deviation of one sample, from 40 000 independent ones, within what its own kurtosis allows.
#[test]
fn spreads_are_the_closed_forms() {
    for case in cases() {
        let [area, angle, cosine] = case.spread;
        let lamp = if is_seen_evenly(&case) { area } else { angle };
        for (way, spread) in [(Way::Distributed, lamp), (Way::Path(Strategy::Lobe), cosine)] {
            if spread > 4.0 {
                continue;
            }
            let (estimate, kurtosis) = with_estimator(&case, way, |f| {
                let estimate = independent(40_000, 5, f);
                let deviation = estimate.variance().sqrt();
                let fourth = |sample: &Sample| ((f(sample) - estimate.mean()) / deviation).powi(4);
                (estimate, independent(40_000, 5, fourth).mean())
            });
            let ratio = estimate.variance() / (spread * case.irradiance).powi(2);
            let bound = Z * ((kurtosis - 1.0) / 40_000.0).sqrt();
            // The table has five digits.
            let name = case.name;
            assert!((ratio - 1.0).abs() < bound + 1e-4, "{name} {way:?}: {ratio}, {bound}");
        }
    }
}

/// A lamp does not light itself, nor what lies beside it in its plane, whose points are before it or behind it by chance
/// of rounding: seen from 1e-17 before it a lamp would fill half of all directions.
#[test]
fn what_is_in_the_plane_of_a_lamp_is_not_lit() {
    let turn = DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(1.1);
    let at = |x, y| turn * DVec3::new(x, y, 0.3);
    let mut scene = Scene::of_mesh(Mesh::default());
    quad(&mut scene.mesh, 1, [at(-1.0, -1.0), turn * (2.0 * DVec3::X), turn * (2.0 * DVec3::Y)]);
    quad(&mut scene.mesh, 0, [at(1.0, -1.0), turn * (2.0 * DVec3::X), turn * (2.0 * DVec3::Y)]);
    scene.materials = vec![
        Material::matte(Rgb::ONE),
        Material { emission: Rgb::splat(5.0), ..Material::matte(Rgb::ONE) },
    ];
    let index = LinearScan::new(&scene);
    let world = World { scene: &scene, index: &index };
    let distributed = Distributed::new(world, Settings::default());
    let path = PathTracer::new(world, PathSettings::default());
    let mut random = Uniform::new(5, 6, 7);
    for _ in 0..2000 {
        let (x, y) = (4.0 * random.number() - 1.0, 2.0 * random.number() - 1.0);
        let ray = Ray::new(
            at(x, y) + turn * DVec3::new(0.3, 0.4, 1.2),
            turn * DVec3::new(-3.0, -4.0, -12.0) / 13.0,
        );
        let hit = index.closest_hit(&ray, Interval::POSITIVE);
        let emitted = if x < 1.0 { 5.0 } else { 0.0 };
        let near = |radiance: Rgb| (radiance - emitted).abs().max_element() < 1e-9;
        for sample in PixelSampling::CENTER.of_pixel(random.number().to_bits() as u32, 4) {
            let rays = &mut RayCounts::default();
            assert!(near(distributed.shade(&ray, hit, None, &sample, rays)), "{x} {y}");
            assert!(near(path.shade(&ray, hit, None, &sample, rays)), "{x} {y}");
        }
    }
}

/// A slip of beginners.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Slip {
    None,
    /// d²/A: the lamp's cosine is missing.
    NoCosine,
    /// The area of one of the lamp's two triangles.
    HalfArea,
    /// |N·ω|: light from below the horizon counts.
    BelowHorizon,
    /// |cos θ'|: the lamp shines to its back.
    BackSide,
}

/// The irradiance from points of the lamp, in the few lines of a beginner.
fn by_points(case: &Case, slip: Slip) -> Estimate {
    let [corner, first, second] = case.lamp;
    let normal = first.cross(second).normalize();
    let area = first.cross(second).length() * if slip == Slip::HalfArea { 0.5 } else { 1.0 };
    replicated(256, 7, |sample| {
        let [.., u, v] = sample.numbers(0);
        let to_light = corner + u * first + v * second;
        let direction = to_light.normalize();
        let (cos, cos_light) = (case.n.dot(direction), -normal.dot(direction));
        let cos = if slip == Slip::BelowHorizon { cos.abs() } else { cos.max(0.0) };
        let cos_light = match slip {
            Slip::NoCosine => 1.0,
            Slip::BackSide => cos_light.abs(),
            _ => cos_light.max(0.0),
        };
        cos * cos_light / to_light.length_squared() * area
    })
}

/// eq:area-light: each slip is caught where it shows, with the samples that the methods are tested with.
#[test]
fn slips_with_lamps_are_caught() {
    let mut cases = cases();
    // R1 seen from its back: nothing.
    let mut behind = cases.swap_remove(0);
    behind.lamp.swap(1, 2);
    (behind.name, behind.irradiance) = ("R1, from behind", 0.0);
    cases.push(behind);
    for (slip, name) in [
        (Slip::NoCosine, "C3"),
        (Slip::HalfArea, "R2"),
        (Slip::BelowHorizon, "R5"),
        (Slip::BackSide, "R1, from behind"),
    ] {
        let case = cases.iter().find(|case| case.name == name).unwrap();
        assert!(agrees(&by_points(case, Slip::None), case.irradiance), "{name}");
        let wrong = by_points(case, slip);
        assert!(!agrees(&wrong, case.irradiance), "{slip:?} passes for {name}: {wrong:?}");
    }
    let behind = cases.last().unwrap();
    for way in [Way::Distributed, Way::Path(Strategy::Lobe), Way::Path(Strategy::Mis)] {
        let estimate = with_estimator(behind, way, |f| replicated(16, 7, f));
        assert_eq!((estimate.mean(), estimate.variance()), (0.0, 0.0), "{way:?}");
    }
}

/// eq:cosine-hemisphere: directions drawn evenly, over the density of the cosine, give Ω / 2 instead of E, and a white
/// furnace does not see it.
#[test]
fn a_density_of_other_samples_is_caught() {
    let case = &cases()[0];
    let [corner, first, second] = case.lamp;
    let meets = |direction: DVec3| {
        let t = corner.z / direction.z;
        let (x, y) = (t * direction.x - corner.x, t * direction.y - corner.y);
        (0.0..second.x).contains(&x) && (0.0..first.y).contains(&y)
    };
    let mut random = Uniform::new(3, 1, 4);
    let mut estimates = [Estimate::default(); 3];
    for _ in 0..200_000 {
        let mut direction = random.direction();
        direction.z = direction.z.abs();
        let seen = if meets(direction) { direction.z } else { 0.0 };
        let wrong = cosine_hemisphere_density(direction.z);
        let found = [seen / (1.0 / TAU), seen / wrong, FRAC_1_PI * direction.z / wrong];
        estimates.iter_mut().zip(found).for_each(|(estimate, x)| estimate.add(x));
    }
    let [right, wrong, furnace] = estimates;
    assert!(agrees(&right, case.irradiance), "{right:?}");
    assert!(!agrees(&wrong, case.irradiance) && agrees(&wrong, 0.402715840580662), "{wrong:?}");
    assert!((furnace.mean() - 1.0).abs() < 1e-12, "{furnace:?}");
}

/// The densities that strategies weigh by are those that samples come with, up to rounding, near the lamp and far from it.
#[test]
fn a_sample_and_its_density_agree() {
    for case in cases() {
        let [corner, first, second] = case.lamp;
        let corners = [corner, corner + first, corner + first + second, corner + second];
        let [a, b, c, d] = corners;
        let patch = Patch::new([[a, b, c], [a, c, d]]).unwrap();
        let seen = patch.seen_from(DVec3::ZERO);
        let normal = first.cross(second).normalize();
        let mut random = Uniform::new(1, 2, 3);
        for _ in 0..100 {
            let Some(sample) = seen.sample([random.number(), random.number()]) else { continue };
            let density = seen.density(sample.position, normal);
            assert!((density / sample.density - 1.0).abs() < 1e-12, "{}", case.name);
        }
    }
}
