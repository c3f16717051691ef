//! 0.1: a sphere far away, by the textbook's quadratic and by the stable one.

use glam::{DVec3, Vec3};
use lancer_core::geometry::{Interval, Ray, Sphere};
use lancer_figure::{
    Axis, Chart, Effort, Finished, Plate, Row, Series, Table, category_color, method_color, number,
};

use lancer_lesson::naive::textbook_sphere;

/// The ray leaves the origin along D = (2, 3, 6), of length 7. A sphere of radius 35 stands at
/// k D + 3 (6, 2, −3): its centre is 21 beside the ray, the half chord is √(35² − 21²) = 28 = 4 |D|, and
/// the ray enters it at t = k − 4 exactly.
const DIRECTION: DVec3 = DVec3::new(2.0, 3.0, 6.0);
const ASIDE: DVec3 = DVec3::new(18.0, 6.0, -9.0);
/// Everything is a tenth as large and D of unit length: integers would not be rounded.
const SCALE: f64 = 0.1;
const RADIUS: f64 = 35.0 * SCALE;

/// A way to find t, given the centre and the direction.
type Solver = fn(DVec3, DVec3) -> Option<f64>;

const SOLVERS: [(&str, Solver); 4] = [
    ("textbook f32", textbook_f32),
    ("stable f32", stable_f32),
    ("textbook f64", |center, d| textbook_sphere(sphere(center), &Ray::new(DVec3::ZERO, d))),
    ("stable f64", |center, d| {
        sphere(center).intersect(&Ray::new(DVec3::ZERO, d), Interval::POSITIVE)
    }),
];

fn sphere(center: DVec3) -> Sphere {
    Sphere { center, radius: RADIUS }
}

fn textbook_f32(center: DVec3, direction: DVec3) -> Option<f64> {
    let (f, d, r) = (-center.as_vec3(), direction.as_vec3(), RADIUS as f32);
    let (a, b) = (d.length_squared(), f.dot(d));
    let discriminant = b * b - a * (f.length_squared() - r * r);
    (discriminant >= 0.0).then(|| f64::from((-b - discriminant.sqrt()) / a))
}

fn stable_f32(center: DVec3, direction: DVec3) -> Option<f64> {
    let (f, d, r): (Vec3, Vec3, f32) = (-center.as_vec3(), direction.as_vec3(), RADIUS as f32);
    let (a, b) = (d.length_squared(), f.dot(d));
    let discriminant = a * r * r - f.cross(d).length_squared();
    (discriminant >= 0.0)
        .then(|| f64::from((f.length_squared() - r * r) / (discriminant.sqrt() - b)))
}

pub fn make(effort: Effort) -> Finished {
    let mut data = Table::new(["solver", "distance_over_radius", "largest_error", "lost_of_96"]);
    let mut errors = Chart::new(
        Axis::log("distance / radius"),
        Axis::log("largest relative error of t (1: sphere lost)"),
    )
    .title("Error of the hit")
    .height(560.0);
    let per_octave = effort.pick(1, 2);
    let distances: Vec<f64> = (5 * per_octave..=21 * per_octave)
        .map(|step| 2.0_f64.powf(f64::from(step) / f64::from(per_octave)).round())
        .collect();
    let colors = [method_color("naive"), category_color(1), category_color(3), category_color(2)];
    let mut worst = [0.0_f64; SOLVERS.len()];
    let mut first_lost = [None; SOLVERS.len()];
    for (s, ((name, solver), color)) in SOLVERS.iter().zip(colors).enumerate() {
        let mut series = Series::new(*name, color);
        for &k in &distances {
            let (error, lost) = at(k, *solver);
            let distance = k / 5.0;
            worst[s] = worst[s].max(error);
            if lost > 0 && first_lost[s].is_none() {
                first_lost[s] = Some(distance);
            }
            series = series.point(distance, error);
            data.push([(*name).into(), distance.into(), error.into(), lost.into()]);
        }
        errors = errors.series(series);
    }
    let holds =
        worst[3] <= 4.0 * f64::EPSILON && first_lost[0].is_some() && worst[2] > 1e3 * worst[3];
    let claim = format!(
        "Up to {} radii away the stable form in 64 bits errs by {} at most; the textbook's in 64 bits by \
         {}, and in 32 bits it loses spheres from {} radii on.",
        number(distances.last().map_or(0.0, |k| k / 5.0)),
        number(worst[3]),
        number(worst[2]),
        first_lost[0].map_or("no".to_owned(), number),
    );
    let plate = Plate::new("0.1", "The quadratic of a far sphere", claim, holds)
        .panel(Row::new().panel(1.0, errors))
        .note(
            "Method",
            "eq:ray-sphere: (D·D) r² − |F×D|² in place of (F·D)² − (D·D)(F·F − r²), and the near \
             root from the product of the roots; each point is the worst of 96 rays",
        )
        .note(
            "Reference",
            "closed form: the ray enters the sphere at t = 0.7 (k − 4), since 2² + 3² + 6² = 7² and \
             35² = 21² + 28²; the rounding of its numbers alone is 10⁻¹⁶ in 64 bits, 10⁻⁷ in 32",
        );
    Finished { plate, data }
}

/// The largest relative error of t over the 48 ways to turn the axes and two neighbouring distances,
/// and how many of these 96 spheres are lost, which counts as an error of 1.
fn at(k: f64, solver: Solver) -> (f64, usize) {
    let (mut largest, mut lost) = (0.0_f64, 0);
    for k in [k, k + 1.0] {
        for turn in 0..48 {
            let (sphere, ray, exact) = far_sphere(k, turn);
            match solver(sphere.center, ray.direction) {
                Some(t) => largest = largest.max((t / exact - 1.0).abs()),
                None => {
                    lost += 1;
                    largest = largest.max(1.0);
                }
            }
        }
    }
    (largest, lost)
}

/// A sphere k / 5 radii away, turned by one of the 48 symmetries of the cube, with a ray from the origin and
/// the exact t at which that enters it.
pub(crate) fn far_sphere(k: f64, turn: usize) -> (Sphere, Ray, f64) {
    let center = turned(SCALE * (k * DIRECTION + ASIDE), turn);
    let ray = Ray::new(DVec3::ZERO, turned(DIRECTION / 7.0, turn));
    (sphere(center), ray, 7.0 * SCALE * (k - 4.0))
}

/// One of the 48 symmetries of the cube.
fn turned(v: DVec3, turn: usize) -> DVec3 {
    let [x, y, z] = v.to_array();
    let [a, b, c] = [[x, y, z], [y, z, x], [z, x, y], [x, z, y], [z, y, x], [y, x, z]][turn % 6];
    let sign = |bit: usize| if (turn / 6) >> bit & 1 == 0 { 1.0 } else { -1.0 };
    DVec3::new(sign(0) * a, sign(1) * b, sign(2) * c)
}
