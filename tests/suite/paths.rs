//! algo:path against series that can be summed, to the last bounce.

use std::f64::consts::PI;

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::generate::cube;
use lancer_core::geometry::{Interval, Ray, Sphere};
use lancer_core::intersector::{Intersector, LinearScan};
use lancer_core::method::Strategy;
use lancer_core::optics::Branches;
use lancer_core::sampling::{Estimate, PixelSampling, Sample, power_heuristic};
use lancer_core::scene::{Material, MaterialId, Mesh, PointLight, Scene, SphereObject};
use lancer_core::world::World;
use lancer_distributed::{
    Light, Lights, Lobes, PathSettings, PathTracer, RayCounts, Way, roulette,
};

use crate::statistics::{agrees, grey, independent, replicated};

const STRATEGIES: [Strategy; 3] = [Strategy::Lamp, Strategy::Lobe, Strategy::Mis];

/// What `settings` estimate of what comes back along a ray.
fn with_path<T>(
    scene: &Scene,
    settings: PathSettings,
    ray: Ray,
    run: impl Fn(&dyn Fn(&Sample) -> f64) -> T,
) -> T {
    let index = LinearScan::new(scene);
    let method = PathTracer::new(World { scene, index: &index }, settings);
    let hit = index.closest_hit(&ray, Interval::POSITIVE);
    run(&|sample| grey(method.shade(&ray, hit, None, sample, &mut RayCounts::default())))
}

/// A cube seen from inside, of one matte material that emits 1.
fn furnace(rho: f64) -> Scene {
    let mut mesh = cube();
    for triangle in &mut mesh.triangles {
        triangle.vertices.swap(1, 2);
    }
    let mut scene = Scene::of_mesh(mesh);
    scene.materials[0] = Material { emission: Rgb::ONE, ..Material::matte(Rgb::splat(rho)) };
    scene
}

fn inside() -> Ray {
    Ray::new(DVec3::new(0.1, 0.2, -0.3), DVec3::new(2.0, 3.0, -6.0) / 7.0)
}

fn to_depth(max_depth: u32, strategy: Strategy) -> PathSettings {
    PathSettings { max_depth: Some(max_depth), roulette_from: u32::MAX, strategy }
}

/// The white furnace: after d bounces, and the light of lamps that comes to the last surface, 1 + ρ + … + ρ^(d+1). By lobes
/// alone each single path has it, whatever its numbers.
#[test]
fn a_furnace_has_its_series() {
    for rho in [0.5, 0.8, 0.95_f64] {
        let scene = furnace(rho);
        for depth in [0, 1, 4, 9] {
            let series = (1.0 - rho.powi(depth + 2)) / (1.0 - rho);
            for strategy in STRATEGIES {
                let settings = to_depth(depth as u32, strategy);
                let estimate = with_path(&scene, settings, inside(), |f| replicated(64, 3, f));
                assert!(
                    agrees(&estimate, series),
                    "ρ {rho}, {depth}, {strategy:?}: {estimate:?}, {series}"
                );
                let spread = estimate.standard_error();
                assert!((strategy == Strategy::Lobe) == (spread < 1e-14), "{strategy:?} {spread}");
            }
        }
    }
}

/// eq:roulette: a furnace without a last bounce has 1 / (1 − ρ), by each strategy.
#[test]
fn roulette_takes_nothing() {
    for rho in [0.5, 0.8] {
        let scene = furnace(rho);
        for strategy in STRATEGIES {
            for roulette_from in [1, 3] {
                let settings = PathSettings { max_depth: None, roulette_from, strategy };
                let estimate = with_path(&scene, settings, inside(), |f| replicated(128, 3, f));
                let truth = 1.0 / (1.0 - rho);
                assert!(agrees(&estimate, truth), "ρ {rho} {strategy:?}: {estimate:?}, {truth}");
            }
        }
    }
}

