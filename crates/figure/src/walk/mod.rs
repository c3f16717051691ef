//! A walk through an algorithm, step by step: as text for a terminal, and as a page with a slider.
//!
//! The algorithm is recursive: its calls form a [`Tree`], in which they are numbered from the root
//! downwards, left before right. Each [`Step`] belongs to a call, says what happens in words and numbers, and
//! adds to a drawing of the scene.

mod page;

use crate::diagram::Pen;
use crate::geometry::Point;
use crate::picture::Picture;
use crate::shape::Color;
use crate::tree::Tree;

/// Something drawn in the world units of a walk's drawing.
pub(crate) type Draw = Box<dyn Fn(&mut Pen<'_>)>;

/// The drawing beside the tree.
pub struct Backdrop {
    /// What is seen, such as "the scene from above".
    pub name: String,
    /// The lower left corner of what is shown at least, in world units.
    pub low: Point,
    /// The upper right corner of what is shown at least.
    pub high: Point,
    /// Draws what is there before the first step.
    pub draw: Draw,
}

/// The steps of an algorithm, with what is seen beside them.
pub struct Walk {
    /// What is walked through, a line.
    pub title: String,
    /// The settings, a line.
    pub subtitle: String,
    /// What the steps draw on.
    pub backdrop: Backdrop,
    /// What the colours of the drawing stand for; whether the line is dashed.
    pub legend: Vec<(&'static str, Color, bool)>,
    /// A small picture and what it shows.
    pub picture: (Picture, String),
    /// The calls.
    pub calls: Tree,
    /// What happens, in order.
    pub steps: Vec<Step>,
}

/// One step of a walk.
pub struct Step {
    call: usize,
    depth: usize,
    headline: String,
    lines: Vec<String>,
    table: Vec<String>,
    opens: bool,
    returns: Option<Color>,
    clears: bool,
    stays: Option<Draw>,
    passes: Option<Draw>,
}

impl Step {
    /// A step of the call of that number (from 0), which is `depth` calls below the root.
    pub fn new(call: usize, depth: usize, headline: impl Into<String>) -> Self {
        Self {
            call,
            depth,
            headline: headline.into(),
            lines: Vec::new(),
            table: Vec::new(),
            opens: false,
            returns: None,
            clears: false,
            stays: None,
            passes: None,
        }
    }

    /// With one more line of text.
    pub fn line(mut self, line: impl Into<String>) -> Self {
        self.lines.push(line.into());
        self
    }

    /// With one more row of a table below the lines: its columns are aligned by spaces, and it is never
    /// broken.
    pub fn row(mut self, row: impl Into<String>) -> Self {
        self.table.push(row.into());
        self
    }

    /// The call begins: it appears in the tree.
    pub fn opens(self) -> Self {
        Self { opens: true, ..self }
    }

    /// The call ends; its answer looks like this.
    pub fn returns(self, answer: Color) -> Self {
        Self { returns: Some(answer), ..self }
    }

    /// The drawing begins anew: what earlier steps added to it is gone.
    pub fn clears(self) -> Self {
        Self { clears: true, ..self }
    }

    /// Adds to the drawing, for this step and all that follow, up to the next that [`Step::clears`] it.
    pub fn draws(self, draw: impl Fn(&mut Pen<'_>) + 'static) -> Self {
        Self { stays: Some(Box::new(draw)), ..self }
    }

    /// Adds to the drawing, for this step only.
    pub fn points_out(self, draw: impl Fn(&mut Pen<'_>) + 'static) -> Self {
        Self { passes: Some(Box::new(draw)), ..self }
    }
}

impl Backdrop {
    /// The corners `low` and `high`, moved apart to the proportions of the drawing: all that it shows.
    pub fn frame(low: Point, high: Point) -> [Point; 2] {
        let [width, height] = page::DRAWING;
        let unit = ((high[0] - low[0]) / width).max((high[1] - low[1]) / height);
        let corner = |side: f64| {
            let along =
                |axis: usize, size: f64| (low[axis] + high[axis] + side * unit * size) / 2.0;
            [along(0, width), along(1, height)]
        };
        [corner(-1.0), corner(1.0)]
    }
}

impl Walk {
    /// All steps as text, indented by their depth.
    pub fn to_text(&self) -> String {
        let mut text = format!("{}\n{}\n", self.title, self.subtitle);
        for step in &self.steps {
            let indent = "  ".repeat(step.depth);
            text += &format!("\n{indent}{}\n", step.headline);
            for line in step.lines.iter().chain(&step.table) {
                text += &format!("{indent}    {line}\n");
            }
        }
        text
    }

    /// The walk as an HTML page that needs nothing from elsewhere: a slider over the steps, the drawing, the
    /// tree as it grows and the text of the step. The page's fragment, such as `#12`, chooses a step.
    pub fn to_html(&self) -> String {
        page::html(self)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{INK, Stroke};

    /// A call that makes another one, both with a hostile name.
    pub fn sample() -> Walk {
        let ray = |pen: &mut Pen<'_>| pen.arrow([0.0, 0.0], [1.0, 1.0], Stroke::new(INK, 2.0));
        let steps = vec![
            Step::new(0, 0, "call 1 <script>").line("a & b").opens().draws(ray),
            Step::new(1, 1, "call 2").opens().points_out(ray),
            Step::new(1, 1, "call 2 returns")
                .line("1")
                .line("2")
                .row("a  b")
                .row("3 <4")
                .returns(Color::rgb(1, 2, 3)),
            Step::new(0, 0, "call 1 returns").returns(Color::WHITE).clears().draws(ray),
        ];
        Walk {
            title: "An <algorithm>".into(),
            subtitle: "with 'settings'".into(),
            backdrop: Backdrop {
                name: "the \"scene\"".into(),
                low: [0.0, 0.0],
                high: [2.0, 1.0],
                draw: Box::new(|pen| pen.dot([1.0, 0.5], 3.0, INK)),
            },
            legend: vec![("ray", INK, false), ("shadow ray", INK, true)],
            picture: (Picture::from_fn(2, 2, |_, _| [9; 3]), "pixel <0>".into()),
            calls: Tree::new("1", INK).child("<edge>", Tree::new("2", INK)),
            steps,
        }
    }

    #[test]
    fn a_frame_has_the_proportions_of_the_drawing() {
        let [width, height] = page::DRAWING;
        assert_eq!(
            Backdrop::frame([0.0, 0.0], [0.0, height]),
            [[-width / 2.0, 0.0], [width / 2.0, height]]
        );
        assert_eq!(
            Backdrop::frame([-width, 1.0], [width, 1.0]),
            [[-width, 1.0 - height], [width, 1.0 + height]]
        );
    }

    #[test]
    fn text_is_indented_by_depth() {
        let text = "An <algorithm>\nwith 'settings'\n\ncall 1 <script>\n    a & b\n\n  call 2\n\n  \
                    call 2 returns\n      1\n      2\n      a  b\n      3 <4\n\ncall 1 returns\n";
        assert_eq!(sample().to_text(), text);
    }
}
