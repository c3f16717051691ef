//! 0.3: rays aimed at what triangles share, against three tests that all look right.

use std::hint::black_box;

use glam::DVec3;
use lancer_core::generate::icosphere;
use lancer_core::geometry::{Ray, Shear, intersect_triangle};
use lancer_core::sampling::Uniform;
use lancer_core::scene::Mesh;
use lancer_figure::{
    BarChart, Color, Contender, Effort, Finished, Inset, Montage, Picture, Plate, Row, Study, Tile,
    category_color, method_color, number,
};

use lancer_lesson::naive::{BySigns, moeller_trumbore};

/// The three tests.
pub(super) const TESTS: [&str; 3] = ["Möller-Trumbore", "fused edge functions", "watertight"];

const COLORS: [fn() -> Color; 3] =
    [|| method_color("naive"), || category_color(1), || category_color(2)];

/// A triangle's corners.
type Corners = [DVec3; 3];

/// The triangles of a mesh.
pub(super) fn triangles(mesh: &Mesh) -> Vec<Corners> {
    (0..mesh.triangles.len()).map(|index| mesh.corners(index)).collect()
}

/// How many rays meet no triangle by one of [`TESTS`], and the tests made. A ray is prepared once, and
/// tested with one triangle after the other until one is met.
pub(super) fn leaking(test: usize, triangles: &[Corners], rays: &[Ray]) -> (usize, u64) {
    match test {
        0 => missing(triangles, rays, |ray| |corners| moeller_trumbore(corners, ray)),
        1 => missing(triangles, rays, |ray| {
            let ray = BySigns::new(ray);
            move |corners| ray.fused(corners)
        }),
        _ => missing(triangles, rays, |ray| {
            let shear = Shear::new(ray.direction);
            move |corners| intersect_triangle(corners, ray, &shear).map(|hit| hit.t)
        }),
    }
}

fn missing<'a, T: Fn(Corners) -> Option<f64>>(
    triangles: &[Corners],
    rays: &'a [Ray],
    prepare: impl Fn(&'a Ray) -> T,
) -> (usize, u64) {
    let (mut missed, mut tests) = (0, 0);
    for ray in rays {
        let test = prepare(ray);
        let mut met = None;
        for &corners in triangles {
            tests += 1;
            met = test(corners);
            if met.is_some() {
                break;
            }
        }
        missed += usize::from(black_box(met).is_none());
    }
    (missed, tests)
}

/// Where the rays go.
const AIMS: [&str; 3] = ["random directions", "points of edges", "vertices"];
/// The number of an aim.
pub(crate) const EDGES: usize = 1;
pub(crate) const VERTICES: usize = 2;

pub fn make(effort: Effort) -> Finished {
    let mesh = icosphere(3);
    let triangles = triangles(&mesh);
    let count = effort.pick(2_000, 20_000);
    let rays: Vec<Vec<Ray>> = (0..AIMS.len()).map(|aim| aimed(&mesh, aim, count)).collect();
    let contenders = TESTS.iter().zip(COLORS).enumerate().flat_map(|(test, (&name, color))| {
        let (triangles, rays) = (&triangles, &rays);
        (0..AIMS.len()).map(move |aim| Contender {
            curve: name.to_owned(),
            color: color(),
            knob: AIMS[aim],
            run: Box::new(move || leaking(test, triangles, &rays[aim])),
        })
    });
    let study = Study::measure("tests", effort.runs(3), contenders, |&leaks: &usize| {
        vec![("leaking rays (%)", 100.0 * leaks as f64 / count as f64)]
    });
    let leaks = |test: usize| AIMS.map(|aim| study.at(TESTS[test], aim).error("leaking rays (%)"));
    let all = [leaks(0), leaks(1), leaks(2)];
    let [moeller_trumbore_leaks, fused_leaks, watertight_leaks] = all;
    let holds = watertight_leaks == [0.0; 3]
        && moeller_trumbore_leaks[1].min(moeller_trumbore_leaks[2]) > 0.0
        && fused_leaks[1] > 0.0
        && all.iter().all(|leaks| leaks[0] == 0.0);
    let claim = format!(
        "Of {count} rays aimed at vertices of a closed mesh, Möller-Trumbore lets {:.1} % through, the \
         watertight test {} %; rays in random directions find no leak in any test.",
        moeller_trumbore_leaks[2],
        number(watertight_leaks[2]),
    );

    let mut bars = BarChart::new("leaking rays (%)", AIMS).title("Leaks");
    for (name, (color, leaks)) in TESTS.iter().zip(COLORS.iter().zip(all)) {
        bars = bars.series(*name, color(), leaks);
    }
    let relief = Relief::new(effort.pick([48, 32], [192, 128]));
    let inset = effort.pick(Inset::new(14, 10, 16, 10), Inset::new(70, 50, 40, 26));
    let tile = |test: usize| Tile::new(TESTS[test], relief.seen_by(test)).color(COLORS[test]());
    let pictures =
        Montage::new().tile(tile(0)).tile(tile(2)).inset(inset).insets_right().columns(2);
    let plate = Plate::new("0.3", "No ray passes between two triangles", claim, holds)
        .panel(pictures)
        .panel(Row::new().panel(1.0, bars))
        .panel(study.chart("leaking rays (%)"))
        .note("Pictures", "a relief, every pixel's ray aimed at a vertex; black is a ray that met nothing")
        .note("Method", format!(
            "eq:ray-triangle in f64, a closed sphere of {} triangles seen from inside, tried in order until \
             one is met; the edge functions of neighbours must agree to the last bit, which a fused \
             multiply-add breaks. The watertight test also works out the bound of t's error and the weights",
            mesh.triangles.len()
        ))
        .note("Reference", "exact: no ray from inside leaves a closed mesh");
    Finished { plate, data: study.table() }
}

