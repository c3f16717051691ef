//! Mirror and refracted directions against closed forms; angles to the digits of 40-digit arithmetic.

use glam::{DVec2, DVec3};
use lancer_core::optics::{reflect, refract};

use crate::random::Random;

/// A unit direction that arrives at a surface with normal +y, at `degrees` from the normal.
fn arriving(degrees: f64) -> DVec3 {
    let angle = degrees.to_radians();
    DVec3::new(angle.sin(), -angle.cos(), 0.0)
}

/// The angle of a transmitted direction from the inner normal −y, in degrees.
fn angle(direction: DVec3) -> f64 {
    direction.x.atan2(-direction.y).to_degrees()
}

#[test]
fn reflected_ray_of_45_degrees() {
    let half = 0.5_f64.sqrt();
    let r = reflect(DVec3::new(half, -half, 0.0), DVec3::Y);
    assert!((r - DVec3::new(half, half, 0.0)).length() < 1e-16);
    assert_eq!(reflect(DVec3::NEG_Y, DVec3::Y), DVec3::Y);
    let oblique = DVec3::new(2.0, -3.0, 6.0) / 7.0;
    let (up, down) = (reflect(oblique, DVec3::Y), reflect(oblique, DVec3::NEG_Y));
    assert_eq!(up, down, "the side of the normal does not matter");
    assert!((up - DVec3::new(2.0, 3.0, 6.0) / 7.0).length() < 1e-15);
}

/// eq:reflected-ray in a corner of three mirrors: the ray comes back as it went, bit for bit.
#[test]
fn three_perpendicular_mirrors_return_a_ray() {
    let mut random = Random::new(59);
    for _ in 0..1000 {
        let d = random.direction();
        let back = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().fold(d, reflect);
        assert_eq!(back, -d);
    }
}

/// One bounce changes the length of a direction by rounding only, and a thousand, the most that
/// `render --depth` allows, stay far within what the formulas take for a unit vector.
#[test]
fn mirror_bounces_keep_the_length() {
    let mut random = Random::new(61);
    for _ in 0..1_000_000 {
        let length = reflect(random.direction(), random.direction()).length();
        assert!((length - 1.0).abs() <= 8.0 * f64::EPSILON, "{:e}", length - 1.0);
    }
    let mut d = random.direction();
    for _ in 0..1000 {
        d = reflect(d, random.direction());
    }
    assert!((d.length() - 1.0).abs() < 1e-12, "{:e}", d.length() - 1.0);
}

/// eq:descartes against 40-digit values.
#[test]
fn descartes_at_30_and_60_degrees_into_glass() {
    for (degrees, wanted) in [(30.0, 19.4712206344907), (60.0, 35.2643896827547)] {
        let t = refract(arriving(degrees), DVec3::Y, 1.0, 1.5).unwrap();
        assert!((angle(t) - wanted).abs() < 1e-12, "{degrees}: {}", angle(t));
    }
}

#[test]
fn total_reflection_begins_at_the_critical_angle() {
    for (index, critical) in [(1.5, 41.8103148957786), (4.0 / 3.0, 48.5903778907291)] {
        let leaving = |degrees: f64| refract(arriving(degrees), DVec3::Y, index, 1.0);
        assert!(leaving(critical - 1e-9).is_some());
        assert!(leaving(critical + 1e-9).is_none());
        // Just before, the ray grazes the surface.
        assert!(angle(leaving(critical - 1e-9).unwrap()) > 89.9);
    }
    assert!(refract(arriving(89.999), DVec3::Y, 1.5, 1.0).is_none());
    assert!(
        refract(arriving(89.999), DVec3::Y, 1.0, 1.5).is_some(),
        "never into the denser medium"
    );
}

/// cos θ₂ at a microradian before the critical angle, where it is infinitely sensitive.
#[test]
fn refraction_near_the_critical_angle() {
    let critical = 41.8103148957786_f64.to_radians();
    let t = refract(arriving((critical - 1e-6).to_degrees()), DVec3::Y, 1.5, 1.0).unwrap();
    // The angle above has 15 digits, which leaves 8 of the cosine.
    assert!((-t.y - 1.495348698e-3).abs() < 2e-10, "{:e}", -t.y);
}

