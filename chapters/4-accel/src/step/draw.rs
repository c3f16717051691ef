//! The drawings beside a walk: boxes, cells and primitives, seen from one side.

use glam::DVec3;
use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};
use lancer_core::intersector::Hit;
use lancer_core::scene::{PrimitiveId, Scene, Shape};
use lancer_figure::{
    Backdrop, Color, FAINT, INK, LABEL, MUTED, Pen, Point, Stroke, Style, Text, category_color,
};
use lancer_lesson::view::{Side, View};

/// The most vertices of a mesh that are drawn as dots.
const MOST_DOTS: usize = 1500;
/// The most boxes, or primitives, that one step draws.
const MOST_SHAPES: usize = 200;

/// The colour of the boxes and cells on the ray's way.
pub fn met() -> Color {
    category_color(0)
}

/// The colour of primitives that are hit.
pub fn hit() -> Color {
    category_color(3)
}

/// A scene is not shown as a whole if it is this many times as large as the ray's way to its hit is long.
const LARGE: f64 = 50.0;

/// The view of a ray's way through a scene, from the side from which it takes up more room: all of the scene,
/// and the eye too if the ray passes it by; of a large scene only the way.
pub fn view(scene: &Scene, ray: &Ray, answer: Option<Hit>) -> View {
    let bounds = scene.bounds();
    let Bounds3 { min, max } = bounds;
    let eye = ray.origin;
    let end = answer.map_or(scene.camera.look_at, |hit| ray.at(hit.t));
    let mut ends = vec![end];
    if bounds.is_empty() || (max - min).length() > LARGE * (end - eye).length() {
        ends.push(eye);
    } else {
        ends.extend([min, max]);
        if Slabs::new(ray).cross(min, max, Interval::POSITIVE).is_none() {
            ends.push(eye);
        }
    }
    let shown = Bounds3::of_points(ends);
    let shown = shown.grown(0.08 * (shown.max - shown.min).length());
    let area = |side: Side| {
        let [width, height] = side.flat(shown.max - shown.min);
        (width * height).abs()
    };
    let side = if area(Side::Right) > area(Side::Above) { Side::Right } else { Side::Above };
    let [a, b] = [shown.min, shown.max].map(|corner| side.flat(corner));
    let [low, high] =
        Backdrop::frame([a[0].min(b[0]), a[1].min(b[1])], [a[0].max(b[0]), a[1].max(b[1])]);
    View { side, low, high }
}

/// Draws a ray up to its hit, over the vertices in sight.
pub fn ray(
    view: View,
    scene: &Scene,
    ray: &Ray,
    answer: Option<Hit>,
) -> impl Fn(&mut Pen<'_>) + use<> {
    let in_sight = |&p: &Point| view.rect().clip(p, p).is_some();
    let dots: Vec<Point> =
        scene.mesh.positions.iter().map(|&p| view.side.flat(p)).filter(in_sight).collect();
    let apart = dots.len().div_ceil(MOST_DOTS).max(1);
    let dots: Vec<Point> = dots.into_iter().step_by(apart).collect();
    let from = ray.origin;
    let to = answer.map_or(view.beyond(from, ray.direction), |hit| ray.at(hit.t));
    move |pen| {
        for &dot in &dots {
            pen.dot(dot, 1.6, MUTED.mix(FAINT, 0.6));
        }
        view.arrow(pen, from, to, Stroke::new(INK, 2.5));
    }
}

/// The rectangle in which a box is seen, from its lower left to its upper right corner; none of an empty or
/// infinite box.
fn rectangle(view: View, Bounds3 { min, max }: Bounds3) -> Option<[Point; 2]> {
    let [a, b] = [min, max].map(|corner| view.side.flat(corner));
    let seen = min.is_finite() && max.is_finite() && min.cmple(max).all();
    seen.then(|| [[a[0].min(b[0]), a[1].min(b[1])], [a[0].max(b[0]), a[1].max(b[1])]])
}

/// The edges of a polygon, as far as they are in sight.
fn outline(view: View, pen: &mut Pen<'_>, corners: &[Point], stroke: Stroke) {
    let next = corners.iter().cycle().skip(1);
    for (&from, &to) in corners.iter().zip(next) {
        if let Some((from, to)) = view.rect().clip(from, to) {
            pen.line(&[from, to], stroke);
        }
    }
}

