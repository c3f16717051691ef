//! E1.6 The mirror ray. Slide « Reflets spéculaires : calcul du rayon réfléchi ».

use chapter_1::exercises::prelude::*;

/// The direction R in which a mirror sends on what arrives along `incident`; a `DVec3` is three `f64`.
///
/// - `incident`: D (slide: V), unit, towards the surface.
/// - `n`: the unit normal N; it may stand on either side.
///
/// The answer is unit and leads away from the surface.
pub fn reflected_ray(incident: DVec3, n: DVec3) -> DVec3 {
    todo!("E1.6: mirror the incident direction")
}
