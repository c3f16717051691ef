//! E1.3 Where a ray meets a sphere. Slide « Algorithme : calcul et tri des intersections ».

use chapter_1::exercises::prelude::*;

/// With F = origin − centre, a difference F·F − r² below this share of F·F + r² is rounding noise: count it as 0.
const NOISE: f64 = 1e-15;

/// The smallest t > 0 at which a ray meets a sphere, from outside or from inside: `Some(t)`, or `None`.
///
/// - `sphere.center`, a `DVec3`, and `sphere.radius`, greater than 0 (crates/core/src/geometry/sphere.rs).
/// - `ray.origin`, `ray.direction`: the direction has any length; t is in units of it, and may be as small
///   as it likes.
///
/// A ray that just touches the sphere meets it. A ray that starts on the sphere, up to [`NOISE`], does not
/// meet it there. The answer has all its digits also when the sphere is a million radii away.
pub fn ray_sphere(sphere: &Sphere, ray: &Ray) -> Option<f64> {
    todo!("E1.3: the roots of the quadratic, without cancellation")
}
