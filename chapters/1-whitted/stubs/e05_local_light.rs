//! E1.5 One lamp's part of the local model. Slide « Modèle d'éclairage, modèle local ».

use chapter_1::exercises::prelude::*;

/// What a surface sends to the eye of one lamp's light.
///
/// What comes in are the fields of `lit` (`Lit` is in chapters/1-whitted/src/exercises/mod.rs). An `Rgb` is a
/// `DVec3` of red, green and blue; two of them are multiplied channel by channel.
///
/// - `intensity`: Iᵢ of the lamp, per channel.
/// - `visible`: vis(i), whether the shadow ray reaches the lamp.
/// - `distance`: dᵢ from the surface to the lamp, in scene units.
/// - `reflectance.diffuse`, `.specular`, `.shininess`: ρ_d and ρ_s per channel, and the exponent n.
/// - `n`: the unit normal N, on the eye's side.
/// - `to_light`: L, unit, from the surface to the lamp, which may be behind the surface.
/// - `to_eye`: V, unit, from the surface to the eye.
///
/// The slide's R is the mirror direction of the light, unit, away from the surface. A lamp behind the
/// surface, N·L ≤ 0, adds nothing, not even a highlight; R·V counts as 0 where it is negative.
pub fn local_light(lit: &Lit) -> Rgb {
    let Lit { intensity, visible, distance, reflectance, n, to_light, to_eye } = *lit;
    todo!("E1.5: one term of eq:local")
}
