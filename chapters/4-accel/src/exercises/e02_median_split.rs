//! E4.2: the median split.

use std::cmp::Reverse;

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::image::{Image, ImageSize};
use lancer_core::sampling::Uniform;
use lancer_core::scene::PrimitiveId;
use lancer_exercise::{
    Card, Check, Exercise, Mismatch, Shown, Solution, Verdict, ensure, same, slips,
};
use lancer_lesson::picture::painted;

use super::reference::median_split;
use super::{Item, Subject, color_of};

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E4.2",
        name: "median-split",
        title: "The median split",
        slide: "Hiérarchie de volumes englobants",
        stub: include_str!("../../stubs/e02_median_split.rs"),
        functions: &["median_split"],
        minutes: 15,
        predict: "512 points, crowded on the left, are divided four times, and each part gets a colour: are \
                  the parts of equal size?",
        vary: "cut at the middle of the box instead of the middle item: what becomes of the parts where the \
               points are crowded, and how deep would such a tree get?",
        hints: [
            "Sort along the axis on which the centres are spread widest, and cut so that half of the items are \
             on each side.",
            "The extent of the centres is the largest coordinate minus the smallest, on each axis; the cut is \
             at items.len() / 2.",
            "Fold the centres with `DVec3::min` and `DVec3::max`; `let axis = (max - min).max_position();`. \
             Then `items.sort_by(|a, b| a.center[axis].total_cmp(&b.center[axis]).then(a.id.cmp(&b.id)))`.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e02_median_split.rs"),
            file: "crates/accel/src/bvh/mod.rs",
            item: "pub fn split_at_median",
            notice: "nothing is sorted: `select_nth_unstable_by` only puts the middle item into its place, in \
                     O(n)",
        },
    },
    checks: &[
        Check { name: "a row along x", run: row },
        Check { name: "the longest axis, not the farthest", run: longest },
        Check { name: "an odd number", run: odd },
        Check { name: "centres that coincide", run: coincide },
        Check { name: "centres that almost coincide", run: almost },
        Check { name: "every split of the picture", run: crowd },
    ],
    slips: slips! {
        median_split(items):
        "the cut is always across x: take the axis on which the centres are spread widest":
            "the longest axis, not the farthest" catches along(0, items);
        "the axis is that of the largest coordinates: the extent is the largest minus the smallest, and their search \
         begins with −∞ and ∞, not with 0":
            "the longest axis, not the farthest" catches
                along(extent(items).1.max_position(), items);
        "the axis is the one on which the centres are spread least: take the longest":
            "a row along x" catches {
                let (min, max) = extent(items);
                along((max - min).min_position(), items)
            };
        "the items are not sorted: the order in which they arrive decides":
            "a row along x" catches items.len() / 2;
        "the upper half is at the front: the order is turned around":
            "a row along x" catches {
                median_split(items);
                items.reverse();
                items.len() / 2
            };
        "the cut is at the middle of the box: that halves space, not the items":
            "a row along x" catches {
                let ((min, max), axis) = (extent(items), widest(items));
                along(axis, items);
                items.partition_point(|item| item.center[axis] < 0.5 * (min + max)[axis])
            };
        "coordinates are cut to whole numbers before they are compared: compare the `f64` by `total_cmp`":
            "an odd number" catches {
                let axis = widest(items);
                items.sort_by_key(|item| (item.center[axis] as i64, item.id));
                items.len() / 2
            };
        "coordinates are compared in `f32`, to which those that differ by little are equal: keep to `f64`":
            "centres that almost coincide" catches {
                let axis = widest(items);
                items.sort_by(|a, b| {
                    let [a, b] = [a, b].map(|item| (item.center[axis] as f32, item.id));
                    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
                });
                items.len() / 2
            };
        "the front gets one item too many: the items before index n / 2 are n / 2":
            "a row along x" catches along(widest(items), items) + 1;
        "of an odd number the front gets the larger part":
            "an odd number" catches {
                median_split(items);
                items.len().div_ceil(2)
            };
        "ties are left to chance: where coordinates are equal the smaller id is lower, or the tree depends on the \
         order of its input":
            "centres that coincide" catches {
                sort(widest(items), items);
                items.len() / 2
            };
        "where coordinates are equal the larger id comes first: the smaller one is lower":
            "centres that coincide" catches {
                items.sort_by_key(|item| Reverse(item.id));
                sort(widest(items), items);
                items.len() / 2
            };
        "the front is what lies below the middle item's coordinate: items that are equal to it are not counted":
            "centres that coincide" catches {
                let axis = widest(items);
                let count = along(axis, items);
                let middle = items[count].center[axis];
                items.partition_point(|item| item.center[axis] < middle)
            };
    },
    own: |yours, reference| Subject { median_split: yours.median_split, ..reference },
    draw,
    explain: None,
};

