//! 4.7: every index on the same rays: counted work, time, memory, and what the build is worth.

use lancer_accel::structures::{STRUCTURES, Structure};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Intersector, TestCounts};
use lancer_figure::{
    Axis, BarChart, Chart, Effort, Finished, Plate, Row, Series, Table, method_color, power_of_ten,
    time_in_turn,
};
use lancer_lesson::judge::fitted_exponent;

use crate::rays::{Kind, Rays};
use crate::scenes::{FAMILIES, Family};

/// Brute force is not asked for more triangles.
const MOST_LINEAR: u32 = 1_000;
/// The BSP tree, which is the slowest to build, is not asked for more; all indexes are compared at this size.
const MOST_BSP: u32 = 100_000;
/// Larger scenes are built of these kinds only: a plate should not take minutes.
const LARGE: [&str; 2] = ["soup", "scan"];

/// How high a chart is: there are eight.
const CHART: f64 = 360.0;

/// An index of a scene.
struct Case {
    family: Family,
    triangles: usize,
    name: &'static str,
    rays: usize,
    hits: usize,
    counts: TestCounts,
    bytes: usize,
    build: f64,
    trace: f64,
}

impl Case {
    fn per_ray(&self, count: u64) -> f64 {
        count as f64 / self.rays as f64
    }

    /// Boxes, cells and primitives, counted alike.
    fn work(&self) -> f64 {
        self.per_ray(self.counts.boxes + self.counts.cells + self.counts.primitives)
    }

    fn nanoseconds(&self) -> f64 {
        1e9 * self.trace / self.rays as f64
    }

    /// Seconds for building and tracing so many rays.
    fn total(&self, rays: f64) -> f64 {
        self.build + rays * self.trace / self.rays as f64
    }
}

fn takes(structure: &Structure, count: u32) -> bool {
    match structure.name {
        "linear" => count <= MOST_LINEAR,
        "bsp" => count <= MOST_BSP,
        _ => true,
    }
}

/// All indexes of one scene, on the same rays.
///
/// # Panics
/// If two indexes differ in an answer: their speeds could not be compared.
fn measure(family: Family, count: u32, size: ImageSize, runs: usize) -> Vec<Case> {
    let scene = family.scene(count);
    let structures: Vec<Structure> =
        STRUCTURES.into_iter().filter(|structure| takes(structure, count)).collect();
    let built = time_in_turn(1, structures.iter().map(|structure| || structure.build(&scene)));

    let rays = Rays::of(&scene, size, &*built.last().expect("an index").1.index);
    let count_of_rays = rays.iter().map(|rays| rays.queries.len()).sum();
    let trace = |index: &dyn Intersector| rays.iter().map(|rays| rays.trace(index)).sum::<usize>();
    let traces = time_in_turn(runs, built.iter().map(|(_, built)| || trace(&*built.index)));

    let mut answers = None;
    let each = structures.iter().zip(&built).zip(&traces);
    let watched = each.map(|((structure, (build, built)), (trace, hits))| {
        let mut counts = TestCounts::default();
        let mut found = Vec::new();
        for rays in &rays {
            let (met, work) = rays.watch(&*built.index);
            counts += work;
            // Of a shadow ray only whether it hits is the same for all.
            let key = |hit: lancer_core::intersector::Hit| match rays.kind {
                Kind::Shadow => (0, 0),
                _ => (hit.t.to_bits(), hit.primitive.0),
            };
            found.extend(met.into_iter().map(|hit| hit.map(key)));
        }
        assert_eq!(found.iter().flatten().count(), *hits, "{}: {}", family.name, structure.name);
        let wanted = answers.get_or_insert_with(|| found.clone());
        assert!(*wanted == found, "{} differs in {}", structure.name, family.name);
        Case {
            family,
            triangles: scene.mesh.triangles.len(),
            name: structure.name,
            rays: count_of_rays,
            hits: *hits,
            counts,
            bytes: built.bytes,
            build: build.low,
            trace: trace.low,
        }
    });
    watched.collect()
}

fn names() -> impl Iterator<Item = &'static str> {
    STRUCTURES.into_iter().map(|structure| structure.name)
}

/// What was measured: cases of all sizes, and the greatest size that all but brute force are asked for.
struct Measured {
    cases: Vec<Case>,
    shared: u32,
}

impl Measured {
    fn new(effort: Effort, size: ImageSize) -> Self {
        let decades = effort.pick(2..=4, 2..=6);
        let shared = 10_u32.pow((*decades.end()).min(MOST_BSP.ilog10()));
        let cases = FAMILIES.into_iter().flat_map(|family| {
            let counts = decades.clone().map(|decade| 10_u32.pow(decade));
            let is_large = LARGE.contains(&family.name);
            counts
                .filter(move |count| is_large || *count <= MOST_BSP)
                .flat_map(move |count| measure(family, count, size, effort.runs(3)))
        });
        Self { cases: cases.collect(), shared }
    }

