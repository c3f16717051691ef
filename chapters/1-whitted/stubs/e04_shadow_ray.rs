//! E1.4 The shadow ray. Slide « Modèle local : calcul des ombres portées ».

use chapter_1::exercises::prelude::*;

/// The ray from a point of a surface to a lamp, which it reaches at t = 1: `Ray::new(origin, lamp - origin)`.
///
/// A `SurfacePoint` (crates/core/src/world.rs) is what is known of the point; vectors are `DVec3`:
///
/// - `surface.position`: the point, as computed; its rounding left it on either side of the true surface.
/// - `surface.error`: per coordinate, how far that may be. The true point is in the box
///   `position` ± `error`.
/// - `surface.geometric_normal`: unit, of the shape itself, outwards.
/// - `surface.shading_normal`: unit, on the same side, interpolated over smooth triangles.
/// - `surface.lifted`: where the ray starts instead of `position` if the lamp is on the side of the
///   `shading_normal`: a smooth mesh bulges out beyond its triangles.
/// - `lamp`: a point, on either side of the surface.
///
/// The ray leaves the surface on the lamp's side: its origin is moved along the geometric normal just far
/// enough to clear the box of error around it. No epsilon is to be chosen.
pub fn shadow_ray(surface: &SurfacePoint, lamp: DVec3) -> Ray {
    todo!("E1.4: start off the surface, and aim at the lamp")
}
