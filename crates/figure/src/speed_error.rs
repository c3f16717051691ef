//! The one chart of speed against error, which every figure with a cost and an error uses.

use crate::axis::Axis;
use crate::canvas::Canvas;
use crate::chart::{Chart, Series, Spread};
use crate::geometry::Rect;
use crate::plate::{Panel, Row};
use crate::shape::Color;

/// A method run at one setting of its knob.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvePoint {
    /// The setting, as written beside the point: `16`, `depth 3`.
    pub knob: String,
    /// The wall time in seconds: least, median and greatest of the runs.
    pub seconds: Spread,
    /// The counted work, in the chart's unit.
    pub work: u64,
    /// The error against the reference, at least 0.
    pub error: f64,
}

/// A method run at several settings of its knob, in the knob's order.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodCurve {
    /// Its name in the chart.
    pub label: String,
    /// Its colour: that of the method, or one of a category for variants of one method.
    pub color: Color,
    /// One point for each setting.
    pub points: Vec<CurvePoint>,
}

/// Error against counted work (deterministic) and against seconds (median with least and greatest), side
/// by side, all axes logarithmic, the better the lower and the further left.
#[derive(Clone, Debug)]
pub struct SpeedError {
    subject: String,
    curves: Vec<MethodCurve>,
    work_unit: String,
    error_name: String,
    residual: Option<f64>,
    slope: Option<(f64, String)>,
}

impl SpeedError {
    /// A chart without curves: the unit of the counted work (`rays`, `tests`) and the name of the error.
    pub fn new(work_unit: impl Into<String>, error_name: impl Into<String>) -> Self {
        Self {
            subject: String::new(),
            curves: Vec::new(),
            work_unit: work_unit.into(),
            error_name: error_name.into(),
            residual: None,
            slope: None,
        }
    }

    /// With the name of what is measured, such as a scene, before the charts' titles.
    pub fn subject(self, subject: impl Into<String>) -> Self {
        Self { subject: subject.into(), ..self }
    }

    /// With one more method; a second curve of the same colour is dashed.
    pub fn curve(mut self, curve: MethodCurve) -> Self {
        self.curves.push(curve);
        self
    }

    /// With a line at the reference's own error, below which differences mean nothing.
    pub fn reference_error(self, residual: f64) -> Self {
        Self { residual: Some(residual), ..self }
    }

    /// With a line of the slope to compare with, such as `-0.5` for Monte Carlo's RMSE.
    pub fn slope(self, slope: f64, label: impl Into<String>) -> Self {
        Self { slope: Some((slope, label.into())), ..self }
    }

    fn row(&self) -> Row {
        let work = |point: &CurvePoint| Spread::from(point.work as f64);
        let seconds = |point: &CurvePoint| point.seconds;
        Row::new()
            .panel(1.0, self.chart("Counted work", format!("work ({})", self.work_unit), work))
            .panel(1.0, self.chart("Time", "time (s)".to_owned(), seconds))
    }

    fn chart(&self, title: &str, axis: String, cost: fn(&CurvePoint) -> Spread) -> Chart {
        let title = match self.subject.as_str() {
            "" => title.to_owned(),
            subject => format!("{subject}: {}", title.to_lowercase()),
        };
        let mut chart = Chart::new(Axis::log(axis), Axis::log(&self.error_name))
            .title(title)
            .better_lower_left();
        for (i, curve) in self.curves.iter().enumerate() {
            let mut series = Series::new(&curve.label, curve.color);
            for point in &curve.points {
                series = series.noted(cost(point), point.error, &point.knob);
            }
            let repeated = self.curves[..i].iter().any(|other| other.color == curve.color);
            chart = chart.series(if repeated { series.dashed() } else { series });
        }
        if let Some(residual) = self.residual {
            chart = chart.horizontal(residual, "error of the reference itself");
        }
        if let Some((slope, label)) = &self.slope {
            chart = chart.slope(*slope, label);
        }
        chart
    }
}

impl Panel for SpeedError {
    fn height(&self, width: f64) -> f64 {
        self.row().height(width)
    }

    fn draw(&self, canvas: &mut Canvas, rect: Rect) {
        self.row().draw(canvas, rect);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::palette::method_color;

    fn chart() -> SpeedError {
        let point = |n: u64, error: f64| CurvePoint {
            knob: n.to_string(),
            seconds: Spread::of_runs(&[0.02 * n as f64, 0.01 * n as f64, 0.04 * n as f64]),
            work: 1000 * n,
            error,
        };
        let curve = |method: &str, label: &str, factor: f64| MethodCurve {
            label: label.into(),
            color: method_color(method),
            points: [1, 4, 16].map(|n| point(n, factor / (n as f64).sqrt())).to_vec(),
        };
        SpeedError::new("rays", "RMSE")
            .curve(curve("distributed", "random", 0.3))
            .curve(curve("distributed", "stratified", 0.1))
            .curve(curve("precise", "beams", 0.0))
            .reference_error(1e-4)
            .slope(-0.5, "slope −1/2")
    }

    fn drawn() -> Canvas {
        let height = chart().height(1300.0);
        let mut canvas = Canvas::new(1300.0, height);
        chart().draw(&mut canvas, Rect::new(0.0, 0.0, 1300.0, height));
        canvas
    }

    #[test]
    fn both_panels_name_every_method() {
        let (canvas, svg) = (drawn(), drawn().to_svg());
        assert_eq!(canvas.faults(), []);
        for label in ["random", "stratified", "beams", "better", "RMSE"] {
            assert_eq!(svg.matches(&format!("aria-label=\"{label}\"")).count(), 2, "{label}");
        }
        assert!(svg.contains("work (rays)") && svg.contains("time (s)"));
        assert!(svg.contains("stroke-dasharray=\"10 6\""), "the second of a method is dashed");
    }

    #[test]
    fn both_panels_name_their_subject() {
        let mut canvas = Canvas::new(1300.0, 600.0);
        chart().subject("room").draw(&mut canvas, Rect::new(0.0, 0.0, 1300.0, 600.0));
        let svg = canvas.to_svg();
        assert!(svg.contains("room: counted work") && svg.contains("room: time"));
    }

    #[test]
    fn the_median_of_an_even_number_of_runs_lies_between() {
        let runs = Spread::of_runs(&[4.0, 1.0, 2.0, 100.0]);
        assert_eq!(runs, Spread { low: 1.0, mid: 3.0, high: 100.0 });
    }
}
