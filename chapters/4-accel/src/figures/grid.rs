//! 4.5: how many cells a grid should have, and the « théière dans un stade » where no number helps.

use glam::UVec3;
use lancer_accel::GridBuilder;
use lancer_accel::structures::structure;
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Hit, Intersector, LinearScan, TestCounts};
use lancer_core::scene::{Camera, Scene};
use lancer_figure::{
    Axis, Chart, Effort, Finished, Montage, Plate, Row, Series, Table, Tile, category_color,
    method_color, number,
};

use super::shaded;
use crate::rays::Rays;
use crate::scenes::family;

/// Cells per primitive that are asked for.
const DENSITIES: [f64; 10] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];
/// What the grid is compared with in the stadium.
const OTHERS: [&str; 4] = ["octree", "kd", "bsp", "bvh"];

/// The rays of all kinds through a scene, and what they meet.
struct Questions {
    rays: [Rays; 3],
    hits: Vec<Vec<Option<Hit>>>,
}

/// What all rays cost an index, per ray.
#[derive(Clone, Copy)]
struct Work {
    cells: f64,
    tests: f64,
    wrong: bool,
}

impl Work {
    fn sum(&self) -> f64 {
        self.cells + self.tests
    }
}

impl Questions {
    fn new(scene: &Scene, size: ImageSize) -> Self {
        let rays = Rays::of(scene, size, &*structure("bvh").build(scene).index);
        let oracle = LinearScan::new(scene);
        let hits = rays.iter().map(|rays| rays.watch(&oracle).0).collect();
        Self { rays, hits }
    }

    fn count(&self) -> usize {
        self.rays.iter().map(|rays| rays.queries.len()).sum()
    }

    fn ask(&self, index: &dyn Intersector) -> Work {
        let (mut counts, mut wrong) = (TestCounts::default(), false);
        for (rays, expected) in self.rays.iter().zip(&self.hits) {
            let (hits, more) = rays.watch(index);
            wrong |= !rays.agree(&hits, expected);
            counts += more;
        }
        let per_ray = |count: u64| count as f64 / self.count() as f64;
        // A box of a hierarchy is to it what a cell is to a subdivision.
        Work {
            cells: per_ray(counts.boxes + counts.cells),
            tests: per_ray(counts.primitives),
            wrong,
        }
    }
}

/// A grid of some density, with the mailbox and without.
struct GridTrial {
    density: f64,
    resolution: UVec3,
    bytes: f64,
    work: Work,
    unmarked: Work,
}

fn sweep(scene: &Scene, questions: &Questions) -> Vec<GridTrial> {
    let primitives = scene.primitives().len() as f64;
    let trial = |density| {
        let [grid, unmarked] =
            [true, false].map(|mailboxing| GridBuilder { density, mailboxing }.build(scene));
        GridTrial {
            density,
            resolution: grid.resolution(),
            bytes: grid.memory() as f64 / primitives,
            work: questions.ask(&grid),
            unmarked: questions.ask(&unmarked),
        }
    };
    DENSITIES.into_iter().map(trial).collect()
}

impl GridTrial {
    fn sum(&self) -> f64 {
        self.work.sum()
    }
}

/// The trial of the least work.
fn best(trials: &[GridTrial]) -> &GridTrial {
    let least = trials.iter().min_by(|a, b| a.sum().total_cmp(&b.sum()));
    least.expect("densities were tried")
}

/// What was measured: grids of all densities over triangles evenly spread and over the stadium, and the trees over
/// the stadium with their bytes per triangle.
struct Measured {
    even: Vec<GridTrial>,
    uneven: Vec<GridTrial>,
    others: Vec<(&'static str, f64, Work)>,
}

impl Measured {
    fn new([soup, stadium]: [&Scene; 2], [in_soup, in_stadium]: [&Questions; 2]) -> Self {
        let others = OTHERS.map(|name| {
            let built = structure(name).build(stadium);
            let bytes = built.bytes as f64 / stadium.primitives().len() as f64;
            (name, bytes, in_stadium.ask(&*built.index))
        });
        let (even, uneven) = (sweep(soup, in_soup), sweep(stadium, in_stadium));
        Self { even, uneven, others: others.into() }
    }

