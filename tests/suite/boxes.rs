//! A box that a ray touches is never missed. The inputs are dyadic, so that the exact answer is known:
//! every ray passes through the chosen point of the box at t = k without any rounding.

use glam::DVec3;
use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};

use crate::random::Random;

/// Where on the box a ray passes, and how it runs there.
const CLASSES: [&str; 10] = [
    "corner",
    "edge",
    "face",
    "in a face plane, +0",
    "in a face plane, -0",
    "origin on a face plane",
    "origin inside",
    "corner at 1e6",
    "point box",
    "flat box",
];

/// A box and a ray that meets it.
fn case(class: &str, random: &mut Random) -> (Bounds3, Ray) {
    let grid = |random: &mut Random, size| {
        DVec3::new(random.integer(size), random.integer(size), random.integer(size))
    };
    let mut min = grid(random, 1 << 12) / 64.0;
    let mut size = (grid(random, 1 << 10).abs() + 1.0) / 64.0;
    if class == "corner at 1e6" {
        min += 1e6;
    }
    match class {
        "point box" => size = DVec3::ZERO,
        "flat box" => size[random.below(3)] = 0.0,
        _ => (),
    }
    let max = min + size;
    let mut direction = (grid(random, 1 << 12) + 0.5) / 128.0;
    let corner = |random: &mut Random, axis: usize| {
        if random.unit() < 0.5 { min[axis] } else { max[axis] }
    };
    let inside = |random: &mut Random, axis: usize| {
        min[axis] + size[axis] * (random.below(1025) as f64 / 1024.0)
    };
    // How many of the coordinates lie on a plane of the box: 3 at a corner, 2 on an edge, 1 on a face.
    let fixed = match class {
        "edge" => 2,
        "origin inside" => 0,
        "corner" | "corner at 1e6" | "point box" => 3,
        _ => 1,
    };
    let first = random.below(3);
    let mut point = DVec3::ZERO;
    for k in 0..3 {
        let axis = (first + k) % 3;
        point[axis] = if k < fixed { corner(random, axis) } else { inside(random, axis) };
    }
    let steps = match class {
        "origin inside" | "origin on a face plane" => 0.0,
        _ => random.below(64) as f64,
    };
    match class {
        "in a face plane, +0" => direction[first] = 0.0,
        "in a face plane, -0" => direction[first] = -0.0,
        _ => (),
    }
    (Bounds3 { min, max }, Ray::new(point - steps * direction, direction))
}

fn misses(rays: usize, enters: impl Fn(&Bounds3, &Ray) -> bool) -> Vec<(&'static str, usize)> {
    CLASSES
        .iter()
        .map(|&class| {
            let mut random = Random::new(3);
            let missed = (0..rays)
                .filter(|_| {
                    let (bounds, ray) = case(class, &mut random);
                    !enters(&bounds, &ray)
                })
                .count();
            (class, missed)
        })
        .collect()
}

#[test]
fn no_box_is_missed_in_any_of_ten_classes() {
    let ours = misses(100_000, |bounds, ray| {
        Slabs::new(ray).enter(bounds.min, bounds.max, Interval::POSITIVE).is_some()
    });
    for (class, missed) in ours {
        assert_eq!(missed, 0, "{class}");
    }
}

/// `f64::min` and `max` drop the NaN of 0 · ∞ and keep the wrong operand; without padding, corners get
/// lost to rounding.
#[test]
fn the_textbook_test_misses_boxes() {
    let naive = misses(10_000, |bounds, ray| {
        let inverse = DVec3::ONE / ray.direction;
        let a = (bounds.min - ray.origin) * inverse;
        let b = (bounds.max - ray.origin) * inverse;
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            near = near.max(a[axis].min(b[axis]));
            far = far.min(a[axis].max(b[axis]));
        }
        near <= far
    });
    for class in ["corner", "in a face plane, +0", "in a face plane, -0"] {
        let missed = naive.iter().find(|(name, _)| *name == class).unwrap().1;
        assert!(missed > 100, "{class}: only {missed} of 10 000 missed");
    }
}

/// Inputs that other well-known forms of the test miss.
#[test]
fn known_hard_boxes_are_entered() {
    let v = DVec3::new;
    let cases = [
        (
            v(5.125, -3.5, 9.234375),
            v(9.28125, 7.046875, 9.8125),
            v(40.0, -3.5, 9.31472),
            v(-1.0, 0.0, 0.0),
        ),
        (
            v(5.125, -3.5, 9.234375),
            v(9.28125, 7.046875, 9.8125),
            v(40.0, -3.5, 9.31472),
            v(-1.0, -0.0, -0.0),
        ),
        (
            v(-3.765625, 6.40625, -8.96875),
            v(7.671875, 6.65625, -6.5),
            v(7.671875, -40.0, -6.7012815),
            v(0.0, 1.0, 0.0),
        ),
    ];
    for (min, max, origin, direction) in cases {
        let slabs = Slabs::new(&Ray::new(origin, direction));
        assert!(slabs.enter(min, max, Interval::POSITIVE).is_some(), "{origin} {direction}");
    }
}

#[test]
fn boxes_beside_or_behind_a_ray_are_not_entered() {
    let slabs = Slabs::new(&Ray::new(DVec3::ZERO, DVec3::X));
    let unit = |center: DVec3| (center - 0.5, center + 0.5);
    for center in [DVec3::new(3.0, 1.0, 0.0), DVec3::new(-3.0, 0.0, 0.0)] {
        let (min, max) = unit(center);
        assert_eq!(slabs.enter(min, max, Interval::POSITIVE), None);
    }
    let (min, max) = unit(DVec3::new(3.0, 0.0, 0.0));
    assert_eq!(slabs.enter(min, max, Interval::up_to(2.0)), None);
    assert_eq!(slabs.enter(Bounds3::EMPTY.min, Bounds3::EMPTY.max, Interval::POSITIVE), None);
}
