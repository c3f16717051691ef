use std::ops::Range;

use lancer_core::geometry::{ConvexVolume, Ray};
use lancer_core::intersector::{Hit, Observer, Probe, Query, Wanted};
use lancer_core::scene::{PrimitiveId, Scene, Subset};
use smallvec::SmallVec;

use crate::binary_tree::{BinaryTree, Coverage, TreeNode, TreeStatistics};
use crate::four_boxes::{FourBoxes, FourSlabs, Frame};
use crate::front::Front;
use crate::pending::{Entered, Lanes, Pending};

/// A binary tree walked two levels at a time: a node here has up to four children, since four boxes
/// are tested at the price of one.
///
/// Boxes are `f32`, rounded outwards and visited conservatively; primitives are decided in `f64`.
/// Source: Ernst and Greiner, *Multi Bounding Volume Hierarchies*; Dammertz et al., *Shallow Bounding
/// Volume Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays*, both 2008.
pub(crate) struct FourWide<'s> {
    scene: &'s Scene,
    frame: Frame,
    /// The first is the root.
    nodes: Vec<Node>,
    /// The primitives of the leaves, leaf by leaf.
    primitives: Vec<PrimitiveId>,
    /// The binary tree's.
    statistics: TreeStatistics,
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

/// What a lane of a node refers to.
enum Below {
    Node(usize),
    /// A range of the primitives.
    Leaf(Range<usize>),
}

impl<'s> FourWide<'s> {
    /// Takes over a tree whose leaves have at most 255 primitives.
    pub(crate) fn of(tree: BinaryTree<'s>) -> Self {
        Self {
            nodes: if tree.nodes.is_empty() { Vec::new() } else { take_over(&tree.nodes) },
            statistics: tree.statistics(),
            scene: tree.scene,
            frame: tree.frame,
            primitives: tree.primitives,
        }
    }

    pub(crate) fn memory(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.primitives.as_slice())
    }

    pub(crate) fn statistics(&self) -> &TreeStatistics {
        &self.statistics
    }

    #[inline]
    pub(crate) fn walk<O: Observer>(&self, query: Query<&Ray>, observer: &mut O) -> Option<Hit> {
        let mut probe = Probe::new(self.scene, query.ray, query.range);
        let slabs = FourSlabs::new(query.ray, &self.frame);
        let mut max = slabs.parameter(query.range.max);
        let mut pending = Pending::default();
        let mut next = self.nodes.first();
        while let Some(node) = next {
            for lane in 0..4 {
                observer.region(&|| self.frame.in_scene(node.boxes.get(lane)));
                observer.box_test();
            }
            let (near, met) = slabs.enter(&node.boxes, max);
            let near = near.to_array();
            for lane in Lanes::<4>(met & node.leaves) {
                if near[lane] > max {
                    continue;
                }
                for &primitive in &self.primitives[node.leaf(lane)] {
                    observer.primitive_test(primitive);
                    if probe.test(primitive) && query.wanted == Wanted::Any {
                        return probe.best();
                    }
                }
                max = slabs.parameter(probe.range().max);
            }
            let inner = Lanes::<4>(met & !node.leaves)
                .map(|lane| Entered::new(near[lane], node.first[lane]));
            next = pending.next(inner, max).map(|index| &self.nodes[index]);
        }
        probe.best()
    }

    /// Boxes are decided in `f64`: they are no longer four at a time, since a beam has a dozen
    /// half-spaces and few boxes need them all.
    pub(crate) fn walk_beam<O: Observer>(
        &self,
        volume: &ConvexVolume,
        far: f64,
        observer: &mut O,
        visit: impl FnMut(PrimitiveId) -> f64,
    ) {
        let root = (!self.nodes.is_empty()).then_some(Below::Node(0));
        Front::new(self.scene, volume, far, observer).search(root, visit, |front, below, depth| {
            match below {
                Below::Leaf(range) => {
                    for &primitive in &self.primitives[range] {
                        front.primitive(primitive, depth);
                    }
                }
                Below::Node(index) => {
                    let node = &self.nodes[index];
                    for lane in 0..4 {
                        let below = match node.leaves & 1 << lane {
                            0 => Below::Node(node.first[lane] as usize),
                            _ if node.count[lane] == 0 => continue,
                            _ => Below::Leaf(node.leaf(lane)),
                        };
                        front.node(&self.frame.in_scene(node.boxes.get(lane)), below);
                    }
                }
            }
        });
    }

    pub(crate) fn validate(&self, primitives: Subset) -> Result<(), String> {
        let mut coverage = Coverage::new(primitives, self.nodes.len());
        let mut pending = if self.nodes.is_empty() { Vec::new() } else { vec![0] };
        while let Some(index) = pending.pop() {
            coverage.node()?;
            let node = &self.nodes[index];
            for lane in 0..4 {
                let bounds = node.boxes.get(lane);
                if node.leaves & 1 << lane != 0 {
                    coverage.leaf(&self.frame, bounds, &self.primitives[node.leaf(lane)])?;
                    continue;
                }
                let child = node.first[lane] as usize;
                let below =
                    self.nodes.get(child).ok_or_else(|| format!("there is no node {child}"))?;
                // An empty lane is in every box.
                if !(0..4).all(|lane| bounds.contains(below.boxes.get(lane))) {
                    return Err(format!("node {child} sticks out of node {index}"));
                }
                pending.push(child);
            }
        }
        coverage.all()
    }
}

/// Copies a tree into nodes of four, in depth-first order; the first is the root.
fn take_over(tree: &[TreeNode]) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::with_capacity(tree.len() / 3 + 1);
    // (a node of the tree, the node and lane that refer to it)
    let mut pending: Vec<(&TreeNode, Option<(usize, usize)>)> = vec![(&tree[0], None)];
    while let Some((top, referrer)) = pending.pop() {
        let index = nodes.len();
        if let Some((parent, lane)) = referrer {
            nodes[parent].first[lane] = index as u32;
        }
        nodes.push(Node::EMPTY);
        for (lane, below) in open(tree, top).into_iter().enumerate() {
            let node = &mut nodes[index];
            node.boxes.set(lane, below.bounds);
            if below.is_leaf() {
                node.first[lane] = below.first;
                node.count[lane] = below.count as u8;
            } else {
                node.leaves ^= 1 << lane;
                pending.push((below, Some((index, lane))));
            }
        }
    }
    nodes
}

/// The up to four nodes that a node of the tree is opened into: always the largest inner one next.
fn open<'t>(tree: &'t [TreeNode], top: &'t TreeNode) -> SmallVec<[&'t TreeNode; 4]> {
    let area = |node: &TreeNode| node.bounds.half_area();
    let mut open: SmallVec<[&TreeNode; 4]> = SmallVec::from_slice(&[top]);
    while open.len() < 4 {
        let inner = (0..open.len()).filter(|&lane| !open[lane].is_leaf());
        let largest = inner.max_by(|&a, &b| area(open[a]).total_cmp(&area(open[b])));
        let Some(largest) = largest else { break };
        let [left, right] = open[largest].children();
        open[largest] = &tree[left];
        open.push(&tree[right]);
    }
    open
}