fn extent(items: &[Item]) -> (DVec3, DVec3) {
    items.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), item| {
        (min.min(item.center), max.max(item.center))
    })
}

/// The axis on which the centres are spread widest.
fn widest(items: &[Item]) -> usize {
    let (min, max) = extent(items);
    (max - min).max_position()
}

/// What is equal along the axis stays in order.
fn sort(axis: usize, items: &mut [Item]) {
    items.sort_by(|a, b| a.center[axis].total_cmp(&b.center[axis]));
}

/// The split across an axis.
fn along(axis: usize, items: &mut [Item]) -> usize {
    items.sort_by_key(|item| item.id);
    sort(axis, items);
    items.len() / 2
}

/// The ids, in order.
fn ids(items: &[Item]) -> Vec<u32> {
    let mut ids: Vec<u32> = items.iter().map(|item| item.id.0).collect();
    ids.sort_unstable();
    ids
}

/// Splits items at these centres, whose ids count from 0, given in the order of `given`.
fn compare(subject: &Subject, centers: &[[f64; 3]], given: &[u32], wanted: &[u32]) -> Verdict {
    let item = |&id: &u32| Item { center: centers[id as usize].into(), id: PrimitiveId(id) };
    let mut items: Vec<Item> = given.iter().map(item).collect();
    let list = |item: &Item| format!("{} at {}", item.id.0, item.center.shown());
    let case = items.iter().map(list).collect::<Vec<_>>().join(", ");
    let count = (subject.median_split)(&mut items);
    let all: Vec<u32> = (0..given.len() as u32).collect();
    let got = items.get(..count).map(ids);
    if ids(&items) == all && got.as_deref() == Some(wanted) {
        return Ok(());
    }
    let got =
        got.map_or(format!("{count} items"), |front| format!("{front:?} of {:?}", ids(&items)));
    Err(Mismatch::new(format!("items {case}"), got, format!("{wanted:?} of {all:?} in front")))
}

fn row(subject: &Subject) -> Verdict {
    let centers = [[5.0, 1.0, 2.0], [1.0, 2.0, 1.0], [40.0, 1.5, 2.5], [3.0, 1.25, 1.5]];
    compare(subject, &centers, &[0, 1, 2, 3], &[1, 3])
}

/// The coordinates are largest on z, and spread widest on y.
fn longest(subject: &Subject) -> Verdict {
    let centers = [[1.0, -7.0, 20.0], [4.0, 5.0, 21.0], [2.0, 6.0, 22.5], [3.0, -6.0, 23.0]];
    compare(subject, &centers, &[2, 0, 3, 1], &[0, 3])
}

fn odd(subject: &Subject) -> Verdict {
    let at = |z: f64| [0.5, 0.25 * z, z];
    let centers = [at(0.5), at(-0.25), at(0.375), at(0.875), at(-0.125)];
    compare(subject, &centers, &[3, 1, 2, 4, 0], &[1, 4])
}

