//! Indexes as they are often written, and what they lose: the rivals of plate 4.11.

use glam::{DVec3, Vec3A};
use lancer_accel::Grid;
use lancer_core::geometry::{Bounds3, Interval, Ray};
use lancer_core::intersector::{Hit, Probe};
use lancer_core::scene::{PrimitiveId, Scene};
use lancer_lesson::naive::min_max_box;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::RayHit;
use obvhs::triangle::Triangle;

/// A hierarchy of exact boxes, with no pad, tested by the language's `min` and `max`: a ray in a box's face is 0 · ∞, a
/// ray through a corner is lost to rounding.
pub struct BareTree<'s> {
    scene: &'s Scene,
    root: Option<BareNode>,
}

struct BareNode {
    bounds: Bounds3,
    below: Below,
}

enum Below {
    Leaf(Vec<PrimitiveId>),
    Inner(Box<[BareNode; 2]>),
}

impl<'s> BareTree<'s> {
    /// Divides at the median of the longest axis.
    pub fn build(scene: &'s Scene) -> Self {
        let mut primitives: Vec<PrimitiveId> = scene.primitives().collect();
        let root = (!primitives.is_empty()).then(|| Self::grow(scene, &mut primitives));
        Self { scene, root }
    }

    fn grow(scene: &Scene, primitives: &mut [PrimitiveId]) -> BareNode {
        let boxes = primitives.iter().map(|id| scene.primitive_bounds(*id));
        let bounds = boxes.fold(Bounds3::EMPTY, Bounds3::union);
        if primitives.len() <= 4 {
            return BareNode { bounds, below: Below::Leaf(primitives.to_vec()) };
        }
        let axis = (bounds.max - bounds.min).max_position();
        primitives.sort_by(|a, b| {
            let middle = |id: &PrimitiveId| scene.primitive_bounds(*id).center()[axis];
            middle(a).total_cmp(&middle(b))
        });
        let (left, right) = primitives.split_at_mut(primitives.len() / 2);
        let children = [Self::grow(scene, left), Self::grow(scene, right)];
        BareNode { bounds, below: Below::Inner(Box::new(children)) }
    }

    /// The closest hit, as far as it is found.
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let mut probe = Probe::new(self.scene, ray, Interval::POSITIVE);
        self.root.iter().for_each(|root| Self::visit(root, ray, &mut probe));
        probe.best()
    }

    fn visit(node: &BareNode, ray: &Ray, probe: &mut Probe) {
        let near = min_max_box(&node.bounds, ray.origin, ray.direction.recip());
        if near.is_none_or(|near| near > probe.range().max) {
            return;
        }
        match &node.below {
            Below::Leaf(primitives) => primitives.iter().for_each(|id| {
                probe.test(*id);
            }),
            Below::Inner(children) => {
                children.iter().for_each(|child| Self::visit(child, ray, probe));
            }
        }
    }
}

/// The rule of the first grids: the first cell in which anything is hit has the closest hit. But the hit may be in a
/// later cell, and something else before it.
pub fn first_hit_wins(scene: &Scene, grid: &Grid, ray: &Ray) -> Option<Hit> {
    grid.cells(ray, Interval::POSITIVE).find_map(|cell| {
        let mut probe = Probe::new(scene, ray, Interval::POSITIVE);
        cell.primitives.iter().for_each(|&primitive| {
            probe.test(primitive);
        });
        probe.best()
    })
}

/// The obvhs library as it comes: its tree, its walk and its triangle test, in `f32`, over a scene of triangles. It is
/// made for speed and promises no watertight surface.
pub struct LibraryWalk {
    tree: Bvh2,
    /// The triangles in the order of the tree's leaves.
    triangles: Vec<Triangle>,
}

impl LibraryWalk {
    /// Builds the tree by the preset for medium builds.
    pub fn build(scene: &Scene) -> Self {
        let triangles: Vec<Triangle> = (0..scene.mesh.triangles.len())
            .map(|index| {
                let [v0, v1, v2] = scene.mesh.corners(index).map(DVec3::as_vec3a);
                Triangle { v0, v1, v2 }
            })
            .collect();
        let boxes: Vec<_> = triangles.iter().map(Triangle::aabb).collect();
        let tree = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Default::default());
        let order = &tree.primitive_indices;
        let triangles = order.iter().map(|&index| triangles[index as usize]).collect();
        Self { tree, triangles }
    }

    /// The ray parameter of the closest hit, as far as it is found.
    pub fn closest_hit(&self, ray: &Ray) -> Option<f32> {
        let [origin, direction]: [Vec3A; 2] = [ray.origin, ray.direction].map(DVec3::as_vec3a);
        let ray = obvhs::ray::Ray::new(origin, direction, 0.0, f32::MAX);
        let mut hit = RayHit::none();
        self.tree.ray_traverse(ray, &mut hit, |ray, id| self.triangles[id].intersect(ray));
        (hit.t < f32::MAX).then_some(hit.t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::family;
    use lancer_core::image::ImageSize;
    use lancer_core::intersector::{Intersector, LinearScan};

    /// On ordinary rays the rivals are right: what plate 4.11 shows is not a slip in them.
    #[test]
    fn rivals_are_right_where_rays_are_ordinary() {
        let scene = family("scan").scene(1_000);
        let (oracle, bare) = (LinearScan::new(&scene), BareTree::build(&scene));
        let library = LibraryWalk::build(&scene);
        let rays = scene.camera.primary_rays(ImageSize::new(40, 30));
        for (x, y) in (0..40).flat_map(|x| (0..30).map(move |y| (x, y))) {
            let ray = rays.through(f64::from(x) + 0.37, f64::from(y) + 0.61);
            let hit = oracle.closest_hit(&ray, Interval::POSITIVE);
            assert_eq!(bare.closest_hit(&ray), hit);
            let t = library.closest_hit(&ray).map(f64::from);
            assert_eq!(t.is_some(), hit.is_some());
            assert!(t.zip(hit).is_none_or(|(t, hit)| (t / hit.t - 1.0).abs() < 1e-4));
        }
    }
}
