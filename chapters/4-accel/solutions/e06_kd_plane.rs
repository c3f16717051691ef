//! E4.6 A ray and the plane of a kd-tree. Slide « Subdivision spatiale régulière et irrégulière ».

use chapter_4::exercises::prelude::*;

/// Which sides of a plane across an axis a ray visits.
pub fn plane_sides(split: f64, origin: f64, direction: f64, inside: Interval) -> Sides {
    let t = (split - origin) * (1.0 / direction);
    if t > inside.max {
        return Sides::Near;
    }
    if t < inside.min {
        return Sides::Far;
    }
    // In the plane t is NaN: both comparisons are false, and `min` and `max` give the other number.
    Sides::Both {
        near: Interval { max: t.min(inside.max), ..inside },
        far: Interval { min: t.max(inside.min), ..inside },
    }
}
