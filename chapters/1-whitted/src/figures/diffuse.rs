//! 1.10: diffuse light between surfaces, and what a constant can stand for.

use glam::Vec3;
use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::{Image, ImageSize};
use lancer_core::metric::rmse;
use lancer_core::render::Rendering;
use lancer_core::sampling::{Pattern, PixelSampling, Uniform};
use lancer_core::scene::{Pigment, Scene};
use lancer_core::world::World;
use lancer_figure::{
    Axis, Chart, Contender, Effort, Finished, HeatScale, Montage, Plate, Row, Series, Study, Tile,
    Trial, category_color, method_color, number,
};
use lancer_lesson::judge::{error_tile, errors_of, mean_error, pixelwise};
use lancer_lesson::picture::{picture, shown};
use lancer_lesson::scenes::parsed;
use lancer_whitted::{Lighting, RayCounts, Settings};

use super::whitted_picture;

/// A lamp in the middle of a hollow sphere of radius 1: the direct light is ρ_d everywhere.
const SPHERE: &str = "
    camera = { eye = [0.3, 0.2, 0.1], look_at = [-1, 0.5, 0.3], fov = 90 }
    material.plaster = { rho_d = 0.5 }
    light = [{ position = [0, 0, 0], intensity = 1 }]
    sphere = [{ center = [0, 0, 0], radius = 1, material = 'plaster' }]";

/// A plastered room, its side walls painted, with two blocks; open to no side.
const ROOM: &str = "
    camera = { eye = [0, 1, 3.9], look_at = [0, 0.95, 0], fov = 40 }
    material.plaster = { rho_d = 0.7 }
    material.red = { rho_d = [0.65, 0.12, 0.08] }
    material.green = { rho_d = [0.15, 0.5, 0.12] }
    light = [{ position = [0, 1.2, 0.8], intensity = 0.6 }]
    sphere = [
        { center = [-0.42, 0.4, -0.35], radius = 0.4, material = 'plaster' },
        { center = [0.45, 0.3, 0.35], radius = 0.3, material = 'plaster' },
    ]
    polygon = [
        { vertices = [[-1, 0, 4], [1, 0, 4], [1, 0, -1], [-1, 0, -1]], material = 'plaster' },
        { vertices = [[-1, 2, -1], [1, 2, -1], [1, 2, 4], [-1, 2, 4]], material = 'plaster' },
        { vertices = [[-1, 0, -1], [1, 0, -1], [1, 2, -1], [-1, 2, -1]], material = 'plaster' },
        { vertices = [[1, 0, 4], [-1, 0, 4], [-1, 2, 4], [1, 2, 4]], material = 'plaster' },
        { vertices = [[-1, 0, 4], [-1, 0, -1], [-1, 2, -1], [-1, 2, 4]], material = 'red' },
        { vertices = [[1, 0, -1], [1, 0, 4], [1, 2, 4], [1, 2, -1]], material = 'green' },
    ]";

/// The radiance along a ray with the light that comes by way of other matte surfaces, by one random
/// path: at each surface the lamps, and on in a direction that is the likelier the more it counts, by the
/// cosine. A path goes on with the probability of its surface's reflectance, so that none is cut short.
/// All its rays but those to lamps are counted as primary.
fn path_radiance(
    lighting: &Lighting,
    mut ray: Ray,
    random: &mut Uniform,
    rays: &mut RayCounts,
) -> Rgb {
    let World { scene, index } = lighting.world;
    let (mut radiance, mut weight) = (Rgb::ZERO, Rgb::ONE);
    loop {
        rays.primary += 1;
        let Some(hit) = index.closest_hit(&ray, Interval::POSITIVE) else {
            return radiance + weight * scene.background;
        };
        let surface = scene.surface_at(&ray, &hit);
        let n = surface.shading_normal_towards(-ray.direction);
        radiance += weight * lighting.surface(&surface, -ray.direction, rays);
        let rho_d = scene.reflectance(&surface).diffuse;
        let survival = rho_d.max_element();
        if random.number() >= survival {
            return radiance;
        }
        weight *= rho_d / survival;
        // A unit vector added to the normal is distributed by the cosine.
        ray = surface.spawn((n + random.direction()).normalize());
    }
}

/// A way to account for the light between matte surfaces.
#[derive(Clone, Copy)]
enum Method {
    /// Not at all, or by eq:ambient with this I_a.
    Whitted { ambient: Rgb },
    /// By this many random paths per pixel.
    Paths { samples: u32, seed: u64 },
}

