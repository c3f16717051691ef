//! E4.1: a ray and a box.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Bounds3, Interval, Ray};
use lancer_core::image::{Image, ImageSize};
use lancer_core::sampling::Uniform;
use lancer_exercise::{
    Card, Check, Exercise, Mismatch, Shown, Solution, Verdict, ensure, slips, within,
};
use lancer_lesson::hard_boxes::{Class, HardBox};
use lancer_lesson::picture::painted;

use super::Subject;
use super::reference::slab_test;

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E4.1",
        name: "slab-test",
        title: "A ray and a box",
        slide: "Hiérarchie de volumes englobants",
        stub: include_str!("../../stubs/e01_slab_test.rs"),
        functions: &["slab_test"],
        minutes: 20,
        predict: "the picture looks straight down on towers, along rays that partly run in their walls: what \
                  is there to see if 0 · ∞ is compared carelessly?",
        vary: "write the loop with `near.max(t0.min(t1))` and `far.min(t0.max(t1))`, and draw again: what do \
               the rays in the walls see, and why?",
        hints: [
            "A box is what three slabs have in common. In each slab the ray is from one t to another; what is \
             left of the range after all three is in the box.",
            "t = (plane − o) / d. A ray with d < 0, or d = −0, meets the larger plane first. A ray in a plane \
             gives 0 · ∞, which is no number: it must leave the range as it is.",
            "For each axis: `let inverse = 1.0 / d; let (first, last) = if d.is_sign_negative() { (max, min) } \
             else { (min, max) };` then `let a = (first - o) * inverse; if a > near { near = a; }` and the same \
             for the smaller far, `(last - o) * inverse * FAR`. A comparison with NaN is false.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e01_slab_test.rs"),
            file: "crates/core/src/geometry/bounds.rs",
            item: "pub fn cross",
            notice: "the near t is rounded down as well, for hits that round below it, and a reciprocal that \
                     overflows is made NaN: such an axis does not count",
        },
    },
    checks: &[
        Check { name: "from the front", run: front },
        Check { name: "past the box", run: past },
        Check { name: "against the axes", run: against },
        Check { name: "from inside", run: inside },
        Check { name: "behind the ray, or beyond its range", run: out_of_range },
        Check { name: "parallel to a slab, outside and inside it", run: parallel },
        Check { name: "in a face", run: in_a_face },
        Check { name: "no corner is missed", run: corners },
    ],
    slips: slips! {
        slab_test(bounds, ray, range):
        "the planes are taken as min first, max last: a ray with a negative direction meets max first":
            "against the axes" catches
                clip(bounds, ray, range, |o, d, min, max| [(min - o) / d, (max - o) / d * FAR]);
        "`min` and `max` sort the two planes; for a ray in a face 0 · ∞ = NaN, and they keep the other operand: \
         the slab becomes thin, and the ray is lost":
            "in a face" catches clip(bounds, ray, range, |o, d, min, max| {
                let (a, b) = ((min - o) / d, (max - o) / d);
                [a.min(b), a.max(b) * FAR]
            });
        "the range is not looked at: boxes behind the ray, or beyond its end, count":
            "behind the ray, or beyond its range" catches
                slab_test(bounds, ray, LINE).map(|enter| enter.max(range.min));
        "the far t is not widened: rounding makes a ray that touches a corner miss the box":
            "no corner is missed" catches clip(bounds, ray, range, |o, d, min, max| {
                let (first, last) = if d.is_sign_negative() { (max, min) } else { (min, max) };
                [(first - o) * (1.0 / d), (last - o) * (1.0 / d)]
            });
        "the answer is where the ray leaves the box, not where it enters":
            "from the front" catches {
                slab_test(bounds, ray, range)?;
                let back = Ray::new(ray.origin, -ray.direction);
                slab_test(bounds, &back, LINE).map(|t| (-t).min(range.max))
            };
        "an axis with d = 0 is left out: a ray beside the slab is taken for one inside it":
            "parallel to a slab, outside and inside it" catches {
                let along = ray.direction.cmpeq(DVec3::ZERO);
                let min = DVec3::select(along, ray.origin - 1.0, bounds.min);
                let max = DVec3::select(along, ray.origin + 1.0, bounds.max);
                slab_test(&Bounds3 { min, max }, ray, range)
            };
    },
    draw,
    explain: None,
};

const FAR: f64 = 1.0 + 4.0 * f64::EPSILON;
const LINE: Interval = Interval { min: f64::NEG_INFINITY, max: f64::INFINITY };

/// A slab test by what it says of each slab, from where it begins to where it ends.
fn clip(
    bounds: &Bounds3,
    ray: &Ray,
    range: Interval,
    slab: impl Fn(f64, f64, f64, f64) -> [f64; 2],
) -> Option<f64> {
    let (mut near, mut far) = (range.min, range.max);
    for k in 0..3 {
        let [a, b] = slab(ray.origin[k], ray.direction[k], bounds.min[k], bounds.max[k]);
        if a > near {
            near = a;
        }
        if b < far {
            far = b;
        }
    }
    (near <= far).then_some(near)
}

const BOX: Bounds3 = Bounds3 { min: DVec3::new(2.0, -1.0, 3.0), max: DVec3::new(4.0, 5.0, 7.0) };

