//! E1.2 Where a ray meets a triangle. Slide « Algorithme : calcul et tri des intersections ».

use chapter_1::exercises::prelude::*;

/// Where a ray meets a triangle, from either side: t, and the weights of the corners a, b and c there.
pub fn ray_triangle(corners: [DVec3; 3], ray: &Ray) -> Option<Meeting> {
    let [a, b, c] = corners.map(|corner| sheared(corner, ray));
    // E_A, E_B and E_C.
    let (u, v, w) = (edge(b, c), edge(c, a), edge(a, b));
    if u.min(v).min(w) < 0.0 && u.max(v).max(w) > 0.0 {
        return None;
    }
    let is_outside = |a: f64, b: f64, c: f64| a.min(b).min(c) > 0.0 || a.max(b).max(c) < 0.0;
    if is_outside(a.x, b.x, c.x) || is_outside(a.y, b.y, c.y) {
        return None;
    }
    let det = u + v + w;
    let t = (u * a.z + v * b.z + w * c.z) / det;
    // What is right is accepted: a NaN fails every comparison.
    (t > 0.0 && t.is_finite()).then(|| (t, DVec3::new(u, v, w) / det))
}

/// On which side of the edge from p to q the ray passes; 0 is on it.
fn edge(p: DVec3, q: DVec3) -> f64 {
    q.x * p.y - q.y * p.x
}

/// A corner in coordinates in which the ray is the z axis.
fn sheared(corner: DVec3, ray: &Ray) -> DVec3 {
    let (v, d) = (corner - ray.origin, ray.direction);
    // The axis along which the direction is longest becomes z.
    let z = d.abs().max_position();
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let inverse = 1.0 / d[z];
    DVec3::new(v[x] - d[x] * inverse * v[z], v[y] - d[y] * inverse * v[z], v[z] * inverse)
}
