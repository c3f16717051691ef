use glam::{DVec3, Vec3, Vec3A};
use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};
use lancer_core::intersector::{Hit, Intersector, Observer, Probe};
use lancer_core::scene::{PrimitiveId, Scene};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;

/// A binary bounding volume hierarchy built by the obvhs library and walked here.
///
/// The library builds good trees fast, in `f32`. Its own traversal and triangle test are made for
/// speed and lose rays aimed at edges and vertices, so only its nodes are used: they hold boxes
/// recentred on the scene and rounded outwards, which an `f64` slab test visits conservatively.
pub struct ObvhsBvh2<'s> {
    scene: &'s Scene,
    tree: Bvh2,
    /// The origin of the nodes' coordinates.
    center: DVec3,
}

/// A node still to be visited, and the parameter at which the ray enters it.
type Pending = (u32, f64);

/// What is still to be visited. Trees deeper than the array are rare and pay for an allocation.
struct Stack {
    held: [Pending; 64],
    len: usize,
    spilled: Vec<Pending>,
}

impl Stack {
    fn new() -> Self {
        Self { held: [(0, 0.0); 64], len: 0, spilled: Vec::new() }
    }

    #[inline(always)]
    fn push(&mut self, pending: Pending) {
        if self.len < self.held.len() {
            self.held[self.len] = pending;
            self.len += 1;
        } else {
            self.spilled.push(pending);
        }
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Pending> {
        if let Some(pending) = self.spilled.pop() {
            return Some(pending);
        }
        self.len = self.len.checked_sub(1)?;
        Some(self.held[self.len])
    }
}

impl<'s> ObvhsBvh2<'s> {
    /// Builds the tree over all primitives of the scene.
    pub fn build(scene: &'s Scene) -> Self {
        let bounds = scene.bounds();
        let center = if bounds.is_empty() { DVec3::ZERO } else { bounds.center() };
        // Covers hits that the primitive test places a rounding error beside the primitive.
        let margin = f64::from(f32::EPSILON) * bounds.diagonal();
        let boxes: Vec<Aabb> = scene
            .primitives()
            .map(|primitive| outwards(scene.primitive_bounds(primitive), center, margin))
            .collect();
        let tree = if boxes.is_empty() {
            Bvh2::default()
        } else {
            build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Default::default())
        };
        Self { scene, tree, center }
    }

    /// Bytes held by the index, without the scene it borrows.
    pub fn memory(&self) -> usize {
        size_of_val(self.tree.nodes.as_slice())
            + size_of_val(self.tree.primitive_indices.as_slice())
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
        let slabs = Slabs::new(&Ray::new(ray.origin - self.center, ray.direction));
        let mut stack = Stack::new();
        let enter = |index: u32, range: Interval, observer: &mut O| {
            observer.box_test();
            let Bvh2Node { min, max, .. } = self.tree.nodes[index as usize];
            slabs.enter(min.as_dvec3(), max.as_dvec3(), range)
        };

        let root = if self.tree.nodes.is_empty() { None } else { enter(0, range, observer) };
        let mut next = root.map(|near| (0, near));
        while let Some((index, near)) = next {
            next = None;
            if near <= probe.range().max {
                let node = &self.tree.nodes[index as usize];
                if node.is_leaf() {
                    let first = node.first_index as usize;
                    let leaf = first..first + node.prim_count as usize;
                    for &primitive in &self.tree.primitive_indices[leaf] {
                        let primitive = PrimitiveId(primitive);
                        observer.primitive_test(primitive);
                        if probe.test(primitive) && done(&probe) {
                            return probe.best();
                        }
                    }
                } else {
                    let (left, right) = (node.first_index, node.first_index + 1);
                    let range = probe.range();
                    next = match (enter(left, range, observer), enter(right, range, observer)) {
                        (Some(l), Some(r)) if l <= r => {
                            stack.push((right, r));
                            Some((left, l))
                        }
                        (Some(l), Some(r)) => {
                            stack.push((left, l));
                            Some((right, r))
                        }
                        (Some(l), None) => Some((left, l)),
                        (None, Some(r)) => Some((right, r)),
                        (None, None) => None,
                    };
                }
            }
            if next.is_none() {
                next = stack.pop();
            }
        }
        probe.best()
    }
}

impl Intersector for ObvhsBvh2<'_> {
    fn closest_hit(&self, ray: &Ray, range: Interval) -> Option<Hit> {
        self.walk(ray, range, &mut (), |_| false)
    }

    fn occluded(&self, ray: &Ray, range: Interval) -> bool {
        self.walk(ray, range, &mut (), |_| true).is_some()
    }
}

/// The box relative to `center`, grown by `margin` and rounded outwards to `f32`.
fn outwards(bounds: Bounds3, center: DVec3, margin: f64) -> Aabb {
    let down = |v: DVec3| v.as_vec3().to_array().map(f32::next_down);
    let up = |v: DVec3| v.as_vec3().to_array().map(f32::next_up);
    let min = Vec3::from(down(bounds.min - center - margin));
    let max = Vec3::from(up(bounds.max - center + margin));
    Aabb::new(Vec3A::from(min), Vec3A::from(max))
}
