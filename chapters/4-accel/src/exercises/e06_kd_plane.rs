//! E4.6: a ray and the plane of a kd-tree.

use lancer_accel::Sides;
use lancer_core::Rgb;
use lancer_core::geometry::Interval;
use lancer_core::image::{Image, ImageSize};
use lancer_exercise::{Card, Check, Exercise, Mismatch, Shown, Solution, Verdict, ensure, slips};
use lancer_lesson::picture::painted;

use super::Subject;
use super::reference::plane_sides;

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E4.6",
        name: "kd-plane",
        title: "A ray and the plane of a kd-tree",
        slide: "Subdivision spatiale régulière et irrégulière",
        stub: include_str!("../../stubs/e06_kd_plane.rs"),
        functions: &["plane_sides"],
        minutes: 20,
        predict: "each pixel is a ray, its origin to the right and its direction upwards, and blue, red and \
                  green say near, far and both: which shape is green, and what happens in the row of direction \
                  0?",
        vary: "answer Near wherever the plane is not *inside* the part, ends excluded: which pixels change, \
               and which triangle does a ray lose then?",
        hints: [
            "The ray is in the plane at one t. Before it is on the near side, after it on the far side; compare \
             that t with the two ends of the part.",
            "t = (split − origin) / direction. t > inside.max: Near. t < inside.min: Far. Otherwise both, near up \
             to t, far from t. With direction 0 the quotient is ∞, −∞, or, in the plane, NaN.",
            "`let t = (split - origin) * (1.0 / direction);` compare first with `>` and `<`, which a NaN fails, \
             then `let (mut near, mut far) = (inside, inside); if t < near.max { near.max = t; }` and the same \
             for `far.min`.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e06_kd_plane.rs"),
            file: "crates/accel/src/kd/sides.rs",
            item: "pub(super) fn divide",
            notice: "the course's ray is thick, by what it may err: it reaches a plane before it leaves it",
        },
    },
    checks: &[
        Check { name: "the plane inside the part", run: both },
        Check { name: "the plane beyond the part, or before it", run: one },
        Check { name: "parallel to the plane", run: parallel },
        Check { name: "at the ends of the part", run: ends },
        Check { name: "in the plane", run: in_plane },
    ],
    slips: slips! {
        plane_sides(split, o, d, inside):
        "both sides are always visited: then the tree saves nothing":
            "the plane beyond the part, or before it" catches {
                let t = (split - o) / d;
                parts(inside, inside.max.min(t), inside.min.max(t))
            };
        "near and far are swapped: before the plane the ray is on the near side":
            "the plane beyond the part, or before it" catches
                match plane_sides(split, o, d, inside) {
                    Sides::Near => Sides::Far,
                    Sides::Far => Sides::Near,
                    both => both,
                };
        "the parts are not cut at the plane: the far side is entered at t, and the near one left there":
            "the plane inside the part" catches
                if_both(plane_sides(split, o, d, inside), uncut(inside));
        "the t of the plane is the distance: divide by the direction":
            "the plane inside the part" catches
                plane_sides(split, o, 1.0_f64.copysign(d), inside);
        "the ends are excluded: a ray that meets the plane just there loses what lies in the plane":
            "at the ends of the part" catches match (split - o) / d {
                t if t >= inside.max => Sides::Near,
                t if t <= inside.min => Sides::Far,
                _ => plane_sides(split, o, d, inside),
            };
        "a ray in the plane, where t is NaN, visits the near side only: it loses what is stored on the other":
            "in the plane" catches
                if d == 0.0 && split == o { Sides::Near } else { plane_sides(split, o, d, inside) };
        "a ray along the plane counts as meeting it: with direction 0 the other side is never reached":
            "parallel to the plane" catches
                if d == 0.0 { uncut(inside) } else { plane_sides(split, o, d, inside) };
        "in the plane t is NaN, and so are the parts: a comparison with NaN must leave them as they are":
            "in the plane" catches
                if_both(plane_sides(split, o, d, inside), cut(inside, (split - o) / d));
    },
    draw,
    explain: None,
};

/// Both sides, the near one up to a t and the far one from another.
fn parts(inside: Interval, end: f64, start: f64) -> Sides {
    Sides::Both { near: Interval { max: end, ..inside }, far: Interval { min: start, ..inside } }
}

