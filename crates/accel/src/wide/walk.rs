//! The walk through the tree, and what a ray does on its way.

use std::mem::MaybeUninit;
use std::ops::ControlFlow;

use lancer_core::geometry::{Axis, Interval, Ray};
use lancer_core::intersector::{Hit, Observer};
use lancer_core::scene::PrimitiveId;

use super::collapse::WIDTH;
use super::decide::{Certain, Decision};
use super::lanes::Lanes;
use super::ray::{Boxes, WideRay};
use super::{Child, Node, Wide, spheres};
use crate::bvh::MAX_DEPTH;
use crate::four_boxes::FourSlabs;
use crate::pending::Lanes as Bits;

/// Levels of a tree at most: it has no more than the binary tree that is collapsed.
pub(super) const MOST_LEVELS: usize = MAX_DEPTH + 1;
/// Entries of the stack at most: all children but one of a node on each level.
const MOST_PENDING: usize = MOST_LEVELS * (WIDTH - 1);
/// Candidates for the answer that are kept until the end of the walk.
const CANDIDATES: usize = 24;

/// What walks: a ray, or several.
pub(super) trait Walker<L: Lanes> {
    /// Whether near children come first.
    const SORTS: bool;
    /// What tests boxes.
    type Boxes;
    /// What tests the boxes before [`Walker::max`].
    fn boxes(&self) -> Self::Boxes;
    /// Where it enters the eight boxes, and which of them it meets, a bit per lane.
    fn enter(&mut self, boxes: &Self::Boxes, node: &Node) -> (L::F, u32);
    /// Visits a leaf. The walk may be over.
    fn visit(&mut self, leaf: Child) -> ControlFlow<()>;
    /// Nothing beyond this parameter is of interest.
    fn max(&self) -> f32;
}

/// Visits the leaves that the walker meets until it breaks off.
#[inline(always)]
pub(super) fn walk<L: Lanes, W: Walker<L>, O: Observer>(
    lanes: L,
    wide: &Wide,
    walker: &mut W,
    observer: &mut O,
) -> ControlFlow<()> {
    let mut space = Stack::<MOST_PENDING>::SPACE;
    let mut pending = Stack::new(&mut space);
    let mut next = Child::node(0);
    let mut boxes = walker.boxes();
    loop {
        while !next.is_leaf() {
            let node = &wide.nodes[next.0 as usize];
            wide.watch_node(node, observer);
            // Its line is the last of the node's, and read last.
            lanes.prefetch(&node.children);
            let (near, met) = walker.enter(&boxes, node);
            next = if met == 0 {
                let Some(child) = pending.pop_before(walker.max()) else {
                    return ControlFlow::Continue(());
                };
                child
            } else if met & (met - 1) == 0 {
                node.children[met.trailing_zeros() as usize % WIDTH]
            } else if W::SORTS {
                pending.push_but_nearest(met, &lanes.store(near), &node.children)
            } else {
                pending.push_but_last(met, &node.children)
            };
        }
        wide.watch_leaf(next, observer);
        walker.visit(next)?;
        let Some(child) = pending.pop_before(walker.max()) else {
            return ControlFlow::Continue(());
        };
        next = child;
        boxes = walker.boxes();
    }
}

/// At most `N` numbers, the last one first: a parameter that is at least 0 in the high bits, so that integers
/// are in the order of parameters, and what is there in the low ones. They stand elsewhere, so that the length
/// may be in a register.
struct Stack<'s, const N: usize> {
    entries: &'s mut [MaybeUninit<u64>; N],
    length: usize,
}

impl<'s, const N: usize> Stack<'s, N> {
    /// Room for the numbers: nothing is initialised in vain.
    const SPACE: [MaybeUninit<u64>; N] = [const { MaybeUninit::uninit() }; N];

    #[inline(always)]
    fn new(entries: &'s mut [MaybeUninit<u64>; N]) -> Self {
        Self { entries, length: 0 }
    }

    #[inline(always)]
    fn push(&mut self, entry: u64) {
        self.entries[self.length] = MaybeUninit::new(entry);
        self.length += 1;
    }

