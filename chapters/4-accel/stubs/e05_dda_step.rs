//! E4.5 A step through the grid. Slide « Subdivision spatiale régulière et irrégulière ».

use chapter_4::exercises::prelude::*;

/// The cell that a ray enters next, and the t at which it does, as `Some((cell, t))`; `None` if it leaves the grid.
///
/// - `lattice: &Lattice` (crates/accel/src/grid.rs): along axis k cell i reaches from `min[k] + i · width[k]` to
///   the next plane, and i counts from 0 to `resolution[k] - 1`.
/// - `ray: &Ray` (crates/core/src/geometry/ray.rs): the points `ray.origin + t * ray.direction`. The direction has
///   any length; its components may be 0 or −0: such an axis is never crossed.
/// - `cell: IVec3`: the cell that the ray is in, by its three indices, `i32`; `f64::from(cell[k])` converts one.
///
/// Where two planes are met at once the step goes along the smaller axis, and along that one only.
pub fn next_cell(lattice: &Lattice, ray: &Ray, cell: IVec3) -> Option<(IVec3, f64)> {
    todo!("E4.5: the nearest of the three planes ahead")
}
