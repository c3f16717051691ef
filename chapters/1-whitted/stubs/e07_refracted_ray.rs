//! E1.7 The refracted ray. Slide « Reflets spéculaires : calcul du rayon réfracté ».

use chapter_1::exercises::prelude::*;

/// The direction T in which a ray goes on behind a surface, or `None` if it is totally reflected.
///
/// - `incident`: D (slide: V), unit, towards the surface.
/// - `n`: the unit normal N, on the side that the ray comes from: N·D ≤ 0.
/// - `n1`, `n2`: the refractive indices before and behind the surface.
///
/// T is unit, leads away from the surface on its other side, N·T ≤ 0, and lies in the plane of D and N. Its
/// angle θ₂ to −N follows from that of D, θ₁: n₁ sin θ₁ = n₂ sin θ₂. Where no θ₂ does, all is reflected.
/// The answer is `Some(t)`, t being a `DVec3`, or `None`.
pub fn refracted_ray(incident: DVec3, n: DVec3, n1: f64, n2: f64) -> Option<DVec3> {
    todo!("E1.7: refract the incident direction")
}