    #[inline(always)]
    #[allow(unsafe_code)]
    fn at(&self, place: usize) -> u64 {
        assert!(place < self.length);
        // SAFETY: what is below the length has been pushed, and there is room for it.
        unsafe { self.entries.get_unchecked(place).assume_init() }
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<u64> {
        let last = self.at(self.length.checked_sub(1)?);
        self.length -= 1;
        Some(last)
    }

    /// The last child that is entered before `max`.
    #[inline(always)]
    fn pop_before(&mut self, max: f32) -> Option<Child> {
        loop {
            let entry = self.pop()?;
            if near(entry) <= max {
                return Some(child(entry));
            }
        }
    }

    /// All numbers, which it has no more.
    #[inline(always)]
    fn take(&mut self) -> Stack<'_, N> {
        Stack { entries: &mut *self.entries, length: std::mem::take(&mut self.length) }
    }

    /// Pushes the lanes of a mask with at least two bits, but for the last one.
    #[inline(always)]
    fn push_but_last(&mut self, mut met: u32, children: &[Child; WIDTH]) -> Child {
        loop {
            let child = children[met.trailing_zeros() as usize % WIDTH];
            met &= met - 1;
            if met == 0 {
                return child;
            }
            self.push(entry(0.0, child));
        }
    }

    /// Pushes the lanes of a mask with at least two bits, far ones first, but for the nearest.
    #[inline(always)]
    fn push_but_nearest(
        &mut self,
        met: u32,
        near: &[f32; WIDTH],
        children: &[Child; WIDTH],
    ) -> Child {
        let mut lanes = Bits::<WIDTH>(met);
        let mut next = || lanes.next().map(|lane| entry(near[lane], children[lane]));
        let (Some(a), Some(b)) = (next(), next()) else { unreachable!("at least two") };
        let (mut nearest, far) = (a.min(b), a.max(b));
        let Some(c) = next() else {
            self.push(far);
            return child(nearest);
        };
        let middle = nearest.max(c);
        nearest = nearest.min(c);
        let first = self.length;
        self.push(far.max(middle));
        self.push(far.min(middle));
        while let Some(d) = next() {
            self.insert(nearest.max(d), first);
            nearest = nearest.min(d);
        }
        child(nearest)
    }

    /// Pushes an entry to its place among those from `first` on, which are in falling order.
    #[inline(always)]
    fn insert(&mut self, entry: u64, first: usize) {
        let mut place = self.length;
        self.push(entry);
        while place > first {
            let before = self.at(place - 1);
            if before >= entry {
                break;
            }
            self.entries[place] = MaybeUninit::new(before);
            place -= 1;
        }
        self.entries[place] = MaybeUninit::new(entry);
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
fn child(entry: u64) -> Child {
    Child(entry as u32)
}

#[inline(always)]
fn near(entry: u64) -> f32 {
    f32::from_bits((entry >> 32) as u32)
}

/// Marks a candidate that `f64` must accept: no record is as far on.
const CERTAIN: u32 = 1 << 31;

/// A ray on its way through the tree.
struct Single<'w, L: Lanes, G> {
    lanes: L,
    wide: &'w Wide<'w>,
    ray: &'w Ray,
    range: Interval,
    in_frame: &'w WideRay,
    /// Nothing beyond this parameter is of interest.
    max: f32,
    goal: G,
}

/// What a ray looks for.
trait Goal: Sized {
    /// Whether what is near is of more interest.
    const SORTS: bool;
    /// Sorts out the primitives of a leaf. The walk may be over.
    fn visit<L: Lanes>(single: &mut Single<'_, L, Self>, leaf: Child) -> ControlFlow<()>;
}

impl<L: Lanes, G: Goal> Walker<L> for Single<'_, L, G> {
    const SORTS: bool = G::SORTS;

    type Boxes = Boxes<L>;

    #[inline(always)]
    fn boxes(&self) -> Boxes<L> {
        self.in_frame.boxes(self.lanes, self.max)
    }

    #[inline(always)]
    fn enter(&mut self, boxes: &Boxes<L>, node: &Node) -> (L::F, u32) {
        boxes.enter(self.lanes, node)
    }

    #[inline(always)]
    fn visit(&mut self, leaf: Child) -> ControlFlow<()> {
        self.in_frame = self.lanes.read_here(self.in_frame);
        G::visit(self, leaf)
    }

