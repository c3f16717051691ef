use glam::{DVec3, Vec3A, Vec4};
use lancer_core::geometry::{Bounds3, Ray};

/// Four boxes in `f32`, laid out to be tested together: one lane each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FourBoxes {
    /// Per axis the lanes' smallest and largest coordinates.
    planes: [[Vec4; 2]; 3],
}

impl FourBoxes {
    /// Four boxes that no ray meets.
    pub(crate) const EMPTY: Self = Self { planes: [[Vec4::INFINITY, Vec4::NEG_INFINITY]; 3] };

    /// Puts a box into a lane.
    pub(crate) fn set(&mut self, lane: usize, bounds: FrameBox) {
        for (axis, planes) in self.planes.iter_mut().enumerate() {
            planes[0][lane] = bounds.min[axis];
            planes[1][lane] = bounds.max[axis];
        }
    }

    /// The boxes between four smallest and four largest coordinates on each axis.
    #[inline(always)]
    pub(crate) fn between(planes: [[Vec4; 2]; 3]) -> Self {
        Self { planes }
    }

    /// The box in a lane.
    pub(crate) fn get(&self, lane: usize) -> FrameBox {
        let [x, y, z] = self.planes;
        FrameBox {
            min: Vec3A::new(x[0][lane], y[0][lane], z[0][lane]),
            max: Vec3A::new(x[1][lane], y[1][lane], z[1][lane]),
        }
    }
}

/// A box in the coordinates of a [`Frame`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrameBox {
    pub(crate) min: Vec3A,
    pub(crate) max: Vec3A,
}

impl FrameBox {
    /// The box that contains nothing.
    pub(crate) const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    /// The box that contains everything.
    pub(crate) const EVERYTHING: Self = Self { min: Vec3A::NEG_INFINITY, max: Vec3A::INFINITY };

    /// The smallest box around both.
    #[inline(always)]
    pub(crate) fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The box between two points of a frame, rounded outwards by more than the primitive test errs, unless a ray runs nearly in its plane.
    pub(crate) fn around(min: DVec3, max: DVec3) -> Self {
        let margin = f64::from(f32::EPSILON);
        let min = (min - margin).as_vec3a().to_array().map(f32::next_down);
        let max = (max + margin).as_vec3a().to_array().map(f32::next_up);
        Self { min: min.into(), max: max.into() }
    }

    /// What is in both.
    pub(crate) fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// The box with all faces moved outwards.
    pub(crate) fn grown(self, by: f32) -> Self {
        Self { min: self.min - by, max: self.max + by }
    }

    /// Half the area of its faces. A random line that meets a convex body meets a convex body inside
    /// it with the probability of the ratio of their areas: the reason of the surface area heuristic.
    #[inline(always)]
    pub(crate) fn half_area(self) -> f32 {
        let side = self.max - self.min;
        side.x * (side.y + side.z) + side.y * side.z
    }

    /// Whether the other box lies in it.
    pub(crate) fn contains(self, other: Self) -> bool {
        self.min.cmple(other.min).all() && other.max.cmple(self.max).all()
    }
}

/// Where the nodes' coordinates live: the scene's box, moved to the origin and scaled into [−1, 1]³.
/// There `f32` neither overflows nor loses digits to the scene's position.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    center: DVec3,
    pub(crate) to_unit: f64,
    /// What [`FourSlabs`] call `moved` at least: as if from afar where `f64` itself under- or overflows, so that
    /// no hit is certain.
    pub(crate) moved: f32,
}

/// Sizes of scenes, and their inverses, of which products of six coordinates are still numbers.
const ORDINARY: f64 = 1e-50;
/// The distance of which that is the rounding: beyond what any index calls near.
const DOUBTFUL: f64 = 32.0;

impl Frame {
    /// The frame of a scene within `bounds`.
    pub fn of(bounds: Bounds3) -> Self {
        if bounds.is_empty() {
            return Self { center: DVec3::ZERO, to_unit: 1.0, moved: 0.0 };
        }
        let extent = (bounds.max - bounds.min).max_element() * 0.5;
        let to_unit = if extent > 0.0 { extent.recip().min(1e300) } else { 1.0 };
        let is_ordinary = (ORDINARY..=ORDINARY.recip()).contains(&to_unit);
        let moved = if is_ordinary { 0.0 } else { rounding_at(DOUBTFUL) };
        Self { center: bounds.center(), to_unit, moved }
    }

