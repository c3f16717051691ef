//! The ray tree in a plane drawing, as the step-through and plate 1.6 show it.

use glam::DVec3;
use lancer_core::geometry::Sphere;
use lancer_core::scene::{Scene, Shape};
use lancer_figure::{Backdrop, Color, INK, MUTED, Point, Tree, category_color};
use lancer_lesson::view::{Side, View};
use lancer_whitted::{RayEnd, RayKind, RayTree};

/// How a kind of ray is called, and its colour.
pub fn kind(kind: RayKind) -> (&'static str, Color) {
    match kind {
        RayKind::Primary => ("primary", INK),
        RayKind::Mirror => ("mirror", category_color(3)),
        RayKind::Refracted => ("refracted", category_color(0)),
    }
}

/// How the answer to a shadow ray is called, and its colour.
pub fn shadow(visible: bool) -> (&'static str, Color) {
    if visible { ("shadow ray, lit", category_color(1)) } else { ("shadow ray, blocked", MUTED) }
}

/// The tree of the calls from the `k`-th downwards; `label` gives the text of a node and of the edge that
/// leads to it.
pub fn calls(tree: &RayTree, k: usize, label: &dyn Fn(usize) -> [String; 2]) -> Tree {
    let node = &tree.nodes[k];
    let color = if matches!(node.end, RayEnd::Cut) { MUTED } else { kind(node.call.kind).1 };
    let children = (k + 1..tree.nodes.len()).filter(|&child| tree.nodes[child].parent == Some(k));
    let [name, _] = label(k);
    children.fold(Tree::new(name, color), |drawn, child| {
        let [_, edge] = label(child);
        drawn.child(edge, calls(tree, child, label))
    })
}

/// The view of a pixel's rays, from the side from which they look longest: what they meet is in sight,
/// and all of the scene unless it is large.
pub fn of_rays(scene: &Scene, tree: &RayTree) -> View {
    let root = &tree.nodes[0];
    let mut paths = Vec::new();
    let mut ends = Vec::new();
    for node in &tree.nodes {
        if let RayEnd::Surface { hit, position, .. } = node.end {
            paths.push((node.call.ray.origin, position));
            ends.push((position, 0.0));
            if let Shape::Sphere(index) = scene.shape(hit.primitive) {
                let Sphere { center, radius } = scene.spheres[index].shape;
                ends.push((center, radius));
            }
        }
    }
    // A pixel that meets nothing is seen before the eye, as far as the middle of the picture.
    let distance =
        paths.first().map_or(scene.camera.look_at - root.call.ray.origin, |(a, b)| *b - *a);
    if ends.is_empty() {
        ends.push((root.call.ray.origin, 0.0));
    }
    let whole = scene.bounding_sphere().filter(|s| s.radius < distance.length());
    if whole.is_some() {
        ends.extend(scene.mesh.positions.iter().map(|&p| (p, 0.0)));
        ends.extend(scene.spheres.iter().map(|s| (s.shape.center, s.shape.radius)));
    }
    let length = |side: Side| -> f64 {
        let run = |(a, b): &(DVec3, DVec3)| {
            let [x, y] = side.flat(*b - *a);
            x.hypot(y)
        };
        paths.iter().map(run).sum()
    };
    let side = if length(Side::Right) > length(Side::Above) { Side::Right } else { Side::Above };
    let corner = |sign: f64| -> Point {
        let reach = |axis: usize| {
            let end = |(p, radius): &(DVec3, f64)| sign * side.flat(*p)[axis] + radius;
            let least = 0.1 * distance.length();
            sign * (ends.iter().map(end).fold(f64::NEG_INFINITY, f64::max) + least)
        };
        [reach(0), reach(1)]
    };
    let [low, high] = Backdrop::frame(corner(-1.0), corner(1.0));
    View { side, low, high }
}