    #[inline(always)]
    fn max(&self) -> f32 {
        self.max
    }
}

/// The closest hit.
struct Closest<'w> {
    /// What `f64` has decided on: nothing, as a rule, until the walk ends.
    early: &'w mut Option<Hit>,
    /// Candidates, each with the lower end of where it may be.
    candidates: Stack<'w, CANDIDATES>,
}

impl Goal for Closest<'_> {
    const SORTS: bool = true;

    #[inline(always)]
    fn visit<L: Lanes>(single: &mut Single<'_, L, Self>, leaf: Child) -> ControlFlow<()> {
        let (wide, lanes, ray) = (single.wide, single.lanes, single.in_frame);
        if leaf.has_spheres() {
            let early = &mut *single.goal.early;
            let end = spheres::test(lanes, wide, leaf, single.ray, single.range, early);
            single.max = single.max.min(ray.slabs.parameter(end));
            return ControlFlow::Continue(());
        }
        let filtered = ray.filter(lanes, wide.words(leaf), leaf.count(), single.max);
        if filtered.kept == 0 {
            return ControlFlow::Continue(());
        }
        let (certain, lowest, highest) = filtered.certain(lanes, ray.least(single.range));
        let lowest = lanes.store(lanes.max(lowest, lanes.splat(0.0)));
        let highest = lanes.store(highest);
        for lane in Bits::<WIDTH>(filtered.kept) {
            let record = Wide::record(leaf, lane);
            let mut what = record;
            if certain >> lane & 1 != 0 {
                what |= CERTAIN;
                if highest[lane] < single.max {
                    single.max = highest[lane];
                }
            }
            single.goal.candidates.push(key(lowest[lane], what));
        }
        if single.goal.candidates.length > CANDIDATES - WIDTH {
            single.make_room();
        }
        ControlFlow::Continue(())
    }
}

impl<L: Lanes> Single<'_, L, Closest<'_>> {
    /// Decides on the candidates, so that there is room for others.
    #[inline(always)]
    fn make_room(&mut self) {
        let (wide, ray, range, max) = (self.wide, self.ray, self.range, self.max);
        let (candidates, slabs) = (self.goal.candidates.take(), &self.in_frame.slabs);
        let early = &mut *self.goal.early;
        let end = self.lanes.apart(
            #[inline(always)]
            move |lanes| {
                let decision = Decision::new(lanes, wide, ray, range, *early);
                *early = decide(decision, candidates, slabs, max);
                early.map_or(range.max, |hit| hit.t)
            },
        );
        self.max = self.max.min(slabs.parameter(end));
    }
}

/// Lets `f64` decide on candidates up to `max`. What came last is nearest more often than not.
#[inline(always)]
fn decide<L: Lanes>(
    mut decision: Decision<L>,
    mut candidates: Stack<CANDIDATES>,
    slabs: &FourSlabs,
    mut max: f32,
) -> Option<Hit> {
    while let Some(candidate) = candidates.pop() {
        if near(candidate) > max {
            continue;
        }
        let what = candidate as u32;
        if decision.test(what & !CERTAIN, what & CERTAIN != 0) {
            let end = slabs.parameter(decision.end());
            if end < max {
                max = end;
            }
        }
    }
    decision.best()
}

/// The closest hit.
#[inline(always)]
pub(super) fn closest<L: Lanes, O: Observer>(
    lanes: L,
    wide: &Wide,
    ray: &Ray,
    range: Interval,
    observer: &mut O,
) -> Option<Hit> {
    closest_or(
        lanes,
        wide,
        ray,
        range,
        observer,
        #[inline(always)]
        |_| false,
    )
}

