//! The plate: a figure's title, its panels, its claim with the verdict, and its caption.

use crate::canvas::Canvas;
use crate::geometry::Rect;
use crate::palette::{GREEN, VERMILION};
use crate::shape::{Color, Stroke, Style, Text};
use crate::style::{
    ACCENT, CAP_HEIGHT, CAPTION, CLAIM, FAINT, INK, LABEL, LEADING, MUTED, TITLE, WIDTH,
};
use crate::wrap::Paragraph;

/// Something that fills a rectangle of a plate.
pub trait Panel {
    /// The height it needs when it is `width` px wide.
    fn height(&self, width: f64) -> f64;

    /// Draws it in `rect`, which is as tall as it asked for or taller.
    fn draw(&self, canvas: &mut Canvas, rect: Rect);
}

/// Panels side by side, their upper edges aligned.
#[derive(Default)]
pub struct Row {
    panels: Vec<(f64, Box<dyn Panel>)>,
}

impl Row {
    /// A row without panels.
    pub fn new() -> Self {
        Self::default()
    }

    /// With one more panel on the right; widths are in proportion to the `share`s, which are positive.
    pub fn panel(mut self, share: f64, panel: impl Panel + 'static) -> Self {
        self.panels.push((share, Box::new(panel)));
        self
    }

    /// Each panel with its left edge and its width, in a row `width` px wide.
    fn columns(&self, width: f64) -> impl Iterator<Item = (&dyn Panel, f64, f64)> {
        const GAP: f64 = 44.0;
        let all: f64 = self.panels.iter().map(|(share, _)| share).sum();
        let room = width - GAP * self.panels.len().saturating_sub(1) as f64;
        let mut x = 0.0;
        self.panels.iter().map(move |(share, panel)| {
            let (left, width) = (x, room * share / all);
            x += width + GAP;
            (&**panel, left, width)
        })
    }
}

impl Panel for Row {
    fn height(&self, width: f64) -> f64 {
        self.columns(width).map(|(panel, _, width)| panel.height(width)).fold(0.0, f64::max)
    }

    fn draw(&self, canvas: &mut Canvas, rect: Rect) {
        for (panel, left, width) in self.columns(rect.width) {
            panel.draw(canvas, Rect::new(rect.x + left, rect.y, width, rect.height));
        }
    }
}

/// Whether the data bear a claim out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// They do.
    Holds,
    /// They do not.
    Fails,
}

impl From<bool> for Verdict {
    /// `true` holds.
    fn from(holds: bool) -> Self {
        if holds { Self::Holds } else { Self::Fails }
    }
}

impl Verdict {
    /// The word on the badge, after its mark.
    pub(crate) fn text(self) -> &'static str {
        match self {
            Self::Holds => "✓ HOLDS",
            Self::Fails => "✗ FAILS",
        }
    }

    /// The badge's colour, dark enough for white letters.
    pub(crate) fn color(self) -> Color {
        match self {
            Self::Holds => GREEN,
            Self::Fails => VERMILION,
        }
        .for_text()
    }
}

/// A finished figure, [`WIDTH`] px wide and as tall as its content asks for.
pub struct Plate {
    id: String,
    title: String,
    claim: String,
    verdict: Verdict,
    notes: Vec<(String, String)>,
    panels: Vec<Box<dyn Panel>>,
}

const MARGIN: f64 = 48.0;
const BODY: f64 = WIDTH - 2.0 * MARGIN;
/// Between the title, the panels and the claim.
const GAP: f64 = 34.0;

impl Plate {
    /// A plate without panels: its number and title, and the claim with the verdict computed from the
    /// figure's data.
    pub fn new(
        id: impl Into<String>,
        title: impl Into<String>,
        claim: impl Into<String>,
        verdict: impl Into<Verdict>,
    ) -> Self {
        Self {
            id: id.into(),
            title: title.into(),
            claim: claim.into(),
            verdict: verdict.into(),
            notes: Vec::new(),
            panels: Vec::new(),
        }
    }

    /// With one more panel, below those there are.
    pub fn panel(mut self, panel: impl Panel + 'static) -> Self {
        self.panels.push(Box::new(panel));
        self
    }

    /// With one more entry in the caption, such as `("Reference", "closed form, exact to 1e-12")`.
    pub fn note(mut self, name: impl Into<String>, content: impl Into<String>) -> Self {
        self.notes.push((name.into(), content.into()));
        self
    }

    /// The plate's number.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// The plate's title.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The sentence the figure claims.
    pub fn claim(&self) -> &str {
        &self.claim
    }

    /// Whether the claim holds.
    pub fn verdict(&self) -> Verdict {
        self.verdict
    }

    /// The caption as plain text, an entry a line.
    pub fn caption(&self) -> String {
        let lines: Vec<String> =
            self.notes.iter().map(|(name, content)| format!("{name}: {content}")).collect();
        lines.join("\n")
    }

    /// Draws the plate.
    pub fn canvas(&self) -> Canvas {
        let parts: [Box<dyn Panel + '_>; 3] =
            [Box::new(Header(self)), Box::new(Claim(self)), Box::new(Caption(self))];
        let [header, claim, caption] = &parts;
        let panels = self.panels.iter().map(|panel| &**panel);
        let stack: Vec<&dyn Panel> =
            [&**header].into_iter().chain(panels).chain([&**claim, &**caption]).collect();
        let heights: Vec<f64> = stack.iter().map(|panel| panel.height(BODY)).collect();
        let height = 2.0 * MARGIN + heights.iter().sum::<f64>() + GAP * (stack.len() - 1) as f64;
        let mut canvas = Canvas::new(WIDTH, height.ceil());
        let description = format!("{}: {}\n{}", self.verdict.text(), self.claim, self.caption());
        canvas.describe(format!("{} {}", self.id, self.title), description);
        let mut y = MARGIN;
        for (panel, height) in stack.into_iter().zip(heights) {
            panel.draw(&mut canvas, Rect::new(MARGIN, y, BODY, height));
            y += height + GAP;
        }
        canvas
    }
}

struct Header<'a>(&'a Plate);

