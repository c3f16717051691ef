//! Where everything in a chart goes: the frame, the axes, and each label.

use crate::axis::{Scale, Tick, widest};
use crate::chart::{CAP, Chart, Datum, MARK, Marker, Series, Spread};
use crate::geometry::{Point, Rect, along};
use crate::labels::{Room, beside, spread};
use crate::shape::{Color, Text};
use crate::style::{ASCENT, CAP_HEIGHT, DESCENT, HEADING, INK, LABEL, MUTED, SMALLEST, TICK};

/// A chart's geometry in one rectangle.
pub(crate) struct Layout {
    pub(crate) frame: Rect,
    pub(crate) x: Scale,
    pub(crate) y: Scale,
    pub(crate) x_ticks: Vec<Tick>,
    pub(crate) y_ticks: Vec<Tick>,
    /// Labels with their halo, at the positions of their baselines.
    pub(crate) labels: Vec<(Point, Text)>,
    pub(crate) guides: Vec<(Point, Point)>,
    pub(crate) markers: Vec<(Point, Point)>,
    /// Thin lines to the labels right of the frame.
    pub(crate) leaders: Vec<(Point, Point, Color)>,
    pub(crate) better: Option<(Point, Point)>,
}

/// A label that found no room inside the frame, and the point it names.
struct Homeless {
    text: Text,
    target: Option<Point>,
}

const LEADER: f64 = 22.0;

impl Layout {
    /// Lays the chart out in `rect`.
    pub(crate) fn of(chart: &Chart, rect: Rect) -> Self {
        // A narrower frame may leave more labels without a home: widen the gutter until it takes all.
        let mut gutter = 0.0;
        loop {
            let mut layout = Self::framed(chart, rect, gutter);
            let homeless = layout.place_labels(chart);
            let needed =
                homeless.iter().map(|label| label.text.width() + LEADER).fold(0.0, f64::max);
            if needed <= gutter {
                layout.fill_gutter(homeless);
                return layout;
            }
            gutter = needed;
        }
    }

    fn framed(chart: &Chart, rect: Rect, gutter: f64) -> Self {
        let top = if chart.title.is_empty() { 0.6 * TICK } else { 1.7 * HEADING };
        let bottom = 9.0 + CAP_HEIGHT * TICK + 12.0 + LABEL + DESCENT * LABEL;
        let (y_top, y_bottom) = (rect.y + top, rect.bottom() - bottom);
        let values = |upright: bool, of: fn(&Datum) -> Spread| {
            let markers =
                chart.markers.iter().filter(move |m| m.upright == upright).map(|m| m.value);
            let data = chart.series.iter().flat_map(Series::shown);
            data.flat_map(move |datum| [of(datum).low, of(datum).mid, of(datum).high])
                .chain(markers)
        };
        let y = chart.y.scale(values(false, |datum| datum.y), y_bottom, y_top);
        let y_ticks = y.ticks(2.6 * TICK);
        let title = if chart.y.title.is_empty() { 0.0 } else { 1.6 * LABEL };
        let left = rect.x + title + widest(&y_ticks) + 9.0;
        // The last label may be centred on the frame's corner.
        let full_width = chart.x.scale(values(true, |datum| datum.x), left, rect.right());
        let right = rect.right() - gutter.max(widest(&full_width.level_ticks()) / 2.0 + 2.0);
        let x = chart.x.scale(values(true, |datum| datum.x), left, right);
        let x_ticks = x.level_ticks();
        let across = |marker: &Marker| {
            let (x, y) = (x.at(marker.value), y.at(marker.value));
            if marker.upright { ([x, y_bottom], [x, y_top]) } else { ([left, y], [right, y]) }
        };
        Self {
            frame: Rect::new(left, y_top, right - left, y_bottom - y_top),
            markers: chart.markers.iter().map(across).collect(),
            x,
            y,
            x_ticks,
            y_ticks,
            labels: Vec::new(),
            guides: Vec::new(),
            leaders: Vec::new(),
            better: None,
        }
    }

    /// Where a point lies.
    pub(crate) fn place(&self, datum: &Datum) -> Point {
        [self.x.at(datum.x.mid), self.y.at(datum.y.mid)]
    }

    /// Where the upright grid lines are: the minor or the labelled ones.
    pub(crate) fn grid_x(&self, minor: bool) -> Vec<f64> {
        grid(&self.x, &self.x_ticks, minor)
    }

    /// Where the level grid lines are.
    pub(crate) fn grid_y(&self, minor: bool) -> Vec<f64> {
        grid(&self.y, &self.y_ticks, minor)
    }

    /// Places all labels, the important ones first, and returns those that must go elsewhere.
    fn place_labels(&mut self, chart: &Chart) -> Vec<Homeless> {
        let mut room = self.room(chart);
        let mut homeless = self.name_series(chart, &mut room);
        self.name_markers(chart, &mut room, &mut homeless);
        if chart.better {
            self.place_better(&mut room, &mut homeless);
        }
        for (slope, label) in &chart.guides {
            self.place_guide(chart, *slope, label, &mut room, &mut homeless);
        }
        for (owner, series) in chart.series.iter().enumerate() {
            for datum in series.shown().filter(|datum| !datum.note.is_empty()) {
                let text = note_text(series, datum);
                let candidates = beside(self.place(datum), size(&text), MARK + 4.0);
                if let Some(rect) = room.place_name(owner, MARK, candidates) {
                    self.write(text, rect);
                }
            }
        }
        homeless
    }

