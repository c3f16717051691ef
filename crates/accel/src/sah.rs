//! The surface area heuristic.

use glam::DVec3;

/// What a node costs after a split by the surface area heuristic, in visits of a node: a random line that
/// meets the node meets a part of it with the probability of the ratio of their surfaces.
///
/// ```text
/// C = 1 + C_i (A_0 n_0 + A_1 n_1) / A
/// ```
///
/// `node` and `parts` are the boxes' extents, A and A_k their surfaces, `counts` the primitives n_k in the
/// parts; `test_cost`, C_i, is what a primitive test costs.
#[doc(alias = "SAH")]
#[inline]
pub fn sah_cost(node: DVec3, parts: [DVec3; 2], counts: [usize; 2], test_cost: f64) -> f64 {
    let [below, above] = parts.map(|part| half_area(part) / half_area(node));
    1.0 + test_cost * (below * counts[0] as f64 + above * counts[1] as f64)
}

#[inline]
fn half_area(extent: DVec3) -> f64 {
    extent.x * extent.y + extent.y * extent.z + extent.z * extent.x
}
