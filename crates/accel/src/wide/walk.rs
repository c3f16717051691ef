//! The walk of one ray.

use std::mem::MaybeUninit;

use lancer_core::geometry::{Interval, Ray};
use lancer_core::intersector::{Hit, Observer, Probe};
use lancer_core::scene::PrimitiveId;

use super::collapse::WIDTH;
use super::lanes::{Lanes, Vectors, cross, dot, splat3, sub3};
use super::{Child, Node, Wide};
use crate::bvh::MAX_DEPTH;
use crate::four_boxes::FourSlabs;

/// Levels of a tree at most: it has no more than the binary tree that is collapsed.
pub(super) const MOST_LEVELS: usize = MAX_DEPTH + 1;
/// Entries of the stack at most: all children but one of a node on each level.
pub(super) const MOST_PENDING: usize = MOST_LEVELS * (WIDTH - 1);
/// Candidates for the answer that are kept until the end of the walk.
const CANDIDATES: usize = 24;

/// The farthest origin from which hits are called certain, in units of the scene's frame.
const FARTHEST: f32 = 16.0;
/// Unit roundoff of `f32`.
pub(super) const U: f32 = 0.5 * f32::EPSILON;

/// A ray in the scene's frame. Its numbers are broadcast to the lanes where they are used: stored eight times
/// each they would cost more.
pub(super) struct WideRay<L: Lanes> {
    lanes: L,
    pub(super) slabs: FourSlabs,
    /// Which of a node's rows of planes a ray meets first on each axis: 1 for the highest coordinates.
    near: [usize; 3],
    inverse: [f32; 3],
    near_offset: [f32; 3],
    far_offset: [f32; 3],
    origin: [f32; 3],
    direction: [f32; 3],
    bounds: Bounds,
    /// A hit must be this far away to be certain.
    pub(super) min: f32,
}

impl<L: Lanes> WideRay<L> {
    #[inline(always)]
    pub(super) fn new(lanes: L, wide: &Wide, ray: &Ray, range: Interval) -> Self {
        let slabs = FourSlabs::new(ray, &wide.frame);
        let reach = 1.0 + slabs.origin.abs().max_element() + slabs.moved / U;
        let length = slabs.direction.abs().max_element();
        // From farther away the parameter's own bound in `f64` might exceed what is certain here.
        let is_far = slabs.moved > 8.0 * f64::EPSILON as f32 * FARTHEST;
        let min = if is_far { f32::INFINITY } else { slabs.parameter(range.min) };
        let negative = slabs.inverse.is_negative_bitmask() as usize;
        let near = [negative & 1, negative >> 1 & 1, negative >> 2 & 1];
        Self {
            lanes,
            slabs,
            near,
            inverse: slabs.inverse.to_array(),
            near_offset: slabs.near_offset.to_array(),
            far_offset: slabs.far_offset.to_array(),
            origin: slabs.origin.to_array(),
            direction: slabs.direction.to_array(),
            bounds: Bounds::new(reach, length),
            min,
        }
    }

    /// Where the ray enters the eight boxes, and which of them before `max`, a bit per lane.
    #[inline(always)]
    fn enter(&self, node: &Node, max: f32) -> (L::F, u32) {
        let lanes = self.lanes;
        let near = self.planes(node, 0, &self.near_offset);
        let far = self.planes(node, 1, &self.far_offset);
        let first = lanes.max(lanes.max(near[0], near[1]), lanes.max(near[2], lanes.splat(0.0)));
        let last = lanes.min(lanes.min(far[0], far[1]), lanes.min(far[2], lanes.splat(max)));
        (first, lanes.at_least(last, first))
    }

    /// Where the ray meets the planes on its side, or (1) on the other.
    #[inline(always)]
    fn planes(&self, node: &Node, other: usize, offset: &[f32; 3]) -> Vectors<L> {
        let lanes = self.lanes;
        let row = |axis: usize| &node.planes[axis][(self.near[axis] ^ other) & 1];
        let (inverse, offset) = (splat3(lanes, self.inverse), splat3(lanes, *offset));
        [
            lanes.mul_add(lanes.load(row(0)), inverse[0], offset[0]),
            lanes.mul_add(lanes.load(row(1)), inverse[1], offset[1]),
            lanes.mul_add(lanes.load(row(2)), inverse[2], offset[2]),
        ]
    }

