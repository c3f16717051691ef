//! The canvas as an SVG document.

use std::collections::BTreeSet;
use std::fmt::Write;

use crate::canvas::{Canvas, Primitive};
use crate::font::{Outline, Weight, advances, outline, units_per_em};
use crate::geometry::{Point, Rect};
use crate::number::coordinate;
use crate::picture::{Picture, base64};
use crate::shape::{Color, Stroke, Style, Text};

/// The width of the white rim around text with a halo, as a multiple of the text's size.
pub(crate) const HALO: f64 = 0.3;

pub(crate) fn document(canvas: &Canvas) -> String {
    let (width, height) = (coordinate(canvas.width), coordinate(canvas.height));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         width=\"{width}\" height=\"{height}\" role=\"img\">\n\
         <title>{}</title>\n<desc>{}</desc>\n",
        escape(&canvas.title),
        escape(&canvas.description)
    );
    svg.push_str(&glyph_definitions([canvas]));
    let _ = writeln!(svg, "<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>");
    for primitive in &canvas.primitives {
        svg.push_str(&element(primitive));
        svg.push('\n');
    }
    svg.push_str("</svg>\n");
    svg
}

/// `text` with the characters that markup reserves replaced, for element content and attributes.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            // XML has no way to write most control characters, not even escaped.
            _ if character.is_control() && !matches!(character, '\n' | '\t') => escaped.push(' '),
            _ => escaped.push(character),
        }
    }
    escaped
}

/// The path data of a polyline, from point to point.
fn path(points: &[Point]) -> String {
    let mut data = String::new();
    for (i, point) in points.iter().enumerate() {
        let step = if i == 0 { "M" } else { "L" };
        let _ = write!(data, "{step}{} {}", coordinate(point[0]), coordinate(point[1]));
    }
    data
}

fn element(primitive: &Primitive) -> String {
    match primitive {
        Primitive::Line { points, stroke } => {
            let line = Style { fill: None, stroke: Some(*stroke) };
            format!("<path d=\"{}\"{}/>", path(points), paint(line))
        }
        Primitive::Polygon { points, style } => {
            format!("<path d=\"{}Z\"{}/>", path(points), paint(*style))
        }
        Primitive::Rect { rect, radius, style } => {
            let corner = if *radius > 0.0 {
                format!(" rx=\"{}\"", coordinate(*radius))
            } else {
                String::new()
            };
            format!("<rect{}{corner}{}/>", extent(rect), paint(*style))
        }
        Primitive::Circle { center, radius, style } => format!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}/>",
            coordinate(center[0]),
            coordinate(center[1]),
            coordinate(*radius),
            paint(*style)
        ),
        Primitive::Text { at, text } => text_group(*at, text),
        Primitive::Picture { rect, picture } => image(rect, picture),
    }
}

fn extent(rect: &Rect) -> String {
    let [x, y, width, height] = [rect.x, rect.y, rect.width, rect.height].map(coordinate);
    format!(" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
}

fn paint(style: Style) -> String {
    let fill = style.fill.map_or_else(|| " fill=\"none\"".to_owned(), |color| hue("fill", color));
    fill + &style.stroke.map_or_else(String::new, stroke)
}

fn stroke(stroke: Stroke) -> String {
    let dash = stroke.dash.map_or_else(String::new, |[on, off]| {
        format!(" stroke-dasharray=\"{} {}\"", coordinate(on), coordinate(off))
    });
    // Dashes end bluntly: round ends would close their gaps.
    let cap = if stroke.dash.is_some() { "butt" } else { "round" };
    format!(
        "{} stroke-width=\"{}\" stroke-linecap=\"{cap}\" stroke-linejoin=\"round\"{dash}",
        hue("stroke", stroke.color),
        coordinate(stroke.width)
    )
}

fn hue(attribute: &str, color: Color) -> String {
    let [red, green, blue] = color.rgb;
    let opacity = if color.alpha == 255 {
        String::new()
    } else {
        format!(" {attribute}-opacity=\"{}\"", coordinate(f64::from(color.alpha) / 255.0))
    };
    format!(" {attribute}=\"#{red:02x}{green:02x}{blue:02x}\"{opacity}")
}

fn image(rect: &Rect, picture: &Picture) -> String {
    // Enlarged pixels are to be seen as pixels; a shrunk picture is left to the viewer to smooth.
    let crisp = if rect.width >= f64::from(picture.width()) {
        " style=\"image-rendering:pixelated\""
    } else {
        ""
    };
    format!(
        "<image{} preserveAspectRatio=\"none\"{crisp} href=\"data:image/png;base64,{}\"/>",
        extent(rect),
        base64(&picture.to_png())
    )
}

fn glyph_id(character: char, weight: Weight) -> String {
    let face = match weight {
        Weight::Regular => 'r',
        Weight::Bold => 'b',
    };
    format!("{face}{:x}", u32::from(character))
}

/// The elements of a canvas for a page that holds its [`glyph_definitions`], without the canvas's white
/// sheet: in groups, each with its attributes and the number of its primitives.
pub(crate) fn inline(canvas: &Canvas, groups: &[(String, usize)]) -> String {
    let (width, height) = (coordinate(canvas.width), coordinate(canvas.height));
    let mut svg = format!("<svg viewBox=\"0 0 {width} {height}\" role=\"img\">\n");
    let mut primitives = canvas.primitives.iter();
    for (attributes, count) in groups {
        let _ = writeln!(svg, "<g{attributes}>");
        for primitive in primitives.by_ref().take(*count) {
            svg.push_str(&element(primitive));
            svg.push('\n');
        }
        svg.push_str("</g>\n");
    }
    svg.push_str("</svg>\n");
    svg
}

/// One `<path>` for each character in use on the canvases, which texts refer to.
pub(crate) fn glyph_definitions<'a>(canvases: impl IntoIterator<Item = &'a Canvas>) -> String {
    let used: BTreeSet<(Weight, char)> = canvases
        .into_iter()
        .flat_map(|canvas| &canvas.primitives)
        .filter_map(|primitive| match primitive {
            Primitive::Text { text, .. } => Some(text),
            _ => None,
        })
        .flat_map(|text| text.content.chars().map(|character| (text.weight, character)))
        .collect();
    let mut definitions = String::from("<defs>\n");
    for (weight, character) in used {
        let mut data = String::new();
        for step in outline(character, weight) {
            let _ = match step {
                Outline::Move([x, y]) => write!(data, "M{x} {y}"),
                Outline::Line([x, y]) => write!(data, "L{x} {y}"),
                Outline::Quad([cx, cy], [x, y]) => write!(data, "Q{cx} {cy} {x} {y}"),
                Outline::Close => write!(data, "Z"),
            };
        }
        if !data.is_empty() {
            let _ = writeln!(
                definitions,
                "<path id=\"{}\" d=\"{data}\"/>",
                glyph_id(character, weight)
            );
        }
    }
    definitions.push_str("</defs>\n");
    definitions
}

