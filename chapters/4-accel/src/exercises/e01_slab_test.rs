//! E4.1: a ray and a box.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Bounds3, Interval, Ray};
use lancer_core::image::{Image, ImageSize};
use lancer_core::sampling::Uniform;
use lancer_exercise::{Card, Check, Exercise, Shown, Solution, Verdict, slips, within};
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
        Check { name: "flat boxes, and boxes that are only touched", run: touched },
        Check { name: "by a hair past the box, or into it", run: by_a_hair },
        Check { name: "no corner is missed", run: corners },
        Check { name: "every ray of the picture", run: towers_from_above },
    ],
    slips: slips! {
        slab_test(bounds, ray, range):
        "the planes are taken as min first, max last: a ray with a negative direction meets max first":
            "against the axes" catches
                clip(bounds, ray, range, |o, d, min, max| [(min - o) / d, (max - o) / d * FAR]);
        "a ray that runs in a face is lost. If you divide, one of its t is 0 · ∞ = NaN, and the slab must not begin \
         or end at the other: choose the two planes by the sign of the direction, and let a NaN change nothing. If you \
         compare with the planes, the planes belong to the box":
            "in a face" catches clip(bounds, ray, range, |o, d, min, max| {
                let (a, b) = ((min - o) / d, (max - o) / d);
                [a.min(b), a.max(b) * FAR]
            });
        "the two t are swapped if the first is larger; in a face one of them is NaN, and no comparison with NaN is \
         true: choose the planes by the sign of the direction, before any t is known":
            "in a face" catches clip(bounds, ray, range, |o, d, min, max| {
                let (a, b) = ((min - o) / d, (max - o) / d);
                if a > b { [b, a * FAR] } else { [a, b * FAR] }
            });
        "−0 is taken for a positive direction, but 1 / −0 is −∞: `d < 0.0` is false for it, ask \
         `d.is_sign_negative()`":
            "parallel to a slab, outside and inside it" catches clip(bounds, ray, range, |o, d, min, max| {
                let (first, last) = if d < 0.0 { (max, min) } else { (min, max) };
                [(first - o) / d, (last - o) / d * FAR]
            });
        "the range is not looked at: boxes behind the ray, or beyond its end, count":
            "behind the ray, or beyond its range" catches
                slab_test(bounds, ray, LINE).map(|enter| enter.max(range.min));
        "a ray that starts in the box gets a t before its range: begin with near = range.min, not −∞":
            "from inside" catches {
                slab_test(bounds, ray, range)?;
                slab_test(bounds, ray, LINE)
            };
        "the far t is not widened: rounding makes a ray that touches a corner miss the box":
            "no corner is missed" catches clip(bounds, ray, range, |o, d, min, max| {
                let (first, last) = in_order(d, min, max);
                [(first - o) * (1.0 / d), (last - o) * (1.0 / d)]
            });
        "something fixed is added to the far t, or taken from the near one: a ray that misses the box by less counts \
         as meeting it. The factor FAR is all that rounding needs, whatever the size of the box":
            "by a hair past the box, or into it" catches {
                let longer = Interval { max: range.max + 1e-3, ..range };
                let [near, far] = clipped(bounds, ray, longer, |o, d, min, max| {
                    let (first, last) = in_order(d, min, max);
                    [(first - o) / d, (last - o) / d * FAR + 1e-3]
                });
                (near <= far && near <= range.max).then_some(near)
            };
        "a box that the ray meets at one t only is left out: compare near with far by ≤, not by <":
            "flat boxes, and boxes that are only touched" catches {
                let [near, far] = clipped(bounds, ray, range, |o, d, min, max| {
                    let (first, last) = in_order(d, min, max);
                    [(first - o) / d, (last - o) / d * FAR]
                });
                (near < far).then_some(near)
            };
        "t is computed in `f32`, whose 24 bits cannot tell a ray that misses the box by little from one that meets \
         it: keep to `f64`":
            "by a hair past the box, or into it" catches clip(bounds, ray, range, |o, d, min, max| {
                let (first, last) = in_order(d, min, max);
                let t = |plane: f64| (plane as f32 - o as f32) / d as f32;
                [f64::from(t(first)), f64::from(t(last)) * FAR]
            });
        "the direction is made a unit vector: t counts in lengths of the direction as it is given":
            "from the front" catches
                slab_test(bounds, &Ray::new(ray.origin, ray.direction.normalize()), range);
        "the answer is where the ray leaves the box, not where it enters":
            "from the front" catches {
                slab_test(bounds, ray, range)?;
                let back = Ray::new(ray.origin, -ray.direction);
                slab_test(bounds, &back, LINE).map(|t| (-t).min(range.max))
            };
        "an axis with d = 0 is left out: a ray outside the slab is taken for one inside it":
            "parallel to a slab, outside and inside it" catches {
                let along = ray.direction.cmpeq(DVec3::ZERO);
                let min = DVec3::select(along, ray.origin - 1.0, bounds.min);
                let max = DVec3::select(along, ray.origin + 1.0, bounds.max);
                slab_test(&Bounds3 { min, max }, ray, range)
            };
    },
    own: |yours, reference| Subject { slab_test: yours.slab_test, ..reference },
    draw,
    explain: None,
};

