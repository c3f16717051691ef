//! Error heat maps: dark where there is little error, bright where there is much.

use crate::axis::Scale;
use crate::canvas::Canvas;
use crate::geometry::Rect;
use crate::picture::Picture;
use crate::shape::{Anchor, Color, Stroke, Style, Text};
use crate::style::{CAP_HEIGHT, DESCENT, INK, LABEL, MUTED, TICK};

/// Equally spaced colours of the ramp; luminance grows from each to the next.
const RAMP: [[u8; 3]; 8] = [
    [0, 0, 12],
    [36, 14, 90],
    [92, 22, 126],
    [160, 36, 108],
    [216, 70, 62],
    [244, 132, 24],
    [250, 198, 52],
    [254, 252, 200],
];

/// The colour of values that are not numbers; not on the ramp.
const NOT_A_NUMBER: [u8; 3] = [0, 230, 230];

/// The colour of `part` of the way (0 to 1, clamped) from no error to the most; NaN is cyan.
pub fn heat_color(part: f64) -> [u8; 3] {
    if part.is_nan() {
        return NOT_A_NUMBER;
    }
    let along = part.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let step = (along as usize).min(RAMP.len() - 2);
    let [low, high] = [RAMP[step], RAMP[step + 1]].map(|[r, g, b]| Color::rgb(r, g, b));
    low.mix(high, along - step as f64).rgb
}

/// The scale that several heat maps share, so that they can be compared.
#[derive(Clone, Debug)]
pub struct HeatScale {
    label: String,
    log: bool,
    low: f64,
    high: f64,
}

impl HeatScale {
    /// A linear scale from `low` to `high`; the label names the quantity and its unit.
    ///
    /// # Panics
    /// If `low` is not below `high`.
    pub fn linear(label: impl Into<String>, low: f64, high: f64) -> Self {
        assert!(low < high, "a scale goes from low to high, not from {low} to {high}");
        Self { label: label.into(), log: false, low, high }
    }

    /// A logarithmic scale from `low` to `high`, both above 0.
    ///
    /// # Panics
    /// If `low` is not above 0 and below `high`.
    pub fn log(label: impl Into<String>, low: f64, high: f64) -> Self {
        assert!(low > 0.0, "a log scale begins above 0, not at {low}");
        Self { log: true, ..Self::linear(label, low, high) }
    }

    /// How far `value` lies on the scale: 0 at its low end, 1 at its high end.
    fn part(&self, value: f64) -> f64 {
        if self.log {
            let value = if value <= 0.0 { self.low } else { value };
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// The heat map of `values`, row by row from the upper left corner; values beyond the scale get the
    /// colours of its ends.
    ///
    /// # Panics
    /// If there are not `width` × `height` values.
    pub fn paint(&self, width: u32, height: u32, values: &[f64]) -> Picture {
        Picture::new(
            width,
            height,
            values.iter().map(|&value| heat_color(self.part(value))).collect(),
        )
    }

    /// The width its colour bar takes, labels included.
    pub(crate) fn bar_width(&self) -> f64 {
        let widest =
            self.ticks(Rect::new(0.0, 0.0, BAR, 300.0)).into_iter().map(|(text, _)| text.width());
        BAR + TICK_GAP + widest.fold(0.0, f64::max) + 1.6 * LABEL
    }

    /// Draws the scale as an upright colour bar at the left of `rect`, over its whole height.
    pub(crate) fn draw_bar(&self, canvas: &mut Canvas, rect: Rect) {
        const STEPS: u32 = 256;
        let bar = Rect::new(rect.x, rect.y, BAR, rect.height);
        let ramp = Picture::from_fn(1, STEPS, |_, y| {
            heat_color(1.0 - f64::from(y) / f64::from(STEPS - 1))
        });
        canvas.picture(bar, ramp);
        canvas.rect(bar, Style::outline(MUTED, 1.0));
        for (text, y) in self.ticks(bar) {
            canvas.line([bar.right(), y], [bar.right() + 5.0, y], Stroke::new(MUTED, 1.0));
            // Labels of the ends stay within the bar's height.
            let baseline =
                (y + CAP_HEIGHT / 2.0 * TICK).clamp(bar.y + CAP_HEIGHT * TICK, bar.bottom());
            canvas.text([bar.right() + TICK_GAP, baseline], text);
        }
        let title = Text::new(&self.label, LABEL).color(INK).upwards().centered();
        canvas.text([rect.x + self.bar_width() - DESCENT * LABEL, bar.center()[1]], title);
    }

    fn ticks(&self, bar: Rect) -> Vec<(Text, f64)> {
        let scale = Scale::exactly(self.log, self.low, self.high, bar.bottom(), bar.y);
        let ticks = scale.ticks(2.5 * TICK).into_iter();
        ticks
            .map(|tick| {
                (
                    Text::new(tick.label, TICK).color(MUTED).anchor(Anchor::Start),
                    scale.at(tick.value),
                )
            })
            .collect()
    }
}

const BAR: f64 = 22.0;
const TICK_GAP: f64 = 10.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brighter_means_more() {
        let luminance = |part: f64| {
            let [r, g, b] = heat_color(part);
            Color::rgb(r, g, b).luminance()
        };
        let ramp: Vec<f64> = (0..=200).map(|i| luminance(f64::from(i) / 200.0)).collect();
        assert!(ramp.windows(2).all(|pair| pair[0] <= pair[1] + 1e-4), "monotone");
        assert!((0..10).all(|i| ramp[i * 20] + 0.004 < ramp[(i + 1) * 20]), "every tenth is seen");
        assert!(ramp[0] < 0.001 && ramp[200] > 0.9);
    }

    #[test]
    fn scales_map_their_ends_and_their_middle() {
        let log = HeatScale::log("relMSE", 1e-4, 1.0);
        assert!((log.part(1e-2) - 0.5).abs() < 1e-12);
        assert_eq!(log.part(0.0), 0.0);
        let linear = HeatScale::linear("tests", 10.0, 30.0);
        assert_eq!(linear.part(20.0), 0.5);
        let map = linear.paint(3, 1, &[-5.0, 99.0, f64::NAN]);
        assert_eq!(
            [map.get(0, 0), map.get(1, 0), map.get(2, 0)],
            [heat_color(0.0), heat_color(1.0), NOT_A_NUMBER]
        );
    }
}
