//! Diagrams: drawing in world units, with the arrows, arcs and hatched surfaces of optics.

use crate::canvas::Canvas;
use crate::geometry::{Point, Rect, along};
use crate::plate::Panel;
use crate::shape::{Color, Stroke, Style, Text};
use crate::style::{CAP_HEIGHT, LABEL, MUTED};

/// Px between a thing and its label.
const BETWEEN: f64 = 8.0;

/// A panel drawn by a function with a [`Pen`].
pub struct Drawing {
    low: Point,
    high: Point,
    height: f64,
    draw: Box<dyn Fn(&mut Pen<'_>)>,
}

impl Drawing {
    /// A panel `height` px tall showing the world from `low` to `high` (y upwards), as large as fits, with
    /// the same unit along both axes.
    pub fn new(
        low: Point,
        high: Point,
        height: f64,
        draw: impl Fn(&mut Pen<'_>) + 'static,
    ) -> Self {
        Self { low, high, height, draw: Box::new(draw) }
    }
}

impl Panel for Drawing {
    fn height(&self, _width: f64) -> f64 {
        self.height
    }

    fn draw(&self, canvas: &mut Canvas, rect: Rect) {
        (self.draw)(&mut Pen::new(canvas, rect, self.low, self.high));
    }
}

/// Draws in world units (x to the right, y upwards) on a part of a canvas; sizes in px stay in px.
pub struct Pen<'a> {
    canvas: &'a mut Canvas,
    scale: f64,
    middle: Point,
    center: Point,
}

impl<'a> Pen<'a> {
    /// A pen that shows the world from `low` to `high` in the middle of `rect`, as large as fits.
    pub fn new(canvas: &'a mut Canvas, rect: Rect, low: Point, high: Point) -> Self {
        let scale = (rect.width / (high[0] - low[0])).min(rect.height / (high[1] - low[1]));
        Self { canvas, scale, middle: along(low, high, 0.5), center: rect.center() }
    }

    /// Where a point of the world lies on the canvas.
    pub fn at(&self, [x, y]: Point) -> Point {
        [
            self.center[0] + (x - self.middle[0]) * self.scale,
            self.center[1] - (y - self.middle[1]) * self.scale,
        ]
    }

    /// Canvas px of one world unit.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The canvas, for what the pen has no word for.
    pub fn canvas(&mut self) -> &mut Canvas {
        self.canvas
    }

    /// A line through all points.
    pub fn line(&mut self, points: &[Point], stroke: Stroke) {
        let points = points.iter().map(|&point| self.at(point)).collect();
        self.canvas.polyline(points, stroke);
    }

    /// A closed polygon.
    pub fn polygon(&mut self, points: &[Point], style: Style) {
        let points = points.iter().map(|&point| self.at(point)).collect();
        self.canvas.polygon(points, style);
    }

    /// A circle whose radius is in world units.
    pub fn circle(&mut self, center: Point, radius: f64, style: Style) {
        self.canvas.circle(self.at(center), radius * self.scale, style);
    }

    /// A disc whose radius is in px: a point of the world.
    pub fn dot(&mut self, center: Point, radius: f64, color: Color) {
        self.canvas.circle(self.at(center), radius, Style::fill(color));
    }

    /// An arrow.
    pub fn arrow(&mut self, from: Point, to: Point, stroke: Stroke) {
        self.canvas.arrow(self.at(from), self.at(to), stroke);
    }

    /// Text with a halo, its middle `offset` px (x to the right, y upwards) from the point `at`.
    pub fn label(&mut self, at: Point, offset: Point, text: Text) {
        let [x, y] = self.at(at);
        let baseline = y - offset[1] + CAP_HEIGHT / 2.0 * text.size;
        self.canvas.text([x + offset[0], baseline], text.centered().halo());
    }

    /// A vector: an arrow with its letter beyond the tip; nothing when the two points coincide.
    pub fn vector(&mut self, from: Point, to: Point, letter: &str, stroke: Stroke) {
        let run = [to[0] - from[0], to[1] - from[1]];
        if run == [0.0, 0.0] {
            return;
        }
        self.arrow(from, to, stroke);
        let text = Text::new(letter, LABEL).bold().color(stroke.color.for_text());
        self.beyond(to, run[1].atan2(run[0]), BETWEEN, text);
    }

    /// A point of the world with its name, which stands in the direction `towards` from it (radians,
    /// counter-clockwise from the right).
    pub fn point(&mut self, at: Point, towards: f64, name: &str, color: Color) {
        const RADIUS: f64 = 5.5;
        self.dot(at, RADIUS, color);
        let text = Text::new(name, LABEL).color(color.for_text());
        self.beyond(at, towards, RADIUS + BETWEEN, text);
    }

