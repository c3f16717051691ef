//! The page of a walk. Everything is in the page from the start; its script only hides what belongs to
//! other steps.

use std::fmt::Write;

use super::{Draw, Step, Walk};
use crate::canvas::Canvas;
use crate::diagram::Pen;
use crate::geometry::Rect;
use crate::picture::base64;
use crate::plate::Panel;
use crate::shape::{Color, Style};
use crate::style::INK;
use crate::svg::{escape, glyph_definitions, inline};

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The size of the drawing, in canvas px.
pub(super) const DRAWING: [f64; 2] = [860.0, 560.0];
/// The room around the tree.
const MARGIN: f64 = 16.0;
/// The height of the bar below a node that shows the colour of its answer.
const ANSWER: f64 = 14.0;

/// A canvas whose primitives are in groups.
struct Layers {
    canvas: Canvas,
    groups: Vec<(String, usize)>,
}

impl Layers {
    fn new([width, height]: [f64; 2]) -> Self {
        Self { canvas: Canvas::new(width, height), groups: Vec::new() }
    }

    /// Draws a group with these attributes.
    fn add(&mut self, attributes: String, draw: impl FnOnce(&mut Canvas)) {
        let before = self.canvas.primitives.len();
        draw(&mut self.canvas);
        self.groups.push((attributes, self.canvas.primitives.len() - before));
    }

    fn to_svg(&self) -> String {
        inline(&self.canvas, &self.groups)
    }
}

pub(super) fn html(walk: &Walk) -> String {
    let (drawing, tree) = (drawing(walk), tree(walk));
    let title = escape(&walk.title);
    let (picture, caption) = &walk.picture;
    let count = walk.steps.len();
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<svg class=\"glyphs\">{}</svg>\n\
         <header><h1>{title}</h1><p>{}</p></header>\n\
         <nav><button type=\"button\" id=\"back\" aria-label=\"back\">◀</button>\
         <input type=\"range\" min=\"1\" max=\"{count}\" value=\"1\" aria-label=\"step\">\
         <button type=\"button\" id=\"on\" aria-label=\"on\">▶</button>\
         <output></output></nav>\n<main>\n",
        glyph_definitions([&drawing.canvas, &tree.canvas]),
        escape(&walk.subtitle),
    );
    let _ = writeln!(
        html,
        "<div class=\"seen\">\n<figure class=\"drawing\">\n{}<figcaption>{}{}</figcaption></figure>",
        drawing.to_svg(),
        escape(&walk.backdrop.name),
        walk.legend.iter().map(legend).collect::<String>(),
    );
    let _ = writeln!(
        html,
        "<figure class=\"picture\"><img alt=\"\" src=\"data:image/png;base64,{}\">\
         <figcaption>{}</figcaption></figure>\n</div>",
        base64(&picture.to_png()),
        escape(caption)
    );
    let sections = walk.steps.iter().zip(1..).map(section).collect::<String>();
    let _ = writeln!(html, "<div class=\"said\">\n<div class=\"text\">\n{sections}</div>");
    let width = tree.canvas.width();
    let _ = writeln!(
        html,
        "<div class=\"tree\"><div style=\"max-width:{width:.0}px;min-width:{:.0}px\">\n{}</div></div>\n</div>",
        0.6 * width,
        tree.to_svg()
    );
    let _ = writeln!(html, "</main>\n<script>\n{SCRIPT}</script>\n</body>\n</html>");
    html
}

fn legend(&(name, color, dashed): &(&str, Color, bool)) -> String {
    let line = if dashed { "dashed" } else { "solid" };
    format!("<span style=\"border-top:4px {line} {}\">{}</span>", css(color), escape(name))
}

fn section((step, number): (&Step, usize)) -> String {
    let Step { call, headline, lines, table, .. } = step;
    let table = match table.as_slice() {
        [] => String::new(),
        rows => format!("<pre class=\"table\">{}</pre>", escape(&rows.join("\n"))),
    };
    format!(
        "<section data-from=\"{number}\" data-to=\"{number}\" data-call=\"{call}\"><h2>{}</h2><pre>{}</pre>{table}</section>\n",
        escape(headline),
        escape(&lines.join("\n"))
    )
}

