//! 0.3: rays aimed at what triangles share, against three tests that all look right.

use std::time::Instant;

use glam::{DVec2, DVec3};
use lancer_core::generate::icosphere;
use lancer_core::geometry::{Ray, Shear, intersect_triangle};
use lancer_core::sampling::{Pattern, PixelSampling};
use lancer_core::scene::Mesh;
use lancer_figure::{
    BarChart, Effort, Finished, Inset, Montage, Picture, Plate, Row, Table, Tile, category_color,
    method_color,
};

use crate::naive::{fused_edges, moeller_trumbore};

type Test = fn([DVec3; 3], &Ray) -> bool;

fn watertight(corners: [DVec3; 3], ray: &Ray) -> bool {
    intersect_triangle(corners, ray, &Shear::new(ray.direction)).is_some()
}

const TESTS: [(&str, Test); 3] = [
    ("Möller-Trumbore", moeller_trumbore),
    ("fused edge functions", fused_edges),
    ("watertight", watertight),
];

/// Where the rays go.
const AIMS: [&str; 3] = ["random directions", "points of edges", "vertices"];

pub fn make(effort: Effort) -> Finished {
    let mesh = icosphere(3);
    let count = effort.pick(2_000, 50_000);
    let mut data = Table::new(["test", "aim", "rays", "leaks", "nanoseconds_per_test"]);
    let mut leaks = [[0; AIMS.len()]; TESTS.len()];
    let mut cost = [0.0; TESTS.len()];
    for (a, aim) in AIMS.iter().enumerate() {
        let rays = aimed(&mesh, a, count);
        for (t, (name, test)) in TESTS.iter().enumerate() {
            let start = Instant::now();
            let (missed, tested) = leaking(&mesh, &rays, *test);
            cost[t] = start.elapsed().as_secs_f64() * 1e9 / tested as f64;
            leaks[t][a] = missed;
            data.push([(*name).into(), (*aim).into(), count.into(), missed.into(), cost[t].into()]);
        }
    }
    let ours = leaks[2];
    let holds = ours == [0; 3] && leaks[0][1] > 0 && leaks[0][2] > 0 && leaks[1][1] > 0;
    let per_cent = |leaks: usize| 100.0 * leaks as f64 / count as f64;
    let claim = format!(
        "Of {count} rays aimed at vertices of a closed mesh, Möller-Trumbore lets {:.1} % through, the \
         watertight test {}; random rays find no leak in any of them.",
        per_cent(leaks[0][2]),
        if ours == [0; 3] { "none".to_owned() } else { format!("{}", ours[2]) },
    );
    let random_find_nothing = leaks.iter().all(|row| row[0] == 0);

    let mut bars = BarChart::new("rays that leak (%)", AIMS).title("Leaks");
    for (t, (name, _)) in TESTS.iter().enumerate() {
        let color = [method_color("naive"), category_color(1), category_color(2)][t];
        bars = bars.series(*name, color, leaks[t].map(per_cent));
    }
    let relief = Relief::new(effort.pick([48, 32], [192, 128]));
    let inset = effort.pick(Inset::new(14, 10, 16, 10), Inset::new(70, 50, 40, 26));
    let pictures = Montage::new()
        .tile(
            Tile::new("Möller-Trumbore", relief.seen_by(moeller_trumbore))
                .color(method_color("naive")),
        )
        .tile(Tile::new("Watertight", relief.seen_by(watertight)).color(category_color(2)))
        .inset(inset)
        .insets_right()
        .columns(2);
    let plate = Plate::new("0.3", "No ray passes between two triangles", claim, holds && random_find_nothing)
        .panel(pictures)
        .panel(Row::new().panel(1.0, bars))
        .note("Pictures", "a relief, every pixel's ray aimed at a vertex; black is a ray that met nothing")
        .note("Method", format!(
            "eq:ray-triangle in f64, a closed sphere of {} triangles seen from inside; the edge functions \
             of neighbours must agree to the last bit, which a fused multiply-add breaks",
            mesh.triangles.len()
        ))
        .note("Cost", format!(
            "{:.1} / {:.1} / {:.1} ns per triangle, in the order of the legend (the watertight test also \
             works out t, its error bound and the weights, and prepares each ray once per triangle here)",
            cost[0], cost[1], cost[2]
        ))
        .note("Reference", "exact: no ray from inside leaves a closed mesh");
    Finished { plate, data }
}