    /// The cases of an index in a kind of scene.
    fn of(&self, family: &str, name: &str) -> Vec<&Case> {
        let of = |case: &&Case| case.family.name == family && case.name == name;
        self.cases.iter().filter(of).collect()
    }

    /// The cases of a kind of scene at the shared size.
    fn at_shared(&self, family: &str) -> Vec<&Case> {
        let shared = f64::from(self.shared);
        let near = |case: &&Case| (0.5..2.0).contains(&(case.triangles as f64 / shared));
        self.cases.iter().filter(|case| case.family.name == family).filter(near).collect()
    }

    /// The shared size in words.
    fn shared_size(&self) -> String {
        power_of_ten(self.shared.ilog10() as i32)
    }

    /// How the work grows with the number of triangles.
    fn exponent(&self, family: &str, name: &str) -> f64 {
        let points = self.of(family, name).into_iter();
        let points = points.map(|case| (case.triangles as f64, case.work()));
        fitted_exponent(&points.collect::<Vec<_>>())
    }

    /// The exponents of each index in all kinds of scenes.
    fn exponents(&self) -> Vec<(&'static str, [f64; 4])> {
        let of = |name| (name, FAMILIES.map(|family| self.exponent(family.name, name)));
        names().map(of).collect()
    }

    fn claim(&self) -> (String, bool) {
        let exponents = self.exponents();
        let brute = exponents[0].1;
        // Where an index comes near to brute force, its exponent says so.
        let (steady, lost): (Vec<_>, Vec<_>) =
            exponents[1..].iter().partition(|(_, exponents)| exponents.iter().all(|p| *p < 0.5));
        let greatest =
            steady.iter().flat_map(|(_, p)| p).copied().fold(f64::NEG_INFINITY, f64::max);
        let losses = lost.iter().flat_map(|(name, exponents)| {
            let families = FAMILIES.iter().zip(exponents).filter(|(_, p)| **p >= 0.5);
            families.map(move |(family, p)| format!("{name} n^{p:.2} in the {}", family.name))
        });
        let is_steady = |name: &str| steady.iter().any(|(steady, _)| *steady == name);
        let holds = brute.iter().all(|p| (0.9..1.1).contains(p))
            && names().filter(|name| !["linear", "grid"].contains(name)).all(is_steady)
            && self.exponent("stadium", "grid") > 0.8
            && self.exponent("soup", "grid") < 0.5;
        let claim = format!(
            "With n triangles a ray costs brute force n^{:.2} tests; {} cost at most n^{greatest:.2} in every kind \
             of scene, but {}.",
            brute[0],
            steady.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", "),
            losses.collect::<Vec<_>>().join(", "),
        );
        (claim, holds)
    }

    /// How something grows with the number of triangles, in two kinds of scenes.
    fn growth(
        &self,
        title: &str,
        unit: &str,
        value: fn(&Case) -> f64,
        families: [usize; 2],
    ) -> Row {
        families.into_iter().fold(Row::new(), |row, k| {
            let family = FAMILIES[k].name;
            let chart = Chart::new(Axis::log("triangles, n"), Axis::log(unit))
                .title(format!("{family}: {title}"))
                .height(CHART);
            let chart = names().fold(chart, |chart, name| {
                let points = self.of(family, name).into_iter();
                let points = points.map(|case| (case.triangles as f64, value(case)));
                chart.series(Series::new(name, method_color(name)).points(points))
            });
            row.panel(1.0, chart)
        })
    }

    /// A number of each index at the shared size.
    fn bars(&self, title: &str, axis: &str, value: fn(&Case) -> f64) -> BarChart {
        let chart = BarChart::new(axis, FAMILIES.map(|family| family.name)).title(title);
        names().filter(|name| *name != "linear").fold(chart, |chart, name| {
            let values = FAMILIES.map(|family| {
                let cases = self.at_shared(family.name);
                value(cases.iter().find(|case| case.name == name).expect("an index"))
            });
            chart.series(name, method_color(name), values)
        })
    }

    /// What building and tracing take together, by the number of rays.
    fn totals(&self, family: &str) -> Chart {
        let chart = Chart::new(Axis::log("rays"), Axis::log("build and trace (s)"))
            .title(format!("{family}, {} triangles", self.shared_size()))
            .height(CHART);
        self.at_shared(family).into_iter().fold(chart, |chart, case| {
            let points = (6..=18).map(|step| 10_f64.powf(f64::from(step) / 2.0));
            let points = points.map(|rays| (rays, case.total(rays)));
            chart.series(Series::new(case.name, method_color(case.name)).points(points).curve())
        })
    }

    fn listed_exponents(&self) -> String {
        let listed = self.exponents().into_iter().map(|(name, exponents)| {
            let exponents = exponents.map(|p| lancer_figure::decimals(p, 2));
            format!("{name} {}", exponents.join(" / "))
        });
        listed.collect::<Vec<_>>().join("; ")
    }

    fn cheapest(&self) -> String {
        let of = |family: Family| {
            let cheapest = [1e4, 1e6, 1e8].map(|rays| {
                let cases = self.at_shared(family.name).into_iter();
                let least = cases.min_by(|a, b| a.total(rays).total_cmp(&b.total(rays)));
                least.expect("an index").name
            });
            format!("{} {}", family.name, cheapest.join(" / "))
        };
        FAMILIES.map(of).join("; ")
    }

    fn hits(&self) -> String {
        let of = |family: Family| {
            let cases = self.at_shared(family.name);
            format!("{} {} of {} rays", family.name, cases[0].hits, cases[0].rays)
        };
        FAMILIES.map(of).join("; ")
    }

    fn table(&self) -> Table {
        let mut data = Table::new([
            "family",
            "triangles",
            "index",
            "rays",
            "hits",
            "boxes_per_ray",
            "cells_per_ray",
            "primitive_tests_per_ray",
            "ns_per_ray",
            "bytes_per_triangle",
            "build_seconds",
            "seconds_for_1e4_rays",
            "seconds_for_1e6_rays",
            "seconds_for_1e8_rays",
            "work_exponent",
        ]);
        for case in &self.cases {
            data.push([
                case.family.name.into(),
                case.triangles.into(),
                case.name.into(),
                case.rays.into(),
                case.hits.into(),
                case.per_ray(case.counts.boxes).into(),
                case.per_ray(case.counts.cells).into(),
                case.per_ray(case.counts.primitives).into(),
                case.nanoseconds().into(),
                (case.bytes as f64 / case.triangles as f64).into(),
                case.build.into(),
                case.total(1e4).into(),
                case.total(1e6).into(),
                case.total(1e8).into(),
                self.exponent(case.family.name, case.name).into(),
            ]);
        }
        data
    }
}