    /// A point in this frame.
    #[inline]
    pub(crate) fn point(&self, p: DVec3) -> DVec3 {
        (p - self.center) * self.to_unit
    }

    /// A difference of points in this frame.
    pub(crate) fn vector(&self, v: DVec3) -> DVec3 {
        v * self.to_unit
    }

    /// Where a box of this frame is in the scene, rounded outwards: what lies in the box by
    /// [`Frame::outwards`] lies in this one.
    pub(crate) fn in_scene(&self, bounds: FrameBox) -> Bounds3 {
        let at = |p: Vec3A| p.as_dvec3() / self.to_unit;
        let (min, max) = (at(bounds.min), at(bounds.max));
        let rounding = |p: DVec3| 4.0 * f64::EPSILON * (p.abs() + self.center.abs());
        Bounds3 { min: self.center + min - rounding(min), max: self.center + max + rounding(max) }
    }

    /// A box in this frame, rounded outwards by more than the primitive test errs, unless a ray runs nearly in its plane.
    pub(crate) fn outwards(&self, bounds: Bounds3) -> FrameBox {
        FrameBox::around(self.point(bounds.min), self.point(bounds.max))
    }
}

/// A ray prepared for conservative `f32` tests of boxes, four or eight at a time.
///
/// A slab is t = plane · inverse + offset. Rounding the origin and the direction to `f32`, the
/// inverse and the two operations moves a plane by less than 8 u (1 + |origin|), u = 2⁻²⁴: the product
/// errs by 3 u |plane|, the offset by 5 u |origin|, their sum by u (|plane| + |origin|), and |plane| is
/// at most 1. The offsets carry that pad, near ones towards the origin and far ones away from it, so a
/// box is entered too early or left too late, never missed. A direction component near 0 is replaced by
/// a tiny one of its sign: then no 0 · ∞ = NaN can arise.
#[derive(Clone, Copy, Debug)]
pub struct FourSlabs {
    /// A bit per axis: the ray travels towards smaller coordinates.
    pub(crate) negative: u32,
    /// 1 / direction, never infinite.
    pub inverse: Vec3A,
    /// −origin · inverse, less the pad.
    pub near_offset: Vec3A,
    /// The same, and the pad more.
    pub far_offset: Vec3A,
    /// The ray itself, rounded, for tests of triangles.
    pub(crate) origin: Vec3A,
    pub(crate) direction: Vec3A,
    /// How far its origin may have been moved aside before it was rounded.
    pub(crate) moved: f32,
    /// The parameter in units of the boxes is `t · per_unit − skipped`.
    per_unit: f64,
    skipped: f64,
}

/// The rounding of what is so far away, finite.
fn rounding_at(distance: f64) -> f32 {
    ((8.0 * f64::EPSILON * distance) as f32).min(FARTHEST)
}

/// A ray far from a frame, moved close to it: see [`FourSlabs`].
struct Placed {
    origin: DVec3,
    direction: DVec3,
    moved: f32,
    per_unit: f64,
    skipped: f64,
}

impl Placed {
    /// A direction of extreme length is scaled. An origin far outside would pad the boxes into
    /// nothing: it moves close to the scene, and the rounding of that counts as well.
    #[cold]
    #[inline(never)]
    fn from_afar(ray: &Ray, frame: &Frame) -> Self {
        let origin = frame.point(ray.origin);
        let longest = ray.direction.abs().max_element();
        let direction = ray.direction / longest;
        let farthest = origin.abs().max_element().max(1.0);
        let away = farthest * (origin / farthest).length();
        let away = if away.is_finite() { away } else { f64::INFINITY };
        // All boxes are let in from a distance that is no number any more.
        let is_moved = away >= 2.0 && away.is_finite();
        let skipped = if is_moved { (away - 2.0) / direction.length() } else { 0.0 };
        // What `f64` makes of a direction of extreme length is not known here, nor what of NaN and infinity.
        let is_ordinary = ray.direction.is_finite()
            && longest > f64::from(LONG.recip())
            && longest < f64::from(LONG);
        let doubt = if is_ordinary { away } else { away.max(DOUBTFUL) };
        Self {
            origin: (origin + skipped * direction).map(finite),
            direction: direction.map(finite),
            moved: rounding_at(doubt),
            per_unit: frame.to_unit * longest,
            skipped,
        }
    }
}

