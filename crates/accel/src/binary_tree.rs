use std::ops::Range;

use glam::DVec3;
use lancer_core::geometry::Ray;
use lancer_core::intersector::{Hit, Observer, Probe, Query, Traversal, Wanted};
use lancer_core::scene::{PrimitiveId, Scene, Shape, Subset};
use smallvec::SmallVec;

use crate::four_boxes::{FourSlabs, Frame, FrameBox};

/// A binary hierarchy of bounding volumes, walked by recursion: the algorithm as it is taught.
///
/// *Built* by a [`crate::Split`], as [`crate::Bvh`].
///
/// *Walked* from the root: a ray that misses a node's box misses everything below. It takes the nearer
/// of two children that it meets first, since a hit there often ends before the other begins.
///
/// *Wins* for reading, for looking at trees, and for checking the faster walk. *Loses* to [`crate::Bvh`], which
/// walks the same tree without recursion and two levels at a time.
///
/// *Sources:* Kay and Kajiya, *Ray Tracing Complex Scenes*, SIGGRAPH 1986.
#[doc(alias = "hiérarchie de volumes englobants")]
pub struct BinaryTree<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) frame: Frame,
    /// The first is the root; there is none in an empty scene.
    pub(crate) nodes: Vec<TreeNode>,
    /// The primitives of the leaves, leaf by leaf.
    pub(crate) primitives: Vec<PrimitiveId>,
}

/// A node with a box around everything below it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TreeNode {
    pub(crate) bounds: FrameBox,
    /// The first primitive of a leaf, or the first child; the second child follows it.
    pub(crate) first: u32,
    /// The number of a leaf's primitives; 0 in an inner node.
    pub(crate) count: u32,
}

impl TreeNode {
    pub(crate) fn is_leaf(&self) -> bool {
        self.count > 0
    }

    /// A leaf's primitives.
    pub(crate) fn leaf(&self) -> Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }

    /// An inner node's children.
    pub(crate) fn children(&self) -> [usize; 2] {
        [self.first as usize, self.first as usize + 1]
    }
}

/// The shape of a tree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeStatistics {
    /// The surface area heuristic: how many node visits and primitive tests, counted alike, a random
    /// line costs that meets the scene's box, if nothing stops it.
    /// C = Σ_inner A(n)/A(root) + Σ_leaves A(n)/A(root) · primitives(n)
    ///
    /// Source: Goldsmith and Salmon, *Automatic Creation of Object Hierarchies for Ray Tracing*, IEEE
    /// CG&A 7(5), 1987; MacDonald and Booth, *Heuristics for Ray Tracing Using Space Subdivision*, 1990.
    #[doc(alias = "SAH")]
    pub sah_cost: f64,
    /// Nodes, inner ones and leaves.
    pub nodes: usize,
    /// Steps from the root to the deepest leaf.
    pub depth: usize,
    /// How many leaves have 0, 1, 2, … primitives.
    pub leaves: Vec<usize>,
}

impl BinaryTree<'_> {
    /// Its cost, depth and leaves.
    pub fn statistics(&self) -> TreeStatistics {
        let mut statistics = TreeStatistics { nodes: self.nodes.len(), ..Default::default() };
        let Some(root) = self.nodes.first() else { return statistics };
        let mut area = 0.0;
        let mut pending = vec![(root, 0)];
        while let Some((node, depth)) = pending.pop() {
            let half_area = f64::from(node.bounds.half_area());
            if node.is_leaf() {
                let count = node.count as usize;
                if statistics.leaves.len() <= count {
                    statistics.leaves.resize(count + 1, 0);
                }
                statistics.leaves[count] += 1;
                statistics.depth = statistics.depth.max(depth);
                area += half_area * count as f64;
            } else {
                area += half_area;
                pending.extend(node.children().map(|child| (&self.nodes[child], depth + 1)));
            }
        }
        statistics.sah_cost = area / f64::from(root.bounds.half_area());
        statistics
    }

    /// Bytes held by the tree, without the scene it borrows.
    pub fn memory(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.primitives.as_slice())
    }

    /// Checks that every box contains what is below it, and that every node and every one of these
    /// primitives is below the root once.
    pub fn validate<'p>(&self, primitives: impl Into<Subset<'p>>) -> Result<(), String> {
        let mut coverage = Coverage::new(primitives.into(), self.nodes.len());
        let mut pending: Vec<usize> = if self.nodes.is_empty() { Vec::new() } else { vec![0] };
        while let Some(index) = pending.pop() {
            coverage.node()?;
            let node = &self.nodes[index];
            if node.is_leaf() {
                coverage.leaf(&self.frame, node.bounds, &self.primitives[node.leaf()])?;
                continue;
            }
            for child in node.children() {
                if !node.bounds.contains(self.nodes[child].bounds) {
                    return Err(format!("node {child} sticks out of node {index}"));
                }
                pending.push(child);
            }
        }
        coverage.all()
    }
}