/// The closest hit, unless `f64` is left with one triangle that the ray meets for certain, and somebody `takes` its
/// record: then nothing.
#[inline(always)]
fn closest_or<L: Lanes, O: Observer>(
    lanes: L,
    wide: &Wide,
    ray: &Ray,
    range: Interval,
    observer: &mut O,
    takes: impl FnOnce(u32) -> bool,
) -> Option<Hit> {
    if wide.nodes.is_empty() {
        return None;
    }
    let in_frame = &WideRay::new(lanes, wide, ray);
    let max = in_frame.slabs.parameter(range.max);
    let mut space = Stack::SPACE;
    let mut early = None;
    let goal = Closest { early: &mut early, candidates: Stack::new(&mut space) };
    let mut single = Single { lanes, wide, ray, range, in_frame, max, goal };
    let _ = walk(lanes, wide, &mut single, observer);
    let Single { max, goal: Closest { mut candidates, early }, .. } = single;
    let early = *early;
    if early.is_none() {
        let last = candidates.pop()? as u32;
        if candidates.length == 0 && last & CERTAIN != 0 && takes(last & !CERTAIN) {
            return None;
        }
        // It is there still.
        candidates.length += 1;
    }
    let decision = Decision::new(lanes, wide, lanes.read_here(ray), range, early);
    decide(decision, candidates, &in_frame.slabs, max)
}

/// The closest hit of each of many rays.
#[inline(always)]
pub(super) fn closest_each<L: Lanes>(
    lanes: L,
    wide: &Wide,
    rays: &[Ray],
    range: Interval,
    hits: &mut [Option<Hit>],
) {
    let mut certain = Certain::new();
    for (k, (ray, hit)) in rays.iter().zip(&mut *hits).enumerate() {
        *hit = closest_or(
            lanes,
            wide,
            ray,
            range,
            &mut (),
            #[inline(always)]
            |record| {
                // What `f64` will read is on its way while others walk.
                for corner in wide.triangle(record).1 {
                    lanes.prefetch(&wide.scene.mesh.positions[corner]);
                }
                certain.push(Axis::longest(ray.direction), k, record);
                true
            },
        );
    }
    certain.solve(lanes, wide, rays, range, hits);
}

/// Any hit: what the ray meets.
struct Any(Option<PrimitiveId>);

impl Goal for Any {
    const SORTS: bool = false;

    #[inline(always)]
    fn visit<L: Lanes>(single: &mut Single<'_, L, Self>, leaf: Child) -> ControlFlow<()> {
        let (wide, lanes, ray) = (single.wide, single.lanes, single.in_frame);
        let mut kept = 0;
        if !leaf.has_spheres() {
            let filtered = ray.filter(lanes, wide.words(leaf), leaf.count(), single.max);
            if filtered.kept == 0 {
                return ControlFlow::Continue(());
            }
            kept = filtered.kept;
            let (certain, _, highest) = filtered.certain(lanes, ray.least(single.range));
            let before_end = lanes.splat(ray.slabs.parameter_below(single.range.max));
            let certain = certain & lanes.above(before_end, highest);
            if certain != 0 {
                let lane = certain.trailing_zeros() as usize % WIDTH;
                single.goal = Self(Some(wide.triangle(Wide::record(leaf, lane)).0));
                return ControlFlow::Break(());
            }
        }
        single.goal = Self(single.test(leaf, kept));
        if single.goal.0.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

impl<L: Lanes> Single<'_, L, Any> {
    /// Lets `f64` decide on what the filter kept of a leaf, or on its spheres. Returns what the ray meets.
    #[inline(always)]
    fn test(&self, leaf: Child, kept: u32) -> Option<PrimitiveId> {
        let (wide, ray, range) = (self.wide, self.ray, self.range);
        if leaf.has_spheres() {
            let mut early = None;
            spheres::test(self.lanes, wide, leaf, ray, range, &mut early);
            return early.map(|hit| hit.primitive);
        }
        self.lanes.apart(
            #[inline(always)]
            move |lanes| {
                let mut decision = Decision::new(lanes, wide, ray, range, None);
                for lane in Bits::<WIDTH>(kept) {
                    if decision.test(Wide::record(leaf, lane), false) {
                        return decision.best().map(|hit| hit.primitive);
                    }
                }
                None
            },
        )
    }
}

/// Any hit.
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
    let in_frame = &WideRay::new(lanes, wide, ray);
    let max = in_frame.slabs.parameter(range.max);
    let mut single = Single { lanes, wide, ray, range, in_frame, max, goal: Any(None) };
    let _ = walk(lanes, wide, &mut single, observer);
    single.goal.0
}
