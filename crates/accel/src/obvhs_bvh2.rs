use std::ops::Range;

use glam::Vec3A;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::intersector::{Hit, Intersector, Observer, Probe};
use lancer_core::scene::{PrimitiveId, Scene};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use smallvec::SmallVec;

use crate::four_boxes::{FourBoxes, FourSlabs, Frame};

/// The binary bounding volume hierarchy that the obvhs library builds, walked two levels at a time.
///
/// The library builds good trees fast, in `f32`. Its own traversal and triangle test are made for
/// speed and lose rays aimed at edges and vertices, so only its tree is taken over: boxes in `f32`,
/// rounded outwards, visited conservatively, and primitives decided in `f64`. A node here has up to
/// four children, since four boxes are tested at the price of one.
pub struct ObvhsBvh2<'s> {
    scene: &'s Scene,
    frame: Frame,
    /// The first is the root.
    nodes: Vec<Node>,
    /// The primitives of the leaves, leaf by leaf.
    primitives: Vec<PrimitiveId>,
}

/// An inner node: its children and their boxes, two cache lines. A lane without a child has an empty
/// box, and is a leaf without primitives.
#[repr(align(64))]
struct Node {
    boxes: FourBoxes,
    /// Per lane the index of a node or, in a leaf, of the first primitive.
    first: [u32; 4],
    /// Per lane the primitives of a leaf.
    count: [u8; 4],
    /// One bit per lane: its child is a leaf.
    leaves: u32,
}

impl Node {
    const EMPTY: Self =
        Self { boxes: FourBoxes::EMPTY, first: [0; 4], count: [0; 4], leaves: 0b1111 };

    /// The primitives of the leaf in a lane.
    #[inline(always)]
    fn leaf(&self, lane: usize) -> Range<usize> {
        let first = self.first[lane] as usize;
        first..first + usize::from(self.count[lane])
    }
}

/// A node still to be visited: the parameter at which the ray enters it, at least 0, in the upper half
/// and its index in the lower one. Such numbers are ordered near to far.
type Pending = u64;

/// What is still to be visited. A tree that needs more than 64 is rare and pays for an allocation.
type Stack = SmallVec<[Pending; 64]>;

/// Leaves of at most three primitives: a primitive's `f64` test costs as much as a node's.
const BUILD: BvhBuildParams = BvhBuildParams {
    max_prims_per_leaf: 3,
    collapse_traversal_cost: 1.0,
    ..BvhBuildParams::medium_build()
};

impl<'s> ObvhsBvh2<'s> {
    /// Builds the tree over all primitives of the scene.
    pub fn build(scene: &'s Scene) -> Self {
        let frame = Frame::of(scene.bounds());
        let boxes: Vec<Aabb> = scene
            .primitives()
            .map(|primitive| {
                let [min, max] = frame.outwards(scene.primitive_bounds(primitive));
                Aabb::new(min, max)
            })
            .collect();
        let tree = if boxes.is_empty() {
            Bvh2::default()
        } else {
            build_bvh2(&boxes, BUILD, &mut Default::default())
        };
        drop(boxes);
        let nodes = if tree.nodes.is_empty() { Vec::new() } else { take_over(&tree) };
        let primitives = tree.primitive_indices.into_iter().map(PrimitiveId).collect();
        Self { scene, frame, nodes, primitives }
    }

