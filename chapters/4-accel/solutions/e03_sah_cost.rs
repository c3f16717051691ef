//! E4.3 The surface area heuristic. Slide « Hiérarchie de volumes englobants ».

use chapter_4::exercises::prelude::*;

/// What a node is expected to cost after a split: C = 1 + (A₀ n₀ + A₁ n₁) / A, in primitive tests.
pub fn sah_cost(node: &Bounds3, parts: [&Bounds3; 2], counts: [usize; 2]) -> f64 {
    let [a, b] = parts.map(|part| half_surface(part) / half_surface(node));
    1.0 + (a * counts[0] as f64 + b * counts[1] as f64)
}

/// The other half cancels.
fn half_surface(bounds: &Bounds3) -> f64 {
    let DVec3 { x, y, z } = bounds.max - bounds.min;
    x * y + y * z + z * x
}

/// How many boxes of a row go to the left child, if a split costs less than testing all boxes.
pub fn best_split(boxes: &[Bounds3]) -> Option<usize> {
    let around = |boxes: &[Bounds3]| boxes.iter().copied().fold(Bounds3::EMPTY, Bounds3::union);
    let cost = |left: usize| {
        let (a, b) = boxes.split_at(left);
        sah_cost(&around(boxes), [&around(a), &around(b)], [a.len(), b.len()])
    };
    // Of equal ones `min_by` takes the first.
    let best = (1..boxes.len()).min_by(|a, b| cost(*a).total_cmp(&cost(*b)))?;
    (cost(best) < boxes.len() as f64).then_some(best)
}
