//! E4.6 A ray and the plane of a kd-tree. Slide « Subdivision spatiale régulière et irrégulière ».

use chapter_4::exercises::prelude::*;

/// Which sides of a plane across an axis a ray visits: `Sides::Near`, `Sides::Far`, or
/// `Sides::Both { near, far }` with the part of the ray that lies in each (crates/accel/src/kd/sides.rs).
///
/// - `split`: where the plane is on the axis.
/// - `origin`, `direction`: the ray's components along the axis. The near side is where the ray comes from:
///   below the plane for a positive `direction` or 0, above it for a negative one or −0.
/// - `inside: Interval` (crates/core/src/geometry/ray.rs): the part of the ray that is in the node's cell, from
///   `inside.min` to `inside.max`; `Interval { max: t, ..inside }` is a copy with another end.
///
/// A ray that meets the plane just at the beginning or the end of `inside` visits both sides, since what
/// lies in the plane may be stored on either; before the beginning or beyond the end, by however little, one. A
/// ray that runs in the plane visits both, each with all of `inside`.
pub fn plane_sides(split: f64, origin: f64, direction: f64, inside: Interval) -> Sides {
    todo!("E4.6: where the plane divides the ray")
}
