//! 1.13: what part of a picture's time the intersections take, by the number of primitives and by index.

use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Intersector, LinearScan, Query, TestCounts};
use lancer_core::scene::Scene;
use lancer_core::world::World;
use lancer_figure::{
    Axis, BarChart, Chart, Contender, Effort, Finished, Plate, Row, Series, Study, Table,
    category_color, method_color,
};
use lancer_lesson::judge::fitted_exponent;
use lancer_whitted::{Call, Recorder, Settings, Whitted};

use crate::scenes;

/// Brute force is not asked for more primitives.
const MOST_LINEAR: usize = 1100;
/// How often everything is timed.
const RUNS: usize = 25;

/// Everything that a picture asks its index, in order.
#[derive(Default)]
struct Queries(Vec<Query<Ray>>);

impl Recorder for Queries {
    fn enter(&mut self, call: &Call) {
        self.0.push(Query::closest(call.ray, Interval::POSITIVE));
    }

    fn shadow(&mut self, ray: &Ray, _visible: bool) {
        self.0.push(Query::any(*ray, Interval::up_to(1.0)));
    }
}

/// The indexes, by the names of their colours.
const INDEXES: [&str; 2] = ["linear", "obvhs-bvh2"];
/// The scenes with a level of detail.
const FAMILIES: [&str; 2] = ["flake", "tetrahedra"];

/// A scene at one level of detail with one index.
struct Case<'s> {
    scene_name: &'static str,
    scene: &'s Scene,
    index_name: &'static str,
    index: Box<dyn Intersector + 's>,
    size: ImageSize,
    queries: Vec<Query<Ray>>,
    counts: TestCounts,
}

impl<'s> Case<'s> {
    fn new(
        scene_name: &'static str,
        scene: &'s Scene,
        index_name: &'static str,
        size: ImageSize,
    ) -> Self {
        let index: Box<dyn Intersector> = match index_name {
            "linear" => Box::new(LinearScan::new(scene)),
            _ => Box::new(ObvhsBvh2::build(scene)),
        };
        let mut queries = Queries::default();
        picture(scene, &*index, size, &mut queries);
        let (queries, mut counts) = (queries.0, TestCounts::default());
        for query in &queries {
            index.watch(query.as_ref(), &mut counts);
        }
        Self { scene_name, scene, index_name, index, size, queries, counts }
    }

    fn label(&self) -> String {
        format!("{} {}", self.scene_name, self.index_name)
    }

    fn primitives(&self) -> usize {
        self.scene.primitives().len()
    }

    fn rays_per_pixel(&self) -> f64 {
        self.queries.len() as f64 / self.size.pixels() as f64
    }

    /// Primitives, and tests of boxes and primitives per ray.
    fn work(&self) -> (f64, f64) {
        let tests = (self.counts.boxes + self.counts.primitives) as f64;
        (self.primitives() as f64, tests / self.queries.len() as f64)
    }

    /// Asks the queries alone. Returns the number of hits.
    fn replay(&self) -> f64 {
        self.queries.iter().filter(|query| query.as_ref().hits(&*self.index)).count() as f64
    }
}

/// A picture by one thread: the sum of its pixels.
fn picture<R: Recorder>(
    scene: &Scene,
    index: &dyn Intersector,
    size: ImageSize,
    recorder: &mut R,
) -> f64 {
    let method = Whitted::new(World { scene, index }, Settings::default());
    let rays = scene.camera.primary_rays(size);
    let pixels = (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y)));
    let centers = pixels.map(|(x, y)| (f64::from(x) + 0.5, f64::from(y) + 0.5));
    let rays: Vec<Ray> = centers.map(|(x, y)| rays.through(x, y)).collect();
    let mut radiance = vec![Rgb::ZERO; rays.len()];
    // As many together as a rendering hands over.
    for (rays, radiance) in rays.chunks(128).zip(radiance.chunks_mut(128)) {
        method.trace_all(rays, radiance, recorder);
    }
    radiance.into_iter().map(Rgb::element_sum).sum()
}

/// Brute force gets a smaller picture: the longer a run, the less often it stays undisturbed.
fn size(effort: Effort, index: &str) -> ImageSize {
    match index {
        "linear" => ImageSize::new(24, 24),
        _ => effort.pick(ImageSize::new(24, 24), ImageSize::new(96, 96)),
    }
}

