use glam::Vec4;
use lancer_core::geometry::Ray;
use lancer_core::intersector::{Hit, Observer, Probe, Query, Traversal, Wanted};
use lancer_core::scene::{PrimitiveId, Scene, Subset};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::cwbvh::node::CwBvhNode;

use crate::binary_tree::{BinaryTree, Coverage, TreeNode};
use crate::four_boxes::{FourBoxes, FourSlabs, Frame, FrameBox};
use crate::obvhs_bvh2::{has_many_equal, ids, library_boxes};
use crate::pending::{Entered, Lanes, Pending};

/// The compressed wide hierarchy that the obvhs library builds: eight children per node, their boxes on
/// a grid of 256 steps over the node's.
///
/// *Built* by the library, from a binary tree, which is as that of [`crate::ObvhsBvh2`]. As there only the tree is
/// the library's.
///
/// *Walked* near to far: every visit unpacks a node's boxes, and tests them four at a time.
///
/// *Wins* in memory: a node takes 80 bytes where a [`crate::Bvh`] takes 256 for as many boxes, which is made for
/// graphics processors, where a ray waits for memory. *Loses* to wider boxes as long as those fit into the
/// caches.
///
/// *Sources:* Ylitie, Karras, Laine, *Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
/// BVHs*, HPG 2017.
pub struct ObvhsCwbvh<'s> {
    scene: &'s Scene,
    frame: Frame,
    /// The first is the root.
    nodes: Vec<CwBvhNode>,
    /// The primitives of the leaves.
    primitives: Vec<PrimitiveId>,
}

/// The library rounds a box to its grid in `f32`, where a face may end up inside by some units in the
/// last place of the frame, and so may our unpacking: boxes are grown by more than that before.
const MARGIN: f32 = 8.0 * f32::EPSILON;

/// The most primitives of a leaf that the format has room for.
const MAX_LEAF: u32 = 3;

impl<'s> ObvhsCwbvh<'s> {
    /// Builds the tree.
    pub fn build(primitives: impl Into<Subset<'s>>) -> Self {
        let all = primitives.into();
        let (scene, frame) = (all.scene(), Frame::of(all.bounds()));
        let boxes = library_boxes(&all, &frame, MARGIN);
        if boxes.is_empty() {
            return Self { scene, frame, nodes: Vec::new(), primitives: Vec::new() };
        }
        if has_many_equal(&boxes) {
            return Self::collapsed(&BinaryTree::of_single_primitives(&all));
        }
        let tree = build_cwbvh(&boxes, BvhBuildParams::medium_build(), &mut Default::default());
        Self { scene, frame, nodes: tree.nodes, primitives: ids(&all, tree.primitive_indices) }
    }

    /// The library's wide tree of a binary one.
    fn collapsed(tree: &BinaryTree<'s>) -> Self {
        let node = |node: &TreeNode| {
            let FrameBox { min, max } = node.bounds.grown(MARGIN);
            Bvh2Node::new(Aabb::new(min, max), node.count, node.first)
        };
        let binary = Bvh2 {
            nodes: tree.nodes.iter().map(node).collect(),
            primitive_indices: (0..tree.primitives.len() as u32).collect(),
            ..Bvh2::default()
        };
        let wide = bvh2_to_cwbvh(&binary, MAX_LEAF, true, false);
        let primitive = |&place: &u32| tree.primitives[place as usize];
        Self {
            scene: tree.scene,
            frame: tree.frame,
            nodes: wide.nodes,
            primitives: wide.primitive_indices.iter().map(primitive).collect(),
        }
    }

    /// Bytes held by the index, without the scene it borrows.
    pub fn memory(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.primitives.as_slice())
    }

    /// Checks that every one of these primitives is in one leaf and in all boxes above it, as they are
    /// unpacked.
    pub fn validate<'p>(&self, primitives: impl Into<Subset<'p>>) -> Result<(), String> {
        let mut coverage = Coverage::new(primitives.into(), self.nodes.len());
        let root = (0, FrameBox::EVERYTHING);
        let mut pending = if self.nodes.is_empty() { Vec::new() } else { vec![root] };
        while let Some((index, around)) = pending.pop() {
            coverage.node()?;
            let node = self.nodes.get(index).ok_or_else(|| format!("there is no node {index}"))?;
            for (half, boxes) in [0, 4].into_iter().zip(unpack(node)) {
                for lane in 0..4 {
                    let bounds = around.intersection(boxes.get(lane));
                    if node.is_leaf(half + lane) {
                        coverage.leaf(&self.frame, bounds, self.leaf(node, half + lane))?;
                    } else {
                        pending.push((node.child_node_index(half + lane) as usize, bounds));
                    }
                }
            }
        }
        coverage.all()
    }

    /// The primitives of a leaf; none in an empty slot.
    #[inline(always)]
    fn leaf(&self, node: &CwBvhNode, slot: usize) -> &[PrimitiveId] {
        let (first, count) = node.child_primitives(slot);
        &self.primitives[first as usize..(first + count) as usize]
    }
}

