//! The right answers: the chapter's own code under the names that students write.

use glam::IVec3;
use lancer_accel::{Cell, Lattice, Sides, split_at_median};
use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};

use super::{Item, Lanes, Met, PreparedRay, Subject, Test, Walk};

/// All of them.
pub const SUBJECT: Subject = Subject {
    slab_test,
    median_split,
    sah_cost,
    best_split,
    visit,
    next_cell,
    plane_sides,
    search_cells,
    eight_boxes,
    near_to_far,
};

/// [`Subject::slab_test`].
pub fn slab_test(bounds: &Bounds3, ray: &Ray, range: Interval) -> Option<f64> {
    Slabs::new(ray).enter(bounds.min, bounds.max, range)
}

/// [`Subject::median_split`].
pub fn median_split(items: &mut [Item]) -> usize {
    split_at_median(items, |item| (item.center.as_vec3a(), item.id))
}

/// [`Subject::sah_cost`].
pub fn sah_cost(node: &Bounds3, parts: [&Bounds3; 2], counts: [usize; 2]) -> f64 {
    let extent = |bounds: &Bounds3| bounds.max - bounds.min;
    lancer_accel::sah_cost(extent(node), parts.map(extent), counts, 1.0)
}

/// [`Subject::best_split`].
pub fn best_split(boxes: &[Bounds3]) -> Option<usize> {
    let around = |boxes: &[Bounds3]| boxes.iter().copied().fold(Bounds3::EMPTY, Bounds3::union);
    let cost = |left: usize| {
        let (a, b) = boxes.split_at(left);
        sah_cost(&around(boxes), [&around(a), &around(b)], [a.len(), b.len()])
    };
    let best = (1..boxes.len()).min_by(|a, b| cost(*a).total_cmp(&cost(*b)))?;
    (cost(best) < boxes.len() as f64).then_some(best)
}

/// [`Subject::visit`].
pub fn visit(walk: &mut Walk, node: usize) {
    let Some(children) = walk.children(node) else { return walk.test_leaf(node) };
    let mut order = children.map(|child| (walk.enter(child), child));
    if order[1].0 < order[0].0 {
        order.reverse();
    }
    for (enter, child) in order {
        if enter.is_some_and(|enter| enter <= walk.closest()) {
            visit(walk, child);
        }
    }
}

/// [`Subject::next_cell`].
pub fn next_cell(lattice: &Lattice, ray: &Ray, cell: IVec3) -> Option<(IVec3, f64)> {
    lattice.step(ray, cell)
}

/// [`Subject::plane_sides`].
pub fn plane_sides(split: f64, origin: f64, direction: f64, inside: Interval) -> Sides {
    Sides::of(split, origin, direction, inside)
}

/// [`Subject::search_cells`].
pub fn search_cells(cells: &[Cell], test: &mut Test) -> Option<Met> {
    let mut best: Option<Met> = None;
    let mut tested = Vec::new();
    for cell in cells {
        if best.is_some_and(|(t, _)| cell.enter > t) {
            break;
        }
        for &primitive in cell.primitives {
            if tested.contains(&primitive) {
                continue;
            }
            tested.push(primitive);
            let Some(t) = test(primitive) else { continue };
            if best.is_none_or(|best| (t, primitive) < best) {
                best = Some((t, primitive));
            }
        }
    }
    best
}

/// [`Subject::eight_boxes`].
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
    (near, (0..8).fold(0, |met, lane| met | u32::from(near[lane] <= far[lane]) << lane))
}

/// [`Subject::near_to_far`].
pub fn near_to_far(near: &Lanes, met: u32) -> Vec<usize> {
    let mut lanes: Vec<usize> = (0..8).filter(|lane| met >> lane & 1 == 1).collect();
    lanes.sort_by(|&a, &b| near[a].total_cmp(&near[b]));
    lanes
}
