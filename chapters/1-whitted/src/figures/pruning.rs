//! 1.8: three ways to end the recursion, and what each ray they save costs in error.

use glam::DVec3;
use lancer_core::geometry::Sphere;
use lancer_core::image::{Image, ImageSize};
use lancer_core::metric::rmse;
use lancer_core::render::Rendering;
use lancer_core::scene::{Scene, SphereObject};
use lancer_figure::{
    Axis, Chart, Color, Contender, Effort, Finished, HeatScale, Montage, Plate, Row, Series, Study,
    Table, Tile, Trial, Value, category_color, decimals, method_color, number,
};
use lancer_lesson::judge::{error_tile, errors_of, mean};
use lancer_lesson::picture::shown;
use lancer_whitted::{AtLimit, Settings};

use super::whitted_picture;
use crate::scenes;

/// Max_Prof of the rules that go by weight: so deep that no ray of these scenes comes there.
const ENDLESS: u32 = 1000;
/// Below this a ray changes no picture that is looked at here.
const NEGLIGIBLE: f64 = 1e-6;

fn depth(max_depth: f64) -> Settings {
    Settings { max_depth: max_depth as u32, min_weight: 0.0, at_limit: AtLimit::Black }
}

fn weight(min_weight: f64) -> Settings {
    Settings { max_depth: ENDLESS, min_weight, at_limit: AtLimit::Black }
}

fn roulette(min_weight: f64, seed: u64) -> Settings {
    Settings { at_limit: AtLimit::Roulette { seed }, ..weight(min_weight) }
}

/// A way to end the recursion, given its limit, and the limits tried.
struct Rule {
    name: &'static str,
    settings: fn(f64) -> Settings,
    limits: &'static [f64],
    color: fn() -> Color,
}

const RULES: [Rule; 3] = [
    Rule {
        name: "depth",
        settings: depth,
        limits: &[0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0],
        color: || category_color(0),
    },
    Rule { name: "weight", settings: weight, limits: WEIGHTS, color: || category_color(2) },
    Rule {
        name: "roulette",
        settings: |limit| roulette(limit, 0),
        limits: WEIGHTS,
        color: || category_color(3),
    },
];
const WEIGHTS: &[f64] = &[0.8, 0.4, 0.1, 0.05, 0.01, 0.005, 0.001];

/// Pictures by roulette that are averaged, and the |z| that their mean exceeds once in a million if it
/// is right: Student's t with 31 degrees of freedom.
const SEEDS: u64 = 32;
const Z: f64 = 6.08;

/// Whitted's scene with a stack of glass balls in place of its three.
fn glass_balls() -> Scene {
    let mut scene = scenes::whitted();
    let material = scene.spheres[0].material;
    let balls = (0..27).map(|k| {
        let [x, y, z] = [k % 3, k / 3 % 3, k / 9].map(f64::from);
        let center = DVec3::new(1.1 * (x - 1.0), 0.5 + 1.02 * y, 1.2 - 1.3 * z);
        SphereObject { shape: Sphere { center, radius: 0.5 }, material }
    });
    scene.spheres = balls.collect();
    scene
}

/// What is measured in one scene.
struct InScene {
    name: &'static str,
    scene: Scene,
    size: ImageSize,
    reference: Image,
    reference_rays: u64,
    /// The reference with a ten times larger minimum weight.
    rougher: Image,
    study: Study<f64, Image>,
    /// The error at which the rules are compared.
    level: f64,
    /// A limit of each rule, with about as many rays.
    alike: [f64; 3],
}

impl InScene {
    fn new(effort: Effort, name: &'static str, scene: Scene, level: f64, alike: [f64; 3]) -> Self {
        let size = effort.pick(ImageSize::new(32, 32), ImageSize::new(120, 120));
        let render = |settings| whitted_picture(&scene, settings, size);
        let Rendering { image: reference, counts } = render(weight(NEGLIGIBLE));
        let rougher = render(weight(10.0 * NEGLIGIBLE)).image;
        let contenders = RULES.iter().flat_map(|rule| {
            rule.limits.iter().map(move |&limit| Contender {
                curve: rule.name.to_owned(),
                color: (rule.color)(),
                knob: limit,
                run: Box::new(move || {
                    let rendering = render((rule.settings)(limit));
                    (rendering.image, rendering.counts.total())
                }),
            })
        });
        let judge = |image: &Image| errors_of(&reference, image).to_vec();
        let study = Study::measure("rays", effort.runs(3), contenders, judge);
        let reference_rays = counts.total();
        Self { name, size, reference, reference_rays, rougher, study, level, alike, scene }
    }

