//! A box that a ray touches is never missed; the exact answers come with [`HardBox`].

use glam::DVec3;
use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};
use lancer_core::sampling::Uniform;
use lancer_lesson::hard_boxes::{Class, HardBox};
use lancer_lesson::naive::min_max_box;

fn misses(rays: usize, enters: impl Fn(&HardBox) -> bool) -> Vec<(&'static str, usize)> {
    Class::ALL
        .iter()
        .map(|&(class, name)| {
            let mut random = Uniform::new(3, 0, 0);
            let boxes = (0..rays).map(|_| HardBox::new(class, &mut random));
            (name, boxes.filter(|hard| !enters(hard)).count())
        })
        .collect()
}

fn enters(bounds: &Bounds3, ray: &Ray) -> bool {
    Slabs::new(ray).enter(bounds.min, bounds.max, Interval::POSITIVE).is_some()
}

#[test]
fn no_box_is_missed_in_any_of_thirteen_classes() {
    // Rays that start in the touched point itself as well, into the box or away from it.
    let ours = misses(100_000, |hard| {
        let starts = [hard.direction, -hard.direction].map(|d| Ray::new(hard.point, d));
        enters(&hard.bounds, &hard.ray()) && starts.iter().all(|ray| enters(&hard.bounds, ray))
    });
    for (class, missed) in ours {
        assert_eq!(missed, 0, "{class}");
    }
}

/// The generator's promise: origin + t · direction is the point without any rounding. The product is split
/// into two numbers, and the sum is exact if either of its terms can be taken away again. Only the
/// denormal's way is lost.
#[test]
fn hard_boxes_are_touched_exactly() {
    for (class, name) in Class::ALL {
        let mut random = Uniform::new(4, 0, 0);
        for _ in 0..10_000 {
            let hard = HardBox::new(class, &mut random);
            let HardBox { bounds: Bounds3 { min, max }, point, direction, t } = hard;
            assert!((point.cmpge(min) & point.cmple(max)).all(), "{name}");
            let origin = hard.ray().origin;
            let way = t * direction;
            let rest = direction.mul_add(DVec3::splat(t), -way);
            let sum = origin + way;
            let exact = (sum - origin).cmpeq(way) & (sum - way).cmpeq(origin);
            let touched = exact & (sum + rest).cmpeq(point);
            let lost = way.abs().cmplt(DVec3::splat(f64::MIN_POSITIVE));
            assert!((touched | lost).all(), "{name}: {hard:?}");
        }
    }
}

/// `f64::min` and `max` drop the NaN of 0 · ∞ and keep the wrong operand; without padding, corners get
/// lost to rounding.
#[test]
fn the_textbook_test_misses_boxes() {
    let naive = misses(10_000, |hard| {
        let ray = hard.ray();
        min_max_box(&hard.bounds, ray.origin, DVec3::ONE / ray.direction).is_some()
    });
    for class in ["corner", "in a face plane +0", "in a face plane −0"] {
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
