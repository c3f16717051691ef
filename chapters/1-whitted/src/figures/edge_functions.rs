//! 1.16: the shear that makes a ray the z axis, and the signed areas that tell whether it meets a triangle.

use glam::DVec3;
use lancer_core::geometry::{Ray, Shear, intersect_triangle};
use lancer_figure::{
    Color, Drawing, Effort, Finished, HEADING, INK, LABEL, MUTED, Pen, Plate, Point, Row, Stroke,
    Style, Table, Text, category_color, number,
};

/// Seen along the ray they turn clockwise, so that the edge functions are positive.
const CORNERS: [DVec3; 3] =
    [DVec3::new(-0.2, -0.3, 1.6), DVec3::new(1.1, 1.6, 2.4), DVec3::new(1.6, -0.1, 1.2)];
const DIRECTION: DVec3 = DVec3::new(0.5, 0.25, 1.0);
/// Where a parallel ray starts that passes the triangle outside the edge from B to C.
const OUTSIDE: DVec3 = DVec3::new(0.8, 0.75, 0.0);
const NAMES: [&str; 3] = ["A", "B", "C"];

pub fn make(_: Effort) -> Finished {
    let mut data = Table::new(["ray", "e_a", "e_b", "e_c", "t", "gap"]);
    let mut sees = |name: &str, origin: DVec3| {
        let ray = Ray::new(origin, DIRECTION);
        let flat = CORNERS.map(|corner| sheared(corner, &ray));
        let areas = parts(flat).map(|part| 2.0 * signed_area(part));
        let formula = edge_functions(flat);
        let differ = (0..3).map(|k| (areas[k] - formula[k]).abs()).fold(0.0, f64::max);
        let hit = intersect_triangle(CORNERS, &ray, &Shear::new(DIRECTION));
        let same_sign =
            formula.iter().all(|side| *side > 0.0) || formula.iter().all(|side| *side < 0.0);
        // How far the weighted mean of the corners is from the point at t.
        let sum: f64 = formula.iter().sum();
        let t = (0..3).map(|k| formula[k] * flat[k].z).sum::<f64>() / sum;
        let mean: DVec3 = (0..3).map(|k| formula[k] / sum * CORNERS[k]).sum();
        let gap = (mean - ray.at(t)).length();
        let as_in_code = hit.is_some() == same_sign
            && hit.is_none_or(|hit| (hit.t - t).abs() <= 4.0 * f64::EPSILON);
        let [a, b, c] = formula;
        data.push([name.into(), a.into(), b.into(), c.into(), t.into(), gap.into()]);
        (same_sign, differ.max(gap), as_in_code)
    };
    let (inside, outside) = (sees("inside", DVec3::ZERO), sees("outside", OUTSIDE));
    let largest = inside.1.max(outside.1);
    let holds = inside.0 && !outside.0 && inside.2 && outside.2 && largest <= 16.0 * f64::EPSILON;
    let claim = format!(
        "E_A, E_B and E_C are twice the signed areas of the drawn triangles, of one sign inside only; the corners' mean \
         by these weights is the ray's point at t, to {}.",
        number(largest)
    );
    let seen = |origin: DVec3, title: &'static str| {
        Drawing::new([-1.42, -1.6], [1.36, 1.96], 500.0, move |pen| {
            along_the_ray(pen, origin, title);
        })
    };
    let plate = Plate::new("1.16", "The shear and the signed areas", claim, holds)
        .panel(
            Row::new()
                .panel(1.15, Drawing::new([-0.3, -1.45], [3.1, 2.35], 500.0, the_shear))
                .panel(1.0, seen(DVec3::ZERO, "Seen along the ray: inside"))
                .panel(1.0, seen(OUTSIDE, "Outside")),
        )
        .note("Shear", "x − (dx/dz) z and y − (dy/dz) z, with the ray's origin at O = (0, 0, 0): every point of the ray \
             lands on the z axis, and z stays (times 1/dz it is t)")
        .note("Areas", "E_A = Cx By − Cy Bx is twice the area of O C B, E_B that of O A C, E_C that of O B A, positive if \
             the three turn counter-clockwise")
        .note("Method", "eq:ray-triangle; triangles with no area left, and rays in their plane, are misses");
    Finished { plate, data }
}

/// A corner where the ray is the z axis and starts at 0; z is the ray parameter.
fn sheared(corner: DVec3, ray: &Ray) -> DVec3 {
    let (v, d) = (corner - ray.origin, ray.direction);
    DVec3::new(v.x - d.x / d.z * v.z, v.y - d.y / d.z * v.z, v.z / d.z)
}