    /// The frame, with everything taken that is drawn from data.
    fn room(&self, chart: &Chart) -> Room {
        let mut room = Room::new(self.frame.grown(-3.0));
        for (i, series) in chart.series.iter().enumerate() {
            let owner = Some(i);
            let places: Vec<Point> = series.shown().map(|datum| self.place(datum)).collect();
            if series.line.is_some() {
                places.windows(2).for_each(|pair| room.cross(owner, pair[0], pair[1]));
            }
            for (&[x, y], datum) in places.iter().zip(series.shown()) {
                if series.marks {
                    room.take(owner, Rect::around([x, y], 2.4 * MARK, 2.4 * MARK));
                }
                let (left, right) = (self.x.at(datum.x.low), self.x.at(datum.x.high));
                let (bottom, top) = (self.y.at(datum.y.low), self.y.at(datum.y.high));
                room.take(owner, Rect::new(left, y - CAP, right - left, 2.0 * CAP));
                room.take(owner, Rect::new(x - CAP, top, 2.0 * CAP, bottom - top));
            }
        }
        self.markers.iter().for_each(|&(from, to)| room.cross(None, from, to));
        room
    }

    /// Names each series beside its right end, else its left end, else anywhere along it, else at the end
    /// of a leader; returns the names without room.
    fn name_series(&mut self, chart: &Chart, room: &mut Room) -> Vec<Homeless> {
        let apart = MARK + 7.0;
        let mut unnamed = Vec::new();
        for (owner, series) in chart.series.iter().enumerate().filter(|(_, s)| !s.label.is_empty())
        {
            let anchors = self.anchors(series);
            let Some(&end) = anchors.first() else { continue };
            let text = series_text(series);
            let candidates =
                anchors.into_iter().flat_map(|at| beside(at, size(&text), apart - 2.0));
            match room.place_name(owner, apart, candidates) {
                Some(rect) => self.write(text, rect),
                None => unnamed.push((owner, end, text)),
            }
        }
        let mut homeless = Vec::new();
        for (owner, end, text) in unnamed {
            // Where the way to the right of the frame is short, names stand in line there.
            let reach = (self.frame.right() - end[0]).min(200.0) - 60.0;
            let [width, height] = size(&text);
            let spots = room.spots(end).into_iter().map(|spot| Rect::around(spot, width, height));
            let within = spots.filter(|rect| {
                let foot = rect.nearest(end);
                (foot[0] - end[0]).hypot(foot[1] - end[1]) < reach
            });
            match room.place_led(owner, apart, end, within.collect::<Vec<_>>()) {
                Some((rect, foot)) => {
                    self.leaders.push((end, foot, text.color));
                    self.write(text, rect);
                }
                None => homeless.push(Homeless { text, target: Some(end) }),
            }
        }
        homeless
    }

    /// Where a series may be named: its right end, its left end, its other points and the middles between,
    /// from the right.
    fn anchors(&self, series: &Series) -> Vec<Point> {
        let places: Vec<Point> = series.shown().map(|datum| self.place(datum)).collect();
        let mut anchors = places.clone();
        if series.line.is_some() {
            anchors.extend(places.windows(2).map(|pair| along(pair[0], pair[1], 0.5)));
        }
        anchors.sort_by(|a, b| b[0].total_cmp(&a[0]));
        if let Some(left) = anchors.pop() {
            anchors.insert(anchors.len().min(1), left);
        }
        anchors
    }

    /// A marker is named along its line, the far end first.
    fn name_markers(&mut self, chart: &Chart, room: &mut Room, homeless: &mut Vec<Homeless>) {
        const GAP: f64 = 4.0;
        for (marker, (from, to)) in chart.markers.iter().zip(self.markers.clone()) {
            let text = marker_text(&marker.label);
            let [width, height] = size(&text);
            let candidates = (0..=20).flat_map(|step| {
                let inside = if marker.upright { height } else { width } / 2.0 + GAP;
                let length = (to[0] - from[0]).abs() + (to[1] - from[1]).abs();
                let part =
                    1.0 - inside / length - f64::from(step) / 20.0 * (1.0 - 2.0 * inside / length);
                let at = along(from, to, part);
                [1.0, -1.0].map(|side| {
                    let offset = if marker.upright {
                        [side * (width / 2.0 + GAP), 0.0]
                    } else {
                        [0.0, -side * (height / 2.0 + GAP)]
                    };
                    Rect::around([at[0] + offset[0], at[1] + offset[1]], width, height)
                })
            });
            match room.place(candidates) {
                Some(rect) => self.write(text, rect),
                None => homeless.push(Homeless { text, target: Some(to) }),
            }
        }
    }