/// A ray on its way down the tree.
struct Descent<'a, O> {
    tree: &'a BinaryTree<'a>,
    slabs: FourSlabs,
    /// Where the closest hit so far is, in the units of the boxes.
    max: f32,
    probe: Probe<'a>,
    wanted: Wanted,
    observer: &'a mut O,
}

impl<O: Observer> Descent<'_, O> {
    /// Where the ray enters the node's box, if it does so before the closest hit.
    fn enter(&mut self, node: &TreeNode) -> Option<f32> {
        self.observer.region(&|| self.tree.frame.in_scene(node.bounds));
        self.observer.box_test();
        self.slabs.enter_one(node.bounds, self.max)
    }

    /// Visits a node whose box the ray meets. Returns whether the walk is over.
    fn visit(&mut self, node: &TreeNode) -> bool {
        let tree = self.tree;
        if node.is_leaf() {
            for &primitive in &tree.primitives[node.leaf()] {
                self.observer.primitive_test(primitive);
                if self.probe.test(primitive) && self.wanted == Wanted::Any {
                    return true;
                }
            }
            self.max = self.slabs.parameter(self.probe.range().max);
            return false;
        }
        let children = node.children().map(|child| &tree.nodes[child]);
        let mut order = children.map(|child| (self.enter(child), child));
        if order[1].0 < order[0].0 {
            order.reverse();
        }
        // The second box is met no more if a hit in the first one lies before it.
        order
            .into_iter()
            .any(|(near, child)| near.is_some_and(|near| near <= self.max) && self.visit(child))
    }
}

impl Traversal for BinaryTree<'_> {
    /// Visits the primitives whose boxes the ray meets, the nearer child first, until any hit will do.
    fn walk<O: Observer>(&self, query: Query<&Ray>, observer: &mut O) -> Option<Hit> {
        let root = self.nodes.first()?;
        let slabs = FourSlabs::new(query.ray, &self.frame);
        let mut descent = Descent {
            tree: self,
            slabs,
            max: slabs.parameter(query.range.max),
            probe: Probe::new(self.scene, query.ray, query.range),
            wanted: query.wanted,
            observer,
        };
        if descent.enter(root).is_some() {
            descent.visit(root);
        }
        descent.probe.best()
    }
}

/// What a validation has found below the root.
pub(crate) struct Coverage<'s> {
    all: Subset<'s>,
    /// The boxes of the leaves in which each of them was found, in their order.
    seen: Vec<SmallVec<[FrameBox; 1]>>,
    nodes: usize,
    reached: usize,
}

impl<'s> Coverage<'s> {
    pub(crate) fn new(all: Subset<'s>, nodes: usize) -> Self {
        Self { seen: vec![SmallVec::new(); all.len()], all, nodes, reached: 0 }
    }

    /// A tree reaches each of its nodes once.
    pub(crate) fn node(&mut self) -> Result<(), String> {
        self.reached += 1;
        if self.reached > self.nodes { Err("a node is below itself".into()) } else { Ok(()) }
    }