const FAR: f64 = 1.0 + 4.0 * f64::EPSILON;
const LINE: Interval = Interval { min: f64::NEG_INFINITY, max: f64::INFINITY };

/// The plane of a slab that is met first, and the other.
fn in_order(d: f64, min: f64, max: f64) -> (f64, f64) {
    if d.is_sign_negative() { (max, min) } else { (min, max) }
}

/// What a test leaves of the range, by what it says of each slab, from where it begins to where it ends.
fn clipped(
    bounds: &Bounds3,
    ray: &Ray,
    range: Interval,
    slab: impl Fn(f64, f64, f64, f64) -> [f64; 2],
) -> [f64; 2] {
    (0..3).fold([range.min, range.max], |[near, far], k| {
        let [a, b] = slab(ray.origin[k], ray.direction[k], bounds.min[k], bounds.max[k]);
        // A NaN is neither more nor less.
        [if a > near { a } else { near }, if b < far { b } else { far }]
    })
}

/// A slab test by what it says of each slab.
fn clip(
    bounds: &Bounds3,
    ray: &Ray,
    range: Interval,
    slab: impl Fn(f64, f64, f64, f64) -> [f64; 2],
) -> Option<f64> {
    let [near, far] = clipped(bounds, ray, range, slab);
    (near <= far).then_some(near)
}

const BOX: Bounds3 = Bounds3 { min: DVec3::new(2.0, -1.0, 3.0), max: DVec3::new(4.0, 5.0, 7.0) };

/// The part of the plane x = 2 that is a face of [`BOX`].
const WALL: Bounds3 = Bounds3 { max: DVec3::new(2.0, 5.0, 7.0), ..BOX };

/// A box, a ray, its range, and what is special about them.
type Case<'a> = (&'a Bounds3, &'a Ray, Interval, &'a str);

fn text((Bounds3 { min, max }, ray, range, what): Case) -> String {
    let [min, max] = [min, max].map(Shown::shown);
    let (ray, from, to) = (ray.shown(), range.min, range.max);
    format!("{what}: box {min} to {max}; {ray}, t from {from} to {to}")
}

fn judge(subject: &Subject, case: Case, wanted: Option<f64>) -> Verdict {
    let (bounds, ray, range, _) = case;
    let got = (subject.slab_test)(bounds, ray, range);
    within(1e-9, || text(case), &got, &wanted)
}

/// Judges a ray that looks at [`BOX`].
fn compare(
    subject: &Subject,
    what: &str,
    [origin, direction]: [[f64; 3]; 2],
    range: Interval,
    wanted: Option<f64>,
) -> Verdict {
    let ray = Ray::new(origin.into(), direction.into());
    judge(subject, (&BOX, &ray, range, what), wanted)
}

const POSITIVE: Interval = Interval::POSITIVE;

/// The planes are reached at t = 1.5, 1 and 1.75, and left at 2.5, 4 and 2.75.
fn front(subject: &Subject) -> Verdict {
    let ray = [[-1.0, -3.0, -4.0], [2.0, 2.0, 4.0]];
    compare(subject, "into the box", ray, POSITIVE, Some(1.75))
}

