//! The walk of one ray.

use std::mem::MaybeUninit;

use lancer_core::geometry::{Interval, Ray};
use lancer_core::intersector::{Hit, Observer, Probe};
use lancer_core::scene::PrimitiveId;

use super::collapse::WIDTH;
use super::lanes::{Lanes, Vectors, cross, dot, splat3, sub3};
use super::leaf::HEADER;
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
}

impl<L: Lanes> WideRay<L> {
    #[inline(always)]
    pub(super) fn new(lanes: L, wide: &Wide, ray: &Ray) -> Self {
        Self { lanes, slabs: FourSlabs::new(ray, &wide.frame) }
    }

    /// A hit in `range` must be this far away to be certain.
    #[inline(always)]
    pub(super) fn least(&self, range: Interval) -> f32 {
        // From farther away the parameter's own bound in `f64` might exceed what is certain here.
        let is_far = self.slabs.moved > 8.0 * f64::EPSILON as f32 * FARTHEST;
        if is_far { f32::INFINITY } else { self.slabs.parameter(range.min) }
    }

    /// Where the ray enters the eight boxes, and which of them before `max`, a bit per lane.
    #[inline(always)]
    fn enter(&self, node: &Node, max: f32) -> (L::F, u32) {
        let lanes = self.lanes;
        let near = self.planes(node, 0, self.slabs.near_offset.to_array());
        let far = self.planes(node, 1, self.slabs.far_offset.to_array());
        let first = lanes.max(lanes.max(near[0], near[1]), lanes.max(near[2], lanes.splat(0.0)));
        let last = lanes.min(lanes.min(far[0], far[1]), lanes.min(far[2], lanes.splat(max)));
        (first, lanes.at_least(last, first))
    }

    /// Where the ray meets the planes on its side, or (1) on the other.
    #[inline(always)]
    fn planes(&self, node: &Node, other: u32, offset: [f32; 3]) -> Vectors<L> {
        let lanes = self.lanes;
        let row =
            |axis: usize| &node.planes[axis][(self.slabs.negative >> axis & 1 ^ other) as usize];
        let (inverse, offset) =
            (splat3(lanes, self.slabs.inverse.to_array()), splat3(lanes, offset));
        [
            lanes.mul_add(lanes.load(row(0)), inverse[0], offset[0]),
            lanes.mul_add(lanes.load(row(1)), inverse[1], offset[1]),
            lanes.mul_add(lanes.load(row(2)), inverse[2], offset[2]),
        ]
    }

