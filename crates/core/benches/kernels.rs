//! The kernels that every ray runs through, each on the same thousand rays.
#![allow(missing_docs)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use lancer_core::generate::icosphere;
use lancer_core::geometry::{Interval, Ray, Shear, Slabs, Sphere, intersect_triangle};
use lancer_core::optics::{reflect, refract};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

const RAYS: usize = 1000;

/// Rays from a cube of side 2 towards a cube of side 2 around (0, 0, 5).
fn rays() -> Vec<Ray> {
    let mut random = Pcg64::new(1, 1);
    let mut coordinate = || f64::from(random.next_u32()) / f64::from(u32::MAX) * 2.0 - 1.0;
    let mut point = || DVec3::new(coordinate(), coordinate(), coordinate());
    (0..RAYS)
        .map(|_| {
            let origin = point();
            Ray::new(origin, (point() + 5.0 * DVec3::Z - origin).normalize())
        })
        .collect()
}

fn kernels(criterion: &mut Criterion) {
    let rays = rays();
    let mut group = criterion.benchmark_group("kernels");
    group.throughput(Throughput::Elements(RAYS as u64));

    let corners = icosphere(0).corners(7).map(|p| p + 5.0 * DVec3::Z);
    group.bench_function("watertight triangle", |bencher| {
        bencher.iter(|| {
            let hit =
                |ray: &&Ray| intersect_triangle(corners, ray, &Shear::new(ray.direction)).is_some();
            rays.iter().filter(hit).count()
        });
    });
    let sphere = Sphere { center: 5.0 * DVec3::Z, radius: 1.0 };
    group.bench_function("sphere", |bencher| {
        bencher.iter(|| {
            let hit = |ray: &&Ray| sphere.intersect(ray, Interval::POSITIVE).is_some();
            rays.iter().filter(hit).count()
        });
    });
    let (min, max) = (DVec3::new(-1.0, -1.0, 4.0), DVec3::new(1.0, 1.0, 6.0));
    group.bench_function("box", |bencher| {
        bencher.iter(|| {
            let hit = |ray: &&Ray| Slabs::new(ray).enter(min, max, Interval::POSITIVE).is_some();
            rays.iter().filter(hit).count()
        });
    });
    group.bench_function("reflect and refract", |bencher| {
        bencher.iter(|| {
            let directions = |ray: &Ray| {
                let t = refract(ray.direction, DVec3::NEG_Z, 1.0, 1.5);
                reflect(ray.direction, DVec3::NEG_Z) + t.unwrap_or(DVec3::ZERO)
            };
            rays.iter().filter(|ray| ray.direction.z > 0.0).map(directions).sum::<DVec3>()
        });
    });
    group.finish();
}

criterion_group!(benches, kernels);
criterion_main!(benches);
