use glam::{DVec3, Vec4, Vec4Swizzles};
use lancer_core::geometry::{Bounds3, Ray};

/// The boxes of two siblings, in `f32`, laid out to be tested together.
///
/// Per axis one vector (min of the first, min of the second, max of the first, max of the second).
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairBounds {
    axes: [Vec4; 3],
}

impl PairBounds {
    /// Two boxes given by their smallest and largest coordinates.
    pub(crate) fn new(first: [[f32; 3]; 2], second: [[f32; 3]; 2]) -> Self {
        let [first_min, first_max] = first;
        let [second_min, second_max] = second;
        Self {
            axes: [0, 1, 2].map(|axis| {
                Vec4::new(first_min[axis], second_min[axis], first_max[axis], second_max[axis])
            }),
        }
    }
}

/// Where the nodes' coordinates live: the scene's box, moved to the origin and scaled into [−1, 1]³.
/// There `f32` neither overflows nor loses digits to the scene's position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    center: DVec3,
    to_unit: f64,
}

impl Frame {
    /// The frame of a scene within `bounds`.
    pub(crate) fn of(bounds: Bounds3) -> Self {
        if bounds.is_empty() {
            return Self { center: DVec3::ZERO, to_unit: 1.0 };
        }
        let extent = (bounds.max - bounds.min).max_element() * 0.5;
        let to_unit = if extent > 0.0 { extent.recip() } else { 1.0 };
        Self { center: bounds.center(), to_unit }
    }

    /// A box in this frame, rounded outwards by more than the primitive test can err.
    pub(crate) fn outwards(&self, bounds: Bounds3) -> [[f32; 3]; 2] {
        let margin = f64::from(f32::EPSILON);
        let unit = |p: DVec3| (p - self.center) * self.to_unit;
        let min = (unit(bounds.min) - margin).as_vec3().to_array().map(f32::next_down);
        let max = (unit(bounds.max) + margin).as_vec3().to_array().map(f32::next_up);
        [min, max]
    }
}

/// A ray prepared for conservative `f32` tests of [`PairBounds`].
///
/// A slab is t = plane · inverse + offset. Rounding the plane, the origin (`f64` to `f32`), the inverse
/// and the two operations moves a plane by less than 8 u (1 + |origin|), u = 2⁻²⁴; the offsets carry
/// that pad, near ones towards the origin and far ones away from it, so a box is entered too early
/// or left too late, never missed. A direction component near 0 is replaced by a tiny one of its
/// sign: then no 0 · ∞ = NaN can arise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairSlabs {
    inverse: [f32; 3],
    offset: [Vec4; 3],
    /// The ray's parameter is `skipped + t · per_unit`.
    skipped: f64,
    per_unit: f64,
    /// Boxes left before this are behind the ray.
    start: f32,
}

/// Components of a direction below this fraction of the largest count as this fraction.
const TINY: f64 = 1e-18;
const PAD: f64 = 8.0 * 0.5 * f32::EPSILON as f64;

impl PairSlabs {
    /// Prepares the tests of a ray.
    pub(crate) fn new(ray: &Ray, frame: &Frame) -> Self {
        let per_direction = ray.direction.abs().max_element().recip();
        let direction = ray.direction * per_direction;
        let mut origin = (ray.origin - frame.center) * frame.to_unit;
        // An origin far outside would pad the boxes into nothing: start near the scene instead. The
        // rounding of a start far away then counts as well.
        let (mut skip, mut far_rounding) = (0.0, 0.0);
        let away = origin.length_squared();
        if away > 16.0 {
            let away = away.sqrt();
            skip = (away - 2.0) / direction.length();
            far_rounding = 8.0 * f64::EPSILON * away;
            origin += skip * direction;
        }
        let axis = |o: f64, d: f64| {
            let d = if d.abs() < TINY { TINY.copysign(d) } else { d };
            let inverse = d.recip();
            let widen = (PAD * (1.0 + o.abs()) + far_rounding) * inverse.abs();
            let (near, far) = ((-o * inverse - widen) as f32, (-o * inverse + widen) as f32);
            let offset = if d > 0.0 {
                Vec4::new(near, near, far, far)
            } else {
                Vec4::new(far, far, near, near)
            };
            (inverse as f32, offset)
        };
        let (x, y, z) =
            (axis(origin.x, direction.x), axis(origin.y, direction.y), axis(origin.z, direction.z));
        Self {
            inverse: [x.0, y.0, z.0],
            offset: [x.1, y.1, z.1],
            skipped: skip,
            per_unit: frame.to_unit / per_direction,
            start: (-skip) as f32,
        }
    }

    /// A parameter of the ray in the units of the boxes, rounded up.
    #[inline(always)]
    pub(crate) fn parameter(&self, t: f64) -> f32 {
        ((t * self.per_unit - self.skipped) as f32).next_up()
    }

    /// Entry parameters of the two boxes, `None` where the ray misses the box, enters it after `max`
    /// or leaves it before its start.
    #[inline(always)]
    pub(crate) fn enter(&self, pair: &PairBounds, max: f32) -> [Option<f32>; 2] {
        let mut near = Vec4::splat(f32::NEG_INFINITY);
        let mut far = Vec4::splat(max);
        for axis in 0..3 {
            let t = pair.axes[axis] * self.inverse[axis] + self.offset[axis];
            let swapped = t.zwxy();
            near = near.max(t.min(swapped));
            far = far.min(t.max(swapped));
        }
        let met = near.cmple(far) & far.cmpge(Vec4::splat(self.start));
        [met.test(0).then_some(near.x), met.test(1).then_some(near.y)]
    }
}
