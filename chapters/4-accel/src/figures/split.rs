//! 4.14: the cuts of a row by the surface area heuristic, worked by numbers and counted by lines.

use glam::DVec3;
use lancer_accel::sah_cost;
use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};
use lancer_figure::{
    Color, Drawing, Effort, FAINT, Finished, HEADING, INK, LABEL, MUTED, Pen, Plate, Stroke, Style,
    Table, Text, category_color, decimals, number,
};

use crate::volumes::random_lines;

/// Where the boxes begin; each is 1 wide, 2 tall and 2 deep.
const PLACES: [f64; 5] = [0.0, 1.5, 3.0, 8.5, 10.0];
const EXTENT: DVec3 = DVec3::new(1.0, 2.0, 2.0);

fn boxes() -> [Bounds3; 5] {
    PLACES.map(|x| {
        let min = DVec3::new(x, 0.0, 0.0);
        Bounds3 { min, max: min + EXTENT }
    })
}

fn around(boxes: &[Bounds3]) -> Bounds3 {
    boxes.iter().copied().fold(Bounds3::EMPTY, Bounds3::union)
}

fn surface(bounds: &Bounds3) -> f64 {
    let DVec3 { x, y, z } = bounds.max - bounds.min;
    2.0 * (x * y + y * z + z * x)
}

/// A cut of the row.
#[derive(Clone, Copy)]
struct Cut {
    /// The boxes of the children.
    sides: [Bounds3; 2],
    counts: [usize; 2],
    /// By the formula.
    cost: f64,
    /// The node, and the boxes that lines test in the children whose box they meet, on average.
    counted: f64,
}

fn meets(line: &Ray, bounds: &Bounds3) -> bool {
    Slabs::new(line).enter(bounds.min, bounds.max, Interval::POSITIVE).is_some()
}

fn cuts(lines: &[Ray]) -> Vec<Cut> {
    let row = boxes();
    let node = around(&row);
    let extent = |bounds: &Bounds3| bounds.max - bounds.min;
    let cut = |left: usize| {
        let (a, b) = row.split_at(left);
        let (sides, counts) = ([around(a), around(b)], [a.len(), b.len()]);
        let tests = |line: &Ray| {
            let of = |k: usize| if meets(line, &sides[k]) { counts[k] } else { 0 };
            1 + of(0) + of(1)
        };
        let counted = lines.iter().map(tests).sum::<usize>() as f64 / lines.len() as f64;
        let cost = sah_cost(extent(&node), [extent(&sides[0]), extent(&sides[1])], counts, 1.0);
        Cut { sides, counts, cost, counted }
    };
    (1..row.len()).map(cut).collect()
}

fn least(cuts: &[Cut], cost: impl Fn(&Cut) -> f64) -> usize {
    let by_cost = |a: &usize, b: &usize| cost(&cuts[*a]).total_cmp(&cost(&cuts[*b]));
    (0..cuts.len()).min_by(by_cost).unwrap_or(0)
}

pub fn make(effort: Effort) -> Finished {
    let node = around(&boxes());
    let radius = 0.5 * (node.max - node.min).length();
    let all = random_lines(node.center(), radius, effort.pick(100_000, 1_000_000));
    let lines: Vec<Ray> = all.filter(|line| meets(line, &node)).collect();
    let cuts = cuts(&lines);
    let best = least(&cuts, |cut| cut.cost);
    let off = |cut: &Cut| (cut.counted / cut.cost - 1.0).abs();
    let worst = cuts.iter().map(off).fold(0.0, f64::max);
    let whole = PLACES.len() as f64;
    let holds = worst < 0.02 && best == least(&cuts, |cut| cut.counted) && cuts[best].cost < whole;
    let claim = format!(
        "Cut {} costs least, {} instead of the {whole} tests of the undivided row; random lines that meet the row cost \
         what the formula says, within {} %.",
        best + 1,
        decimals(cuts[best].cost, 2),
        number((1000.0 * worst).ceil() / 10.0),
    );
    let mut data =
        Table::new(["cut", "left_surface", "left", "right_surface", "right", "cost", "counted"]);
    for (k, cut) in cuts.iter().enumerate() {
        let [a, b] = &cut.sides;
        data.push([
            (k + 1).into(),
            surface(a).into(),
            cut.counts[0].into(),
            surface(b).into(),
            cut.counts[1].into(),
            cut.cost.into(),
            cut.counted.into(),
        ]);
    }
    let plate = Plate::new("4.14", "A split by the surface area heuristic", claim, holds)
        .panel(drawing(cuts, best))
        .note("Drawn", "five boxes, 1 wide, 2 tall and 2 deep, seen from the front; for each of the four cuts the boxes of \
             its two children with surface · number of boxes, and the cost C")
        .note("Checked", format!(
            "{} lines without any preference that meet the row: 1 for the node, and all boxes of each child whose box a \
             line meets",
            lines.len(),
        ));
    Finished { plate, data }
}