    /// Filters the triangles of a leaf: see [`Wide`] for the formulas and their bounds.
    #[inline(always)]
    pub(super) fn filter(&self, words: &[f32], count: usize, max: L::F) -> Filtered<L::F> {
        let l = self.lanes;
        let [ax, ay, az, ex, ey, ez, fx, fy, fz] = l.rows::<9>(&words[1..=9 * count], count);
        let (e, f) = ([ex, ey, ez], [fx, fy, fz]);
        let (origin, direction) = (splat3(l, self.origin), splat3(l, self.direction));
        let c = sub3(l, [ax, ay, az], origin);
        let n = cross(l, e, f);
        let r = cross(l, c, direction);
        let (det, t) = (dot(l, n, direction), dot(l, n, c));
        let (u, v) = (dot(l, r, f), l.sub(l.splat(0.0), dot(l, r, e)));
        Filtered::new(l, [u, v, det, t], self.bounds.of(l, words[0], c), max, (1 << count) - 1)
    }
}

/// What the bounds are made of that a ray has, or several have: u D and δ.
pub(super) struct Bounds {
    reach: f32,
    length: f32,
}

/// The bounds of eight triangles: see [`Wide`].
#[derive(Clone, Copy)]
pub(super) struct TriangleBounds<F> {
    pub(super) e: F,
    pub(super) e_t: F,
    pub(super) e_det: F,
    /// e'_T
    pub(super) e_behind: F,
}

impl Bounds {
    /// D is `reach`, δ is `length`.
    #[inline(always)]
    pub(super) fn new(reach: f32, length: f32) -> Self {
        Self { reach: U * reach, length }
    }

    /// Of triangles with the longest edge component `s`, seen along C = `from_origin`.
    #[inline(always)]
    pub(super) fn of<L: Lanes>(
        &self,
        l: L,
        s: f32,
        from_origin: Vectors<L>,
    ) -> TriangleBounds<L::F> {
        let [x, y, z] = from_origin;
        let c = l.max(l.abs(x), l.max(l.abs(y), l.abs(z)));
        let scale = s * self.length;
        let (near, far) = (scale * (16.0 * self.reach + 64.0 * U * s), scale * 128.0 * U);
        let (near_t, far_t) = (s * s * 8.0 * self.reach, s * s * 56.0 * U);
        let e_t = l.mul_add(c, l.splat(far_t), l.splat(near_t));
        TriangleBounds {
            e: l.mul_add(c, l.splat(far), l.splat(near)),
            e_t,
            e_det: l.splat(64.0 * U * s * scale),
            e_behind: l.mul_add(e_t, l.splat(2.0), l.splat(64.0 * U * s * s * s)),
        }
    }
}

/// Eight pairs of a ray and a triangle after the filter.
pub(super) struct Filtered<F> {
    /// What `f64` might accept, a bit per lane.
    pub(super) kept: u32,
    /// The least of U, V and W.
    inside: F,
    t: F,
    det: F,
    det_most: F,
    bounds: TriangleBounds<F>,
}

impl<F: Copy> Filtered<F> {
    /// Keeps what may be a hit before `max`, among the lanes of `valid`: see [`Wide`] for the comparisons.
    #[inline(always)]
    pub(super) fn new<L: Lanes<F = F>>(
        l: L,
        [u, v, det, t]: [F; 4],
        bounds: TriangleBounds<F>,
        max: F,
        valid: u32,
    ) -> Self {
        let (u, v, t) = (l.turn(u, det), l.turn(v, det), l.turn(t, det));
        let det = l.abs(det);
        let inside = l.min(u, l.min(v, l.sub(l.sub(det, u), v)));
        let det_most = l.add(det, bounds.e_det);
        let zero = l.splat(0.0);
        let kept = l.at_least(inside, l.sub(zero, bounds.e))
            & l.at_least(t, l.sub(zero, bounds.e_behind))
            & l.at_least(l.mul_sub(max, det_most, t), l.sub(zero, bounds.e_t))
            & valid;
        Self { kept, inside, t, det, det_most, bounds }
    }

    /// Which of the kept hits are certain and lie beyond `min`, and between which parameters they lie.
    #[inline(always)]
    pub(super) fn certain<L: Lanes<F = F>>(&self, l: L, min: f32) -> (u32, F, F) {
        let Self { kept, inside, t, det, det_most, bounds } = *self;
        // The quotients round too.
        let lowest =
            l.mul(l.div(l.sub(t, bounds.e_t), det_most), l.splat(1.0 - 4.0 * f32::EPSILON));
        let det_least = l.sub(det, bounds.e_det);
        let highest =
            l.mul(l.div(l.add(t, bounds.e_t), det_least), l.splat(1.0 + 4.0 * f32::EPSILON));
        let certain = kept
            & l.above(inside, bounds.e)
            & l.above(t, bounds.e_t)
            & l.above(det_least, bounds.e_det)
            & l.above(lowest, l.splat(min));
        (certain, lowest, highest)
    }
}

/// At most `N` numbers, the last one first: a parameter that is at least 0 in the high bits, so that integers
/// are in the order of parameters, and what is there in the low ones. Nothing is initialised in vain.
pub(super) struct Stack<const N: usize> {
    entries: [MaybeUninit<u64>; N],
    length: usize,
}

