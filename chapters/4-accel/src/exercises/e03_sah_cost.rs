//! E4.3: the surface area heuristic.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::Bounds3;
use lancer_core::image::{Image, ImageSize};
use lancer_exercise::{Card, Check, Exercise, Shown, Solution, Verdict, same, slips, within};
use lancer_lesson::picture::painted;

use super::Subject;
use super::reference::{best_split, sah_cost};

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E4.3",
        name: "sah-cost",
        title: "What a split costs",
        slide: "Hiérarchie de volumes englobants",
        stub: include_str!("../../stubs/e03_sah_cost.rs"),
        functions: &["sah_cost", "best_split"],
        minutes: 25,
        predict: "24 boxes stand in a row, most of them close together, and a bar tells the cost of each cut: \
                  is the cheapest cut in the middle of the row, in the middle of the space, or elsewhere?",
        vary: "use the volume instead of the surface, and draw again: which random rays would that be right \
               for, if for any?",
        hints: [
            "A random line that meets a box meets a smaller convex box in it with the probability of the ratio \
             of their surfaces. What is met is tested.",
            "C = 1 + (A₀ n₀ + A₁ n₁) / A with the surface A = 2 (xy + yz + zx) of a box of extent (x, y, z); \
             the 2 cancels. A leaf costs n, one test for each.",
            "For each `left` from 1 to `boxes.len() - 1`: split the row there, fold each side with \
             `Bounds3::union` from `Bounds3::EMPTY`, and keep the first smallest cost; answer it only if that \
             is smaller than `boxes.len() as f64`.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e03_sah_cost.rs"),
            file: "crates/accel/src/sah.rs",
            item: "pub fn sah_cost",
            notice: "the hierarchy's own `cheapest_cut`, in crates/accel/src/bvh/cuts.rs, tries 15 planes on each \
                     axis and sums from both ends, so that a split costs O(n)",
        },
    },
    checks: &[
        Check { name: "a cost by hand", run: by_hand },
        Check { name: "one part empty of primitives", run: empty_part },
        Check { name: "flat boxes", run: flat },
        Check { name: "the gap in a row", run: gap },
        Check { name: "no split that does not pay", run: leaf },
        Check { name: "of equal costs the first", run: tie },
        Check { name: "the row of the picture", run: row_of_the_picture },
    ],
    slips: slips! {
        sah_cost(node, parts, counts):
        "volumes are compared: the chance of being met goes with the surface":
            "a cost by hand" catches by(node, parts, counts, DVec3::element_product);
        "the surface is the sum of the extents: it is xy + yz + zx":
            "a cost by hand" catches by(node, parts, counts, DVec3::element_sum);
        "the sum is not divided by the node's surface: the ratios are probabilities":
            "a cost by hand" catches
                1.0 + surface(node.max - node.min) * (sah_cost(node, parts, counts) - 1.0);
        "the 1 for visiting the node is missing":
            "a cost by hand" catches sah_cost(node, parts, counts) - 1.0;
        "the factor 2 of the surface stands above the fraction bar only: it cancels, or belongs to all three surfaces":
            "a cost by hand" catches 2.0 * sah_cost(node, parts, counts) - 1.0;
        "the counts are swapped: each surface goes with its own number":
            "a cost by hand" catches sah_cost(node, parts, [counts[1], counts[0]]);
        "whole numbers are divided: 130 / 44 is 2 then. Convert the counts by `as f64` first":
            "a cost by hand" catches 1.0 + (sah_cost(node, parts, counts) - 1.0).trunc();
        "the cost is computed in `f32`, which keeps 7 digits: keep to `f64`":
            "a cost by hand" catches {
                let [a, b] = parts.map(|part| half_surface_32(part) / half_surface_32(node));
                f64::from(1.0 + a * counts[0] as f32 + b * counts[1] as f32)
            };

        best_split(boxes):
        "the row is cut in its middle, whatever that costs":
            "the gap in a row" catches best_split(boxes).map(|_| boxes.len() / 2);
        "the answer is one too small: it is how many boxes go to the left, not the index of the last of them":
            "the gap in a row" catches best_split(boxes).map(|left| left - 1);
        "the answer is one too large: the box at the cut already goes to the right":
            "the gap in a row" catches best_split(boxes).map(|left| left + 1);
        "the last cut is never tried: up to n − 1 boxes go to the left":
            "the gap in a row" catches
                split_by(boxes, 1..boxes.len().max(2) - 1, |left| cut(boxes, left));
        "the first cut is never tried: one box alone may go to the left":
            "the gap in a row" catches split_by(boxes, 2..boxes.len(), |left| cut(boxes, left));
        "the left box is a step behind: the box that is counted last is not in it yet":
            "the gap in a row" catches split_by(boxes, 1..boxes.len(), |left| {
                sides(boxes, left, &boxes[..left - 1], &boxes[left..])
            });
        "the right box is not begun anew for each cut: it still holds what has gone to the left":
            "the gap in a row" catches split_by(boxes, 1..boxes.len(), |left| {
                sides(boxes, left, &boxes[..left], &boxes[1..])
            });
        "the right box stays that of the whole row: it is the box around the boxes from the cut on":
            "the gap in a row" catches split_by(boxes, 1..boxes.len(), |left| {
                sides(boxes, left, &boxes[..left], boxes)
            });
        "a split is made where testing all is cheaper: compare the cost with n":
            "no split that does not pay" catches cheapest(boxes, 1..boxes.len());
        "a split is made where testing all costs the same: it must cost less":
            "no split that does not pay" catches
                cheapest(boxes, 1..boxes.len())
                    .filter(|best| cut(boxes, *best) <= boxes.len() as f64);
        "of equal costs the later one is taken, even of a cut and of no split: replace the best only by a smaller one, \
         by < and not by ≤":
            "no split that does not pay" catches
                cheapest(boxes, (1..boxes.len()).rev())
                    .filter(|last| cut(boxes, *last) <= boxes.len() as f64);
        "of equal costs the last is taken: replace the best only by a smaller one":
            "of equal costs the first" catches
                cheapest(boxes, (1..boxes.len()).rev())
                    .filter(|last| cut(boxes, *last) < boxes.len() as f64);
    },
    own: |yours, reference| Subject {
        sah_cost: yours.sah_cost,
        best_split: yours.best_split,
        ..reference
    },
    draw,
    explain: None,
};