/// x is left at t = 2.5, before z is reached at 3.5.
fn past(subject: &Subject) -> Verdict {
    let ray = [[-1.0, -3.0, -4.0], [2.0, 2.0, 2.0]];
    compare(subject, "past the box", ray, POSITIVE, None)
}

/// The larger planes are reached at t = 1.5, 1 and 0.8, the smaller ones left at 2.5, 4 and 1.6.
fn against(subject: &Subject) -> Verdict {
    let ray = |dz| [[7.0, 7.0, 11.0], [-2.0, -2.0, dz]];
    compare(subject, "towards smaller coordinates", ray(-5.0), POSITIVE, Some(1.5))?;
    compare(subject, "towards smaller coordinates", ray(-8.0), POSITIVE, None)
}

fn inside(subject: &Subject) -> Verdict {
    let ray = [[3.0, 1.0, 5.0], [1.0, -2.0, 0.5]];
    compare(subject, "the origin is in the box", ray, POSITIVE, Some(0.0))?;
    let later = Interval { min: 0.25, max: 9.0 };
    compare(subject, "the range begins in the box", ray, later, Some(0.25))
}

fn out_of_range(subject: &Subject) -> Verdict {
    let away = [[5.0, 7.0, 9.0], [1.0, 2.0, 1.5]];
    compare(subject, "the box is behind the ray", away, POSITIVE, None)?;
    let ray = [[-1.0, -3.0, -4.0], [2.0, 2.0, 4.0]];
    compare(subject, "the range ends before the box", ray, Interval::up_to(1.5), None)
}

/// The two zeros, which their sign tells apart.
const ZEROS: [f64; 2] = [0.0, -0.0];

fn parallel(subject: &Subject) -> Verdict {
    for zero in ZEROS {
        for (x, place, wanted) in
            [(5.0, "above", None), (1.0, "below", None), (3.0, "inside", Some(2.0))]
        {
            let what = format!("direction.x = {}, {place} the slab of x", zero.shown());
            compare(subject, &what, [[x, 1.0, 1.0], [zero, 0.5, 1.0]], POSITIVE, wanted)?;
        }
    }
    Ok(())
}

fn in_a_face(subject: &Subject) -> Verdict {
    for zero in ZEROS {
        for (bounds, x, place) in [
            (&BOX, 2.0, "in the face"),
            (&BOX, 4.0, "in the face"),
            (&WALL, 2.0, "in the flat box"),
        ] {
            let what = format!("direction.x = {}, {place} x = {x}", zero.shown());
            let ray = Ray::new(DVec3::new(x, 1.0, 1.0), DVec3::new(zero, 0.5, 1.0));
            judge(subject, (bounds, &ray, POSITIVE, &what), Some(2.0))?;
        }
    }
    Ok(())
}

/// Where near and far are one t.
fn touched(subject: &Subject) -> Verdict {
    let ray = |origin: [f64; 3]| Ray::new(origin.into(), DVec3::new(2.0, 1.5, 0.5));
    let (before, on, last) = (ray([-2.0, -1.0, 3.5]), ray([2.0, 1.0, 5.0]), ray([4.0, 1.0, 5.0]));
    let up_to_it = Interval::up_to(2.0);
    judge(subject, (&WALL, &before, POSITIVE, "through a flat box"), Some(2.0))?;
    judge(subject, (&WALL, &on, POSITIVE, "the origin is in the flat box"), Some(0.0))?;
    judge(subject, (&BOX, &last, POSITIVE, "the origin is in the last face"), Some(0.0))?;
    judge(subject, (&BOX, &before, up_to_it, "the range ends in the first face"), Some(2.0))
}

/// As in [`past`], but z is reached by so much after x is left, or before; in a large world and in a tiny one.
fn by_a_hair(subject: &Subject) -> Verdict {
    for (scale, bits) in
        [1.0, 2.0_f64.powi(-30)].into_iter().flat_map(|s| [8, 20, 34].map(|b| (s, b)))
    {
        let gap = 2.0_f64.powi(-bits);
        let Bounds3 { min, max } = BOX;
        let bounds = Bounds3 { min: scale * min, max: scale * max };
        for (late, wanted) in [(gap, None), (-gap, Some(scale * (2.5 - gap)))] {
            let origin = scale * DVec3::new(-1.0, -3.0, -2.0 - 2.0 * late);
            let ray = Ray::new(origin, DVec3::splat(2.0));
            let side = if late > 0.0 { "after" } else { "before" };
            let what = format!("z is reached {} {side} x is left", (scale * gap).shown());
            let got = (subject.slab_test)(&bounds, &ray, POSITIVE);
            within(1e-12 * scale, || text((&bounds, &ray, POSITIVE, &what)), &got, &wanted)?;
        }
    }
    Ok(())
}

