use glam::DVec3;

/// The origin of a ray that leaves a computed point of a surface.
///
/// `position` is off the true surface by at most `error` per coordinate. The origin is moved along
/// the unit normal `n` to the side that `direction` points to, just far enough to clear that box of
/// error, and each moved coordinate is rounded one step further. The move follows from the point's
/// own rounding, about 1e-15 of its coordinates: no epsilon has to be chosen for a scene's scale.
///
/// Source: Pharr, Jakob, Humphreys, *Physically Based Rendering*, 4th ed., §6.8.6.
#[inline]
pub fn leave_surface(position: DVec3, error: DVec3, n: DVec3, direction: DVec3) -> DVec3 {
    let distance = n.abs().dot(error);
    let offset = if n.dot(direction) < 0.0 { -distance * n } else { distance * n };
    let origin = position + offset;
    DVec3::new(away(origin.x, offset.x), away(origin.y, offset.y), away(origin.z, offset.z))
}

#[inline(always)]
fn away(coordinate: f64, offset: f64) -> f64 {
    if offset > 0.0 {
        coordinate.next_up()
    } else if offset < 0.0 {
        coordinate.next_down()
    } else {
        coordinate
    }
}