/// What becomes of the furnace's series where a beginner ends paths: the numbers decide at each bounce.
fn naive_furnace(rho: f64, slip: Slip) -> Estimate {
    independent(20_000, 9, |sample| {
        let (mut radiance, mut throughput, mut at) = (0.0, 1.0, *sample);
        for depth in 0.. {
            if slip == Slip::LastEmission && depth == 3 {
                break;
            }
            radiance += throughput;
            if slip == Slip::LastEmission || slip == Slip::NoRoulette {
                if depth == 3 {
                    break;
                }
                throughput *= rho;
                continue;
            }
            throughput *= rho;
            let [number, ..] = at.numbers(1);
            at = at.along(0);
            let survival = rho;
            if number >= survival {
                break;
            }
            match slip {
                Slip::NotDivided => (),
                Slip::OtherOdds => throughput /= 1.0 - survival,
                _ => throughput /= survival,
            }
        }
        radiance
    })
}

/// A slip of beginners.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Slip {
    None,
    /// Roulette's survivors are not divided by q.
    NotDivided,
    /// They are divided by 1 − q.
    OtherOdds,
    /// Three bounces, and all of it.
    NoRoulette,
    /// Three bounces, without what the last surface emits.
    LastEmission,
}

#[test]
fn slips_with_the_end_of_paths_are_caught() {
    let (rho, all, three) = (0.8, 5.0, 1.0 + 0.8 + 0.64 + 0.512);
    assert!(agrees(&naive_furnace(rho, Slip::None), all));
    assert!(agrees(&naive_furnace(rho, Slip::NoRoulette), three));
    // Σ ρ²ᵏ = 1 / (1 − ρ²)
    let not_divided = naive_furnace(rho, Slip::NotDivided);
    assert!(!agrees(&not_divided, all) && agrees(&not_divided, 1.0 / (1.0 - rho * rho)));
    assert!(!agrees(&naive_furnace(rho, Slip::LastEmission), three));
    let other = naive_furnace(0.3, Slip::OtherOdds);
    assert!(!agrees(&other, 1.0 / 0.7), "{other:?}");
}

/// A path survives with its throughput's strongest channel, at most with 0.95, and counts for those that do not.
#[test]
fn roulette_by_hand() {
    let grey = Rgb::splat;
    assert_eq!(roulette(Rgb::new(0.1, 0.5, 0.2), 0.499), Some(2.0));
    assert_eq!(roulette(Rgb::new(0.1, 0.5, 0.2), 0.5), None);
    assert_eq!(roulette(grey(3.0), 0.94), Some(1.0 / 0.95));
    assert_eq!(roulette(grey(3.0), 0.95), None);
    assert_eq!(roulette(Rgb::ZERO, 0.0), None);
}

/// The interior of a matte sphere around a point light: ρ directly, ρ + … + ρ^(d+1) after d bounces, on each single path;
/// with the light aside the indirect part is the same constant.
#[test]
fn a_matte_sphere_is_lit_by_itself() {
    let mut scene = Scene::of_mesh(Mesh::default());
    let shape = Sphere { center: DVec3::splat(2.0), radius: 1.0 };
    scene.spheres.push(SphereObject { shape, material: MaterialId(0) });
    scene.lights.push(PointLight { position: shape.center, intensity: Rgb::ONE });
    let ray = Ray::new(DVec3::splat(2.1), DVec3::new(2.0, 3.0, -6.0) / 7.0);
    for rho in [0.5, 0.9_f64] {
        scene.materials[0] = Material::matte(Rgb::splat(rho));
        for depth in [0, 1, 5] {
            let series = rho * (1.0 - rho.powi(depth + 1)) / (1.0 - rho);
            for strategy in STRATEGIES {
                let settings = to_depth(depth as u32, strategy);
                let estimate = with_path(&scene, settings, ray, |f| replicated(1, 3, f));
                assert!((estimate.mean() - series).abs() < 1e-12, "{estimate:?}, {series}");
                assert!(estimate.variance() < 1e-24, "{estimate:?}");
            }
        }
        let unlimited = PathSettings::default();
        let estimate = with_path(&scene, unlimited, ray, |f| replicated(256, 3, f));
        assert!(agrees(&estimate, rho / (1.0 - rho)), "{estimate:?}");
    }
}

