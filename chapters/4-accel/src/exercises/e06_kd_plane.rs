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
        vary: "answer Near wherever the plane is not *inside* the part, ends excluded, and draw again: no ray of \
               the picture meets the plane just at an end; which check finds one, and what does such a ray lose?",
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
        Check { name: "by a hair before the ends, or beyond them", run: by_a_hair },
        Check { name: "in the plane", run: in_plane },
        Check { name: "every ray of the picture", run: all_rays },
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
        "something fixed is added at the ends: a ray that stays on one side visits both":
            "by a hair before the ends, or beyond them" catches {
                let Interval { min, max } = inside;
                match (split - o) / d {
                    t if t >= min - 1e-3 && t <= max + 1e-3 => parts(inside, t.min(max), t.max(min)),
                    _ => plane_sides(split, o, d, inside),
                }
            };
        "t is computed in `f32`, whose 24 bits cannot tell what is just beyond an end: keep to `f64`":
            "by a hair before the ends, or beyond them" catches match f64::from(((split - o) / d) as f32) {
                t if t >= inside.min && t <= inside.max => cut(inside, t),
                _ => plane_sides(split, o, d, inside),
            };
        "near is the lower side whatever the direction: it is where the ray comes from":
            "the plane inside the part" catches match plane_sides(split, o, d, inside) {
                right if d >= 0.0 => right,
                Sides::Near => Sides::Far,
                Sides::Far => Sides::Near,
                Sides::Both { near, far } => Sides::Both { near: far, far: near },
            };
        "a plane behind the origin counts as not met yet: the ray is beyond it, on the far side":
            "the plane beyond the part, or before it" catches
                if (split - o) / d < 0.0 { Sides::Near } else { plane_sides(split, o, d, inside) };
        "−0 is taken for 0, but comes from above: ask `direction.is_sign_negative()`":
            "parallel to the plane" catches
                plane_sides(split, o, if d == 0.0 { 0.0 } else { d }, inside);
        "a ray along the plane always visits the near side: it may run on the far one":
            "parallel to the plane" catches
                if d == 0.0 && split != o { Sides::Near } else { plane_sides(split, o, d, inside) };
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
    own: |yours, reference| Subject { plane_sides: yours.plane_sides, ..reference },
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

/// Judges what is visited by a ray: the plane, the ray's origin and direction, and the part.
fn judge(
    subject: &Subject,
    what: &str,
    ([split, origin, direction], inside): ([f64; 3], Interval),
    wanted: Sides,
) -> Verdict {
    let got = (subject.plane_sides)(split, origin, direction, inside);
    let is_close = |a: Interval, b: Interval| {
        Shown::distance(&(a.min, a.max), &(b.min, b.max)) <= 1e-12 * b.min.abs().max(1.0)
    };
    let is_right = match (got, wanted) {
        (Sides::Both { near, far }, Sides::Both { near: a, far: b }) => {
            is_close(near, a) && is_close(far, b)
        }
        _ => got == wanted,
    };
    let [split, origin, direction] = [split, origin, direction].map(|x| x.shown());
    let case = format!(
        "{what}: plane at {split}, origin {origin}, direction {direction}, t from {}",
        part(inside)
    );
    ensure(is_right, || Mismatch::new(case, text(got), text(wanted)))
}

fn compare(subject: &Subject, what: &str, ray: [f64; 3], wanted: Sides) -> Verdict {
    judge(subject, what, (ray, INSIDE), wanted)
}

fn both(subject: &Subject) -> Verdict {
    compare(subject, "through the plane, upwards", [3.0, -1.0, 2.0], cut(INSIDE, 2.0))?;
    compare(subject, "through the plane, downwards", [3.0, 9.0, -2.0], cut(INSIDE, 3.0))?;
    let all = Interval::POSITIVE;
    judge(subject, "a part without end", ([3.0, -1.0, 2.0], all), cut(all, 2.0))
}

fn one(subject: &Subject) -> Verdict {
    compare(subject, "the plane is met after the part", [3.0, -7.0, 2.0], Sides::Near)?;
    compare(subject, "the plane is met before the part", [3.0, 2.5, 2.0], Sides::Far)?;
    compare(subject, "the plane is behind the ray", [3.0, 5.0, 2.0], Sides::Far)?;
    compare(subject, "the plane is met after the part", [3.0, 13.0, -2.0], Sides::Near)?;
    compare(subject, "the plane is behind the ray", [3.0, 1.0, -2.0], Sides::Far)
}

