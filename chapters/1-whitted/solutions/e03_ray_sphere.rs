//! E1.3 Where a ray meets a sphere. Slide « Algorithme : calcul et tri des intersections ».

use chapter_1::exercises::prelude::*;

/// With F = origin − centre, a difference F·F − r² below this share of F·F + r² is rounding noise: count it as 0.
const NOISE: f64 = 1e-15;

/// The smallest t > 0 at which a ray meets a sphere, from outside or from inside.
pub fn ray_sphere(sphere: &Sphere, ray: &Ray) -> Option<f64> {
    let (f, d) = (ray.origin - sphere.center, ray.direction);
    let (dd, fd, ff) = (d.length_squared(), f.dot(d), f.length_squared());
    let rr = sphere.radius * sphere.radius;
    let discriminant = dd * rr - f.cross(d).length_squared();
    if discriminant < 0.0 {
        return None;
    }
    let difference = ff - rr;
    let product = if difference.abs() > NOISE * (ff + rr) { difference } else { 0.0 };
    // Both have one sign: nothing cancels.
    let q = -fd - discriminant.sqrt().copysign(fd);
    let (a, b) = (product / q, q / dd);
    [a.min(b), a.max(b)].into_iter().find(|t| *t > 0.0)
}
