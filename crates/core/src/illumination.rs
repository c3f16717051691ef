//! « Modèle d'éclairage »: from the rendering equation to the sum that the slides compute.
//!
//! ```text
//! eq:rendering            L(x, x') = g(x, x') [ ε(x, x') + ∫_Ω ρ(x, x', x'') L(x', x'') dx'' ]
//! eq:directional          I(x') = ε(x') + ∫_Ω ρ(x, x', x'') g(x', x'') I(x'') dx''
//! eq:direction-sets       S = { ωᵢ | L(ωᵢ) ≠ 0 },   S' = S ∪ { ωᵢ | ωᵢ = R or ωᵢ = T },   Ω' = Ω − S'
//! ```
//!
//! Of all directions the model keeps S', the lights, the mirror and the refracted direction, and puts
//! the constant `eq:ambient` in place of the rest, Ω'. (The slide writes dᵢ for ωᵢ, and Ω' = Ω − S; with S the mirror
//! directions would be counted twice.) What is left is one small function per term:
//! [`attenuation`], [`local`] and [`ambient`], and [`recursion`] adds what comes back along R and T.

use glam::DVec3;

use crate::Rgb;
use crate::geometry::{Ray, Real, Vector};
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
#[inline(always)]
pub fn attenuation<T: Real>(visible: T::Mask, distance: T) -> T {
    T::select(visible, (distance * distance).recip(), distance.all(0.0))
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
pub struct Reflectance<V: Vector = Rgb> {
    /// ρ_d.
    pub diffuse: V,
    /// ρ_s.
    pub specular: V,
    /// n, the exponent of the highlight.
    pub shininess: V::Scalar,
}

/// What a surface sends to the eye of the light that arrives from one direction, per unit of it: the bracket of
///
/// ```text
/// eq:local                I_local = Σᵢ Iᵢ · vis(i) / dᵢ² · ( ρ_d (N·L) + ρ_s (R·V)ⁿ )
/// ```
///
/// | slide        | here           |                                                        |
/// |--------------|----------------|--------------------------------------------------------|
/// | ρ_d, ρ_s, n  | `reflectance`  | [`Reflectance`]                                        |
/// | N            | `n`            | unit, on the eye's side                                |
/// | L            | `to_light`     | unit, from the surface to the light                    |
/// | V            | `to_eye`       | unit, from the surface to the eye                      |
/// | R            | inside         | the mirror of L: L comes in as −L, so R leaves the surface |
///
/// Both products are 0 below the horizon: a light behind the surface does not shine on it, and an
/// even power of a negative R·V would light the wrong side. [`lit`] is the sum, whose Iᵢ come in as
/// [`Arriving`].
///
/// OBJ files and many programs use (N·H)^Ns instead, H half-way between L and V; [`load`](crate::scene::load) says how
/// their exponents become n.
///
/// Slide « Modèle Local ». (The slide's sum runs from 0 to nbLum, one light too many.)
#[doc(alias = "eq:local")]
#[doc(alias = "modèle local")]
#[inline(always)]
pub fn local<V: Vector>(reflectance: &Reflectance<V>, n: V, to_light: V, to_eye: V) -> V {
    let (cos_light, cos_mirror) = (n.dot(to_light), reflect(-to_light, n).dot(to_eye));
    let zero = cos_light.all(0.0);
    let is_lit = zero.below(cos_light);
    let is_highlit = is_lit & zero.below(cos_mirror) & !reflectance.specular.is_zero();
    let highlight = reflectance.specular * cos_mirror.power(reflectance.shininess, is_highlit);
    V::select(is_lit, reflectance.diffuse * cos_light + highlight, n.all(Rgb::ZERO))
}

/// Light that arrives at a surface unless something is in its way.
#[derive(Clone, Copy, Debug)]
pub struct Arriving<I, V = DVec3> {
    /// From the surface to the light, which it reaches at t = 1.
    pub shadow_ray: Ray<V>,
    /// Iᵢ for L, the unit direction of that ray: of a point source, or of a sample of a lamp over its density.
    pub intensity: I,
}

impl<V: Vector, I: Fn(V) -> V> Arriving<I, V> {
    /// By a shadow ray, with an intensity.
    #[inline(always)]
    pub fn new(shadow_ray: Ray<V>, intensity: I) -> Self {
        Self { shadow_ray, intensity }
    }

    /// What the surface sends to the eye of it with vis = 1: one term of `eq:local`, 0 for a light behind the
    /// surface.
    #[inline(always)]
    pub fn unshadowed(&self, reflectance: &Reflectance<V>, n: V, to_eye: V) -> V {
        let direction = self.shadow_ray.direction;
        let cos_light = n.dot(direction);
        let is_before = cos_light.all(0.0).below(cos_light);
        let distance = direction.dot(direction).sqrt();
        let to_light = direction * distance.recip();
        let g = attenuation(is_before, distance);
        let arriving = (self.intensity)(to_light) * g * local(reflectance, n, to_light, to_eye);
        V::select(is_before, arriving, n.all(Rgb::ZERO))
    }
}

/// The light that leaves a surface without the help of other surfaces.
///
/// ```text
/// algo:appel              ε + ρ̄ I_a + Σᵢ Iᵢ vis(i)/dᵢ² ( ρ_d (N·L) + ρ_s (R·V)ⁿ )
/// ```
///
/// `unlit` is ε + ρ̄ I_a, to which the sum is added light by light; `n` is the unit shading normal on the eye's
/// side; `to_eye` is unit and points away from the surface. vis(i), `visible`, is asked last: no shadow ray is
/// cast to a light that would add nothing, because it is behind the surface or makes only a highlight that the eye
/// does not see.
///
/// Slides « Élimination des parties cachées [Appel 68] », « Modèle Local : calcul des ombres
/// portées ».
#[doc(alias = "algo:appel")]
#[doc(alias = "ombres portées")]
#[inline]
pub fn lit<I: Fn(DVec3) -> Rgb>(
    unlit: Rgb,
    reflectance: &Reflectance,
    n: DVec3,
    to_eye: DVec3,
    arriving: impl IntoIterator<Item = Arriving<I>>,
    mut visible: impl FnMut(&Ray) -> bool,
) -> Rgb {
    let mut radiance = unlit;
    if reflectance.diffuse == Rgb::ZERO && reflectance.specular == Rgb::ZERO {
        return radiance;
    }
    for light in arriving {
        let unshadowed = light.unshadowed(reflectance, n, to_eye);
        if unshadowed != Rgb::ZERO && visible(&light.shadow_ray) {
            radiance += unshadowed;
        }
    }
    radiance
}

/// Radiance along a ray.
///
/// ```text
/// eq:recursion            I_R = I_Local + k_s I_Refl + k_t I_Trans
/// ```
///
/// (The algorithm's last line on the slides adds the three components without k_s and k_t; the
/// formula is right.)
///
/// Slide « Intensité lumineuse sur un rayon ».
#[doc(alias = "eq:recursion")]
#[inline]
pub fn recursion(local: Rgb, k_s: Rgb, reflected: Rgb, k_t: Rgb, refracted: Rgb) -> Rgb {
    local + k_s * reflected + k_t * refracted
}
