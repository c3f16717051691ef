use glam::DVec3;

use super::{Ray, Real, gamma};

/// The shear that turns a ray, or several side by side, into the z axis; computed once, used for every
/// triangle.
///
/// Source: Woop, Benthin, Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013.
#[derive(Clone, Copy, Debug)]
pub struct Shear<T = f64> {
    axis: Axis,
    x: T,
    y: T,
    z: T,
}

/// The axis along which a direction is longest; the shear makes it z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third, also of a direction that is not longer along one of the others.
    Z,
}

impl Axis {
    /// The longest of a direction.
    #[inline]
    pub fn longest(direction: DVec3) -> Self {
        let d = direction.abs();
        if d.x > d.y && d.x > d.z {
            Self::X
        } else if d.y > d.z {
            Self::Y
        } else {
            Self::Z
        }
    }

    /// Cyclic renaming of the components that makes this axis the last.
    #[inline(always)]
    fn to_last<T>(self, [x, y, z]: [T; 3]) -> [T; 3] {
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
        Self::along(Axis::longest(direction), direction.to_array())
    }
}

impl<T: Real> Shear<T> {
    /// The same for rays whose directions have one longest axis.
    #[inline(always)]
    pub fn along(axis: Axis, direction: [T; 3]) -> Self {
        let [x, y, z] = axis.to_last(direction);
        let z = z.recip();
        Self { axis, x: x * z, y: y * z, z }
    }