fn all_scenes(effort: Effort) -> Vec<(&'static str, Scene)> {
    let levels = effort.pick([3, 5], [5, 8]);
    let generated = FAMILIES.into_iter().zip(levels).flat_map(|(name, levels)| {
        (1..=levels).map(move |level| (name, scenes::opened(name, Some(&level.to_string())).scene))
    });
    [("whitted", scenes::whitted())].into_iter().chain(generated).collect()
}

/// What was measured.
struct Measured<'s> {
    cases: Vec<Case<'s>>,
    study: Study<usize, f64>,
}

impl<'s> Measured<'s> {
    fn new(effort: Effort, scenes: &'s [(&'static str, Scene)]) -> Self {
        let cases: Vec<Case> = scenes
            .iter()
            .flat_map(|(name, scene)| INDEXES.map(|index| (*name, scene, index)))
            .filter(|(_, scene, index)| {
                *index != "linear" || scene.primitives().len() <= MOST_LINEAR
            })
            .map(|(name, scene, index)| Case::new(name, scene, index, size(effort, index)))
            .collect();
        // All pictures, then all queries: what ran before has emptied the caches for both alike.
        let contenders = ["whole", "queries"].into_iter().flat_map(|part| {
            cases.iter().map(move |case| Contender {
                curve: format!("{} {part}", case.label()),
                color: method_color(case.index_name),
                knob: case.primitives(),
                run: Box::new(move || {
                    let outcome = match part {
                        "whole" => picture(case.scene, &*case.index, case.size, &mut ()),
                        _ => case.replay(),
                    };
                    (outcome, case.queries.len() as u64)
                }),
            })
        });
        let study = Study::measure("rays", effort.runs(RUNS), contenders, |_| Vec::new());
        Self { cases, study }
    }

    /// The least time of a case's runs: what disturbs a run only makes it longer.
    fn seconds(&self, case: &Case, part: &str) -> f64 {
        self.study.at(&format!("{} {part}", case.label()), case.primitives()).seconds.low
    }

    /// The part of a case's time that its queries take, in percent.
    fn share(&self, case: &Case) -> f64 {
        100.0 * self.seconds(case, "queries") / self.seconds(case, "whole")
    }

    /// The cases of an index.
    fn by(&self, index: &str) -> Vec<&Case<'s>> {
        self.cases.iter().filter(|case| case.index_name == index).collect()
    }

    /// The cases of an index in a family of scenes.
    fn of(&self, family: &str, index: &str) -> Vec<&Case<'s>> {
        self.by(index).into_iter().filter(|case| case.scene_name == family).collect()
    }

    fn claim(&self) -> (String, bool) {
        let [linear, tree] = INDEXES.map(|index| {
            FAMILIES.map(|family| {
                let points = self.of(family, index).into_iter().map(Case::work);
                fitted_exponent(&points.collect::<Vec<_>>())
            })
        });
        let holds = linear.iter().all(|p| (0.9..1.1).contains(p)) && tree.iter().all(|p| *p < 0.3);
        let [by_force, by_tree] = INDEXES
            .map(|index| span(&mut self.by(index).into_iter().map(|case| self.share(case)), 0));
        let claim = format!(
            "With n primitives a ray costs brute force n^{:.2} tests, the hierarchy n^{:.2} (flake) and n^{:.2} \
             (tetrahedra); intersections take {by_force} % of the time by brute force and {by_tree} % with the \
             hierarchy, where Whitted measured 75 to 95 % in 1980.",
            linear[0], tree[0], tree[1],
        );
        (claim, holds)
    }

    fn bars(&self, index: &str, title: &str) -> BarChart {
        let cases = self.by(index);
        let names = cases.iter().map(|case| format!("{}, {}", case.scene_name, case.primitives()));
        let shares: Vec<f64> = cases.iter().map(|case| self.share(case)).collect();
        // A share measured above 100 % is printed as measured and leaves nothing to draw.
        let rest: Vec<f64> = shares.iter().map(|share| (100.0 - share).max(0.0)).collect();
        let rounded: Vec<f64> = shares.iter().map(|share| (10.0 * share).round() / 10.0).collect();
        BarChart::new("part of the time (%)", names)
            .title(title)
            .stacked()
            .first_printed()
            .series("intersections", category_color(0), rounded)
            .series("the rest", category_color(1), rest)
    }

    /// Tests per ray, and nanoseconds per ray.
    fn growth(&self) -> [Chart; 2] {
        let chart = |unit, title| {
            Chart::new(Axis::log("primitives, n"), Axis::log(unit))
                .title(title)
                .slope(1.0, "slope 1")
        };
        let mut tests = chart("tests per ray", "Counted work");
        let mut times = chart("nanoseconds per ray", "Time (one thread)");
        for (index, name) in INDEXES.into_iter().zip(["brute force", "hierarchy"]) {
            for family in FAMILIES {
                let cases = self.of(family, index);
                let styled = |label: String, color| {
                    let series = Series::new(label, color);
                    if family == FAMILIES[0] { series } else { series.dashed() }
                };
                let named = || styled(format!("{name}, {family}"), method_color(index));
                tests = tests.series(named().points(cases.iter().map(|case| case.work())));
                let per_ray = |case: &Case, seconds: f64| {
                    (case.primitives() as f64, 1e9 * seconds / case.queries.len() as f64)
                };
                let queries = cases.iter().map(|case| per_ray(case, self.seconds(case, "queries")));
                times = times.series(named().points(queries));
                if index == INDEXES[1] {
                    let rest = cases.iter().map(|case| {
                        per_ray(case, self.seconds(case, "whole") - self.seconds(case, "queries"))
                    });
                    let label = format!("the rest, {family}");
                    times = times.series(styled(label, category_color(1)).points(rest));
                }
            }
        }
        [tests, times]
    }

    fn table(&self) -> Table {
        let mut data = Table::new([
            "scene",
            "primitives",
            "index",
            "rays",
            "rays_per_pixel",
            "box_tests",
            "primitive_tests",
            "seconds_whole",
            "seconds_queries",
            "share_percent",
        ]);
        for case in &self.cases {
            data.push([
                case.scene_name.into(),
                case.primitives().into(),
                case.index_name.into(),
                case.queries.len().into(),
                case.rays_per_pixel().into(),
                case.counts.boxes.into(),
                case.counts.primitives.into(),
                self.seconds(case, "whole").into(),
                self.seconds(case, "queries").into(),
                self.share(case).into(),
            ]);
        }
        data
    }
}