/// A coordinate of a ray that is moved, as a number whose products with all others are numbers. A ray that is
/// still so far from the scene misses it.
fn finite(x: f64) -> f64 {
    let limit = f64::from(FARTHEST) * 0.1;
    if x.is_nan() { 0.0 } else { x.clamp(-limit, limit) }
}

/// The farthest that a ray is moved aside: times the inverse of [`TINY`] it is still a number of 32 bits.
const FARTHEST: f32 = 1e18;
/// Components of a direction below this count as this; the largest is at least 2³⁰ times as long.
const TINY: f32 = 1e-20;
/// An origin with a coordinate beyond this is far, a direction with a component beyond this, or none above its
/// inverse, is extreme.
const NEAR: f32 = 8.0;
const LONG: f32 = 1e9;
const PAD: f32 = 8.0 * 0.5 * f32::EPSILON;

impl FourSlabs {
    /// Prepares the tests of a ray.
    #[inline(always)] // Written to memory and read back in other pieces it costs as much as a node.
    pub fn new(ray: &Ray, frame: &Frame) -> Self {
        Self::of_numbers(ray, [ray.origin, ray.direction], frame)
    }

    /// The same where the ray's origin and direction have been read already.
    #[inline(always)]
    pub(crate) fn of_numbers(ray: &Ray, [origin, direction]: [DVec3; 2], frame: &Frame) -> Self {
        let origin = frame.point(origin).as_vec3a();
        let direction = direction.as_vec3a();
        let length = direction.abs();
        let is_near = (origin.abs().cmple(Vec3A::splat(NEAR)) & length.cmplt(Vec3A::splat(LONG)))
            .all()
            && length.cmpgt(Vec3A::splat(LONG.recip())).any();
        // The usual case stays in registers.
        let (origin, direction, moved, per_unit, skipped) = if is_near {
            (origin, direction, frame.moved, frame.to_unit, 0.0)
        } else {
            let Placed { origin, direction, moved, per_unit, skipped } =
                Placed::from_afar(ray, frame);
            (origin.as_vec3a(), direction.as_vec3a(), moved.max(frame.moved), per_unit, skipped)
        };

        let inverse = direction.abs().max(Vec3A::splat(TINY)).copysign(direction).recip();
        let widen = ((origin.abs() + 1.0) * PAD + moved) * inverse.abs();
        let offset = -origin * inverse;
        Self {
            negative: direction.is_negative_bitmask(),
            inverse,
            near_offset: offset - widen,
            far_offset: offset + widen,
            origin,
            direction,
            moved,
            // A parameter is rounded up when it becomes an `f32`.
            per_unit: per_unit * (1.0 + f64::from(f32::EPSILON)),
            skipped,
        }
    }

    /// A parameter of the ray in the units of the boxes, rounded up if it is not before the boxes.
    #[inline(always)]
    pub(crate) fn parameter(&self, t: f64) -> f32 {
        (t * self.per_unit - self.skipped) as f32
    }

    /// The same, rounded down.
    #[inline(always)]
    pub(crate) fn parameter_below(&self, t: f64) -> f32 {
        // Undoes the factor of `per_unit` and goes as far to the other side.
        (t * self.per_unit * (1.0 - 2.0 * f64::from(f32::EPSILON)) - self.skipped) as f32
    }

