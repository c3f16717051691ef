//! 4.2: what to put around an object: a sphere, a box, a turned box, or more slabs.

use glam::{DAffine3, DMat3, DVec3};
use lancer_accel::Bvh;
use lancer_core::generate::icosphere;
use lancer_core::geometry::Interval;
use lancer_core::intersector::Intersector;
use lancer_core::scene::{Mesh, Scene};
use lancer_figure::{BarChart, Effort, Finished, Plate, Row, Table, category_color, number};

use crate::scenes::teapot;
use crate::volumes::{Kind, random_lines};

/// The objects: a name, and a mesh.
fn objects() -> [(&'static str, Mesh); 5] {
    let scaled = |size: DVec3, turn: DMat3| {
        let mut mesh = Mesh::default();
        let stretch = turn * DMat3::from_diagonal(size);
        mesh.append(&icosphere(3), DAffine3::from_mat3(stretch), 0);
        mesh
    };
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, -1.0, 0.3).normalize(), 0.8);
    [
        ("ball", scaled(DVec3::ONE, DMat3::IDENTITY)),
        ("rod", scaled(DVec3::new(1.0, 0.04, 0.04), DMat3::IDENTITY)),
        ("slanted rod", scaled(DVec3::new(0.04, 0.04, 1.0), turn)),
        ("slanted disc", scaled(DVec3::new(1.0, 1.0, 0.03), turn)),
        ("teapot", teapot(3_000)),
    ]
}

/// What the object behind the volume costs a ray that meets the volume, in operations: one triangle's
/// test, and a hundred of them.
const BEHIND: [(&str, f64); 2] = [("a triangle", 60.0), ("a hundred triangles", 6000.0)];

/// One volume around one object.
struct Case {
    object: &'static str,
    kind: Kind,
    /// Lines that meet the volume, for each that meets the object.
    met: f64,
    /// Those lines as a part of the ones that meet the object's sphere.
    part: f64,
}

impl Case {
    /// Operations per line, the object's own included.
    fn cost(&self, behind: f64) -> f64 {
        f64::from(self.kind.operations()) + self.part * behind
    }
}

pub fn make(effort: Effort) -> Finished {
    let lines = effort.pick(4_000, 60_000);
    let cases: Vec<Case> =
        objects().into_iter().flat_map(|object| cases_of(object, lines)).collect();
    let names: Vec<&str> = cases.chunks(Kind::ALL.len()).map(|chunk| chunk[0].object).collect();
    let winner = |object: &str, behind: f64| {
        let of = cases.iter().filter(|case| case.object == object);
        let best = of.min_by(|a, b| a.cost(behind).total_cmp(&b.cost(behind)));
        best.expect("an object").kind
    };
    let winners: Vec<(Kind, Kind)> = names
        .iter()
        .map(|object| (winner(object, BEHIND[0].1), winner(object, BEHIND[1].1)))
        .collect();
    let mut kinds: Vec<&str> = winners.iter().flat_map(|(a, b)| [a.name(), b.name()]).collect();
    kinds.sort_unstable();
    kinds.dedup();
    // Nothing lies outside of its volume, and no volume is the best for all.
    let holds = kinds.len() >= 2 && cases.iter().all(|case| case.met >= 1.0);
    let most = |kind: Kind| {
        let of = cases.iter().filter(|case| case.kind == kind);
        of.map(|case| case.met).fold(0.0, f64::max)
    };
    let claim = format!(
        "No volume is the best for all objects: {} of the {} do the least work for one of them, and for each \
         line that meets the object up to {} meet its sphere, {} its box, {} its oriented box and {} its \
         seven slabs.",
        kinds.len(),
        Kind::ALL.len(),
        number(most(Kind::Sphere)),
        number(most(Kind::Box)),
        number(most(Kind::OrientedBox)),
        number(most(Kind::SevenSlabs)),
    );

    let bars = |title: &str, unit: &str, value: &dyn Fn(&Case) -> f64| {
        let mut chart = BarChart::new(unit, names.iter().copied()).title(title);
        for (k, kind) in Kind::ALL.into_iter().enumerate() {
            let of = cases.iter().filter(|case| case.kind == kind);
            // Three digits are enough to compare.
            let values: Vec<f64> = of.map(|case| rounded(value(case))).collect();
            chart = chart.series(kind.name(), category_color(k), values);
        }
        chart
    };
    let mut data = Table::new([
        "object",
        "volume",
        "operations",
        "lines_per_hit",
        "part_of_sphere",
        "cost_triangle",
        "cost_hundred",
    ]);
    for case in &cases {
        data.push([
            case.object.into(),
            case.kind.name().into(),
            case.kind.operations().into(),
            case.met.into(),
            case.part.into(),
            case.cost(BEHIND[0].1).into(),
            case.cost(BEHIND[1].1).into(),
        ]);
    }
    let best = |k: usize| {
        let of = names.iter().zip(&winners);
        let of =
            of.map(|(object, winners)| format!("{object}: {}", [winners.0, winners.1][k].name()));
        of.collect::<Vec<_>>().join(", ")
    };
    let operations =
        Kind::ALL.map(|kind| format!("{} {}", kind.name(), kind.operations())).join(", ");
    let cost = |k: usize| move |case: &Case| case.cost(BEHIND[k].1);
    let plate = Plate::new("4.2", "Which volume around an object", claim, holds)
        .panel(bars("How well it fits", "lines that meet the volume, per line that meets the object", &|case| case.met))
        .panel(
            Row::new()
                .panel(1.0, bars("Work in front of one triangle", "operations per line", &cost(0)))
                .panel(1.0, bars("In front of a hundred", "operations per line", &cost(1))),
        )
        .note("Least work", format!("in front of {}: {}. In front of {}: {}", BEHIND[0].0, best(0), BEHIND[1].0, best(1)))
        .note("Operations of a test", format!(
            "{operations}; what depends on the ray alone is computed once for all boxes and all slabs, but not \
             for boxes that are turned each in its own way"
        ))
        .note("Lines", format!(
            "{lines} without preference of place or direction that meet the sphere; of such lines a convex body is met by a \
             part in proportion to its surface"
        ))
        .note("Reference", "the hits of a hierarchy over the object's triangles, which are those of brute force");
    Finished { plate, data }
}

fn rounded(x: f64) -> f64 {
    let digit = 10.0_f64.powf(x.log10().floor() - 2.0);
    (x / digit).round() * digit
}

fn cases_of((object, mesh): (&'static str, Mesh), count: u32) -> Vec<Case> {
    let scene = Scene::of_mesh(mesh);
    let index = Bvh::build(&scene);
    let points = &scene.mesh.positions;
    let sphere = scene.bounding_sphere().expect("an object");
    // A little larger than the sphere that is compared, whose lines are counted anew.
    let lines: Vec<_> = random_lines(sphere.center, 1.01 * sphere.radius, count).collect();
    let around = Kind::Sphere.around(points);
    let in_sphere = lines.iter().filter(|line| around.meets(line)).count() as f64;
    let hits = lines.iter().filter(|line| index.occluded(line, Interval::POSITIVE)).count() as f64;
    Kind::ALL
        .into_iter()
        .map(|kind| {
            let volume = kind.around(points);
            let met = lines.iter().filter(|line| volume.meets(line)).count() as f64;
            Case { object, kind, met: met / hits, part: met / in_sphere }
        })
        .collect()
}