    /// Rays per pixel at which a rule comes down to the scene's error; infinite if it never does.
    fn rays(&self, rule: &str) -> f64 {
        let rays = self.study.work_at_error(rule, "RMSE", self.level);
        rays.unwrap_or(f64::INFINITY) / self.size.pixels() as f64
    }

    /// The picture by a rule at its limit of `alike`.
    fn alike(&self, rule: usize) -> &Trial<f64, Image> {
        self.study.at(RULES[rule].name, self.alike[rule])
    }

    /// What part of the reference's light a picture has too much.
    fn bias(&self, image: &Image) -> f64 {
        mean(image) / mean(&self.reference) - 1.0
    }
}

/// The mean of many pictures by roulette.
struct Average {
    /// RMSE of the mean of the first 1, 2, 4, … pictures.
    errors: Vec<(f64, f64)>,
    /// What part of the reference's light they have too much on average, and its standard error.
    bias: f64,
    standard_error: f64,
}

impl Average {
    fn new(trial: &InScene) -> Self {
        let mut sum = vec![[0.0_f64; 3]; trial.size.pixels()];
        let (mut errors, mut biases) = (Vec::new(), Vec::new());
        for seed in 0..SEEDS {
            let image =
                whitted_picture(&trial.scene, roulette(trial.alike[2], seed), trial.size).image;
            biases.push(trial.bias(&image));
            for (sum, pixel) in sum.iter_mut().zip(image.pixels()) {
                *sum = std::array::from_fn(|c| sum[c] + f64::from(pixel[c]));
            }
            let count = (seed + 1) as f64;
            if (seed + 1).is_power_of_two() {
                let pixels = sum.iter().map(|sum| sum.map(|c| (c / count) as f32)).collect();
                let mean = Image::from_pixels(trial.size, pixels);
                let error = rmse(&trial.reference, &mean).expect("pictures of one size");
                errors.push((count, error));
            }
        }
        let count = SEEDS as f64;
        let bias = biases.iter().sum::<f64>() / count;
        let variance = biases.iter().map(|b| (b - bias).powi(2)).sum::<f64>() / (count - 1.0);
        Self { errors, bias, standard_error: (variance / count).sqrt() }
    }

    fn z(&self) -> f64 {
        self.bias / self.standard_error
    }
}

pub fn make(effort: Effort) -> Finished {
    let trials = [
        InScene::new(effort, "whitted", scenes::whitted(), 0.01, [2.0, 0.1, 0.1]),
        InScene::new(effort, "27 glass balls", glass_balls(), 0.03, [4.0, 0.05, 0.1]),
    ];
    let averages = trials.each_ref().map(Average::new);
    let [whitted, glass] = &trials;
    let biases = |trial: &InScene| [0, 1].map(|rule| trial.bias(&trial.alike(rule).outcome));
    let holds = trials.iter().zip(&averages).all(|(trial, average)| {
        let cheaper = trial.rays("weight") < trial.rays("depth");
        let darker = biases(trial).iter().all(|bias| *bias < -Z * average.standard_error);
        cheaper && darker && average.z().abs() < Z
    });
    let [by_depth, by_weight] = biases(glass).map(|bias| number(-100.0 * bias));
    let claim = format!(
        "Among glass balls a stop by weight needs {:.1} rays per pixel for an RMSE of {}, a stop by depth {:.1}; at \
         equal rays they lose {by_weight} and {by_depth} % of the light, roulette on average none.",
        glass.rays("weight"),
        glass.level,
        glass.rays("depth"),
    );

    let size = glass.size;
    let pixels = size.pixels() as f64;
    let [glass_average, whitted_average] = [&averages[1], &averages[0]];
    let [pictures, maps] = montages(glass);
    let mut plate =
        Plate::new("1.8", "When to stop following a ray", claim, holds).panel(pictures).panel(maps);
    for trial in [glass, whitted] {
        plate = plate.panel(trial.study.chart("RMSE").subject(trial.name));
    }
    plate = plate.panel(Row::new().panel(1.0, averaged(glass, glass_average)));
    for trial in [glass, whitted] {
        let at = trial.study.at_equal_error("RMSE", trial.level, pixels, "rays per pixel");
        plate = plate.note(format!("Equal error, {}", trial.name), at);
    }
    let residual = |trial: &InScene| {
        let error = rmse(&trial.reference, &trial.rougher).expect("pictures of one size");
        let light = trial.bias(&trial.rougher).abs();
        format!("an RMSE of {} and {} % of its light", number(error), number(100.0 * light))
    };
    let plate = plate
        .note("Method", "algo:lr. Depth: black beyond Max_Prof. Weight: black where the product of k_s and k_t from \
             the eye is below the limit m. Roulette: such a ray of weight w is traced with probability w / m \
             and its answer divided by it. Work counts all rays, shadow rays included")
        .note("Roulette's mean", format!(
            "{SEEDS} pictures at {}; |z| above {Z} would be a false alarm once in a million (Student's t of \
             the pictures' light); here z is {} and, in Whitted's scene, {}. Standard errors of the light: {} and \
             {} %",
            glass.alike[2],
            decimals(glass_average.z(), 1),
            decimals(whitted_average.z(), 1),
            number(100.0 * glass_average.standard_error),
            number(100.0 * whitted_average.standard_error)
        ))
        .note("Limits", "the weight wins where k_s and k_t differ: between mirrors of one k_s both rules stop the \
             same rays. One picture by roulette is noisier than the weight's at equal rays, until little is \
             left to cut")
        .note("Settings", format!("glass and floor of scene whitted, {size}, 1 sample per pixel"))
        .note("Reference", format!(
            "algo:lr to a weight of {}; ten times that changes it by {} (glass balls) and {}",
            number(NEGLIGIBLE), residual(glass), residual(whitted)
        ));
    Finished { plate, data: table(&trials, &averages) }
}

