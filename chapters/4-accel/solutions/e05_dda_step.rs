//! E4.5 A step through the grid. Slide « Subdivision spatiale régulière et irrégulière ».

use chapter_4::exercises::prelude::*;

/// The cell that a ray enters next, and the t at which it does; None if it leaves the grid.
pub fn next_cell(lattice: &Lattice, ray: &Ray, cell: IVec3) -> Option<(IVec3, f64)> {
    let t = [0, 1, 2].map(|k| {
        let direction = ray.direction[k];
        if direction == 0.0 {
            return f64::INFINITY;
        }
        let ahead = cell[k] + i32::from(direction > 0.0);
        let plane = lattice.min[k] + f64::from(ahead) * lattice.width[k];
        (plane - ray.origin[k]) / direction
    });
    let axis = (1..3).fold(0, |best, k| if t[k] < t[best] { k } else { best });
    let mut next = cell;
    next[axis] += if ray.direction[axis] < 0.0 { -1 } else { 1 };
    (0..lattice.resolution[axis]).contains(&next[axis]).then_some((next, t[axis]))
}
