//! « Hiérarchie de volumes englobants »: the binary tree of our own.

mod cuts;
mod grow;
mod item;
mod spatial;

pub(crate) use grow::MAX_DEPTH;

use glam::Vec3A;
use lancer_core::geometry::{ConvexVolume, Ray};
use lancer_core::intersector::{BeamIndex, BeamTraversal, Hit, Observer, Query, Traversal};
use lancer_core::scene::{PrimitiveId, Scene, Subset};
use rayon::prelude::*;

use crate::binary_tree::{BinaryTree, TreeNode, TreeStatistics};
use crate::four_boxes::{Frame, FrameBox};
use crate::four_wide::FourWide;
use grow::{MAX_LEAF, Rule};
use item::Item;
use spatial::Splitter;

/// How a node's primitives are divided between its two children.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Split {
    /// Two halves of as many primitives, along the longest axis of the box around their centres: the
    /// shallowest tree, built without looking at what its boxes cost.
    Median,
    /// Where the surface area heuristic expects the least work: a random line that meets the node
    /// meets a child with the probability of the ratio of their surfaces, so
    /// C = 1 + (A(left) · n(left) + A(right) · n(right)) / A(node)
    /// is what the node costs after the split, and n(node) without. The centres are thrown into bins
    /// along each axis, and only the planes between bins are compared; and cuts between the large and
    /// the small. Of a few primitives all cuts are compared. Source, but for those: Wald, *On fast
    /// Construction of SAH-based Bounding Volume Hierarchies*, RT 2007.
    #[default]
    Sah,
}

/// A binary hierarchy of bounding volumes, built from the root down.
///
/// *Built* in O(n log n): a node's primitives are divided by a [`Split`], the parts become its
/// children, until few are left.
///
/// *Walked* near to far in about O(log n) per ray, two levels of the tree at a time: four boxes are tested
/// together in `f32`, rounded outwards; primitives are decided in `f64`. [`BinaryTree`] has the same walk as it
/// is taught.
///
/// *Wins* where primitives are of all sizes: it adapts to them, needs O(n) memory whatever the scene looks like,
/// and has every primitive once. *Loses* where boxes fit badly, such as those of long diagonal triangles: where
/// boxes overlap a ray visits them all, while the cells of a subdivision never overlap.
///
/// *Sources:* Rubin and Whitted, *A 3-Dimensional Representation for Fast Rendering of Complex Scenes*,
/// SIGGRAPH 1980; Kay and Kajiya, *Ray Tracing Complex Scenes*, SIGGRAPH 1986.
#[doc(alias = "hiérarchie de volumes englobants")]
pub struct Bvh<'s>(FourWide<'s>);

impl<'s> Bvh<'s> {
    /// Builds the tree by the surface area heuristic.
    pub fn build(primitives: impl Into<Subset<'s>>) -> Self {
        Self::with_split(primitives, Split::default())
    }

    /// Builds the tree by a split rule of choice.
    pub fn with_split(primitives: impl Into<Subset<'s>>, split: Split) -> Self {
        Self(FourWide::of(BinaryTree::build(primitives, split)))
    }

    /// Bytes held by the index, without the scene it borrows.
    pub fn memory(&self) -> usize {
        self.0.memory()
    }

    /// Cost, depth and leaves of the binary tree.
    pub fn statistics(&self) -> &TreeStatistics {
        self.0.statistics()
    }

    /// Checks that every box contains what is below it, that every one of these primitives is in one
    /// leaf, and that the tree is not too deep.
    pub fn validate<'p>(&self, primitives: impl Into<Subset<'p>>) -> Result<(), String> {
        grow::check_depth(self.statistics())?;
        self.0.validate(primitives.into())
    }
}

impl Traversal for Bvh<'_> {
    /// Visits the primitives whose boxes the ray meets, the leaves of a node before its other
    /// children and the nearest of those next, until any hit will do.
    #[inline]
    fn walk<O: Observer>(&self, query: Query<&Ray>, observer: &mut O) -> Option<Hit> {
        self.0.walk(query, observer)
    }

    fn beams(&self) -> Option<&dyn BeamIndex> {
        Some(self)
    }
}

