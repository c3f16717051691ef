//! Charts of points and lines over two axes.

use crate::axis::{Axis, Scale, has_place};
use crate::canvas::Canvas;
use crate::chart_layout::Layout;
use crate::geometry::{Point, Rect};
use crate::plate::Panel;
use crate::shape::{Anchor, Color, Stroke, Style, Text};
use crate::style::{CAP_HEIGHT, FAINT, HEADING, INK, LABEL, MUTED, TICK};

/// A measured value with the least and the greatest of its repetitions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The least.
    pub low: f64,
    /// The one that stands for all, such as the median.
    pub mid: f64,
    /// The greatest.
    pub high: f64,
}

impl Spread {
    /// The least, the median (of an even number, the mean of the middle two) and the greatest of some runs.
    ///
    /// # Panics
    /// If there is no run.
    pub fn of_runs(runs: &[f64]) -> Self {
        assert!(!runs.is_empty(), "a measurement has at least one run");
        let mut sorted = runs.to_vec();
        sorted.sort_by(f64::total_cmp);
        let middle = (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2]) / 2.0;
        Self { low: sorted[0], mid: middle, high: sorted[sorted.len() - 1] }
    }
}

impl From<f64> for Spread {
    /// A value without repetitions.
    fn from(value: f64) -> Self {
        Self { low: value, mid: value, high: value }
    }
}

/// One point of a series.
#[derive(Clone, Debug, PartialEq)]
pub struct Datum {
    /// Its place to the right.
    pub x: Spread,
    /// Its place upwards.
    pub y: Spread,
    /// What is written beside it where there is room; may be empty.
    pub note: String,
}

impl Datum {
    fn has_place(&self) -> bool {
        [self.x, self.y].iter().all(|s| [s.low, s.mid, s.high].into_iter().all(has_place))
    }
}

/// Points that belong together, with a label and a colour.
#[derive(Clone, Debug)]
pub struct Series {
    pub(crate) label: String,
    pub(crate) color: Color,
    pub(crate) data: Vec<Datum>,
    pub(crate) line: Option<Stroke>,
    pub(crate) marks: bool,
}

impl Series {
    /// A series whose points are marked and joined in the order they are added.
    pub fn new(label: impl Into<String>, color: Color) -> Self {
        Self {
            label: label.into(),
            color,
            data: Vec::new(),
            line: Some(Stroke::new(color, 3.0)),
            marks: true,
        }
    }

    /// With one more point.
    pub fn point(self, x: impl Into<Spread>, y: impl Into<Spread>) -> Self {
        self.noted(x, y, "")
    }

    /// With one more point and what to write beside it.
    pub fn noted(
        mut self,
        x: impl Into<Spread>,
        y: impl Into<Spread>,
        note: impl Into<String>,
    ) -> Self {
        self.data.push(Datum { x: x.into(), y: y.into(), note: note.into() });
        self
    }

    /// With more points.
    pub fn points(mut self, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let data = points.into_iter().map(|(x, y)| Datum {
            x: x.into(),
            y: y.into(),
            note: String::new(),
        });
        self.data.extend(data);
        self
    }

    /// Marks only: a scatter.
    pub fn scatter(self) -> Self {
        Self { line: None, ..self }
    }

    /// Line only: a curve.
    pub fn curve(self) -> Self {
        Self { marks: false, ..self }
    }

    /// With a dashed line.
    pub fn dashed(self) -> Self {
        Self { line: self.line.map(|line| line.dashed(10.0, 6.0)), ..self }
    }

    /// The points that have a place on a chart.
    pub(crate) fn shown(&self) -> impl Iterator<Item = &Datum> {
        self.data.iter().filter(|datum| datum.has_place())
    }
}

/// A line across the chart at one value.
#[derive(Clone, Debug)]
pub(crate) struct Marker {
    pub(crate) upright: bool,
    pub(crate) value: f64,
    pub(crate) label: String,
}

/// A chart. Labels stand beside what they name and overlap nothing; those without room there go to the
/// right of the frame, tied to their line by a thin leader.
#[derive(Clone, Debug)]
pub struct Chart {
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) series: Vec<Series>,
    pub(crate) markers: Vec<Marker>,
    pub(crate) guides: Vec<(f64, String)>,
    pub(crate) better: bool,
    height: f64,
}

