//! E4.8 Eight boxes at once. Slide « Accélération matérielle ».

use chapter_4::exercises::prelude::*;

/// Where a ray enters each of eight boxes, and which of them it meets up to `max`: bit 0 for lane 0, …
pub fn eight_boxes(planes: &[Lanes; 6], ray: &PreparedRay, max: f32) -> (Lanes, u32) {
    let (mut near, mut far) = ([0.0_f32; 8], [max; 8]);
    for axis in 0..3 {
        let inverse = ray.inverse[axis];
        let first = 2 * axis + usize::from(inverse < 0.0);
        let (first, last) = (planes[first], planes[first ^ 1]);
        for lane in 0..8 {
            near[lane] = near[lane].max(first[lane] * inverse + ray.near_offset[axis]);
            far[lane] = far[lane].min(last[lane] * inverse + ray.far_offset[axis]);
        }
    }
    let met = (0..8).map(|lane| u32::from(near[lane] <= far[lane]) << lane).sum();
    (near, met)
}

/// The numbers of the lanes that are met, the one that is entered first in front.
pub fn near_to_far(near: &Lanes, met: u32) -> Vec<usize> {
    let mut lanes: Vec<usize> = (0..8).filter(|lane| met >> lane & 1 == 1).collect();
    // Stable: equal ones stay in order.
    lanes.sort_by(|&a, &b| near[a].total_cmp(&near[b]));
    lanes
}