/// E_A, E_B and E_C by the formula.
fn edge_functions([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    [c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x]
}

/// The triangles whose areas they are.
fn parts(corners: [DVec3; 3]) -> [[Point; 3]; 3] {
    let o = [0.0, 0.0];
    let [a, b, c] = corners.map(|corner| [corner.x, corner.y]);
    [[o, c, b], [o, a, c], [o, b, a]]
}

/// Positive counter-clockwise, by the trapezoids under the sides.
fn signed_area(corners: [Point; 3]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let under = |(p, q): (&Point, &Point)| 0.5 * (p[0] - q[0]) * (p[1] + q[1]);
    corners.iter().zip(next).map(under).sum()
}

/// The directions in which the names of the corners stand.
const ASIDE: [f64; 3] = [3.6, 1.6, -0.3];

fn color(k: usize) -> Color {
    category_color([3, 1, 2][k])
}

/// z to the right and x upwards, before the shear and after.
fn the_shear(pen: &mut Pen<'_>) {
    let ray = Ray::new(DVec3::ZERO, DIRECTION);
    let side = |p: DVec3| -> Point { [p.z, p.x] };
    let after = CORNERS.map(|corner| side(sheared(corner, &ray)));
    let before = CORNERS.map(side);
    let end = 2.9;
    pen.line(&[[0.0, -1.2], [0.0, 1.9]], Stroke::new(MUTED, 1.4));
    let ghost = Style { fill: None, stroke: Some(Stroke::new(MUTED, 2.0).dashed(8.0, 6.0)) };
    pen.polygon(&before, ghost);
    pen.polygon(&after, Style::fill(category_color(4).with_alpha(80)).outlined(INK, 2.5));
    pen.line(&[[0.0, 0.0], side(end * DIRECTION)], Stroke::new(MUTED, 2.5).dashed(8.0, 6.0));
    for k in 0..3 {
        pen.arrow(before[k], after[k], Stroke::new(category_color(3), 2.5));
    }
    pen.vector([0.0, 0.0], [end, 0.0], "z", Stroke::new(INK, 3.5));
    pen.label(side(2.6 * DIRECTION), [0.0, 22.0], Text::new("ray", LABEL).color(MUTED));
    pen.label([0.75, 0.0], [0.0, -18.0], Text::new("ray, sheared", LABEL));
    pen.label([0.0, 1.9], [0.0, 14.0], Text::new("x", LABEL).bold());
    pen.point([0.0, 0.0], 3.6, "O", INK);
    for k in 0..3 {
        pen.point(after[k], [4.7, -0.4, 3.0][k], NAMES[k], INK);
    }
    pen.label([1.4, 2.25], [0.0, 0.0], Text::new("The shear, from the side", HEADING).bold());
}

/// x to the right and y upwards; the ray is the point O.
fn along_the_ray(pen: &mut Pen<'_>, origin: DVec3, title: &str) {
    let flat = CORNERS.map(|corner| sheared(corner, &Ray::new(origin, DIRECTION)));
    // The triangle stands still, and the ray moves.
    let still = |p: Point| [p[0] + origin.x, p[1] + origin.y];
    // What is taken away lies over what it is taken from.
    let mut areas: Vec<([Point; 3], usize)> = parts(flat).into_iter().zip(0..).collect();
    areas.sort_by_key(|&(part, _)| signed_area(part) < 0.0);
    for &(part, k) in &areas {
        let color = color(k);
        let alpha = if signed_area(part) < 0.0 { 120 } else { 75 };
        pen.polygon(&part.map(still), Style::fill(color.with_alpha(alpha)).outlined(color, 2.0));
    }
    let corners = flat.map(|corner| still([corner.x, corner.y]));
    pen.line(&[corners[0], corners[1], corners[2], corners[0]], Stroke::new(INK, 3.5));
    for &(part, k) in &areas {
        // A tenth nearer to O than the centroid, clear of the triangle's side.
        let middle: Point =
            std::array::from_fn(|axis| part.iter().map(|p| p[axis]).sum::<f64>() * 0.3);
        let sign = if signed_area(part) < 0.0 { "−" } else { "+" };
        let text = Text::new(format!("E_{} {sign}", NAMES[k]), LABEL).bold();
        pen.label(still(middle), [0.0, 0.0], text.color(color(k).for_text()));
    }
    for k in 0..3 {
        pen.point(corners[k], ASIDE[k], NAMES[k], INK);
    }
    pen.point([origin.x, origin.y], if origin == DVec3::ZERO { 5.1 } else { 0.8 }, "O", INK);
    pen.label([0.0, 1.86], [0.0, 0.0], Text::new(title, HEADING).bold());
}