fn drawing(walk: &Walk) -> Layers {
    let mut layers = Layers::new(DRAWING);
    let rect = Rect::new(0.0, 0.0, DRAWING[0], DRAWING[1]);
    let with_pen = |draw: &Draw, canvas: &mut Canvas| {
        draw(&mut Pen::new(canvas, rect, walk.backdrop.low, walk.backdrop.high));
    };
    layers.add(String::new(), |canvas| with_pen(&walk.backdrop.draw, canvas));
    for (step, number) in walk.steps.iter().zip(1..) {
        if let Some(draw) = &step.stays {
            // `number` counts from 1: the steps behind this one begin at that place.
            let cleared = walk.steps[number..].iter().position(|later| later.clears);
            let to = cleared.map(|later| format!(" data-to=\"{}\"", number + later));
            let shown = format!(" data-from=\"{number}\"{}", to.unwrap_or_default());
            layers.add(shown, |canvas| with_pen(draw, canvas));
        }
    }
    // On top of everything that stays.
    for (step, number) in walk.steps.iter().zip(1..) {
        if let Some(draw) = &step.passes {
            let only = format!(" data-from=\"{number}\" data-to=\"{number}\"");
            layers.add(only, |canvas| with_pen(draw, canvas));
        }
    }
    layers
}

fn tree(walk: &Walk) -> Layers {
    let (width, height) = (walk.calls.width(), walk.calls.height(0.0) + ANSWER);
    let mut layers = Layers::new([width + 2.0 * MARGIN, height + 2.0 * MARGIN]);
    let parts = walk.calls.parts(Rect::new(MARGIN, MARGIN, width, height));
    for (step, number) in walk.steps.iter().zip(1..) {
        let attributes = format!(" data-from=\"{number}\" data-call=\"{}\"", step.call);
        let part = &parts[step.call];
        if step.opens {
            layers.add(attributes.clone(), |canvas| part.draw(canvas));
        }
        if let Some(answer) = step.returns {
            let node = part.node();
            let bar = Rect::new(node.x, node.bottom(), node.width, ANSWER);
            layers.add(attributes, |canvas| {
                canvas.rect(bar, Style::fill(answer).outlined(INK, 1.5));
            });
        }
    }
    layers
}