    /// A point relative to the origin, sheared: x and y, and z as it was.
    #[inline(always)]
    fn flatten(&self, point: [T; 3]) -> [T; 3] {
        let [x, y, z] = self.axis.to_last(point);
        [x - self.x * z, y - self.y * z, z]
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
/// eq:ray-triangle     E_A = Cx By − Cy Bx,  E_B = Ax Cy − Ay Cx,  E_C = Bx Ay − By Ax
///                     t = (E_A Az + E_B Bz + E_C Cz) / (E_A + E_B + E_C)
/// ```
///
/// in coordinates sheared so that the ray is the z axis (U, V and W for E_A, E_B and E_C in the paper of
/// [`Shear`]). Two triangles that share an edge compute the same products for it, rounding is monotone, so
/// an edge function never gets the wrong sign; at worst it is 0, and 0 is inside for both neighbours. Hence
/// no ray passes between them. The products stay plain: `mul_add` would round one of the two and break the
/// symmetry.
///
/// A ray *in* the triangle's plane meets it nowhere. There the edge functions are rounding noise whose signs
/// may agree by chance, so a hit must also lie in the range of the sheared corners.
///
/// Hits with `t` below their own error bound are dropped: they cannot be told from the origin. That
/// bound (Pharr, Jakob, Humphreys, *Physically Based Rendering*, 4th ed., §6.8.7, with the shear's own term
/// kept apart) is what lets rays leave a surface without a global epsilon; see [`super::leave_surface`].
#[doc(alias = "eq:ray-triangle")]
#[inline(always)] // Returned through memory its result costs as much again as the test.
pub fn intersect_triangle(corners: [DVec3; 3], ray: &Ray, shear: &Shear) -> Option<TriangleHit> {
    let corners = corners.map(|corner| (corner - ray.origin).to_array());
    let (t, weights, met) = intersect_triangles(corners, shear, [0.0, f64::INFINITY])?;
    met.then(|| TriangleHit { t, barycentric: weights.into() })
}

/// [`intersect_triangle`] for several triangles, or several rays, side by side: the parameters, the weights, and where
/// they are those of hits with min < t ≤ max; `None` where there is none at all. `corners` are relative to the rays'
/// origins.
#[inline(always)]
pub fn intersect_triangles<T: Real>(
    corners: [[T; 3]; 3],
    shear: &Shear<T>,
    [min, max]: [T; 2],
) -> Option<(T, [T; 3], T::Mask)> {
    for_each_axis(
        shear,
        #[inline(always)]
        |shear| sheared(corners, shear, [min, max]),
    )
}

/// The parameters and weights of [`intersect_triangle`], of rays that are known to meet their triangles, and
/// without its checks. `corners` are relative to the rays' origins.
#[inline(always)]
pub fn solve_triangle<T: Real>(corners: [[T; 3]; 3], shear: &Shear<T>) -> (T, [T; 3]) {
    for_each_axis(
        shear,
        #[inline(always)]
        |shear| {
            let [a, b, c] = corners;
            let corners = [shear.flatten(a), shear.flatten(b), shear.flatten(c)];
            let [u, v, w] = edge_functions(corners);
            let inverse = (u + v + w).recip();
            (parameter(corners, [u, v, w], shear, inverse), [u * inverse, v * inverse, w * inverse])
        },
    )
}

/// Compiles `f` once for each axis: then the renaming costs nothing.
#[inline(always)]
fn for_each_axis<T: Copy, R>(shear: &Shear<T>, f: impl Fn(&Shear<T>) -> R) -> R {
    match shear.axis {
        Axis::X => f(&Shear { axis: Axis::X, ..*shear }),
        Axis::Y => f(&Shear { axis: Axis::Y, ..*shear }),
        Axis::Z => f(&Shear { axis: Axis::Z, ..*shear }),
    }
}

/// The edge functions E_A, E_B and E_C of sheared corners.
#[inline(always)]
fn edge_functions<T: Real>([[ax, ay, _], [bx, by, _], [cx, cy, _]]: [[T; 3]; 3]) -> [T; 3] {
    [cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax]
}

/// t, given 1 / (E_A + E_B + E_C).
#[inline(always)]
fn parameter<T: Real>(
    [a, b, c]: [[T; 3]; 3],
    [u, v, w]: [T; 3],
    shear: &Shear<T>,
    inverse: T,
) -> T {
    (u * (shear.z * a[2]) + v * (shear.z * b[2]) + w * (shear.z * c[2])) * inverse
}

/// The test for one renaming of the axes; the axis is a constant at each call.
#[inline(always)]
fn sheared<T: Real>(
    corners: [[T; 3]; 3],
    shear: &Shear<T>,
    [min_t, max_t]: [T; 2],
) -> Option<(T, [T; 3], T::Mask)> {
    let [a, b, c] = corners;
    let corners = [shear.flatten(a), shear.flatten(b), shear.flatten(c)];
    let [u, v, w] = edge_functions(corners);
    let zero = u.all(0.0);
    let inside = !(min(u, v, w).below(zero) & zero.below(max(u, v, w)));
    if T::bits(inside) == 0 {
        return None;
    }
    let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = corners;
    let det = u + v + w;
    let is_flat = det.at_most(zero) & zero.at_most(det);
    let met = inside & !is_flat & !beside(ax, bx, cx) & !beside(ay, by, cy);
    if T::bits(met) == 0 {
        return None;
    }
    let inverse = det.recip();
    let t = parameter(corners, [u, v, w], shear, inverse);
    // The plane of a surface that a ray leaves is met outside the range, if only just: no bound is needed there.
    let met = met & min_t.below(t) & t.at_most(max_t);
    if T::bits(met) == 0 {
        return None;
    }

    let reach = max_abs(az, bz, cz);
    let (max_x, max_y) = (max_abs(ax, bx, cx), max_abs(ay, by, cy));
    let max_z = max_abs(shear.z * az, shear.z * bz, shear.z * cz);
    let max_e = max_abs(u, v, w);
    let dx = times(gamma(5), max_x + shear.x.abs() * reach);
    let dy = times(gamma(5), max_y + shear.y.abs() * reach);
    let dz = times(gamma(3), max_z);
    let de = times(2.0, times(gamma(2), max_x) * max_y + dy * max_x + dx * max_y);
    let dt = times(3.0, times(gamma(3), max_e) * max_z + de * max_z + dz * max_e) * inverse.abs();

    // An accepting comparison: a NaN anywhere above ends here as a miss.
    let met = met & dt.below(t) & t.below(zero.all(f64::INFINITY));
    Some((t, [u * inverse, v * inverse, w * inverse], met))
}

#[inline(always)]
fn times<T: Real>(factor: f64, x: T) -> T {
    x.all(factor) * x
}

/// Whether the ray, at 0 in sheared coordinates, lies outside the range of three corners.
#[inline(always)]
fn beside<T: Real>(a: T, b: T, c: T) -> T::Mask {
    let zero = a.all(0.0);
    !(min(a, b, c).at_most(zero) & zero.at_most(max(a, b, c)))
}

#[inline(always)]
fn min<T: Real>(a: T, b: T, c: T) -> T {
    a.smaller(b).smaller(c)
}

#[inline(always)]
fn max<T: Real>(a: T, b: T, c: T) -> T {
    a.larger(b).larger(c)
}

#[inline(always)]
fn max_abs<T: Real>(a: T, b: T, c: T) -> T {
    max(a.abs(), b.abs(), c.abs())
}