    fn claim(&self) -> (String, bool) {
        let Self { even, uneven, others } = self;
        let of = |value: fn(&GridTrial) -> f64| -> Vec<f64> { even.iter().map(value).collect() };
        let falls = |values: &[f64]| values.is_sorted_by(|a, b| a >= b);
        let sums = of(GridTrial::sum);
        let lowest = best(even);
        let bottom = even.iter().position(|trial| trial.density == lowest.density).unwrap_or(0);
        let one_minimum = falls(&sums[..=bottom]) && sums[bottom..].is_sorted();
        let at_ends = [sums[0], sums[sums.len() - 1]];
        let u_shape = falls(&of(|trial| trial.work.tests))
            && of(|trial| trial.work.cells).is_sorted()
            && one_minimum
            && at_ends.iter().all(|end| *end > 1.5 * lowest.sum());
        let worst = others.iter().map(|(_, _, work)| work.sum()).fold(0.0, f64::max);
        let lost = best(uneven).sum() / worst;
        let is_right = |trial: &GridTrial| !trial.work.wrong && !trial.unmarked.wrong;
        let right = even.iter().chain(uneven).all(is_right)
            && others.iter().all(|(_, _, work)| !work.wrong);
        let claim = format!(
            "More cells mean fewer primitive tests and more steps: their sum has one minimum, {} per ray at {} cells per \
             triangle, but with a teapot in a stadium the best grid of all costs {} times as much as the most expensive tree.",
            number(lowest.sum().round()),
            number(lowest.density),
            number(lost.round()),
        );
        (claim, u_shape && lost > 5.0 && right)
    }

    fn work(&self) -> Chart {
        let line = |label: &str, color, value: fn(&GridTrial) -> f64| {
            let points = self.even.iter().map(|trial| (trial.density, value(trial)));
            Series::new(label, category_color(color)).points(points)
        };
        Chart::new(Axis::log("cells per triangle"), Axis::log("per ray"))
            .title("Triangles evenly spread (soup): counted work")
            .series(line("cells visited", 4, |trial| trial.work.cells))
            .series(line("triangle tests", 3, |trial| trial.work.tests))
            .series(line("tests, no mailbox", 3, |trial| trial.unmarked.tests).dashed())
            .series(sums("sum", &self.even))
            .vertical(best(&self.even).density, "minimum")
    }

    fn memory(&self) -> Chart {
        let series = |label: &str, trials: &[GridTrial]| {
            let points = trials.iter().map(|trial| (trial.density, trial.bytes));
            Series::new(label, method_color("grid")).points(points)
        };
        Chart::new(Axis::log("cells per triangle"), Axis::log("bytes per triangle"))
            .title("Memory of the grid")
            .series(series("soup", &self.even))
            .series(series("stadium", &self.uneven).dashed())
    }

    fn losing(&self) -> Chart {
        let per_ray = Axis::log("cells or boxes, and tests, per ray");
        let chart = Chart::new(Axis::log("cells per triangle"), per_ray)
            .title("« Théière dans un stade »: no density saves the grid")
            .series(sums("grid", &self.uneven));
        self.others.iter().fold(chart, |chart, (name, _, work)| {
            let ends = [DENSITIES[0], DENSITIES[DENSITIES.len() - 1]];
            let points = ends.map(|density| (density, work.sum()));
            chart.series(Series::new(*name, method_color(name)).curve().points(points))
        })
    }

