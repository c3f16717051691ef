//! Spheres as lamps of radiance 1.

use std::f64::consts::{FRAC_PI_4, PI};

use glam::DVec3;
use lancer_core::geometry::Sphere;
use lancer_core::sampling::{SeenSphere, area_light_density};

use super::statistics::{agrees, deviates, independent, replicated};

/// cos θ over the density of a unit sphere at `distance` along z, for a receiver whose normal is so many degrees off.
fn by_cone(distance: f64, degrees: f64) -> impl Fn([f64; 2]) -> f64 {
    let sphere = Sphere { center: distance * DVec3::Z, radius: 1.0 };
    let seen = SeenSphere::new(sphere, DVec3::ZERO).unwrap();
    let (sin, cos) = degrees.to_radians().sin_cos();
    move |u| {
        let sample = seen.sample(u);
        let cosine = sample.position.normalize().dot(DVec3::new(sin, 0.0, cos));
        cosine.max(0.0) / sample.density
    }
}

/// Facing it E = π r²/d², tilted by an angle that leaves it above the horizon cos times that; beyond, by quadrature of
/// 40 digits.
#[test]
fn irradiances_are_those_of_the_closed_form() {
    for (distance, degrees, irradiance) in [
        (1.5, 0.0, 1.3962634015955),
        (2.0, 0.0, FRAC_PI_4),
        (3.0, 0.0, 0.34906585039887),
        (10.0, 0.0, 0.031415926535898),
        (1e8, 0.0, 3.1415926535898e-16),
        (3.0, 30.0, 0.302299894039036),
        (2.0, 80.0, 0.171831975127396),
        (2.0, 90.0, 0.0905860737060795),
        (2.0, 100.0, 0.0354490153104747),
    ] {
        let estimate = replicated(1024, by_cone(distance, degrees));
        assert!(agrees(&estimate, irradiance), "{distance} {degrees}: {estimate:?}");
    }
}

/// Facing it, the cosines are even: their kurtosis is 9/5.
#[test]
fn deviations_are_those_of_the_closed_form() {
    for (distance, relative) in
        [(1.5, 0.084234269), (2.0, 0.041451884), (3.0, 0.016995605), (10.0, 0.00145064)]
    {
        let estimate = independent(100_000, by_cone(distance, 0.0));
        let irradiance = PI / distance.powi(2);
        assert!(deviates(&estimate, irradiance, relative, 1.8), "{distance}: {estimate:?}");
    }
}

/// All points of the sphere alike: √7 at distance 2. The same test tells the two apart.
#[test]
fn by_area_the_deviation_is_another() {
    let by_area = |[u, v]: [f64; 2]| {
        let (z, r) = (1.0 - 2.0 * u, 2.0 * (u * (1.0 - u)).sqrt());
        let (sin, cos) = (2.0 * PI * v).sin_cos();
        let normal = DVec3::new(r * cos, r * sin, z);
        let point = 2.0 * DVec3::Z + normal;
        let cos_light = -normal.dot(point) / point.length();
        let density = area_light_density(point.length_squared(), cos_light, 4.0 * PI);
        if density > 0.0 { point.normalize().z / density } else { 0.0 }
    };
    let estimate = independent(100_000, by_area);
    let off = (estimate.mean() / (PI / 4.0) - 1.0).abs();
    assert!(off < 5.0 * 7.0_f64.sqrt() / 100_000.0_f64.sqrt(), "{off}");
    let deviation = estimate.variance().sqrt() / (PI / 4.0);
    assert!((deviation / 7.0_f64.sqrt() - 1.0).abs() < 0.05, "{deviation}");
    assert!(!deviates(&estimate, PI / 4.0, 0.041451884, 1.8));
}

/// 1/(1 − cos θ) and samples from hardly outside to 10⁸ radii away: on the sphere, on its near side, within the cone.
/// The difference 1 − cos θ would be 0 from there.
#[test]
fn near_and_far_spheres_keep_their_digits() {
    let axis = DVec3::new(0.48, -0.64, 0.6);
    for (distance, one_minus_cos) in [
        // s²/(1 + √(1 − s²)) in 40 digits.
        (1.0 + 1e-9, 0.9999552786386334_f64),
        (1.0001, 0.9858589249348051),
        (2.0, 0.13397459621556135),
        (1e4, 5.0000000125e-9),
        (1e8, 5e-17),
    ] {
        let sphere = Sphere { center: DVec3::ZERO, radius: 1.0 };
        let from = -distance * axis;
        let seen = SeenSphere::new(sphere, from).unwrap();
        let relative = seen.solid_angle() / (2.0 * PI * one_minus_cos) - 1.0;
        // Close to the sphere the cosine is as inexact as the distance, over itself.
        let bound = f64::EPSILON * (4.0 + 2.0 / (1.0 - one_minus_cos));
        assert!(relative.abs() < bound, "{distance}: {relative}");
        assert!((seen.density() * seen.solid_angle() - 1.0).abs() < 1e-15);
        let limb = (1.0 / distance).powi(2);
        for i in 0..50 {
            for j in 0..50 {
                let u = [f64::from(i) / 49.0, f64::from(j) / 49.0];
                let point = seen.sample(u).position;
                assert!((point.length() - 1.0).abs() < 1e-15, "{distance} {u:?}: {point}");
                // On the near side: the tangent plane has the eye before it.
                assert!(-point.dot(axis) >= limb.sqrt() - 1e-15, "{distance} {u:?}: {point}");
            }
        }
    }
}

#[test]
fn from_inside_and_on_it_nothing_is_seen_nor_of_a_point() {
    let sphere = Sphere { center: DVec3::new(1.0, 2.0, 3.0), radius: 0.5 };
    for off in [0.0, 0.1, 0.5] {
        assert!(SeenSphere::new(sphere, sphere.center + off * DVec3::X).is_none(), "{off}");
    }
    assert!(SeenSphere::new(sphere, DVec3::splat(f64::NAN)).is_none());
    assert!(SeenSphere::new(Sphere { radius: 0.0, ..sphere }, DVec3::ZERO).is_none());
}
