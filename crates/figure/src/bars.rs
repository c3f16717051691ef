//! Bar charts: quantities of named things, from zero.

use crate::axis::{Axis, Scale};
use crate::canvas::Canvas;
use crate::geometry::{Point, Rect};
use crate::number::number;
use crate::plate::Panel;
use crate::shape::{Anchor, Color, Stroke, Style, Text};
use crate::style::{CAP_HEIGHT, FAINT, HEADING, INK, LABEL, LEADING, MUTED, TICK};

/// Level bars, one group for each category, with the value printed at each end.
#[derive(Clone, Debug)]
pub struct BarChart {
    title: String,
    axis: String,
    categories: Vec<String>,
    series: Vec<(String, Color, Vec<f64>)>,
    stacked: bool,
    first_printed: bool,
}

const BAR: f64 = 26.0;
const GROUP_GAP: f64 = 16.0;

impl BarChart {
    /// A chart without bars; `axis` names the quantity and its unit.
    pub fn new<S: Into<String>>(
        axis: impl Into<String>,
        categories: impl IntoIterator<Item = S>,
    ) -> Self {
        Self {
            title: String::new(),
            axis: axis.into(),
            categories: categories.into_iter().map(Into::into).collect(),
            series: Vec::new(),
            stacked: false,
            first_printed: false,
        }
    }

    /// With a title over the frame.
    pub fn title(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// With one more bar in every category.
    ///
    /// # Panics
    /// If there is not one finite value of at least 0 for each category.
    pub fn series(
        mut self,
        label: impl Into<String>,
        color: Color,
        values: impl Into<Vec<f64>>,
    ) -> Self {
        let (label, values) = (label.into(), values.into());
        assert_eq!(values.len(), self.categories.len(), "{label:?} has a value for each category");
        assert!(
            values.iter().all(|v| v.is_finite() && *v >= 0.0),
            "{label:?} has lengths: {values:?}"
        );
        self.series.push((label, color, values));
        self
    }

    /// The bars of a category one after another, as parts of a whole, instead of one below another.
    pub fn stacked(self) -> Self {
        Self { stacked: true, ..self }
    }

    /// With the first part's value at the end of a stacked bar instead of the sum.
    pub fn first_printed(self) -> Self {
        Self { first_printed: true, ..self }
    }

    fn group_height(&self) -> f64 {
        let bars = if self.stacked { 1 } else { self.series.len() };
        BAR * bars as f64 + GROUP_GAP
    }

    /// The bars of a category, of each series or of all together: where they end and what is printed there.
    fn printed(&self, category: usize) -> Vec<(f64, f64)> {
        let values = self.series.iter().map(|(_, _, values)| values[category]);
        if !self.stacked {
            return values.map(|value| (value, value)).collect();
        }
        let sum = values.clone().sum();
        vec![(sum, values.take(1).find(|_| self.first_printed).unwrap_or(sum))]
    }

    fn all_printed(&self) -> impl Iterator<Item = (f64, f64)> {
        (0..self.categories.len()).flat_map(|category| self.printed(category))
    }

    fn widest_value(&self) -> f64 {
        let widths = self.all_printed().map(|(_, value)| Text::new(number(value), TICK).width());
        // The tick of the longest bar is centred on its end.
        widths.fold(2.0 * TICK, f64::max)
    }

    /// The places of the legend's entries, and its height; a single series needs none.
    fn legend(&self, width: f64) -> (Vec<Point>, f64) {
        let line = LEADING * LABEL;
        let (mut x, mut y, mut places) = (0.0, 0.0, Vec::new());
        if self.series.len() < 2 {
            return (places, 0.0);
        }
        for (label, _, _) in &self.series {
            let wide = SWATCH + 8.0 + Text::new(label, LABEL).width();
            if x > 0.0 && x + wide > width {
                (x, y) = (0.0, y + line);
            }
            places.push([x, y]);
            x += wide + 28.0;
        }
        (places, y + line + 8.0)
    }

    fn top(&self, width: f64) -> f64 {
        let title = if self.title.is_empty() { 0.0 } else { 1.7 * HEADING };
        title + self.legend(width).1
    }

    fn draw_category(&self, canvas: &mut Canvas, scale: &Scale, category: usize, top: f64) {
        let zero = scale.at(0.0);
        let mut before = 0.0;
        for (i, (_, color, values)) in self.series.iter().enumerate() {
            let length = scale.at(values[category]) - zero;
            let (left, y) = if self.stacked { (before, top) } else { (0.0, top + i as f64 * BAR) };
            canvas.rect(Rect::new(zero + left, y + 2.0, length, BAR - 4.0), Style::fill(*color));
            before += length;
        }
        for (i, (end, value)) in self.printed(category).into_iter().enumerate() {
            let baseline = top + (i as f64 + 0.5) * BAR + CAP_HEIGHT / 2.0 * TICK;
            canvas.text([scale.at(end) + 8.0, baseline], Text::new(number(value), TICK));
        }
    }
}

const SWATCH: f64 = 18.0;

impl Panel for BarChart {
    fn height(&self, width: f64) -> f64 {
        let axis = 9.0 + TICK + 12.0 + LABEL + 6.0;
        self.top(width) + self.categories.len() as f64 * self.group_height() + GROUP_GAP + axis
    }