fn surface(extent: DVec3) -> f64 {
    extent.dot(DVec3::new(extent.y, extent.z, extent.x))
}

/// The formula with another measure of a box than its surface.
fn by(node: &Bounds3, parts: [&Bounds3; 2], counts: [usize; 2], size: fn(DVec3) -> f64) -> f64 {
    let of = |bounds: &Bounds3| size(bounds.max - bounds.min);
    let [a, b] = parts.map(|part| of(part) / of(node));
    1.0 + a * counts[0] as f64 + b * counts[1] as f64
}

/// Half the surface, in 24 bits.
fn half_surface_32(bounds: &Bounds3) -> f32 {
    let [x, y, z] = (bounds.max - bounds.min).as_vec3().to_array();
    x * y + y * z + z * x
}

fn around(boxes: &[Bounds3]) -> Bounds3 {
    boxes.iter().copied().fold(Bounds3::EMPTY, Bounds3::union)
}

/// What a cut costs if these are taken for its sides.
fn sides(boxes: &[Bounds3], left: usize, a: &[Bounds3], b: &[Bounds3]) -> f64 {
    sah_cost(&around(boxes), [&around(a), &around(b)], [left, boxes.len() - left])
}

/// The reference's cost of a cut of a row.
fn cut(boxes: &[Bounds3], left: usize) -> f64 {
    let (a, b) = boxes.split_at(left);
    sides(boxes, left, a, b)
}

/// The first of the cuts that cost least.
fn cheapest(boxes: &[Bounds3], cuts: impl Iterator<Item = usize>) -> Option<usize> {
    cuts.min_by(|a, b| cut(boxes, *a).total_cmp(&cut(boxes, *b)))
}

/// The same by another cost, if it is less than testing all.
fn split_by(
    boxes: &[Bounds3],
    cuts: impl Iterator<Item = usize>,
    cost: impl Fn(usize) -> f64,
) -> Option<usize> {
    let best = cuts.min_by(|a, b| cost(*a).total_cmp(&cost(*b)));
    best.filter(|best| cost(*best) < boxes.len() as f64)
}

fn compare(subject: &Subject, extents: [[f64; 3]; 3], counts: [usize; 2], wanted: f64) -> Verdict {
    let min = DVec3::new(-3.0, 1.0, 0.5);
    let [node, a, b] = extents.map(|extent| Bounds3 { min, max: min + DVec3::from(extent) });
    let got = (subject.sah_cost)(&node, [&a, &b], counts);
    let text = extents.map(|extent| DVec3::from(extent).shown());
    let case = || {
        format!("extents: node {}, parts {} and {}; counts {counts:?}", text[0], text[1], text[2])
    };
    within(1e-12, case, &got, &wanted)
}

/// Half the surfaces: 6·4 + 4·2 + 2·6 = 44, 2·4 + 4·1 + 1·2 = 14 and 3·1 + 1·2 + 2·3 = 11.
fn by_hand(subject: &Subject) -> Verdict {
    let extents = [[6.0, 4.0, 2.0], [2.0, 4.0, 1.0], [3.0, 1.0, 2.0]];
    compare(subject, extents, [3, 8], 1.0 + (14.0 * 3.0 + 11.0 * 8.0) / 44.0)
}

fn empty_part(subject: &Subject) -> Verdict {
    let extents = [[6.0, 4.0, 2.0], [2.0, 4.0, 1.0], [3.0, 1.0, 2.0]];
    compare(subject, extents, [0, 4], 2.0)
}

fn flat(subject: &Subject) -> Verdict {
    let extents = [[5.0, 0.0, 4.0], [2.0, 0.0, 4.0], [3.0, 0.0, 2.0]];
    compare(subject, extents, [5, 3], 1.0 + (8.0 * 5.0 + 6.0 * 3.0) / 20.0)
}