/// Mirrors that face each other and emit 1: 1 + k + … + k^d, on each single path.
#[test]
fn a_corridor_of_mirrors_has_its_series() {
    let mut scene = furnace(0.0);
    scene.materials[0].k_s = Rgb::splat(0.9);
    let ray = Ray::new(DVec3::new(0.1, 0.2, 0.3), DVec3::X);
    for (depth, series) in [(1, 1.9), (5, 4.68559), (10, 6.8618940391), (20, 8.90581010868)] {
        for strategy in STRATEGIES {
            let settings = to_depth(depth, strategy);
            let estimate = with_path(&scene, settings, ray, |f| replicated(1, 3, f));
            assert!((estimate.mean() - series).abs() < 1e-10, "{depth}: {estimate:?}, {series}");
        }
    }
    let estimate = with_path(&scene, PathSettings::default(), ray, |f| replicated(512, 3, f));
    assert!(agrees(&estimate, 10.0), "{estimate:?}");

    // The mirror ray beyond the last surface is neither traced nor counted.
    let index = LinearScan::new(&scene);
    let world = World { scene: &scene, index: &index };
    let path = PathTracer::new(world, to_depth(5, Strategy::Mis));
    let hit = index.closest_hit(&ray, Interval::POSITIVE);
    for sample in PixelSampling::CENTER.of_pixel(0, 0) {
        let mut rays = RayCounts::default();
        path.shade(&ray, hit, None, &sample, &mut rays);
        assert_eq!(rays, RayCounts { primary: 1, mirror: 5, ..RayCounts::default() });
    }
}

/// eq:local as it stands, under a sky of radiance 1: ρ_d + 2 ρ_s / (n + 1) · H, H being the part of the lobe above the
/// horizon, where the eye is so many degrees off the normal. The naive form draws again what falls below.
#[test]
fn a_sky_shows_what_a_surface_sends_back() {
    let mut scene = Scene::of_mesh(Mesh {
        positions: vec![DVec3::new(-1.0, -1.0, 0.0), DVec3::X, DVec3::new(-1.0, 1.0, 0.0)],
        ..Mesh::default()
    });
    scene.mesh.push_face(MaterialId(0), &[[0, 1, 2]]);
    scene.background = Rgb::ONE;
    for (n, degrees, above) in [
        (1.0, 30.0_f64, 0.93301270189),
        (1.0, 80.0, 0.58682408883),
        (10.0, 60.0, 0.95906788442),
        (10.0, 80.0, 0.71476209601),
        (50.0, 80.0, 0.89315925674),
        (100.0, 80.0, 0.96030028237_f64),
    ] {
        for rho_d in [0.0, 0.3] {
            let rho_s = 0.5;
            let matte = Material::matte(Rgb::splat(rho_d));
            scene.materials[0] = Material { rho_s: Rgb::splat(rho_s), shininess: n, ..matte };
            let to_eye = DVec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
            let ray = Ray::new(DVec3::new(-0.3, 0.1, 0.0) + to_eye, -to_eye);
            let truth = rho_d + 2.0 * rho_s / (n + 1.0) * above;
            for strategy in STRATEGIES {
                let settings = to_depth(0, strategy);
                let estimate = with_path(&scene, settings, ray, |f| replicated(1024, 3, f));
                assert!(agrees(&estimate, truth), "n {n}, {degrees}°: {estimate:?}, {truth}");
                let again = rho_d + 2.0 * rho_s / (n + 1.0);
                assert!(!agrees(&estimate, again), "n {n}, {degrees}°");
            }
        }
    }
}