pub fn make(effort: Effort) -> Finished {
    let scenes = all_scenes(effort);
    let measured = Measured::new(effort, &scenes);
    let (claim, holds) = measured.claim();
    let [tests, times] = measured.growth();
    let plate = Plate::new("1.13", "Where the time goes", claim, holds)
        .panel(
            Row::new()
                .panel(1.0, measured.bars(INDEXES[0], "Brute force"))
                .panel(1.0, measured.bars(INDEXES[1], "Hierarchy (obvhs-bvh2)")),
        )
        .panel(Row::new().panel(1.0, tests).panel(1.0, times))
        .note("« Temps de calcul important »", format!(
            "intersections and number of rays: {} rays per pixel. The exponents are fitted to the tests of \
             primitives and boxes by all rays of a picture",
            span(&mut measured.cases.iter().map(Case::rays_per_pixel), 1)
        ))
        .note("Method", format!(
            "algo:lr to depth 5, with shadow rays. All rays of a picture are recorded; then all pictures and, \
             after them, the bare queries of their rays are timed, {} times in turn, and the share is that \
             of the least times", effort.runs(RUNS)
        ))
        .note("Limits", "an estimate of this code on this machine, in which a share may be over 100: the bare \
             queries read their rays from memory, and no shading comes between them. Pictures and queries start with equally cold caches, so that \
             the nanoseconds grow faster than the tests where the scene must be fetched. Building the index \
             is not counted")
        .note("Settings", format!(
            "{} (brute force, up to {MOST_LINEAR} primitives) and {}, 1 sample per pixel",
            size(effort, "linear"), size(effort, "obvhs-bvh2")
        ))
        .note("Reference", "closed form for brute force: a ray tests all n primitives, a shadow ray that is \
             stopped at least one");
    Finished { plate, data: measured.table() }
}

/// From the least to the greatest.
fn span(values: &mut dyn Iterator<Item = f64>, places: usize) -> String {
    let (low, high) = values
        .fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    format!("{low:.places$} to {high:.places$}")
}