/// What the boxes of the rows are like.
const EXTENT: [f64; 3] = [1.0, 2.0, 3.0];

/// Boxes of one extent at these x.
fn boxes(extent: [f64; 3], at: &[f64]) -> Vec<Bounds3> {
    let place = |&x: &f64| {
        let min = DVec3::new(x, -1.0, 0.5);
        Bounds3 { min, max: min + DVec3::from(extent) }
    };
    at.iter().map(place).collect()
}

fn compare_split(
    subject: &Subject,
    extent: [f64; 3],
    at: &[f64],
    wanted: Option<usize>,
) -> Verdict {
    let got = (subject.best_split)(&boxes(extent, at));
    let extent = DVec3::from(extent).shown();
    same(|| format!("boxes of extent {extent} at x = {at:?}"), &got, &wanted)
}

fn gap(subject: &Subject) -> Verdict {
    compare_split(subject, EXTENT, &[0.0, 20.0, 21.5, 23.0, 24.5], Some(1))?;
    compare_split(subject, EXTENT, &[0.0, 1.5, 3.0, 4.5, 5.5, 40.0], Some(5))?;
    compare_split(subject, EXTENT, &[0.0, 10.0, 20.0, 21.5, 23.0, 24.5], Some(2))
}

fn leaf(subject: &Subject) -> Verdict {
    compare_split(subject, EXTENT, &[0.0], None)?;
    compare_split(subject, EXTENT, &[0.0, 0.25], None)?;
    compare_split(subject, EXTENT, &[3.0; 4], None)?;
    // Half the surfaces are 8 and 8 of 16: 1 + (8 + 8) / 16 = 2, as much as testing both.
    compare_split(subject, [1.0, 2.0, 2.0], &[0.0, 2.0], None)
}

/// The cuts after the second and the fourth of these six mirror each other, and none is cheaper. Half the surface of
/// all is 256, so that no order of the sums rounds.
fn tie(subject: &Subject) -> Verdict {
    compare_split(subject, [1.0, 2.0, 2.0], &[0.0, 1.0, 30.5, 31.5, 61.0, 62.0], Some(2))
}

const COUNT: usize = 24;
const WIDTH: u32 = 240;

/// Where the boxes of the picture begin: a few apart, a wide gap, and many close together.
fn places() -> Vec<f64> {
    let mut x = 0.0;
    let place = |k| {
        x += match k {
            3 => 30.0,
            0..8 => 4.0,
            _ => 1.25,
        };
        x
    };
    (0..COUNT).map(place).collect()
}

/// What the subject says of every cut of a row.
fn costs(subject: &Subject, row: &[Bounds3]) -> Vec<f64> {
    let cost = |left: usize| {
        let (a, b) = row.split_at(left);
        (subject.sah_cost)(&around(row), [&around(a), &around(b)], [a.len(), b.len()])
    };
    (1..row.len()).map(cost).collect()
}

/// A box e wide has half the surface 2 e + 6 + 3 e, and one around boxes ends 1 after the last begins.
fn row_of_the_picture(subject: &Subject) -> Verdict {
    let at = places();
    let row = boxes(EXTENT, &at);
    let half_surface = |at: &[f64]| 5.0 * (at[at.len() - 1] + 1.0 - at[0]) + 6.0;
    let cost = |left: usize| {
        let [a, b] = [&at[..left], &at[left..]].map(|at| half_surface(at) * at.len() as f64);
        1.0 + (a + b) / half_surface(&at)
    };
    for (left, got) in (1..).zip(costs(subject, &row)) {
        let case = || format!("the picture's row of {COUNT} boxes, {left} of them on the left");
        within(1e-9, case, &got, &cost(left))?;
    }
    let cheapest = (1..COUNT).min_by(|a, b| cost(*a).total_cmp(&cost(*b)));
    let case = || format!("the picture's row of {COUNT} boxes: the cheapest cut");
    same(case, &(subject.best_split)(&row), &cheapest)
}

/// A row of boxes, and below each gap the cost of cutting there; the cheapest cut is red.
fn draw(subject: &Subject) -> Image {
    let row = boxes(EXTENT, &places());
    let whole = around(&row);
    let scale = (whole.max.x - whole.min.x) / f64::from(WIDTH);
    let costs = costs(subject, &row);
    let best = (subject.best_split)(&row);
    painted(ImageSize::new(WIDTH, 120), |px, py| {
        if py < 30.0 {
            let x = whole.min.x + scale * px;
            let inside = row.iter().any(|b| b.min.x <= x && x < b.max.x);
            return if inside { Rgb::new(0.2, 0.35, 0.6) } else { Rgb::ONE };
        }
        let left = 1 + (px / f64::from(WIDTH) * (COUNT - 1) as f64) as usize;
        let height = 80.0 * costs[left - 1] / (COUNT as f64 + 1.0);
        match (120.0 - py < height, best == Some(left)) {
            (true, true) => Rgb::new(0.8, 0.1, 0.1),
            (true, false) => Rgb::splat(0.45),
            (false, _) => Rgb::ONE,
        }
    })
}
