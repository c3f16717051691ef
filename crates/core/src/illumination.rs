//! « Modèle d'éclairage »: from the rendering equation to the sum that the slides compute.
//!
//! ```text
//! eq:rendering            L(x, x') = g(x, x') [ ε(x, x') + ∫_Ω ρ(x, x', x'') L(x', x'') dx'' ]
//! eq:directional          I(x') = ε(x') + ∫_Ω ρ(x, x', x'') g(x', x'') I(x'') dx''
//! eq:direction-sets       S = { dᵢ | L(dᵢ) ≠ 0 },   S' = S ∪ { dᵢ | dᵢ = R or dᵢ = T },   Ω' = Ω − S'
//! ```
//!
//! Of all directions the model keeps S', the lights, the mirror and the refracted direction, and puts
//! the constant `eq:ambient` in place of the rest, Ω'. (The slide prints Ω' = Ω − S; with S the mirror
//! directions would be counted twice.) What is left is one small function per term:
//! [`attenuation`], [`local`] and [`ambient`]; the recursion over R and T is chapter 1's.

use glam::DVec3;

use crate::Rgb;
use crate::optics::reflect;

/// What a light contributes per unit of its intensity before the surface is looked at.
///
/// ```text
/// eq:attenuation          g(x', pᵢ) = vis(x', pᵢ) / d(x', pᵢ)²
/// ```
///
/// `visible` is vis, 1 or 0 on the slides; `distance` is d, in scene units.
///
/// Slide « Modèle d'éclairage : expression du modèle ».
#[doc(alias = "eq:attenuation")]
#[doc(alias = "atténuation")]
#[inline]
pub fn attenuation(visible: bool, distance: f64) -> f64 {
    if visible { 1.0 / (distance * distance) } else { 0.0 }
}

/// The term for all directions that the model does not follow.
///
/// ```text
/// eq:ambient              A(x') ≈ ρ̄(x') I_a
/// ```
///
/// `mean_reflectance` is ρ̄, here the diffuse reflectance; `ambient` is I_a.
///
/// Slide « Prise en compte des autres directions ».
#[doc(alias = "eq:ambient")]
#[doc(alias = "terme ambiant")]
#[inline]
pub fn ambient(mean_reflectance: Rgb, ambient: Rgb) -> Rgb {
    mean_reflectance * ambient
}

/// The constants of `eq:local` at one point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflectance {
    /// ρ_d.
    pub diffuse: Rgb,
    /// ρ_s.
    pub specular: Rgb,
    /// n, the exponent of the highlight.
    pub shininess: f64,
}

/// What one light sends to the eye by way of a surface: one term of the sum.
///
/// ```text
/// eq:local                I_local = Σᵢ Iᵢ · vis(i) / dᵢ² · ( ρ_d (N·L) + ρ_s (R·V)ⁿ )
/// ```
///
/// | slide        | here           |                                                        |
/// |--------------|----------------|--------------------------------------------------------|
/// | Iᵢ           | `intensity`    | of the light in the surface's direction                |
/// | vis(i) / dᵢ² | `attenuation`  | [`attenuation`], `eq:attenuation`                       |
/// | ρ_d, ρ_s, n  | `reflectance`  | [`Reflectance`]                                        |
/// | N            | `n`            | unit, on the eye's side                                |
/// | L            | `to_light`     | unit, from the surface to the light                    |
/// | V            | `to_eye`       | unit, from the surface to the eye                      |
/// | R            | inside         | the mirror of L: L comes in as −L, so R leaves the surface |
///
/// Both products are 0 below the horizon: a light behind the surface does not shine on it, and an
/// even power of a negative R·V would light the wrong side.
///
/// Slide « Modèle Local ». (The slide's sum runs from 0 to nbLum, one light too many.)
#[doc(alias = "eq:local")]
#[doc(alias = "modèle local")]
#[inline]
pub fn local(
    intensity: Rgb,
    attenuation: f64,
    reflectance: &Reflectance,
    n: DVec3,
    to_light: DVec3,
    to_eye: DVec3,
) -> Rgb {
    let cos_light = n.dot(to_light);
    if cos_light <= 0.0 {
        return Rgb::ZERO;
    }
    let mut reflected = reflectance.diffuse * cos_light;
    if reflectance.specular != Rgb::ZERO {
        let cos_mirror = reflect(-to_light, n).dot(to_eye);
        if cos_mirror > 0.0 {
            reflected += reflectance.specular * cos_mirror.powf(reflectance.shininess);
        }
    }
    intensity * attenuation * reflected
}