    /// A leaf must contain its primitives, and no other leaf may have them.
    pub(crate) fn leaf(
        &mut self,
        frame: &Frame,
        bounds: FrameBox,
        primitives: &[PrimitiveId],
    ) -> Result<(), String> {
        for &primitive in primitives {
            let seen = self.seen(primitive)?;
            if !seen.is_empty() {
                return Err(format!("{primitive:?} is in two leaves"));
            }
            seen.push(bounds);
            if !bounds.contains(frame.outwards(self.all.scene().primitive_bounds(primitive))) {
                return Err(format!("{primitive:?} sticks out of its leaf"));
            }
        }
        Ok(())
    }

    /// A leaf may have parts of its primitives, each of them once.
    pub(crate) fn parts(
        &mut self,
        bounds: FrameBox,
        primitives: &[PrimitiveId],
    ) -> Result<(), String> {
        for (k, &primitive) in primitives.iter().enumerate() {
            if primitives[..k].contains(&primitive) {
                return Err(format!("{primitive:?} is twice in a leaf"));
            }
            self.seen(primitive)?.push(bounds);
        }
        Ok(())
    }

    fn seen(&mut self, primitive: PrimitiveId) -> Result<&mut SmallVec<[FrameBox; 1]>, String> {
        let place = self.all.place(primitive);
        let place = place.ok_or_else(|| format!("{primitive:?} is not among the primitives"))?;
        Ok(&mut self.seen[place])
    }

    /// No node and no primitive may be missing, the leaves' boxes must cover each primitive, and there may be no more
    /// than so many parts.
    pub(crate) fn all_parts(self, frame: &Frame, most: usize) -> Result<(), String> {
        let parts: usize = self.seen.iter().map(SmallVec::len).sum();
        if parts > most {
            return Err(format!("{parts} parts of {} primitives", self.all.len()));
        }
        for (primitive, boxes) in self.all.iter().zip(&self.seen) {
            let is_covered = |at: FrameBox| boxes.iter().any(|bounds| bounds.contains(at));
            let whole = frame.outwards(self.all.scene().primitive_bounds(primitive));
            let is_whole = is_covered(whole);
            if !boxes.is_empty() && !is_whole && !self.samples(frame, primitive).all(is_covered) {
                return Err(format!("{primitive:?} sticks out of its leaves"));
            }
        }
        self.all()
    }

    /// Points of a triangle's surface, with half of the margin of boxes around them. Of a sphere, which is not split,
    /// its box.
    fn samples(&self, frame: &Frame, primitive: PrimitiveId) -> impl Iterator<Item = FrameBox> {
        const STEPS: u32 = 24;
        let scene = self.all.scene();
        let corners = match scene.shape(primitive) {
            Shape::Triangle(index) => Some(scene.mesh.corners(index).map(|p| frame.point(p))),
            Shape::Sphere(_) => None,
        };
        let weights = (0..=STEPS).flat_map(|i| (0..=STEPS - i).map(move |k| (i, k)));
        let points = corners.into_iter().flat_map(move |[a, b, c]| {
            let part = |k: u32| f64::from(k) / f64::from(STEPS);
            weights.clone().map(move |(i, k)| a + (b - a) * part(i) + (c - a) * part(k))
        });
        let half = 0.5 * f64::from(f32::EPSILON);
        let around =
            move |p: DVec3| FrameBox { min: (p - half).as_vec3a(), max: (p + half).as_vec3a() };
        let sphere = corners.is_none().then(|| frame.outwards(scene.primitive_bounds(primitive)));
        points.map(around).chain(sphere)
    }

    /// No node and no primitive may be missing.
    pub(crate) fn all(self) -> Result<(), String> {
        if self.reached < self.nodes {
            return Err(format!("{} of {} nodes are reached", self.reached, self.nodes));
        }
        match self.seen.iter().position(SmallVec::is_empty) {
            Some(missing) => Err(format!("{:?} is in no leaf", self.all.get(missing))),
            None => Ok(()),
        }
    }
}
