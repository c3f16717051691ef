//! Lamps sampled by the solid angle under which they are seen.

use std::f64::consts::{FRAC_1_PI, PI};

use glam::{DVec2, DVec3};

use super::directions::{around, concentric};
use super::patch::LampSample;
use super::surfaces::parallelogram;
use crate::geometry::Sphere;

/// How far from 1 the ratio of a rectangle's farthest to its nearest point must be for sampling by solid angle to be
/// worth its time: by area, the samples' weights span the cube of it.
const NEAR: f64 = 1.3;
/// The least solid angle that is sampled as such: down to it, the samples' places err by less than 10⁻¹⁰ of a side. A
/// smaller lamp adds little, however it is sampled.
const SMALL: f64 = 1e-5;
/// How far the cosine of a rectangle's angles may be from 0. Coordinates come with six digits; the densities are off
/// by as much.
const SKEW: f64 = 1e-6;

/// The solid angle of a triangle, in steradians, from 0 to 2π.
///
/// ```text
/// eq:solid-angle          tan(Ω/2) = |a · ((b−a) × (c−a))| / ( |a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b| )
/// ```
///
/// The corners a, b and c are relative to where it is seen from. Unlike the sum of the angles minus π, this keeps its
/// digits however small the triangle is.
///
/// Source: van Oosterom, Strackee, *The Solid Angle of a Plane Triangle*, IEEE Transactions on Biomedical Engineering
/// 30(2), 1983.
#[doc(alias = "eq:solid-angle")]
#[doc(alias = "angle solide")]
#[inline]
pub fn triangle_solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let volume = a.dot((b - a).cross(c - a)).abs();
    2.0 * volume.atan2(half_tangent_divisor([a, b, c]))
}

/// What the volume is divided by for tan(Ω/2).
#[inline]
fn half_tangent_divisor([a, b, c]: [DVec3; 3]) -> f64 {
    let [la, lb, lc] = [a.length(), b.length(), c.length()];
    la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb
}

/// The solid angle of a parallelogram, in steradians, from 0 to 2π: that of its two triangles.
///
/// `corner` is relative to where it is seen from.
#[inline]
pub fn parallelogram_solid_angle(corner: DVec3, edges: [DVec3; 2]) -> f64 {
    let [left, right] = edges.map(|edge| corner + edge);
    let opposite = left + edges[1];
    let volume = corner.dot(edges[0].cross(edges[1])).abs();
    let first = half_tangent_divisor([corner, left, right]);
    let second = half_tangent_divisor([opposite, right, left]);
    // The two half angles at once: the angle of a product of complex numbers is the sum of theirs, at most π.
    2.0 * (volume * (first + second)).atan2(first * second - volume * volume)
}

/// A rectangle, from which points can be picked by solid angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    corner: DVec3,
    edges: [DVec3; 2],
    /// Unit vectors along the edges, and the normal of the side that it shows.
    axes: [DVec3; 3],
    /// The lengths of the edges.
    sides: [f64; 2],
}

impl Rectangle {
    /// The rectangle that two edges span from a corner, seen from the side where they turn counter-clockwise; `None`
    /// if their angle is no right one, or it has no area.
    pub fn new(corner: DVec3, edges: [DVec3; 2]) -> Option<Self> {
        let sides = edges.map(DVec3::length);
        let skew = edges[0].dot(edges[1]).abs();
        let normal = edges[0].cross(edges[1]).try_normalize()?;
        let x = edges[0] / sides[0];
        let axes = [x, normal.cross(x), normal];
        (skew <= SKEW * sides[0] * sides[1]).then_some(Self { corner, edges, axes, sides })
    }

    /// Its unit normal, to the side that it shows.
    #[inline]
    pub(super) fn normal(&self) -> DVec3 {
        self.axes[2]
    }

    /// A point of it, of density 1/A everywhere.
    #[inline]
    pub(super) fn point(&self, u: [f64; 2]) -> DVec3 {
        parallelogram(self.corner, self.edges, u)
    }