/// The boxes of a node's children: corner + step · 2^exponent.
#[inline(always)]
fn unpack(node: &CwBvhNode) -> [FourBoxes; 2] {
    let width = node.compute_extent();
    let steps = [
        [node.child_min_x, node.child_max_x],
        [node.child_min_y, node.child_max_y],
        [node.child_min_z, node.child_max_z],
    ];
    [0, 4].map(|half| {
        let mut planes = [[Vec4::ZERO; 2]; 3];
        for axis in 0..3 {
            planes[axis] = steps[axis].map(|steps| {
                let steps: [f32; 4] = std::array::from_fn(|lane| f32::from(steps[half + lane]));
                Vec4::from(steps) * width[axis] + node.p[axis]
            });
        }
        FourBoxes::between(planes)
    })
}

impl Traversal for ObvhsCwbvh<'_> {
    /// Visits the primitives whose boxes the ray meets, the leaves of a node before its other
    /// children and the nearest of those next, until any hit will do.
    #[inline]
    fn walk<O: Observer>(&self, query: Query<&Ray>, observer: &mut O) -> Option<Hit> {
        let mut probe = Probe::new(self.scene, query.ray, query.range);
        let slabs = FourSlabs::new(query.ray, &self.frame);
        let mut max = slabs.parameter(query.range.max);
        let mut pending = Pending::default();
        let mut next = self.nodes.first();
        while let Some(node) = next {
            let boxes = unpack(node);
            for slot in 0..8 {
                observer.region(&|| self.frame.in_scene(boxes[slot / 4].get(slot % 4)));
                observer.box_test();
            }
            let [low, high] = boxes.map(|boxes| slabs.enter(&boxes, max));
            let mut near = [0.0; 8];
            near[..4].copy_from_slice(&low.0.to_array());
            near[4..].copy_from_slice(&high.0.to_array());
            let met = low.1 | high.1 << 4;
            let inner = u32::from(node.imask);
            for slot in Lanes::<8>(met & !inner) {
                if near[slot] > max {
                    continue;
                }
                for &primitive in self.leaf(node, slot) {
                    observer.primitive_test(primitive);
                    if probe.test(primitive) && query.wanted == Wanted::Any {
                        return probe.best();
                    }
                }
                max = slabs.parameter(probe.range().max);
            }
            let entered = Lanes::<8>(met & inner)
                .map(|slot| Entered::new(near[slot], node.child_node_index(slot)));
            next = pending.next(entered, max).map(|index| &self.nodes[index]);
        }
        probe.best()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hard_sets::hard_sets;

    /// Few triangles: on sets whose boxes all overlap the library's reinsertion takes quadratic time.
    #[test]
    fn unpacked_boxes_contain_their_primitives() {
        for (name, scene) in hard_sets(1000) {
            assert_eq!(ObvhsCwbvh::build(&scene).validate(&scene), Ok(()), "{name}");
        }
    }

    /// The library's tree of equal boxes is a chain, as deep as a seventh of the triangles.
    #[test]
    fn trees_of_equal_boxes_are_balanced() {
        fn depth(tree: &ObvhsCwbvh<'_>, node: &CwBvhNode) -> usize {
            let inner = Lanes::<8>(u32::from(node.imask));
            let child = |slot| &tree.nodes[node.child_node_index(slot) as usize];
            1 + inner.map(|slot| depth(tree, child(slot))).max().unwrap_or(0)
        }
        for (name, scene) in hard_sets(20_000) {
            if ["points", "identical"].contains(&name) {
                let tree = ObvhsCwbvh::build(&scene);
                let depth = depth(&tree, &tree.nodes[0]);
                assert!(depth < 20, "{name}: {depth}");
                assert_eq!(tree.validate(&scene), Ok(()), "{name}");
            }
        }
    }
}