    /// The measure of the way from one point to another: a thin line between two ticks, `aside` px to its
    /// left as seen going there (to its right if negative), with its label outside its middle.
    pub fn span(&mut self, from: Point, to: Point, aside: f64, label: &str, color: Color) {
        const TICK: f64 = 6.0;
        let (a, b) = (self.at(from), self.at(to));
        let run = [b[0] - a[0], b[1] - a[1]];
        let length = (run[0] * run[0] + run[1] * run[1]).sqrt();
        if length == 0.0 {
            return;
        }
        // On the canvas, y downwards, the left side of (dx, dy) is (dy, −dx).
        let left = [run[1] / length, -run[0] / length];
        let off = |p: Point, by: f64| [p[0] + by * left[0], p[1] + by * left[1]];
        let stroke = Stroke::new(color, 1.8);
        self.canvas.line(off(a, aside), off(b, aside), stroke);
        for end in [a, b] {
            self.canvas.line(off(end, aside - TICK), off(end, aside + TICK), stroke);
        }
        let outside = left.map(|c| c * aside.signum());
        let text = Text::new(label, LABEL).color(color.for_text());
        let towards = (-outside[1]).atan2(outside[0]);
        self.beyond(along(from, to, 0.5), towards, aside.abs() + BETWEEN, text);
    }

    /// Text in the direction `towards` from a point of the world, its box `gap` px or a little more from it.
    fn beyond(&mut self, at: Point, towards: f64, gap: f64, text: Text) {
        let (sin, cos) = towards.sin_cos();
        // Half the box's diagonal at most.
        let half = (text.width() / 2.0 * cos.abs()).max(text.size / 2.0 * sin.abs());
        self.label(at, [(gap + half) * cos, (gap + half) * sin], text);
    }

    /// An arc of `radius` px around `center` from one angle to another (radians, counter-clockwise from
    /// the right), with its label outside its middle.
    pub fn angle(
        &mut self,
        center: Point,
        from: f64,
        to: f64,
        radius: f64,
        label: &str,
        color: Color,
    ) {
        const STEPS: u32 = 32;
        let [x, y] = self.at(center);
        let points = (0..=STEPS)
            .map(|i| {
                let (sin, cos) = (from + (to - from) * f64::from(i) / f64::from(STEPS)).sin_cos();
                [x + radius * cos, y - radius * sin]
            })
            .collect();
        self.canvas.polyline(points, Stroke::new(color, 2.0));
        let text = Text::new(label, LABEL).color(color.for_text());
        self.beyond(center, (from + to) / 2.0, radius + BETWEEN, text);
    }

    /// The mark of a right angle at `corner`, `side` px wide, between the directions to two points.
    pub fn right_angle(&mut self, corner: Point, [a, b]: [Point; 2], side: f64, color: Color) {
        let c = self.at(corner);
        let [p, q] = [a, b].map(|end| {
            let end = self.at(end);
            let length = ((end[0] - c[0]).powi(2) + (end[1] - c[1]).powi(2)).sqrt();
            along(c, end, side / length)
        });
        let r = [p[0] + q[0] - c[0], p[1] + q[1] - c[1]];
        self.canvas.polyline(vec![p, r, q], Stroke::new(color, 1.8));
    }

