//! The same bits for any number of threads, any tile size and any run.

use std::sync::atomic::AtomicBool;

use glam::DVec3;
use lancer_accel::{ObvhsBvh2, Wide};
use lancer_core::Rgb;
use lancer_core::generate::{icosphere, sphere_flake};
use lancer_core::geometry::Ray;
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Intersector, LinearScan};
use lancer_core::render::{AlongRays, Cancelled, Control, Rendering, render_pixels};
use lancer_core::sampling::{Pattern, PixelSampling, Sample};
use lancer_core::scene::{Material, MaterialId, PointLight, Scene};
use lancer_core::world::World;
use lancer_whitted::{AtLimit, RayCounts, Settings, Whitted};

fn scene() -> Scene {
    let mut scene = Scene::of_mesh(icosphere(1));
    scene.camera.eye = DVec3::new(1.0, 2.0, 5.0);
    scene.spheres = sphere_flake(2, MaterialId(1));
    scene.materials.push(Material {
        k_s: Rgb::splat(0.4),
        k_t: Rgb::splat(0.5),
        refractive_index: 1.5,
        ..Material::matte(Rgb::splat(0.2))
    });
    scene.materials[0].k_t = Rgb::splat(0.8);
    scene.lights = vec![PointLight { position: DVec3::splat(4.0), intensity: Rgb::splat(30.0) }];
    scene.background = Rgb::splat(0.3);
    scene
}

fn render(threads: usize, tile: u32, pattern: Pattern, settings: Settings) -> Rendering<RayCounts> {
    let scene = scene();
    let index = ObvhsBvh2::build(&scene);
    let method = Whitted::new(World { scene: &scene, index: &index }, settings);
    let size = ImageSize::new(61, 47);
    let rays = scene.camera.primary_rays(size);
    let sampling = PixelSampling { pattern, samples: 4, seed: 9 };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let control = Control { tile, ..Control::default() };
    pool.install(|| {
        render_pixels(size, sampling, control, |sample: &Sample, counts: &mut RayCounts| {
            method.trace(&rays.through(sample.film.x, sample.film.y), counts)
        })
    })
    .unwrap()
}

/// Primary rays that are answered together, and the same one by one and by brute force.
#[test]
fn pictures_do_not_depend_on_who_answers() {
    let mut scene = Scene::of_mesh(icosphere(3));
    scene.lights.push(PointLight::beside(&scene.camera));
    let spheres = self::scene();
    for scene in [&scene, &spheres] {
        let (wide, linear) = (Wide::build(scene), LinearScan::new(scene));
        let size = ImageSize::new(61, 47);
        let rays = scene.camera.primary_rays(size);
        for samples in [1, 5] {
            let sampling = PixelSampling { pattern: Pattern::Owen, samples, seed: 9 };
            let [together, alone] = [&wide as &dyn Intersector, &linear].map(|index| {
                let world = World { scene, index };
                let whitted = Whitted::new(world, Settings::default());
                let trace =
                    |rays: &[Ray], _: &[Sample], radiance: &mut [Rgb], counts: &mut RayCounts| {
                        whitted.trace_all(rays, radiance, counts);
                    };
                let all = AlongRays::new(world, size, trace);
                let together = render_pixels(size, sampling, Control::default(), all).unwrap();
                let alone = render_pixels(
                    size,
                    sampling,
                    Control::default(),
                    |sample: &Sample, counts: &mut _| {
                        whitted.trace(&rays.through(sample.film.x, sample.film.y), counts)
                    },
                );
                assert_eq!(together, alone.unwrap());
                together
            });
            assert!(together == alone && together.counts.shadow > 100, "{:?}", together.counts);
        }
    }
}

/// Bits and counts of rays that are followed together are those of rays followed one by one, whatever ends the
/// recursion and however many there are.
#[test]
fn rays_are_followed_together_as_alone() {
    let mut scene = scene();
    let second = PointLight { position: DVec3::new(-4.0, 3.0, 5.0), ..scene.lights[0] };
    scene.lights.push(second);
    let wide = Wide::build(&scene);
    let world = World { scene: &scene, index: &wide };
    let through = scene.camera.primary_rays(ImageSize::new(24, 16));
    let pixels = (0..16).flat_map(|y| (0..24).map(move |x| (f64::from(x), f64::from(y))));
    let rays: Vec<Ray> = pixels.map(|(x, y)| through.through(x + 0.5, y + 0.5)).collect();
    let mut bounces = Vec::new();
    for (max_depth, min_weight, at_limit) in [
        (0, 0.0, AtLimit::Background),
        (4, 0.3, AtLimit::Ambient),
        (6, 0.0, AtLimit::Black),
        (6, 0.3, AtLimit::Roulette { seed: 5 }),
    ] {
        let whitted = Whitted::new(world, Settings { max_depth, min_weight, at_limit });
        let mut wanted = RayCounts::default();
        let alone: Vec<Rgb> = rays.iter().map(|ray| whitted.trace(ray, &mut wanted)).collect();
        bounces.push(wanted.mirror + wanted.refracted);
        for batch in [1, 2, 3, 7, 128, rays.len()] {
            let (mut together, mut counts) = (vec![Rgb::NAN; rays.len()], RayCounts::default());
            for (rays, radiance) in rays.chunks(batch).zip(together.chunks_mut(batch)) {
                whitted.trace_all(rays, radiance, &mut counts);
            }
            assert_eq!(counts, wanted, "{max_depth} {at_limit:?} {batch}");
            assert!(together == alone, "{max_depth} {at_limit:?} {batch}");
        }
    }
    assert!(bounces[0] == 0 && bounces[1] > 100 && bounces[2] > 2 * bounces[1], "{bounces:?}");
}

#[test]
fn pictures_do_not_depend_on_threads_or_tiles() {
    let roulette =
        Settings { max_depth: 100, min_weight: 0.2, at_limit: AtLimit::Roulette { seed: 3 } };
    for (pattern, settings) in [
        (Pattern::Regular, Settings::default()),
        (Pattern::Jittered, Settings::default()),
        (Pattern::Owen, Settings::default()),
        (Pattern::Owen, roulette),
    ] {
        let one = render(1, 16, pattern, settings);
        assert!(
            one.counts.refracted > 1000 && one.counts.shadow > 1000,
            "the test traces something"
        );
        for threads in [2, 3, 7] {
            assert!(
                render(threads, 16, pattern, settings) == one,
                "{threads} threads, {pattern:?}"
            );
        }
        for tile in [1, 8, 17, 64] {
            assert!(render(2, tile, pattern, settings) == one, "tiles of {tile}, {pattern:?}");
        }
    }
}

#[test]
fn a_cancelled_rendering_is_no_picture() {
    let cancelled = AtomicBool::new(true);
    let control = Control { cancelled: &cancelled, ..Control::default() };
    let size = ImageSize::new(8, 8);
    let result =
        render_pixels(size, PixelSampling::CENTER, control, |_: &Sample, _: &mut RayCounts| {
            Rgb::ONE
        });
    assert_eq!(result, Err(Cancelled));
}