impl Chart {
    /// A chart without data, 520 px tall.
    pub fn new(x: Axis, y: Axis) -> Self {
        Self {
            title: String::new(),
            x,
            y,
            series: Vec::new(),
            markers: Vec::new(),
            guides: Vec::new(),
            better: false,
            height: 520.0,
        }
    }

    /// With a title over the frame.
    pub fn title(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// With one more series.
    pub fn series(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// With a short line of the given slope (in decades per decade between log axes) to compare with.
    pub fn slope(mut self, slope: f64, label: impl Into<String>) -> Self {
        self.guides.push((slope, label.into()));
        self
    }

    /// With a horizontal line at `y`.
    pub fn horizontal(self, y: f64, label: impl Into<String>) -> Self {
        self.marker(false, y, label.into())
    }

    /// With an upright line at `x`.
    pub fn vertical(self, x: f64, label: impl Into<String>) -> Self {
        self.marker(true, x, label.into())
    }

    fn marker(mut self, upright: bool, value: f64, label: String) -> Self {
        self.markers.push(Marker { upright, value, label });
        self
    }

    /// With an arrow saying that the lower left is better.
    pub fn better_lower_left(self) -> Self {
        Self { better: true, ..self }
    }

    /// With another height, in px.
    pub fn height(self, height: f64) -> Self {
        Self { height, ..self }
    }
}

impl Panel for Chart {
    fn height(&self, _width: f64) -> f64 {
        // Were all labels to stand in one column, they must still have room.
        let labels = self.series.len() + self.markers.len() + self.guides.len() + 1;
        self.height.max(labels as f64 * 1.4 * LABEL + 130.0)
    }

    fn draw(&self, canvas: &mut Canvas, rect: Rect) {
        let layout = Layout::of(self, rect);
        self.draw_frame(canvas, rect, &layout);
        for &(from, to) in &layout.guides {
            canvas.line(from, to, Stroke::new(MUTED, 2.0).dashed(7.0, 5.0));
        }
        for &(from, to) in &layout.markers {
            canvas.line(from, to, Stroke::new(INK, 1.5).dashed(3.0, 4.0));
        }
        for (from, to, color) in &layout.leaders {
            canvas.line(*from, *to, Stroke::new(color.with_alpha(140), 1.2));
        }
        for (i, series) in self.series.iter().enumerate() {
            draw_series(canvas, series, i, &layout);
        }
        if let Some((from, to)) = layout.better {
            canvas.arrow(from, to, Stroke::new(INK, 3.0));
        }
        for (at, text) in layout.labels {
            canvas.text(at, text);
        }
    }
}

impl Chart {
    fn draw_frame(&self, canvas: &mut Canvas, rect: Rect, layout: &Layout) {
        let frame = layout.frame;
        if !self.title.is_empty() {
            let baseline = rect.y + CAP_HEIGHT * HEADING + 2.0;
            canvas.text([frame.x, baseline], Text::new(&self.title, HEADING).bold());
        }
        for (minor, width) in [(true, 0.6), (false, 1.3)] {
            let grid = Stroke::new(FAINT, width);
            for x in layout.grid_x(minor) {
                canvas.line([x, frame.y], [x, frame.bottom()], grid);
            }
            for y in layout.grid_y(minor) {
                canvas.line([frame.x, y], [frame.right(), y], grid);
            }
        }
        for band in zero_bands(layout) {
            canvas.rect(band, Style::fill(FAINT.with_alpha(120)));
        }
        let axis = Stroke::new(INK, 1.5);
        canvas.line([frame.x, frame.y], [frame.x, frame.bottom()], axis);
        canvas.line([frame.x, frame.bottom()], [frame.right(), frame.bottom()], axis);
        let below = frame.bottom() + 9.0 + CAP_HEIGHT * TICK;
        for tick in &layout.x_ticks {
            let text = Text::new(&tick.label, TICK).color(MUTED).centered();
            canvas.text([layout.x.at(tick.value), below], text);
        }
        for tick in &layout.y_ticks {
            let baseline = layout.y.at(tick.value) + CAP_HEIGHT / 2.0 * TICK;
            canvas.text(
                [frame.x - 9.0, baseline],
                Text::new(&tick.label, TICK).color(MUTED).anchor(Anchor::End),
            );
        }
        let title = |text: &str| Text::new(text, LABEL).centered();
        canvas.text([frame.center()[0], below + 12.0 + LABEL], title(&self.x.title));
        canvas.text([rect.x + LABEL, frame.center()[1]], title(&self.y.title).upwards());
        let lost: usize =
            self.series.iter().map(|series| series.data.len() - series.shown().count()).sum();
        if lost > 0 {
            let note = format!("not shown: {lost} without a finite value");
            let text = Text::new(note, TICK).color(MUTED).anchor(Anchor::End);
            canvas.text([frame.right(), rect.y + CAP_HEIGHT * HEADING], text);
        }
    }
}

fn zero_bands(layout: &Layout) -> Vec<Rect> {
    let frame = layout.frame;
    let across = layout.x.zero_band().map(|(a, b)| Rect::new(a, frame.y, b - a, frame.height));
    let under = layout.y.zero_band().map(|(a, b)| Rect::new(frame.x, b, frame.width, a - b));
    across.into_iter().chain(under).collect()
}

/// Half the width of an error bar's ends.
pub(crate) const CAP: f64 = 5.0;
/// Half the size of a mark.
pub(crate) const MARK: f64 = 6.0;

fn draw_series(canvas: &mut Canvas, series: &Series, index: usize, layout: &Layout) {
    let places: Vec<Point> = series.shown().map(|datum| layout.place(datum)).collect();
    if let Some(line) = series.line {
        if is_bright(series.color) {
            let rim = Stroke { color: series.color.for_text(), width: line.width + 1.6, ..line };
            canvas.polyline(places.clone(), rim);
        }
        canvas.polyline(places.clone(), line);
    }
    for datum in series.shown() {
        draw_bars(canvas, datum, series.color, &layout.x, &layout.y);
    }
    if series.marks {
        for place in places {
            draw_mark(canvas, place, series.color, index);
        }
    }
}

/// Whether a colour (yellow) needs a dark rim to be seen on white.
fn is_bright(color: Color) -> bool {
    color.luminance() > 0.5
}

fn draw_bars(canvas: &mut Canvas, datum: &Datum, color: Color, x: &Scale, y: &Scale) {
    let stroke = Stroke::new(color, 1.8);
    let [cx, cy] = [x.at(datum.x.mid), y.at(datum.y.mid)];
    if datum.x.low < datum.x.high {
        let (left, right) = (x.at(datum.x.low), x.at(datum.x.high));
        canvas.line([left, cy], [right, cy], stroke);
        for end in [left, right] {
            canvas.line([end, cy - CAP], [end, cy + CAP], stroke);
        }
    }
    if datum.y.low < datum.y.high {
        let (bottom, top) = (y.at(datum.y.low), y.at(datum.y.high));
        canvas.line([cx, bottom], [cx, top], stroke);
        for end in [bottom, top] {
            canvas.line([cx - CAP, end], [cx + CAP, end], stroke);
        }
    }
}

/// Marks differ by series too, so that colour is never the only difference.
fn draw_mark(canvas: &mut Canvas, [x, y]: Point, color: Color, index: usize) {
    let rim = if is_bright(color) { color.for_text() } else { Color::WHITE };
    let style = Style::fill(color).outlined(rim, 1.5);
    let r = MARK;
    match index % 4 {
        0 => canvas.circle([x, y], r, style),
        1 => canvas.rect(Rect::around([x, y], 1.8 * r, 1.8 * r), style),
        2 => canvas.polygon(
            vec![[x, y - 1.25 * r], [x + 1.2 * r, y + 0.9 * r], [x - 1.2 * r, y + 0.9 * r]],
            style,
        ),
        _ => {
            let d = 1.35 * r;
            canvas.polygon(vec![[x, y - d], [x + d, y], [x, y + d], [x - d, y]], style);
        }
    }
}
