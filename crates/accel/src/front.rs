//! What the indexes share when they look for what a beam meets.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use lancer_core::geometry::{Bounds3, ConvexVolume};
use lancer_core::intersector::Observer;
use lancer_core::scene::{PrimitiveId, Scene};

/// What a beam has still to look into, nearest first.
///
/// A ray's stack is near to far only among the children of a node. Here a heap holds nodes and primitives
/// by depth, a node before a primitive as deep: as a node begins no later than what is in it, primitives
/// come out in order. It is the best-first search of Hjaltason and Samet, *Distance Browsing in Spatial
/// Databases*, ACM TODS 24(2), 1999.
pub(crate) struct Front<'f, N, O> {
    scene: &'f Scene,
    volume: &'f ConvexVolume,
    far: f64,
    observer: &'f mut O,
    ahead: BinaryHeap<Ahead<N>>,
}

struct Ahead<N> {
    depth: f64,
    what: What<N>,
}

enum What<N> {
    Node(N),
    Primitive(PrimitiveId),
}

impl<'f, N, O: Observer> Front<'f, N, O> {
    pub(crate) fn new(
        scene: &'f Scene,
        volume: &'f ConvexVolume,
        far: f64,
        observer: &'f mut O,
    ) -> Self {
        Self { scene, volume, far, observer, ahead: BinaryHeap::new() }
    }

    /// Tests a node within `bounds`, and keeps it if the beam may meet it.
    pub(crate) fn node(&mut self, bounds: &Bounds3, node: N) {
        self.observer.box_test();
        if self.volume.may_meet(bounds) {
            self.keep(self.volume.depth(bounds), What::Node(node));
        }
    }

    /// Tests a primitive, and keeps it if the beam may meet it. It counts as no nearer than
    /// where it was found.
    pub(crate) fn primitive(&mut self, primitive: PrimitiveId, found: f64) {
        self.observer.primitive_test(primitive);
        if let Some(depth) = self.scene.depth_in(self.volume, primitive) {
            self.keep(depth.max(found), What::Primitive(primitive));
        }
    }

    /// A cell is looked into.
    pub(crate) fn cell(&mut self) {
        self.observer.cell_visit();
    }

    fn keep(&mut self, depth: f64, what: What<N>) {
        if depth <= self.far {
            self.ahead.push(Ahead { depth, what });
        }
    }

    /// Visits the primitives below a root. `open` looks into a node, which begins at the given depth.
    pub(crate) fn search(
        mut self,
        root: Option<N>,
        mut visit: impl FnMut(PrimitiveId) -> f64,
        mut open: impl FnMut(&mut Self, N, f64),
    ) {
        let root = root.map(|root| Ahead { depth: f64::NEG_INFINITY, what: What::Node(root) });
        self.ahead.extend(root);
        while let Some(Ahead { depth, what }) = self.ahead.pop() {
            if depth > self.far {
                break;
            }
            match what {
                What::Node(node) => open(&mut self, node, depth),
                What::Primitive(primitive) => self.far = self.far.min(visit(primitive)),
            }
        }
    }
}

/// The greatest is the nearest: a [`BinaryHeap`] gives out the greatest first.
impl<N> Ord for Ahead<N> {
    fn cmp(&self, other: &Self) -> Ordering {
        let rank = |what: &What<N>| match what {
            What::Node(_) => None,
            What::Primitive(primitive) => Some(*primitive),
        };
        other.depth.total_cmp(&self.depth).then_with(|| rank(&other.what).cmp(&rank(&self.what)))
    }
}

impl<N> PartialOrd for Ahead<N> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<N> PartialEq for Ahead<N> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<N> Eq for Ahead<N> {}

#[cfg(test)]
mod tests;