/// The t at which a ray that passes through a corner enters the box. On an axis along which it goes into the box there,
/// the corner's plane is the first that it meets, else the last, and the first lies before by the box's size.
fn entered(HardBox { bounds, point, direction, t }: &HardBox) -> f64 {
    let firsts = (0..3).map(|k| {
        let goes_in = (point[k] == bounds.min[k]) == (direction[k] > 0.0);
        if goes_in { *t } else { t - (bounds.max[k] - bounds.min[k]) / direction[k].abs() }
    });
    firsts.fold(POSITIVE.min, f64::max)
}

/// Rays that pass through a corner exactly: the box is met, however the quotients are rounded.
fn corners(subject: &Subject) -> Verdict {
    for class in [Class::Corner, Class::CornerFromAfar] {
        let mut random = Uniform::new(41, 0, 0);
        for _ in 0..2000 {
            let hard = HardBox::new(class, &mut random);
            let (bounds, ray) = (hard.bounds, hard.ray());
            let met = (subject.slab_test)(&bounds, &ray, POSITIVE);
            let case = || text((&bounds, &ray, POSITIVE, "the ray passes through a corner"));
            within(1e-12 * hard.t, case, &met, &Some(entered(&hard)))?;
        }
    }
    Ok(())
}

const TOP: f64 = 30.0;

fn tower(column: u32, row: u32) -> Bounds3 {
    let low = DVec3::new(f64::from(column), 0.0, f64::from(row)) * 16.0 + 3.5;
    Bounds3 { min: low.with_y(0.0), max: (low + 9.0).with_y(height(column, row)) }
}

fn height(column: u32, row: u32) -> f64 {
    10.0 + f64::from((7 * column + 5 * row) % 11)
}

/// Rays straight down on towers, whose walls stand where rays are: what the picture shows of each.
struct City(Vec<Bounds3>);

impl City {
    const SIZE: ImageSize = ImageSize::new(128, 96);

    fn new() -> Self {
        Self((0..8).flat_map(|column| (0..6).map(move |row| tower(column, row))).collect())
    }

    /// One direction of zeros on the left, the other on the right.
    fn ray(x: f64, y: f64) -> Ray {
        let zero = if x < 64.0 { 0.0 } else { -0.0 };
        Ray::new(DVec3::new(x, TOP, y), DVec3::new(zero, -1.0, -zero))
    }

    /// The t of the first tower, at most that of the ground.
    fn seen(&self, subject: &Subject, ray: &Ray) -> f64 {
        let enters = self.0.iter().filter_map(|tower| (subject.slab_test)(tower, ray, POSITIVE));
        enters.fold(TOP, f64::min)
    }
}

/// Each tower covers 3.5 to 12.5 of 16 units, both walls included.
fn towers_from_above(subject: &Subject) -> Verdict {
    let city = City::new();
    let ImageSize { width, height: rows, .. } = City::SIZE;
    for (x, y) in (0..rows).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let ray = City::ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let is_on_tower = [x, y].iter().all(|at| (3..=12).contains(&(at % 16)));
        let wanted = if is_on_tower { TOP - height(x / 16, y / 16) } else { TOP };
        let case =
            || format!("towers from above, pixel {x} of row {y}; {}: the first t", ray.shown());
        within(1e-9, case, &city.seen(subject, &ray), &wanted)?;
    }
    Ok(())
}

/// Towers seen from above, the lighter the higher.
fn draw(subject: &Subject) -> Image {
    let city = City::new();
    painted(City::SIZE, |x, y| {
        let height = (TOP - city.seen(subject, &City::ray(x, y))) / 22.0;
        Rgb::new(0.05 + 0.9 * height, 0.05 + 0.7 * height, 0.1 + 0.3 * height)
    })
}
