//! Diagrams: drawing in world units, with the arrows, arcs and hatched surfaces of optics.

use crate::canvas::Canvas;
use crate::geometry::{Point, Rect, along};
use crate::plate::Panel;
use crate::shape::{Color, Stroke, Style, Text};
use crate::style::{CAP_HEIGHT, LABEL, MUTED};

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
        let (sin, cos) = ((from + to) / 2.0).sin_cos();
        let text = Text::new(label, LABEL).color(color.for_text());
        // Its box must clear the arc whatever the direction: half its diagonal away at most.
        let away = radius + 8.0 + (text.width() / 2.0 * cos.abs()).max(LABEL / 2.0 * sin.abs());
        self.label(center, [away * cos, away * sin], text);
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
    use super::*;

    #[test]
    fn the_world_keeps_its_proportions() {
        let mut canvas = Canvas::new(400.0, 200.0);
        let pen =
            Pen::new(&mut canvas, Rect::new(0.0, 0.0, 400.0, 200.0), [-1.0, -1.0], [1.0, 1.0]);
        assert_eq!(pen.at([0.0, 0.0]), [200.0, 100.0]);
        assert_eq!(pen.at([1.0, 1.0]), [300.0, 0.0], "y upwards, one unit for both axes");
        assert_eq!(pen.scale(), 100.0);
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
