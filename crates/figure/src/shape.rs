//! What can be said about a primitive: its colours, strokes and text.

use crate::font::{Weight, text_width};
use crate::geometry::{Point, Rect};
use crate::picture::linear_light;
use crate::style::{ASCENT, DESCENT, INK};

/// An sRGB colour with an opacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color {
    /// Red, green, blue.
    pub rgb: [u8; 3],
    /// From 0 (invisible) to 255 (opaque).
    pub alpha: u8,
}

impl Color {
    /// White.
    pub const WHITE: Self = Self::rgb(255, 255, 255);

    /// An opaque colour.
    pub const fn rgb(red: u8, green: u8, blue: u8) -> Self {
        Self { rgb: [red, green, blue], alpha: 255 }
    }

    /// The same colour with the opacity `alpha`, from 0 to 255.
    pub const fn with_alpha(self, alpha: u8) -> Self {
        Self { alpha, ..self }
    }

    /// The colour `part` of the way (0 to 1) to `other`, on the sRGB scale.
    pub fn mix(self, other: Self, part: f64) -> Self {
        let blend =
            |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * part).round() as u8;
        Self {
            rgb: std::array::from_fn(|c| blend(self.rgb[c], other.rgb[c])),
            alpha: blend(self.alpha, other.alpha),
        }
    }

    /// Red, green and blue as linear light, from 0 to 1.
    pub fn linear(self) -> [f64; 3] {
        self.rgb.map(|byte| linear_light()[byte as usize])
    }

    /// The relative luminance, from 0 (black) to 1 (white).
    pub fn luminance(self) -> f64 {
        let [red, green, blue] = self.linear();
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    /// The colour, darkened until it is readable as text on white (contrast at least 4.5 to 1).
    pub fn for_text(self) -> Self {
        const DARK_ENOUGH: f64 = 1.05 / 4.5 - 0.05;
        let black = Self::rgb(0, 0, 0);
        (0..=20)
            .map(|step| self.mix(black, f64::from(step) / 20.0))
            .find(|color| color.luminance() <= DARK_ENOUGH)
            .unwrap_or(black)
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub color: Color,
    /// Its width, in canvas px.
    pub width: f64,
    /// The lengths of dash and gap, in canvas px.
    pub dash: Option<[f64; 2]>,
}

impl Stroke {
    /// A solid line.
    pub const fn new(color: Color, width: f64) -> Self {
        Self { color, width, dash: None }
    }

    /// The same line in dashes `on` px long and `off` px apart.
    pub const fn dashed(self, on: f64, off: f64) -> Self {
        Self { dash: Some([on, off]), ..self }
    }
}

/// How an area is drawn: filled, outlined, or both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Style {
    /// The colour of its inside.
    pub fill: Option<Color>,
    /// Its border, centred on the edge.
    pub stroke: Option<Stroke>,
}

impl Style {
    /// Filled, without a border.
    pub const fn fill(color: Color) -> Self {
        Self { fill: Some(color), stroke: None }
    }

    /// A border only.
    pub const fn outline(color: Color, width: f64) -> Self {
        Self { fill: None, stroke: Some(Stroke::new(color, width)) }
    }

    /// The same with a border.
    pub const fn outlined(self, color: Color, width: f64) -> Self {
        Self { stroke: Some(Stroke::new(color, width)), ..self }
    }
}

/// Which part of a line of text stands at its position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Anchor {
    /// Its beginning.
    #[default]
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// One line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    pub(crate) content: String,
    pub(crate) size: f64,
    pub(crate) weight: Weight,
    pub(crate) color: Color,
    pub(crate) anchor: Anchor,
    pub(crate) upwards: bool,
    pub(crate) halo: bool,
}

impl Text {
    /// Text of `size` px, regular, in ink, its beginning at its position.
    pub fn new(content: impl Into<String>, size: f64) -> Self {
        Self {
            content: content.into(),
            size,
            weight: Weight::Regular,
            color: INK,
            anchor: Anchor::Start,
            upwards: false,
            halo: false,
        }
    }

    /// In bold.
    pub fn bold(self) -> Self {
        Self { weight: Weight::Bold, ..self }
    }

    /// In another colour.
    pub fn color(self, color: Color) -> Self {
        Self { color, ..self }
    }

    /// Its middle at its position.
    pub fn centered(self) -> Self {
        Self { anchor: Anchor::Middle, ..self }
    }

    /// `anchor` at its position.
    pub fn anchor(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    /// Turned by −90°, so that it reads upwards.
    pub fn upwards(self) -> Self {
        Self { upwards: true, ..self }
    }

    /// With a white rim, to be readable on lines.
    pub fn halo(self) -> Self {
        Self { halo: true, ..self }
    }

    /// The length of the line, in canvas px.
    pub fn width(&self) -> f64 {
        text_width(&self.content, self.size, self.weight)
    }

    /// How far the beginning of the line lies behind its position.
    pub(crate) fn lead(&self) -> f64 {
        match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => self.width() / 2.0,
            Anchor::End => self.width(),
        }
    }

    /// The rectangle it takes when its baseline passes through `at`.
    pub(crate) fn rect(&self, at: Point) -> Rect {
        let (width, over, height) =
            (self.width(), ASCENT * self.size, (ASCENT + DESCENT) * self.size);
        if self.upwards {
            Rect::new(at[0] - over, at[1] + self.lead() - width, height, width)
        } else {
            Rect::new(at[0] - self.lead(), at[1] - over, width, height)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_colors_are_readable_on_white() {
        for color in [Color::rgb(240, 228, 66), Color::rgb(86, 180, 233), Color::WHITE] {
            let contrast = 1.05 / (color.for_text().luminance() + 0.05);
            assert!(contrast >= 4.5, "{color:?}: {contrast}");
        }
        let dark = Color::rgb(0, 60, 90);
        assert_eq!(dark.for_text(), dark);
    }

    #[test]
    fn the_box_of_text_follows_its_anchor_and_turn() {
        let text = Text::new("error", 20.0);
        let width = text.width();
        assert_eq!(text.rect([100.0, 50.0]).x, 100.0);
        assert!(
            (text.clone().anchor(Anchor::End).rect([100.0, 50.0]).right() - 100.0).abs() < 1e-9
        );
        let upright = text.centered().upwards().rect([100.0, 50.0]);
        assert!((upright.height - width).abs() < 1e-9);
        assert!((upright.center()[1] - 50.0).abs() < 1e-9);
    }
}
