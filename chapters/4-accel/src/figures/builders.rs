//! 4.3: what it takes to build a tree, and what the tree saves each ray.

use lancer_accel::structures::Built;
use lancer_accel::{Bvh, ObvhsBvh2, Split};
use lancer_core::image::ImageSize;
use lancer_core::scene::Scene;
use lancer_figure::{
    Axis, BarChart, Chart, Color, Effort, Finished, Plate, Row, Series, Table, category_color,
    method_color, number, time_in_turn,
};

use crate::rays::Rays;
use crate::scenes::FAMILIES;

type Build = for<'s> fn(&'s Scene) -> Built<'s>;

const BUILDERS: [(&str, Build); 3] = [
    ("median", |scene| Built::new(Bvh::with_split(scene, Split::Median), Bvh::memory)),
    ("SAH", |scene| Built::new(Bvh::build(scene), Bvh::memory)),
    ("obvhs", |scene| Built::new(ObvhsBvh2::build(scene), ObvhsBvh2::memory)),
];

fn color(builder: usize) -> Color {
    [category_color(1), method_color("bvh"), method_color("obvhs-bvh2")][builder]
}

/// One builder's tree over one scene.
struct Case {
    family: &'static str,
    triangles: usize,
    tests_per_ray: f64,
    hits: usize,
    build_seconds: f64,
    ray_seconds: f64,
    bytes: usize,
}

impl Case {
    fn total(&self, rays: f64) -> f64 {
        self.build_seconds + rays * self.ray_seconds
    }
}

pub fn make(effort: Effort) -> Finished {
    let count = effort.pick(2_000, 100_000);
    let (size, runs) = effort.pick((ImageSize::new(24, 24), 1), (ImageSize::new(96, 96), 3));
    // By family, then by builder.
    let cases: Vec<[Case; 3]> = FAMILIES
        .iter()
        .map(|family| cases_of(family.name, &family.scene(count), size, runs))
        .collect();
    let same = cases.iter().all(|[a, b, c]| a.hits == b.hits && a.hits == c.hits);
    let saved: Vec<f64> =
        cases.iter().map(|[median, sah, _]| median.tests_per_ray / sah.tests_per_ray).collect();
    let least = saved.iter().copied().fold(f64::INFINITY, f64::min);
    let most = saved.iter().copied().fold(0.0, f64::max);
    let holds = same && least > 1.0;
    let claim = format!(
        "A tree divided by the surface area heuristic answers the same with {} to {} times fewer tests than \
         one divided at the median, on all {} kinds of scene.",
        number(least),
        number(most),
        cases.len()
    );

    let families = || cases.iter().map(|builders| builders[0].family);
    let bars = |title: &str, unit: &str, value: &dyn Fn(&Case) -> f64| {
        let mut chart = BarChart::new(unit, families()).title(title);
        for (k, (name, _)) in BUILDERS.iter().enumerate() {
            let values: Vec<f64> = cases.iter().map(|builders| value(&builders[k])).collect();
            chart = chart.series(*name, color(k), values);
        }
        chart
    };
    let tenth = |x: f64| (10.0 * x).round() / 10.0;
    let amortised = |builders: &[Case; 3]| {
        let mut chart = Chart::new(Axis::log("rays traced"), Axis::log("microseconds per ray"))
            .title(format!("{}: with its share of the build", builders[0].family));
        for (k, (name, _)) in BUILDERS.iter().enumerate() {
            let points = (4..=16).map(|e| 10.0_f64.powf(0.5 * f64::from(e)));
            let points = points.map(|rays| (rays, 1e6 * builders[k].total(rays) / rays));
            chart = chart.series(Series::new(*name, color(k)).points(points));
        }
        chart
    };
    let crossings: Vec<String> =
        cases.iter().map(|[median, sah, _]| crossing(median, sah)).collect();
    let mut data = Table::new([
        "family",
        "builder",
        "triangles",
        "tests_per_ray",
        "hits",
        "build_seconds",
        "seconds_per_ray",
        "bytes",
    ]);
    for builders in &cases {
        for (case, (name, _)) in builders.iter().zip(&BUILDERS) {
            data.push([
                case.family.into(),
                (*name).into(),
                case.triangles.into(),
                case.tests_per_ray.into(),
                case.hits.into(),
                case.build_seconds.into(),
                case.ray_seconds.into(),
                case.bytes.into(),
            ]);
        }
    }
    let plate = Plate::new("4.3", "To build a tree, and to use it", claim, holds)
        .panel(
            Row::new()
                .panel(1.0, bars("What a ray costs", "tests per ray", &|case| tenth(case.tests_per_ray)))
                .panel(1.0, bars("What the tree costs", "milliseconds to build", &|case| {
                    tenth(1e3 * case.build_seconds)
                })),
        )
        .panel(Row::new().panel(1.0, amortised(&cases[0])).panel(1.0, amortised(&cases[2])))
        .note("Where the better tree pays", crossings.join("; "))
        .note("Work", "tests of boxes and triangles by the same number of primary, shadow and diffuse rays; \
             boxes are tested four at a time")
        .note("Settings", format!(
            "about {count} triangles, pictures of {size}, rays on one thread, builds on all; medians of {runs}. obvhs \
             builds by agglomeration and improves the tree by reinsertion (its preset for medium builds)"
        ))
        .note("Reference", "all trees meet the same number of rays; that each hit is brute force's is plate 4.11");
    Finished { plate, data }
}

fn crossing(median: &Case, sah: &Case) -> String {
    let (later, saved) =
        (sah.build_seconds - median.build_seconds, median.ray_seconds - sah.ray_seconds);
    let family = sah.family;
    match (later > 0.0, saved > 0.0) {
        (true, true) => format!("{family}: from {} rays on", number(later / saved)),
        (false, true) => format!("{family}: at once"),
        (_, false) => format!("{family}: not measurably"),
    }
}

fn cases_of(family: &'static str, scene: &Scene, size: ImageSize, runs: usize) -> [Case; 3] {
    let built = BUILDERS.map(|(_, build)| build(scene));
    let rays = Rays::of(scene, size, &*built[0].index);
    let asked: usize = rays.iter().map(|rays| rays.queries.len()).sum();
    let builds = BUILDERS
        .iter()
        .map(|(_, build)| -> Box<dyn Fn() -> usize + '_> { Box::new(|| build(scene).bytes) });
    let traces = built.iter().map(|built| -> Box<dyn Fn() -> usize + '_> {
        Box::new(|| rays.iter().map(|rays| rays.trace(&*built.index)).sum())
    });
    let timed = time_in_turn(runs, builds.chain(traces));
    [0, 1, 2].map(|k| {
        let tests = rays.iter().map(|rays| {
            let (_, work) = rays.watch(&*built[k].index);
            work.boxes + work.primitives
        });
        Case {
            family,
            triangles: scene.mesh.triangles.len(),
            tests_per_ray: tests.sum::<u64>() as f64 / asked as f64,
            hits: timed[3 + k].1,
            build_seconds: timed[k].0.mid,
            ray_seconds: timed[3 + k].0.mid / asked as f64,
            bytes: built[k].bytes,
        }
    })
}
