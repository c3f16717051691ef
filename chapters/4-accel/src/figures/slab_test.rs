//! 4.13: what the slabs of a box leave of a ray.

use glam::DVec2;
use lancer_core::geometry::{Interval, Ray, Slabs};
use lancer_core::sampling::Uniform;
use lancer_figure::{
    Color, Drawing, Effort, FAINT, Finished, HEADING, INK, LABEL, MUTED, Pen, Plate, Row, Stroke,
    Style, TICK, Table, Text, category_color, decimals,
};

const LOW: DVec2 = DVec2::new(2.0, 1.5);
const HIGH: DVec2 = DVec2::new(5.0, 3.5);
const AXES: [&str; 2] = ["x", "y"];

/// A ray in the plane of the drawing.
#[derive(Clone, Copy)]
struct Way {
    origin: DVec2,
    direction: DVec2,
}

const MEETS: Way = Way { origin: DVec2::new(0.5, 0.3), direction: DVec2::new(1.0, 0.6) };
const MISSES: Way = Way { origin: DVec2::new(0.2, 0.3), direction: DVec2::new(0.6, 1.2) };

impl Way {
    fn at(self, t: f64) -> DVec2 {
        self.origin + t * self.direction
    }

    /// From where to where the ray is in the slab of an axis.
    fn slab(self, axis: usize) -> [f64; 2] {
        let [a, b] =
            [LOW, HIGH].map(|plane| (plane[axis] - self.origin[axis]) / self.direction[axis]);
        [a.min(b), a.max(b)]
    }

    /// The largest of the first t and the smallest of the last ones, in front of the origin.
    fn common(self) -> [f64; 2] {
        let [x, y] = [0, 1].map(|axis| self.slab(axis));
        [x[0].max(y[0]).max(0.0), x[1].min(y[1])]
    }

    fn is_met(self) -> bool {
        let [near, far] = self.common();
        near <= far
    }

    /// What the course's own test leaves of the ray.
    fn by_course(self) -> Option<[f64; 2]> {
        let ray = Ray::new(self.origin.extend(0.0), self.direction.extend(0.0));
        let [low, high] = [LOW.extend(-1.0), HIGH.extend(1.0)];
        let inside: Interval = Slabs::new(&ray).cross(low, high, Interval::POSITIVE)?;
        Some([inside.min, inside.max])
    }

    /// The first and the last of many points along the ray that are in the box: no plane is met for that.
    fn by_points(self) -> Option<[f64; 2]> {
        let inside = |t: &f64| {
            let point = self.at(*t);
            point.cmpge(LOW).all() && point.cmple(HIGH).all()
        };
        let all: Vec<f64> = (0..STEPS).map(|k| f64::from(k) * STEP).filter(inside).collect();
        Some([*all.first()?, *all.last()?])
    }

    /// Whether the points and the course's test say what the slabs say.
    fn is_right(self) -> bool {
        let [near, far] = self.common();
        let close = |answer: Option<[f64; 2]>, by: f64| match answer {
            Some([a, b]) => (a - near).abs() <= by && (b - far).abs() <= by,
            // A part shorter than a step may lie between two points.
            None => far - near < by,
        };
        close(self.by_points(), STEP) && close(self.by_course(), 1e-9)
    }
}

const STEP: f64 = 0.004;
const STEPS: u32 = 5_000;

/// Rays from around the box to points near it.
fn others(count: u32) -> impl Iterator<Item = Way> {
    (0..count).map(|k| {
        let mut random = Uniform::new(13, k, 0);
        let mut number = |from: f64, to: f64| from + random.number() * (to - from);
        let origin = DVec2::new(number(-1.0, 8.0), number(-1.0, 6.0));
        let towards = DVec2::new(number(1.5, 5.5), number(1.0, 4.0));
        Way { origin, direction: (towards - origin).normalize() }
    })
}

pub fn make(effort: Effort) -> Finished {
    let others: Vec<Way> = others(effort.pick(200, 2_000)).collect();
    let right = others.iter().filter(|way| way.is_right()).count();
    let met = others.iter().filter(|way| way.is_met()).count();
    let drawn = [("meets the box", MEETS), ("misses the box", MISSES)];
    let holds = right == others.len()
        && drawn.iter().all(|(_, way)| way.is_right())
        && MEETS.is_met()
        && !MISSES.is_met();
    let [near, far] = MEETS.common().map(|t| decimals(t, 2));
    let claim = format!(
        "A ray is in the box while it is in all of its slabs: the left ray from near = {near}, the largest first t, to \
         far = {far}, the smallest last t; the right one never, since it leaves one slab before it is in the other.",
    );
    let mut data = Table::new(["ray", "slab", "enter", "leave", "by_points", "by_course"]);
    for (name, way) in drawn {
        for (axis, slab) in AXES.into_iter().enumerate() {
            let [enter, leave] = way.slab(axis);
            data.push([name.into(), slab.into(), enter.into(), leave.into(), "".into(), "".into()]);
        }
        let [near, far] = way.common();
        let text = |answer: Option<[f64; 2]>| {
            answer.map_or("none".to_owned(), |[a, b]| {
                format!("{} to {}", decimals(a, 2), decimals(b, 2))
            })
        };
        let [points, course] = [way.by_points(), way.by_course()].map(text);
        data.push([
            name.into(),
            "all".into(),
            near.into(),
            far.into(),
            points.into(),
            course.into(),
        ]);
    }
    let panels = drawn.map(|(name, way)| panel(name, way));
    let [meets, misses] = panels;
    let plate = Plate::new("4.13", "A ray and the slabs of a box", claim, holds)
        .panel(Row::new().panel(1.0, meets).panel(1.0, misses))
        .note("Drawn", "the box in two dimensions, its four planes dashed, and the t at which the ray meets each; below \
             them the part of the ray in each slab, and what both parts have in common")
        .note("Checked", format!(
            "against {STEPS} points of each ray, and against the test of the indexes, for these two and {} others, of \
             which {met} meet the box",
            others.len(),
        ));
    Finished { plate, data }
}

