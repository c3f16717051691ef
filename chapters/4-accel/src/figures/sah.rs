//! 4.4: what the surface area heuristic promises, and what rays do.

use lancer_accel::{BinaryTree, Split};
use lancer_core::geometry::Interval;
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Query, TestCounts, Traversal};
use lancer_figure::{
    Axis, Chart, Effort, Finished, Plate, Row, Series, Table, category_color, number,
};

use crate::rays::Rays;
use crate::scenes::FAMILIES;
use crate::volumes::random_lines;

const SPLITS: [(&str, Split); 2] = [("median", Split::Median), ("SAH", Split::Sah)];

/// One tree.
struct Case {
    family: usize,
    split: &'static str,
    triangles: usize,
    /// What the heuristic says of a line.
    predicted: f64,
    /// What lines of its kind do: node visits and triangle tests.
    lines: f64,
    /// What the rays of a picture do.
    rays: f64,
}

pub fn make(effort: Effort) -> Finished {
    let counts: &[u32] = effort.pick(&[300, 3_000], &[300, 1_000, 10_000, 100_000]);
    let (lines, size) =
        effort.pick((6_000, ImageSize::new(16, 16)), (40_000, ImageSize::new(48, 48)));
    let mut cases = Vec::new();
    for family in 0..FAMILIES.len() {
        for &count in counts {
            for (name, split) in SPLITS {
                cases.push(case_of(family, count, name, split, lines, size));
            }
        }
    }
    let off = |case: &Case| (case.lines / case.predicted - 1.0).abs();
    let worst = cases.iter().map(off).fold(0.0, f64::max);
    let log =
        |value: fn(&Case) -> f64| cases.iter().map(|case| value(case).ln()).collect::<Vec<_>>();
    let correlation = correlation(&log(|case| case.predicted), &log(|case| case.rays));
    // The part of the promise that the rays of a picture pay.
    let paid: Vec<f64> = cases.iter().map(|case| case.rays / case.predicted).collect();
    let (least, most) =
        paid.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(*x), high.max(*x)));
    let holds = worst < 0.1 && correlation > 0.5;
    let claim = format!(
        "For lines that nothing stops the heuristic is right within {} % on {} trees; the rays of a picture \
         take {least:.2} to {most:.2} times as much, and follow it with a correlation of {correlation:.2}.",
        number(100.0 * worst),
        cases.len(),
    );

    let chart = |title: &str, value: fn(&Case) -> f64| {
        let mut chart = Chart::new(
            Axis::log("predicted: SAH cost C of the tree"),
            Axis::log("node visits and triangle tests"),
        )
        .title(title);
        for (k, family) in FAMILIES.iter().enumerate() {
            let of = cases.iter().filter(|case| case.family == k);
            let points = of.map(|case| (case.predicted, value(case)));
            let series = Series::new(family.name, category_color(k)).points(points);
            chart = chart.series(series.scatter());
        }
        chart.slope(1.0, "as predicted")
    };
    let mut data = Table::new([
        "family",
        "split",
        "triangles",
        "predicted",
        "lines_measured",
        "rays_measured",
    ]);
    for case in &cases {
        data.push([
            FAMILIES[case.family].name.into(),
            case.split.into(),
            case.triangles.into(),
            case.predicted.into(),
            case.lines.into(),
            case.rays.into(),
        ]);
    }
    let plate = Plate::new("4.4", "What the heuristic promises", claim, holds)
        .panel(
            Row::new()
                .panel(1.0, chart("Lines that nothing stops", |case| case.lines))
                .panel(1.0, chart("The rays of a picture", |case| case.rays)),
        )
        .note("Why the right side differs", "a ray starts somewhere, most often ends at the first hit, and prefers the \
             directions of the picture: three things of which the heuristic knows nothing. It still ranks trees")
        .note("Predicted", "C = Σ A(inner) / A(root) + Σ A(leaf) / A(root) · triangles: the surface area heuristic, from boxes alone")
        .note("Measured", format!(
            "{lines} lines without preference around each scene, of which those count that meet its box; primary, shadow and \
             diffuse rays of pictures of {size}, of which all count. Binary trees by median and by the \
             heuristic"
        ))
        .note("Reference", "the prediction itself, in closed form; what is measured differs from it by the chance of the lines");
    Finished { plate, data }
}

fn case_of(
    family: usize,
    count: u32,
    split_name: &'static str,
    split: Split,
    lines: u32,
    size: ImageSize,
) -> Case {
    let scene = FAMILIES[family].scene(count);
    let tree = BinaryTree::build(&scene, split);
    // All lines that meet the scene's box meet the sphere around the box.
    let bounds = scene.bounds();
    let around = 0.5 * (bounds.max - bounds.min).length();
    let mut work = Work::default();
    for line in random_lines(bounds.center(), around, lines) {
        // Beyond all hits: none counts, so nothing stops the line.
        let nowhere = Interval { min: f64::MAX, max: f64::INFINITY };
        work.add(&tree, |tree, counts| {
            tree.walk(Query::closest(&line, nowhere), counts);
        });
    }
    let mut of_rays = Work::default();
    for rays in Rays::of(&scene, size, &tree) {
        for query in &rays.queries {
            of_rays.add(&tree, |tree, counts| {
                tree.walk(query.as_ref(), counts);
            });
        }
    }
    Case {
        family,
        split: split_name,
        triangles: scene.mesh.triangles.len(),
        predicted: tree.statistics().sah_cost,
        lines: work.tests as f64 / work.in_box as f64,
        rays: of_rays.tests as f64 / of_rays.asked as f64,
    }
}

/// The work of many walks, counted as the heuristic counts.
#[derive(Default)]
struct Work {
    asked: u64,
    /// Walks that met the tree's box.
    in_box: u64,
    tests: u64,
}

impl Work {
    fn add(&mut self, tree: &BinaryTree, walk: impl FnOnce(&BinaryTree, &mut TestCounts)) {
        let mut counts = TestCounts::default();
        walk(tree, &mut counts);
        // One test of the root's box, and two for each inner node that is visited.
        let visits = counts.boxes.saturating_sub(1) / 2;
        self.asked += 1;
        self.in_box += u64::from(visits > 0 || counts.primitives > 0);
        self.tests += visits + counts.primitives;
    }
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let covariance = |x: &[f64], mean_x: f64, y: &[f64], mean_y: f64| -> f64 {
        x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum()
    };
    covariance(a, mean_a, b, mean_b)
        / (covariance(a, mean_a, a, mean_a) * covariance(b, mean_b, b, mean_b)).sqrt()
}