    /// It as seen from a point; `None` from its back and from its plane.
    #[inline]
    pub fn seen_from(&self, from: DVec3) -> Option<SphericalRectangle<'_>> {
        self.seen_if(from, |_, _| true)
    }

    /// The same, if sampling it by solid angle is better than by area: from near, and unless it is too small.
    ///
    /// By area the weights are as the cubes of the distances, whose ratio is κ, from the farthest point to the
    /// nearest. It is worth its time for κ > 1.3, where the deviation of one sample by area exceeds a fifth of the
    /// mean. The corners alone do not tell: from close to its middle all four are equally far.
    #[inline]
    pub(super) fn by_solid_angle(&self, from: DVec3) -> Option<SphericalRectangle<'_>> {
        let is_near = |nearest: DVec3, farthest: DVec3| {
            farthest.length_squared() > NEAR * NEAR * nearest.length_squared()
        };
        self.seen_if(from, is_near).filter(|seen| seen.solid_angle >= SMALL)
    }

    /// It as seen from a point, if that is in front of it and its nearest and farthest point pass.
    #[inline]
    fn seen_if(
        &self,
        from: DVec3,
        passes: impl Fn(DVec3, DVec3) -> bool,
    ) -> Option<SphericalRectangle<'_>> {
        let corner = self.corner - from;
        let [x, y, z] = self.axes.map(|axis| axis.dot(corner));
        let (x, y) = ([x, x + self.sides[0]], [y, y + self.sides[1]]);
        let nearest = DVec3::new(within(x, 0.0), within(y, 0.0), z);
        let farthest = |[min, max]: [f64; 2]| min.abs().max(max.abs());
        if !(z < 0.0 && passes(nearest, DVec3::new(farthest(x), farthest(y), z))) {
            return None;
        }
        let solid_angle = parallelogram_solid_angle(corner, self.edges);
        Some(SphericalRectangle { rectangle: self, x, y, z, solid_angle })
    }
}

/// The number of an interval that is nearest to `x`.
#[inline]
fn within([min, max]: [f64; 2], x: f64) -> f64 {
    x.max(min).min(max)
}

/// A [`Rectangle`] as seen from a point, in its own axes.
#[derive(Clone, Copy, Debug)]
pub struct SphericalRectangle<'a> {
    rectangle: &'a Rectangle,
    x: [f64; 2],
    y: [f64; 2],
    /// Below 0: the normal points at the eye.
    z: f64,
    solid_angle: f64,
}

impl SphericalRectangle<'_> {
    /// Its solid angle Ω, in steradians.
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// The density 1/Ω of each direction towards it, per solid angle.
    #[inline]
    pub fn density(&self) -> f64 {
        1.0 / self.solid_angle
    }

    /// A point of it, in a direction evenly picked of those towards it.
    ///
    /// ```text
    ///                         S(x) = u Ω,   h(y) = h(y₀) + v ( h(y₁) − h(y₀) ),   h(y) = y / √(x² + y² + z²)
    /// ```
    ///
    /// The first number picks x by S, the solid angle to its left, the second y by the height h on the sphere. With
    /// γ₂ and γ₃ the angles on the left of the spherical rectangle, β₀ and β₁ those of the lower and the upper plane
    /// through its edges to its own:
    ///
    /// ```text
    ///                         x = ± z sin a / √( (cos a − cos(β₀ − β₁)) (cos a − cos(β₀ + β₁)) ),   a = u Ω − γ₂ − γ₃
    /// ```
    ///
    /// Angles are held by their cosines and sines, as complex numbers, and the differences are products of the sines
    /// of half angles. (The paper's form has cosines alone, which are noise where the eye is nearly in the plane:
    /// from 10⁻⁶ of a side above it, x errs by 4·10⁻⁴ of a side.)
    ///
    /// Source: Ureña, Fajardo, King, *An Area-Preserving Parametrization for Spherical Rectangles*, EGSR 2013.
    #[inline]
    pub fn sample(&self, [u, v]: [f64; 2]) -> DVec3 {
        let ([x0, x1], [y0, y1], z) = (self.x, self.y, self.z);
        // The plane through an edge, by its angle to the rectangle.
        let plane = |outward: f64| DVec2::new(outward, -z) / (outward * outward + z * z).sqrt();
        let [bottom, top, left] = [plane(-y0), plane(y1), plane(-x0)];
        let to_left = half(between(top, left)).rotate(half(between(left, bottom)));
        let half_a = turned_back(DVec2::from_angle(0.5 * u * self.solid_angle), to_left);

        let [lower, upper] = [half(bottom), half(top)];
        let sines = |b: DVec2| half_a.rotate(b).y * turned_back(half_a, b).y;
        let root = sines(turned_back(lower, upper)) * sines(lower.rotate(upper));
        let a = half_a.rotate(half_a);
        let side = (a.x * bottom.x - top.x).signum();
        let x = within([x0, x1], -0.5 * z * side * a.y / root.max(0.0).sqrt());

        let d_squared = x * x + z * z;
        let height = |y: f64| y / (d_squared + y * y).sqrt();
        let (h0, h1) = (height(y0), height(y1));
        let h = h0 + v * (h1 - h0);
        let y = within(self.y, h * (d_squared / ((1.0 - h) * (1.0 + h))).sqrt());

        let [width, depth] = self.rectangle.sides;
        self.rectangle.point([(x - x0) / width, (y - y0) / depth])
    }
}

