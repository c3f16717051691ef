//! The one chart of speed against error, which every figure with a cost and an error uses.

use crate::axis::Axis;
use crate::canvas::Canvas;
use crate::chart::{Chart, Series, Spread};
use crate::geometry::Rect;
use crate::palette::method_color;
use crate::plate::{Panel, Row};

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
    /// Its name in [`METHODS`](crate::METHODS), which decides the colour.
    pub method: String,
    /// Its name in the chart.
    pub label: String,
    /// One point for each setting.
    pub points: Vec<CurvePoint>,
}

/// Error against counted work (deterministic) and against seconds (median with least and greatest), side
/// by side, all axes logarithmic, the better the lower and the further left.
#[derive(Clone, Debug)]
pub struct SpeedError {
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
            curves: Vec::new(),
            work_unit: work_unit.into(),
            error_name: error_name.into(),
            residual: None,
            slope: None,
        }
    }

    /// With one more method; a second curve of the same method is dashed.
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
        let mut chart = Chart::new(Axis::log(axis), Axis::log(&self.error_name))
            .title(title)
            .better_lower_left();
        for (i, curve) in self.curves.iter().enumerate() {
            let mut series = Series::new(&curve.label, method_color(&curve.method));
            for point in &curve.points {
                series = series.noted(cost(point), point.error, &point.knob);
            }
            let repeated = self.curves[..i].iter().any(|other| other.method == curve.method);
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