    /// A surface from `from` to `to`, hatched on its right side as seen going there.
    pub fn surface(&mut self, from: Point, to: Point) {
        const APART: f64 = 13.0;
        const LENGTH: f64 = 13.0;
        let (a, b) = (self.at(from), self.at(to));
        let run = [b[0] - a[0], b[1] - a[1]];
        let length = (run[0] * run[0] + run[1] * run[1]).sqrt();
        let ahead = run.map(|r| r / length);
        // On the canvas, y downwards, the right side of (dx, dy) is (−dy, dx).
        let back = [-ahead[1] - ahead[0], ahead[0] - ahead[1]].map(|c| c * LENGTH / 2f64.sqrt());
        let hatch = Stroke::new(MUTED, 1.4);
        for i in 1..=(length / APART) as u32 {
            let foot = along(a, b, f64::from(i) * APART / length);
            self.canvas.line(foot, [foot[0] + back[0], foot[1] + back[1]], hatch);
        }
        self.canvas.line(a, b, Stroke::new(crate::INK, 3.0));
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::canvas::Primitive;

    #[test]
    fn the_world_keeps_its_proportions() {
        let mut canvas = Canvas::new(400.0, 200.0);
        let pen =
            Pen::new(&mut canvas, Rect::new(0.0, 0.0, 400.0, 200.0), [-1.0, -1.0], [1.0, 1.0]);
        assert_eq!(pen.at([0.0, 0.0]), [200.0, 100.0]);
        assert_eq!(pen.at([1.0, 1.0]), [300.0, 0.0], "y upwards, one unit for both axes");
        assert_eq!(pen.scale(), 100.0);
    }

    /// The texts of a drawing of the square from 0 to 1 on 100 × 100 px, with the middles of their boxes.
    fn labels(draw: impl Fn(&mut Pen<'_>)) -> Vec<(String, Point)> {
        let mut canvas = Canvas::new(100.0, 100.0);
        draw(&mut Pen::new(&mut canvas, Rect::new(0.0, 0.0, 100.0, 100.0), [0.0, 0.0], [1.0, 1.0]));
        let middle = |primitive: &Primitive| match primitive {
            Primitive::Text { at, text } => {
                Some((text.content.clone(), [at[0], at[1] - CAP_HEIGHT / 2.0 * text.size]))
            }
            _ => None,
        };
        canvas.primitives.iter().filter_map(middle).collect()
    }

    #[test]
    fn a_vectors_letter_continues_it() {
        let stroke = Stroke::new(crate::INK, 2.0);
        let at = |to| labels(|pen| pen.vector([0.5, 0.5], to, "N", stroke))[0].1;
        let [x, y] = at([0.5, 0.8]);
        // Upwards: the tip is at (50, 20), half a line of 19 px and the gap of 8 above it.
        assert!((x - 50.0).abs() < 1e-9 && (y - (20.0 - 8.0 - 9.5)).abs() < 1e-9, "{x} {y}");
        let [x, y] = at([0.2, 0.5]);
        assert!(x < 20.0 - 8.0 && (y - 50.0).abs() < 1e-9, "{x} {y}");
        assert_eq!(labels(|pen| pen.vector([0.5, 0.5], [0.5, 0.5], "N", stroke)), []);
    }

    #[test]
    fn a_name_and_a_measure_stand_where_they_are_told() {
        let [x, y] = labels(|pen| pen.point([0.5, 0.5], PI, "P", crate::INK))[0].1;
        assert!(x < 50.0 - 8.0 && (y - 50.0).abs() < 1e-9, "{x} {y}");
        // Going to the right, the left side is above.
        for (aside, above) in [(10.0, true), (-10.0, false)] {
            let span = |pen: &mut Pen<'_>| {
                pen.span([0.2, 0.5], [0.8, 0.5], aside, "d", crate::INK);
            };
            let [x, y] = labels(span)[0].1;
            assert!((x - 50.0).abs() < 1e-9, "{x}");
            assert!(
                ((y - 50.0).abs() - (10.0 + 8.0 + 9.5)).abs() < 1e-9 && (y < 50.0) == above,
                "{y}"
            );
        }
    }

    #[test]
    fn a_right_angle_is_a_square() {
        let mut canvas = Canvas::new(100.0, 100.0);
        Pen::new(&mut canvas, Rect::new(0.0, 0.0, 100.0, 100.0), [0.0, 0.0], [1.0, 1.0])
            .right_angle([0.5, 0.5], [[0.9, 0.5], [0.5, 0.6]], 12.0, crate::INK);
        let Primitive::Line { points, .. } = &canvas.primitives[0] else { panic!("no line") };
        assert_eq!(points[..], [[62.0, 50.0], [62.0, 38.0], [50.0, 38.0]]);
    }

    #[test]
    fn hatching_lies_below_a_surface_drawn_to_the_right() {
        let mut canvas = Canvas::new(100.0, 100.0);
        Pen::new(&mut canvas, Rect::new(0.0, 0.0, 100.0, 100.0), [0.0, 0.0], [1.0, 1.0])
            .surface([0.0, 0.5], [1.0, 0.5]);
        let svg = canvas.to_svg();
        let ends: Vec<f64> = svg
            .lines()
            .filter(|line| line.starts_with("<path d=\"M") && line.contains("1.4"))
            .map(|line| {
                let data = line.split('"').nth(1).unwrap();
                data.rsplit(' ').next().unwrap().parse().unwrap()
            })
            .collect();
        assert_eq!(ends.len(), 7);
        assert!(ends.iter().all(|&y| y > 50.0), "{ends:?}");
    }
}
