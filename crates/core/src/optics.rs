//! « Reflets spéculaires »: the directions of the mirror ray and of the refracted ray.

use glam::DVec3;

/// How far the length of a unit vector may be from 1: a hundred reflections of one direction stay
/// within it.
const UNIT: f64 = 1e-9;

fn is_unit(v: DVec3) -> bool {
    (v.length_squared() - 1.0).abs() <= UNIT
}

/// Direction of the mirror ray.
///
/// ```text
/// eq:reflected-ray        R = V − 2 (N·V) N
/// ```
///
/// | slide | here       |                                                  |
/// |-------|------------|--------------------------------------------------|
/// | V     | `incident` | unit, travels *towards* the surface              |
/// | N     | `n`        | unit, either side: R does not change if N flips   |
/// | R     | result     | unit, travels away from the surface              |
///
/// Slide « Reflets spéculaires : calcul du rayon réfléchi ».
#[doc(alias = "eq:reflected-ray")]
#[doc(alias = "reflected-ray")]
#[doc(alias = "rayon réfléchi")]
#[inline]
pub fn reflect(incident: DVec3, n: DVec3) -> DVec3 {
    debug_assert!(is_unit(incident) && is_unit(n));
    incident - 2.0 * n.dot(incident) * n
}

/// Direction of the refracted ray; `None` is total reflection.
///
/// ```text
/// eq:descartes            n₁ sin θ₁ = n₂ sin θ₂
///                         T = η V + (η cos θ₁ − cos θ₂) N,   η = n₁ / n₂
///                         cos² θ₂ = 1 − η² (1 − cos² θ₁)
/// ```
///
/// | slide  | here       |                                                          |
/// |--------|------------|----------------------------------------------------------|
/// | V      | `incident` | unit, travels *towards* the surface                      |
/// | N      | `n`        | unit, on the side the ray comes from: N·V ≤ 0            |
/// | n₁, n₂ | `n1`, `n2` | refractive indices before and behind the surface          |
/// | T      | result     | unit, travels away from the surface, on the other side   |
///
/// Slide « Calcul du rayon réfracté : loi de Descartes ».
#[doc(alias = "eq:descartes")]
#[doc(alias = "descartes")]
#[doc(alias = "rayon réfracté")]
#[doc(alias = "snell")]
#[inline]
pub fn refract(incident: DVec3, n: DVec3, n1: f64, n2: f64) -> Option<DVec3> {
    debug_assert!(is_unit(incident) && is_unit(n) && n.dot(incident) <= 0.0);
    let eta = n1 / n2;
    let cos1 = -n.dot(incident);
    // 1 − cos² as a product: it keeps the digits that the difference of squares loses at normal
    // incidence, where cos θ₁ is near 1.
    let sin1_squared = (1.0 - cos1) * (1.0 + cos1);
    let cos2_squared = 1.0 - eta * eta * sin1_squared;
    (cos2_squared >= 0.0).then(|| eta * incident + (eta * cos1 - cos2_squared.sqrt()) * n)
}
