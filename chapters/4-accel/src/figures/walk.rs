//! 4.15: a ray's walk through a grid, step by step.

use glam::{DVec3, IVec3};
use lancer_accel::Lattice;
use lancer_core::geometry::Ray;
use lancer_core::sampling::Uniform;
use lancer_figure::{
    Color, Drawing, Effort, FAINT, Finished, HEADING, INK, LABEL, MUTED, Pen, Plate, Row, SMALLEST,
    Stroke, Style, TICK, Table, Text, category_color, decimals,
};

const COLUMNS: i32 = 8;
const ROWS: i32 = 5;
/// A slice of a grid: one cell deep.
const SLICE: Lattice =
    Lattice { min: DVec3::ZERO, width: DVec3::ONE, resolution: IVec3::new(COLUMNS, ROWS, 1) };
const AXES: [&str; 2] = ["x", "y"];

/// The ray that is drawn. One unit of t is one unit of x.
fn drawn() -> Ray {
    Ray::new(DVec3::new(0.4, 0.5, 0.5), DVec3::new(1.0, 0.6, 0.0))
}

/// A plane that the ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Crossing {
    axis: usize,
    t: f64,
}

/// The cells of a walk, and the crossings that lead from each to the next.
struct Walked {
    cells: Vec<IVec3>,
    crossings: Vec<Crossing>,
}

fn walked(ray: &Ray) -> Walked {
    let mut walk = Walked { cells: vec![ray.origin.as_ivec3()], crossings: Vec::new() };
    let mut cell = walk.cells[0];
    while let Some((next, t)) = SLICE.step(ray, cell) {
        walk.crossings.push(Crossing { axis: usize::from(next.x == cell.x), t });
        walk.cells.push(next);
        cell = next;
    }
    walk
}

/// When the ray meets the plane of an axis, counted from below.
fn crossing(ray: &Ray, axis: usize, plane: i32) -> Crossing {
    Crossing { axis, t: (f64::from(plane) - ray.origin[axis]) / ray.direction[axis] }
}

/// All planes between cells that the ray meets in the grid, sorted by t.
fn sorted(ray: &Ray) -> Vec<Crossing> {
    let inside = |crossing: &Crossing| {
        let other = 1 - crossing.axis;
        let at = ray.origin[other] + crossing.t * ray.direction[other];
        crossing.t > 0.0 && (0.0..f64::from(SLICE.resolution[other])).contains(&at)
    };
    let of = |axis: usize| (1..SLICE.resolution[axis]).map(move |plane| crossing(ray, axis, plane));
    let mut all: Vec<Crossing> = of(0).chain(of(1)).filter(inside).collect();
    all.sort_by(|a, b| a.t.total_cmp(&b.t));
    all
}

/// The cells in which the ray has a part, near ones first: each of them is clipped by itself.
fn clipped(ray: &Ray) -> Vec<IVec3> {
    let enter = |cell: IVec3| {
        let ends = [0, 1].map(|axis| {
            let [a, b] = [0, 1].map(|side| crossing(ray, axis, cell[axis] + side).t);
            [a.min(b), a.max(b)]
        });
        let (near, far) = (ends[0][0].max(ends[1][0]).max(0.0), ends[0][1].min(ends[1][1]));
        (near < far).then_some((near, cell))
    };
    let cells = (0..ROWS).flat_map(|y| (0..COLUMNS).map(move |x| IVec3::new(x, y, 0)));
    let mut cells: Vec<_> = cells.filter_map(enter).collect();
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    cells.into_iter().map(|(_, cell)| cell).collect()
}

fn is_right(ray: &Ray) -> bool {
    let walk = walked(ray);
    let same = |(a, b): (&Crossing, &Crossing)| a.axis == b.axis && (a.t - b.t).abs() < 1e-12;
    let sorted = sorted(ray);
    walk.crossings.len() == sorted.len()
        && walk.crossings.iter().zip(&sorted).all(same)
        && walk.cells == clipped(ray)
}

/// Rays from cells of the slice in all directions.
fn others(count: u32) -> impl Iterator<Item = Ray> {
    (0..count).map(|k| {
        let mut random = Uniform::new(15, k, 0);
        let at = [COLUMNS, ROWS].map(|cells| f64::from(cells) * random.number());
        let (sin, cos) = (std::f64::consts::TAU * random.number()).sin_cos();
        Ray::new(DVec3::new(at[0], at[1], 0.5), DVec3::new(cos, sin, 0.0))
    })
}

pub fn make(effort: Effort) -> Finished {
    let ray = drawn();
    let walk = walked(&ray);
    let others: Vec<Ray> = others(effort.pick(500, 10_000)).collect();
    let wrong = others.iter().filter(|ray| !is_right(ray)).count();
    let holds = is_right(&ray) && wrong == 0;
    let steps = walk.crossings.len();
    let of = |axis| walk.crossings.iter().filter(|crossing| crossing.axis == axis).count();
    let claim = format!(
        "Always going through the nearer of the two planes ahead takes the planes of x ({}) and those of y ({}) in the \
         order of t: {steps} steps lead through the {} cells in which the ray has a part, and no other.",
        of(0),
        of(1),
        steps + 1,
    );
    let mut data = Table::new(["number", "cell_x", "cell_y", "t_x", "t_y", "step", "t"]);
    for (k, cell) in walk.cells.iter().enumerate() {
        let [t_x, t_y] = [0, 1].map(|axis| crossing(&ray, axis, cell[axis] + 1).t);
        let step = walk.crossings.get(k);
        data.push([
            (k + 1).into(),
            i64::from(cell.x).into(),
            i64::from(cell.y).into(),
            t_x.into(),
            t_y.into(),
            step.map_or("out", |crossing| AXES[crossing.axis]).into(),
            step.map_or(t_x.min(t_y), |crossing| crossing.t).into(),
        ]);
    }
    let Walked { cells, crossings } = walk;
    let plate = Plate::new("4.15", "A walk through a grid", claim, holds)
        .panel(
            Row::new()
                .panel(0.64, slice(ray, cells.clone(), crossings))
                .panel(0.36, list(ray, cells)),
        )
        .note("Drawn", "a slice of a grid, a ray and the cells that it visits, numbered; below, when it meets the planes \
             of x and those of y, numbered in the order in which they are crossed; on the right the two t that each step \
             compares")
        .note("Checked", format!(
            "against all planes sorted by t, and against each cell clipped by itself, for this ray and {} others",
            others.len(),
        ));
    Finished { plate, data }
}