impl Method {
    fn picture(self, scene: &Scene, size: ImageSize) -> (Image, u64) {
        match self {
            Self::Whitted { ambient } => {
                let scene = Scene { ambient, ..scene.clone() };
                let rendering: Rendering<RayCounts> =
                    whitted_picture(&scene, Settings::default(), size);
                (rendering.image, rendering.counts.total())
            }
            Self::Paths { samples, seed } => {
                let index = ObvhsBvh2::build(scene);
                let lighting = Lighting::new(World { scene, index: &index });
                let sampling = PixelSampling { pattern: Pattern::Jittered, samples, seed };
                let radiance = |ray: &Ray, rays: &mut RayCounts| {
                    let mut random = Uniform::of_ray(seed, ray);
                    path_radiance(&lighting, *ray, &mut random, rays)
                };
                let rendering = picture(scene, size, sampling, radiance);
                (rendering.image, rendering.counts.total())
            }
        }
    }
}

/// The reflectances of the sphere.
const RHO: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
const IN_SPHERE: [&str; 5] = ["sphere 0.1", "sphere 0.3", "sphere 0.5", "sphere 0.7", "sphere 0.9"];
/// The side of its picture in pixels.
const SPHERE_SIDE: u32 = 16;

/// The mean radiance of the sphere's inside, over the direct light.
fn in_sphere(method: Method, rho: f64) -> f64 {
    let mut scene = parsed("sphere", SPHERE);
    scene.materials[0].rho_d = Pigment::Solid(Rgb::splat(rho));
    let (image, _) = method.picture(&scene, ImageSize::new(SPHERE_SIDE, SPHERE_SIDE));
    let radiances = image.pixels().iter().map(|pixel| f64::from(pixel[0]));
    radiances.sum::<f64>() / image.pixels().len() as f64 / rho
}

const NOTHING: &str = "Whitted without I_a";
const CONSTANT: &str = "Whitted with the best I_a";
const PATHS: &str = "random paths";
const PATHS_PER_PIXEL: [u32; 5] = [1, 4, 16, 64, 256];

/// A method's picture of the room, with the method as it is in the spheres.
type InRoom = Trial<u32, (Image, [Method; 5])>;

