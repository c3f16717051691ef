//! Chapter 3's methods beside chapter 1's, and beside each other.

use chapter_1::scenes::opened;
use glam::DVec3;
use lancer_accel::Wide;
use lancer_core::Rgb;
use lancer_core::generate::{cube, icosphere, sphere_flake};
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::{Defects, ImageSize};
use lancer_core::intersector::{Hit, Intersector, LinearScan};
use lancer_core::method::{Branching, BuildIndex, Method, Order, WorkKind};
use lancer_core::render::{Control, Estimator};
use lancer_core::sampling::{Estimate, Pattern, PixelSampling, Sample};
use lancer_core::scene::{Material, MaterialId, PointLight, Scene};
use lancer_core::world::World;
use lancer_distributed::{
    Distributed, Eye, Outlines, PathSettings, PathTracer, RayCounts, Settings,
};
use lancer_whitted::Whitted;

use crate::statistics::{agrees, grey, independent};

const INDEX: &BuildIndex = &|primitives| Box::new(Wide::build(primitives));

fn method<'m>(methods: &'m [Method], name: &str) -> &'m Method {
    methods.iter().find(|method| method.name == name).unwrap()
}

/// Smooth glass over a mirror: total reflection, and both branches at most hits.
fn glassy() -> Scene {
    let mut scene = Scene::of_mesh(cube());
    scene.mesh.append(
        &icosphere(2),
        glam::DAffine3::from_translation(DVec3::new(2.5, 0.2, 0.3)),
        1,
    );
    scene.spheres = sphere_flake(1, MaterialId(1));
    scene.camera.eye = DVec3::new(1.5, 2.0, 6.0);
    scene.materials.push(Material {
        rho_s: Rgb::splat(0.3),
        shininess: 20.0,
        k_s: Rgb::new(0.3, 0.35, 0.4),
        k_t: Rgb::new(0.6, 0.5, 0.4),
        refractive_index: 1.5,
        ..Material::matte(Rgb::splat(0.1))
    });
    scene.materials[0].k_t = Rgb::splat(0.7);
    scene.materials[0].k_s = Rgb::splat(0.2);
    scene.lights = [(4.0, 40.0), (-3.0, 15.0)]
        .map(|(x, i)| PointLight { position: DVec3::new(x, 5.0, 4.0), intensity: Rgb::splat(i) })
        .to_vec();
    scene.background = Rgb::new(0.2, 0.3, 0.5);
    scene.ambient = Rgb::splat(0.1);
    scene
}

/// algo:distributed with point lights, both branches and a sample in each pixel's centre is algo:lr: the same bits,
/// and the same rays.
#[test]
fn sharp_it_is_whitted_bit_for_bit() {
    let whitted = method(&lancer_whitted::METHODS, "whitted");
    let distributed = method(&lancer_distributed::METHODS, "distributed");
    let named = |name, level| opened(name, level).scene;
    let scenes = [
        ("whitted", named("whitted", None)),
        ("horizon", named("horizon", None)),
        ("flake", named("flake", Some("2"))),
        ("tetrahedra", named("tetrahedra", Some("3"))),
        ("gears", named("gears", Some("2"))),
        ("glassy", glassy()),
    ];
    for (name, scene) in &scenes {
        for max_depth in [None, Some(0), Some(2), Some(9)] {
            let order = Order { max_depth, ..Order::new(scene, INDEX, ImageSize::new(64, 48)) };
            let sharp = (whitted.render)(&order).unwrap();
            let branching = Some(Branching::Both);
            let same = (distributed.render)(&Order { branching, ..order }).unwrap();
            assert!(sharp.image == same.image, "{name}, depth {max_depth:?}");
            assert_eq!(sharp.work.total(WorkKind::Rays), same.work.total(WorkKind::Rays), "{name}");
        }
    }
}

