//! Lamps that are hard to sample, against Lambert's polygon and limits known by hand.

use std::f64::consts::PI;

use glam::DVec3;
use lancer_accel::Wide;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::intersector::Intersector;
use lancer_core::sampling::{Estimate, PixelSampling};
use lancer_core::scene::{Material, MaterialId, Mesh, Scene};
use lancer_core::world::World;
use lancer_distributed::{Distributed, PathSettings, PathTracer, RayCounts, Settings};

use crate::statistics::{agrees, replicated};

/// A small white receiver of normal z at the origin, of this side, and lamps of radiance 1, each a polygon that is
/// counter-clockwise seen from the side it shines to, cut into a fan.
fn under(side: f64, lamps: &[Vec<DVec3>]) -> Scene {
    let mut mesh = Mesh::default();
    let mut face = |material, outline: &[DVec3]| {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(outline);
        let fan = (1..outline.len() as u32 - 1).map(|k| [first, first + k, first + k + 1]);
        mesh.push_face(MaterialId(material), &fan.collect::<Vec<_>>());
    };
    let [x, y] = [side * DVec3::X, side * DVec3::Y];
    face(0, &[-x - y, x - y, x + y, y - x]);
    lamps.iter().for_each(|lamp| face(1, lamp));
    let lamp = Material { emission: Rgb::ONE, ..Material::matte(Rgb::ZERO) };
    let materials = vec![Material::matte(Rgb::ONE), lamp];
    Scene { materials, ..Scene::of_mesh(mesh) }
}

/// The irradiance of the receiver's middle, from 64 scramblings of some samples.
fn irradiance(scene: &Scene, side: f64, samples: u32, by_paths: bool) -> Estimate {
    let index = Wide::build(scene);
    let world = World { scene, index: &index };
    let distributed = Distributed::new(world, Settings::default());
    let settings = PathSettings { max_depth: Some(0), ..PathSettings::default() };
    let path = PathTracer::new(world, settings);
    let from = 0.1 * side * DVec3::new(0.3, 0.4, 1.0);
    let ray = Ray::new(from, -from.normalize());
    let hit = index.closest_hit(&ray, Interval::POSITIVE);
    replicated(samples, 5, |sample| {
        let rays = &mut RayCounts::default();
        let radiance = if by_paths {
            path.shade(&ray, hit, None, sample, rays)
        } else {
            distributed.shade(&ray, hit, None, sample, rays)
        };
        PI * radiance.x
    })
}

#[track_caller]
fn assert_irradiance(scene: &Scene, side: f64, samples: u32, truth: f64) {
    let estimates = [false, true].map(|by_paths| irradiance(scene, side, samples, by_paths));
    assert!(estimates.iter().all(|estimate| agrees(estimate, truth)), "{estimates:?}, {truth}");
    let spreads =
        estimates.map(|estimate| estimate.standard_error() / truth.max(f64::MIN_POSITIVE));
    assert!(spreads.iter().all(|&spread| spread < 0.02), "{spreads:?}");
}

/// E = ½ Σ γᵢ n·Γᵢ: Lambert's polygon, above the horizon z = 0.
fn lambert(outline: &[DVec3]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    let edge = |(a, b): (&DVec3, &DVec3)| {
        let normal = a.cross(*b);
        let angle = normal.length().atan2(a.dot(*b));
        0.5 * angle * normal.normalize_or_zero().z
    };
    // Seen from below the polygons run the other way round.
    -outline.iter().zip(next).map(edge).sum::<f64>()
}

/// A level square that shines down.
fn square(center: DVec3, side: f64) -> Vec<DVec3> {
    let corner = |x: f64, y: f64| center + 0.5 * side * DVec3::new(x, y, 0.0);
    vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)]
}

/// A triangle, a skew quadrilateral and a pentagon, near and far.
#[test]
fn polygons_have_lamberts_irradiance() {
    let outline = [(-0.4, -0.3), (-0.6, 0.5), (0.1, 0.9), (0.8, 0.4), (0.5, -0.5)];
    for height in [0.25, 0.7, 5.0] {
        for corners in 3..=5 {
            let lamp: Vec<DVec3> =
                outline[..corners].iter().map(|&(x, y)| DVec3::new(x, y, height)).collect();
            let truth = lambert(&lamp);
            assert!(truth > 0.0, "{truth}");
            assert_irradiance(&under(1e-4, &[lamp]), 1e-4, 1024, truth);
        }
    }
    let closed = lambert(&square(DVec3::Z, 1.0));
    assert!((closed - 0.752274688454107).abs() < 1e-14, "{closed}");
}

