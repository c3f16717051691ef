//! 1.4: how light weakens with distance, and how far away a lamp is a point.

use std::f64::consts::PI;

use glam::DVec3;
use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::geometry::Ray;
use lancer_core::image::ImageSize;
use lancer_core::sampling::{Pattern, PixelSampling};
use lancer_core::scene::{Camera, Material, MaterialId, Mesh, PointLight, Scene};
use lancer_core::world::World;
use lancer_figure::{
    Axis, Chart, Color, Contender, Effort, Finished, Montage, Plate, Row, Series, Study, Table,
    Tile, category_color, method_color, number,
};
use lancer_lesson::judge::fitted_exponent;
use lancer_lesson::picture::{picture, shown};
use lancer_lesson::scenes::parsed;
use lancer_whitted::{Appel, RayCounts, Recorder};

/// Balls ever farther from a lamp, on a floor.
const ROW: &str = "
    camera = { eye = [5, 3.2, 9], look_at = [5.3, 0.35, 0], fov = 16 }
    material.floor = { rho_d = 0.5 }
    material.ball = { rho_d = [0.9, 0.75, 0.5] }
    light = [{ position = [0.2, 1.9, 1.8], intensity = 6 }]
    sphere = [
        { center = [0.6, 0.4, 0], radius = 0.4, material = 'ball' },
        { center = [2.1, 0.4, -0.2], radius = 0.4, material = 'ball' },
        { center = [3.9, 0.4, -0.4], radius = 0.4, material = 'ball' },
        { center = [5.8, 0.4, -0.6], radius = 0.4, material = 'ball' },
        { center = [7.9, 0.4, -0.8], radius = 0.4, material = 'ball' },
        { center = [10.1, 0.4, -1], radius = 0.4, material = 'ball' },
    ]
    [[polygon]]
    vertices = [[-40, 0, 40], [40, 0, 40], [40, 0, -40], [-40, 0, -40]]
    material = 'floor'";

/// A law of the distance from the lamp.
type Law = fn(f64) -> f64;

/// What stands in eq:attenuation's place, each 1 at the first ball, at distance [`NEAR`].
const LAWS: [(&str, Law); 3] = [
    ("1 / d²", |d| (NEAR / d).powi(2)),
    ("1 / (1 + d)", |d| (1.0 + NEAR) / (1.0 + d)),
    ("constant", |_| 1.0),
];
const NEAR: f64 = 2.0;
const COLORS: [fn() -> Color; 3] =
    [|| method_color("appel"), || category_color(5), || category_color(3)];

/// How far the lamp is, if a shadow ray asked for it.
#[derive(Clone, Copy, Default)]
struct LampDistance(Option<f64>);

impl Recorder for LampDistance {
    fn shadow(&mut self, ray: &Ray, _visible: bool) {
        self.0 = Some(ray.direction.length());
    }
}

/// Appel's radiance with its one lamp weakened by another law.
fn radiance_by(appel: &Appel, ray: &Ray, law: Law) -> Rgb {
    let mut distance = LampDistance::default();
    let radiance = appel.trace(ray, &mut distance);
    // I_local is in proportion to 1 / d², and there is no other light.
    let by_law = |d: f64| radiance * (d / NEAR).powi(2) * law(d);
    distance.0.map_or(Rgb::ZERO, by_law)
}

/// A white surface of side 1 in the plane y = 0, facing what is above it.
fn white_floor() -> Scene {
    let mut mesh = Mesh::default();
    square(&mut mesh, DVec3::ZERO, DVec3::Z, DVec3::X, MaterialId(0));
    Scene {
        camera: Camera {
            eye: DVec3::ONE,
            look_at: DVec3::ZERO,
            up: DVec3::Y,
            fov: 40.0,
            lens: None,
        },
        mesh,
        spheres: Vec::new(),
        motions: Vec::new(),
        materials: vec![
            Material::matte(Rgb::ONE),
            Material { emission: Rgb::ONE, ..Material::matte(Rgb::ZERO) },
        ],
        lights: Vec::new(),
        ambient: Rgb::ZERO,
        background: Rgb::ZERO,
    }
}

