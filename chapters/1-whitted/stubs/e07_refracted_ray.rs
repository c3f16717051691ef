//! E1.7 The refracted ray. Slide « Reflets spéculaires : calcul du rayon réfracté ».

use chapter_1::exercises::prelude::*;

/// The direction in which a ray goes on behind a surface, where n₁ sin θ₁ = n₂ sin θ₂, or `None` if it
/// is totally reflected.
///
/// - `incident`: unit, towards the surface.
/// - `n`: the unit normal, on the side that the ray comes from: N·V ≤ 0.
/// - `n1`, `n2`: the refractive indices before and behind the surface.
///
/// The answer is unit, leads away from the surface, and lies in the plane of `incident` and `n`.
pub fn refracted_ray(incident: DVec3, n: DVec3, n1: f64, n2: f64) -> Option<DVec3> {
    todo!("E1.7: refract the incident direction")
}
