//! Polygons, in space and as files have them, cut into triangles.

mod ears;
mod outline;
#[cfg(test)]
mod tests;

use glam::{DVec2, DVec3};

use ears::EarClipper;

/// The share of a polygon's area by which its triangles may overlap. Corners rounded to six digits, as
/// many programs write them, make a polygon that touches itself overlap by less.
const OVERLAP: f64 = 1e-4;

/// What a polygon was found to be while it was cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Defects {
    /// It crosses itself, so that its triangles' areas do not add up to its own.
    pub self_intersecting: bool,
    /// A corner is further from the mean plane than a thousandth of the polygon's size.
    pub non_planar: bool,
}

/// Cuts the polygon `corners` (at least 3, finite) into `corners.len() − 2` triangles of corner
/// numbers, appended to `triangles`, with the polygon's sense of rotation. The areas of the
/// triangles add up to the area of the polygon, also where it is concave, has straight corners, or
/// touches itself: at the bridge to a hole, and where a hole meets the outline at a corner or anywhere
/// on an edge. Corners may be rounded, as those of a polygon turned in space are.
///
/// A fan of one corner serves where it covers the polygon, as in every convex one; otherwise ears
/// are clipped. Both look at the polygon along the axis its normal is closest to, which keeps the
/// coordinates as they were written.
pub(crate) fn triangulate(corners: &[DVec3], triangles: &mut Vec<[u32; 3]>) -> Defects {
    let count = corners.len() as u32;
    if count == 3 {
        triangles.push([0, 1, 2]);
        return Defects::default();
    }
    let normal = newell_normal(corners);
    let mut flat = flatten(corners, normal);
    let non_planar = is_non_planar(corners, normal);

    // A simple quadrilateral always has a diagonal inside.
    let apexes = if count == 4 { 2 } else { 1 };
    if let Some(apex) = (0..apexes).find(|&apex| fan_covers(&flat, apex)) {
        push_fan(count, apex, triangles);
        return Defects { self_intersecting: false, non_planar };
    }
    let first = triangles.len();
    lay_along_x(&mut flat);
    EarClipper::new(&flat).clip(triangles);
    let whole: f64 = (1..flat.len() - 1).map(|i| cross(flat[0], flat[i], flat[i + 1])).sum();
    let parts: f64 = triangles[first..]
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| flat[i as usize]);
            cross(a, b, c).abs()
        })
        .sum();
    Defects { self_intersecting: parts - whole.abs() > OVERLAP * parts, non_planar }
}

/// The area vector of a polygon: perpendicular to its mean plane, as long as twice its area.
///
/// Newell's method: a straight or repeated corner does not disturb it.
pub(crate) fn newell_normal(corners: &[DVec3]) -> DVec3 {
    let origin = corners[0];
    corners.windows(2).map(|pair| (pair[0] - origin).cross(pair[1] - origin)).sum()
}

fn is_non_planar(corners: &[DVec3], normal: DVec3) -> bool {
    let Some(n) = normal.try_normalize() else { return false };
    let mean = corners.iter().map(|&p| p - corners[0]).sum::<DVec3>() / corners.len() as f64;
    let from_mean = || corners.iter().map(|&p| p - corners[0] - mean);
    let size = from_mean().map(DVec3::length).fold(0.0, f64::max);
    from_mean().any(|p| p.dot(n).abs() > 1e-3 * size)
}

/// The corners seen along the axis that `normal` is closest to, counter-clockwise.
fn flatten(corners: &[DVec3], normal: DVec3) -> Vec<DVec2> {
    let n = normal.abs();
    let (project, towards_eye): (fn(&DVec3) -> DVec2, f64) = if n.z >= n.x && n.z >= n.y {
        (|p| DVec2::new(p.x, p.y), normal.z)
    } else if n.x >= n.y {
        (|p| DVec2::new(p.y, p.z), normal.x)
    } else {
        (|p| DVec2::new(p.z, p.x), normal.y)
    };
    let mut flat: Vec<DVec2> = corners.iter().map(project).collect();
    if towards_eye < 0.0 {
        for p in &mut flat {
            p.x = -p.x;
        }
    }
    flat
}

/// Turns a polygon that is higher than wide by a quarter: its corners then spread well along x.
fn lay_along_x(flat: &mut [DVec2]) {
    let (min, max) =
        flat.iter().fold((flat[0], flat[0]), |(min, max), &p| (min.min(p), max.max(p)));
    if max.y - min.y > max.x - min.x {
        for p in flat {
            *p = p.perp();
        }
    }
}

/// Twice the area of the triangle a b c, positive where it turns counter-clockwise.
fn cross(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Whether the triangles from corner `apex` to every edge turn the same way, in less than one turn.
fn fan_covers(flat: &[DVec2], apex: usize) -> bool {
    let at = |i: usize| flat[(apex + i) % flat.len()];
    let (mut past_half_turn, mut area) = (false, 0.0);
    for i in 1..flat.len() - 1 {
        let part = cross(at(0), at(i), at(i + 1));
        let turned = cross(at(0), at(1), at(i + 1));
        if part < 0.0 || (past_half_turn && turned > 0.0) {
            return false;
        }
        past_half_turn |= turned < 0.0;
        area += part;
    }
    area > 0.0
}

fn push_fan(count: u32, apex: usize, triangles: &mut Vec<[u32; 3]>) {
    let at = |i: u32| (apex as u32 + i) % count;
    triangles.extend((1..count - 1).map(|i| [at(0), at(i), at(i + 1)]));
}
