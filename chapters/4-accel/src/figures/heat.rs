//! 4.8: where in a picture each structure works, on one scale.

use lancer_accel::structures::STRUCTURES;
use lancer_core::geometry::Interval;
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Hit, Intersector, LinearScan, Query, TestCounts};
use lancer_core::scene::Scene;
use lancer_figure::{
    Effort, Finished, HeatScale, Montage, Plate, Table, Tile, decimals, method_color, number,
};

use super::shaded;
use crate::scenes::family;

/// What every pixel's ray met, and the work it took.
fn watch(
    scene: &Scene,
    size: ImageSize,
    index: &dyn Intersector,
) -> Vec<(Option<Hit>, TestCounts)> {
    let rays = scene.camera.primary_rays(size);
    let pixels = (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| {
            let ray = rays.through(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let mut counts = TestCounts::default();
            (index.watch(Query::closest(&ray, Interval::POSITIVE), &mut counts), counts)
        })
        .collect()
}

/// A structure's work over the picture.
struct Map {
    name: &'static str,
    visits: Vec<f64>,
    tests: Vec<f64>,
    /// Both, in ascending order.
    sorted: Vec<f64>,
    wrong: usize,
}

impl Map {
    fn of(
        name: &'static str,
        seen: &[(Option<Hit>, TestCounts)],
        expected: &[Option<Hit>],
    ) -> Self {
        let visits = seen.iter().map(|(_, n)| (n.boxes + n.cells) as f64).collect();
        let tests = seen.iter().map(|(_, n)| n.primitives as f64).collect();
        let wrong =
            seen.iter().zip(expected).filter(|((hit, _), expected)| hit != *expected).count();
        let mut map = Self { name, visits, tests, sorted: Vec::new(), wrong };
        map.sorted = map.sums();
        map.sorted.sort_by(f64::total_cmp);
        map
    }

    fn sums(&self) -> Vec<f64> {
        self.visits.iter().zip(&self.tests).map(|(visits, tests)| visits + tests).collect()
    }

    fn mean(&self) -> f64 {
        mean(&self.visits) + mean(&self.tests)
    }

    fn median(&self) -> f64 {
        self.sorted[self.sorted.len() / 2]
    }

    fn most(&self) -> f64 {
        self.sorted[self.sorted.len() - 1]
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The structures that cut space; the others group primitives.
const SUBDIVISIONS: [&str; 4] = ["grid", "octree", "kd", "bsp"];

/// The least and the greatest mean of some structures.
fn span(maps: &[&Map], values: fn(&Map) -> &[f64]) -> [f64; 2] {
    let means = || maps.iter().map(|map| mean(values(map)));
    [means().fold(f64::INFINITY, f64::min), means().fold(0.0, f64::max)]
}

pub fn make(effort: Effort) -> Finished {
    let size = effort.pick(ImageSize::new(36, 24), ImageSize::new(300, 200));
    let scene = family("town").scene(effort.pick(1_000, 4_000));
    let expected: Vec<Option<Hit>> =
        watch(&scene, size, &LinearScan::new(&scene)).into_iter().map(|(hit, _)| hit).collect();
    let maps: Vec<Map> = STRUCTURES
        .iter()
        .filter(|structure| structure.name != "linear")
        .map(|structure| {
            let built = structure.build(&scene);
            Map::of(structure.name, &watch(&scene, size, &*built.index), &expected)
        })
        .collect();

    let (subdivisions, hierarchies): (Vec<&Map>, Vec<&Map>) =
        maps.iter().partition(|map| SUBDIVISIONS.contains(&map.name));
    let visits = [&hierarchies, &subdivisions].map(|maps| span(maps, |map| &map.visits));
    let tests = [&hierarchies, &subdivisions].map(|maps| span(maps, |map| &map.tests));
    let right = maps.iter().all(|map| map.wrong == 0);
    let holds = right && visits[0][0] > visits[1][1] && tests[0][1] < tests[1][0];
    let words = |[low, high]: [f64; 2]| format!("{} to {}", decimals(low, 1), decimals(high, 1));
    let claim = format!(
        "In a town every hierarchy of volumes visits more and tests less than every subdivision of space: {} boxes \
         and {} triangles per ray against {} cells and {} triangles.",
        words(visits[0]),
        words(tests[0]),
        words(visits[1]),
        words(tests[1]),
    );
    let least = maps.iter().min_by(|a, b| a.mean().total_cmp(&b.mean())).expect("structures");

    let most = maps.iter().map(Map::most).fold(1.0, f64::max);
    let scale = HeatScale::log("visits + tests per ray", 1.0, most);
    let mut montage = Montage::new().columns(3).color_bar(&scale).tile(
        Tile::new(
            format!("Town, {} triangles", scene.primitives().len()),
            shaded(&scene, scene.camera, size),
        )
        .subtitle("nearer to white: facing the eye"),
    );
    let mut data = Table::new(["index", "visits", "tests", "median", "most", "wrong"]);
    for map in &maps {
        let [visits, tests] = [&map.visits, &map.tests].map(|values| mean(values));
        let numbers = format!(
            "{} = {} visits + {} tests; most {}",
            decimals(map.mean(), 1),
            decimals(visits, 1),
            decimals(tests, 1),
            number(map.most()),
        );
        montage = montage.tile(
            Tile::new(map.name, scale.paint(size.width, size.height, &map.sums()))
                .color(method_color(map.name))
                .subtitle(numbers),
        );
        data.push([
            map.name.into(),
            visits.into(),
            tests.into(),
            map.median().into(),
            map.most().into(),
            map.wrong.into(),
        ]);
    }
    let plate = Plate::new("4.8", "Where each structure works", claim, holds)
        .panel(montage)
        .note("Numbers", format!(
            "means over all pixels, and the most expensive pixel. The least sum here has « {} », but counts are not seconds: \
             a hierarchy tests 4 or 8 boxes at once, and a ray past the town costs it those of its root, while a \
             subdivision compares its own box uncounted",
            least.name,
        ))
        .note("Settings", format!("scene town, {size}, one primary ray through each pixel's centre, default parameters"))
        .note("Reference", "brute force: every index has its hit in every pixel, the same t and triangle bit for bit");
    Finished { plate, data }
}
