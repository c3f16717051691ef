//! E4.4 Near child first. Slide « Hiérarchie de volumes englobants ».

use chapter_4::exercises::prelude::*;

/// Visits a node whose box the ray meets, and what is below it, until the closest hit is known.
pub fn visit(walk: &mut Walk, node: usize) {
    let Some(children) = walk.children(node) else { return walk.test_leaf(node) };
    let mut order = children.map(|child| (walk.enter(child), child));
    if order[1].0 < order[0].0 {
        order.reverse();
    }
    for (enter, child) in order {
        // Asked again for the second: the first may have brought a hit.
        if enter.is_some_and(|t| t <= walk.closest()) {
            visit(walk, child);
        }
    }
}
