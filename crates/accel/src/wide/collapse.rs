//! From a binary tree with one or two primitives per leaf to nodes of eight children and leaves of up to eight
//! triangles.

use lancer_core::scene::PrimitiveId;
use rayon::prelude::*;
use smallvec::SmallVec;

use super::{Child, Node, leaf};
use crate::binary_tree::{BinaryTree, TreeNode};
use crate::four_boxes::FrameBox;

/// Children of a node, and primitives of a leaf, at most.
pub(super) const WIDTH: usize = 8;

/// What a leaf costs, whatever its number of triangles, in visits of a node: both are a handful of
/// vector operations after a cache miss.
const LEAF_COST: f32 = 0.9;

/// What is below a node of the binary tree.
#[derive(Clone, Copy)]
struct Below {
    /// `cost[k]`: the least cost of representing it by at most k + 1 children of one node, each a leaf
    /// or a node.
    cost: [f32; WIDTH - 1],
    /// `left[k]`: how many of at most k + 1 of them are in its left part; 0 where fewer, or one leaf or
    /// node, are better.
    left: [u8; WIDTH],
    /// The primitives of its leaves; one that was split may count several times.
    count: u32,
}

/// The best collapse by dynamic programming.
///
/// ```text
/// C(n, 1) = min( leaf: A(n) · 0.9  if n has at most 8 triangles,
///                node: A(n) + min_k C(left, k) + C(right, 8 − k) )
/// C(n, j) = min( C(n, j − 1),  min_k C(left, k) + C(right, j − k) )
/// ```
///
/// Source: Ylitie, Karras, Laine, *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
/// BVHs*, HPG 2017.
fn costs(tree: &[TreeNode]) -> Vec<Below> {
    let unknown = Below { cost: [0.0; WIDTH - 1], left: [0; WIDTH], count: 0 };
    let mut all = vec![unknown; tree.len()];
    if let Some((root, descendants)) = all.split_first_mut() {
        *root = cost_of(tree, 0, descendants);
    }
    all
}

/// Nodes below which the two parts are worked out by different threads.
const PARALLEL: usize = 1 << 13;

/// Works out what is below a node, and of its descendants, which stand together: the two children, what is
/// below the left one, what is below the right one.
fn cost_of(tree: &[TreeNode], index: usize, descendants: &mut [Below]) -> Below {
    let node = &tree[index];
    let area = node.bounds.half_area();
    if node.is_leaf() {
        let cost = [LEAF_COST * area; WIDTH - 1];
        return Below { cost, left: [0; WIDTH], count: node.count };
    }
    let [left, right] = node.children();
    let below_right = if tree[right].is_leaf() { None } else { Some(tree[right].children()[0]) };
    let (children, below) = descendants.split_at_mut(2);
    let below_left = below_right.map_or(below.len(), |first| first - (right + 1));
    let (lefts, rights) = below.split_at_mut(below_left);
    let (left, right) = if lefts.len().min(rights.len()) > PARALLEL {
        rayon::join(|| cost_of(tree, left, lefts), || cost_of(tree, right, rights))
    } else {
        (cost_of(tree, left, lefts), cost_of(tree, right, rights))
    };
    (children[0], children[1]) = (left, right);
    inner(area, &left, &right)
}

fn inner(area: f32, left: &Below, right: &Below) -> Below {
    // (cost, how many are left) of at most `total` children, some from each part.
    let best = |total: usize| {
        let mut best = (f32::INFINITY, 0);
        for k in 1..total {
            let cost = left.cost[k - 1] + right.cost[total - k - 1];
            if cost < best.0 {
                best = (cost, k as u8);
            }
        }
        best
    };
    let count = left.count + right.count;
    let mut below = Below { cost: [0.0; WIDTH - 1], left: [0; WIDTH], count };
    let (distributed, lefts) = best(WIDTH);
    below.left[WIDTH - 1] = lefts;
    below.cost[0] = area + distributed;
    if count <= WIDTH as u32 {
        below.cost[0] = below.cost[0].min(LEAF_COST * area);
    }
    for k in 1..WIDTH - 1 {
        let (cost, lefts) = best(k + 1);
        below.cost[k] = below.cost[k - 1];
        if cost < below.cost[k - 1] {
            (below.cost[k], below.left[k]) = (cost, lefts);
        }
    }
    below
}

