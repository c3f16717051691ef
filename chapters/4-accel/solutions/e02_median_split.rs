//! E4.2 The median split. Slide « Hiérarchie de volumes englobants ».

use chapter_4::exercises::prelude::*;

/// Sorts the lower half of the items to the front, and returns how many items that are.
pub fn median_split(items: &mut [Item]) -> usize {
    let centers = items.iter().map(|item| item.center);
    let min = centers.clone().fold(DVec3::INFINITY, DVec3::min);
    let max = centers.fold(DVec3::NEG_INFINITY, DVec3::max);
    let axis = (max - min).max_position();
    items.sort_by(|a, b| a.center[axis].total_cmp(&b.center[axis]).then(a.id.cmp(&b.id)));
    items.len() / 2
}