fn css(color: Color) -> String {
    let [red, green, blue] = color.rgb;
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::super::tests::sample;
    use super::*;

    #[test]
    fn everything_is_escaped_and_nothing_comes_from_elsewhere() {
        let html = sample().to_html();
        assert_eq!(html.matches("<script>").count(), 1, "only the page's own");
        assert!(html.contains("<h2>call 1 &lt;script&gt;</h2><pre>a &amp; b</pre>"));
        assert!(html.contains("aria-label=\"&lt;edge&gt;\""));
        assert!(html.contains("the &quot;scene&quot;") && html.contains("pixel &lt;0&gt;"));
        assert!(!html.contains("http") && !html.contains("url("), "no address of another place");
        for (attribute, allowed) in [("src=\"", "data:"), ("href=\"", "#")] {
            assert!(html.split(attribute).skip(1).all(|value| value.starts_with(allowed)));
        }
    }

    #[test]
    fn each_part_appears_with_its_step() {
        let html = sample().to_html();
        let all = |line: &str| html.matches(line).count();
        assert_eq!(all("<section data-from=\"3\" data-to=\"3\" data-call=\"1\">"), 1);
        assert_eq!(all("<g data-from=\"1\" data-to=\"3\">"), 1, "until step 4 clears the drawing");
        assert_eq!(all("<g data-from=\"4\">"), 1, "what step 4 draws stays");
        assert_eq!(all("<g data-from=\"2\" data-to=\"2\">"), 1, "what step 2 draws passes");
        for (step, call) in [(1, 0), (2, 1), (3, 1), (4, 0)] {
            let part = format!("<g data-from=\"{step}\" data-call=\"{call}\">");
            assert_eq!(all(&part), 1, "call {call} begins or returns at step {step}");
        }
        assert!(html.contains("fill=\"#010203\""), "the colour of an answer");
        assert!(html.contains("max=\"4\""));
    }

    /// Rows stay whole, however long: they are in a box of their own that scrolls.
    #[test]
    fn a_table_is_not_wrapped() {
        let html = sample().to_html();
        assert!(html.contains("<pre>1\n2</pre><pre class=\"table\">a  b\n3 &lt;4</pre></section>"));
        assert_eq!(html.matches("class=\"table\"").count(), 1);
        assert!(rule("pre.table").contains("white-space:pre;overflow-x:auto"));
    }

    /// What a selector's rule says, outside of all conditions.
    fn rule(selector: &str) -> &'static str {
        let found = STYLE.lines().find_map(|line| line.strip_prefix(selector)?.strip_prefix('{'));
        found.and_then(|rest| rest.split('}').next()).unwrap_or_else(|| panic!("{selector}"))
    }

    /// The colours of a `:root{…}`, by name.
    fn colors(root: &str) -> BTreeMap<&str, Color> {
        let values = root.split([';', '{', '}']).filter_map(|value| value.split_once(":#"));
        let parse = |hex: &str| {
            let digits: String = match hex.len() {
                3 => hex.chars().flat_map(|digit| [digit, digit]).collect(),
                _ => hex.to_owned(),
            };
            let [_, r, g, b] = u32::from_str_radix(&digits, 16).unwrap().to_be_bytes();
            Color::rgb(r, g, b)
        };
        values.map(|(name, hex)| (name.trim_start_matches("--"), parse(hex))).collect()
    }

    /// By the Web Content Accessibility Guidelines 2.2, 1.4.3: at least 4.5 to 1, by day and by night.
    #[test]
    fn text_is_readable_in_both_themes() {
        let light = colors(STYLE.lines().find(|line| line.starts_with(":root")).unwrap());
        let night =
            STYLE.lines().find(|line| line.starts_with("@media(prefers-color-scheme:dark)"));
        let mut dark = light.clone();
        dark.extend(colors(night.unwrap()));
        for (theme, colors) in [("light", &light), ("dark", &dark)] {
            let pairs = [("ink", "page"), ("muted", "page"), ("accent", "page")];
            for (text, ground) in pairs.into_iter().chain([("sheet-muted", "sheet")]) {
                let [a, b] = [colors[text], colors[ground]].map(|c| c.luminance() + 0.05);
                let contrast = f64::max(a / b, b / a);
                assert!(contrast >= 4.5, "{theme}: {text} on {ground} {contrast:.2}");
            }
            // The drawings' own colours are made for white.
            assert_eq!(colors["sheet"], Color::WHITE, "{theme}");
        }
        assert!(light["page"].luminance() > 0.9 && dark["page"].luminance() < 0.05);
        // No colour stands elsewhere, so that no theme can forget one.
        let rest = STYLE.lines().filter(|line| !line.contains(":root"));
        assert!(rest.clone().all(|line| !line.contains('#')), "a colour that no theme changes");
        assert!(rest.clone().all(|line| !line.contains("color:w") && !line.contains("color:b")));
    }

    /// At 390 px everything is in one column that may shrink; what cannot shrink scrolls by itself.
    #[test]
    fn a_narrow_page_stacks_and_fits() {
        assert!(sample().to_html().contains("content=\"width=device-width,initial-scale=1\""));
        let (narrow, wide) = STYLE.split_once("@media(min-width:900px)").unwrap();
        assert!(rule("main").contains("grid-template-columns:minmax(0,1fr)"));
        assert!(
            rule("nav").contains("flex-wrap:wrap") && rule("nav input").contains("min-width:0")
        );
        assert!(rule(".tree").contains("overflow:auto"), "a wide tree scrolls");
        assert!(rule(".picture img").contains("max-width:100%"));
        assert!(rule("body").contains("overflow-wrap:anywhere"), "no word is wider than the page");
        for declaration in narrow.split([';', '{', '}']) {
            let width =
                declaration.strip_prefix("width:").or(declaration.strip_prefix("min-width:"));
            let px = width.and_then(|width| width.strip_suffix("px"));
            assert!(px.is_none_or(|px| px.parse::<f64>().unwrap() <= 360.0), "{declaration}");
        }
        // At 1280×800 nothing is below the fold: rows share the window's height and shrink.
        let main = wide.lines().find(|line| line.starts_with("main{")).unwrap();
        assert!(wide.contains("body{height:100vh") && main.contains("minmax(0,1fr)/"), "{main}");
        assert!(wide.contains(".text{order:0;overflow:auto}"));
    }

    #[test]
    fn the_same_walk_gives_the_same_bytes() {
        assert_eq!(sample().to_html(), sample().to_html());
    }
}