/// Rays from around the middle of a closed mesh.
pub(crate) fn aimed(mesh: &Mesh, aim: usize, count: usize) -> Vec<Ray> {
    let mut random = Uniform::new(3, aim as u32, 0);
    let mut unit = move || random.number();
    (0..count)
        .map(|_| {
            let origin = DVec3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5) * 0.6;
            let triangle = (unit() * mesh.triangles.len() as f64) as usize;
            let [a, b, c] = mesh.corners(triangle);
            let target = match aim {
                0 => DVec3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5) + 0.1 * c,
                EDGES => a + unit() * (b - a),
                _ => a,
            };
            Ray::new(origin, target - origin)
        })
        .collect()
}

/// A wavy sheet with one vertex for each pixel.
pub(crate) struct Relief {
    size: [u32; 2],
    vertices: Vec<DVec3>,
}

impl Relief {
    pub(crate) fn new(size: [u32; 2]) -> Self {
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

    /// By one of [`TESTS`].
    fn seen_by(&self, test: usize) -> Picture {
        Picture::from_fn(self.size[0], self.size[1], |x, y| {
            let meets = |corners, ray: &Ray| leaking(test, &[corners], &[*ray]).0 == 0;
            let light = self.brightness(x, y, meets).unwrap_or(0.0);
            [235.0, 205.0, 160.0].map(|channel| (channel * light) as u8)
        })
    }

    /// How bright the relief is at a pixel's vertex, up to 1, if the ray aimed there meets it by `test`.
    pub(crate) fn brightness(
        &self,
        x: u32,
        y: u32,
        test: impl Fn([DVec3; 3], &Ray) -> bool,
    ) -> Option<f64> {
        let eye = DVec3::new(0.31, 0.17, 4.3);
        let to_light = DVec3::new(-0.5, 0.6, 0.62).normalize();
        let (column, row) = (x + 1, y + 1);
        let target = self.vertex(column, row);
        let ray = Ray::new(eye, target - eye);
        // The six triangles around the vertex: both halves of the four cells.
        let cell = |column: u32, row: u32| {
            let [a, b] = [self.vertex(column, row), self.vertex(column + 1, row)];
            let [c, d] = [self.vertex(column, row + 1), self.vertex(column + 1, row + 1)];
            [[a, c, d], [a, d, b]]
        };
        let around = [(column - 1, row - 1), (column, row - 1), (column - 1, row), (column, row)];
        let met = around
            .into_iter()
            .flat_map(|(column, row)| cell(column, row))
            .any(|corners| test(corners, &ray));
        let (across, down) = (
            self.vertex(column + 1, row) - self.vertex(column - 1, row),
            self.vertex(column, row + 1) - self.vertex(column, row - 1),
        );
        let n = down.cross(across).normalize();
        met.then(|| 0.25 + 0.75 * n.dot(to_light).max(0.0))
    }
}
