//! E4.8 Eight boxes at once. Slide « Accélération matérielle ».

use chapter_4::exercises::prelude::*;

/// Where a ray enters each of eight boxes, and which of them it meets up to `max`: bit 0 for lane 0, …
///
/// - `planes`: a row for the lowest x of all eight boxes, then highest x, lowest y, highest y, lowest z and
///   highest z; `Lanes` is `[f32; 8]`, a number for each box. In a lane without a box the lowest are ∞ and the
///   highest −∞: it is never met.
/// - `ray: &PreparedRay` (chapters/4-accel/src/exercises/mod.rs): on axis k a plane is at `t = plane ·
///   inverse[k] + offset[k]`. `ray.near_offset` belongs to planes through which the ray enters, `ray.far_offset`
///   to those through which it leaves: together they hold more than rounding can take away, so add nothing.
/// - `max`: the ray reaches from t = 0 to here, both included. One that starts in a box enters it at 0.
///
/// The t of a lane that is not met does not matter. The rows are chosen once for all lanes, by the sign of
/// the inverse; a loop over lanes that only multiplies, adds and takes the smaller or the larger number has no
/// branch, and becomes a few instructions that compute with many lanes at once.
pub fn eight_boxes(planes: &[Lanes; 6], ray: &PreparedRay, max: f32) -> (Lanes, u32) {
    todo!("E4.8: clip eight ranges by three slabs each")
}

/// The numbers of the lanes that are met, the one that is entered first in front; of lanes entered at the
/// same t the one with the smaller number is in front.
pub fn near_to_far(near: &Lanes, met: u32) -> Vec<usize> {
    todo!("E4.8: the lanes whose bit is set, sorted by t")
}