    fn draw(&self, canvas: &mut Canvas, rect: Rect) {
        if !self.title.is_empty() {
            canvas.text(
                [rect.x, rect.y + CAP_HEIGHT * HEADING + 2.0],
                Text::new(&self.title, HEADING).bold(),
            );
        }
        let top = rect.y + self.top(rect.width);
        let (places, legend_height) = self.legend(rect.width);
        for ([x, y], (label, color, _)) in places.into_iter().zip(&self.series) {
            let corner = [rect.x + x, top - legend_height + y];
            canvas.rect(Rect::new(corner[0], corner[1], SWATCH, SWATCH), Style::fill(*color));
            canvas.text(
                [corner[0] + SWATCH + 8.0, corner[1] + CAP_HEIGHT * LABEL + 2.0],
                Text::new(label, LABEL),
            );
        }
        let names: Vec<Text> =
            self.categories.iter().map(|name| Text::new(name, LABEL).anchor(Anchor::End)).collect();
        let left = rect.x + names.iter().map(Text::width).fold(0.0, f64::max) + 14.0;
        let bottom = top + self.categories.len() as f64 * self.group_height() + GROUP_GAP;
        // The longest bar leaves room for its value.
        let right = rect.right() - self.widest_value() - 8.0;
        let longest = self.all_printed().map(|(end, _)| end).fold(f64::MIN_POSITIVE, f64::max);
        let scale = Axis::linear("").between(0.0, longest).scale([], left, right);
        let below = bottom + 9.0 + CAP_HEIGHT * TICK;
        for tick in scale.level_ticks() {
            let x = scale.at(tick.value);
            canvas.line([x, top], [x, bottom], Stroke::new(FAINT, 1.3));
            canvas.text([x, below], Text::new(tick.label, TICK).color(MUTED).centered());
        }
        for (i, name) in names.into_iter().enumerate() {
            let y = top + GROUP_GAP + i as f64 * self.group_height();
            let middle = y + (self.group_height() - GROUP_GAP) / 2.0;
            canvas.text([left - 14.0, middle + CAP_HEIGHT / 2.0 * LABEL], name);
            self.draw_category(canvas, &scale, i, y);
        }
        canvas.line([left, top], [left, bottom], Stroke::new(INK, 1.5));
        canvas.text(
            [(left + right) / 2.0, below + 12.0 + LABEL],
            Text::new(&self.axis, LABEL).centered(),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_and_labels_have_room() {
        let chart = BarChart::new("tests per ray", ["stadium", "hall of mirrors", "teapot"])
            .title("Where time goes")
            .series("intersection", Color::rgb(0, 0, 200), [120.0, 3.25e6, 77.5])
            .series("shading", Color::rgb(200, 0, 0), [1.0, 2.0, 0.0]);
        for chart in [chart.clone(), chart.stacked()] {
            let height = chart.height(600.0);
            let mut canvas = Canvas::new(600.0, height);
            chart.draw(&mut canvas, Rect::new(0.0, 0.0, 600.0, height));
            assert_eq!(canvas.faults(), []);
        }
    }

    #[test]
    fn a_stacked_bar_prints_its_sum_or_its_first_part() {
        let stacked = BarChart::new("%", ["a"])
            .series("first", INK, [90.5])
            .series("second", MUTED, [9.25])
            .stacked();
        assert_eq!(stacked.printed(0), [(99.75, 99.75)]);
        assert_eq!(stacked.first_printed().printed(0), [(99.75, 90.5)]);
    }

    #[test]
    #[should_panic(expected = "a value for each category")]
    fn a_missing_value_is_named() {
        let _ = BarChart::new("", ["a", "b"]).series("s", INK, [1.0]);
    }
}