impl<const N: usize> Stack<N> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { entries: [const { MaybeUninit::uninit() }; N], length: 0 }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, entry: u64) {
        self.entries[self.length] = MaybeUninit::new(entry);
        self.length += 1;
    }

    #[inline(always)]
    #[allow(unsafe_code)]
    pub(super) fn pop(&mut self) -> Option<u64> {
        self.length = self.length.checked_sub(1)?;
        // SAFETY: entries below the length have been pushed.
        Some(unsafe { self.entries[self.length].assume_init() })
    }

    /// Pushes the lanes of a mask with at least two bits, far ones first, but for the nearest.
    #[inline(always)]
    pub(super) fn push_but_nearest(
        &mut self,
        mut met: u32,
        near: &[f32; 8],
        children: &[Child; 8],
    ) -> Child {
        let mut take = || {
            let lane = met.trailing_zeros() as usize % WIDTH;
            met &= met - 1;
            entry(near[lane], children[lane])
        };
        let (a, b) = (take(), take());
        let (mut nearest, second) = (a.min(b), a.max(b));
        self.push(second);
        let mut among = 1;
        while met != 0 {
            let lane = met.trailing_zeros() as usize % WIDTH;
            met &= met - 1;
            let next = entry(near[lane], children[lane]);
            let pushed = nearest.max(next);
            nearest = nearest.min(next);
            self.push(pushed);
            self.sink(among);
            among += 1;
        }
        child(nearest)
    }

    /// Brings the last entry to its place among the `among` before it, which are in falling order.
    #[inline(always)]
    #[allow(unsafe_code)]
    fn sink(&mut self, among: usize) {
        let last = self.length - 1;
        for place in (last - among..last).rev() {
            // SAFETY: entries below the length have been pushed.
            let (before, here) = unsafe {
                (self.entries[place].assume_init(), self.entries[place + 1].assume_init())
            };
            if before >= here {
                break;
            }
            self.entries.swap(place, place + 1);
        }
    }
}

#[inline(always)]
fn entry(near: f32, child: Child) -> u64 {
    key(near, child.0)
}

/// What is at a parameter, as a number.
#[inline(always)]
fn key(parameter: f32, what: u32) -> u64 {
    u64::from(parameter.to_bits()) << 32 | u64::from(what)
}

#[inline(always)]
pub(super) fn child(entry: u64) -> Child {
    Child(entry as u32)
}

#[inline(always)]
pub(super) fn near(entry: u64) -> f32 {
    f32::from_bits((entry >> 32) as u32)
}

/// The candidates for the closest hit, which `f64` decides on.
struct Candidates<'s, 'r> {
    probe: Probe<'s>,
    ray: &'r FourSlabs,
    /// Each with the lower end of where its hit may be.
    list: Stack<CANDIDATES>,
    /// Nothing beyond this parameter can be the closest hit.
    max: f32,
}

impl Candidates<'_, '_> {
    #[inline(always)]
    fn add(&mut self, primitive: PrimitiveId, lowest: f32) {
        if self.list.length == CANDIDATES {
            self.decide();
        }
        self.list.push(key(lowest.max(0.0), primitive.0));
    }

    #[inline(always)]
    fn test(&mut self, primitive: PrimitiveId) {
        if self.probe.test(primitive) {
            self.max = self.max.min(self.ray.parameter(self.probe.range().max));
        }
    }

    /// Lets `f64` decide on the list. What came last is nearest more often than not.
    #[inline(always)]
    fn decide(&mut self) {
        while let Some(candidate) = self.list.pop() {
            if near(candidate) <= self.max {
                self.test(PrimitiveId(candidate as u32));
            }
        }
    }
}

#[inline(always)]
pub(super) fn closest<L: Lanes, O: Observer>(
    lanes: L,
    wide: &Wide,
    ray: &Ray,
    range: Interval,
    observer: &mut O,
) -> Option<Hit> {
    if wide.nodes.is_empty() {
        return None;
    }
    let wide_ray = WideRay::new(lanes, wide, ray, range);
    let mut candidates = Candidates {
        probe: Probe::new(wide.scene, ray, range),
        ray: &wide_ray.slabs,
        list: Stack::new(),
        max: wide_ray.slabs.parameter(range.max),
    };
    let mut stack = Stack::<MOST_PENDING>::new();
    let mut next = Child::node(0);
    loop {
        if next.is_leaf() {
            for primitive in wide.primitives(next) {
                observer.primitive_test(primitive);
            }
            visit_leaf(wide, &wide_ray, next, &mut candidates);
        } else {
            let node = &wide.nodes[next.0 as usize];
            for lane in 0..WIDTH {
                observer.region(&|| wide.frame.in_scene(node.bounds(lane)));
                observer.box_test();
            }
            let (near, met) = wide_ray.enter(node, candidates.max);
            if met != 0 {
                if met & (met - 1) == 0 {
                    next = node.children[met.trailing_zeros() as usize % WIDTH];
                } else {
                    next = stack.push_but_nearest(met, &lanes.store(near), &node.children);
                }
                continue;
            }
        }
        next = loop {
            let Some(entry) = stack.pop() else {
                candidates.decide();
                return candidates.probe.best();
            };
            if near(entry) <= candidates.max {
                break child(entry);
            }
        };
    }
}