    /// Bytes held by the index, without the scene it borrows.
    pub fn memory(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.primitives.as_slice())
    }

    /// Visits the primitives whose boxes the ray meets, the leaves of a node before its other
    /// children and the nearest of those next, until `done` says so.
    #[inline]
    pub fn walk<O: Observer>(
        &self,
        ray: &Ray,
        range: Interval,
        observer: &mut O,
        done: impl Fn(&Probe) -> bool,
    ) -> Option<Hit> {
        let mut probe = Probe::new(self.scene, ray, range);
        let slabs = FourSlabs::new(ray, &self.frame);
        let mut max = slabs.parameter(range.max);
        let mut stack = Stack::new();
        let mut next = self.nodes.first();
        while let Some(node) = next {
            (0..4).for_each(|_| observer.box_test());
            let (near, met) = slabs.enter(&node.boxes, max);
            let near = near.to_array();
            for lane in Lanes(met & node.leaves) {
                if near[lane] > max {
                    continue;
                }
                for &primitive in &self.primitives[node.leaf(lane)] {
                    observer.primitive_test(primitive);
                    if probe.test(primitive) && done(&probe) {
                        return probe.best();
                    }
                }
                max = slabs.parameter(probe.range().max);
            }
            let mut inner =
                Lanes(met & !node.leaves).map(|lane| pending(near[lane], node.first[lane]));
            next = if let Some(mut nearest) = inner.next() {
                for other in inner {
                    stack.push(nearest.max(other));
                    nearest = nearest.min(other);
                }
                Some(nearest as u32)
            } else {
                pop(&mut stack, max)
            }
            .map(|index| &self.nodes[index as usize]);
        }
        probe.best()
    }
}

/// The set bits of a mask of four lanes.
struct Lanes(u32);

impl Iterator for Lanes {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize % 4;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}

#[inline(always)]
fn pending(near: f32, node: u32) -> Pending {
    u64::from(near.to_bits()) << 32 | u64::from(node)
}

/// The next node that is not entirely behind the closest hit.
#[inline(always)]
fn pop(stack: &mut Stack, max: f32) -> Option<u32> {
    loop {
        let pending = stack.pop()?;
        if f32::from_bits((pending >> 32) as u32) <= max {
            return Some(pending as u32);
        }
    }
}

/// Copies the tree into nodes of four, in depth-first order; the first is the root.
fn take_over(tree: &Bvh2) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::with_capacity(tree.nodes.len() / 3);
    // (a node of the tree, the node and lane that refer to it)
    let mut pending: Vec<(&Bvh2Node, Option<(usize, usize)>)> = vec![(&tree.nodes[0], None)];
    while let Some((top, referrer)) = pending.pop() {
        let index = nodes.len();
        if let Some((parent, lane)) = referrer {
            nodes[parent].first[lane] = index as u32;
        }
        nodes.push(Node::EMPTY);
        for (lane, below) in open(tree, top).into_iter().enumerate() {
            let node = &mut nodes[index];
            node.boxes.set(lane, [Vec3A::from(below.min), Vec3A::from(below.max)]);
            if below.is_leaf() {
                node.first[lane] = below.first_index;
                node.count[lane] = below.prim_count as u8;
            } else {
                node.leaves ^= 1 << lane;
                pending.push((below, Some((index, lane))));
            }
        }
    }
    nodes
}

/// The up to four nodes that a node of the tree is opened into: always the largest inner one next.
fn open<'t>(tree: &'t Bvh2, top: &'t Bvh2Node) -> SmallVec<[&'t Bvh2Node; 4]> {
    let area = |node: &Bvh2Node| node.aabb().half_area();
    let mut open: SmallVec<[&Bvh2Node; 4]> = SmallVec::from_slice(&[top]);
    while open.len() < 4 {
        let inner = (0..open.len()).filter(|&lane| !open[lane].is_leaf());
        let largest = inner.max_by(|&a, &b| area(open[a]).total_cmp(&area(open[b])));
        let Some(largest) = largest else { break };
        let first = open[largest].first_index as usize;
        open[largest] = &tree.nodes[first];
        open.push(&tree.nodes[first + 1]);
    }
    open
}

impl Intersector for ObvhsBvh2<'_> {
    fn closest_hit(&self, ray: &Ray, range: Interval) -> Option<Hit> {
        self.walk(ray, range, &mut (), |_| false)
    }

    fn occluded(&self, ray: &Ray, range: Interval) -> bool {
        self.walk(ray, range, &mut (), |_| true).is_some()
    }
}