/// A square face around `center` with the sides `a` and `b`, facing a × b.
fn square(mesh: &mut Mesh, center: DVec3, a: DVec3, b: DVec3, material: MaterialId) {
    let first = mesh.positions.len() as u32;
    let corners = [-a - b, a - b, a + b, b - a];
    mesh.positions.extend(corners.map(|corner| center + 0.5 * corner));
    mesh.push_face(material, &[[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

/// What Appel's method says of the middle of the white floor, and the shadow rays it took.
fn floor_radiance(scene: &Scene, index: &ObvhsBvh2) -> (f64, u64) {
    let appel = Appel::new(World { scene, index });
    let mut counts = RayCounts::default();
    let ray = Ray::new(DVec3::new(0.01, 0.01, 0.02), DVec3::new(-1.0, -1.0, -2.0).normalize());
    (appel.trace(&ray, &mut counts).x, counts.shadow)
}

/// The floor under a point light of intensity 1 at distance `d`.
fn under_point(d: f64) -> f64 {
    let mut scene = white_floor();
    scene.lights.push(PointLight { position: DVec3::Y * d, intensity: Rgb::ONE });
    floor_radiance(&scene, &ObvhsBvh2::build(&scene)).0
}

/// The floor under a square lamp of side 1 and radiance 1 at height `h`, cut into `cuts` × `cuts` faces.
fn square_lamp(h: f64, cuts: u32) -> Scene {
    let mut scene = white_floor();
    let side = 1.0 / f64::from(cuts);
    for k in 0..cuts * cuts {
        let [x, z] = [k % cuts, k / cuts].map(|k| (f64::from(k) + 0.5) * side - 0.5);
        let center = DVec3::new(x, h, z);
        square(&mut scene.mesh, center, DVec3::X * side, DVec3::Z * side, MaterialId(1));
    }
    scene
}

/// The radiance of the floor in closed form: Lambert's formula for a parallel square over the point, a quarter at a time.
fn lambert(h: f64) -> f64 {
    let x = 0.5 / h;
    let s = (1.0 + x * x).sqrt();
    4.0 * (x / s) * (x / s).atan() / PI
}

const CUTS: [u32; 5] = [1, 2, 4, 8, 16];

pub fn make(effort: Effort) -> Finished {
    // At distances 1, √2, 2 … 64.
    let distances = (0..=12).map(|k| 2.0_f64.powf(f64::from(k) / 2.0));
    let mut data = Table::new(["lamp", "distance", "points", "radiance", "exact", "error"]);
    let (mut points, mut errors): (Vec<_>, Vec<_>) = (Vec::new(), Vec::new());
    for d in distances {
        let (radiance, exact) = (under_point(d), 1.0 / (d * d));
        data.push([
            "point".into(),
            d.into(),
            1_u32.into(),
            radiance.into(),
            exact.into(),
            (radiance / exact - 1.0).abs().into(),
        ]);
        points.push((d, radiance));
        for cuts in CUTS {
            let scene = square_lamp(d, cuts);
            let radiance = floor_radiance(&scene, &ObvhsBvh2::build(&scene)).0;
            let exact = lambert(d);
            let error = (radiance / exact - 1.0).abs();
            data.push([
                "square".into(),
                d.into(),
                (cuts * cuts).into(),
                radiance.into(),
                exact.into(),
                error.into(),
            ]);
            if cuts == 1 {
                errors.push((d, error));
            }
        }
    }
    let off = points.windows(2).map(|pair| (fitted_exponent(pair) + 2.0).abs()).fold(0.0, f64::max);
    let [near, far] = [errors[0].1, errors[6].1];
    let error_slope = fitted_exponent(&errors[6..]);
    let holds = off < 1e-12 && near > 0.1 && (error_slope + 2.0).abs() < 0.05;
    let claim = format!(
        "Light falls with slope −2 on logarithmic axes, to {}; a square lamp taken for a point errs by {:.0} % one \
         side away, by {:.2} % at eight sides: its error falls with slope −{:.2} as well.",
        number(off),
        100.0 * near,
        100.0 * far,
        -error_slope,
    );

    let heights = [(1.0, "lamp 1 side away", 1), (4.0, "lamp 4 sides away", 2)];
    let scenes = heights.map(|(height, ..)| CUTS.map(|cuts| square_lamp(height, cuts)));
    let indexes = scenes.each_ref().map(|scenes| scenes.each_ref().map(ObvhsBvh2::build));
    let mut contenders = Vec::new();
    for ((height, label, color), (scenes, indexes)) in
        heights.into_iter().zip(scenes.iter().zip(&indexes))
    {
        for ((cuts, scene), index) in CUTS.into_iter().zip(scenes).zip(indexes) {
            contenders.push(Contender {
                curve: label.to_owned(),
                color: category_color(color),
                knob: format!("{} points", cuts * cuts),
                run: Box::new(move || {
                    let (radiance, rays) = floor_radiance(scene, index);
                    ((radiance / lambert(height) - 1.0).abs(), rays)
                }),
            });
        }
    }
    let judge = |&error: &f64| vec![("relative error", error)];
    let study = Study::measure("shadow rays", effort.runs(31), contenders, judge);

    let mut laws = Chart::new(Axis::log("distance from the lamp"), Axis::log("light received"))
        .title("Three laws")
        .height(480.0);
    for ((name, law), color) in LAWS.iter().zip(COLORS) {
        let curve = points.iter().map(|&(d, _)| (d, law(d) / law(1.0)));
        laws = laws.series(Series::new(*name, color()).curve().points(curve));
    }
    let measured = Series::new("measured", method_color("appel")).scatter();
    laws = laws.series(measured.points(points)).slope(-2.0, "slope −2");
    let as_point =
        Chart::new(Axis::log("distance / side of the lamp"), Axis::log("relative error"))
            .title("A square lamp as one point")
            .height(480.0)
            .series(Series::new("measured", method_color("appel")).points(errors))
            .slope(-2.0, "slope −2");
    let plate = Plate::new("1.4", "Light weakens with the square of the distance", claim, holds)
        .panel(row_of_balls(effort))
        .panel(Row::new().panel(1.0, laws).panel(1.0, as_point))
        .panel(study.chart("relative error").slope(-1.0, "slope −1, midpoint rule"))
        .note("Pictures", "six equal balls, the lamp at the left; each law gives the first ball the same light, and \
             all pictures have the same exposure")
        .note("Equal error", study.at_equal_error("relative error", 1e-3, 1.0, "shadow rays"))
        .note("Method", "algo:appel, eq:attenuation; a lamp with a size counts as the point in its middle, or is cut \
             into equal squares that do. The constant and 1 / (1 + d) are what programs use to avoid dark pictures")
        .note("Reference", "closed forms: 1 / d², and Lambert's formula for a square over a parallel surface");
    Finished { plate, data }
}

/// The same scene by each law.
fn row_of_balls(effort: Effort) -> Montage {
    let scene = parsed("row", ROW);
    let index = ObvhsBvh2::build(&scene);
    let appel = Appel::new(World { scene: &scene, index: &index });
    let size = effort.pick(ImageSize::new(96, 24), ImageSize::new(900, 180));
    let sampling = PixelSampling { pattern: Pattern::Owen, samples: effort.pick(1, 8), seed: 1 };
    LAWS.iter().zip(COLORS).fold(Montage::new().columns(1), |montage, ((name, law), color)| {
        let radiance = |ray: &Ray, _: &mut u64| radiance_by(&appel, ray, *law);
        let image = picture(&scene, size, sampling, radiance).image;
        montage.tile(Tile::new(*name, shown(&image)).color(color()))
    })
}
