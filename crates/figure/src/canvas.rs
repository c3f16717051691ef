//! The list of primitives that both the PNG and the SVG are drawn from.

use crate::font::missing_glyphs;
use crate::geometry::{Point, Rect, along};
use crate::picture::Picture;
use crate::shape::{Stroke, Style, Text};
use crate::style::SMALLEST;
use crate::{raster, svg};

/// One drawn thing.
#[derive(Clone, Debug)]
pub(crate) enum Primitive {
    Line { points: Vec<Point>, stroke: Stroke },
    Polygon { points: Vec<Point>, style: Style },
    Rect { rect: Rect, radius: f64, style: Style },
    Circle { center: Point, radius: f64, style: Style },
    Text { at: Point, text: Text },
    Picture { rect: Rect, picture: Picture },
}

/// Something that makes a canvas unfit to be shown.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// Two lines of text overlap.
    Overlap(String, String),
    /// A line of text reaches over the canvas's edge.
    Outside(String),
    /// A line of text is smaller than [`SMALLEST`].
    TooSmall(String),
    /// The font lacks characters of a line of text.
    MissingGlyphs(Vec<char>),
}

/// A white sheet on which primitives are drawn one over another, in abstract px.
#[derive(Clone, Debug)]
pub struct Canvas {
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) title: String,
    pub(crate) description: String,
    pub(crate) primitives: Vec<Primitive>,
}

impl Canvas {
    /// An empty sheet of `width` × `height` px, both positive.
    pub fn new(width: f64, height: f64) -> Self {
        assert!(width > 0.0 && height > 0.0, "a canvas has an area");
        Self {
            width,
            height,
            title: String::new(),
            description: String::new(),
            primitives: Vec::new(),
        }
    }

    /// Says what is drawn, for those who cannot see it: the SVG's `<title>` and `<desc>`.
    pub fn describe(&mut self, title: impl Into<String>, description: impl Into<String>) {
        self.title = title.into();
        self.description = description.into();
    }

    /// Width in px.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Height in px.
    pub fn height(&self) -> f64 {
        self.height
    }

    /// A straight line.
    pub fn line(&mut self, from: Point, to: Point, stroke: Stroke) {
        self.polyline(vec![from, to], stroke);
    }

    /// A line through all `points`, with round joints.
    pub fn polyline(&mut self, points: Vec<Point>, stroke: Stroke) {
        self.primitives.push(Primitive::Line { points, stroke });
    }

    /// A closed polygon.
    pub fn polygon(&mut self, points: Vec<Point>, style: Style) {
        self.primitives.push(Primitive::Polygon { points, style });
    }

    /// A rectangle.
    pub fn rect(&mut self, rect: Rect, style: Style) {
        self.rounded_rect(rect, 0.0, style);
    }

    /// A rectangle with corners rounded by `radius` px.
    pub fn rounded_rect(&mut self, rect: Rect, radius: f64, style: Style) {
        self.primitives.push(Primitive::Rect { rect, radius, style });
    }

    /// A circle.
    pub fn circle(&mut self, center: Point, radius: f64, style: Style) {
        self.primitives.push(Primitive::Circle { center, radius, style });
    }

    /// A line with an arrow head at `to`; nothing when the two points coincide.
    pub fn arrow(&mut self, from: Point, to: Point, stroke: Stroke) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = (dx * dx + dy * dy).sqrt();
        if length == 0.0 {
            return;
        }
        let head = (8.0 + 2.5 * stroke.width).min(length);
        let half = 0.38 * head;
        let neck = along(to, from, head / length);
        let side = [-dy / length * half, dx / length * half];
        self.line(from, along(to, from, 0.8 * head / length), stroke);
        let barb = |sign: f64| [neck[0] + sign * side[0], neck[1] + sign * side[1]];
        self.polygon(vec![to, barb(1.0), barb(-1.0)], Style::fill(stroke.color));
    }

    /// One line of text whose baseline passes through `at`.
    pub fn text(&mut self, at: Point, text: Text) {
        self.primitives.push(Primitive::Text { at, text });
    }

    /// A picture filling `rect`; its pixels stay crisp when it is enlarged.
    pub fn picture(&mut self, rect: Rect, picture: Picture) {
        self.primitives.push(Primitive::Picture { rect, picture });
    }

    /// What makes the canvas unfit to be shown; figures' tests ask that there be nothing.
    pub fn faults(&self) -> Vec<Fault> {
        // Text may lean over its neighbour's empty ascent or descent by this much.
        const SLACK: f64 = 1.5;
        let sheet = Rect::new(0.0, 0.0, self.width, self.height);
        let mut faults = Vec::new();
        let mut seen: Vec<(Rect, &str)> = Vec::new();
        for primitive in &self.primitives {
            let Primitive::Text { at, text } = primitive else { continue };
            if text.content.trim().is_empty() {
                continue;
            }
            let rect = text.rect(*at).grown(-SLACK);
            if !sheet.contains(&rect) {
                faults.push(Fault::Outside(text.content.clone()));
            }
            if text.size < SMALLEST {
                faults.push(Fault::TooSmall(text.content.clone()));
            }
            let missing = missing_glyphs(&text.content);
            if !missing.is_empty() {
                faults.push(Fault::MissingGlyphs(missing));
            }
            for (other, content) in &seen {
                if rect.overlaps(other) {
                    faults.push(Fault::Overlap((*content).to_owned(), text.content.clone()));
                }
            }
            seen.push((rect, &text.content));
        }
        faults
    }

    /// The canvas as an SVG document, text as outlines, pictures embedded.
    pub fn to_svg(&self) -> String {
        svg::document(self)
    }

    /// The canvas as a PNG file, `scale` pixels to the px (1 for the screen, 2 for print).
    pub fn to_png(&self, scale: f64) -> Vec<u8> {
        raster::render(self, scale).to_png()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Color, INK};

    #[test]
    fn faults_are_found() {
        let mut canvas = Canvas::new(200.0, 100.0);
        canvas.text([10.0, 40.0], Text::new("one", 20.0));
        assert_eq!(canvas.faults(), []);
        canvas.text([20.0, 45.0], Text::new("two", 20.0));
        canvas.text([170.0, 90.0], Text::new("edge", 20.0));
        canvas.text([100.0, 90.0], Text::new("漢", 9.0));
        let faults = canvas.faults();
        assert!(faults.contains(&Fault::Overlap("one".into(), "two".into())));
        assert!(faults.contains(&Fault::Outside("edge".into())));
        assert!(faults.contains(&Fault::TooSmall("漢".into())));
        assert!(faults.contains(&Fault::MissingGlyphs(vec!['漢'])));
        assert_eq!(faults.len(), 4);
    }

    #[test]
    fn an_arrow_ends_at_its_target() {
        let mut canvas = Canvas::new(200.0, 100.0);
        canvas.arrow([10.0, 10.0], [110.0, 10.0], Stroke::new(INK, 2.0));
        let Primitive::Polygon { points, .. } = &canvas.primitives[1] else { panic!("no head") };
        assert_eq!(points[0], [110.0, 10.0]);
        canvas.arrow([5.0, 5.0], [5.0, 5.0], Stroke::new(Color::WHITE, 2.0));
        assert_eq!(canvas.primitives.len(), 2, "no arrow without a direction");
    }
}
