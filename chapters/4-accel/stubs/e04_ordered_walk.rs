//! E4.4 Near child first. Slide « Hiérarchie de volumes englobants ».

use chapter_4::exercises::prelude::*;

/// Visits a node whose box the ray meets, and what is below it, until the closest hit is known.
///
/// `walk: &mut Walk` (chapters/4-accel/src/exercises/walk.rs) is a ray on its way through a tree of boxes, whose
/// nodes are numbers; it is asked by these methods:
/// - `walk.children(node)`: `Some` array of the two children, in no order; `None` says that `node` is a leaf.
/// - `walk.test_leaf(node)`: tests the leaf's primitive and keeps the hit if it is the closest so far.
/// - `walk.enter(node)`: tests the node's box; `Some(t)` at which the ray enters it, `None` if it does not, or
///   only behind the closest hit.
/// - `walk.closest()`: the t of the closest hit so far; infinite before the first.
///
/// Box tests and primitive tests are counted: no box is tested twice, and nothing behind the closest hit
/// is visited.
pub fn visit(walk: &mut Walk, node: usize) {
    todo!("E4.4: test a leaf, or visit the children")
}
