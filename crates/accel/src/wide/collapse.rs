//! From a binary tree with one primitive per leaf to nodes of eight children and leaves of up to eight
//! triangles.

use lancer_core::scene::{PrimitiveId, Scene};

use super::{Child, Node};
use crate::binary_tree::{BinaryTree, TreeNode};
use crate::four_boxes::{Frame, FrameBox};

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
    /// Its primitives stand together.
    first: u32,
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
    let unknown = Below { cost: [0.0; WIDTH - 1], left: [0; WIDTH], first: 0, count: 0 };
    let mut all = vec![unknown; tree.len()];
    // Children stand behind their parents.
    for (index, node) in tree.iter().enumerate().rev() {
        let area = node.bounds.half_area();
        all[index] = if node.is_leaf() {
            let cost = [LEAF_COST * area; WIDTH - 1];
            Below { cost, left: [0; WIDTH], first: node.first, count: node.count }
        } else {
            let [left, right] = node.children().map(|child| &all[child]);
            inner(area, left, right)
        };
    }
    all
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
    let mut below = Below {
        cost: [0.0; WIDTH - 1],
        left: [0; WIDTH],
        first: left.first.min(right.first),
        count,
    };
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

pub(super) fn collapse(tree: &BinaryTree) -> Collapsed {
    let mut result = Collapsed { nodes: Vec::new(), leaves: Vec::new() };
    if tree.nodes.is_empty() {
        return result;
    }
    let below = costs(&tree.nodes);
    let is_leaf = |index: usize| {
        let below = &below[index];
        let area = tree.nodes[index].bounds.half_area();
        below.count <= WIDTH as u32 && below.cost[0] >= LEAF_COST * area
    };
    // (a node of the tree, the node and lane that refer to it)
    let mut pending: Vec<(usize, Option<(usize, usize)>)> = vec![(0, None)];
    while let Some((top, referrer)) = pending.pop() {
        let index = result.nodes.len();
        if let Some((parent, lane)) = referrer {
            result.nodes[parent].set_child(lane, Child::node(index));
        }
        result.nodes.push(Node::EMPTY);
        let mut children = Vec::with_capacity(WIDTH);
        if is_leaf(top) {
            children.push(top);
        } else {
            open(&tree.nodes, &below, top, WIDTH, &mut children);
        }
        for (lane, child) in children.into_iter().enumerate() {
            result.nodes[index].set_box(lane, tree.nodes[child].bounds);
            if is_leaf(child) {
                let below = below[child];
                let primitives = &tree.primitives[below.first as usize..][..below.count as usize];
                let leaf = push_leaf(&mut result.leaves, tree.scene, &tree.frame, primitives);
                result.nodes[index].set_child(lane, leaf);
            } else {
                pending.push((child, Some((index, lane))));
            }
        }
    }
    result
}

/// The at most `most` nodes that a node of the tree is opened into; `WIDTH` opens it in any case.
fn open(tree: &[TreeNode], below: &[Below], node: usize, most: usize, into: &mut Vec<usize>) {
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

/// Writes a leaf: see [`super::Wide`] for its words.
fn push_leaf(
    leaves: &mut Vec<f32>,
    scene: &Scene,
    frame: &Frame,
    primitives: &[PrimitiveId],
) -> Child {
    let offset = leaves.len();
    let triangles = scene.mesh.triangles.len();
    let has_sphere = primitives.iter().any(|id| id.0 as usize >= triangles);
    if !has_sphere {
        let rows: Vec<[f32; 9]> = primitives
            .iter()
            .map(|id| {
                let [a, b, c] = scene.mesh.corners(id.0 as usize);
                // Edges are rounded in proportion to their own length, not to their place.
                let parts = [frame.point(a), frame.vector(b - a), frame.vector(c - a)];
                std::array::from_fn(|k| parts[k / 3][k % 3] as f32)
            })
            .collect();
        let edges = rows.iter().flat_map(|row| &row[3..]);
        leaves.push(edges.fold(super::SHORTEST, |longest, edge| longest.max(edge.abs())));
        for k in 0..9 {
            leaves.extend(rows.iter().map(|row| row[k]));
        }
    }
    leaves.extend(primitives.iter().map(|id| f32::from_bits(id.0)));
    leaves.resize(leaves.len().next_multiple_of(super::UNIT), 0.0);
    Child::leaf(offset, primitives.len(), has_sphere)
}

impl Node {
    pub(super) fn set_box(&mut self, lane: usize, bounds: FrameBox) {
        for axis in 0..3 {
            self.planes[axis][0][lane] = bounds.min[axis];
            self.planes[axis][1][lane] = bounds.max[axis];
        }
    }

    fn set_child(&mut self, lane: usize, child: Child) {
        self.children[lane] = child;
    }
}
