//! What textbooks write and what goes wrong with it: the counterparts that the figures and the tests
//! compare the course's own code with.

use glam::DVec3;
use lancer_core::geometry::{Ray, Sphere};

/// Whether a ray meets a triangle, after Möller and Trumbore, *Fast, Minimum Storage Ray/Triangle
/// Intersection*, 1997.
///
/// Neighbours compute different numbers for their common edge, so that a ray may pass between them.
pub fn moeller_trumbore([a, b, c]: [DVec3; 3], ray: &Ray) -> bool {
    let (e1, e2, s) = (b - a, c - a, ray.origin - a);
    let p = ray.direction.cross(e2);
    let inverse = 1.0 / e1.dot(p);
    let u = s.dot(p) * inverse;
    let q = s.cross(e1);
    let v = ray.direction.dot(q) * inverse;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && e2.dot(q) * inverse > 0.0
}

/// Whether a ray meets a triangle by the watertight test with its edge functions rounded once, by a
/// fused multiply-add, instead of twice: more accurate, and no longer antisymmetric.
pub fn fused_edges(corners: [DVec3; 3], ray: &Ray) -> bool {
    by_signs(corners, ray, |p, q| p[0].mul_add(q[1], -(p[1] * q[0])))
}

/// Whether a ray meets a triangle by the signs of the edge functions alone: a ray in the triangle's plane
/// but beside it is sometimes taken for a hit.
pub fn signs_only(corners: [DVec3; 3], ray: &Ray) -> bool {
    by_signs(corners, ray, |p, q| p[0] * q[1] - p[1] * q[0])
}

fn by_signs(corners: [DVec3; 3], ray: &Ray, edge: impl Fn([f64; 3], [f64; 3]) -> f64) -> bool {
    let d = ray.direction.abs();
    let z = if d.x > d.y && d.x > d.z {
        0
    } else if d.y > d.z {
        1
    } else {
        2
    };
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let (sx, sy) = (ray.direction[x] / ray.direction[z], ray.direction[y] / ray.direction[z]);
    let [a, b, c] = corners.map(|corner| {
        let v = corner - ray.origin;
        [v[x] - sx * v[z], v[y] - sy * v[z], v[z] / ray.direction[z]]
    });
    let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
    let det = u + v + w;
    let mixed = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
    !mixed && det != 0.0 && (u * a[2] + v * b[2] + w * c[2]) / det > 0.0
}

/// Where a ray enters a sphere, by the formula of the textbooks: its discriminant is the difference of
/// two large numbers when the sphere is far away or small.
pub fn textbook_sphere(sphere: Sphere, ray: &Ray) -> Option<f64> {
    let f = ray.origin - sphere.center;
    let (a, b) = (ray.direction.length_squared(), f.dot(ray.direction));
    let discriminant = b * b - a * (f.length_squared() - sphere.radius * sphere.radius);
    (discriminant >= 0.0).then(|| (-b - discriminant.sqrt()) / a)
}