fn text_group(at: Point, text: &Text) -> String {
    let em = units_per_em(text.weight);
    let scale = text.size / em;
    let mut glyphs = String::new();
    for (character, x) in advances(&text.content, text.weight).0 {
        if !outline(character, text.weight).is_empty() {
            let _ = write!(
                glyphs,
                "<use href=\"#{}\" x=\"{}\"/>",
                glyph_id(character, text.weight),
                coordinate(x)
            );
        }
    }
    let turn = if text.upwards { " rotate(-90)" } else { "" };
    let transform = format!(
        "translate({} {}){turn} translate({} 0) scale({scale:.6} -{scale:.6})",
        coordinate(at[0]),
        coordinate(at[1]),
        coordinate(-text.lead()),
    );
    let rim = if text.halo {
        let width = coordinate(HALO * em);
        format!(
            "<g fill=\"none\" stroke=\"#ffffff\" stroke-width=\"{width}\" stroke-linejoin=\"round\">{glyphs}</g>"
        )
    } else {
        String::new()
    };
    format!(
        "<g aria-label=\"{}\" transform=\"{transform}\"{}>{rim}{glyphs}</g>",
        escape(&text.content),
        hue("fill", text.color)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names of the elements of a well-formed document; panics at the first thing that is not.
    fn elements(document: &str) -> Vec<String> {
        let (mut open, mut names, mut rest) = (Vec::new(), Vec::new(), document);
        while let Some(start) = rest.find('<') {
            assert!(!rest[..start].contains('>'), "a bare > in {}", &rest[..start]);
            for entity in rest[..start].split('&').skip(1) {
                assert!(
                    ["amp;", "lt;", "gt;", "quot;", "#39;"].iter().any(|e| entity.starts_with(e))
                );
            }
            let end = start + rest[start..].find('>').expect("every tag ends");
            let tag = &rest[start + 1..end];
            assert!(!tag.contains('<'), "a bare < in {tag}");
            assert_eq!(tag.matches('"').count() % 2, 0, "an unpaired quote in {tag}");
            if let Some(name) = tag.strip_prefix('/') {
                assert_eq!(open.pop().as_deref(), Some(name), "closes what is open");
            } else {
                let name = tag.split([' ', '/']).next().unwrap().to_owned();
                names.push(name.clone());
                if !tag.ends_with('/') {
                    open.push(name);
                }
            }
            rest = &rest[end + 1..];
        }
        assert!(open.is_empty(), "{open:?} stay open");
        names
    }

    fn sample() -> Canvas {
        let mut canvas = Canvas::new(100.0, 60.0);
        canvas.describe("a < b & \"c\"", "it's\u{7} 1 > 0");
        canvas.text([5.0, 20.0], Text::new("a<b>&\"é'", 16.0).halo());
        canvas.text([5.0, 50.0], Text::new("aaa", 16.0).upwards());
        canvas.picture(Rect::new(50.0, 10.0, 40.0, 40.0), Picture::new(1, 1, vec![[1, 2, 3]]));
        canvas.line([0.0, 0.0], [1.0, 1.0], Stroke::new(Color::WHITE, 1.0).dashed(2.0, 3.0));
        canvas.circle([10.0, 10.0], 2.0, Style::fill(Color::WHITE.with_alpha(128)));
        canvas
    }

    #[test]
    fn documents_are_well_formed() {
        let svg = document(&sample());
        let names = elements(&svg);
        assert!(names.starts_with(&["svg".into(), "title".into(), "desc".into()]));
        assert!(svg.contains("<title>a &lt; b &amp; &quot;c&quot;</title>"));
        assert!(svg.contains("aria-label=\"a&lt;b&gt;&amp;&quot;é&#39;\""));
    }

    #[test]
    fn each_character_is_outlined_once() {
        let svg = document(&sample());
        assert_eq!(svg.matches("<path id=\"r61\"").count(), 1);
        assert_eq!(svg.matches("href=\"#r61\"").count(), 5, "halo, its text, and aaa");
    }

    #[test]
    fn the_same_canvas_gives_the_same_bytes() {
        assert_eq!(document(&sample()), document(&sample()));
    }
}
