//! Rays and shapes in a plane drawing, as the step-through and plate 1.6 show them.

use std::collections::HashMap;

use glam::DVec3;
use lancer_core::geometry::Sphere;
use lancer_core::scene::{Scene, Shape, SphereObject};
use lancer_figure::{
    Backdrop, Color, FAINT, INK, LABEL, MUTED, Pen, Point, Rect, Stroke, Style, TICK, Text, Tree,
    category_color,
};
use lancer_whitted::{RayEnd, RayKind, RayTree};

/// The most faces, and the most spheres, that are drawn one by one.
const MOST_SHAPES: usize = 1000;
/// The most spheres that are drawn with the name of their material.
const MOST_NAMES: usize = 12;

/// How a kind of ray is called, and its colour.
pub fn kind(kind: RayKind) -> (&'static str, Color) {
    match kind {
        RayKind::Primary => ("primary", INK),
        RayKind::Mirror => ("mirror", category_color(3)),
        RayKind::Refracted => ("refracted", category_color(0)),
    }
}

/// How the answer to a shadow ray is called, and its colour.
pub fn shadow(visible: bool) -> (&'static str, Color) {
    if visible { ("shadow ray, lit", category_color(1)) } else { ("shadow ray, blocked", MUTED) }
}

/// The tree of the calls from the `k`-th downwards; `label` gives the text of a node and of the edge that
/// leads to it.
pub fn calls(tree: &RayTree, k: usize, label: &dyn Fn(usize) -> [String; 2]) -> Tree {
    let node = &tree.nodes[k];
    let color = if matches!(node.end, RayEnd::Cut) { MUTED } else { kind(node.call.kind).1 };
    let children = (k + 1..tree.nodes.len()).filter(|&child| tree.nodes[child].parent == Some(k));
    let [name, _] = label(k);
    children.fold(Tree::new(name, color), |drawn, child| {
        let [_, edge] = label(child);
        drawn.child(edge, calls(tree, child, label))
    })
}

/// The side that a scene is drawn from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// From above: x to the right, −z upwards, away from an eye in front of the scene.
    Above,
    /// From the right: −z to the right, y upwards.
    Right,
}

impl Side {
    /// What is drawn, in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Above => "the scene from above",
            Self::Right => "the scene from its right side",
        }
    }

    /// Where a point of the scene lies in the drawing.
    pub fn flat(self, p: DVec3) -> Point {
        match self {
            Self::Above => [p.x, -p.z],
            Self::Right => [-p.z, p.y],
        }
    }
}

/// A rectangle of the drawing, seen from one side; what lies outside is cut off.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Where it is seen from.
    pub side: Side,
    /// The lower left corner.
    pub low: Point,
    /// The upper right corner.
    pub high: Point,
}

impl View {
    /// The view of a pixel's rays, from the side from which they look longest: what they meet is in sight,
    /// and all of the scene unless it is large.
    pub fn of_rays(scene: &Scene, tree: &RayTree) -> Self {
        let root = &tree.nodes[0];
        let mut paths = Vec::new();
        let mut ends = Vec::new();
        for node in &tree.nodes {
            if let RayEnd::Surface { hit, position, .. } = node.end {
                paths.push((node.call.ray.origin, position));
                ends.push((position, 0.0));
                if let Shape::Sphere(index) = scene.shape(hit.primitive) {
                    let Sphere { center, radius } = scene.spheres[index].shape;
                    ends.push((center, radius));
                }
            }
        }
        // A pixel that meets nothing is seen before the eye, as far as the middle of the picture.
        let distance =
            paths.first().map_or(scene.camera.look_at - root.call.ray.origin, |(a, b)| *b - *a);
        if ends.is_empty() {
            ends.push((root.call.ray.origin, 0.0));
        }
        let whole = scene.bounding_sphere().filter(|s| s.radius < distance.length());
        if whole.is_some() {
            ends.extend(scene.mesh.positions.iter().map(|&p| (p, 0.0)));
            ends.extend(scene.spheres.iter().map(|s| (s.shape.center, s.shape.radius)));
        }
        let length = |side: Side| -> f64 {
            let run = |(a, b): &(DVec3, DVec3)| {
                let [x, y] = side.flat(*b - *a);
                x.hypot(y)
            };
            paths.iter().map(run).sum()
        };
        let side =
            if length(Side::Right) > length(Side::Above) { Side::Right } else { Side::Above };
        let corner = |sign: f64| -> Point {
            let reach = |axis: usize| {
                let end = |(p, radius): &(DVec3, f64)| sign * side.flat(*p)[axis] + radius;
                let least = 0.1 * distance.length();
                sign * (ends.iter().map(end).fold(f64::NEG_INFINITY, f64::max) + least)
            };
            [reach(0), reach(1)]
        };
        let [low, high] = Backdrop::frame(corner(-1.0), corner(1.0));
        Self { side, low, high }
    }

