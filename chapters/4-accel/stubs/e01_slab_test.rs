//! E4.1 A ray and a box. Slide « Hiérarchie de volumes englobants ».

use chapter_4::exercises::prelude::*;

/// What (plane − o) · (1 / d) may be too small by: multiply the t of each far plane by it. More is too much: a
/// ray that misses the box by little must miss it.
const FAR: f64 = 1.0 + 4.0 * f64::EPSILON;

/// The t at which a ray enters a box, if it meets the box in `range`: `Some(t)`, or `None`.
///
/// - `bounds: &Bounds3` (crates/core/src/geometry/bounds.rs): the corners `bounds.min` and `bounds.max`, each a
///   `DVec3`, three `f64` called `.x`, `.y`, `.z` or `[0]`, `[1]`, `[2]`. A box may be flat: `min[k] == max[k]`.
/// - `ray: &Ray` (crates/core/src/geometry/ray.rs): the points `ray.origin + t * ray.direction`. The direction
///   has any length, and t counts in it; its components may be 0 or −0.
/// - `range: Interval` (the same file): the t to look at, from `range.min`, which is 0 or more, to `range.max`,
///   both included. A ray that is in the box at `range.min` already enters it there.
///
/// A ray that touches the box, or runs in one of its faces, meets it: no box that is met may be missed.
pub fn slab_test(bounds: &Bounds3, ray: &Ray, range: Interval) -> Option<f64> {
    todo!("E4.1: clip the range by the three slabs")
}
