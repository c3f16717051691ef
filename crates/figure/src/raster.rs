//! The canvas as pixels.

use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, PremultipliedColorU8,
    StrokeDash, Transform,
};

use crate::canvas::{Canvas, Primitive};
use crate::font::{Outline, advances, outline, units_per_em};
use crate::geometry::{Point, Rect};
use crate::picture::Picture;
use crate::shape::{Color, Stroke, Style, Text};
use crate::svg::HALO;

/// Draws the canvas with `scale` pixels to the px, rounding its size up to whole pixels.
pub(crate) fn render(canvas: &Canvas, scale: f64) -> Picture {
    let [width, height] = [canvas.width, canvas.height].map(|side| (side * scale).ceil() as u32);
    let mut sheet = Sheet {
        pixmap: Pixmap::new(width, height).expect("a canvas has an area that fits in memory"),
        scale,
    };
    sheet.pixmap.fill(tiny_skia::Color::WHITE);
    for primitive in &canvas.primitives {
        sheet.draw(primitive);
    }
    let rgb = sheet.pixmap.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]).collect();
    Picture::new(width, height, rgb)
}

struct Sheet {
    pixmap: Pixmap,
    scale: f64,
}

impl Sheet {
    fn draw(&mut self, primitive: &Primitive) {
        match primitive {
            Primitive::Line { points, stroke } => {
                self.paint(polyline(points, false), Style { fill: None, stroke: Some(*stroke) });
            }
            Primitive::Polygon { points, style } => self.paint(polyline(points, true), *style),
            Primitive::Rect { rect, radius, style } => self.paint(rectangle(rect, *radius), *style),
            Primitive::Circle { center, radius, style } => {
                let [x, y, r] = [center[0], center[1], *radius].map(|v| v as f32);
                self.paint(PathBuilder::from_circle(x, y, r), *style);
            }
            Primitive::Text { at, text } => self.text(*at, text),
            Primitive::Picture { rect, picture } => self.picture(rect, picture),
        }
    }

    /// Paints a path; one without any extent (`None`) leaves no mark.
    fn paint(&mut self, path: Option<Path>, style: Style) {
        let Some(path) = path else { return };
        let transform = Transform::from_scale(self.scale as f32, self.scale as f32);
        if let Some(color) = style.fill {
            self.pixmap.fill_path(&path, &ink(color), FillRule::Winding, transform, None);
        }
        if let Some(stroke) = style.stroke {
            self.pixmap.stroke_path(&path, &ink(stroke.color), &pen(stroke), transform, None);
        }
    }

    fn text(&mut self, at: Point, text: &Text) {
        let glyphs = letters(at, text);
        if text.halo {
            let rim = Stroke::new(Color::WHITE, HALO * text.size);
            self.paint(glyphs.clone(), Style { fill: None, stroke: Some(rim) });
        }
        self.paint(glyphs, Style::fill(text.color));
    }

    /// Pictures are placed on whole pixels, so that theirs stay crisp.
    fn picture(&mut self, rect: &Rect, picture: &Picture) {
        let [left, right, top, bottom] = [rect.x, rect.right(), rect.y, rect.bottom()]
            .map(|side| (side * self.scale).round() as i64);
        let (width, height) = ((right - left).max(1) as u32, (bottom - top).max(1) as u32);
        let placed = picture.resampled(width, height);
        let (columns, rows) = (i64::from(self.pixmap.width()), i64::from(self.pixmap.height()));
        for y in 0..height {
            for x in 0..width {
                let (column, row) = (left + i64::from(x), top + i64::from(y));
                if (0..columns).contains(&column) && (0..rows).contains(&row) {
                    let [r, g, b] = placed.get(x, y);
                    let pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).expect("opaque");
                    self.pixmap.pixels_mut()[(row * columns + column) as usize] = pixel;
                }
            }
        }
    }
}

fn ink(color: Color) -> Paint<'static> {
    let [red, green, blue] = color.rgb;
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, color.alpha);
    paint
}

fn pen(stroke: Stroke) -> tiny_skia::Stroke {
    tiny_skia::Stroke {
        width: stroke.width as f32,
        line_cap: if stroke.dash.is_some() { LineCap::Butt } else { LineCap::Round },
        line_join: LineJoin::Round,
        dash: stroke.dash.and_then(|dash| StrokeDash::new(dash.map(|v| v as f32).to_vec(), 0.0)),
        ..tiny_skia::Stroke::default()
    }
}

