//! E1.5 One lamp's part of the local model. Slide « Modèle d'éclairage, modèle local ».

use chapter_1::exercises::prelude::*;

/// What a surface sends to the eye of one lamp's light.
///
/// What comes in are the fields of `lit`:
///
/// - `intensity`: Iᵢ of the lamp, per channel.
/// - `visible`: vis(i), whether the shadow ray reaches the lamp.
/// - `distance`: dᵢ from the surface to the lamp, in scene units.
/// - `reflectance.diffuse`, `.specular`, `.shininess`: ρ_d and ρ_s per channel, and the exponent n.
/// - `n`: the unit normal N, on the eye's side.
/// - `to_light`: L, unit, from the surface to the lamp, which may be behind the surface.
/// - `to_eye`: V, unit, from the surface to the eye.
///
/// The slide's R is the mirror direction of the light, unit, away from the surface.
pub fn local_light(lit: &Lit) -> Rgb {
    let Lit { intensity, visible, distance, reflectance, n, to_light, to_eye } = *lit;
    todo!("E1.5: one term of eq:local")
}