/// The same picture from 1e-6 to 1e6 units, to the last digits.
#[test]
fn scenes_have_no_scale() {
    for scale in [1e-6, 1.0, 1e6] {
        let scene = under(1e-4 * scale, &[square(scale * DVec3::Z, scale)]);
        assert_irradiance(&scene, 1e-4 * scale, 64, 0.752274688454107);
    }
}

/// A lamp of a millionth is A h² / d⁴ bright, up to a part of 1e-12; one of a million fills the sky, up to 1e-11.
#[test]
fn tiny_and_huge_lamps() {
    let tiny = under(1e-4, &[square(DVec3::new(0.3, 0.2, 1.0), 1e-6)]);
    assert_irradiance(&tiny, 1e-4, 16, 1e-12 / (1.13 * 1.13));
    let huge = under(1e-4, &[square(DVec3::Z, 1e6)]);
    assert_irradiance(&huge, 1e-4, 1024, PI);
}

/// Ten thousand lamps side by side are one.
#[test]
fn ten_thousand_lamps_are_one() {
    let place = |k: u32| DVec3::new(f64::from(k % 100), f64::from(k / 100), 0.0);
    let part = |k| square(0.01 * place(k) - DVec3::new(0.495, 0.495, -1.0), 0.01);
    let lamps: Vec<_> = (0..10_000).map(part).collect();
    let scene = under(1e-4, &lamps);
    for (samples, by_paths) in [(1, false), (256, true)] {
        let estimate = irradiance(&scene, 1e-4, samples, by_paths);
        assert!(agrees(&estimate, 0.752274688454107), "{by_paths}: {estimate:?}");
        assert!(estimate.standard_error() < 0.01, "{by_paths}: {estimate:?}");
    }
}

/// A wall of light that ends on the receiver's plane, ever nearer, down to a billionth: half the sky.
#[test]
fn lamps_that_touch_the_receiver() {
    for distance in [0.1, 1e-3, 1e-6, 1e-9] {
        let at = |y: f64, z: f64| DVec3::new(distance, y, z);
        let wall = vec![at(-0.5, 0.0), at(-0.5, 1.0), at(0.5, 1.0), at(0.5, 0.0)];
        let truth = lambert(&wall);
        assert!(distance > 0.01 || (truth - 0.5 * PI).abs() < 4.0 * distance);
        let side = 0.01 * distance;
        assert_irradiance(&under(side, &[wall]), side, 1024, truth);
    }
}

/// Faces without area, lamps that turn their backs and lamps below the horizon light nothing, and cost no shadow ray.
#[test]
fn lamps_that_light_nothing() {
    let above = square(DVec3::Z, 1.0);
    let mut turned = above.clone();
    turned.reverse();
    let line = vec![above[0], above[2], 0.5 * (above[0] + above[2])];
    let point = vec![above[0]; 4];
    let below = above.iter().map(|p| DVec3 { z: -1.0, ..*p }).collect();
    let mut shining_up = turned.clone();
    shining_up.iter_mut().for_each(|p| p.z = -1.0);
    for lamp in [turned, line, point, below, shining_up] {
        let scene = under(1e-4, &[lamp]);
        let index = Wide::build(&scene);
        let world = World { scene: &scene, index: &index };
        let distributed = Distributed::new(world, Settings::default());
        let path = PathTracer::new(world, PathSettings::default());
        let ray = Ray::new(DVec3::new(0.0, 0.0, 0.1), DVec3::NEG_Z);
        let hit = index.closest_hit(&ray, Interval::POSITIVE);
        let mut rays = RayCounts::default();
        let estimate = replicated(4, 5, |sample| {
            distributed.shade(&ray, hit, None, sample, &mut RayCounts::default()).x
        });
        assert_eq!((estimate.mean(), estimate.variance()), (0.0, 0.0));
        for sample in PixelSampling::CENTER.of_pixel(1, 2) {
            assert_eq!(path.shade(&ray, hit, None, &sample, &mut rays), Rgb::ZERO);
            distributed.shade(&ray, hit, None, &sample, &mut rays);
        }
        assert_eq!(rays.shadow, 0);
    }
}
