//! E1.9 The ray tree. Slide « Arbre de rayons ».

use chapter_1::exercises::prelude::*;

// Your own functions of the exercises before.
use crate::yours::{reflected_ray, refracted_ray};

/// A call of LR and those that it makes, as a tree; nobody asks for the colours.
///
/// `Node` and `Stage` are in chapters/1-whitted/src/exercises/stage.rs, `Call`, `RayKind` and `RayCounts` in
/// crates/whitted/src/recorder.rs; surfaces are asked as in the stub of `lr`.
///
/// - `call`: `ray`, `depth`, `weight` and `kind` of the root. `Node::untraced(call)` is its node as long as
///   nothing has been traced.
/// - A call beyond `stage.max_depth` stays untraced: it is a leaf.
/// - `shadows` of a surface: the lamps in front of it, N·L > 0, with
///   N = `surface.shading_normal_towards(-call.ray.direction)`.
/// - `children`, a `Vec<Node>` that `node.children.push(child)` adds to: the refracted ray if k_t is not 0,
///   then the mirror ray if k_s is not 0. At total reflection the mirror ray has k_s + k_t.
/// - A child's weight is its parent's times the largest channel (`max_element()`) of its k_t or k_s.
pub fn ray_tree(stage: &Stage, call: &Call) -> Node {
    todo!("E1.9: follow the calls")
}

/// The rays of a tree that were traced, by kind, and its shadow rays.
///
/// `counts.count_mut(kind)` is the count of a kind, to be added to; two counts can be added by `+=`.
pub fn count_rays(node: &Node) -> RayCounts {
    todo!("E1.9: count the rays")
}
