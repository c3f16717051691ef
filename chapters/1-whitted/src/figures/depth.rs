//! 1.7: what each further bounce brings and costs, and the choice of the colour at the limit.

use std::ops::AddAssign;

use lancer_core::image::{Image, ImageSize};
use lancer_core::metric::rmse;
use lancer_core::sampling::PixelSampling;
use lancer_core::scene::Scene;
use lancer_figure::{
    Axis, Chart, Color, Contender, Effort, Finished, HeatScale, Montage, Plate, Row, Series, Study,
    Tile, category_color, method_color, number,
};
use lancer_lesson::judge::{error_tile, errors_of, mean_error};
use lancer_lesson::picture::shown;
use lancer_whitted::{AtLimit, Call, RayCounts, Recorder, Settings};

use super::trace_picture;
use crate::scenes;

/// Counts the rays, and the weight of those that were cut: what the picture may still lack.
#[derive(Clone, Copy, Debug, Default)]
struct WeightLeft {
    rays: RayCounts,
    weight: f64,
}

impl Recorder for WeightLeft {
    fn enter(&mut self, call: &Call) {
        self.rays.enter(call);
    }

    fn shadow(&mut self, ray: &lancer_core::geometry::Ray, visible: bool) {
        self.rays.shadow(ray, visible);
    }

    fn cut(&mut self, call: &Call) {
        self.weight += call.weight;
    }
}

impl AddAssign for WeightLeft {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.weight += other.weight;
    }
}

const LIMITS: [(AtLimit, &str); 3] =
    [(AtLimit::Black, "black"), (AtLimit::Ambient, "ambient"), (AtLimit::Background, "background")];
const COLORS: [fn() -> Color; 3] =
    [|| method_color("whitted"), || category_color(1), || category_color(2)];
const REFERENCE_DEPTH: u32 = 14;
const DEPTHS: [u32; 9] = [0, 1, 2, 3, 4, 5, 6, 8, 10];

pub fn make(effort: Effort) -> Finished {
    let scene = scenes::whitted();
    let size = effort.pick(ImageSize::new(48, 48), ImageSize::new(240, 240));
    let render = |settings| render(&scene, settings, size);
    let unlimited = |max_depth| Settings { max_depth, min_weight: 0.0, at_limit: AtLimit::Black };
    let reference = render(unlimited(REFERENCE_DEPTH));
    let pixels = size.pixels() as f64;
    // What two more bounces change, and the rounding to f32 of values below 1.
    let deeper = render(unlimited(REFERENCE_DEPTH + 2));
    let rounding = f64::from(f32::EPSILON) / 48.0_f64.sqrt();
    let residual = rmse(&deeper.0, &reference.0).expect("pictures of one size") + rounding;

    let contenders = LIMITS.iter().enumerate().flat_map(|(k, &(at_limit, name))| {
        DEPTHS.map(|max_depth| Contender {
            curve: name.to_owned(),
            color: COLORS[k](),
            knob: max_depth,
            run: Box::new(move || {
                let (image, counts) = render(Settings { at_limit, ..unlimited(max_depth) });
                ((image, counts.weight / pixels), counts.rays.total())
            }),
        })
    });
    let judge = |(image, weight): &(Image, f64)| {
        let (errors, mean) = (errors_of(&reference.0, image), mean_error(&reference.0, image));
        errors.into_iter().chain([("mean_abs", mean), ("weight_left", *weight)]).collect()
    };
    let study = Study::measure("rays", effort.runs(3), contenders, judge);

    // The lost light per weight left: the mean radiance behind the cut rays, about the same everywhere.
    let lost = |depth: u32| {
        let trial = study.at("black", depth);
        trial.error("mean_abs") / trial.error("weight_left")
    };
    let measured: Vec<u32> = DEPTHS.into_iter().filter(|depth| (1..=8).contains(depth)).collect();
    let ratios: Vec<f64> = measured.iter().map(|&depth| lost(depth)).collect();
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let most = ratios.iter().copied().fold(0.0, f64::max);
    let fall = |name: &str| study.at("black", 1).error(name) / study.at("black", 8).error(name);
    let (error_fall, weight_fall) = (fall("mean_abs"), fall("weight_left"));
    let holds = most / least < 2.0 && error_fall.min(weight_fall) > 1000.0;
    let claim = format!(
        "The error follows the weight that each bounce leaves: from depth 1 to 8 the weight falls {}-fold, \
         the error {}-fold, and the light lost per weight stays between {least:.2} and {most:.2}.",
        number(weight_fall),
        number(error_fall)
    );

    let mut montage = Montage::new().columns(5);
    for depth in [0, 1, 2, 3, 5] {
        let trial = study.at("black", depth);
        let (rays, error) = (trial.work as f64 / pixels, trial.error("RMSE"));
        montage = montage.tile(
            Tile::new(format!("depth {depth}"), shown(&trial.outcome.0))
                .subtitle(format!("{rays:.1} rays/pixel, RMSE {}", number(error)))
                .color(method_color("whitted")),
        );
    }
    let scale = HeatScale::log("|error|", 1e-4, 1.0);
    let mut at_depth_3 = Montage::new().color_bar(&scale);
    for (_, name) in LIMITS {
        let (trial, title) = (study.at(name, 3), format!("error at depth 3, {name}"));
        at_depth_3 = at_depth_3.tile(
            error_tile(title, &scale, &reference.0, &trial.outcome.0)
                .subtitle(format!("RMSE {}", number(trial.error("RMSE"))))
                .color(trial.color),
        );
    }
    let mut bounces = Chart::new(Axis::linear("depth limit, Max_Prof"), Axis::log("per pixel"))
        .title("Error and weight left");
    for (name, label, color) in [
        ("weight_left", "weight of the cut rays", category_color(3)),
        ("mean_abs", "mean |error|, black at the limit", method_color("whitted")),
    ] {
        let points = DEPTHS.map(|d| (f64::from(d), study.at("black", d).error(name)));
        bounces = bounces.series(Series::new(label, color).points(points));
    }
    let best = |depth: u32| {
        let error = |name: &str| study.at(name, depth).error("RMSE");
        let by_error =
            |a: &&(AtLimit, &str), b: &&(AtLimit, &str)| error(a.1).total_cmp(&error(b.1));
        LIMITS.iter().min_by(by_error).map_or("", |(_, name)| name)
    };
    let plate = Plate::new("1.7", "How deep to follow the rays", claim, holds)
        .panel(montage)
        .panel(at_depth_3)
        .panel(study.chart("RMSE").reference_error(residual))
        .panel(Row::new().panel(1.0, bounces))
        .note("« choix discutable »", format!(
            "the colour where the recursion ends: the smallest error at depth 1 has {}, at depth 3 {}, at \
             depth 5 {}",
            best(1), best(3), best(5)
        ))
        .note("Equal error", study.at_equal_error("RMSE", 1e-3, pixels, "rays per pixel"))
        .note("Method", "algo:lr, eq:recursion; the work counts all rays, shadow rays included")
        .note("Settings", format!("scene whitted, {size}, 1 sample per pixel, no minimum weight"))
        .note("Reference", format!(
            "algo:lr to depth {REFERENCE_DEPTH}; two more bounces and the rounding to 32 bits change it by an \
             RMSE of {}",
            number(residual)
        ));
    Finished { plate, data: study.table() }
}

fn render(scene: &Scene, settings: Settings, size: ImageSize) -> (Image, WeightLeft) {
    let rendering = trace_picture::<WeightLeft>(scene, settings, size, PixelSampling::CENTER);
    (rendering.image, rendering.counts)
}