impl Header<'_> {
    fn id(&self) -> Text {
        Text::new(&self.0.id, TITLE).color(MUTED)
    }

    fn title(&self, width: f64) -> (Paragraph, f64) {
        let left = self.id().width() + 0.6 * TITLE;
        (Paragraph::new(Text::new(&self.0.title, TITLE).bold().color(ACCENT), width - left), left)
    }
}

impl Panel for Header<'_> {
    fn height(&self, width: f64) -> f64 {
        self.title(width).0.height()
    }

    fn draw(&self, canvas: &mut Canvas, rect: Rect) {
        canvas.text([rect.x, rect.y + TITLE], self.id());
        let (title, left) = self.title(rect.width);
        title.draw(canvas, [rect.x + left, rect.y]);
    }
}

struct Claim<'a>(&'a Plate);

const BADGE_PAD: f64 = 16.0;

impl Claim<'_> {
    fn badge(&self) -> Text {
        Text::new(self.0.verdict.text(), LABEL + 1.0).bold().color(Color::WHITE)
    }

    fn sentence(&self, width: f64) -> (Paragraph, f64) {
        let left = self.badge().width() + 2.0 * BADGE_PAD + 22.0;
        (Paragraph::new(Text::new(&self.0.claim, CLAIM), width - left), left)
    }
}

impl Panel for Claim<'_> {
    fn height(&self, width: f64) -> f64 {
        self.sentence(width).0.height().max(LEADING * CLAIM)
    }

    fn draw(&self, canvas: &mut Canvas, rect: Rect) {
        let badge = self.badge();
        let (sentence, left) = self.sentence(rect.width);
        // The badge is centred on the capitals of the sentence's first line.
        let middle = rect.y + CLAIM * (1.0 - CAP_HEIGHT / 2.0);
        let pill = Rect::new(rect.x, middle - 20.0, badge.width() + 2.0 * BADGE_PAD, 40.0);
        canvas.rounded_rect(pill, 6.0, Style::fill(self.0.verdict.color()));
        canvas.text([pill.x + BADGE_PAD, middle + CAP_HEIGHT / 2.0 * (LABEL + 1.0)], badge);
        sentence.draw(canvas, [rect.x + left, rect.y]);
    }
}

struct Caption<'a>(&'a Plate);

impl Caption<'_> {
    /// The entries with their names, and where their contents begin.
    fn entries(&self, width: f64) -> (Vec<(Text, Paragraph)>, f64) {
        let names =
            self.0.notes.iter().map(|(name, _)| Text::new(name, CAPTION).bold().color(MUTED));
        let names: Vec<Text> = names.collect();
        let left = names.iter().map(Text::width).fold(0.0, f64::max) + 1.2 * CAPTION;
        let contents = self.0.notes.iter().map(|(_, content)| {
            Paragraph::new(Text::new(content, CAPTION).color(INK), width - left)
        });
        (names.iter().cloned().zip(contents).collect(), left)
    }
}

/// Between the rule over the caption and its first line.
const RULE: f64 = 16.0;
const BETWEEN_ENTRIES: f64 = 4.0;

impl Panel for Caption<'_> {
    fn height(&self, width: f64) -> f64 {
        let entries = self.entries(width).0;
        RULE + entries.iter().map(|(_, content)| content.height() + BETWEEN_ENTRIES).sum::<f64>()
    }

    fn draw(&self, canvas: &mut Canvas, rect: Rect) {
        let (entries, left) = self.entries(rect.width);
        canvas.line([rect.x, rect.y], [rect.right(), rect.y], Stroke::new(FAINT, 2.0));
        let mut y = rect.y + RULE;
        for (name, content) in entries {
            canvas.text([rect.x, y + CAPTION], name);
            content.draw(canvas, [rect.x + left, y]);
            y += content.height() + BETWEEN_ENTRIES;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_captions_make_the_plate_taller_not_fuller() {
        let plate = |words: usize| {
            Plate::new("2.9", "Penumbra", "Beams win. ".repeat(words), true)
                .note("Method", "a sentence of settings, ".repeat(words))
                .note("Command", "x".repeat(40 * words))
                .canvas()
        };
        let (short, long) = (plate(1), plate(60));
        assert!(long.height() > short.height() + 400.0);
        assert_eq!(long.faults(), []);
        assert_eq!(short.faults(), []);
        assert_eq!(long.width(), WIDTH);
    }

    #[test]
    fn the_verdict_is_said_in_words() {
        let claim = "n < 3 & \"holds\"";
        let svg = |holds: bool| Plate::new("1.1", "T", claim, holds).canvas().to_svg();
        assert!(svg(true).contains("✓ HOLDS") && !svg(true).contains("FAILS"));
        assert!(svg(false).contains("✗ FAILS"));
        assert!(svg(true).contains("n &lt; 3 &amp; &quot;holds&quot;"));
    }

    #[test]
    fn the_same_plate_gives_the_same_bytes() {
        let plate = || Plate::new("1.1", "Title", "Claim.", true).note("Method", "appel");
        assert_eq!(plate().canvas().to_png(1.0), plate().canvas().to_png(1.0));
        assert_eq!(plate().canvas().to_svg(), plate().canvas().to_svg());
    }
}