impl BeamTraversal for Bvh<'_> {
    /// Opens the nearest node that the beam may meet, until the nearest of all is a primitive: each comes
    /// once, in order of depth and id, as by brute force.
    fn walk_beam<O: Observer>(
        &self,
        volume: &ConvexVolume,
        far: f64,
        observer: &mut O,
        visit: impl FnMut(PrimitiveId) -> f64,
    ) {
        self.0.walk_beam(volume, far, observer, visit);
    }
}

impl<'s> BinaryTree<'s> {
    /// Builds the tree. It is the same for any number of threads.
    pub fn build(primitives: impl Into<Subset<'s>>, split: Split) -> Self {
        let rule = Rule { split, max_leaf: MAX_LEAF, whole_leaf: 1, by_size: 1.0, splitter: None };
        Items::of(&primitives.into()).tree(&rule)
    }

    /// The tree by the surface area heuristic down to single primitives.
    pub(crate) fn of_single_primitives(primitives: &Subset<'s>) -> Self {
        let split = Split::Sah;
        let rule = Rule { split, max_leaf: 1, whole_leaf: 1, by_size: 1.0, splitter: None };
        Items::of(primitives).tree(&rule)
    }

    /// Moves the nodes together.
    fn close_gaps(&mut self) {
        let mut nodes = Vec::with_capacity(self.nodes.len());
        nodes.extend(self.nodes.first());
        let mut pending = Vec::from_iter((!nodes.is_empty()).then_some(0));
        while let Some(index) = pending.pop() {
            let node: TreeNode = nodes[index];
            if node.is_leaf() {
                continue;
            }
            let children = node.children().map(|child| self.nodes[child]);
            let first = nodes.len();
            nodes[index].first = first as u32;
            nodes.extend(children);
            pending.extend([first + 1, first]);
        }
        self.nodes = nodes;
    }
}

/// Trees to be collapsed, with leaves of one or two primitives.
const WHOLE_LEAF: usize = 2;
/// How many parts there may be more than primitives, in percent.
const MORE_PARTS: usize = 30;
/// Where primitives may be split a cut by size must be better by this: what it parts cannot be split at one plane any
/// more.
const SPLIT_BY_SIZE: f32 = 0.5;

/// The primitives that trees are built over.
pub(crate) struct Items<'s> {
    scene: &'s Scene,
    frame: Frame,
    /// As many as there are primitives, and free places.
    room: Vec<Item>,
    count: usize,
    bounds: FrameBox,
}

impl<'s> Items<'s> {
    pub(crate) fn of(primitives: &Subset<'s>) -> Self {
        let (scene, count) = (primitives.scene(), primitives.len());
        let frame = Frame::of(primitives.bounds());
        let item = |place| {
            let primitive = primitives.get(place);
            Item::new(frame.outwards(scene.primitive_bounds(primitive)), primitive)
        };
        let room: Vec<Item> = (0..count).into_par_iter().map(item).collect();
        let bounds = room.iter().fold(FrameBox::EMPTY, |all, item| all.union(item.bounds()));
        Self { scene, frame, room, count, bounds }
    }

    /// The tree by the surface area heuristic, to be collapsed, with gaps between nodes; and whether splitting
    /// primitives may make a better one, because many of its boxes overlap.
    pub(crate) fn whole(&mut self) -> (BinaryTree<'s>, bool) {
        let rule = self.rule(1.0);
        let tree = self.grow(&rule);
        let crowded = rule.splitter.map_or(0, Splitter::crowded);
        (tree, crowded > self.count)
    }

