//! The margins for rounding where space is split.
//!
//! Space can be split exactly, rays and primitives cannot be computed exactly. A primitive may be met a
//! rounding error beside itself, and then it must still be found in the cell where it was met. So a primitive
//! is entered into every cell that it comes near, within the [`slack`], and a ray visits a cell a little before
//! it gets there and until a little after, within its [`rounding`].

use lancer_core::geometry::{Bounds3, Ray};

/// Every rounded operation in question, and few of them follow each other, errs by half an ε.
pub(crate) const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The margin by which a primitive is grown before it is put into the cells of a scene within `bounds`.
///
/// The rounding of coordinates and planes needs 16 ε of the largest coordinate. The share of the scene's
/// size is far more than that size rounds to, and still far less than a cell: it pays for the rounding of
/// rays that start up to 2¹⁶ sizes away.
pub(crate) fn slack(bounds: Bounds3) -> f64 {
    if bounds.is_empty() {
        return 0.0;
    }
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    ROUNDING * largest + (bounds.max - bounds.min).max_element() * 2.0_f64.powi(-32)
}

/// How far beside a primitive within `bounds` a ray may run whose primitive test still finds a hit: the
/// test subtracts the origin first, which rounds in proportion to the distance. `None` for what is no
/// ray: it hits nothing.
#[inline]
pub(crate) fn rounding(ray: &Ray, bounds: Bounds3) -> Option<f64> {
    let distance = (ray.origin - bounds.min).abs().max((ray.origin - bounds.max).abs());
    let valid = ray.origin.is_finite() && ray.direction.is_finite() && !bounds.is_empty();
    valid.then(|| ROUNDING * distance.max_element())
}