fn drawing(cuts: Vec<Cut>, best: usize) -> Drawing {
    Drawing::new([-0.3, -4.6], [17.4, 3.2], 590.0, move |pen: &mut Pen<'_>| {
        let row = boxes();
        let rectangle = |bounds: &Bounds3, low: f64, high: f64| {
            let (left, right) = (bounds.min.x, bounds.max.x);
            [[left, low], [right, low], [right, high], [left, high]]
        };
        for (k, bounds) in row.iter().enumerate() {
            pen.polygon(&rectangle(bounds, 0.0, 2.0), Style::fill(FAINT).outlined(INK, 2.0));
            let name = Text::new((k + 1).to_string(), LABEL).color(INK);
            pen.label([bounds.center().x, 1.0], [0.0, 0.0], name);
        }
        let node = around(&row);
        pen.polygon(&rectangle(&node, -0.12, 2.12), Style::outline(MUTED, 1.5));
        let size = format!("the row: A = {}", number(surface(&node)));
        pen.label([node.max.x, 2.12], [130.0, -14.0], Text::new(size, LABEL).color(INK));
        for (k, pair) in row.windows(2).enumerate() {
            let x = 0.5 * (pair[0].max.x + pair[1].min.x);
            let color = if k == best { category_color(3) } else { MUTED };
            pen.line(&[[x, -0.3], [x, 2.4]], Stroke::new(color, 2.0).dashed(7.0, 5.0));
            let name = Text::new(format!("cut {}", k + 1), LABEL).color(color.for_text());
            pen.label([x, 2.4], [0.0, 14.0], name);
        }
        for (k, cut) in cuts.iter().enumerate() {
            let y = -0.75 - 0.95 * k as f64;
            for (side, color) in cut.sides.iter().zip([category_color(0), category_color(1)]) {
                let style = Style::fill(color.mix(Color::WHITE, 0.75)).outlined(color, 2.0);
                pen.polygon(&rectangle(side, y - 0.3, y + 0.3), style);
            }
            let terms =
                [0, 1].map(|k| format!("{} · {}", number(surface(&cut.sides[k])), cut.counts[k]));
            for (side, term) in cut.sides.iter().zip(&terms) {
                pen.label([side.center().x, y], [0.0, 0.0], Text::new(term, LABEL).color(INK));
            }
            let [a, b] = terms;
            let cost = format!(
                "cut {}: C = 1 + ({a} + {b}) / {} = {}",
                k + 1,
                number(surface(&node)),
                decimals(cut.cost, 2)
            );
            let text = Text::new(cost, LABEL);
            let text =
                if k == best { text.bold().color(category_color(3).for_text()) } else { text };
            let [x, y] = pen.at([11.4, y]);
            pen.canvas().text([x, y + 7.0], text);
        }
        let [x, y] = pen.at([11.4, -4.55]);
        let whole = format!("no split: {} tests", row.len());
        pen.canvas().text([x, y + 7.0], Text::new(whole, LABEL).color(INK));
        let [x, y] = pen.at([-0.3, 3.05]);
        let title = Text::new("Where to divide a row of five boxes", HEADING).bold().color(INK);
        pen.canvas().text([x, y], title);
    })
}
