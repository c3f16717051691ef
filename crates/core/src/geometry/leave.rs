use super::{Real, Vector};

/// The origin of a ray that leaves a computed point of a surface.
///
/// `position` is off the true surface by at most `error` per coordinate, its own rounding included.
/// The origin is moved along the unit normal `n`, to the side that `direction` points to, just far
/// enough to clear that box of error. The move follows from the point's rounding, about 1e-15 of its
/// coordinates: no epsilon has to be chosen for a scene's scale.
///
/// Source: Pharr, Jakob, Humphreys, *Physically Based Rendering*, 4th ed., §6.8.6.
#[inline(always)]
pub fn leave_surface<V: Vector>(position: V, error: V, n: V, direction: V) -> V {
    let distance = n.abs().dot(error);
    position + n * distance.copysign(n.dot(direction))
}
