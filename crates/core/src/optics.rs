//! « Reflets spéculaires »: the directions of the mirror ray and of the refracted ray.

use glam::DVec3;

use crate::Rgb;
use crate::geometry::{Real, Vector};
use crate::scene::Material;
use crate::world::SurfacePoint;

/// How far the length of a unit vector may be from 1: a hundred reflections of one direction stay
/// within it.
const UNIT: f64 = 1e-9;

fn is_unit<V: Vector>(v: V) -> bool {
    let square = v.dot(v);
    let off = (square - square.all(1.0)).abs();
    V::Scalar::bits(!off.at_most(off.all(UNIT))) == 0
}

/// Direction of the mirror ray.
///
/// ```text
/// eq:reflected-ray        R = D − 2 (N·D) N
/// ```
///
/// | formula      | here       |                                                 |
/// |--------------|------------|-------------------------------------------------|
/// | D (slide: V) | `incident` | unit, travels *towards* the surface             |
/// | N            | `n`        | unit, either side: R does not change if N flips |
/// | R            | result     | unit, travels away from the surface             |
///
/// Slide « Reflets spéculaires : calcul du rayon réfléchi ».
#[doc(alias = "eq:reflected-ray")]
#[doc(alias = "reflected-ray")]
#[doc(alias = "rayon réfléchi")]
#[inline(always)]
pub fn reflect<V: Vector>(incident: V, n: V) -> V {
    debug_assert!(is_unit(incident) && is_unit(n));
    let two = n.dot(incident).all(2.0);
    incident - n * (two * n.dot(incident))
}

/// Direction of the refracted ray; `None` is total reflection.
///
/// ```text
/// eq:descartes            n₁ sin θ₁ = n₂ sin θ₂
///                         T = η D + (η cos θ₁ − cos θ₂) N,   η = n₁ / n₂
///                         cos² θ₂ = 1 − η² (1 − cos² θ₁)
/// ```
///
/// | formula      | here       |                                                        |
/// |--------------|------------|--------------------------------------------------------|
/// | D (slide: V) | `incident` | unit, travels *towards* the surface                    |
/// | N            | `n`        | unit, on the side the ray comes from: N·D ≤ 0          |
/// | n₁, n₂       | `n1`, `n2` | refractive indices before and behind the surface       |
/// | T            | result     | unit, travels away from the surface, on the other side |
///
/// Slide « Calcul du rayon réfracté : loi de Descartes ».
#[doc(alias = "eq:descartes")]
#[doc(alias = "descartes")]
#[doc(alias = "rayon réfracté")]
#[doc(alias = "snell")]
#[inline]
pub fn refract(incident: DVec3, n: DVec3, n1: f64, n2: f64) -> Option<DVec3> {
    let (direction, is_refracted) = refract_all(incident, n, n1, n2);
    is_refracted.then_some(direction)
}

/// [`refract`] for several rays side by side: the directions, and where there is one.
#[inline(always)]
pub fn refract_all<V: Vector>(
    incident: V,
    n: V,
    n1: V::Scalar,
    n2: V::Scalar,
) -> (V, <V::Scalar as Real>::Mask) {
    debug_assert!(is_unit(incident) && is_unit(n));
    let one = n1.all(1.0);
    let eta = n1 / n2;
    let cos1 = -n.dot(incident);
    // 1 − cos² as a product: it keeps the digits that the difference of squares loses at normal
    // incidence, where cos θ₁ is near 1.
    let sin1_squared = (one - cos1) * (one + cos1);
    let cos2_squared = one - eta * eta * sin1_squared;
    let direction = incident * eta + n * (eta * cos1 - cos2_squared.sqrt());
    (direction, n1.all(0.0).at_most(cos2_squared))
}

/// n₁ and n₂ of `eq:descartes`, before and behind a surface that a ray meets along `incident`: the outside, where
/// the geometric normal points, has the index 1. Only their quotient counts, so that a material's index is that of the
/// inside over that of the outside: no stack of the media around a ray is kept.
#[inline(always)]
pub fn indices<V: Vector, M>(
    surface: &SurfacePoint<V, M>,
    refractive_index: V::Scalar,
    incident: V,
) -> [V::Scalar; 2] {
    let cos = surface.geometric_normal.dot(incident);
    let (one, from_outside) = (cos.all(1.0), cos.below(cos.all(0.0)));
    [
        V::Scalar::select(from_outside, one, refractive_index),
        V::Scalar::select(from_outside, refractive_index, one),
    ]
}

/// The directions of the mirror ray and of the refracted ray at surfaces side by side, and where the reflection is not
/// total.
#[inline(always)]
pub fn directions<V: Vector, M>(
    surface: &SurfacePoint<V, M>,
    refractive_index: V::Scalar,
    incident: V,
) -> (V, (V, <V::Scalar as Real>::Mask)) {
    let n = surface.optical_normal(incident);
    let [n1, n2] = indices(surface, refractive_index, incident);
    (reflect(incident, n), refract_all(incident, n, n1, n2))
}

/// The two directions that `eq:recursion` follows from a surface, each with its share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branches {
    /// The share k_s of the mirror ray, after total reflection k_s + k_t, and its unit direction; `None` if the
    /// share is 0.
    pub mirror: Option<(Rgb, DVec3)>,
    /// The share k_t of the refracted ray and its unit direction; `None` if the share is 0, and at total
    /// reflection.
    pub refracted: Option<(Rgb, DVec3)>,
    /// Whether the surface lets light pass, but none in this direction.
    pub total_reflection: bool,
}

impl Branches {
    /// Where a ray of unit direction `incident` goes on from `surface`, which is made of `material`.
    ///
    /// At total reflection what does not pass goes the way of the mirror: there is no other.
    #[inline]
    pub fn new(surface: &SurfacePoint, material: &Material, incident: DVec3) -> Self {
        let (mirror, (refracted, is_refracted)) =
            directions(surface, material.refractive_index, incident);
        Self::along(material, mirror, is_refracted.then_some(refracted))
    }

    /// The same if the directions are known: that of the mirror ray, and that of the refracted ray unless the
    /// reflection is total.
    #[inline]
    pub fn along(material: &Material, mirror: DVec3, refracted: Option<DVec3>) -> Self {
        let (mut k_s, k_t) = (material.k_s, material.k_t);
        let total_reflection = k_t != Rgb::ZERO && refracted.is_none();
        if total_reflection {
            k_s += k_t;
        }
        let of = |k: Rgb, direction| (k != Rgb::ZERO).then_some((k, direction));
        let refracted = refracted.and_then(|direction| of(k_t, direction));
        Self { mirror: of(k_s, mirror), refracted, total_reflection }
    }

    /// k_s and k_t of `eq:recursion`, once it is known whether the reflection is total.
    #[inline]
    pub fn shares(&self) -> [Rgb; 2] {
        [self.mirror, self.refracted].map(|branch| branch.map_or(Rgb::ZERO, |(share, _)| share))
    }
}
