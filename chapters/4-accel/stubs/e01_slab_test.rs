//! E4.1 A ray and a box. Slide « Hiérarchie de volumes englobants ».

use chapter_4::exercises::prelude::*;

/// What (plane − o) · (1 / d) may be too small by: multiply the t of each far plane by it.
const FAR: f64 = 1.0 + 4.0 * f64::EPSILON;

/// The t at which a ray enters a box, if it meets the box in `range`.
///
/// - `bounds.min`, `bounds.max`: the corners, whose coordinates are `bounds.min[0]` and so on.
/// - `ray`: its direction has any length; its components may be 0 or −0.
/// - `range.min`, `range.max`: where along the ray to look; a ray that is in the box already enters it at
///   `range.min`.
///
/// A ray that touches the box, or runs in one of its faces, meets it: no box that is met may be missed.
pub fn slab_test(bounds: &Bounds3, ray: &Ray, range: Interval) -> Option<f64> {
    todo!("E4.1: clip the range by the three slabs")
}
