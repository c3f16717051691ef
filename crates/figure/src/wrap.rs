//! Breaking text into lines by its measured width.

use crate::canvas::Canvas;
use crate::font::{Weight, text_width};
use crate::geometry::Point;
use crate::shape::Text;
use crate::style::LEADING;

/// `text` in lines at most `width` px wide at `size`. Lines break at spaces and after `\n`; a word wider
/// than a line is cut. A no-break space keeps its neighbours together.
pub fn wrap(text: &str, size: f64, weight: Weight, width: f64) -> Vec<String> {
    let fits = |line: &str| text_width(line, size, weight) <= width;
    let mut lines = Vec::new();
    for paragraph in text.split('\n') {
        let mut line = String::new();
        for word in paragraph.split(' ').filter(|word| !word.is_empty()) {
            let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
            if fits(&longer) {
                line = longer;
                continue;
            }
            if !line.is_empty() {
                lines.push(std::mem::take(&mut line));
            }
            for character in word.chars() {
                line.push(character);
                if !fits(&line) && line.chars().nth(1).is_some() {
                    line.pop();
                    lines.push(std::mem::replace(&mut line, character.to_string()));
                }
            }
        }
        lines.push(line);
    }
    lines
}

/// A block of text set in lines of one look.
pub(crate) struct Paragraph {
    look: Text,
    lines: Vec<String>,
}

impl Paragraph {
    /// The content of `look` in lines at most `width` px wide; empty text has no line.
    pub(crate) fn new(look: Text, width: f64) -> Self {
        let lines = if look.content.is_empty() {
            Vec::new()
        } else {
            wrap(&look.content, look.size, look.weight, width)
        };
        Self { look, lines }
    }

    pub(crate) fn height(&self) -> f64 {
        self.lines.len() as f64 * self.leading()
    }

    fn leading(&self) -> f64 {
        LEADING * self.look.size
    }

    /// Draws the block below `top`.
    pub(crate) fn draw(&self, canvas: &mut Canvas, [x, top]: Point) {
        for (i, line) in self.lines.iter().enumerate() {
            let baseline = top + self.look.size + i as f64 * self.leading();
            canvas.text([x, baseline], Text { content: line.clone(), ..self.look.clone() });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_line_is_wider_than_asked() {
        let text = "Shadow beams reach the error of 256 samples per pixel in one ninth of the counted \
                    tests; donaudampfschifffahrtsgesellschaftskapitän /a/very/long/path/without/any/space.rs";
        for width in [60.0, 150.0, 333.0, 1200.0] {
            let lines = wrap(text, 16.0, Weight::Regular, width);
            for line in &lines {
                assert!(text_width(line, 16.0, Weight::Regular) <= width, "{line:?} in {width}");
            }
            let letters = |s: &str| s.chars().filter(|c| *c != ' ').collect::<String>();
            assert_eq!(letters(&lines.concat()), letters(text), "nothing is lost");
        }
    }

    #[test]
    fn breaks_are_kept_and_spaces_dropped() {
        assert_eq!(
            wrap("one\n\ntwo  three", 16.0, Weight::Regular, 500.0),
            ["one", "", "two three"]
        );
        assert_eq!(wrap("abc", 16.0, Weight::Regular, 0.0), ["a", "b", "c"], "a line has a letter");
    }
}
