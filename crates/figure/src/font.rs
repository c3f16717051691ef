//! The committed font: which characters it has, how wide text is, and the outlines of its glyphs.

use std::sync::OnceLock;

use ab_glyph::{Font, FontRef, GlyphId, OutlineCurve};

use crate::Point;

/// The thickness of the letters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Weight {
    /// For reading.
    Regular,
    /// For titles and direct labels.
    Bold,
}

/// One step of an outline, in font units, y upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Outline {
    Move(Point),
    Line(Point),
    Quad(Point, Point),
    Close,
}

/// Drawn where the font lacks a character, so that the gap is seen.
const MISSING: char = '□';

fn font(weight: Weight) -> &'static FontRef<'static> {
    static REGULAR: OnceLock<FontRef<'static>> = OnceLock::new();
    static BOLD: OnceLock<FontRef<'static>> = OnceLock::new();
    let (cell, bytes): (_, &'static [u8]) = match weight {
        Weight::Regular => (&REGULAR, include_bytes!("../fonts/DejaVuSans.ttf")),
        Weight::Bold => (&BOLD, include_bytes!("../fonts/DejaVuSans-Bold.ttf")),
    };
    cell.get_or_init(|| FontRef::try_from_slice(bytes).expect("the committed font is a font"))
}

fn glyph(weight: Weight, character: char) -> GlyphId {
    match font(weight).glyph_id(character) {
        GlyphId(0) => font(weight).glyph_id(MISSING),
        id => id,
    }
}

/// The font units in one em: a glyph's outline times `size / units_per_em` is in px.
pub(crate) fn units_per_em(weight: Weight) -> f64 {
    f64::from(font(weight).units_per_em().expect("a scalable font has its em"))
}

/// The characters of `text` for which the course's font has no glyph, in order, each once.
pub fn missing_glyphs(text: &str) -> Vec<char> {
    let mut missing = Vec::new();
    for character in text.chars() {
        let lacks = [Weight::Regular, Weight::Bold]
            .into_iter()
            .any(|weight| font(weight).glyph_id(character) == GlyphId(0));
        if lacks && !missing.contains(&character) {
            missing.push(character);
        }
    }
    missing
}

/// The characters of one line of text with where each starts, in font units, and the line's width.
pub(crate) fn advances(text: &str, weight: Weight) -> (Vec<(char, f64)>, f64) {
    let font = font(weight);
    let mut x = 0.0;
    let mut previous = None;
    let mut starts = Vec::new();
    for character in text.chars() {
        let id = glyph(weight, character);
        if let Some(previous) = previous {
            x += f64::from(font.kern_unscaled(previous, id));
        }
        starts.push((character, x));
        x += f64::from(font.h_advance_unscaled(id));
        previous = Some(id);
    }
    (starts, x)
}

/// The width of one line of text set at `size`, in the unit of `size`.
pub fn text_width(text: &str, size: f64, weight: Weight) -> f64 {
    advances(text, weight).1 * size / units_per_em(weight)
}

/// The outline of a character; empty for spaces.
pub(crate) fn outline(character: char, weight: Weight) -> Vec<Outline> {
    let Some(outline) = font(weight).outline(glyph(weight, character)) else {
        return Vec::new();
    };
    let point = |p: ab_glyph::Point| [f64::from(p.x), f64::from(p.y)];
    let mut steps = Vec::new();
    let mut pen = None;
    for curve in outline.curves {
        let (from, step, to) = match curve {
            OutlineCurve::Line(a, b) => (a, Outline::Line(point(b)), b),
            OutlineCurve::Quad(a, b, c) => (a, Outline::Quad(point(b), point(c)), c),
            OutlineCurve::Cubic(..) => unreachable!("TrueType outlines are quadratic"),
        };
        if pen != Some(from) {
            if pen.is_some() {
                steps.push(Outline::Close);
            }
            steps.push(Outline::Move(point(from)));
        }
        steps.push(step);
        pen = Some(to);
    }
    steps.push(Outline::Close);
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_character_of_the_course_has_a_glyph() {
        let course = "éàèêëçôîïùûœŒÉÀ«»’“”–—… θΩπρεαβγδηλμσφωΔΣτ ≤≥≠≈∝√∞∫∑·×÷±−→←↑↓↙↗⇒ \
                      ⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ ₀₁₂₃₄₅₆₇₈₉ᵢᵣ ′″∥⊥∠∈∩∪⊂ ✓✗●○■▲◆ S' Ω' A' §°µ%‰";
        assert_eq!(missing_glyphs(course), []);
    }

    #[test]
    fn a_missing_glyph_is_reported_once_and_drawn_as_a_box() {
        assert_eq!(missing_glyphs("漢字漢"), ['漢', '字']);
        assert_eq!(outline('漢', Weight::Regular), outline(MISSING, Weight::Regular));
    }

    #[test]
    fn widths_add_up_and_scale() {
        let one = text_width("n", 10.0, Weight::Regular);
        assert!((text_width("nnn", 10.0, Weight::Regular) - 3.0 * one).abs() < 1e-9);
        assert!((text_width("n", 20.0, Weight::Regular) - 2.0 * one).abs() < 1e-9);
        assert!(text_width("n", 10.0, Weight::Bold) > one);
        assert!(
            text_width("AV", 10.0, Weight::Regular) < 2.0 * text_width("A", 10.0, Weight::Regular),
            "kerned"
        );
    }

    #[test]
    fn outlines_are_closed_contours() {
        let letter = outline('é', Weight::Regular);
        let moves = letter.iter().filter(|step| matches!(step, Outline::Move(_))).count();
        let closes = letter.iter().filter(|step| matches!(step, Outline::Close)).count();
        assert_eq!((moves, closes), (3, 3), "the bowl outside and inside, and the accent");
        assert!(outline(' ', Weight::Regular).is_empty());
    }
}