fn panel(name: &'static str, way: Way) -> Drawing {
    /// One unit of t in the lower part.
    const UNIT: f64 = 0.75;
    const LEFT: f64 = 0.6;
    let along = |t: f64| LEFT + UNIT * t;
    Drawing::new([-0.5, -3.0], [7.0, 5.3], 690.0, move |pen: &mut Pen<'_>| {
        let colors = [category_color(0), category_color(1)];
        let box_of = [[LOW.x, LOW.y], [HIGH.x, LOW.y], [HIGH.x, HIGH.y], [LOW.x, HIGH.y]];
        pen.polygon(&box_of, Style::fill(FAINT).outlined(INK, 2.0));
        for plane in [LOW, HIGH] {
            let [x, y] = colors.map(|color| Stroke::new(color, 2.0).dashed(8.0, 6.0));
            pen.line(&[[plane.x, 0.0], [plane.x, 4.75]], x);
            pen.line(&[[0.1, plane.y], [6.9, plane.y]], y);
            let label = |text: String, color: Color| Text::new(text, TICK).color(color.for_text());
            pen.label([plane.x, 4.75], [0.0, 14.0], label(format!("x = {}", plane.x), colors[0]));
            pen.label([0.1, plane.y], [-30.0, 0.0], label(format!("y = {}", plane.y), colors[1]));
        }
        let end = if way.is_met() { 6.0 } else { 3.7 };
        pen.arrow(way.origin.to_array(), way.at(end).to_array(), Stroke::new(MUTED, 2.0));
        let [near, far] = way.common();
        if near <= far {
            let inside = [near, far].map(|t| way.at(t).to_array());
            pen.line(&inside, Stroke::new(category_color(2), 6.0));
        }
        pen.dot(way.origin.to_array(), 5.0, INK);
        pen.label(way.origin.to_array(), [34.0, -12.0], Text::new("t = 0", LABEL).color(INK));
        for (axis, color) in colors.into_iter().enumerate() {
            for t in way.slab(axis).into_iter().filter(|t| *t < end) {
                pen.dot(way.at(t).to_array(), 6.0, color);
                let aside = if axis == 0 { [-26.0, 16.0] } else { [28.0, -15.0] };
                let text = Text::new(decimals(t, 2), LABEL).color(color.for_text());
                pen.label(way.at(t).to_array(), aside, text);
            }
        }

        let mut bar = |row: f64, [from, to]: [f64; 2], color: Color| {
            let y = -0.55 - 0.6 * row;
            let corners = [[from, y], [to, y], [to, y - 0.34], [from, y - 0.34]];
            pen.polygon(&corners.map(|[t, y]| [along(t), y]), Style::fill(color));
        };
        for (axis, color) in colors.into_iter().enumerate() {
            bar(axis as f64, way.slab(axis), color);
        }
        if near <= far {
            bar(2.0, [near, far], category_color(2));
        } else {
            let text =
                format!("nothing: near = {} > far = {}", decimals(near, 2), decimals(far, 2));
            pen.label([3.6, -0.72 - 1.2], [0.0, 0.0], Text::new(text, LABEL).color(INK));
        }
        for (row, text) in ["in x", "in y", "in both"].into_iter().enumerate() {
            let [x, y] = pen.at([-0.5, -0.72 - 0.6 * row as f64]);
            pen.canvas().text([x, y + 7.0], Text::new(text, LABEL).color(INK));
        }
        pen.arrow([along(0.0), -2.4], [along(8.4), -2.4], Stroke::new(MUTED, 1.5));
        for t in 0..=8 {
            let x = along(f64::from(t));
            pen.line(&[[x, -2.4], [x, -2.46]], Stroke::new(MUTED, 1.5));
            pen.label([x, -2.46], [0.0, -14.0], Text::new(t.to_string(), TICK).color(MUTED));
        }
        pen.label([along(8.4), -2.4], [0.0, 14.0], Text::new("t", TICK).color(MUTED));
        let [x, y] = pen.at([-0.5, 5.15]);
        let title = format!("The ray {name}");
        pen.canvas().text([x, y], Text::new(title, HEADING).bold().color(INK));
    })
}
