//! What textbooks write and what goes wrong with it: the counterparts that the figures and the tests
//! compare the course's own code with.

use glam::DVec3;
use lancer_core::geometry::{Bounds3, Ray, Sphere};
use lancer_core::world::SurfacePoint;

/// Where a ray meets a triangle, after Möller and Trumbore, *Fast, Minimum Storage Ray/Triangle
/// Intersection*, 1997.
///
/// Neighbours compute different numbers for their common edge, so that a ray may pass between them.
pub fn moeller_trumbore([a, b, c]: [DVec3; 3], ray: &Ray) -> Option<f64> {
    let (e1, e2, s) = (b - a, c - a, ray.origin - a);
    let p = ray.direction.cross(e2);
    let inverse = 1.0 / e1.dot(p);
    let u = s.dot(p) * inverse;
    let q = s.cross(e1);
    let v = ray.direction.dot(q) * inverse;
    let t = e2.dot(q) * inverse;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}

/// A ray sheared into the z axis, for triangle tests that look at the signs of the edge functions alone.
#[derive(Clone, Copy, Debug)]
pub struct BySigns {
    origin: DVec3,
    axes: [usize; 3],
    shear: [f64; 3],
}

impl BySigns {
    /// Prepares the triangle tests of one ray.
    pub fn new(ray: &Ray) -> Self {
        let d = ray.direction.abs();
        let z = if d.x > d.y && d.x > d.z {
            0
        } else if d.y > d.z {
            1
        } else {
            2
        };
        let (axes, inverse) = ([(z + 1) % 3, (z + 2) % 3, z], 1.0 / ray.direction[z]);
        let shear = [ray.direction[axes[0]] * inverse, ray.direction[axes[1]] * inverse, inverse];
        Self { origin: ray.origin, axes, shear }
    }

    /// Where the ray meets a triangle by the watertight test with its edge functions rounded once, by a
    /// fused multiply-add, instead of twice: more accurate, and no longer antisymmetric.
    pub fn fused(&self, corners: [DVec3; 3]) -> Option<f64> {
        self.meet(corners, |p, q| p[0].mul_add(q[1], -(p[1] * q[0])))
    }

    /// Where the ray meets a triangle: a ray in the triangle's plane but beside it is sometimes taken for
    /// a hit.
    pub fn plain(&self, corners: [DVec3; 3]) -> Option<f64> {
        self.meet(corners, |p, q| p[0] * q[1] - p[1] * q[0])
    }

    #[inline(always)]
    fn meet(&self, corners: [DVec3; 3], edge: impl Fn([f64; 3], [f64; 3]) -> f64) -> Option<f64> {
        let ([x, y, z], [sx, sy, sz]) = (self.axes, self.shear);
        let [a, b, c] = corners.map(|corner| {
            let v = corner - self.origin;
            [v[x] - sx * v[z], v[y] - sy * v[z], v[z] * sz]
        });
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let det = u + v + w;
        let mixed = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
        let t = (u * a[2] + v * b[2] + w * c[2]) / det;
        (!mixed && det != 0.0 && t > 0.0).then_some(t)
    }
}

/// Where a ray enters a sphere, by the formula of the textbooks: its discriminant is the difference of
/// two large numbers when the sphere is far away or small.
pub fn textbook_sphere(sphere: Sphere, ray: &Ray) -> Option<f64> {
    let f = ray.origin - sphere.center;
    let (a, b) = (ray.direction.length_squared(), f.dot(ray.direction));
    let discriminant = b * b - a * (f.length_squared() - sphere.radius * sphere.radius);
    (discriminant >= 0.0).then(|| (-b - discriminant.sqrt()) / a)
}

/// Where a ray enters a box, in the form most often seen: with the language's `min` and `max`, which drop
/// the NaN of 0 · ∞ and keep the wrong operand. `inverse` is 1 / direction, here and below.
pub fn min_max_box(bounds: &Bounds3, origin: DVec3, inverse: DVec3) -> Option<f64> {
    let a = (bounds.min - origin) * inverse;
    let b = (bounds.max - origin) * inverse;
    let (mut near, mut far) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        near = near.max(a[axis].min(b[axis]));
        far = far.min(a[axis].max(b[axis]));
    }
    (near <= far).then_some(near)
}

