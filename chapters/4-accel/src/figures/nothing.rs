//! 4.1: every primitive for every ray, and what a hierarchy makes of that.

use lancer_accel::Bvh;
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Intersector, LinearScan};
use lancer_figure::{
    Axis, Chart, Effort, Finished, Plate, Row, Series, Table, method_color, number, time_in_turn,
};
use lancer_lesson::judge::fitted_exponent;

use crate::rays::{Kind, Rays};
use crate::scenes::family;

const FAMILIES: [&str; 2] = ["soup", "scan"];
const INDEXES: [&str; 2] = ["linear", "bvh"];

/// One scene and one index, asked all rays of a picture.
struct Case {
    family: &'static str,
    index: &'static str,
    triangles: usize,
    tests_per_ray: f64,
    hits: usize,
    nanoseconds: f64,
}

pub fn make(effort: Effort) -> Finished {
    let counts: &[u32] =
        effort.pick(&[100, 1_000, 5_000], &[100, 300, 1_000, 3_000, 10_000, 30_000, 100_000]);
    let (size, runs) = effort.pick((ImageSize::new(8, 8), 1), (ImageSize::new(16, 16), 3));
    let mut cases = Vec::new();
    for family_name in FAMILIES {
        for &count in counts {
            cases.extend(cases_of(family_name, count, size, runs));
        }
    }
    let exponent = |family: &str, index: &str| {
        let points: Vec<(f64, f64)> = of(&cases, family, index)
            .map(|case| (case.triangles as f64, case.tests_per_ray))
            .collect();
        fitted_exponent(&points)
    };
    let linear = FAMILIES.map(|family| exponent(family, "linear"));
    let tree = FAMILIES.map(|family| exponent(family, "bvh"));
    let same = cases.chunks(2).all(|pair| pair[0].hits == pair[1].hits);
    let holds =
        same && linear.iter().all(|p| (p - 1.0).abs() < 1e-9) && tree.iter().all(|p| *p < 0.5);
    let largest = |family: &'static str, index: &'static str| {
        of(&cases, family, index).last().expect("cases")
    };
    let saved = FAMILIES.map(|family| {
        largest(family, "linear").tests_per_ray / largest(family, "bvh").tests_per_ray
    });
    let claim = format!(
        "Without an index a ray costs n tests; with a hierarchy n^{:.2} (soup) and n^{:.2} (scan), \
         {} and {} times fewer for {} triangles, and meets the same.",
        tree[0],
        tree[1],
        number(saved[0]),
        number(saved[1]),
        largest(FAMILIES[0], "linear").triangles
    );

    let chart = |title: &str, unit: &str, value: fn(&Case) -> f64| {
        let mut chart = Chart::new(Axis::log("triangles, n"), Axis::log(unit)).title(title);
        for (index, name) in INDEXES.into_iter().zip(["brute force", "hierarchy"]) {
            for family in FAMILIES {
                let points =
                    of(&cases, family, index).map(|case| (case.triangles as f64, value(case)));
                let series =
                    Series::new(format!("{name}, {family}"), method_color(index)).points(points);
                chart = chart.series(if family == FAMILIES[0] { series } else { series.dashed() });
            }
        }
        chart.slope(1.0, "slope 1")
    };
    let mut data = Table::new([
        "family",
        "index",
        "triangles",
        "tests_per_ray",
        "hits",
        "nanoseconds_per_ray",
    ]);
    for case in &cases {
        data.push([
            case.family.into(),
            case.index.into(),
            case.triangles.into(),
            case.tests_per_ray.into(),
            case.hits.into(),
            case.nanoseconds.into(),
        ]);
    }
    let plate = Plate::new("4.1", "Without any index", claim, holds)
        .panel(
            Row::new()
                .panel(1.0, chart("Counted work", "tests per ray", |case| case.tests_per_ray))
                .panel(1.0, chart("Time (one thread)", "nanoseconds per ray", |case| case.nanoseconds)),
        )
        .note("Work", "tests of triangles and, in the hierarchy, of boxes, which come four at a time")
        .note("Settings", format!(
            "primary rays of a picture of {size}; times are medians of {runs}, building not counted"
        ))
        .note("Reference", "brute force: both meet the same number of rays, and each ray of brute force tests all n triangles");
    Finished { plate, data }
}

fn of<'c>(cases: &'c [Case], family: &'c str, index: &'c str) -> impl Iterator<Item = &'c Case> {
    cases.iter().filter(move |case| case.family == family && case.index == index)
}

/// Both indexes on one scene, timed in turn.
fn cases_of(family_name: &'static str, count: u32, size: ImageSize, runs: usize) -> [Case; 2] {
    let scene = family(family_name).scene(count);
    let (linear, tree) = (LinearScan::new(&scene), Bvh::build(&scene));
    let indexes: [&dyn Intersector; 2] = [&linear, &tree];
    let rays = Rays::of(&scene, size, &tree).into_iter().find(|rays| rays.kind == Kind::Primary);
    let rays = rays.expect("all kinds");
    let asked = rays.queries.len() as f64;
    let timed = time_in_turn(runs, indexes.iter().map(|index| || rays.trace(*index)));
    [0, 1].map(|k| {
        let (_, work) = rays.watch(indexes[k]);
        Case {
            family: family_name,
            index: INDEXES[k],
            triangles: scene.mesh.triangles.len(),
            tests_per_ray: (work.boxes + work.primitives) as f64 / asked,
            hits: timed[k].1,
            nanoseconds: 1e9 * timed[k].0.mid / asked,
        }
    })
}