    /// The same with primitives that are split where their boxes overlap, so that some are in several leaves, each
    /// with a part of their boxes. There are gaps between primitives as well.
    pub(crate) fn split(mut self) -> BinaryTree<'s> {
        if let Some(&first) = self.room.first() {
            self.room.resize(Self::most_parts(self.count), first);
        }
        let rule = self.rule(SPLIT_BY_SIZE);
        self.grow(&rule)
    }

    /// How many parts so many primitives are split into at most.
    pub(crate) fn most_parts(primitives: usize) -> usize {
        primitives + primitives * MORE_PARTS / 100
    }

    fn rule(&self, by_size: f32) -> Rule<'s> {
        let splitter = Some(Splitter::new(self.scene, self.frame, self.bounds));
        Rule { split: Split::Sah, max_leaf: WHOLE_LEAF, whole_leaf: WHOLE_LEAF, by_size, splitter }
    }

    fn grow(&mut self, rule: &Rule) -> BinaryTree<'s> {
        let nodes = grow::tree(&mut self.room, self.count, self.bounds, rule);
        let primitives = self.room.iter().map(Item::primitive).collect();
        BinaryTree { scene: self.scene, frame: self.frame, nodes, primitives }
    }

    fn tree(mut self, rule: &Rule) -> BinaryTree<'s> {
        let mut tree = self.grow(rule);
        tree.close_gaps();
        tree
    }
}