pub fn make(effort: Effort) -> Finished {
    let size = effort.pick(ImageSize::new(16, 16), ImageSize::new(48, 48));
    let measured = Measured::new(effort, size);
    let (claim, holds) = measured.claim();
    let work = "boxes, cells and triangles per ray";
    let memory = |case: &Case| (case.bytes as f64 / case.triangles as f64).round();
    let build = |case: &Case| (1e3 * case.build).round();
    let plate = Plate::new("4.7", "Which index to take", claim, holds)
        .panel(measured.growth("work", work, Case::work, [0, 1]))
        .panel(measured.growth("work", work, Case::work, [2, 3]))
        .panel(measured.growth("time", "nanoseconds per ray", Case::nanoseconds, [0, 3]))
        .panel(
            Row::new()
                .panel(1.0, measured.bars("Memory", "bytes per triangle", memory))
                .panel(1.0, measured.bars("Build", "milliseconds", build)),
        )
        .panel(Row::new().panel(1.0, measured.totals("scan")).panel(1.0, measured.totals("stadium")))
        .note(
            "Exponents",
            format!("of the work, soup / scan / town / stadium: {}", measured.listed_exponents()),
        )
        .note("Cheapest", format!(
            "build and trace of 10⁴ / 10⁶ / 10⁸ rays at {} triangles: {}",
            measured.shared_size(), measured.cheapest()
        ))
        .note("Equal answers", format!(
            "every index returns the same t, bit for bit, and the same triangle (of a shadow ray, whether it is \
             blocked), or the figure stops: {} hit. Up to {MOST_LINEAR} triangles brute force is one of \
             them; beyond, it is plate 4.11 that compares with it",
            measured.hits()
        ))
        .note("Method", format!(
            "primary, shadow and diffuse rays of a picture of {size}; one build, the least of the traces' times, \
             taken in turn. Up to {MOST_LINEAR} triangles by brute force, up to {MOST_BSP} by the BSP tree, \
             whose build is the slowest; more than that for {} only. Memory and build are those of the scenes of \
             {} triangles",
            LARGE.join(" and "),
            measured.shared_size()
        ))
        .note("Limits", "tests of boxes, visits of cells and tests of triangles are counted alike but do not cost \
             alike: compare work within one index, time between indexes. Times are of this machine");
    Finished { plate, data: measured.table() }
}