/// The same with the `min` and `max` of SSE, which return their second operand when one is NaN.
pub fn sse_box(bounds: &Bounds3, origin: DVec3, inverse: DVec3) -> Option<f64> {
    let min = |a: f64, b: f64| if a < b { a } else { b };
    let max = |a: f64, b: f64| if a > b { a } else { b };
    let a = (bounds.min - origin) * inverse;
    let b = (bounds.max - origin) * inverse;
    let [first, last] = [0, 1]
        .map(|end| [0, 1, 2].map(|k| if end == 0 { min(a[k], b[k]) } else { max(a[k], b[k]) }));
    let near = max(max(first[0], first[1]), max(first[2], 0.0));
    let far = min(min(last[0], last[1]), last[2]);
    (near <= far).then_some(near)
}

/// Planes swapped into order, compared by "replace if better", not padded: Kay and Kajiya, *Ray Tracing
/// Complex Scenes*, 1986, as textbooks write it.
pub fn swapped_box(bounds: &Bounds3, origin: DVec3, inverse: DVec3) -> Option<f64> {
    swapped(bounds, origin, inverse, 1.0)
}

/// The same with the far plane padded by 2 γ(3): `Bounds3::IntersectP` of Pharr, Jakob, Humphreys,
/// *Physically Based Rendering*, 4th ed., §6.1.2.
pub fn padded_box(bounds: &Bounds3, origin: DVec3, inverse: DVec3) -> Option<f64> {
    swapped(bounds, origin, inverse, PAD)
}

/// 1 + 2 γ(3), which is 1 + 6 u = 1 + 3 ε.
const PAD: f64 = 1.0 + 3.0 * f64::EPSILON;

#[inline(always)]
fn swapped(bounds: &Bounds3, origin: DVec3, inverse: DVec3, pad: f64) -> Option<f64> {
    let (mut near, mut far) = (0.0, f64::INFINITY);
    for axis in 0..3 {
        let mut a = (bounds.min[axis] - origin[axis]) * inverse[axis];
        let mut b = (bounds.max[axis] - origin[axis]) * inverse[axis];
        if a > b {
            (a, b) = (b, a);
        }
        b *= pad;
        near = if a > near { a } else { near };
        far = if b < far { b } else { far };
        if near > far {
            return None;
        }
    }
    Some(near)
}

/// Planes picked by the direction's sign, the first axis taken as it comes: the faster form of the same
/// section of *Physically Based Rendering*. A NaN of the first axis is never replaced.
pub fn sign_picked_box(bounds: &Bounds3, origin: DVec3, inverse: DVec3) -> Option<f64> {
    let planes = |axis: usize| {
        let (first, last) = if inverse[axis] < 0.0 {
            (bounds.max[axis], bounds.min[axis])
        } else {
            (bounds.min[axis], bounds.max[axis])
        };
        let t = |plane: f64| (plane - origin[axis]) * inverse[axis];
        (t(first), t(last) * PAD)
    };
    let (mut near, mut far) = planes(0);
    for axis in 1..3 {
        let (a, b) = planes(axis);
        if near > b || a > far {
            return None;
        }
        near = if a > near { a } else { near };
        far = if b < far { b } else { far };
    }
    (near < f64::INFINITY && far > 0.0).then_some(near)
}

/// A shadow ray as textbooks start it: a fixed distance above the surface, in the scene's unit.
pub fn epsilon_shadow_ray(surface: &SurfacePoint, target: DVec3, epsilon: f64) -> Ray {
    let n = surface.geometric_normal;
    let side = epsilon.copysign(n.dot(target - surface.position));
    let origin = surface.position + side * n;
    Ray::new(origin, target - origin)
}
