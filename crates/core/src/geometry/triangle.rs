use glam::DVec3;

use super::{Ray, gamma};

/// The shear that turns a ray into the z axis; computed once per ray, used for every triangle.
///
/// Source: Woop, Benthin, Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013.
#[derive(Clone, Copy, Debug)]
pub struct Shear {
    /// The axis along which the direction is longest; it becomes z.
    axis: Axis,
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Clone, Copy, Debug)]
enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    /// Cyclic renaming of the components that makes this axis the last.
    #[inline(always)]
    fn to_last(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::X => [y, z, x],
            Self::Y => [z, x, y],
            Self::Z => [x, y, z],
        }
    }
}

impl Shear {
    /// Prepares the triangle tests of one ray.
    #[inline]
    pub fn new(direction: DVec3) -> Self {
        let d = direction.abs();
        let axis = if d.x > d.y && d.x > d.z {
            Axis::X
        } else if d.y > d.z {
            Axis::Y
        } else {
            Axis::Z
        };
        let [x, y, z] = axis.to_last(direction.to_array());
        let z = 1.0 / z;
        Self { axis, x: x * z, y: y * z, z }
    }
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// The ray parameter.
    pub t: f64,
    /// Weights of the three corners: each at least 0, their sum 1 up to rounding.
    pub barycentric: DVec3,
}

/// The watertight intersection of a ray with a triangle, from either side.
///
/// ```text
/// eq:ray-triangle     U = Cx By − Cy Bx,  V = Ax Cy − Ay Cx,  W = Bx Ay − By Ax
///                     t = (U Az + V Bz + W Cz) / (U + V + W)
/// ```
///
/// in coordinates sheared so that the ray is the z axis. Two triangles that share an edge compute
/// the same products for it, rounding is monotone, so an edge function never gets the wrong sign;
/// at worst it is 0, and 0 is inside for both neighbours. Hence no ray passes between them. The
/// products stay plain: `mul_add` would round one of the two and break the symmetry.
///
/// A ray *in* the triangle's plane meets it nowhere. There U, V and W are rounding noise whose signs
/// may agree by chance, so a hit must also lie in the range of the sheared corners.
///
/// Hits with `t` below their own error bound are dropped: they cannot be told from the origin. That
/// bound (Pharr, Jakob, Humphreys, *Physically Based Rendering*, 4th ed., §6.8.7, with the shear's own term
/// kept apart) is what lets rays leave a surface without a global epsilon; see [`super::leave_surface`].
#[doc(alias = "eq:ray-triangle")]
#[inline(always)] // Returned through memory its result costs as much again as the test.
pub fn intersect_triangle(corners: [DVec3; 3], ray: &Ray, shear: &Shear) -> Option<TriangleHit> {
    let [a, b, c] = corners.map(|corner| (corner - ray.origin).to_array());
    match shear.axis {
        Axis::X => sheared(Axis::X, [a, b, c], shear),
        Axis::Y => sheared(Axis::Y, [a, b, c], shear),
        Axis::Z => sheared(Axis::Z, [a, b, c], shear),
    }
}

/// The test for one renaming of the axes; `axis` is a constant at each call.
#[inline(always)]
fn sheared(axis: Axis, corners: [[f64; 3]; 3], shear: &Shear) -> Option<TriangleHit> {
    let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = corners.map(|corner| axis.to_last(corner));
    let (ax, ay) = (ax - shear.x * az, ay - shear.y * az);
    let (bx, by) = (bx - shear.x * bz, by - shear.y * bz);
    let (cx, cy) = (cx - shear.x * cz, cy - shear.y * cz);

    let u = cx * by - cy * bx;
    let v = ax * cy - ay * cx;
    let w = bx * ay - by * ax;
    if min(u, v, w) < 0.0 && max(u, v, w) > 0.0 {
        return None;
    }
    let det = u + v + w;
    if det == 0.0 || beside(ax, bx, cx) || beside(ay, by, cy) {
        return None;
    }
    let inverse = 1.0 / det;
    let reach = max_abs(az, bz, cz);
    let (az, bz, cz) = (shear.z * az, shear.z * bz, shear.z * cz);
    let t = (u * az + v * bz + w * cz) * inverse;

    let (max_x, max_y, max_z) = (max_abs(ax, bx, cx), max_abs(ay, by, cy), max_abs(az, bz, cz));
    let max_e = max_abs(u, v, w);
    let dx = gamma(5) * (max_x + shear.x.abs() * reach);
    let dy = gamma(5) * (max_y + shear.y.abs() * reach);
    let dz = gamma(3) * max_z;
    let de = 2.0 * (gamma(2) * max_x * max_y + dy * max_x + dx * max_y);
    let dt = 3.0 * (gamma(3) * max_e * max_z + de * max_z + dz * max_e) * inverse.abs();

    // An accepting comparison: a NaN anywhere above ends here as a miss.
    (t > dt && t < f64::INFINITY)
        .then(|| TriangleHit { t, barycentric: DVec3::new(u, v, w) * inverse })
}

/// Whether the ray, at 0 in sheared coordinates, lies outside the range of three corners.
#[inline(always)]
fn beside(a: f64, b: f64, c: f64) -> bool {
    min(a, b, c) > 0.0 || max(a, b, c) < 0.0
}

/// The smallest, by comparisons that become single instructions; `f64::min` also looks after NaN,
/// which the last test of [`sheared`] does.
#[inline(always)]
fn min(a: f64, b: f64, c: f64) -> f64 {
    let ab = if a < b { a } else { b };
    if ab < c { ab } else { c }
}

/// The largest, in the same way as [`min`].
#[inline(always)]
fn max(a: f64, b: f64, c: f64) -> f64 {
    let ab = if a > b { a } else { b };
    if ab > c { ab } else { c }
}

#[inline(always)]
fn max_abs(a: f64, b: f64, c: f64) -> f64 {
    max(a.abs(), b.abs(), c.abs())
}
