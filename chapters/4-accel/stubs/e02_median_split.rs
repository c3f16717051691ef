//! E4.2 The median split. Slide « Hiérarchie de volumes englobants ».

use chapter_4::exercises::prelude::*;

/// Divides the items of a node into two halves: sorts the lower half to the front, and returns how many
/// items that are.
///
/// - `items: &mut [Item]` (chapters/4-accel/src/exercises/mod.rs): an array of known length, `items.len()`, to
///   be put into another order. An `Item` has a `center`, a `DVec3` of three `f64`, and an `id`, a `PrimitiveId`
///   that compares like a number.
/// - The axis is the longest of the box around the centres.
/// - Lower is what has the smaller coordinate `item.center[axis]`; of equal ones, what has the smaller
///   `item.id`.
/// - There are at least two items. Of an odd number the front has the smaller part. The order within each
///   part does not matter.
pub fn median_split(items: &mut [Item]) -> usize {
    todo!("E4.2: choose the axis, sort, cut in the middle")
}
