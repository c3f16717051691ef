//! E4.3 The surface area heuristic. Slide « Hiérarchie de volumes englobants ».

use chapter_4::exercises::prelude::*;

/// What a node is expected to cost after a split: C = 1 + (A₀ n₀ + A₁ n₁) / A, in primitive tests.
///
/// - `node: &Bounds3` (crates/core/src/geometry/bounds.rs): the box of the node, with the surface A. Its extent
///   `node.max - node.min` is a `DVec3`, three `f64` called `.x`, `.y`, `.z`.
/// - `parts`: the boxes of the two children, `parts[0]` and `parts[1]`, with A₀ and A₁.
/// - `counts`: how many primitives are in them, n₀ and n₁: whole numbers, which `as f64` converts.
pub fn sah_cost(node: &Bounds3, parts: [&Bounds3; 2], counts: [usize; 2]) -> f64 {
    todo!("E4.3: the cost of a split")
}

/// How many boxes of a row go to the left child, from 1 to one less than there are: where [`sah_cost`] is least,
/// or the smaller number if two cuts cost the same. None if no split costs less than testing all boxes, one each.
///
/// The boxes, at least one, are in order along the row: the first ones, `boxes[..left]`, go to the left, and
/// `boxes[left..]` to the right. `Bounds3::EMPTY` and `a.union(b)` make the box around several.
pub fn best_split(boxes: &[Bounds3]) -> Option<usize> {
    todo!("E4.3: the cheapest cut")
}
