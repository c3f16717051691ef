//! What is stratified in the square is stratified where the warps take it: each elementary interval's image holds
//! exactly one of 2^k points. The images are told by inverse maps, which are written for this test.

use std::f64::consts::{FRAC_PI_4, TAU};

use glam::{DVec2, DVec3};
use lancer_core::geometry::Sphere;
use lancer_core::sampling::{
    Patch, Pattern, PixelSampling, Rectangle, SeenSphere, concentric_disc, cosine_hemisphere,
    parallelogram_solid_angle, phong_lobe, triangle,
};

/// Whether each elementary interval holds one of the first 2^k points, k = 2 to 10, there and back.
fn survive(there_and_back: impl Fn([f64; 2]) -> [f64; 2]) -> bool {
    (2..=10).all(|k| {
        let sampling = PixelSampling { pattern: Pattern::Owen, samples: 1 << k, seed: 21 };
        let points: Vec<[f64; 2]> = sampling
            .of_pixel(k, 4)
            .map(|sample| {
                let [u, v, _, _] = sample.numbers(3);
                // Half a step away from the intervals' ends, which no rounding crosses.
                let half = 0.5_f64.powi(24);
                there_and_back([u + half, v + half])
            })
            .collect();
        (0..=k).all(|split| {
            let (columns, rows) = (1_u32 << split, 1_u32 << (k - split));
            let mut seen = vec![false; 1 << k];
            points.iter().all(|[u, v]| {
                let [column, row] =
                    [u * f64::from(columns), v * f64::from(rows)].map(|place| place as usize);
                let cell = &mut seen[column * rows as usize + row];
                !std::mem::replace(cell, true)
            })
        })
    })
}

/// The disc's square back: the larger coordinate is the radius, the smaller its share of an eighth of a turn.
fn from_disc(place: DVec2) -> [f64; 2] {
    let (r, angle) = (place.length(), place.to_angle());
    let (a, b) = if place.x.abs() > place.y.abs() {
        let a = r.copysign(place.x);
        (a, a * (place.y / place.x).atan() / FRAC_PI_4)
    } else {
        let b = r.copysign(place.y);
        (b * (place.x / place.y).atan() / FRAC_PI_4, b)
    };
    assert!(angle.is_finite());
    [0.5 * (a + 1.0), 0.5 * (b + 1.0)]
}

#[test]
fn strata_survive_disc_hemisphere_and_lobes() {
    assert!(survive(|u| from_disc(concentric_disc(u))));
    // Around z the frame is x and y.
    assert!(survive(|u| from_disc(cosine_hemisphere(DVec3::Z, u).truncate())));
    for exponent in [0.0, 1.0, 30.0, 1e5] {
        assert!(survive(|u| {
            let direction = phong_lobe(DVec3::Z, exponent, u);
            // r² = 1 − cos^(n+1), from the sine: the cosine of a needle is nearly 1.
            let log = 0.5 * (-direction.truncate().length_squared()).ln_1p();
            let r = (-((exponent + 1.0) * log).exp_m1()).sqrt();
            from_disc(r * direction.truncate().normalize())
        }));
    }
    // A map of another density moves points across: a radius without its root.
    assert!(!survive(|[u, v]| {
        let disc = u * DVec2::from_angle(TAU * (v - 0.5));
        [disc.length_squared(), disc.to_angle() / TAU + 0.5]
    }));
}

#[test]
fn strata_survive_triangles_and_faces() {
    let from_weights = |weights: DVec3| {
        let [b0, b1] = [weights.x, weights.y];
        if b1 > b0 { [2.0 * b0, b0 + b1] } else { [b0 + b1, 2.0 * b1] }
    };
    let unit = [DVec3::X, DVec3::Y, DVec3::Z];
    assert!(survive(|u| from_weights(triangle(unit, u))));

    // Three triangles of areas 1, 1 and 2: halves and quarters of the first number.
    let strip = [
        [DVec3::ZERO, 2.0 * DVec3::X, DVec3::Y],
        [10.0 * DVec3::X, 12.0 * DVec3::X, DVec3::new(10.0, 1.0, 0.0)],
        [20.0 * DVec3::X, 24.0 * DVec3::X, DVec3::new(20.0, 1.0, 0.0)],
    ];
    let face = Patch::new(strip).unwrap();
    assert!(survive(|u| {
        let (point, _) = face.point(u);
        let k = (point.x / 10.0) as usize;
        let [a, b, c] = strip[k];
        let second = (point.x - a.x) / (b.x - a.x);
        let third = point.y / c.y;
        let [u, v] = from_weights(DVec3::new(1.0 - second - third, second, third));
        [[0.25 * u, 0.25 * (u + 1.0), 0.5 * (u + 1.0)][k], v]
    }));
}

#[test]
fn strata_survive_solid_angles() {
    for (corner, size) in [
        (DVec3::new(-0.5, -0.5, 1.0), [1.0, 1.0]),
        (DVec3::new(1.0, -0.5, 1.0), [1.0, 1.0]),
        (DVec3::new(-1.0, -1.0, 0.1), [2.0, 2.0]),
        (DVec3::new(-2.0, 0.95, 1.0), [0.1, 4.0]),
    ] {
        let edges = [size[0] * DVec3::Y, size[1] * DVec3::X];
        let rectangle = Rectangle::new(corner, edges).unwrap();
        let seen = rectangle.seen_from(DVec3::ZERO).unwrap();
        assert!(survive(|u| {
            let point = seen.sample(u);
            let left =
                parallelogram_solid_angle(corner, [(point.y - corner.y) * DVec3::Y, edges[1]]);
            let height = |x: f64| x / point.with_x(x).length();
            let [from, to] = [corner.x, corner.x + size[1]].map(height);
            [left / seen.solid_angle(), (height(point.x) - from) / (to - from)]
        }));
    }
    let sphere = Sphere { center: 3.0 * DVec3::Z, radius: 1.0 };
    let seen = SeenSphere::new(sphere, DVec3::ZERO).unwrap();
    assert!(survive(|u| {
        let direction = seen.sample(u).position.normalize();
        let sin_squared = direction.truncate().length_squared();
        let one_minus_cos = sin_squared / (1.0 + direction.z);
        let r = (one_minus_cos * TAU / seen.solid_angle()).sqrt();
        from_disc(r * direction.truncate().normalize())
    }));
}
