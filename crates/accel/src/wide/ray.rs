//! A ray, ready for boxes and triangles eight at a time.

use glam::DVec3;
use lancer_core::geometry::{Interval, Ray};

use super::filter::{Bounds, Filtered, U};
use super::lanes::{Lanes, Vectors, cross, dot, splat3, sub3};
use super::leaf::HEADER;
use super::{Node, Wide};
use crate::four_boxes::FourSlabs;

/// The farthest origin from which hits are called certain, in units of the scene's frame.
const FARTHEST: f32 = 16.0;

/// A ray in the scene's frame. It stays in memory, and its numbers are broadcast to the lanes where they are used:
/// stored eight times each they would cost more.
pub(super) struct WideRay {
    pub(super) slabs: FourSlabs,
    bounds: Bounds,
}

/// A vector whose numbers are read one by one: two that have just been written each by itself, as those of most rays
/// have, cannot be read together without waiting for both.
#[inline(always)]
fn one_by_one<L: Lanes>(lanes: L, DVec3 { x, y, z }: &DVec3) -> DVec3 {
    DVec3::new(lanes.read_alone(x), lanes.read_alone(y), lanes.read_alone(z))
}

/// What tests eight boxes, ready in registers.
pub(super) struct Boxes<L: Lanes> {
    negative: u32,
    inverse: Vectors<L>,
    near_offset: Vectors<L>,
    far_offset: Vectors<L>,
    max: L::F,
}

impl WideRay {
    #[inline(always)]
    pub(super) fn new<L: Lanes>(lanes: L, wide: &Wide, ray: &Ray) -> Self {
        let numbers = [one_by_one(lanes, &ray.origin), one_by_one(lanes, &ray.direction)];
        let slabs = FourSlabs::of_numbers(ray, numbers, &wide.frame);
        let reach = 1.0 + slabs.origin.abs().max_element() + slabs.moved / U;
        let bounds = Bounds::new(reach, slabs.direction.abs().max_element());
        Self { slabs, bounds }
    }

    /// A hit in `range` must be this far away to be certain.
    #[inline(always)]
    pub(super) fn least(&self, range: Interval) -> f32 {
        // From farther away the parameter's own bound in `f64` might exceed what is certain here.
        let is_far = self.slabs.moved > 8.0 * f64::EPSILON as f32 * FARTHEST;
        if is_far { f32::INFINITY } else { self.slabs.parameter(range.min) }
    }

    /// What tests boxes that the ray meets before `max`.
    #[inline(always)]
    pub(super) fn boxes<L: Lanes>(&self, lanes: L, max: f32) -> Boxes<L> {
        let slabs = &self.slabs;
        Boxes {
            negative: slabs.negative,
            inverse: splat3(lanes, slabs.inverse.to_array()),
            near_offset: splat3(lanes, slabs.near_offset.to_array()),
            far_offset: splat3(lanes, slabs.far_offset.to_array()),
            max: lanes.splat(max),
        }
    }

    /// Filters the triangles of a leaf, whose words come first: see [`Wide`] for the formulas and their bounds.
    #[inline(always)]
    pub(super) fn filter<L: Lanes>(
        &self,
        l: L,
        words: &[f32],
        count: usize,
        max: f32,
    ) -> Filtered<L::F> {
        let Self { slabs, bounds } = self;
        let [ax, ay, az, ex, ey, ez, fx, fy, fz] = l.rows::<9>(&words[HEADER..], count);
        let (e, f) = ([ex, ey, ez], [fx, fy, fz]);
        let origin = splat3(l, slabs.origin.to_array());
        let direction = splat3(l, slabs.direction.to_array());
        let c = sub3(l, [ax, ay, az], origin);
        let n = cross(l, f, e);
        let r = cross(l, c, direction);
        let (det, t) = (dot(l, n, direction), dot(l, n, c));
        let (u, v) = (dot(l, r, f), dot(l, r, e));
        let bounds = bounds.of(l, words, bounds.noise(l, words, c));
        Filtered::new(l, [u, v, det, t], bounds, l.splat(max), (1 << count) - 1)
    }
}

impl<L: Lanes> Boxes<L> {
    /// Where the ray enters the eight boxes, and which of them it meets, a bit per lane.
    #[inline(always)]
    pub(super) fn enter(&self, lanes: L, node: &Node) -> (L::F, u32) {
        let near = self.planes(lanes, node, 0, self.near_offset);
        let far = self.planes(lanes, node, 1, self.far_offset);
        let first = lanes.max(lanes.max(near[0], near[1]), lanes.max(near[2], lanes.splat(0.0)));
        let last = lanes.min(lanes.min(far[0], far[1]), lanes.min(far[2], self.max));
        (first, lanes.at_least(last, first))
    }

    /// Where the ray meets the planes on its side, or (1) on the other.
    #[inline(always)]
    fn planes(&self, lanes: L, node: &Node, other: u32, offset: Vectors<L>) -> Vectors<L> {
        let row = |axis: usize| &node.planes[axis][(self.negative >> axis & 1 ^ other) as usize];
        [
            lanes.mul_add(lanes.load(row(0)), self.inverse[0], offset[0]),
            lanes.mul_add(lanes.load(row(1)), self.inverse[1], offset[1]),
            lanes.mul_add(lanes.load(row(2)), self.inverse[2], offset[2]),
        ]
    }
}