    /// Entry parameters of the four boxes, and a mask of the lanes whose box the ray meets before
    /// `max`.
    #[inline(always)]
    pub(crate) fn enter(&self, boxes: &FourBoxes, max: f32) -> (Vec4, u32) {
        let (mut near, mut far) = (Vec4::ZERO, Vec4::splat(max));
        for axis in 0..3 {
            let negative = (self.negative >> axis & 1) as usize;
            let first = boxes.planes[axis][negative];
            let last = boxes.planes[axis][1 - negative];
            near = near.max(first * self.inverse[axis] + self.near_offset[axis]);
            far = far.min(last * self.inverse[axis] + self.far_offset[axis]);
        }
        (near, near.cmple(far).bitmask())
    }

    /// The same as [`FourSlabs::enter`] for a single box.
    #[inline]
    pub(crate) fn enter_one(&self, bounds: FrameBox, max: f32) -> Option<f32> {
        let negative = self.inverse.cmplt(Vec3A::ZERO);
        let first = Vec3A::select(negative, bounds.max, bounds.min);
        let last = Vec3A::select(negative, bounds.min, bounds.max);
        let near = (first * self.inverse + self.near_offset).max_element().max(0.0);
        let far = (last * self.inverse + self.far_offset).min_element().min(max);
        (near <= far).then_some(near)
    }
}

#[cfg(test)]
mod tests {
    use rand_pcg::Pcg64;
    use rand_pcg::rand_core::Rng;

    use super::*;

    /// Rays through a chosen point of a box, all numbers dyadic, so that the exact answer is known: the
    /// point is at t = k. Its coordinates are on the box's planes or between them (corners, edges, faces,
    /// the inside), the box may be flat or a point, and the ray may run in a plane (d = ±0) or start in
    /// the box (k = 0) or far away.
    #[test]
    fn no_box_that_a_ray_meets_is_missed() {
        let mut random = Pcg64::new(7, 1);
        let mut below = move |count: u32| f64::from(random.next_u32() % count);
        let scene = Bounds3 { min: DVec3::splat(-64.0), max: DVec3::splat(64.0) };
        for offset in [0.0, f64::from(1 << 20)] {
            let moved = Bounds3 { min: scene.min + offset, max: scene.max + offset };
            let frame = Frame::of(moved);
            for _ in 0..300_000 {
                let (mut min, mut max, mut point, mut direction) =
                    (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
                for axis in 0..3 {
                    min[axis] = offset + (below(4096) - 2048.0) / 64.0;
                    max[axis] = min[axis] + below(4) * below(512) / 64.0;
                    let inside = min[axis] + (max[axis] - min[axis]) * below(1025) / 1024.0;
                    point[axis] = [min[axis], max[axis], inside][below(3) as usize];
                    let component = (below(4096) - 2047.5) / 128.0;
                    direction[axis] = [0.0, -0.0, component, component][below(4) as usize];
                }
                let steps = [0.0, below(64), 32768.0][below(3) as usize];
                let ray = Ray::new(point - steps * direction, direction);
                let mut boxes = FourBoxes::EMPTY;
                boxes.set(2, frame.outwards(Bounds3 { min, max }));
                let slabs = FourSlabs::new(&ray, &frame);
                let (near, met) = slabs.enter(&boxes, slabs.parameter(steps));
                if direction == DVec3::ZERO {
                    continue;
                }
                assert_eq!(met, 0b100, "{min} {max} {ray:?}");
                assert!(near.z <= slabs.parameter(steps));
            }
        }
    }

    #[test]
    fn boxes_beside_behind_and_beyond_are_not_met() {
        let frame = Frame::of(Bounds3 { min: DVec3::NEG_ONE, max: DVec3::ONE });
        let slabs = FourSlabs::new(&Ray::new(DVec3::ZERO, DVec3::X), &frame);
        let mut boxes = FourBoxes::EMPTY;
        for (lane, center) in
            [DVec3::new(0.5, 0.5, 0.0), DVec3::NEG_X * 0.5, DVec3::X * 0.8].into_iter().enumerate()
        {
            boxes.set(lane, frame.outwards(Bounds3 { min: center - 0.1, max: center + 0.1 }));
        }
        assert_eq!(slabs.enter(&boxes, slabs.parameter(0.6)).1, 0);
        assert_eq!(slabs.enter(&boxes, slabs.parameter(0.75)).1, 0b100);
    }
}