fn frame(view: View, pen: &mut Pen<'_>, bounds: Bounds3, stroke: Stroke) {
    if let Some([low, high]) = rectangle(view, bounds) {
        outline(view, pen, &[low, [high[0], low[1]], high, [low[0], high[1]]], stroke);
    }
}

/// Draws a box or cell on the ray's way.
pub fn visited(view: View, bounds: Bounds3) -> impl Fn(&mut Pen<'_>) {
    move |pen| frame(view, pen, bounds, Stroke::new(met(), 1.6))
}

/// Fills a box or cell, and writes its number.
pub fn pointed_out(view: View, bounds: Bounds3, number: u64) -> impl Fn(&mut Pen<'_>) {
    move |pen| {
        let Some([low, high]) = rectangle(view, bounds) else { return };
        let low = [low[0].max(view.low[0]), low[1].max(view.low[1])];
        let high = [high[0].min(view.high[0]), high[1].min(view.high[1])];
        if low[0] > high[0] || low[1] > high[1] {
            return;
        }
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        pen.polygon(&corners, Style::fill(met().with_alpha(36)));
        let middle = 0.5 * (low[0] + high[0]);
        let height = high[1] - low[1];
        // The number would hide a low box: it stands on top of that.
        let (at, offset) = if height * pen.scale() < 3.0 * LABEL {
            ([middle, high[1]], [0.0, 0.8 * LABEL])
        } else {
            ([middle, low[1] + 0.5 * height], [0.0, 0.0])
        };
        let text = Text::new(number.to_string(), LABEL).bold().color(met().for_text());
        pen.label(at, offset, text);
    }
}

/// Draws boxes beside the ray.
pub fn missed(view: View, boxes: &[Bounds3]) -> impl Fn(&mut Pen<'_>) + use<> {
    let boxes: Vec<Bounds3> = boxes.iter().copied().take(MOST_SHAPES).collect();
    move |pen| {
        for &bounds in &boxes {
            frame(view, pen, bounds, Stroke::new(MUTED, 1.4).dashed(7.0, 5.0));
        }
    }
}

/// Draws primitives in a colour; of many, some of them all over the list.
pub fn primitives(
    view: View,
    scene: &Scene,
    which: &[PrimitiveId],
    color: Color,
) -> impl Fn(&mut Pen<'_>) + use<> {
    let (mut polygons, mut discs) = (Vec::new(), Vec::new());
    for &primitive in which.iter().step_by(which.len().div_ceil(MOST_SHAPES).max(1)) {
        match scene.shape(primitive) {
            Shape::Triangle(index) => {
                polygons.push(scene.mesh.corners(index).map(|p: DVec3| view.side.flat(p)));
            }
            Shape::Sphere(index) => {
                let sphere = scene.spheres[index].shape;
                discs.push((view.side.flat(sphere.center), sphere.radius));
            }
        }
    }
    move |pen| {
        for corners in &polygons {
            outline(view, pen, corners, Stroke::new(color, 2.0));
        }
        for &(center, radius) in &discs {
            pen.circle(center, radius, Style::outline(color, 2.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use lancer_core::image::ImageSize;
    use lancer_core::intersector::{Intersector, LinearScan};

    use super::*;
    use crate::scenes::family;

    /// The hit is in sight; with it the whole scene, or the eye where the scene is a thousand times as large.
    #[test]
    fn the_view_shows_the_rays_way() {
        for (name, is_large) in [("town", false), ("scan", false), ("stadium", true)] {
            let scene = family(name).scene(1000);
            let ray = scene.camera.primary_rays(ImageSize::new(2, 2)).through(1.0, 1.0);
            let hit = LinearScan::new(&scene).closest_hit(&ray, Interval::POSITIVE);
            let view = view(&scene, &ray, hit);
            let sees = |p: DVec3| {
                let p = view.side.flat(p);
                view.rect().clip(p, p).is_some()
            };
            let Bounds3 { min, max } = scene.bounds();
            assert!(sees(ray.at(hit.unwrap().t)), "{name}");
            assert_eq!(sees(min) && sees(max), !is_large, "{name}");
            assert!(!is_large || sees(ray.origin), "{name}");
            assert!(name != "town" || view.side == Side::Above, "a flat scene is seen from above");
        }
    }
}
