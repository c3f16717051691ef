//! 1.13: what part of a picture's time the intersections take, by the number of primitives and by index.

use lancer_accel::ObvhsBvh2;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Hit, Intersector, LinearScan, TestCounts};
use lancer_core::scene::Scene;
use lancer_core::world::World;
use lancer_figure::{
    Axis, BarChart, Chart, Color, Contender, Effort, Finished, Plate, Row, Series, Study, Table,
    category_color, decimals, method_color,
};
use lancer_whitted::{Call, Recorder, Settings, Whitted};

use crate::scenes;

/// Everything that a picture asks its index, in order.
#[derive(Default)]
struct Queries(Vec<Query>);

struct Query {
    ray: Ray,
    range: Interval,
    /// Whether any hit will do: a shadow ray.
    any: bool,
}

impl Recorder for Queries {
    fn enter(&mut self, call: &Call) {
        self.0.push(Query { ray: call.ray, range: Interval::POSITIVE, any: false });
    }

    fn shadow(&mut self, ray: &Ray, _visible: bool) {
        self.0.push(Query { ray: *ray, range: Interval::up_to(1.0), any: true });
    }
}

enum Index<'s> {
    Linear(LinearScan<'s>),
    Tree(ObvhsBvh2<'s>),
}

/// Their names as methods.
const INDEXES: [&str; 2] = ["linear", "obvhs-bvh2"];

impl Index<'_> {
    fn intersector(&self) -> &dyn Intersector {
        match self {
            Self::Linear(index) => index,
            Self::Tree(index) => index,
        }
    }

    fn count(&self, query: &Query, counts: &mut TestCounts) -> Option<Hit> {
        let Query { ray, range, any } = query;
        match self {
            Self::Linear(index) => index.walk(ray, *range, counts, |_| *any),
            Self::Tree(index) => index.walk(ray, *range, counts, |_| *any),
        }
    }
}

/// A scene at one level of detail with one index.
struct Case<'s> {
    scene_name: &'static str,
    scene: &'s Scene,
    index_name: &'static str,
    index: Index<'s>,
    queries: Vec<Query>,
    counts: TestCounts,
}

impl<'s> Case<'s> {
    fn new(
        scene_name: &'static str,
        scene: &'s Scene,
        index_name: &'static str,
        size: ImageSize,
    ) -> Self {
        let index = match index_name {
            "linear" => Index::Linear(LinearScan::new(scene)),
            _ => Index::Tree(ObvhsBvh2::build(scene)),
        };
        let mut queries = Queries::default();
        picture(scene, &index, size, &mut queries);
        let (queries, mut counts) = (queries.0, TestCounts::default());
        for query in &queries {
            index.count(query, &mut counts);
        }
        Self { scene_name, scene, index_name, index, queries, counts }
    }

    fn label(&self) -> String {
        format!("{} {}", self.scene_name, self.index_name)
    }

    fn primitives(&self) -> usize {
        self.scene.primitives().len()
    }

    fn tests_per_ray(&self) -> f64 {
        (self.counts.boxes + self.counts.primitives) as f64 / self.queries.len() as f64
    }

    /// Only the queries. Returns the number of hits.
    fn replay(&self) -> f64 {
        let index = self.index.intersector();
        let hits = self.queries.iter().filter(|query| match query.any {
            false => index.closest_hit(&query.ray, query.range).is_some(),
            true => index.occluded(&query.ray, query.range),
        });
        hits.count() as f64
    }
}

/// A picture by one thread: the sum of its pixels.
fn picture<R: Recorder>(scene: &Scene, index: &Index, size: ImageSize, recorder: &mut R) -> f64 {
    let method = Whitted::new(World { scene, index: index.intersector() }, Settings::default());
    let rays = scene.camera.primary_rays(size);
    let pixels = (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| {
            let ray = rays.through(f64::from(x) + 0.5, f64::from(y) + 0.5);
            method.trace(&ray, recorder).element_sum()
        })
        .sum()
}

/// The exponent p of y ≈ c xᵖ by least squares between the logarithms.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean_x = logs.iter().map(|(x, _)| x).sum::<f64>() / count;
    let mean_y = logs.iter().map(|(_, y)| y).sum::<f64>() / count;
    let covariance: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    covariance / logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum::<f64>()
}

pub fn make(effort: Effort) -> Finished {
    let size = effort.pick(ImageSize::new(24, 24), ImageSize::new(64, 64));
    // Brute force is not asked to do more.
    let most_linear = effort.pick(1100, 8000);
    let levels = effort.pick([3, 5], [5, 8]);
    let generated = |name: &'static str, levels: u32| {
        (1..=levels).map(move |level| {
            let opened = scenes::open(name, Some(&level.to_string()));
            (name, opened.expect("a level that the scene has").scene)
        })
    };
    let scenes: Vec<(&str, Scene)> = [("whitted", scenes::whitted())]
        .into_iter()
        .chain(generated("flake", levels[0]))
        .chain(generated("tetrahedra", levels[1]))
        .collect();
    let cases: Vec<Case> = scenes
        .iter()
        .flat_map(|(name, scene)| INDEXES.map(|index| (*name, scene, index)))
        .filter(|(_, scene, index)| *index != "linear" || scene.primitives().len() <= most_linear)
        .map(|(name, scene, index)| Case::new(name, scene, index, size))
        .collect();

    let contenders = cases.iter().flat_map(|case| {
        let contender = |part: &str, run: Box<dyn Fn() -> f64>| Contender {
            label: format!("{} {part}", case.label()),
            color: method_color(case.index_name),
            knob: case.primitives().to_string(),
            run: Box::new(move || (run(), case.queries.len() as u64)),
        };
        [
            contender("whole", Box::new(|| picture(case.scene, &case.index, size, &mut ()))),
            contender("queries", Box::new(|| case.replay())),
        ]
    });
    let (study, _) =
        Study::measure("rays", effort.pick(2, 5), contenders.collect(), |_| Vec::new());
    todo!()
}