    /// The arrow to where charts are best, as near to that corner as there is room.
    fn place_better(&mut self, room: &mut Room, homeless: &mut Vec<Homeless>) {
        const ARROW: f64 = 46.0;
        let text = better_text();
        let (width, height) = (ARROW + 6.0 + text.width(), ARROW);
        let corner = [self.frame.x, self.frame.bottom()];
        let spots =
            room.spots(corner).into_iter().map(|spot| Rect::around(spot, width, height).grown(6.0));
        let Some(rect) = room.place(spots) else {
            homeless
                .push(Homeless {
                    text: Text { content: "↙ better".into(), ..text }, target: None
                });
            return;
        };
        let rect = rect.grown(-6.0);
        self.better = Some(([rect.x + ARROW, rect.y], [rect.x, rect.bottom()]));
        self.labels.push(([rect.x + ARROW + 6.0, rect.y + CAP_HEIGHT * LABEL], text));
    }

    /// A short line of the given slope near the data, with its label beside its middle.
    fn place_guide(
        &mut self,
        chart: &Chart,
        slope: f64,
        label: &str,
        room: &mut Room,
        homeless: &mut Vec<Homeless>,
    ) {
        let rise_per_run = slope * self.y.per_unit() / self.x.per_unit();
        let run =
            (0.22 * self.frame.width).min(0.3 * self.frame.height / rise_per_run.abs().max(1e-9));
        let half = [run / 2.0, rise_per_run * run / 2.0];
        let text = marker_text(label);
        let [width, height] = size(&text);
        let data = chart.series.iter().flat_map(Series::shown).map(|datum| self.place(datum));
        let (count, sum) =
            data.fold((0, [0.0; 2]), |(n, sum), p| (n + 1, [sum[0] + p[0], sum[1] + p[1]]));
        let aim = if count == 0 { self.frame.center() } else { sum.map(|s| s / f64::from(count)) };
        for spot in room.spots(aim) {
            let ends =
                ([spot[0] - half[0], spot[1] - half[1]], [spot[0] + half[0], spot[1] + half[1]]);
            let free = (0..=12).all(|i| {
                room.fits(&Rect::around(along(ends.0, ends.1, f64::from(i) / 12.0), 26.0, 26.0))
            });
            if !free {
                continue;
            }
            // Right of the line's middle on its open side: above a falling line, below a rising one.
            let lean = if half[1] > 0.0 { -1.0 } else { 1.0 };
            let beside = [lean, -lean].map(|side| {
                let drop = side * (0.55 * height + 2.0);
                Rect::around(
                    [
                        spot[0] + width / 2.0 + 8.0 - if side == lean { 0.0 } else { width + 16.0 },
                        spot[1] + drop,
                    ],
                    width,
                    height,
                )
            });
            if let Some(rect) = beside.into_iter().find(|rect| room.fits(&rect.grown(8.0))) {
                room.take(None, rect.grown(4.0));
                room.cross(None, ends.0, ends.1);
                self.guides.push(ends);
                self.write(text, rect);
                return;
            }
        }
        // Without room for the line itself there is nothing to compare with; the label says so.
        let text = Text { content: format!("({label}: no room)"), ..text };
        homeless.push(Homeless { text, target: None });
    }

    /// Puts labels one under another to the right of the frame, each near the height of its target.
    fn fill_gutter(&mut self, homeless: Vec<Homeless>) {
        let height = 1.3 * LABEL;
        let wanted: Vec<f64> = homeless
            .iter()
            .map(|h| h.target.map_or(self.frame.bottom(), |t| t[1]) - height / 2.0)
            .collect();
        let tops = spread(&wanted, height, self.frame.y, self.frame.bottom());
        let left = self.frame.right() + LEADER;
        for (Homeless { text, target }, top) in homeless.into_iter().zip(tops) {
            let rect = Rect::new(left, top, text.width(), height);
            if let Some(target) = target {
                self.leaders.push((target, [left - 5.0, rect.center()[1]], text.color));
            }
            self.write(text, rect);
        }
    }

    /// Writes `text` in the middle of the height of `rect`.
    fn write(&mut self, text: Text, rect: Rect) {
        let baseline = rect.center()[1] + CAP_HEIGHT / 2.0 * text.size;
        self.labels.push(([rect.x, baseline], text.halo()));
    }
}

fn grid(scale: &Scale, ticks: &[Tick], minor: bool) -> Vec<f64> {
    let values = if minor { scale.minor() } else { ticks.iter().map(|tick| tick.value).collect() };
    values.into_iter().map(|value| scale.at(value)).collect()
}

fn size(text: &Text) -> [f64; 2] {
    [text.width(), (ASCENT + DESCENT) * text.size]
}

fn series_text(series: &Series) -> Text {
    Text::new(&series.label, LABEL).bold().color(series.color.for_text())
}

fn note_text(series: &Series, datum: &Datum) -> Text {
    Text::new(&datum.note, SMALLEST).color(series.color.for_text())
}

fn marker_text(label: &str) -> Text {
    Text::new(label, TICK).color(MUTED)
}

fn better_text() -> Text {
    Text::new("better", LABEL).bold().color(INK)
}

#[cfg(test)]
mod tests;