/// The angle of a spherical rectangle between two sides, given those of their planes.
#[inline]
fn between(a: DVec2, b: DVec2) -> DVec2 {
    DVec2::new(-a.x * b.x, (a.y * a.y + a.x * a.x * b.y * b.y).sqrt())
}

/// Half an angle between 0 and π.
#[inline]
fn half(angle: DVec2) -> DVec2 {
    // The larger part by a root, the smaller by what they have to make: sin = 2 sin ½ cos ½.
    let larger = (0.5 + 0.5 * angle.x.abs()).sqrt();
    let smaller = 0.5 * angle.y / larger;
    if angle.x >= 0.0 { DVec2::new(larger, smaller) } else { DVec2::new(smaller, larger) }
}

/// The difference of two angles.
#[inline]
fn turned_back(a: DVec2, b: DVec2) -> DVec2 {
    DVec2::new(b.x, -b.y).rotate(a)
}

/// A sphere as it is seen from a point outside, as a cone of directions.
#[derive(Clone, Copy, Debug)]
pub struct SeenSphere {
    sphere: Sphere,
    /// Unit, towards the centre.
    axis: DVec3,
    /// Sine and cosine of the cone's half angle.
    sin: f64,
    cos: f64,
}

impl SeenSphere {
    /// `sphere` as seen from a point; `None` from inside and from the surface itself, where none of its outside is
    /// seen, and if it has no radius.
    #[inline]
    pub fn new(sphere: Sphere, from: DVec3) -> Option<Self> {
        let to_center = sphere.center - from;
        let distance = to_center.length();
        let sin = sphere.radius / distance;
        let cos_squared = (distance - sphere.radius) * (distance + sphere.radius);
        (cos_squared > 0.0 && sin > 0.0).then(|| Self {
            sphere,
            axis: to_center / distance,
            sin,
            cos: cos_squared.sqrt() / distance,
        })
    }

    /// 1 − cos of the half angle, which from afar the difference would lose.
    #[inline]
    fn one_minus_cos(&self) -> f64 {
        self.sin * self.sin / (1.0 + self.cos)
    }

    /// The solid angle 2π (1 − cos θ) of the cone, in steradians.
    #[inline]
    pub fn solid_angle(&self) -> f64 {
        2.0 * PI * self.one_minus_cos()
    }

    /// The density, per solid angle, of each direction towards the sphere.
    #[inline]
    pub fn density(&self) -> f64 {
        0.5 * FRAC_1_PI / self.one_minus_cos()
    }

    /// The point of the sphere, on the side that is seen, in a direction evenly picked of the cone.
    ///
    /// With θ the direction's angle to the axis and s the sine of the cone's half angle, the centre sees the point at
    /// the angle α from where it is seen from:
    ///
    /// ```text
    ///                         q = sin θ / s,   sin α = sin θ (1/s² − 1) / (cos θ / s + √(1 − q²))
    ///                         cos α = s q² + cos θ √(1 − q²)
    /// ```
    ///
    /// Neither cancels, from afar or near.
    #[inline]
    pub fn sample(&self, u: [f64; 2]) -> LampSample {
        let (r, direction) = concentric(u);
        let one_minus_cos = r * r * self.one_minus_cos();
        let q_squared = (r * r * (2.0 - one_minus_cos) / (1.0 + self.cos)).min(1.0);
        let (q, far) = (q_squared.sqrt(), (1.0 - q_squared).sqrt());
        let cos_theta = 1.0 - one_minus_cos;
        let sin_alpha = q * (self.cos * self.cos) / (cos_theta + self.sin * far);
        let cos_alpha = self.sin * q_squared + cos_theta * far;
        let local = (sin_alpha.copysign(r) * direction).extend(-cos_alpha);
        let position = self.sphere.center + self.sphere.radius * around(self.axis, local);
        LampSample { position, density: self.density() }
    }
}