fn case(bounds: &Bounds3, ray: &Ray, range: Interval) -> String {
    let Bounds3 { min, max } = bounds;
    format!(
        "box {} to {}; {}, t from {} to {}",
        min.shown(),
        max.shown(),
        ray.shown(),
        range.min,
        range.max
    )
}

fn compare(subject: &Subject, ray: [[f64; 3]; 2], range: Interval, wanted: Option<f64>) -> Verdict {
    let [origin, direction] = ray.map(DVec3::from);
    let ray = Ray::new(origin, direction);
    let got = (subject.slab_test)(&BOX, &ray, range);
    within(1e-9, || case(&BOX, &ray, range), &got, &wanted)
}

const POSITIVE: Interval = Interval::POSITIVE;

/// The planes are reached at t = 1.5, 1 and 1.75, and left at 2.5, 4 and 2.75.
fn front(subject: &Subject) -> Verdict {
    compare(subject, [[-1.0, -3.0, -4.0], [2.0, 2.0, 4.0]], POSITIVE, Some(1.75))
}

/// x is left at t = 2.5, before z is reached at 3.5.
fn past(subject: &Subject) -> Verdict {
    compare(subject, [[-1.0, -3.0, -4.0], [2.0, 2.0, 2.0]], POSITIVE, None)
}

/// The larger planes are reached at t = 1.5, 1 and 0.8, the smaller ones left at 2.5, 4 and 1.6.
fn against(subject: &Subject) -> Verdict {
    compare(subject, [[7.0, 7.0, 11.0], [-2.0, -2.0, -5.0]], POSITIVE, Some(1.5))?;
    compare(subject, [[7.0, 7.0, 11.0], [-2.0, -2.0, -8.0]], POSITIVE, None)
}

fn inside(subject: &Subject) -> Verdict {
    compare(subject, [[3.0, 1.0, 5.0], [1.0, -2.0, 0.5]], POSITIVE, Some(0.0))?;
    let later = Interval { min: 0.25, max: 9.0 };
    compare(subject, [[3.0, 1.0, 5.0], [1.0, -2.0, 0.5]], later, Some(0.25))
}

fn out_of_range(subject: &Subject) -> Verdict {
    compare(subject, [[5.0, 7.0, 9.0], [1.0, 2.0, 1.5]], POSITIVE, None)?;
    let short = Interval::up_to(1.5);
    compare(subject, [[-1.0, -3.0, -4.0], [2.0, 2.0, 4.0]], short, None)
}

fn parallel(subject: &Subject) -> Verdict {
    for zero in [0.0, -0.0] {
        compare(subject, [[5.0, 1.0, 1.0], [zero, 0.5, 1.0]], POSITIVE, None)?;
        compare(subject, [[1.0, 1.0, 1.0], [zero, 0.5, 1.0]], POSITIVE, None)?;
        compare(subject, [[3.0, 1.0, 1.0], [zero, 0.5, 1.0]], POSITIVE, Some(2.0))?;
    }
    Ok(())
}

fn in_a_face(subject: &Subject) -> Verdict {
    for zero in [0.0, -0.0] {
        compare(subject, [[2.0, 1.0, 1.0], [zero, 0.5, 1.0]], POSITIVE, Some(2.0))?;
        compare(subject, [[4.0, 1.0, 1.0], [zero, 0.5, 1.0]], POSITIVE, Some(2.0))?;
    }
    Ok(())
}

/// Rays that pass through a corner exactly: the box is met, however the quotients are rounded.
fn corners(subject: &Subject) -> Verdict {
    for class in [Class::Corner, Class::CornerFromAfar] {
        let mut random = Uniform::new(41, 0, 0);
        for _ in 0..2000 {
            let hard = HardBox::new(class, &mut random);
            let (bounds, ray) = (hard.bounds, hard.ray());
            let met = (subject.slab_test)(&bounds, &ray, POSITIVE);
            // Through a corner into the box, the ray enters there; along its outside it touches there.
            let wanted = slab_test(&bounds, &ray, POSITIVE);
            ensure(met.is_some(), || {
                let text = case(&bounds, &ray, POSITIVE) + " (it passes through a corner)";
                Mismatch::new(text, "None", wanted.shown())
            })?;
        }
    }
    Ok(())
}

/// Towers seen from above, one direction of zeros on the left, the other on the right; the lighter the
/// higher. The walls stand where rays are.
fn draw(subject: &Subject) -> Image {
    let tower = |column: u32, row: u32| {
        let low = DVec3::new(f64::from(column), 0.0, f64::from(row)) * 16.0 + 3.5;
        let height = 10.0 + f64::from((7 * column + 5 * row) % 11);
        Bounds3 { min: low.with_y(0.0), max: (low + 9.0).with_y(height) }
    };
    let towers: Vec<Bounds3> =
        (0..8).flat_map(|column| (0..6).map(move |row| tower(column, row))).collect();
    painted(ImageSize::new(128, 96), |x, y| {
        let zero = if x < 64.0 { 0.0 } else { -0.0 };
        let ray = Ray::new(DVec3::new(x, 30.0, y), DVec3::new(zero, -1.0, -zero));
        let enters = towers.iter().filter_map(|b| (subject.slab_test)(b, &ray, POSITIVE));
        let t = enters.fold(30.0, f64::min);
        let height = (30.0 - t) / 22.0;
        Rgb::new(0.05 + 0.9 * height, 0.05 + 0.7 * height, 0.1 + 0.3 * height)
    })
}