/// A floor that meets an infinite black wall at an angle Φ, under the sky: π (1 − cos Φ) / 2 is its irradiance.
#[test]
fn a_wall_takes_its_part_of_the_sky() {
    for (degrees, share) in [(60.0, 0.25), (90.0, 0.5), (120.0, 0.75_f64)] {
        let mut scene = Scene::of_mesh(Mesh::default());
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        for to in [DVec3::X, DVec3::new(cos, 0.0, sin)] {
            let k = scene.mesh.positions.len() as u32;
            let far = 1e7;
            scene.mesh.positions.extend([
                far * DVec3::NEG_Y,
                far * (to - DVec3::Y),
                far * (to + DVec3::Y),
                far * DVec3::Y,
            ]);
            scene.mesh.push_face(MaterialId(k / 4), &[[k, k + 1, k + 2], [k, k + 2, k + 3]]);
        }
        scene.materials = vec![Material::matte(Rgb::ONE), Material::matte(Rgb::ZERO)];
        scene.background = Rgb::ONE;
        let ray = Ray::new(DVec3::new(1.0, 0.0, 0.1), DVec3::NEG_Z);
        let settings = to_depth(0, Strategy::Mis);
        let estimate = with_path(&scene, settings, ray, |f| replicated(256, 3, f));
        assert!(agrees(&estimate, share), "{degrees}°: {estimate:?}, {share}");
    }
}

/// A glossy floor under two lamps of different powers and a point light: all strategies find the sum of `eq:local` over
/// the lamps, which a grid of 600 × 600 points on each knows to six digits.
#[test]
fn strategies_find_the_same_light() {
    let (scene, ray, truth) = two_lamps();
    for strategy in STRATEGIES {
        let samples = if strategy == Strategy::Lobe { 4096 } else { 1024 };
        let settings = to_depth(0, strategy);
        let estimate = with_path(&scene, settings, ray, |f| replicated(samples, 3, f));
        assert!(agrees(&estimate, truth), "{strategy:?}: {estimate:?}, {truth}");
        assert!(estimate.standard_error() < 0.02 * truth, "{strategy:?}: {estimate:?}");
    }
}

/// The scene, a ray to its floor, and what comes back along it.
fn two_lamps() -> (Scene, Ray, f64) {
    let mut scene = Scene::of_mesh(Mesh::default());
    let mut quad = |material, [corner, first, second]: [DVec3; 3]| {
        let k = scene.mesh.positions.len() as u32;
        let far = corner + first + second;
        scene.mesh.positions.extend([corner, corner + first, far, corner + second]);
        scene.mesh.push_face(MaterialId(material), &[[k, k + 1, k + 2], [k, k + 2, k + 3]]);
    };
    quad(0, [DVec3::new(-0.01, -0.01, 0.0), 0.02 * DVec3::X, 0.02 * DVec3::Y]);
    let lamps = [
        (4.0, [DVec3::new(-1.5, -0.4, 1.0), 0.8 * DVec3::Y, 0.8 * DVec3::X]),
        (30.0, [DVec3::new(0.9, 1.1, 1.4), 0.3 * DVec3::Y, 0.25 * DVec3::X]),
    ];
    lamps.iter().enumerate().for_each(|(k, (_, lamp))| quad(k as u32 + 1, *lamp));
    let (rho_d, rho_s, n) = (0.3, 0.6, 15.0);
    let matte = Material::matte(Rgb::splat(rho_d));
    scene.materials = vec![Material { rho_s: Rgb::splat(rho_s), shininess: n, ..matte }];
    scene.materials.extend(lamps.map(|(radiance, _)| Material {
        emission: Rgb::splat(radiance),
        ..Material::matte(Rgb::ZERO)
    }));
    let point = PointLight { position: DVec3::new(0.5, -1.0, 2.0), intensity: Rgb::splat(2.0) };
    scene.lights.push(point);
    let to_eye = DVec3::new(0.6, 0.0, 0.8);
    let reflected = |to_light: DVec3| {
        let direction = to_light.normalize();
        let mirror = 2.0 * direction.z * DVec3::Z - direction;
        rho_d * direction.z + rho_s * mirror.dot(to_eye).max(0.0).powf(n)
    };
    let steps = 600;
    let mut truth = 2.0 / point.position.length_squared() * reflected(point.position);
    for (radiance, [corner, first, second]) in lamps {
        let cell = first.cross(second).length() / f64::from(steps * steps);
        for k in 0..steps * steps {
            let (u, v) = (f64::from(k % steps) + 0.5, f64::from(k / steps) + 0.5);
            let to_light = corner + (u * first + v * second) / f64::from(steps);
            // The lamps are level: the cosine there is that of the floor's normal.
            let cos_light = to_light.normalize().z;
            let g = cos_light / to_light.length_squared();
            truth += radiance / PI * g * cell * reflected(to_light);
        }
    }
    (scene, Ray::new(to_eye, -to_eye), truth)
}