    /// What is in sight.
    pub fn rect(&self) -> Rect {
        Rect::new(self.low[0], self.low[1], self.high[0] - self.low[0], self.high[1] - self.low[1])
    }

    /// A line of the scene as far as it is in sight.
    pub fn segment(&self, from: DVec3, to: DVec3) -> Option<(Point, Point)> {
        self.rect().clip(self.side.flat(from), self.side.flat(to))
    }

    /// A point far beyond the drawing, seen from a point in it.
    pub fn beyond(&self, from: DVec3, direction: DVec3) -> DVec3 {
        from + 10.0 * (self.rect().width + self.rect().height) * direction
    }

    /// An arrow from one point of the scene to another.
    pub fn arrow(&self, pen: &mut Pen<'_>, from: DVec3, to: DVec3, stroke: Stroke) {
        if let Some((from, to)) = self.segment(from, to) {
            pen.arrow(from, to, stroke);
        }
    }

    /// A direction as an arrow that is short in the drawing if its length is 1, with its letter at the tip.
    pub fn direction(
        &self,
        pen: &mut Pen<'_>,
        from: DVec3,
        direction: DVec3,
        letter: &str,
        stroke: Stroke,
    ) {
        let short = 0.09 * self.rect().height;
        self.arrow(pen, from, from + short * direction, stroke);
        let tip = self.side.flat(from + short * (direction + 0.4 * direction.normalize()));
        if self.rect().clip(tip, tip).is_some() {
            pen.label(
                tip,
                [0.0, 0.0],
                Text::new(letter, LABEL).bold().color(stroke.color.for_text()),
            );
        }
    }

    /// A ray as an arrow with the number of its call.
    pub fn ray(&self, pen: &mut Pen<'_>, from: DVec3, to: DVec3, color: Color, number: usize) {
        if let Some((from, to)) = self.segment(from, to) {
            pen.arrow(from, to, Stroke::new(color, 2.5));
            let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
            let text = Text::new(number.to_string(), LABEL).bold().color(color.for_text());
            pen.label(middle, [0.0, 0.0], text);
        }
    }

    /// A shadow ray as a dashed line to its lamp.
    pub fn shadow(&self, pen: &mut Pen<'_>, from: DVec3, to: DVec3, visible: bool) {
        if let Some((from, to)) = self.segment(from, to) {
            pen.line(&[from, to], Stroke::new(shadow(visible).1, 2.0).dashed(9.0, 7.0));
        }
    }

    /// A sphere with a name.
    pub fn sphere(&self, pen: &mut Pen<'_>, sphere: &Sphere, name: &str, color: Color) {
        let center = self.side.flat(sphere.center);
        let style = Style::fill(color.with_alpha(60)).outlined(color, 2.0);
        pen.circle(center, sphere.radius, style);
        let foot = [center[0], center[1] - sphere.radius];
        if self.rect().clip(foot, foot).is_some() {
            pen.label(foot, [0.0, -14.0], Text::new(name, TICK).color(MUTED));
        }
    }