    fn table(&self) -> Table {
        let mut data = Table::new([
            "scene",
            "index",
            "density",
            "bytes_per_triangle",
            "cells_or_boxes",
            "tests",
            "tests_no_mailbox",
            "wrong",
            "resolution",
        ]);
        for (scene, trials) in [("soup", &self.even), ("stadium", &self.uneven)] {
            for trial in trials {
                data.push([
                    scene.into(),
                    "grid".into(),
                    trial.density.into(),
                    trial.bytes.into(),
                    trial.work.cells.into(),
                    trial.work.tests.into(),
                    trial.unmarked.tests.into(),
                    u32::from(trial.work.wrong || trial.unmarked.wrong).into(),
                    format!("{}x{}x{}", trial.resolution.x, trial.resolution.y, trial.resolution.z)
                        .into(),
                ]);
            }
        }
        for (name, bytes, work) in &self.others {
            data.push([
                "stadium".into(),
                (*name).into(),
                f64::NAN.into(),
                (*bytes).into(),
                work.cells.into(),
                work.tests.into(),
                f64::NAN.into(),
                u32::from(work.wrong).into(),
                "".into(),
            ]);
        }
        data
    }
}

/// Cells and tests together, by density.
fn sums(label: &str, trials: &[GridTrial]) -> Series {
    let points = trials.iter().map(|trial| (trial.density, trial.sum()));
    Series::new(label, method_color("grid")).points(points)
}

/// The stadium from afar, and its teapot.
fn pictures(stadium: &Scene, size: ImageSize) -> Montage {
    let framing = Camera::framing(stadium.bounding_sphere().expect("triangles"));
    // A flat scene does not fill its sphere.
    let far = Camera { fov: 0.75 * framing.fov, ..framing };
    let near = shaded(stadium, stadium.camera, size);
    Montage::new()
        .columns(1)
        .tile(Tile::new("The whole stadium", shaded(stadium, far, size)))
        .tile(Tile::new("Its teapot, a thousandth as large", near))
}

pub fn make(effort: Effort) -> Finished {
    let count = effort.pick(2_000, 10_000);
    let size = effort.pick(ImageSize::new(12, 12), ImageSize::new(40, 40));
    let [soup, stadium] = ["soup", "stadium"].map(|name| family(name).scene(count));
    let [in_soup, in_stadium] = [&soup, &stadium].map(|scene| Questions::new(scene, size));
    let measured = Measured::new([&soup, &stadium], [&in_soup, &in_stadium]);
    let (claim, holds) = measured.claim();
    let shown_size = effort.pick(ImageSize::new(48, 32), ImageSize::new(360, 240));
    let Measured { even, uneven, .. } = &measured;
    let spared = |trial: &GridTrial| 100.0 * (1.0 - trial.work.tests / trial.unmarked.tests);
    let plate = Plate::new("4.5", "How many cells a grid should have", claim, holds)
        .panel(Row::new().panel(1.4, measured.work()).panel(1.0, measured.memory()))
        .panel(
            Row::new()
                .panel(1.0, pictures(&stadium, shown_size))
                .panel(2.0, measured.losing()),
        )
        .note("Mailbox", format!(
            "what lies in several cells is tested once: the mailbox spares {} % of the tests at {} cells per \
             triangle and {} % at {}",
            number(spared(&even[0]).round()),
            number(even[0].density),
            number(spared(&even[even.len() - 1]).round()),
            number(even[even.len() - 1].density),
        ))
        .note("Why it loses", format!(
            "cells that suit the stadium hold the whole teapot: at one cell per triangle a ray tests {} of its {} \
             triangles; the trees divide where the triangles are. The teapot stands in the \
             middle: an even number of cells along x or z halves it",
            number(at_one(uneven).work.tests.round()),
            stadium.primitives().len(),
        ))
        .note("Settings", format!(
            "{} and {} triangles; primary rays ({size}), shadow and one-bounce diffuse rays, {} and {} in all. A step \
             and a test count alike, as do a cell and a box",
            soup.primitives().len(), stadium.primitives().len(), in_soup.count(), in_stadium.count(),
        ))
        .note("Reference", "brute force: every index has its answers, the same t and triangle bit for bit, and of shadow rays the \
             same are stopped");
    Finished { plate, data: measured.table() }
}

/// The grid with its default density.
fn at_one(trials: &[GridTrial]) -> &GridTrial {
    trials.iter().find(|trial| trial.density == 1.0).expect("the default density was tried")
}