/// The object median: sorts the lower half, by the longest axis of the box around the centres, to the
/// front, and returns how many that are, of an odd number the smaller part. Where centres coincide the
/// smaller id is lower.
#[inline]
pub fn split_at_median<T>(items: &mut [T], key: impl Fn(&T) -> (Vec3A, PrimitiveId)) -> usize {
    let middle = items.len() / 2;
    let around = |(min, max): (Vec3A, Vec3A), item| {
        let (center, _) = key(item);
        (min.min(center), max.max(center))
    };
    let (min, max) = items.iter().fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), around);
    let axis = (max - min).max_position();
    items.select_nth_unstable_by(middle, |a, b| {
        let ((a, a_id), (b, b_id)) = (key(a), key(b));
        a[axis].total_cmp(&b[axis]).then(a_id.cmp(&b_id))
    });
    middle
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3};
    use lancer_core::generate::icosphere;
    use lancer_core::geometry::Interval;
    use lancer_core::intersector::TestCounts;
    use lancer_core::scene::Scene;

    use super::*;
    use crate::hard_sets::{hard_sets, triangles};

    const SPLITS: [Split; 2] = [Split::Median, Split::Sah];

    #[test]
    fn hard_sets_are_built() {
        for (name, scene) in &hard_sets(100_000) {
            for split in SPLITS {
                let valid = BinaryTree::build(scene, split).validate(scene);
                assert_eq!(valid, Ok(()), "{name}, {split:?}");
                assert_eq!(
                    Bvh::with_split(scene, split).validate(scene),
                    Ok(()),
                    "{name}, {split:?}"
                );
            }
        }
    }

    #[test]
    fn a_validation_finds_what_is_wrong() {
        let scene = Scene::of_mesh(icosphere(2));
        let broken = |harm: &dyn Fn(&mut BinaryTree)| {
            let mut tree = BinaryTree::build(&scene, Split::Sah);
            harm(&mut tree);
            [
                tree.validate(&scene).unwrap_err(),
                FourWide::of(tree).validate((&scene).into()).unwrap_err(),
            ]
        };
        let pair = |tree: &BinaryTree| tree.nodes.iter().position(|node| node.count > 1).unwrap();
        let small = broken(&|tree| {
            let pair = pair(tree);
            tree.nodes[pair].bounds = FrameBox::EMPTY;
        });
        assert!(
            small.iter().all(|problem| problem.contains("sticks out of its leaf")),
            "{small:?}"
        );
        let missing = broken(&|tree| {
            let pair = pair(tree);
            tree.nodes[pair].count -= 1;
        });
        assert!(missing.iter().all(|problem| problem.ends_with("is in no leaf")), "{missing:?}");
        let twice = broken(&|tree| {
            let first = tree.nodes[pair(tree)].first as usize;
            tree.primitives[first] = tree.primitives[first + 1];
        });
        assert!(twice.iter().all(|problem| problem.ends_with("is in two leaves")), "{twice:?}");
    }

    #[test]
    fn the_tree_is_the_same_for_any_number_of_threads() {
        let scene = Scene::of_mesh(icosphere(5));
        for split in SPLITS {
            let built = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let tree = pool.install(|| BinaryTree::build(&scene, split));
                let nodes = tree.nodes.iter().map(|node| (node.bounds, node.first, node.count));
                (nodes.collect::<Vec<_>>(), tree.primitives)
            };
            let one = built(1);
            assert!([2, 7].map(built).into_iter().all(|other| other == one));
        }
    }

    /// Long diagonal triangles among small ones are split, no more often than they may be, and alike by any number of
    /// threads.
    #[test]
    fn needles_are_split_the_same_way_by_any_number_of_threads() {
        let place = |k: u32| (DVec3::new(0.8192, 0.6711, 0.5497) * f64::from(k)).fract();
        let corners = |k: u32| {
            // A needle across the cube, or a crumb.
            let end =
                if k.is_multiple_of(200) { place(7 * k + 3) } else { place(k) + 0.002 * DVec3::Y };
            [place(k), end, end + 0.002 * DVec3::X]
        };
        let scene = triangles((0..20_000).map(corners));
        let built = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let tree = pool.install(|| Items::of(&(&scene).into()).split());
            let mut parts = Vec::new();
            let mut pending = vec![0];
            while let Some(index) = pending.pop() {
                let node = tree.nodes[index];
                if node.is_leaf() {
                    let primitives = tree.primitives[node.leaf()].iter();
                    parts.extend(primitives.map(|&primitive| (node.bounds, primitive)));
                } else {
                    pending.extend(node.children());
                }
            }
            parts
        };
        let one = built(1);
        assert!((20_500..=Items::most_parts(20_000)).contains(&one.len()), "{}", one.len());
        assert!([2, 7].map(built).into_iter().all(|other| other == one));
    }

    /// Two triangles far apart: a leaf's box has the sides (1, 1, 0) and the half area 1, the root's
    /// (11, 1, 0) and 11: C = (11 + 1 + 1) / 11. The frame changes nothing but the scale.
    #[test]
    fn the_cost_of_a_tree_by_hand() {
        let corner = |x: f64| [DVec3::X * x, DVec3::X * (x + 1.0), DVec3::new(x, 1.0, 0.0)];
        let scene = triangles([corner(0.0), corner(10.0)]);
        let statistics = BinaryTree::build(&scene, Split::Sah).statistics();
        assert!((statistics.sah_cost - 13.0 / 11.0).abs() < 1e-5, "{statistics:?}");
        let wanted = TreeStatistics { depth: 1, nodes: 3, leaves: vec![0, 2], ..statistics };
        assert_eq!(*Bvh::build(&scene).statistics(), wanted);
    }

    /// A teapot in a stadium: half of the primitives in a thousandth of the space. What the heuristic
    /// promises shows in the work of rays.
    #[test]
    fn the_heuristic_saves_work() {
        let mut mesh = icosphere(4);
        mesh.append(&icosphere(4), DAffine3::from_scale(DVec3::splat(1000.0)), 0);
        let scene = Scene::of_mesh(mesh);
        let [median, sah] = SPLITS.map(|split| {
            let index = Bvh::with_split(&scene, split);
            let mut counts = TestCounts::default();
            for k in 0..1000 {
                let turn = f64::from(k) * 2.4;
                let origin = 3.0 * DVec3::new(turn.cos(), turn.sin(), f64::from(k) / 1000.0);
                let ray = Ray::new(origin, 0.3 * DVec3::new(turn.sin(), 0.0, turn.cos()) - origin);
                assert!(
                    index.walk(Query::closest(&ray, Interval::POSITIVE), &mut counts).is_some()
                );
            }
            (index.statistics().sah_cost, counts.boxes + counts.primitives)
        });
        assert!(sah.0 < median.0 && sah.1 < median.1, "{sah:?} {median:?}");
    }
}