/// A slip of beginners with two strategies.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Weighing {
    Right,
    /// Where a direction meets a lamp, its density is that of a point, without the probability that the lamp is asked.
    /// (Left out at both ends the weights would still add up to 1.)
    NoChoice,
    /// The point light weighs less than 1, as if a direction could find it.
    PointLight,
    /// Emission counts for the direction that meets it, and for the lamp's sample as well.
    Twice,
}

/// One bounce on the floor of [`two_lamps`], from the pieces of algo:path.
fn two_strategies(scene: &Scene, ray: &Ray, weighing: Weighing) -> Estimate {
    let index = LinearScan::new(scene);
    let hit = index.closest_hit(ray, Interval::POSITIVE).unwrap();
    let surface = scene.surface_at(ray, &hit);
    let (n, to_eye) = (surface.shading_normal_towards(-ray.direction), -ray.direction);
    let branches = Branches::new(&surface, scene.material(surface.material), ray.direction);
    let lobes = Lobes::new(scene.reflectance(&surface), n, to_eye, branches);
    let lights = Lights::new(scene, true);
    let weight = |own, other| match weighing {
        Weighing::Twice => 1.0,
        _ => power_heuristic(own, other),
    };
    let choice = |odds| if weighing == Weighing::NoChoice { 1.0 } else { odds };
    replicated(1024, 3, |sample| {
        let ([u, v, choice_of_light, way], [a, b, ..]) = (sample.numbers(1), sample.numbers(2));
        let (light, odds) = lights.choose(|| choice_of_light).unwrap();
        let by_light = match light {
            Light::Point(source) => {
                let arriving = source.arriving(&surface);
                let drawn = lobes.density(arriving.shadow_ray.direction.normalize());
                let less = weighing == Weighing::PointLight;
                let weight = if less { power_heuristic(odds, drawn) } else { 1.0 };
                weight * lobes.unshadowed(&arriving) / odds
            }
            Light::Lamp(lamp) => {
                let point = lamp.sample(surface.position, [u, v]).unwrap();
                let arriving = lamp.arriving(&surface, &point, odds);
                let drawn = lobes.density(arriving.shadow_ray.direction.normalize());
                weight(odds * point.density, drawn) * lobes.unshadowed(&arriving)
            }
        };
        let onwards = lobes.sample(|| way, || [a, b]);
        let by_direction = onwards.map_or(Rgb::ZERO, |onwards| {
            let Way::Lobe(drawn) = onwards.way else { panic!("no mirror") };
            let ray = surface.spawn_for_light(onwards.direction);
            let Some(hit) = index.closest_hit(&ray, Interval::POSITIVE) else { return Rgb::ZERO };
            let met = scene.surface_at(&ray, &hit);
            let Some(lamp) = lights.lamps.of(scene, hit.primitive) else { return Rgb::ZERO };
            let density = lights.lamps.as_slice()[lamp].density(
                surface.position,
                met.position,
                met.geometric_normal,
            );
            let sampled = choice(lights.odds_of_lamp(lamp)) * density;
            onwards.weight * weight(drawn, sampled) * scene.emitted(&met, -ray.direction)
        });
        grey(by_light + by_direction)
    })
}

/// eq:mis: the weights of a lamp's sample and of a direction that meets it add up to 1 if both know all choices.
#[test]
fn slips_with_weights_are_caught() {
    let (scene, ray, truth) = two_lamps();
    let right = two_strategies(&scene, &ray, Weighing::Right);
    assert!(agrees(&right, truth), "{right:?}, {truth}");
    for slip in [Weighing::NoChoice, Weighing::PointLight, Weighing::Twice] {
        let wrong = two_strategies(&scene, &ray, slip);
        assert!(!agrees(&wrong, truth), "{slip:?}: {wrong:?}, {truth}");
    }
}
