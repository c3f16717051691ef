//! Rays and shapes in a plane drawing, as walks and plates show them.

use glam::DVec3;
use lancer_core::geometry::Sphere;
use lancer_core::scene::{FaceId, Scene, SphereObject};
use lancer_figure::{
    Color, FAINT, LABEL, MUTED, Pen, Point, Rect, Stroke, Style, TICK, Text, category_color,
};

/// The most faces, and the most spheres, that are drawn one by one.
const MOST_SHAPES: usize = 1000;
/// The longest name that is written in full.
const LONGEST_NAME: usize = 40;
/// The most spheres that are drawn with the name of their material.
const MOST_NAMES: usize = 12;

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

    /// A line of the scene, dashed.
    pub fn dashed(&self, pen: &mut Pen<'_>, from: DVec3, to: DVec3, color: Color) {
        if let Some((from, to)) = self.segment(from, to) {
            pen.line(&[from, to], Stroke::new(color, 2.0).dashed(9.0, 7.0));
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
        let outlines = (0..mesh.faces.len() as u32).flat_map(|face| mesh.outline(FaceId(face)));
        let edges = outlines.flat_map(|outline| {
            let next = outline.iter().copied().cycle().skip(1);
            outline.iter().copied().zip(next).collect::<Vec<_>>()
        });
        edges.filter_map(|(a, b)| self.rect().clip(flat(a), flat(b))).collect()
    }
}

/// A name from a file, as a short line that cannot control a terminal.
pub fn printable(name: &str) -> String {
    let clean = |c: char| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c };
    let mut short: String = name.chars().take(LONGEST_NAME).map(clean).collect();
    if name.chars().nth(LONGEST_NAME).is_some() {
        short.push('…');
    }
    short
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
    use lancer_core::scene::{MaterialId, Mesh};

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
        let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)];
        let mut floor = Mesh::default();
        floor.positions.extend(corners.map(|(x, z)| DVec3::new(x, 0.0, z)));
        floor.push_face(MaterialId(0), &[[0, 1, 2], [0, 2, 3]]);
        let scene = Scene::of_mesh(floor);
        let mut edges = view.edges(&scene);
        edges.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap().then(a.1.partial_cmp(&b.1).unwrap()));
        assert_eq!(edges.len(), 4, "{edges:?}");
        assert!(edges.iter().all(|(a, b)| a[0] == b[0] || a[1] == b[1]), "{edges:?}");
    }
}