/// A random branch has the mean of both, in each of the pixels where the first surface has two. The naive form, which
/// forgets the odds, has at most 7/9 of what comes back along them, the larger odds of the two materials.
#[test]
fn one_branch_is_both_in_the_mean() {
    let scene = glassy();
    let index = Wide::build(&scene);
    let world = World { scene: &scene, index: &index };
    let both = Whitted::new(world, lancer_whitted::Settings::default());
    let one =
        Distributed::new(world, Settings { branching: Branching::One, ..Settings::default() });
    let rays = scene.camera.primary_rays(ImageSize::new(16, 12));
    let no_bounce = lancer_whitted::Settings::to_depth(Some(0));
    let local = Whitted::new(world, no_bounce);
    let (mut compared, mut told_apart) = (0, 0);
    for y in 0..12_u32 {
        for x in 0..16 {
            let ray = rays.through(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let Some(hit) = index.closest_hit(&ray, Interval::POSITIVE) else { continue };
            let shared = scene.material(scene.surface_at(&ray, &hit).material);
            assert!(shared.k_s != Rgb::ZERO && shared.k_t != Rgb::ZERO);
            let truth = grey(both.trace(&ray, &mut ()));
            let shade = |sample: &Sample| {
                grey(one.shade(&ray, Some(hit), None, sample, &mut RayCounts::default()))
            };
            let seed = u64::from(16 * y + x);
            let estimate = independent(4000, seed, shade);
            assert!(agrees(&estimate, truth), "pixel {x} {y}: {estimate:?}, truth {truth}");
            let back = truth - grey(local.trace(&ray, &mut ()));
            let naive = truth - (1.0 - 7.0 / 9.0) * back;
            assert!(back < 0.01 || !agrees(&estimate, naive), "pixel {x} {y}: {estimate:?}");
            (compared, told_apart) = (compared + 1, told_apart + i32::from(back >= 0.01));
        }
    }
    assert!(compared >= 50 && told_apart >= 50, "{told_apart} of {compared}");
}

/// Where nothing is indirect, and the ambient term is 0, a path is a distributed ray: a matte ball and its shadow under
/// a lamp and a point light, before a black background, in all pixels at once.
#[test]
fn a_path_is_a_distributed_ray_where_nothing_is_indirect() {
    let mut scene = chapter_3::scenes::penumbra();
    scene.ambient = Rgb::ZERO;
    scene
        .lights
        .push(PointLight { position: DVec3::new(3.0, 3.0, 2.0), intensity: Rgb::splat(4.0) });
    let index = Wide::build(&scene);
    let world = World { scene: &scene, index: &index };
    let distributed = Distributed::new(world, Settings::default());
    let path =
        PathTracer::new(world, PathSettings { max_depth: Some(0), ..PathSettings::default() });
    let rays = scene.camera.primary_rays(ImageSize::new(12, 8));
    for y in 0..8 {
        for x in 0..12 {
            let sampling = PixelSampling { pattern: Pattern::Owen, samples: 16, seed: 3 };
            let mean = |pixel: u32, path_is: bool| {
                let radiance = |sample: Sample| {
                    let [u, v, ..] = sample.numbers(0);
                    let ray = rays.through(f64::from(x) + u, f64::from(y) + v);
                    let hit = index.closest_hit(&ray, Interval::POSITIVE);
                    let counts = &mut RayCounts::default();
                    grey(if path_is {
                        path.shade(&ray, hit, None, &sample, counts)
                    } else {
                        distributed.shade(&ray, hit, None, &sample, counts)
                    })
                };
                sampling.of_pixel(pixel, 64 * y + x).map(radiance).sum::<f64>() / 16.0
            };
            let difference: Estimate =
                (0..64).map(|k| mean(k, true) - mean(k + 64, false)).collect();
            assert!(agrees(&difference, 0.0), "pixel {x} {y}: {difference:?}");
        }
    }
}

/// The same bits and the same rays for any number of threads, any tile size, and by brute force.
#[test]
fn pictures_do_not_depend_on_who_draws_them() {
    let mut room = chapter_3::scenes::cornell();
    room.materials[1].rho_s = Rgb::splat(0.4);
    room.materials[1].shininess = 30.0;
    let mut glass = glassy();
    glass.materials[0].emission = Rgb::splat(3.0);
    for (scene, name) in
        [(&room, "path"), (&room, "distributed"), (&glass, "path"), (&glass, "distributed")]
    {
        let method = method(&lancer_distributed::METHODS, name);
        let render = |brute, threads, tile| {
            let draw = || {
                let linear: &BuildIndex = &|primitives| Box::new(LinearScan::new(primitives));
                let sampling = PixelSampling { pattern: Pattern::Owen, samples: 3, seed: 9 };
                let control = Control { tile, ..Control::default() };
                let index = if brute { linear } else { INDEX };
                let size = ImageSize::new(45, 31);
                let order = Order { sampling, control, ..Order::new(scene, index, size) };
                (method.render)(&order).unwrap()
            };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(draw)
        };
        let one = render(false, 1, 16);
        assert!(one.image.defects() == Defects::default() && one.work.total(WorkKind::Rays) > 5000);
        for (threads, tile) in [(2, 1), (3, 17), (7, 64)] {
            assert!(render(false, threads, tile) == one, "{name}: {threads} threads, {tile}");
        }
        assert!(render(true, 2, 16) == one, "{name}");
    }
}

/// The outline of a lamp is an integral of its own: with the pixels that it crosses looked after or not, pictures
/// have the same mean there, and the first less than a tenth of the variance, but where there is next to none.
#[test]
fn outlines_change_the_error_and_not_the_mean() {
    let scene = chapter_3::scenes::cornell();
    let index = Wide::build(&scene);
    let world = World { scene: &scene, index: &index };
    let size = ImageSize::new(32, 32);
    let outlines = Outlines::new(&scene, size);
    let path =
        PathTracer::new(world, PathSettings { max_depth: Some(0), ..PathSettings::default() });
    let shade =
        |ray: &Ray,
         hit: Option<Hit>,
         emission: Option<Rgb>,
         sample: &Sample,
         rays: &mut RayCounts| { path.shade(ray, hit, emission, sample, rays) };
    let eye = Eye::new(world, size, Pattern::Owen, shade);
    let plain = Eye::new(world, size, Pattern::Regular, shade);
    let places = (0..32 * 32).map(|k| [k % 32, k / 32]);
    let crossed: Vec<[u32; 2]> = places.filter(|&pixel| outlines.cross_pixel(pixel)).collect();
    assert!((12..20).contains(&crossed.len()), "{crossed:?}");
    let mut compared = 0;
    for pixel in crossed {
        let means = |eye: &dyn Estimator<RayCounts>, seeds: std::ops::Range<u64>| -> Estimate {
            let mean = |seed| {
                let sampling = PixelSampling { pattern: Pattern::Owen, samples: 8, seed };
                let samples: Vec<Sample> = sampling.of_pixel(pixel[0], pixel[1]).collect();
                let mut radiance = vec![Rgb::ZERO; samples.len()];
                eye.radiance(&samples, &mut radiance, &mut RayCounts::default());
                grey(radiance.iter().sum::<Rgb>()) / 8.0
            };
            seeds.map(mean).collect()
        };
        let (with, without) = (means(&eye, 0..256), means(&plain, 256..512));
        let error = with.standard_error().hypot(without.standard_error());
        let off = with.mean() - without.mean();
        assert!(off.abs() < 5.93 * error, "{pixel:?}: {with:?} {without:?}");
        let ratio = with.variance() / without.variance();
        assert!(ratio < 0.1 || without.standard_error() < 1e-3, "{pixel:?}: {ratio}");
        compared += u32::from(ratio < 0.1);
    }
    assert!(compared >= 8, "{compared}");
}
