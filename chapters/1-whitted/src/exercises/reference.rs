//! The right answers: the chapter's own code under the names that students write.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray, Shear, Sphere, intersect_triangle};
use lancer_core::illumination::{attenuation, local};
use lancer_core::image::ImageSize;
use lancer_core::optics::{reflect, refract};
use lancer_core::sampling::{Pattern, PixelSampling};
use lancer_core::scene::{Camera, PointSource};
use lancer_core::world::{SurfacePoint, World};
use lancer_whitted::{AtLimit, Call, RayCounts, RayEnd, RayTree, Settings, Whitted};

use super::{FilmFunction, Lit, Meeting, Node, Stage, Subject};

/// All of them.
pub const SUBJECT: Subject = Subject {
    primary_ray,
    ray_triangle,
    ray_sphere,
    shadow_ray,
    local_light,
    reflected_ray,
    refracted_ray,
    lr,
    ray_tree,
    count_rays,
    pixel_mean,
    rms_error,
};

/// [`Subject::primary_ray`].
pub fn primary_ray(camera: &Camera, size: ImageSize, x: f64, y: f64) -> Ray {
    camera.primary_rays(size).through(x, y)
}

/// [`Subject::ray_triangle`].
pub fn ray_triangle(corners: [DVec3; 3], ray: &Ray) -> Option<Meeting> {
    intersect_triangle(corners, ray, &Shear::new(ray.direction)).map(|hit| (hit.t, hit.barycentric))
}

/// [`Subject::ray_sphere`].
pub fn ray_sphere(sphere: &Sphere, ray: &Ray) -> Option<f64> {
    sphere.intersect(ray, Interval::POSITIVE)
}

/// [`Subject::shadow_ray`].
pub fn shadow_ray(surface: &SurfacePoint, lamp: DVec3) -> Ray {
    surface.spawn_to(lamp)
}

/// [`Subject::local_light`].
pub fn local_light(lit: &Lit) -> Rgb {
    let Lit { intensity, visible, distance, reflectance, n, to_light, to_eye } = *lit;
    intensity * attenuation(visible, distance) * local(&reflectance, n, to_light, to_eye)
}

/// [`Subject::reflected_ray`].
pub fn reflected_ray(incident: DVec3, n: DVec3) -> DVec3 {
    reflect(incident, n)
}

/// [`Subject::refracted_ray`].
pub fn refracted_ray(incident: DVec3, n: DVec3, n1: f64, n2: f64) -> Option<DVec3> {
    refract(incident, n, n1, n2)
}

/// Whitted's method for what is left of the depth, and a call beyond it.
fn whitted<'a>(stage: &'a Stage, depth: u32) -> Option<Whitted<'a>> {
    let max_depth = stage.max_depth.checked_sub(depth)?;
    let settings = Settings { max_depth, min_weight: 0.0, at_limit: AtLimit::Black };
    Some(Whitted::new(World { scene: stage.scene, index: stage }, settings))
}

/// [`Subject::lr`].
pub fn lr(stage: &Stage, ray: &Ray, depth: u32) -> Rgb {
    whitted(stage, depth).map_or(Rgb::ZERO, |method| method.trace(ray, &mut ()))
}

/// The calls that follow from one, with depths and weights counted from it; none beyond Max_Prof.
pub(super) fn recorded(stage: &Stage, call: &Call) -> RayTree {
    let mut tree = RayTree::default();
    if let Some(method) = whitted(stage, call.depth) {
        method.trace(&call.ray, &mut tree);
    }
    tree
}

/// [`Subject::ray_tree`].
pub fn ray_tree(stage: &Stage, call: &Call) -> Node {
    let tree = recorded(stage, call);
    let mut root = Node::untraced(call);
    if !tree.nodes.is_empty() {
        fill(&mut root, stage, &tree, 0, call);
    }
    root
}

/// Copies a recorded call and those that it made; the recording began at `first`.
fn fill(node: &mut Node, stage: &Stage, tree: &RayTree, index: usize, first: &Call) {
    let own = &tree.nodes[index];
    node.traced = !matches!(own.end, RayEnd::Cut);
    if let RayEnd::Surface { hit, .. } = own.end {
        // The method itself casts fewer: none to a lamp that would add nothing.
        let surface = stage.scene.surface_at(&own.call.ray, &hit);
        let n = surface.shading_normal_towards(-own.call.ray.direction);
        let in_front = |lamp: &&PointSource| n.dot(lamp.position - surface.position) > 0.0;
        node.shadows = stage.lamps.iter().filter(in_front).count() as u32;
    }
    for (child, made) in
        tree.nodes.iter().enumerate().filter(|(_, made)| made.parent == Some(index))
    {
        let call = Call {
            depth: first.depth + made.call.depth,
            weight: first.weight * made.call.weight,
            ..made.call
        };
        let mut next = Node::untraced(&call);
        fill(&mut next, stage, tree, child, first);
        node.children.push(next);
    }
}

/// [`Subject::count_rays`].
pub fn count_rays(node: &Node) -> RayCounts {
    let mut counts = RayCounts::default();
    let mut open = vec![node];
    while let Some(node) = open.pop() {
        if node.traced {
            *counts.count_mut(node.kind) += 1;
        }
        counts.shadow += u64::from(node.shadows);
        open.extend(&node.children);
    }
    counts
}

/// [`Subject::pixel_mean`].
pub fn pixel_mean(radiance: &FilmFunction, x: u32, y: u32, n: u32) -> Rgb {
    let sampling = PixelSampling { pattern: Pattern::Regular, samples: n * n, seed: 0 };
    let radiances = sampling.of_pixel(x, y).map(|sample| radiance(sample.film.x, sample.film.y));
    radiances.sum::<Rgb>() / f64::from(n * n)
}

/// [`Subject::rms_error`].
pub fn rms_error(reference: &[Rgb], estimate: &[Rgb]) -> f64 {
    let squares = reference.iter().zip(estimate).map(|(a, b)| (*a - *b).length_squared());
    (squares.sum::<f64>() / (3 * reference.len()) as f64).sqrt()
}
