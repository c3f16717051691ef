use glam::Vec3A;
use lancer_core::geometry::Ray;
use lancer_core::intersector::{Hit, Observer, Query, Traversal};
use lancer_core::scene::{PrimitiveId, Subset};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;

use crate::binary_tree::{BinaryTree, TreeNode, TreeStatistics};
use crate::bvh::Split;
use crate::four_boxes::{Frame, FrameBox};
use crate::four_wide::FourWide;

/// The binary bounding volume hierarchy that the obvhs library builds.
///
/// *Built* by the library in `f32`, from the leaves up (PLOC), and improved by reinsertion; but where many
/// boxes are equal as [`crate::Bvh`], since the library would pair them one at a time.
///
/// *Walked* as [`crate::Bvh`], two levels at a time. The library's own walk and triangle test are made for
/// speed and lose rays aimed at edges and vertices: only its tree is taken over.
///
/// *Wins* over a tree of medians. *Loses* to [`crate::Bvh`], whose trees spare more tests (plate 4.3).
///
/// *Sources:* Meister and Bittner, *Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy
/// Construction*, IEEE TVCG 24(3), 2018; Meister and Bittner, *Parallel Reinsertion for Bounding Volume
/// Hierarchy Optimization*, Computer Graphics Forum 37(2), 2018.
pub struct ObvhsBvh2<'s>(FourWide<'s>);

/// Leaves of at most three primitives: a primitive's `f64` test costs as much as a node's.
const BUILD: BvhBuildParams = BvhBuildParams {
    max_prims_per_leaf: 3,
    collapse_traversal_cost: 1.0,
    ..BvhBuildParams::medium_build()
};

impl<'s> ObvhsBvh2<'s> {
    /// Builds the tree.
    pub fn build(primitives: impl Into<Subset<'s>>) -> Self {
        let all = primitives.into();
        let frame = Frame::of(all.bounds());
        let boxes = library_boxes(&all, &frame, 0.0);
        if has_many_equal(&boxes) {
            return Self(FourWide::of(BinaryTree::build(all, Split::Sah)));
        }
        let tree = if boxes.is_empty() {
            Bvh2::default()
        } else {
            build_bvh2(&boxes, BUILD, &mut Default::default())
        };
        drop(boxes);
        Self(FourWide::of(BinaryTree {
            scene: all.scene(),
            frame,
            nodes: tree.nodes.iter().map(taken_over).collect(),
            primitives: ids(&all, tree.primitive_indices),
        }))
    }

    /// Bytes held by the index, without the scene it borrows.
    pub fn memory(&self) -> usize {
        self.0.memory()
    }

    /// Cost, depth and leaves of the library's tree.
    pub fn statistics(&self) -> &TreeStatistics {
        self.0.statistics()
    }

    /// Checks that every box contains what is below it, and that every one of these primitives is in one
    /// leaf.
    pub fn validate<'p>(&self, primitives: impl Into<Subset<'p>>) -> Result<(), String> {
        self.0.validate(primitives.into())
    }
}

/// The primitives' boxes as the library wants them, grown by a margin.
pub(crate) fn library_boxes(all: &Subset, frame: &Frame, margin: f32) -> Vec<Aabb> {
    let library_box = |primitive| {
        let bounds = frame.outwards(all.scene().primitive_bounds(primitive)).grown(margin);
        Aabb::new(bounds.min, bounds.max)
    };
    all.iter().map(library_box).collect()
}

/// The most equal boxes that the library may be given.
const MOST_EQUAL: usize = 256;

/// Whether the library would take quadratic time. It merges neighbours that are each other's nearest; of
/// equal boxes all are as near, only the last two agree, and it takes as many rounds as there are boxes.
pub(crate) fn has_many_equal(boxes: &[Aabb]) -> bool {
    let corner = |corner: Vec3A| corner.to_array().map(f32::to_bits);
    let mut sorted: Vec<_> = boxes.iter().map(|b| [corner(b.min), corner(b.max)]).collect();
    sorted.sort_unstable();
    sorted.windows(MOST_EQUAL + 1).any(|run| run[0] == run[MOST_EQUAL])
}

/// What the library numbers by the places of [`library_boxes`].
pub(crate) fn ids(all: &Subset, places: Vec<u32>) -> Vec<PrimitiveId> {
    places.into_iter().map(|place| all.get(place as usize)).collect()
}

fn taken_over(node: &Bvh2Node) -> TreeNode {
    TreeNode {
        bounds: FrameBox { min: Vec3A::from(node.min), max: Vec3A::from(node.max) },
        first: node.first_index,
        count: node.prim_count,
    }
}

impl Traversal for ObvhsBvh2<'_> {
    /// Visits the primitives whose boxes the ray meets, the leaves of a node before its other
    /// children and the nearest of those next, until any hit will do.
    #[inline]
    fn walk<O: Observer>(&self, query: Query<&Ray>, observer: &mut O) -> Option<Hit> {
        self.0.walk(query, observer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hard_sets::hard_sets;

    /// The library's tree of equal boxes is a chain, as deep as there are triangles.
    #[test]
    fn trees_of_equal_boxes_are_balanced() {
        for (name, scene) in hard_sets(20_000) {
            if ["points", "identical"].contains(&name) {
                let tree = ObvhsBvh2::build(&scene);
                assert!(tree.statistics().depth < 20, "{name}: {}", tree.statistics().depth);
                assert_eq!(tree.validate(&scene), Ok(()), "{name}");
            }
        }
    }

    #[test]
    fn equal_boxes_are_counted() {
        let cube = |at: usize| Aabb::new(Vec3A::splat(at as f32), Vec3A::splat(at as f32 + 1.0));
        let boxes = |equal: usize| -> Vec<Aabb> {
            (0..2000).map(|k| cube(if k % 3 == 0 && k / 3 < equal { 7 } else { 10 + k })).collect()
        };
        assert!(!has_many_equal(&boxes(MOST_EQUAL)));
        assert!(has_many_equal(&boxes(MOST_EQUAL + 1)));
        assert!(!has_many_equal(&[]));
    }
}
