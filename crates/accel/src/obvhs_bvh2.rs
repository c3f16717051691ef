use glam::Vec3A;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::intersector::{Hit, Intersector, Observer, Probe};
use lancer_core::scene::{PrimitiveId, Scene};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use smallvec::SmallVec;

use crate::pair_slabs::{Frame, PairBounds, PairSlabs};

/// A binary bounding volume hierarchy built by the obvhs library and walked here.
///
/// The library builds good trees fast, in `f32`. Its own traversal and triangle test are made for
/// speed and lose rays aimed at edges and vertices, so only its tree is taken over: boxes in `f32`,
/// rounded outwards, visited conservatively, and primitives decided in `f64`.
pub struct ObvhsBvh2<'s> {
    scene: &'s Scene,
    frame: Frame,
    root: Option<Child>,
    pairs: Vec<Pair>,
    /// The primitives of the leaves, leaf by leaf.
    primitives: Vec<PrimitiveId>,
}

/// The two children of an inner node, one cache line.
#[repr(align(64))]
struct Pair {
    bounds: PairBounds,
    children: [Child; 2],
}

/// An inner node, whose children are `pairs[first]`, if `count` is 0; else a leaf with the primitives
/// `first .. first + count`.
#[derive(Clone, Copy, Debug)]
struct Child {
    first: u32,
    count: u32,
}

/// A child still to be visited, and the parameter at which the ray enters it.
type Pending = (Child, f32);

/// What is still to be visited. A tree deeper than 64 is rare and pays for an allocation.
type Stack = SmallVec<[Pending; 64]>;

impl<'s> ObvhsBvh2<'s> {
    /// Builds the tree over all primitives of the scene.
    pub fn build(scene: &'s Scene) -> Self {
        let frame = Frame::of(scene.bounds());
        let boxes: Vec<Aabb> = scene
            .primitives()
            .map(|primitive| {
                let [min, max] = frame.outwards(scene.primitive_bounds(primitive));
                Aabb::new(Vec3A::from_array(min), Vec3A::from_array(max))
            })
            .collect();
        let tree = if boxes.is_empty() {
            Bvh2::default()
        } else {
            build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Default::default())
        };
        drop(boxes);
        let mut pairs = Vec::with_capacity(tree.nodes.len() / 2);
        let root = (!tree.nodes.is_empty()).then(|| take_over(&tree, &mut pairs));
        let primitives = tree.primitive_indices.into_iter().map(PrimitiveId).collect();
        Self { scene, frame, root, pairs, primitives }
    }

    /// Bytes held by the index, without the scene it borrows.
    pub fn memory(&self) -> usize {
        size_of_val(self.pairs.as_slice()) + size_of_val(self.primitives.as_slice())
    }

    /// Visits the primitives whose boxes the ray meets, near boxes first, until `done` says so.
    #[inline]
    pub fn walk<O: Observer>(
        &self,
        ray: &Ray,
        range: Interval,
        observer: &mut O,
        done: impl Fn(&Probe) -> bool,
    ) -> Option<Hit> {
        let mut probe = Probe::new(self.scene, ray, range);
        let slabs = PairSlabs::new(ray, &self.frame);
        let mut max = slabs.parameter(range.max);
        let mut stack = Stack::new();
        let mut next = self.root;
        while let Some(child) = next {
            if child.count > 0 {
                let leaf = child.first as usize..(child.first + child.count) as usize;
                for &primitive in &self.primitives[leaf] {
                    observer.primitive_test(primitive);
                    if probe.test(primitive) && done(&probe) {
                        return probe.best();
                    }
                }
                max = slabs.parameter(probe.range().max);
                next = pop(&mut stack, max);
                continue;
            }
            let pair = &self.pairs[child.first as usize];
            observer.box_test();
            observer.box_test();
            let [left, right] = pair.children;
            next = match slabs.enter(&pair.bounds, max) {
                [Some(l), Some(r)] if l <= r => {
                    stack.push((right, r));
                    Some(left)
                }
                [Some(l), Some(_)] => {
                    stack.push((left, l));
                    Some(right)
                }
                [Some(_), None] => Some(left),
                [None, Some(_)] => Some(right),
                [None, None] => pop(&mut stack, max),
            };
        }
        probe.best()
    }
}

/// The next child that is not entirely behind the closest hit.
#[inline(always)]
fn pop(stack: &mut Stack, max: f32) -> Option<Child> {
    loop {
        let (child, near) = stack.pop()?;
        if near <= max {
            return Some(child);
        }
    }
}

/// Copies the tree into pairs, in depth-first order, and returns its root.
fn take_over(tree: &Bvh2, pairs: &mut Vec<Pair>) -> Child {
    const LATER: u32 = u32::MAX;
    let child = |index: u32| {
        let node = &tree.nodes[index as usize];
        Child {
            first: if node.is_leaf() { node.first_index } else { LATER },
            count: node.prim_count,
        }
    };
    let corners = |index: u32| {
        let node = &tree.nodes[index as usize];
        [node.min.to_array(), node.max.to_array()]
    };
    let mut root = child(0);
    // (index in the tree, the pair and side that refer to it)
    let mut pending: Vec<(u32, Option<(usize, usize)>)> = vec![(0, None)];
    while let Some((index, referrer)) = pending.pop() {
        let node = &tree.nodes[index as usize];
        if node.is_leaf() {
            continue;
        }
        let (left, right) = (node.first_index, node.first_index + 1);
        let pair = pairs.len();
        pairs.push(Pair {
            bounds: PairBounds::new(corners(left), corners(right)),
            children: [child(left), child(right)],
        });
        match referrer {
            Some((parent, side)) => pairs[parent].children[side].first = pair as u32,
            None => root.first = pair as u32,
        }
        pending.push((right, Some((pair, 1))));
        pending.push((left, Some((pair, 0))));
    }
    root
}

impl Intersector for ObvhsBvh2<'_> {
    fn closest_hit(&self, ray: &Ray, range: Interval) -> Option<Hit> {
        self.walk(ray, range, &mut (), |_| false)
    }

    fn occluded(&self, ray: &Ray, range: Interval) -> bool {
        self.walk(ray, range, &mut (), |_| true).is_some()
    }
}
