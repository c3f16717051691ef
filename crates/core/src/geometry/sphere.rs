use glam::DVec3;

use super::{Interval, Ray, gamma};

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub center: DVec3,
    /// Its radius, greater than 0; any other value is met by no ray.
    pub radius: f64,
}

impl Sphere {
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
        let (fd, ff, rr) = (f.dot(d), f.length_squared(), self.radius * self.radius);
        let (product, error) = (ff - rr, gamma(8) * (ff + rr));
        if fd >= 0.0 && product >= -error {
            // Outside or on the sphere and not approaching it: no root is positive.
            return None;
        }
        let dd = d.length_squared();
        let discriminant = dd * rr - f.cross(d).length_squared();
        // `>=` accepts: a NaN anywhere above ends here as a miss.
        if !(discriminant >= 0.0 && self.radius > 0.0) {
            return None;
        }
        let q = -fd - discriminant.sqrt().copysign(fd);
        // t = product / q, unless its sign is rounding noise.
        let by_product = if product.abs() > error { product / q } else { 0.0 };
        let by_sum = q / dd;
        let (near, far) =
            if by_product < by_sum { (by_product, by_sum) } else { (by_sum, by_product) };
        let inside = |t: f64| t > range.min && t < range.max && t < f64::INFINITY;
        [near, far].into_iter().find(|&t| t > 0.0 && inside(t))
    }
}
