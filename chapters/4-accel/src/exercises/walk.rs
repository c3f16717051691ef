use lancer_accel::split_at_median;
use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};
use lancer_core::intersector::{Hit, Probe, TestCounts};
use lancer_core::scene::{PrimitiveId, Scene};

/// A binary tree of boxes for trying walks: each leaf has one primitive. [`lancer_accel::BinaryTree`] keeps
/// its boxes to itself.
pub(super) struct Tree {
    /// The first is the root.
    nodes: Vec<Node>,
}

struct Node {
    bounds: Bounds3,
    content: Content,
}

enum Content {
    Inner([usize; 2]),
    Leaf(PrimitiveId),
}

impl Tree {
    /// The tree of a scene that is not empty.
    pub(super) fn new(scene: &Scene) -> Self {
        let mut tree = Self { nodes: Vec::new() };
        let mut primitives: Vec<PrimitiveId> = scene.primitives().collect();
        tree.grow(scene, &mut primitives);
        tree
    }

    fn grow(&mut self, scene: &Scene, primitives: &mut [PrimitiveId]) -> usize {
        let boxes = primitives.iter().map(|primitive| scene.primitive_bounds(*primitive));
        let bounds = boxes.fold(Bounds3::EMPTY, Bounds3::union);
        let index = self.nodes.len();
        self.nodes.push(Node { bounds, content: Content::Leaf(primitives[0]) });
        if primitives.len() > 1 {
            let middle = split_at_median(primitives, |&primitive| {
                (scene.primitive_bounds(primitive).center().as_vec3a(), primitive)
            });
            let (lower, upper) = primitives.split_at_mut(middle);
            // As stored the upper one comes first, so that an order by index is no order along x.
            let children = [self.grow(scene, upper), self.grow(scene, lower)];
            self.nodes[index].content = Content::Inner(children);
        }
        index
    }
}

/// A ray on its way through a binary tree of boxes. What is asked is counted.
pub struct Walk<'a> {
    tree: &'a Tree,
    slabs: Slabs,
    probe: Probe<'a>,
    counts: TestCounts,
}

impl<'a> Walk<'a> {
    pub(super) fn new(scene: &'a Scene, tree: &'a Tree, ray: &'a Ray) -> Self {
        let probe = Probe::new(scene, ray, Interval::POSITIVE);
        Self { tree, slabs: Slabs::new(ray), probe, counts: TestCounts::default() }
    }

    /// The closest hit, and the work, of a function that visits a node.
    pub(super) fn run(mut self, visit: fn(&mut Walk, usize)) -> (Option<Hit>, TestCounts) {
        if self.enter(0).is_some() {
            visit(&mut self, 0);
        }
        (self.probe.best(), self.counts)
    }

    /// An inner node's children; a leaf has none.
    pub fn children(&self, node: usize) -> Option<[usize; 2]> {
        match self.tree.nodes[node].content {
            Content::Inner(children) => Some(children),
            Content::Leaf(_) => None,
        }
    }

    /// Tests a node's box: the t at which the ray enters it, if it does so up to [`Walk::closest`].
    pub fn enter(&mut self, node: usize) -> Option<f64> {
        self.counts.boxes += 1;
        let Bounds3 { min, max } = self.tree.nodes[node].bounds;
        self.slabs.enter(min, max, self.probe.range())
    }

    /// The t of the closest hit so far; infinite before the first.
    pub fn closest(&self) -> f64 {
        self.probe.range().max
    }

    /// Tests a leaf's primitive and keeps the hit if it is the closest.
    pub fn test_leaf(&mut self, node: usize) {
        if let Content::Leaf(primitive) = self.tree.nodes[node].content {
            self.counts.primitives += 1;
            self.probe.test(primitive);
        }
    }
}
