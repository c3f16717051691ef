//! Boxes and rays that touch them, whose exact answer is known: the inputs are dyadic, and every ray passes
//! through the chosen point of its box without any rounding. The figures and the tests share them.

use glam::DVec3;
use lancer_core::geometry::{Bounds3, Ray};
use lancer_core::sampling::Uniform;

/// Where on the box a ray passes, and how it runs there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Class {
    Face,
    Edge,
    Corner,
    CornerAtMillion,
    CornerFromAfar,
    CornerAnyLength,
    PlusZero,
    MinusZero,
    Denormal,
    OriginOnPlane,
    OriginInside,
    PointBox,
    FlatBox,
}

impl Class {
    /// Every class with its name.
    pub const ALL: [(Self, &str); 13] = [
        (Self::Face, "face"),
        (Self::Edge, "edge"),
        (Self::Corner, "corner"),
        (Self::CornerAtMillion, "corner at 10⁶"),
        (Self::CornerFromAfar, "corner from 10¹⁰ away"),
        (Self::CornerAnyLength, "corner |D| 10⁻¹² to 10¹²"),
        (Self::PlusZero, "in a face plane +0"),
        (Self::MinusZero, "in a face plane −0"),
        (Self::Denormal, "in a face plane ±denormal"),
        (Self::OriginOnPlane, "origin on a face"),
        (Self::OriginInside, "origin inside"),
        (Self::PointBox, "point box"),
        (Self::FlatBox, "flat box"),
    ];

    /// How many coordinates of the touched point lie on a plane of the box: 3 at a corner, 2 on an edge, 1
    /// on a face.
    fn fixed(self) -> usize {
        match self {
            Self::OriginInside => 0,
            Self::Edge => 2,
            Self::Corner
            | Self::CornerAtMillion
            | Self::CornerFromAfar
            | Self::CornerAnyLength
            | Self::PointBox => 3,
            _ => 1,
        }
    }
}

/// A box and a ray that touches it.
#[derive(Clone, Copy, Debug)]
pub struct HardBox {
    /// The box.
    pub bounds: Bounds3,
    /// The point of the box through which the ray passes.
    pub point: DVec3,
    /// The ray's direction.
    pub direction: DVec3,
    /// The parameter of the point.
    pub t: f64,
}

impl HardBox {
    /// The next box of a class.
    pub fn new(class: Class, random: &mut Uniform) -> Self {
        let mut min = grid(random, 1 << 12) / 64.0;
        let mut size = (grid(random, 1 << 10).abs() + 1.0) / 64.0;
        match class {
            Class::CornerAtMillion => min += 1e6,
            Class::PointBox => size = DVec3::ZERO,
            Class::FlatBox => size[below(random, 3)] = 0.0,
            _ => (),
        }
        let max = min + size;
        let mut direction = (grid(random, 1 << 12) + 0.5) / 128.0;
        let first = below(random, 3);
        let mut point = DVec3::ZERO;
        for k in 0..3 {
            let axis = (first + k) % 3;
            point[axis] = if k >= class.fixed() {
                min[axis] + size[axis] * ((1 + below(random, 1023)) as f64 / 1024.0)
            } else if below(random, 2) == 0 {
                min[axis]
            } else {
                max[axis]
            };
        }
        let inwards = if point[first] == min[first] { 1.0 } else { -1.0 };
        let mut t = 1.0 + below(random, 63) as f64;
        match class {
            Class::PlusZero => direction[first] = 0.0,
            Class::MinusZero => direction[first] = -0.0,
            // The origin then lies on the plane: what the ray gains on the way is rounded off.
            Class::Denormal => {
                direction[first] = inwards * (1 + below(random, 255)) as f64 * DENORMAL;
            }
            Class::OriginOnPlane => {
                direction[first] = inwards * direction[first].abs();
                t = 0.0;
            }
            Class::OriginInside => t = 0.0,
            Class::CornerFromAfar => {
                return Self { bounds: Bounds3 { min, max }, point, direction, t }
                    .moved_away(random);
            }
            Class::CornerAnyLength => {
                let length = 2.0_f64.powi(below(random, 81) as i32 - 40);
                (direction, t) = (direction * length, t / length);
            }
            _ => (),
        }
        Self { bounds: Bounds3 { min, max }, point, direction, t }
    }

    /// The same box seen along a direction of 27 random bits from a parameter of 30: the way between them has
    /// 57, so that plane − origin is rounded. The box moves by the rounding of the origin, which keeps the
    /// touch exact.
    fn moved_away(self, random: &mut Uniform) -> Self {
        let mut bits = |count: u32| (1 + below(random, 1 << count)) as f64;
        let t = bits(30);
        let length = DVec3::new(bits(27), bits(27), bits(27)) / f64::from(1 << 22);
        let away = Self { direction: length.copysign(self.direction), t, ..self };
        let [whole, rest] = away.way();
        let point = away.ray().origin + whole + rest;
        let Bounds3 { min, max } = self.bounds;
        let at_min = self.point.cmpeq(min);
        let bounds = Bounds3 {
            min: DVec3::select(at_min, point, point + (min - max)),
            max: DVec3::select(at_min, point + (max - min), point),
        };
        Self { bounds, point, ..away }
    }

    /// From the origin to the point, as two products without rounding.
    fn way(&self) -> [DVec3; 2] {
        let whole = self.direction.trunc();
        [self.t * whole, self.t * (self.direction - whole)]
    }

    /// The ray; it starts at the point itself where `t` is 0.
    pub fn ray(&self) -> Ray {
        let [whole, rest] = self.way();
        Ray::new(self.point - rest - whole, self.direction)
    }
}

/// So small that its reciprocal is ∞.
const DENORMAL: f64 = f64::MIN_POSITIVE / (1_u64 << 40) as f64;

fn below(random: &mut Uniform, count: usize) -> usize {
    (random.number() * count as f64) as usize
}

/// A point with integer coordinates from `-size` to `size`.
fn grid(random: &mut Uniform, size: i32) -> DVec3 {
    let mut integer = || f64::from(below(random, 2 * size as usize + 1) as i32 - size);
    DVec3::new(integer(), integer(), integer())
}