    /// The outlines of a scene's shapes: polygons, of a large mesh its hull, and the largest spheres.
    /// `materials` are the names of its materials.
    pub fn outlines(&self, scene: &Scene, materials: &[String]) -> impl Fn(&mut Pen<'_>) + use<> {
        let view = *self;
        let edges: Vec<(Point, Point)> = self.edges(scene);
        let mut largest: Vec<_> = scene.spheres.iter().collect();
        largest.sort_by(|a, b| b.shape.radius.total_cmp(&a.shape.radius));
        largest.truncate(MOST_SHAPES);
        let named = |s: &&SphereObject| (s.shape, materials[s.material.0 as usize].clone());
        let spheres: Vec<(Sphere, String)> = largest.iter().map(named).collect();
        let lamps: Vec<Point> =
            scene.point_sources().iter().map(|lamp| self.side.flat(lamp.position)).collect();
        move |pen| {
            for &(from, to) in &edges {
                pen.line(&[from, to], Stroke::new(MUTED.mix(Color::WHITE, 0.4), 1.6));
            }
            for (sphere, name) in &spheres {
                let name = if spheres.len() <= MOST_NAMES { name } else { "" };
                view.sphere(pen, sphere, name, MUTED.mix(FAINT, 0.4));
            }
            for &lamp in &lamps {
                pen.dot(lamp, 9.0, category_color(7));
                pen.dot(lamp, 4.0, category_color(1));
            }
        }
    }

    /// The borders of the polygons that are in sight; of a large mesh its hull.
    fn edges(&self, scene: &Scene) -> Vec<(Point, Point)> {
        let mesh = &scene.mesh;
        let flat = |index: u32| self.side.flat(mesh.positions[index as usize]);
        if mesh.faces.len() > MOST_SHAPES {
            let hull = hull(mesh.positions.iter().map(|&p| self.side.flat(p)).collect());
            let next = hull.iter().cycle().skip(1);
            return hull.iter().copied().zip(next.copied()).collect();
        }
        // A border edge belongs to one triangle of its face only.
        let mut uses: HashMap<_, u32> = HashMap::new();
        let edges = || {
            mesh.triangles.iter().flat_map(|triangle| {
                let [a, b, c] = triangle.vertices;
                [(a, b), (b, c), (c, a)].map(|(a, b)| (triangle.face.0, a.min(b), a.max(b)))
            })
        };
        for edge in edges() {
            *uses.entry(edge).or_default() += 1;
        }
        let borders = edges().filter(|edge| uses[edge] == 1);
        borders.filter_map(|(_, a, b)| self.rect().clip(flat(a), flat(b))).collect()
    }
}

/// The corners of the convex hull, counter-clockwise (Andrew's monotone chain).
fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let half = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b[0] - a[0]) * (p[1] - a[1]) <= (b[1] - a[1]) * (p[0] - a[0])
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut lower = half(&mut points.iter().copied());
    lower.extend(half(&mut points.iter().rev().copied()));
    lower
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;

    #[test]
    fn a_hull_leaves_out_what_is_inside_and_on_its_edges() {
        let points = vec![[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 0.5], [2.0, 2.0], [0.0, 2.0]];
        assert_eq!(hull(points), [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
    }

    #[test]
    fn the_drawing_keeps_right_and_up() {
        let p = DVec3::new(1.0, 2.0, 3.0);
        assert_eq!(Side::Above.flat(p), [1.0, -3.0]);
        assert_eq!(Side::Right.flat(p), [-3.0, 2.0]);
    }

    #[test]
    fn a_face_has_its_border_and_no_diagonal() {
        let view = View { side: Side::Above, low: [-9.0, -9.0], high: [9.0, 9.0] };
        let mut scene = scenes::room();
        // The floor, a rectangle cut into two triangles, comes first.
        scene.mesh.triangles.truncate(2);
        let mut edges = view.edges(&scene);
        edges.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap().then(a.1.partial_cmp(&b.1).unwrap()));
        assert_eq!(edges.len(), 4, "{edges:?}");
        assert!(edges.iter().all(|(a, b)| a[0] == b[0] || a[1] == b[1]), "{edges:?}");
    }
}
