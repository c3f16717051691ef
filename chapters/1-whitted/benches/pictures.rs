//! Whole pictures on one thread: Whitted's scene by both methods and through both indexes, and two indexes
//! over a mesh. Other meshes: `cargo xtask render`.
#![allow(missing_docs)]

use chapter_1::scenes;
use criterion::{Criterion, criterion_group, criterion_main};
use lancer_accel::{ObvhsBvh2, Wide};
use lancer_core::Rgb;
use lancer_core::geometry::Ray;
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Intersector, LinearScan};
use lancer_core::render::{AlongRays, Control, render_pixels};
use lancer_core::sampling::{PixelSampling, Sample};
use lancer_core::scene::Scene;
use lancer_core::world::World;
use lancer_whitted::{Appel, RayCounts, Settings, Whitted};

const SIZE: ImageSize = ImageSize::new(256, 256);

fn picture(world: World, trace: impl Fn(&[Ray], &mut [Rgb], &mut RayCounts) + Sync) -> RayCounts {
    let trace = |rays: &[Ray], _: &[Sample], radiance: &mut [Rgb], counts: &mut _| {
        trace(rays, radiance, counts);
    };
    let all = AlongRays::new(world, SIZE, trace);
    let rendering = render_pixels(SIZE, PixelSampling::CENTER, Control::default(), all);
    rendering.expect("nobody cancels a bench").counts
}

fn appel(scene: &Scene, index: &dyn Intersector) -> RayCounts {
    let world = World { scene, index };
    let method = Appel::new(world);
    picture(world, |rays, radiance, counts| method.trace_all(rays, radiance, counts))
}

fn whitted(scene: &Scene, index: &dyn Intersector) -> RayCounts {
    let world = World { scene, index };
    let method = Whitted::new(world, Settings::default());
    picture(world, |rays, radiance, counts| method.trace_all(rays, radiance, counts))
}

fn pictures(criterion: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let scene = scenes::whitted();
    let (linear, tree) = (LinearScan::new(&scene), ObvhsBvh2::build(&scene));
    let mut group = criterion.benchmark_group("whitted 256x256");
    group.bench_function("appel, obvhs-bvh2", |b| {
        b.iter(|| pool.install(|| appel(&scene, &tree)));
    });
    group.bench_function("whitted, linear", |b| {
        b.iter(|| pool.install(|| whitted(&scene, &linear)));
    });
    group.bench_function("whitted, obvhs-bvh2", |b| {
        b.iter(|| pool.install(|| whitted(&scene, &tree)));
    });
    group.finish();

    let gears = scenes::opened("gears", Some("4")).scene;
    let (tree, wide) = (ObvhsBvh2::build(&gears), Wide::build(&gears));
    let mut group = criterion.benchmark_group("gears:4");
    group.sample_size(20);
    group.bench_function("build obvhs-bvh2", |b| {
        b.iter(|| ObvhsBvh2::build(&gears).memory());
    });
    group.bench_function("appel 256x256, obvhs-bvh2", |b| {
        b.iter(|| pool.install(|| appel(&gears, &tree)));
    });
    group.bench_function("appel 256x256, wide", |b| {
        b.iter(|| pool.install(|| appel(&gears, &wide)));
    });
    group.finish();
}

criterion_group!(benches, pictures);
criterion_main!(benches);