fn cut(inside: Interval, t: f64) -> Sides {
    parts(inside, t, t)
}

fn uncut(inside: Interval) -> Sides {
    parts(inside, inside.max, inside.min)
}

/// Another answer where the right one is both.
fn if_both(right: Sides, other: Sides) -> Sides {
    if matches!(right, Sides::Both { .. }) { other } else { right }
}

fn part(inside: Interval) -> String {
    format!("{} to {}", inside.min.shown(), inside.max.shown())
}

fn text(sides: Sides) -> String {
    match sides {
        Sides::Near => "near".to_owned(),
        Sides::Far => "far".to_owned(),
        Sides::Both { near, far } => format!("near {}, then far {}", part(near), part(far)),
    }
}

const INSIDE: Interval = Interval { min: 0.5, max: 4.0 };

fn compare(subject: &Subject, [split, origin, direction]: [f64; 3], wanted: Sides) -> Verdict {
    let got = (subject.plane_sides)(split, origin, direction, INSIDE);
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-12;
    let same_part = |a: Interval, b: Interval| close(a.min, b.min) && close(a.max, b.max);
    let is_right = match (got, wanted) {
        (Sides::Both { near, far }, Sides::Both { near: a, far: b }) => {
            same_part(near, a) && same_part(far, b)
        }
        _ => got == wanted,
    };
    let [split, origin, direction] = [split, origin, direction].map(|x| x.shown());
    let inside = part(INSIDE);
    let case = format!("plane at {split}, origin {origin}, direction {direction}, t from {inside}");
    ensure(is_right, || Mismatch::new(case, text(got), text(wanted)))
}

fn both(subject: &Subject) -> Verdict {
    compare(subject, [3.0, -1.0, 2.0], cut(INSIDE, 2.0))?;
    compare(subject, [3.0, 9.0, -2.0], cut(INSIDE, 3.0))
}

fn one(subject: &Subject) -> Verdict {
    compare(subject, [3.0, -7.0, 2.0], Sides::Near)?;
    compare(subject, [3.0, 2.5, 2.0], Sides::Far)?;
    compare(subject, [3.0, 5.0, 2.0], Sides::Far)?;
    compare(subject, [3.0, 13.0, -2.0], Sides::Near)?;
    compare(subject, [3.0, 1.0, -2.0], Sides::Far)
}

/// For 0 near is below, for −0 above.
fn parallel(subject: &Subject) -> Verdict {
    compare(subject, [3.0, 1.0, 0.0], Sides::Near)?;
    compare(subject, [3.0, 7.0, 0.0], Sides::Far)?;
    compare(subject, [3.0, 7.0, -0.0], Sides::Near)?;
    compare(subject, [3.0, 1.0, -0.0], Sides::Far)
}

fn ends(subject: &Subject) -> Verdict {
    compare(subject, [3.0, -5.0, 2.0], cut(INSIDE, 4.0))?;
    compare(subject, [3.0, 2.0, 2.0], cut(INSIDE, 0.5))
}

fn in_plane(subject: &Subject) -> Verdict {
    for zero in [0.0, -0.0] {
        compare(subject, [3.0, 3.0, zero], uncut(INSIDE))?;
    }
    Ok(())
}

const SIDE: u32 = 161;

/// All rays with origins from −4 to 4 and directions from −2 to 2 for a plane at 0: blue is near, red far,
/// green both, the lighter the earlier the plane is met. The middle row has direction 0, the middle column
/// starts in the plane.
fn draw(subject: &Subject) -> Image {
    let middle = 0.5 * f64::from(SIDE);
    painted(ImageSize::new(SIDE, SIDE), |x, y| {
        let (origin, direction) = ((x - middle) / 20.0, (middle - y) / 40.0);
        match (subject.plane_sides)(0.0, origin, direction, INSIDE) {
            Sides::Near => Rgb::new(0.1, 0.2, 0.7),
            Sides::Far => Rgb::new(0.7, 0.15, 0.1),
            Sides::Both { near, far } => Rgb::new(0.9 - far.min / 5.0, 1.0 - near.max / 10.0, 0.3),
        }
    })
}
