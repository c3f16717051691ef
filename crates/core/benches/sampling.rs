//! What a sample's numbers cost, and what is made of them, each a thousand times.
#![allow(missing_docs)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use lancer_core::geometry::Sphere;
use lancer_core::sampling::{
    Patch, Pattern, PixelSampling, Sample, SeenSphere, Uniform, concentric_disc, cosine_hemisphere,
    parallelogram, phong_lobe, phong_lobe_density, power_heuristic, triangle,
};

const CALLS: usize = 1000;

fn samples() -> Vec<Sample> {
    let sampling = PixelSampling { pattern: Pattern::Owen, samples: 16, seed: 1 };
    (0..).flat_map(|x| sampling.of_pixel(x, 7)).take(CALLS).collect()
}

fn numbers(criterion: &mut Criterion) {
    let samples = samples();
    let mut group = criterion.benchmark_group("numbers");
    group.throughput(Throughput::Elements(CALLS as u64));
    group.bench_function("set of four", |bencher| {
        bencher.iter(|| samples.iter().map(|s| s.numbers(3).iter().sum::<f64>()).sum::<f64>());
    });
    let sampling = PixelSampling { pattern: Pattern::Owen, samples: CALLS as u32, seed: 1 };
    group.bench_function("Owen film point", |bencher| {
        bencher.iter(|| sampling.of_pixel(3, 4).map(|s| s.film).sum::<glam::DVec2>());
    });
    group.bench_function("uniform", |bencher| {
        let mut random = Uniform::new(1, 2, 3);
        bencher.iter(|| (0..CALLS).map(|_| random.number()).sum::<f64>());
    });
    group.finish();
}

fn warps(criterion: &mut Criterion) {
    let mut random = Uniform::new(1, 2, 3);
    let numbers: Vec<[f64; 2]> = (0..CALLS).map(|_| [random.number(), random.number()]).collect();
    let directions: Vec<DVec3> = (0..CALLS).map(|_| random.direction()).collect();
    let mut group = criterion.benchmark_group("warps");
    group.throughput(Throughput::Elements(CALLS as u64));
    let mut bench = |name: &str, warp: &dyn Fn(DVec3, [f64; 2]) -> DVec3| {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                directions.iter().zip(&numbers).map(|(&axis, &u)| warp(axis, u)).sum::<DVec3>()
            });
        });
    };

    let corners = [DVec3::X, DVec3::Y, DVec3::Z];
    bench("disc", &|_, u| concentric_disc(u).extend(0.0));
    bench("cosine hemisphere", &cosine_hemisphere);
    bench("lobe", &|axis, u| phong_lobe(axis, 50.0, u));
    bench("lobe density", &|axis, [u, _]| axis * phong_lobe_density(50.0, u));
    bench("triangle", &|_, u| triangle(corners, u));
    bench("parallelogram", &|_, u| parallelogram(corners[0], [corners[1], corners[2]], u));
    bench("power heuristic", &|_, [u, v]| DVec3::splat(power_heuristic(u, v)));

    // A lamp of side 1, and receivers around a point at a distance.
    let [a, b, c] = [DVec3::new(-0.5, -0.5, 0.0), DVec3::Y, DVec3::X];
    let lamp = Patch::new([[a, a + b, a + c], [a + b + c, a + c, a + b]]).unwrap();
    let sampled = |distance: f64| {
        let lamp = &lamp;
        move |off: DVec3, u: [f64; 2]| {
            let from = 0.1 * off - distance * DVec3::Z;
            let sample = lamp.seen_from(from).sample(u);
            sample.map_or(DVec3::ZERO, |sample| sample.position / sample.density)
        }
    };
    bench("lamp by area", &sampled(2.0));
    bench("lamp by solid angle", &sampled(0.5));
    let pentagon = [(0.0, 0.0), (3.0, 0.0), (4.0, 1.0), (2.0, 4.0), (0.5, 3.0)]
        .map(|(x, y)| DVec3::new(y, x, 0.0));
    let face = Patch::new((1..4).map(|k| [pentagon[0], pentagon[k], pentagon[k + 1]])).unwrap();
    bench("face of three triangles", &|off, u| {
        let sample = face.seen_from(0.1 * off - 2.0 * DVec3::Z).sample(u);
        sample.map_or(DVec3::ZERO, |sample| sample.position / sample.density)
    });
    let sphere = Sphere { center: DVec3::new(0.0, 0.0, 2.0), radius: 1.0 };
    bench("sphere", &|off, u| {
        let seen = SeenSphere::new(sphere, 0.1 * off);
        seen.map_or(DVec3::ZERO, |seen| seen.sample(u).position / seen.density())
    });
    group.finish();
}

criterion_group!(benches, numbers, warps);
criterion_main!(benches);