fn slice(ray: Ray, cells: Vec<IVec3>, crossings: Vec<Crossing>) -> Drawing {
    Drawing::new([-0.75, -2.75], [8.9, 5.6], 700.0, move |pen: &mut Pen<'_>| {
        let colors = [category_color(0), category_color(1)];
        for cell in &cells {
            let [x, y] = [cell.x, cell.y].map(f64::from);
            let corners = [[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]];
            pen.polygon(&corners, Style::fill(FAINT));
        }
        let (right, top) = (f64::from(COLUMNS), f64::from(ROWS));
        for x in 0..=COLUMNS {
            let x = f64::from(x);
            pen.line(&[[x, 0.0], [x, top]], Stroke::new(colors[0], 1.5));
        }
        for y in 0..=ROWS {
            let y = f64::from(y);
            pen.line(&[[0.0, y], [right, y]], Stroke::new(colors[1], 1.5));
        }
        let point = |t: f64| {
            let at = ray.at(t);
            [at.x, at.y]
        };
        let rows = [-0.75, -1.75];
        for crossing in &crossings {
            let [x, y] = point(crossing.t);
            let down = [[x, y], [x, rows[crossing.axis]]];
            let color = colors[crossing.axis].mix(Color::WHITE, 0.3);
            pen.line(&down, Stroke::new(color, 1.2).dashed(3.0, 4.0));
        }
        pen.arrow(point(0.0), point(7.9), Stroke::new(INK, 2.5));
        pen.dot(point(0.0), 5.0, INK);
        for crossing in &crossings {
            pen.dot(point(crossing.t), 5.5, colors[crossing.axis]);
        }
        for (k, cell) in cells.iter().enumerate() {
            let corner = [f64::from(cell.x), f64::from(cell.y) + 1.0];
            let name = Text::new((k + 1).to_string(), LABEL).bold().color(INK);
            pen.label(corner, [17.0, -16.0], name);
        }
        for (axis, y) in rows.into_iter().enumerate() {
            let color = colors[axis];
            pen.line(&[[0.4, y], [8.4, y]], Stroke::new(color, 1.5));
            let name = Text::new(["t_x", "t_y"][axis], LABEL).bold().color(color.for_text());
            pen.label([-0.1, y], [0.0, 0.0], name);
        }
        for (k, crossing) in crossings.iter().enumerate() {
            let at = [point(crossing.t)[0], rows[crossing.axis]];
            pen.dot(at, 12.0, colors[crossing.axis].for_text());
            let order = Text::new((k + 1).to_string(), SMALLEST).bold().color(Color::WHITE);
            let [x, y] = pen.at(at);
            pen.canvas().text([x, y + 5.5], order.centered());
            let t =
                Text::new(decimals(crossing.t, 2), TICK).color(colors[crossing.axis].for_text());
            pen.label(at, [0.0, -24.0], t);
        }
        let [x, y] = pen.at([-0.75, 5.35]);
        let title = Text::new("The cells of one ray", HEADING).bold().color(INK);
        pen.canvas().text([x, y], title);
    })
}

/// The t of the planes ahead, cell after cell, the smaller one bold.
fn list(ray: Ray, cells: Vec<IVec3>) -> Drawing {
    Drawing::new([0.0, -14.0], [10.0, 0.6], 700.0, move |pen: &mut Pen<'_>| {
        let mut write = |column: f64, row: f64, text: Text| {
            let [x, y] = pen.at([column, -row]);
            pen.canvas().text([x, y], text);
        };
        let colors = [category_color(0), category_color(1)].map(Color::for_text);
        write(0.0, 0.2, Text::new("What each step compares", HEADING).bold().color(INK));
        for (column, text, color) in [
            (0.0, "cell", MUTED),
            (3.0, "t_x", colors[0]),
            (5.2, "t_y", colors[1]),
            (7.4, "goes", MUTED),
        ] {
            write(column, 1.4, Text::new(text, LABEL).color(color));
        }
        for (k, cell) in cells.iter().enumerate() {
            let row = 2.4 + k as f64 * 0.95;
            let t = [0, 1].map(|axis| crossing(&ray, axis, cell[axis] + 1).t);
            let axis = usize::from(t[1] < t[0]);
            let name = format!("{}  ({}, {})", k + 1, cell.x, cell.y);
            write(0.0, row, Text::new(name, LABEL).color(INK));
            for (k, column) in [3.0, 5.2].into_iter().enumerate() {
                let text = Text::new(decimals(t[k], 2), LABEL);
                let text = if k == axis { text.bold().color(colors[k]) } else { text.color(MUTED) };
                write(column, row, text);
            }
            let goes = if k + 1 < cells.len() { ["right", "up"][axis] } else { "out" };
            write(7.4, row, Text::new(goes, LABEL).color(colors[axis]));
        }
    })
}