fn polyline(points: &[Point], closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (i, [x, y]) in points.iter().enumerate() {
        let (x, y) = (*x as f32, *y as f32);
        if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    if closed {
        path.close();
    }
    path.finish()
}

fn rectangle(rect: &Rect, radius: f64) -> Option<Path> {
    // The control points of a cubic that follows a quarter of a circle lie this far along its tangents.
    const QUARTER: f64 = 0.552_284_75;
    let radius = radius.min(rect.width / 2.0).min(rect.height / 2.0);
    let (left, top, right, bottom) = (rect.x, rect.y, rect.right(), rect.bottom());
    if radius <= 0.0 {
        return polyline(&[[left, top], [right, top], [right, bottom], [left, bottom]], true);
    }
    let near = radius * (1.0 - QUARTER);
    let mut path = PathBuilder::new();
    path.move_to((left + radius) as f32, top as f32);
    // Each side's end, the corner's two control points, and the next side's beginning.
    let corners = [
        [[right - radius, top], [right - near, top], [right, top + near], [right, top + radius]],
        [
            [right, bottom - radius],
            [right, bottom - near],
            [right - near, bottom],
            [right - radius, bottom],
        ],
        [
            [left + radius, bottom],
            [left + near, bottom],
            [left, bottom - near],
            [left, bottom - radius],
        ],
        [[left, top + radius], [left, top + near], [left + near, top], [left + radius, top]],
    ];
    for corner in corners {
        let [end, first, second, begin] = corner.map(|[x, y]| [x as f32, y as f32]);
        path.line_to(end[0], end[1]);
        path.cubic_to(first[0], first[1], second[0], second[1], begin[0], begin[1]);
    }
    path.close();
    path.finish()
}

/// The outlines of a line of text on the canvas, as one path.
fn letters(at: Point, text: &Text) -> Option<Path> {
    let scale = text.size / units_per_em(text.weight);
    let lead = text.lead();
    let mut path = PathBuilder::new();
    for (character, start) in advances(&text.content, text.weight).0 {
        let place = |[x, y]: Point| {
            let (run, rise) = ((start + x) * scale - lead, y * scale);
            let [x, y] = if text.upwards { [-rise, -run] } else { [run, -rise] };
            ((at[0] + x) as f32, (at[1] + y) as f32)
        };
        for step in outline(character, text.weight) {
            match step {
                Outline::Move(to) => {
                    let (x, y) = place(to);
                    path.move_to(x, y);
                }
                Outline::Line(to) => {
                    let (x, y) = place(to);
                    path.line_to(x, y);
                }
                Outline::Quad(control, to) => {
                    let ((cx, cy), (x, y)) = (place(control), place(to));
                    path.quad_to(cx, cy, x, y);
                }
                Outline::Close => path.close(),
            }
        }
    }
    path.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::INK;

    #[test]
    fn the_size_is_the_canvas_times_the_scale() {
        let canvas = Canvas::new(30.0, 20.5);
        let picture = render(&canvas, 2.0);
        assert_eq!((picture.width(), picture.height()), (60, 41));
        assert_eq!(render(&canvas, 1.0).height(), 21);
    }

    #[test]
    fn shapes_land_where_they_are_drawn() {
        let mut canvas = Canvas::new(40.0, 40.0);
        let red = Color::rgb(255, 0, 0);
        canvas.rect(Rect::new(0.0, 0.0, 10.0, 10.0), Style::fill(red));
        canvas.circle([30.0, 30.0], 6.0, Style::fill(red));
        canvas.picture(
            Rect::new(20.0, 0.0, 20.0, 20.0),
            Picture::new(2, 1, vec![[9, 8, 7], [1, 2, 3]]),
        );
        let picture = render(&canvas, 1.0);
        assert_eq!(picture.get(5, 5), [255, 0, 0]);
        assert_eq!(picture.get(30, 30), [255, 0, 0]);
        assert_eq!(picture.get(15, 30), [255; 3]);
        assert_eq!((picture.get(29, 10), picture.get(30, 10)), ([9, 8, 7], [1, 2, 3]));
    }

    #[test]
    fn letters_stay_in_the_box_of_their_text() {
        for text in [Text::new("Ég√ÄQ(", 30.0), Text::new("Ég√ÄQ(", 30.0).upwards().centered()]
        {
            let mut canvas = Canvas::new(200.0, 200.0);
            let at = [60.0, 100.0];
            let room = text.rect(at).grown(4.0);
            canvas.text(at, text.color(INK));
            let picture = render(&canvas, 1.0);
            let mut inked = 0;
            for (x, y) in (0..200).flat_map(|y| (0..200).map(move |x| (x, y))) {
                if picture.get(x, y) != [255; 3] {
                    inked += 1;
                    let pixel = Rect::new(f64::from(x), f64::from(y), 1.0, 1.0);
                    assert!(room.contains(&pixel), "ink at ({x}, {y})");
                }
            }
            assert!(inked > 200, "the text is there");
        }
    }
}
