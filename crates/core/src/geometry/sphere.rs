use glam::DVec3;

use super::real::{cross, dot};
use super::{Bounds3, Interval, Ray, Real, gamma};

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub center: DVec3,
    /// Its radius, greater than 0; any other value is met by no ray.
    pub radius: f64,
}

impl Sphere {
    /// The smallest box around it, up to the rounding of its extent.
    pub fn bounds(&self) -> Bounds3 {
        let reach = DVec3::splat(self.radius);
        Bounds3 { min: self.center - reach, max: self.center + reach }
    }

    /// The smallest parameter in `range` at which the ray meets the sphere, from outside or inside.
    ///
    /// ```text
    /// eq:ray-sphere    t² (D·D) + 2 t (F·D) + F·F − r² = 0,   F = origin − centre
    /// ```
    ///
    /// The textbook discriminant (F·D)² − (D·D)(F·F − r²) cancels when the sphere is far or small.
    /// Here it comes from the distance of the centre to the line, (D·D) r² − |F×D|², and the root that
    /// would cancel comes from the product of the roots. Source: Haines, Günther, Akenine-Möller,
    /// *Precision Improvements for Ray/Sphere Intersection*, Ray Tracing Gems ch. 7 (their vector from
    /// the centre to the closest point has the length |F×D| / |D|; this form needs no division).
    ///
    /// The near root is dropped when it is below its own error bound, so that a ray leaving the
    /// sphere does not meet it again where it starts.
    #[doc(alias = "eq:ray-sphere")]
    #[inline]
    pub fn intersect(&self, ray: &Ray, range: Interval) -> Option<f64> {
        let (f, d) = (ray.origin - self.center, ray.direction);
        let (t, met) =
            intersect_spheres(f.to_array(), self.radius, d.to_array(), [range.min, range.max])?;
        met.then_some(t)
    }
}

/// [`Sphere::intersect`] for several spheres, or several rays, side by side: the parameters, and where they are hits;
/// `None` where there is none at all.
///
/// `f` is F, from the centres to the origins, `d` are the rays' directions, and a hit lies between `min` and `max`.
#[inline(always)]
pub fn intersect_spheres<T: Real>(
    f: [T; 3],
    radius: T,
    d: [T; 3],
    [min, max]: [T; 2],
) -> Option<(T, T::Mask)> {
    let zero = radius.all(0.0);
    let (fd, ff, rr) = (dot(f, d), dot(f, f), radius * radius);
    let (product, error) = (ff - rr, radius.all(gamma(8)) * (ff + rr));
    // Outside or on the sphere and not approaching it no root is positive.
    let approaching = !(zero.at_most(fd) & (-error).at_most(product));
    let dd = dot(d, d);
    let moment = cross(f, d);
    let discriminant = dd * rr - dot(moment, moment);
    // An accepting comparison: a NaN anywhere above ends here as a miss.
    let meets = approaching & zero.at_most(discriminant) & zero.below(radius);
    if T::bits(meets) == 0 {
        return None;
    }
    let q = -fd - discriminant.sqrt().copysign(fd);
    // t = product / q, unless its sign is rounding noise.
    let by_product = T::select(error.below(product.abs()), product / q, zero);
    let by_sum = q / dd;
    let in_order = by_product.below(by_sum);
    let near = T::select(in_order, by_product, by_sum);
    let far = T::select(in_order, by_sum, by_product);
    // What is compared with NaN last is NaN, and so no hit.
    let (min, max) = (zero.larger(min), zero.all(f64::INFINITY).smaller(max));
    let t = T::select(min.below(near) & near.below(max), near, far);
    Some((t, meets & min.below(t) & t.below(max)))
}