/// n₁ (N × V) = n₂ (N × T), |T| = 1, and T in the plane of V and N, for all angles and indices.
#[test]
fn descartes_as_a_vector_identity() {
    let mut random = Random::new(67);
    let mut transmitted = 0;
    for _ in 0..100_000 {
        let n = random.direction();
        let mut v = random.direction();
        v *= -v.dot(n).signum();
        let (n1, n2) = (random.between(1.0, 2.5), random.between(1.0, 2.5));
        let Some(t) = refract(v, n, n1, n2) else {
            let sine = n.cross(v).length();
            assert!(n1 * sine > n2 * (1.0 - 1e-15), "total reflection at n1 sin = {}", n1 * sine);
            continue;
        };
        transmitted += 1;
        assert!((n1 * n.cross(v) - n2 * n.cross(t)).length() < 1e-14);
        assert!((t.length() - 1.0).abs() < 1e-14, "{:e}", t.length() - 1.0);
        assert!(t.dot(n) <= 0.0, "T is on the other side");
    }
    assert!(transmitted > 50_000);
}

/// Through a slab of n = 1.5 and thickness 1 at 45 degrees the ray leaves parallel, shifted by
/// sin(α − β) / cos β = 0.329142308177320.
#[test]
fn a_parallel_slab_shifts_a_ray() {
    let v = arriving(45.0);
    let inside = refract(v, DVec3::Y, 1.0, 1.5).unwrap();
    let out = refract(inside, DVec3::Y, 1.5, 1.0).unwrap();
    assert!((out - v).length() < 4.0 * f64::EPSILON);
    let exit = inside / -inside.y;
    let shift = exit.cross(v).length();
    assert!((shift - 0.329142308177320).abs() < 1e-14, "{shift}");
}

/// A ray at height ½ enters a glass ball of radius 1 and n = 1.5, leaves it behind and crosses the
/// axis at 1.39157294888931 from the centre.
#[test]
fn a_glass_ball_focuses() {
    let meet = |origin: DVec3, d: DVec3| {
        let b = origin.dot(d);
        origin + d * (-b + (b * b - origin.length_squared() + 1.0).sqrt())
    };
    let entry = DVec3::new(-(0.75_f64.sqrt()), 0.5, 0.0);
    let inside = refract(DVec3::X, entry, 1.0, 1.5).unwrap();
    let exit = meet(entry, inside);
    let out = refract(inside, -exit, 1.5, 1.0).unwrap();
    let crossing = exit.x - exit.y * out.x / out.y;
    assert!((crossing - 1.39157294888931).abs() < 1e-14, "{crossing}");
}

/// The primary rainbow: one inner reflection in a drop; the deflection has its minimum 42 degrees off
/// the antisolar direction.
#[test]
fn the_primary_rainbow_stands_at_42_degrees() {
    for (index, wanted) in [(1.333, 42.0781073802436), (4.0 / 3.0, 42.0296588656977)] {
        let bow = |height: f64| {
            let entry = DVec3::new(-(1.0 - height * height).sqrt(), height, 0.0);
            let inside = refract(DVec3::X, entry, 1.0, index).unwrap();
            let back = entry - 2.0 * entry.dot(inside) * inside;
            let turned = reflect(inside, -back);
            let exit = back - 2.0 * back.dot(turned) * turned;
            let out = refract(turned, -exit, index, 1.0).unwrap();
            DVec2::new(-out.x, out.y).angle_to(DVec2::X).abs().to_degrees()
        };
        // Ternary search for the largest bow angle over the height of entry.
        let (mut low, mut high) = (0.5, 0.999);
        for _ in 0..200 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if bow(a) < bow(b) { low = a } else { high = b }
        }
        assert!((bow(low) - wanted).abs() < 1e-10, "{}", bow(low));
    }
}