/// The nodes, the root first, in depth-first order, and the words of the leaves.
pub(super) struct Collapsed {
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<f32>,
}

/// Leaves that a thread fills at once.
const LEAVES: usize = 1 << 10;

pub(super) fn collapse(tree: &BinaryTree) -> Collapsed {
    let mut nodes: Vec<Node> = Vec::new();
    if tree.nodes.is_empty() {
        return Collapsed { nodes, leaves: Vec::new() };
    }
    let below = costs(&tree.nodes);
    let is_leaf = |index: usize| {
        let below = &below[index];
        let area = tree.nodes[index].bounds.half_area();
        below.count <= WIDTH as u32 && below.cost[0] >= LEAF_COST * area
    };
    // Where the words of each leaf begin, and what is in it.
    let mut leaves: Vec<(usize, Primitives)> = Vec::new();
    let mut words = 0;
    // (a node of the tree, the node and lane that refer to it)
    let mut pending: Vec<(usize, Option<(usize, usize)>)> = vec![(0, None)];
    while let Some((top, referrer)) = pending.pop() {
        let index = nodes.len();
        if let Some((parent, lane)) = referrer {
            nodes[parent].children[lane] = Child::node(index);
        }
        nodes.push(Node::EMPTY);
        let mut children = SmallVec::new();
        if is_leaf(top) {
            children.push(top);
        } else {
            open(&tree.nodes, &below, top, WIDTH, &mut children);
        }
        for (lane, child) in children.into_iter().enumerate() {
            nodes[index].set_box(lane, tree.nodes[child].bounds);
            if is_leaf(child) {
                let mut primitives = Primitives::new();
                gather(tree, child, &mut primitives);
                let has_spheres = leaf::has_spheres(tree.scene, &primitives);
                nodes[index].children[lane] = Child::leaf(words, primitives.len(), has_spheres);
                let begin = words;
                words += leaf::words(primitives.len(), has_spheres);
                leaves.push((begin, primitives));
            } else {
                pending.push((child, Some((index, lane))));
            }
        }
    }
    Collapsed { nodes, leaves: fill(tree, &leaves, words) }
}

/// The primitives of a leaf.
type Primitives = SmallVec<[PrimitiveId; WIDTH]>;

/// The primitives below a node of the tree. One that was split may be there twice, and comes once.
fn gather(tree: &BinaryTree, node: usize, into: &mut Primitives) {
    let node = &tree.nodes[node];
    if node.is_leaf() {
        for primitive in &tree.primitives[node.leaf()] {
            if !into.contains(primitive) {
                into.push(*primitive);
            }
        }
        return;
    }
    node.children().into_iter().for_each(|child| gather(tree, child, into));
}

/// The words of all leaves.
fn fill(tree: &BinaryTree, leaves: &[(usize, Primitives)], count: usize) -> Vec<f32> {
    // Eight numbers are read at a time, whose-ever they are.
    let mut words = vec![0.0; count + WIDTH];
    let mut parts = Vec::new();
    let mut rest = words.as_mut_slice();
    for part in leaves.chunks(LEAVES).rev() {
        let (before, mine) = rest.split_at_mut(part[0].0);
        parts.push((part, mine));
        rest = before;
    }
    parts.into_par_iter().for_each(|(part, words)| {
        for (offset, primitives) in part {
            leaf::fill(tree, primitives, &mut words[offset - part[0].0..]);
        }
    });
    words
}

/// The at most `most` nodes that a node of the tree is opened into; `WIDTH` opens it in any case.
fn open(
    tree: &[TreeNode],
    below: &[Below],
    node: usize,
    most: usize,
    into: &mut SmallVec<[usize; WIDTH]>,
) {
    let mut most = most;
    // Fewer may be as good.
    while most > 1 && most < WIDTH && below[node].left[most - 1] == 0 {
        most -= 1;
    }
    if most == 1 || tree[node].is_leaf() {
        into.push(node);
        return;
    }
    let lefts = usize::from(below[node].left[most - 1]);
    let [left, right] = tree[node].children();
    open(tree, below, left, lefts, into);
    open(tree, below, right, most - lefts, into);
}

impl Node {
    pub(super) fn set_box(&mut self, lane: usize, bounds: FrameBox) {
        for axis in 0..3 {
            self.planes[axis][0][lane] = bounds.min[axis];
            self.planes[axis][1][lane] = bounds.max[axis];
        }
    }
}