fn coincide(subject: &Subject) -> Verdict {
    compare(subject, &[[1.5, 2.5, 3.5]; 6], &[4, 5, 1, 0, 3, 2], &[0, 1, 2])?;
    let centers = [[7.0, 1.0, 1.0], [2.0, 1.5, 1.0], [2.0, 1.0, 1.5], [2.0, 1.0, 1.0]];
    compare(subject, &centers, &[3, 0, 2, 1], &[1, 2])
}

/// The coordinates differ in their thirtieth bit.
fn almost(subject: &Subject) -> Verdict {
    let centers = [3.0, 1.0, 2.0, 0.0].map(|x| [1.0 + x * 2.0_f64.powi(-30), 0.5, 0.25]);
    compare(subject, &centers, &[2, 0, 1, 3], &[1, 3])
}

/// 512 points of a square, crowded on the left. They are whole numbers, so that no rounding changes their order.
fn points() -> Vec<Item> {
    let point = |id| {
        let mut random = Uniform::new(42, id, 0);
        let (x, y) = (random.number().powi(3), random.number());
        Item { center: (DVec3::new(x, y, 0.0) * 4096.0).floor(), id: PrimitiveId(id) }
    };
    (0..512).map(point).collect()
}

/// Splits items, and each half again, until `levels` are done; shows what is split, how many of it are in front, and
/// at the end each part.
fn divide(
    subject: &Subject,
    items: &mut [Item],
    levels: u32,
    split: &mut dyn FnMut(&[Item], usize) -> Verdict,
    part: &mut dyn FnMut(&[Item]),
) -> Verdict {
    if levels == 0 || items.len() < 2 {
        part(items);
        return Ok(());
    }
    let middle = (subject.median_split)(items);
    split(items, middle)?;
    let (front, back) = items.split_at_mut(middle.min(items.len()));
    divide(subject, front, levels - 1, split, part)?;
    divide(subject, back, levels - 1, split, part)
}

const LEVELS: u32 = 4;

/// In front of each split is the smaller half, and none of it comes after any of the rest along the longest axis.
fn crowd(subject: &Subject) -> Verdict {
    let mut split = |items: &[Item], middle: usize| {
        let axis = widest(items);
        let key = |item: &Item| (item.center[axis] as i64, item.id);
        let (front, back) = items.split_at(middle.min(items.len()));
        let last = front.iter().map(key).max();
        let first = back.iter().map(key).min();
        let name = ["x", "y", "z"][axis];
        let case =
            format!("{} of the picture's 512 points, spread widest along {name}", items.len());
        let wanted = format!("{} of them in front, all lower than the others", items.len() / 2);
        let got = format!("{middle} in front");
        ensure(middle == items.len() / 2 && last < first, || {
            let order = if last < first { "" } else { ", one of which is not lower" };
            Mismatch::new(case, got + order, wanted)
        })
    };
    let mut ended = Vec::new();
    divide(subject, &mut points(), LEVELS, &mut split, &mut |part| ended.extend(ids(part)))?;
    ended.sort_unstable();
    let case = "the picture's 512 points, divided four times: the points that are left";
    same(|| case.to_owned(), &ended.into_iter().eq(0..512), &true)
}

/// Points of a square, each pixel in the colour of the part in which the nearest point ends up after four
/// splits.
fn draw(subject: &Subject) -> Image {
    let mut parts: Vec<(DVec3, usize)> = Vec::new();
    let mut count = 0;
    let mut keep = |part: &[Item]| {
        parts.extend(part.iter().map(|item| (item.center, count)));
        count += 1;
    };
    // Nothing is judged here, so nothing fails.
    let _ = divide(subject, &mut points(), LEVELS, &mut |_, _| Ok(()), &mut keep);
    painted(ImageSize::new(160, 160), |x, y| {
        let at = DVec3::new(x, y, 0.0) * (4096.0 / 160.0);
        let nearest = parts
            .iter()
            .min_by(|a, b| a.0.distance_squared(at).total_cmp(&b.0.distance_squared(at)));
        nearest.map_or(Rgb::ZERO, |(_, part)| color_of(*part))
    })
}