pub fn make(effort: Effort) -> Finished {
    let room = parsed("plaster", ROOM);
    let size = effort.pick(ImageSize::new(40, 40), ImageSize::new(128, 128));
    let half = |seed| {
        let samples = effort.pick(128, 512);
        Method::Paths { samples, seed }.picture(&room, size).0
    };
    let (first, second) = (half(1), half(2));
    let reference = pixelwise(&first, &second, |a, b| 0.5 * (a + b));
    let residual = 0.5 * rmse(&first, &second).expect("pictures of one size");
    let direct = Method::Whitted { ambient: Rgb::ZERO }.picture(&room, size).0;
    let indirect = pixelwise(&reference, &direct, |a, b| a - b);
    let best = best_ambient(&room, &indirect);

    // Each method in the room, and in a sphere of reflectance ρ, where the best constant is known.
    let nothing = |_| Method::Whitted { ambient: Rgb::ZERO };
    let constant = |rho: f64| Method::Whitted { ambient: Rgb::splat(rho / (1.0 - rho)) };
    let paths = PATHS_PER_PIXEL.map(|samples| {
        let method = Method::Paths { samples, seed: 3 };
        (PATHS, samples, method, RHO.map(|_| method))
    });
    let ambient = |ambient: Rgb| Method::Whitted { ambient };
    let methods = [
        (NOTHING, 1, ambient(Rgb::ZERO), RHO.map(nothing)),
        (CONSTANT, 1, ambient(best), RHO.map(constant)),
    ];
    let colors = [category_color(4), method_color("whitted"), method_color("path")];
    let color = |label: &str| {
        let known = [NOTHING, CONSTANT, PATHS].iter().position(|known| *known == label);
        colors[known.unwrap_or_default()]
    };
    let contenders =
        methods.into_iter().chain(paths).map(|(label, knob, in_room, in_spheres)| Contender {
            curve: label.to_owned(),
            color: color(label),
            knob,
            run: {
                let room = &room;
                Box::new(move || {
                    let (image, rays) = in_room.picture(room, size);
                    ((image, in_spheres), rays)
                })
            },
        });
    let judge = |(image, in_spheres): &(Image, [Method; 5])| {
        let errors = errors_of(&reference, image);
        let spheres = IN_SPHERE.into_iter().zip(in_spheres.iter().zip(RHO));
        let spheres = spheres.map(|(name, (method, rho))| (name, in_sphere(*method, rho)));
        errors.into_iter().chain(spheres).collect()
    };
    let study = Study::measure("rays", effort.runs(3), contenders, judge);
    let (nothing, constant) = (study.at(NOTHING, 1), study.at(CONSTANT, 1));
    let (some_paths, most_paths) = (study.at(PATHS, 16), study.at(PATHS, 256));

    let off = |trial: &InRoom, k: usize| (trial.error(IN_SPHERE[k]) * (1.0 - RHO[k]) - 1.0).abs();
    // The number of surfaces on a path is geometric, with the relative deviation √ρ; 5.2 deviations for
    // five spheres are a false alarm in a million.
    let count = f64::from(PATHS_PER_PIXEL[4] * SPHERE_SIDE * SPHERE_SIDE);
    let constant_is_exact = (0..RHO.len()).all(|k| off(constant, k) < f64::from(f32::EPSILON));
    let paths_agree = (0..RHO.len()).all(|k| off(most_paths, k) < 5.2 * (RHO[k] / count).sqrt());
    let black = Image::new(size);
    let mean = |image: &Image| mean_error(&black, image);
    let left = mean(&pixelwise(&constant.outcome.0, &reference, |a, b| a - b)) / mean(&indirect);
    let share = mean(&indirect) / mean(&reference);
    // What the constant leaves is no noise of the reference.
    let is_seen = constant.error("RMSE") > 2.0 * residual;
    let holds = constant_is_exact && paths_agree && is_seen;
    let claim = format!(
        "In a matte sphere a constant stands for the light between surfaces exactly, I_a = direct / (1 − ρ); \
         in a plastered room, where {:.0} % of the light is of that kind, the best constant is off by {:.0} % of it.",
        100.0 * share,
        100.0 * left
    );

    let tile = |title: &str, trial: &InRoom| {
        Tile::new(title, shown(&trial.outcome.0))
            .subtitle(format!("RMSE {}", number(trial.error("RMSE"))))
            .color(trial.color)
    };
    let pictures = Montage::new()
        .tile(tile("I_a = 0", nothing))
        .tile(tile("best I_a", constant))
        .tile(tile("16 paths per pixel", some_paths))
        .tile(Tile::new("reference", shown(&reference)).color(method_color("reference")));
    let scale = HeatScale::linear("|error|", 0.0, 0.2);
    let errors =
        |title: &str, trial: &InRoom| error_tile(title, &scale, &reference, &trial.outcome.0);
    let maps = Montage::new()
        .tile(errors("error: I_a = 0", nothing))
        .tile(errors("error: best I_a", constant))
        .tile(errors("error: 16 paths", some_paths))
        .color_bar(&scale);
    let mut spheres = Chart::new(
        Axis::linear("reflectance ρ of the sphere").between(0.0, 1.0),
        Axis::log("radiance / direct light"),
    )
    .title("Inside a sphere")
    .series(
        Series::new("direct / (1 − ρ)", method_color("reference"))
            .curve()
            .points((0..=95).map(|k| f64::from(k) / 100.0).map(|rho| (rho, 1.0 / (1.0 - rho)))),
    );
    for trial in [nothing, constant, most_paths] {
        let points = (0..RHO.len()).map(|k| (RHO[k], trial.error(IN_SPHERE[k])));
        let series = Series::new(&trial.curve, trial.color).scatter();
        spheres = spheres.series(series.points(points));
    }
    let plate = Plate::new("1.10", "What a constant ambient term can stand for", claim, holds)
        .panel(pictures)
        .panel(maps)
        .panel(Row::new().panel(1.0, spheres))
        .panel(study.chart("RMSE").slope(-0.5, "slope −1/2, random").reference_error(residual))
        .note("« Éclairage diffus mal représenté »", "only the directions of the lamps, R and T are looked along; \
             a wall's colour on its neighbours, and the light in corners, come from all the others")
        .note("Equal error", study.at_equal_error("RMSE", constant.error("RMSE"), size.pixels() as f64, "rays per pixel"))
        .note("Method", format!(
            "eq:ambient with the I_a of least squares, {} in red, green and blue; random paths ask for the lamps at \
             each surface and go on with the probability ρ_d", best.to_array().map(|c| format!("{c:.3}")).join(", ")
        ))
        .note("Convention", "I is the radiance of a white surface that faces the lamp at distance 1, so that ρ_d is the \
             share of the light that a surface sends back")
        .note("Reference", format!(
            "sphere: closed form, a lamp in the centre; room: {} paths per pixel, whose own RMSE, from two halves, is {}",
            effort.pick(256, 1024),
            number(residual)
        ));
    Finished { plate, data: study.table() }
}

/// The I_a of least squares per channel: where the indirect light is ρ_d I_a but for an error, the
/// best is Σ ρ_d · indirect / Σ ρ_d².
fn best_ambient(scene: &Scene, indirect: &Image) -> Rgb {
    let dark = Scene { lights: Vec::new(), ..scene.clone() };
    let (rho_d, _) = Method::Whitted { ambient: Rgb::ONE }.picture(&dark, indirect.size());
    let (mut products, mut squares) = (Rgb::ZERO, Rgb::ZERO);
    for (rho_d, indirect) in rho_d.pixels().iter().zip(indirect.pixels()) {
        let [rho_d, indirect] = [rho_d, indirect].map(|&pixel| Vec3::from(pixel).as_dvec3());
        products += rho_d * indirect;
        squares += rho_d * rho_d;
    }
    products / squares
}