/// The two zeros, which their sign tells apart.
const ZEROS: [f64; 2] = [0.0, -0.0];

/// For 0 near is below, for −0 above.
fn parallel(subject: &Subject) -> Verdict {
    let sides = [[Sides::Near, Sides::Far], [Sides::Far, Sides::Near]];
    for (zero, [below, above]) in ZEROS.into_iter().zip(sides) {
        for (place, origin, wanted) in [("below", 1.0, below), ("above", 7.0, above)] {
            let what = format!("along the plane, {place} it, direction {}", zero.shown());
            compare(subject, &what, [3.0, origin, zero], wanted)?;
        }
    }
    Ok(())
}

fn ends(subject: &Subject) -> Verdict {
    compare(subject, "the plane is met where the part ends", [3.0, -5.0, 2.0], cut(INSIDE, 4.0))?;
    compare(subject, "the plane is met where the part begins", [3.0, 2.0, 2.0], cut(INSIDE, 0.5))
}

/// The plane is met by so much before or after an end of the part.
fn by_a_hair(subject: &Subject) -> Verdict {
    for gap in [8, 20, 34].map(|bits| 2.0_f64.powi(-bits)) {
        for (end, late, wanted) in [
            (INSIDE.max, gap, Sides::Near),
            (INSIDE.max, -gap, cut(INSIDE, INSIDE.max - gap)),
            (INSIDE.min, -gap, Sides::Far),
            (INSIDE.min, gap, cut(INSIDE, INSIDE.min + gap)),
        ] {
            let side = if late > 0.0 { "after" } else { "before" };
            let what = format!("the plane is met {} {side} t = {end}", gap.shown());
            for d in [2.0, -2.0] {
                compare(subject, &what, [3.0, 3.0 - (end + late) * d, d], wanted)?;
            }
        }
    }
    Ok(())
}

fn in_plane(subject: &Subject) -> Verdict {
    for zero in ZEROS {
        let what = format!("in the plane, direction {}", zero.shown());
        compare(subject, &what, [3.0, 3.0, zero], uncut(INSIDE))?;
    }
    Ok(())
}

const SIDE: u32 = 161;

/// What the picture's rays are divided in: no quotient of two whole numbers up to 80 is one of these ends, which are
/// 513 and 4097 of 1024.
const DRAWN: Interval = Interval { min: 0.500_976_562_5, max: 4.000_976_562_5 };

/// The ray of a pixel, i twentieths from the plane at 0, with j fortieths for its direction.
fn ray_of([i, j]: [i32; 2]) -> [f64; 3] {
    [0.0, f64::from(i) / 20.0, f64::from(j) / 40.0]
}

/// The plane is met at t = −2 i / j, which whole numbers compare with the ends.
fn all_rays(subject: &Subject) -> Verdict {
    for (i, j) in (-80..=80).flat_map(|j| (-80..=80).map(move |i| (i, j))) {
        let forward = if j < 0 { -1 } else { 1 };
        let (way, speed) = (-2 * i * forward, j * forward);
        let wanted = match speed {
            0 if i == 0 => uncut(DRAWN),
            0 if i < 0 => Sides::Near,
            0 => Sides::Far,
            _ if 1024 * way > 4097 * speed => Sides::Near,
            _ if 1024 * way < 513 * speed => Sides::Far,
            _ => cut(DRAWN, f64::from(way) / f64::from(speed)),
        };
        judge(subject, "a ray of the picture", (ray_of([i, j]), DRAWN), wanted)?;
    }
    Ok(())
}

/// All rays with origins from −4 to 4 and directions from −2 to 2 for a plane at 0: blue is near, red far,
/// green both, the lighter the earlier the plane is met. The middle row has direction 0, the middle column
/// starts in the plane.
fn draw(subject: &Subject) -> Image {
    let middle = (SIDE / 2) as i32;
    painted(ImageSize::new(SIDE, SIDE), |x, y| {
        let [split, origin, direction] = ray_of([x as i32 - middle, middle - y as i32]);
        match (subject.plane_sides)(split, origin, direction, DRAWN) {
            Sides::Near => Rgb::new(0.1, 0.2, 0.7),
            Sides::Far => Rgb::new(0.7, 0.15, 0.1),
            Sides::Both { near, far } => Rgb::new(0.9 - far.min / 5.0, 1.0 - near.max / 10.0, 0.3),
        }
    })
}