    /// Filters the triangles of a leaf, whose words come first: see [`Wide`] for the formulas and their bounds.
    #[inline(always)]
    pub(super) fn filter(&self, words: &[f32], count: usize, max: f32) -> Filtered<L::F> {
        let l = self.lanes;
        let slabs = &self.slabs;
        let reach = 1.0 + slabs.origin.abs().max_element() + slabs.moved / U;
        let bounds = Bounds::new(reach, slabs.direction.abs().max_element());
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

/// What the bounds are made of that a ray has, or several have: D and δ.
pub(super) struct Bounds {
    reach: f32,
    length: f32,
}

/// The bounds of eight triangles: see [`Wide`].
#[derive(Clone, Copy)]
pub(super) struct TriangleBounds<F> {
    e: F,
    /// 2 e_T
    e_behind: F,
    e_det: F,
}

impl Bounds {
    /// D is `reach`, δ is `length`.
    #[inline(always)]
    pub(super) fn new(reach: f32, length: f32) -> Self {
        Self { reach, length }
    }

    /// p, of triangles seen along C = `from_origin` in a leaf with these words.
    #[inline(always)]
    pub(super) fn noise<L: Lanes>(&self, l: L, words: &[f32], from_origin: Vectors<L>) -> L::F {
        let [x, y, z] = from_origin;
        let c = l.max(l.abs(x), l.max(l.abs(y), l.abs(z)));
        let of_ray = l.mul_add(c, l.splat(128.0 * U), l.splat(16.0 * U * self.reach));
        l.add(of_ray, l.splat(words[1]))
    }

    /// Of triangles with `noise` p.
    #[inline(always)]
    pub(super) fn of<L: Lanes>(&self, l: L, words: &[f32], noise: L::F) -> TriangleBounds<L::F> {
        let scale = self.length * words[0];
        TriangleBounds {
            e: l.mul(noise, l.splat(scale)),
            e_behind: l.mul(noise, l.splat(words[2])),
            e_det: l.splat(scale * words[1]),
        }
    }
}

impl<F: Copy> TriangleBounds<F> {
    /// Twice e.
    #[inline(always)]
    pub(super) fn margin<L: Lanes<F = F>>(&self, l: L) -> F {
        l.add(self.e, self.e)
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
        let before_max = l.add(l.mul_sub(max, det_most, t), bounds.e_behind);
        let worst = l.min(l.add(inside, bounds.e), l.min(l.add(t, bounds.e_behind), before_max));
        let kept = l.at_least(worst, l.splat(0.0)) & valid;
        Self { kept, inside, t, det, det_most, bounds }
    }

    /// Which of the kept hits are certain and lie beyond `min`, and between which parameters they lie.
    #[inline(always)]
    pub(super) fn certain<L: Lanes<F = F>>(&self, l: L, min: f32) -> (u32, F, F) {
        let Self { kept, inside, t, det, det_most, bounds } = *self;
        let e_t = l.mul(bounds.e_behind, l.splat(0.5));
        // The quotients round too.
        let lowest = l.mul(l.div(l.sub(t, e_t), det_most), l.splat(1.0 - 4.0 * f32::EPSILON));
        let det_least = l.sub(det, bounds.e_det);
        let highest = l.mul(l.div(l.add(t, e_t), det_least), l.splat(1.0 + 4.0 * f32::EPSILON));
        let certain = kept
            & l.above(inside, bounds.e)
            & l.above(t, e_t)
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

/// Marks a candidate that `f64` must accept: no record is as far on.
const CERTAIN: u32 = 1 << 31;

/// Lets `f64` decide on a candidate.
#[inline(always)]
fn decide(wide: &Wide, probe: &mut Probe, candidate: u64) -> bool {
    let what = candidate as u32;
    if what & CERTAIN == 0 { wide.test(probe, what) } else { wide.solve(probe, what & !CERTAIN) }
}

/// A ray on its way to the closest hit.
struct Closest<'w, 's, L: Lanes> {
    wide: &'w Wide<'s>,
    ray: &'w Ray,
    range: Interval,
    in_frame: WideRay<L>,
    /// What `f64` has decided: nothing yet, as a rule, until the walk ends.
    probe: Option<Probe<'w>>,
    /// Candidates for the closest hit, each with the lower end of where it may be.
    candidates: Stack<CANDIDATES>,
    /// Nothing beyond this parameter can be the closest hit.
    max: f32,
}

impl<'w, L: Lanes> Closest<'w, '_, L> {
    /// Sorts out the triangles of a leaf.
    #[inline(always)]
    fn visit(&mut self, leaf: Child) {
        if leaf.has_spheres() {
            return self.visit_spheres(leaf);
        }
        let wide = self.wide;
        let (lanes, ray) = (self.in_frame.lanes, &self.in_frame);
        let filtered = ray.filter(wide.words(leaf), leaf.count(), self.max);
        if filtered.kept == 0 {
            return;
        }
        let (certain, lowest, highest) = filtered.certain(lanes, ray.least(self.range));
        let (lowest, highest) = (lanes.store(lowest), lanes.store(highest));
        let mut kept = filtered.kept;
        while kept != 0 {
            let lane = kept.trailing_zeros() as usize % WIDTH;
            kept &= kept - 1;
            let record = Wide::record(leaf, lane);
            for corner in wide.triangle(record).1 {
                lanes.prefetch(&wide.scene.mesh.positions[corner]);
            }
            let is_certain = certain >> lane & 1 != 0;
            let what = if is_certain { record | CERTAIN } else { record };
            self.candidates.push(key(lowest[lane].max(0.0), what));
            if is_certain {
                self.max = self.max.min(highest[lane]);
            }
        }
    }

    #[inline(never)]
    fn visit_spheres(&mut self, leaf: Child) {
        let probe = self.probe.get_or_insert(Probe::new(self.wide.scene, self.ray, self.range));
        for sphere in self.wide.primitives(leaf) {
            if probe.test(sphere) {
                self.max = self.max.min(self.in_frame.slabs.parameter(probe.range().max));
            }
        }
    }

    /// Lets `f64` decide on the candidates. What came last is nearest more often than not.
    #[inline(always)]
    fn decided(&mut self) -> Probe<'w> {
        let mut probe =
            self.probe.take().unwrap_or(Probe::new(self.wide.scene, self.ray, self.range));
        while let Some(candidate) = self.candidates.pop() {
            if near(candidate) <= self.max && decide(self.wide, &mut probe, candidate) {
                self.max = self.max.min(self.in_frame.slabs.parameter(probe.range().max));
            }
        }
        probe
    }

    /// Makes room for more candidates.
    #[inline(never)]
    fn make_room(&mut self) {
        self.probe = Some(self.decided());
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
    let in_frame = WideRay::new(lanes, wide, ray);
    let max = in_frame.slabs.parameter(range.max);
    let mut walk =
        Closest { wide, ray, range, in_frame, probe: None, candidates: Stack::new(), max };
    let mut stack = Stack::<MOST_PENDING>::new();
    let mut next = Child::node(0);
    loop {
        if next.is_leaf() {
            wide.watch_leaf(next, observer);
            if walk.candidates.length > CANDIDATES - WIDTH {
                walk.make_room();
            }
            let walk = &mut walk;
            lanes.apart(
                #[inline(always)]
                move |_| walk.visit(next),
            );
        } else {
            let node = &wide.nodes[next.0 as usize];
            wide.watch_node(node, observer);
            // Its line is the last of the node's, and read last.
            lanes.prefetch(&node.children);
            let (near, met) = walk.in_frame.enter(node, walk.max);
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
                if walk.candidates.length == 0 && walk.probe.is_none() {
                    return None;
                }
                let walk = &mut walk;
                return lanes.apart(
                    #[inline(always)]
                    move |_| walk.decided().best(),
                );
            };
            if near(entry) <= walk.max {
                break child(entry);
            }
        };
    }
}

/// A ray on its way to any hit.
struct Any<'w, 's, L: Lanes> {
    wide: &'w Wide<'s>,
    ray: &'w Ray,
    range: Interval,
    in_frame: WideRay<L>,
    max: f32,
}

impl<L: Lanes> Any<'_, '_, L> {
    /// A primitive of a leaf that the ray meets, if there is one.
    #[inline(always)]
    fn visit(&self, leaf: Child) -> Option<PrimitiveId> {
        if leaf.has_spheres() {
            return self.test(leaf, 0);
        }
        let wide = self.wide;
        let (lanes, ray) = (self.in_frame.lanes, &self.in_frame);
        let filtered = ray.filter(wide.words(leaf), leaf.count(), self.max);
        if filtered.kept == 0 {
            return None;
        }
        let (mut certain, _, highest) = filtered.certain(lanes, ray.least(self.range));
        let highest = lanes.store(highest);
        let surely_before = ray.slabs.parameter_below(self.range.max);
        while certain != 0 {
            let lane = certain.trailing_zeros() as usize % WIDTH;
            certain &= certain - 1;
            if highest[lane] < surely_before {
                return Some(wide.triangle(Wide::record(leaf, lane)).0);
            }
        }
        self.test(leaf, filtered.kept)
    }

    /// Lets `f64` decide on what the filter kept of a leaf, or on its spheres. Called last, it costs those
    /// leaves nothing that do not need it.
    #[inline(never)]
    fn test(&self, leaf: Child, mut kept: u32) -> Option<PrimitiveId> {
        let wide = self.wide;
        let mut probe = Probe::new(wide.scene, self.ray, self.range);
        if leaf.has_spheres() {
            return wide.primitives(leaf).find(|&primitive| probe.test(primitive));
        }
        while kept != 0 {
            let record = Wide::record(leaf, kept.trailing_zeros() as usize % WIDTH);
            kept &= kept - 1;
            if wide.test(&mut probe, record) {
                return Some(wide.triangle(record).0);
            }
        }
        None
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
    let in_frame = WideRay::new(lanes, wide, ray);
    let max = in_frame.slabs.parameter(range.max);
    let walk = Any { wide, ray, range, in_frame, max };
    let mut stack = Stack::<MOST_PENDING>::new();
    let mut next = Child::node(0);
    loop {
        if next.is_leaf() {
            wide.watch_leaf(next, observer);
            let walk = &walk;
            let found = lanes.apart(
                #[inline(always)]
                move |_| walk.visit(next),
            );
            if found.is_some() {
                return found;
            }
        } else {
            let node = &wide.nodes[next.0 as usize];
            wide.watch_node(node, observer);
            // Its line is the last of the node's, and read last.
            lanes.prefetch(&node.children);
            let (_, mut met) = walk.in_frame.enter(node, max);
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
