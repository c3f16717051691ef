//! E1.9 The ray tree. Slide « Arbre de rayons ».

use chapter_1::exercises::prelude::*;

// Your own functions of the exercises before.
use crate::yours::{reflected_ray, refracted_ray};

/// A call of LR and those that it makes, as a tree; nobody asks for the colours.
pub fn ray_tree(stage: &Stage, call: &Call) -> Node {
    let mut node = Node::untraced(call);
    if call.depth > stage.max_depth {
        return node;
    }
    node.traced = true;
    let incident = call.ray.direction;
    let Some(surface) = stage.surface(&call.ray) else { return node };
    let n = surface.shading_normal_towards(-incident);
    for lamp in &stage.lamps {
        node.shadows += u32::from(n.dot(lamp.position - surface.position) > 0.0);
    }

    let child = |direction, k: Rgb, kind| {
        let (ray, weight) = (surface.spawn(direction), call.weight * k.max_element());
        ray_tree(stage, &Call { ray, depth: call.depth + 1, weight, kind })
    };
    let material = stage.scene.material(surface.material);
    let (n, index) = (surface.optical_normal(incident), material.refractive_index);
    let is_entering = surface.geometric_normal.dot(incident) < 0.0;
    let (n1, n2) = if is_entering { (1.0, index) } else { (index, 1.0) };
    let mut k_s = material.k_s;
    if material.k_t != Rgb::ZERO {
        match refracted_ray(incident, n, n1, n2) {
            Some(t) => node.children.push(child(t, material.k_t, RayKind::Refracted)),
            None => k_s += material.k_t,
        }
    }
    if k_s != Rgb::ZERO {
        node.children.push(child(reflected_ray(incident, n), k_s, RayKind::Mirror));
    }
    node
}

/// The rays of a tree that were traced, by kind, and its shadow rays.
pub fn count_rays(node: &Node) -> RayCounts {
    let mut counts = RayCounts { shadow: node.shadows.into(), ..RayCounts::default() };
    *counts.count_mut(node.kind) += u64::from(node.traced);
    for child in &node.children {
        counts += count_rays(child);
    }
    counts
}