/// The pictures with about as many rays, and their errors.
fn montages(trial: &InScene) -> [Montage; 2] {
    let per_pixel = |rays: u64| rays as f64 / trial.size.pixels() as f64;
    let whole = Tile::new("the whole tree", shown(&trial.reference))
        .subtitle(format!("{:.0} rays/pixel", per_pixel(trial.reference_rays)))
        .color(method_color("reference"));
    let scale = HeatScale::log("|error|", 1e-3, 1.0);
    let (mut pictures, mut maps) = (Montage::new().tile(whole), Montage::new().color_bar(&scale));
    for (k, rule) in RULES.iter().enumerate() {
        let Trial { outcome: image, knob, work, .. } = trial.alike(k);
        let (rays, error) = (per_pixel(*work), trial.alike(k).error("RMSE"));
        pictures = pictures.tile(
            Tile::new(format!("{} {knob}", rule.name), shown(image))
                .subtitle(format!("{rays:.1} rays/pixel, RMSE {error:.3}"))
                .color((rule.color)()),
        );
        let title = format!("error of {} {knob}", rule.name);
        let light = decimals(100.0 * trial.bias(image), 2);
        maps = maps.tile(
            error_tile(title, &scale, &trial.reference, image)
                .subtitle(format!("light {light} %"))
                .color((rule.color)()),
        );
    }
    [pictures, maps]
}

/// The error of a mean of pictures: only roulette's falls.
fn averaged(trial: &InScene, average: &Average) -> Chart {
    let mut chart = Chart::new(Axis::log("pictures averaged"), Axis::log("RMSE of their mean"))
        .title(format!("{}: the mean of several pictures", trial.name))
        .height(440.0)
        .slope(-0.5, "slope −1/2");
    for (k, rule) in RULES.iter().enumerate() {
        let series = Series::new(format!("{} {}", rule.name, trial.alike[k]), (rule.color)());
        let same = trial.alike(k).error("RMSE");
        let errors = average.errors.iter().copied();
        chart = chart.series(match rule.name {
            "roulette" => series.points(errors),
            _ => series.points(errors.map(|(count, _)| (count, same))).curve(),
        });
    }
    chart
}

/// The measurements of both scenes, with the part of light that each picture has too much and the z of
/// roulette's mean.
fn table(trials: &[InScene], averages: &[Average]) -> Table {
    let columns = trials[0].study.table().columns().to_vec();
    let columns = columns.iter().map(String::as_str);
    let mut table = Table::new(["scene"].into_iter().chain(columns).chain(["bias", "z"]));
    for (trial, average) in trials.iter().zip(averages) {
        for (row, at) in trial.study.table().rows().iter().zip(trial.study.trials()) {
            // The z is of roulette's mean.
            let z = if at.curve == "roulette" { average.z() } else { f64::NAN };
            let ours: [Value; 2] = [trial.bias(&at.outcome).into(), z.into()];
            table.push([trial.name.into()].into_iter().chain(row.iter().cloned()).chain(ours));
        }
    }
    table
}