/// Rays from around the middle of a closed mesh.
fn aimed(mesh: &Mesh, aim: usize, count: usize) -> Vec<Ray> {
    let sampling = PixelSampling { pattern: Pattern::Jittered, samples: 1, seed: 3 };
    let mut numbers =
        (0..).flat_map(|x| sampling.points(x, 0).map(DVec2::fract)).flat_map(|p| [p.x, p.y]);
    let mut unit = move || numbers.next().unwrap_or_default();
    (0..count)
        .map(|_| {
            let origin = DVec3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5) * 0.6;
            let triangle = (unit() * mesh.triangles.len() as f64) as usize;
            let [a, b, c] = mesh.corners(triangle);
            let target = match aim {
                0 => DVec3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5) + 0.1 * c,
                1 => a + unit() * (b - a),
                _ => a,
            };
            Ray::new(origin, target - origin)
        })
        .collect()
}

/// How many rays meet no triangle, and how many tests that took.
fn leaking(mesh: &Mesh, rays: &[Ray], test: Test) -> (usize, usize) {
    let mut tested = 0;
    let missed = rays
        .iter()
        .filter(|ray| {
            let first = (0..mesh.triangles.len()).position(|index| test(mesh.corners(index), ray));
            tested += first.map_or(mesh.triangles.len(), |index| index + 1);
            first.is_none()
        })
        .count();
    (missed, tested)
}

/// A wavy sheet with one vertex for each pixel.
struct Relief {
    size: [u32; 2],
    vertices: Vec<DVec3>,
}

impl Relief {
    fn new(size: [u32; 2]) -> Self {
        let [width, height] = size;
        // One row and column more on each side, so that every pixel's vertex is an inner one.
        let vertices = (0..height + 2)
            .flat_map(|row| (0..width + 2).map(move |column| (column, row)))
            .map(|(column, row)| {
                let x = f64::from(column) / f64::from(width) * 3.0 - 1.5;
                let y = 1.0 - f64::from(row) / f64::from(height) * 2.0;
                let bump =
                    (3.1 * x + 0.7).sin() * (2.7 * y - 0.4).cos() + 0.4 * (7.0 * x * y).sin();
                DVec3::new(x, y, 0.22 * bump)
            })
            .collect();
        Self { size, vertices }
    }

    fn vertex(&self, column: u32, row: u32) -> DVec3 {
        self.vertices[(row * (self.size[0] + 2) + column) as usize]
    }

    fn seen_by(&self, test: Test) -> Picture {
        let eye = DVec3::new(0.31, 0.17, 4.3);
        let to_light = DVec3::new(-0.5, 0.6, 0.62).normalize();
        Picture::from_fn(self.size[0], self.size[1], |x, y| {
            let (column, row) = (x + 1, y + 1);
            let target = self.vertex(column, row);
            let ray = Ray::new(eye, target - eye);
            // The six triangles around the vertex: both halves of the four cells.
            let cell = |column: u32, row: u32| {
                let [a, b] = [self.vertex(column, row), self.vertex(column + 1, row)];
                let [c, d] = [self.vertex(column, row + 1), self.vertex(column + 1, row + 1)];
                [[a, c, d], [a, d, b]]
            };
            let around =
                [(column - 1, row - 1), (column, row - 1), (column - 1, row), (column, row)];
            let met = around
                .into_iter()
                .flat_map(|(column, row)| cell(column, row))
                .any(|corners| test(corners, &ray));
            if !met {
                return [0; 3];
            }
            let (across, down) = (
                self.vertex(column + 1, row) - self.vertex(column - 1, row),
                self.vertex(column, row + 1) - self.vertex(column, row - 1),
            );
            let n = down.cross(across).normalize();
            let light = 0.25 + 0.75 * n.dot(to_light).max(0.0);
            [235.0, 205.0, 160.0].map(|channel| (channel * light) as u8)
        })
    }
}