#[inline(always)]
fn visit_leaf<L: Lanes>(wide: &Wide, ray: &WideRay<L>, leaf: Child, candidates: &mut Candidates) {
    if leaf.has_spheres() {
        wide.primitives(leaf).for_each(|primitive| candidates.test(primitive));
        return;
    }
    let count = leaf.count();
    let words = &wide.leaves[leaf.offset()..][..1 + 10 * count];
    let filtered = ray.filter(words, count, ray.lanes.splat(candidates.max));
    if filtered.kept == 0 {
        return;
    }
    let (certain, lowest, highest) = filtered.certain(ray.lanes, ray.min);
    let (lowest, highest) = (ray.lanes.store(lowest), ray.lanes.store(highest));
    let mut kept = filtered.kept;
    while kept != 0 {
        let lane = kept.trailing_zeros() as usize % WIDTH;
        kept &= kept - 1;
        let id = words[1 + 9 * count + lane].to_bits();
        ray.lanes.prefetch(&wide.scene.mesh.triangles[id as usize]);
        candidates.add(PrimitiveId(id), lowest[lane]);
        if certain >> lane & 1 != 0 {
            candidates.max = candidates.max.min(highest[lane]);
        }
    }
}

#[inline(always)]
pub(super) fn any<L: Lanes, O: Observer>(
    lanes: L,
    wide: &Wide,
    ray: &Ray,
    range: Interval,
    observer: &mut O,
) -> Option<PrimitiveId> {
    if wide.nodes.is_empty() {
        return None;
    }
    let wide_ray = WideRay::new(lanes, wide, ray, range);
    let mut probe = Probe::new(wide.scene, ray, range);
    let max = wide_ray.slabs.parameter(range.max);
    let surely_before = wide_ray.slabs.parameter_below(range.max);
    let mut stack = Stack::<MOST_PENDING>::new();
    let mut next = Child::node(0);
    loop {
        if next.is_leaf() {
            let found = in_the_way(wide, &wide_ray, next, max, surely_before, &mut probe, observer);
            if found.is_some() {
                return found;
            }
        } else {
            let node = &wide.nodes[next.0 as usize];
            for lane in 0..WIDTH {
                observer.region(&|| wide.frame.in_scene(node.bounds(lane)));
                observer.box_test();
            }
            let (_, mut met) = wide_ray.enter(node, max);
            if met != 0 {
                // The last one does not pass through the stack.
                while met & (met - 1) != 0 {
                    let lane = met.trailing_zeros() as usize % WIDTH;
                    stack.push(entry(0.0, node.children[lane]));
                    met &= met - 1;
                }
                next = node.children[met.trailing_zeros() as usize % WIDTH];
                continue;
            }
        }
        next = child(stack.pop()?);
    }
}

/// A primitive of a leaf that the ray meets, if there is one.
#[inline(always)]
fn in_the_way<L: Lanes, O: Observer>(
    wide: &Wide,
    ray: &WideRay<L>,
    leaf: Child,
    max: f32,
    surely_before: f32,
    probe: &mut Probe,
    observer: &mut O,
) -> Option<PrimitiveId> {
    for primitive in wide.primitives(leaf) {
        observer.primitive_test(primitive);
    }
    if leaf.has_spheres() {
        return wide.primitives(leaf).find(|&primitive| probe.test(primitive));
    }
    let count = leaf.count();
    let words = &wide.leaves[leaf.offset()..][..1 + 10 * count];
    let filtered = ray.filter(words, count, ray.lanes.splat(max));
    if filtered.kept == 0 {
        return None;
    }
    let id = |lane: usize| PrimitiveId(words[1 + 9 * count + lane].to_bits());
    let (mut certain, _, highest) = filtered.certain(ray.lanes, ray.min);
    let highest = ray.lanes.store(highest);
    while certain != 0 {
        let lane = certain.trailing_zeros() as usize % WIDTH;
        certain &= certain - 1;
        if highest[lane] < surely_before {
            return Some(id(lane));
        }
    }
    let mut kept = filtered.kept;
    while kept != 0 {
        let lane = kept.trailing_zeros() as usize % WIDTH;
        kept &= kept - 1;
        if probe.test(id(lane)) {
            return Some(id(lane));
        }
    }
    None
}
