//! The margins for rounding where space is split.
//!
//! Space can be split exactly, rays and primitives cannot be computed exactly. A primitive may be met a
//! rounding error beside itself, and then it must still be found in the cell where it was met. So a primitive
//! is entered into every cell that it comes near, within the [`slack`], and a ray visits a cell a little before
//! it gets there and until a little after, within its [`rounding`].

use lancer_core::geometry::{Bounds3, Ray};

/// Every rounded operation in question, and few of them follow each other, errs by half an ε.
pub(crate) const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A tree whose planes lie where the primitives end takes so many times a ray's [`rounding`].
///
/// Of two primitives met at the same t one may seem to be in a cell that the ray reaches later. The product with
/// ε is the one of [`lancer_core::geometry::Slabs`], measured there to lose no such tie.
pub(crate) const TIES: f64 = 16.0;

/// The margin by which what lies within `bounds` is grown before it is put into cells: a dozen operations on
/// numbers of its size may say where it is.
pub(crate) fn slack(bounds: Bounds3) -> f64 {
    slack_with(bounds, ROUNDING)
}

/// The same for regular cells of a scene within `bounds`.
///
/// The share of the scene's size is far more than that size rounds to, and still far less than a cell. It pays
/// for the rounding of rays that start up to 2¹⁶ sizes away.
pub(crate) fn regular_slack(bounds: Bounds3) -> f64 {
    slack_with(bounds, 2.0_f64.powi(-32))
}

/// What the largest coordinate rounds by, and this share of the size.
fn slack_with(bounds: Bounds3, share: f64) -> f64 {
    if bounds.is_empty() {
        return 0.0;
    }
    ROUNDING * bounds.reach() + share * (bounds.max - bounds.min).max_element()
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
