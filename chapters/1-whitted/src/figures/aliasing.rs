//! 1.11: detail beyond the pixel grid comes back as false patterns; random sampling turns them into noise.

use std::f64::consts::PI;

use glam::DVec2;
use lancer_core::Rgb;
use lancer_core::image::{Image, ImageSize};
use lancer_core::render::{Control, render_pixels};
use lancer_core::sampling::{Pattern, PixelSampling, Sample};
use lancer_core::scene::Scene;
use lancer_figure::{
    Contender, Effort, Finished, Inset, Montage, Plate, Study, Tile, category_color,
};
use lancer_lesson::judge::errors_of;
use lancer_lesson::picture::shown;
use lancer_whitted::{RayCounts, Settings};

use super::trace_picture;
use crate::scenes;

const PATTERNS: [(Pattern, &str); 3] =
    [(Pattern::Regular, "regular"), (Pattern::Jittered, "jittered"), (Pattern::Owen, "Owen")];
const SAMPLES: [u32; 4] = [1, 4, 16, 64];

/// Rings that get finer outwards: ½ + ½ cos(k r²). At three quarters of the side there is one
/// ring to a pixel, which the pixels' centres take for none.
struct ZonePlate {
    size: ImageSize,
    k: f64,
}

impl ZonePlate {
    fn new(side: u32) -> Self {
        // The phase k r² turns by 2 k r per pixel: by 2π at r = ¾ side.
        Self { size: ImageSize::new(side, side), k: 4.0 / 3.0 * PI / f64::from(side) }
    }

    /// From the corner of the picture: only one quarter of the rings is shown.
    fn value(&self, film: DVec2) -> f64 {
        0.5 + 0.5 * (self.k * film.length_squared()).cos()
    }

    fn sampled(&self, sampling: PixelSampling) -> (Image, u64) {
        let radiance = |sample: &Sample, samples: &mut u64| {
            *samples += 1;
            Rgb::splat(self.value(sample.film))
        };
        let rendering = render_pixels(self.size, sampling, Control::default(), radiance);
        let rendering = rendering.expect("nobody cancels a figure");
        (rendering.image, rendering.counts)
    }

    /// Each pixel's exact mean: cos(k x² + k y²) is a sum of products of functions of x and of y, whose
    /// means over a pixel are one-dimensional.
    fn exact(&self) -> Image {
        let means: Vec<(f64, f64)> = (0..self.size.width)
            .map(|x| {
                let x = f64::from(x);
                (
                    mean_over_unit(|t| (self.k * (x + t).powi(2)).cos()),
                    mean_over_unit(|t| (self.k * (x + t).powi(2)).sin()),
                )
            })
            .collect();
        let pixel = |x: usize, y: usize| {
            let ((cos_x, sin_x), (cos_y, sin_y)) = (means[x], means[y]);
            [(0.5 + 0.5 * (cos_x * cos_y - sin_x * sin_y)) as f32; 3]
        };
        let side = self.size.width as usize;
        let pixels = (0..side * side).map(|i| pixel(i % side, i / side)).collect();
        Image::from_pixels(self.size, pixels)
    }
}

/// The mean of a function over [0, 1] by the 8-point Gauss-Legendre rule on 8 parts.
fn mean_over_unit(f: impl Fn(f64) -> f64) -> f64 {
    const NODES: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    ];
    let part = |k: i32| {
        let middle = (f64::from(k) + 0.5) / 8.0;
        let pair =
            |&(x, weight): &(f64, f64)| weight * (f(middle - x / 16.0) + f(middle + x / 16.0));
        NODES.iter().map(pair).sum::<f64>() / 16.0
    };
    (0..8).map(part).sum()
}

/// How much of a picture's error around the false centre at three quarters of the side is the ring
/// pattern that sampling the pixels' centres makes of the zone plate: the correlation with it, from 0
/// to 1. There the phase turns by a whole number of rings per pixel, and what is left of it between
/// pixel centres is a zone plate of its own.
fn false_rings(zone_plate: &ZonePlate, reference: &Image, image: &Image) -> f64 {
    let side = zone_plate.size.width;
    let (center, reach) = (3 * side / 4, side / 6);
    let (mut with_cos, mut with_sin, mut error_squared, mut count) = (0.0, 0.0, 0.0, 0.0);
    for y in center - reach..center + reach {
        for x in center - reach..center + reach {
            let from_center = DVec2::new(f64::from(x), f64::from(y)) + 0.5 - f64::from(center);
            let (sin, cos) = (zone_plate.k * from_center.length_squared()).sin_cos();
            let error = image.get(x, y).x - reference.get(x, y).x;
            with_cos += error * cos;
            with_sin += error * sin;
            error_squared += error * error;
            count += 1.0;
        }
    }
    // The rings' own mean square is a half, whatever their phase.
    let rings = (with_cos * with_cos + with_sin * with_sin) / (0.5 * count);
    (rings / error_squared).sqrt()
}

pub fn make(effort: Effort) -> Finished {
    let zone_plate = ZonePlate::new(effort.pick(96, 320));
    let reference = zone_plate.exact();
    let contenders = PATTERNS.iter().enumerate().flat_map(|(k, &(pattern, name))| {
        let zone_plate = &zone_plate;
        SAMPLES.map(|samples| Contender {
            curve: name.to_owned(),
            color: [category_color(3), category_color(0), category_color(2)][k],
            knob: samples,
            run: Box::new(move || zone_plate.sampled(PixelSampling { pattern, samples, seed: 11 })),
        })
    });
    let study = Study::measure("samples", effort.runs(3), contenders, |image: &Image| {
        let errors = errors_of(&reference, image);
        let rings = false_rings(&zone_plate, &reference, image);
        errors.into_iter().chain([("false rings", rings)]).collect()
    });

    let rings = |name: &str| study.at(name, 1).error("false rings");
    let (regular, jittered) = (rings("regular"), rings("jittered"));
    let holds = regular > 0.9 && jittered.max(rings("Owen")) < 0.2;
    let claim = format!(
        "With a sample per pixel the error of a regular grid is rings that are not there (correlation {regular:.2} \
         around the false centre at the lower right); jittered, it is noise ({jittered:.2})."
    );

    let picture = |name: &str, samples: u32| {
        let trial = study.at(name, samples);
        Tile::new(format!("{name}, {samples} per pixel"), shown(&trial.outcome))
            .subtitle(format!("RMSE {:.3}", trial.error("RMSE")))
            .color(trial.color)
    };
    let pixels = zone_plate.size.pixels() as f64;
    let floor = Floor::new(effort);
    let plate = Plate::new("1.11", "Aliasing, and what jitter does to it", claim, holds)
        .panel(
            Montage::new()
                .tile(Tile::new("exact", shown(&reference)).subtitle("rings ever finer to the lower right"))
                .tile(picture("regular", 1))
                .tile(picture("jittered", 1))
                .tile(picture("jittered", 16)),
        )
        .panel(study.chart("RMSE").slope(-0.5, "slope −1/2, random"))
        .panel(
            Montage::new()
                .tile(floor.tile("regular, 1 per pixel", Pattern::Regular, 1))
                .tile(floor.tile("jittered, 16 per pixel", Pattern::Jittered, 16))
                .inset(floor.inset)
                .insets_right()
                .columns(2),
        )

        .note("Equal error", study.at_equal_error("RMSE", 0.02, pixels, "samples per pixel"))
        .note(
            "Zone plate",
            "½ + ½ cos(k r²), r from the upper left corner; at three quarters of the side there is one \
             ring to a pixel",
        )
        .note("Floor", "the slides' « aliassage » on a checkered floor to the horizon, by algo:lr")
        .note("Settings", format!(
            "zone plate {}, floor {}, box filter, seed 11; « Owen » is the scrambled Sobol sequence that \
             cargo xtask render --spp uses",
            zone_plate.size, floor.size
        ))
        .note("Reference", "exact: the mean of each pixel by products of one-dimensional integrals, to 1e-7 \
             (stored in 32 bits)");
    Finished { plate, data: study.table() }
}

/// A checkered floor to the horizon.
struct Floor {
    scene: Scene,
    size: ImageSize,
    inset: Inset,
}

impl Floor {
    fn new(effort: Effort) -> Self {
        let size = effort.pick(ImageSize::new(96, 48), ImageSize::new(320, 160));
        let inset = effort.pick(Inset::new(36, 14, 24, 12), Inset::new(120, 44, 72, 36));
        Self { scene: scenes::horizon(), size, inset }
    }

    fn tile(&self, title: &str, pattern: Pattern, samples: u32) -> Tile {
        let sampling = PixelSampling { pattern, samples, seed: 11 };
        let settings = Settings::default();
        let rendering = trace_picture::<RayCounts>(&self.scene, settings, self.size, sampling);
        Tile::new(title, shown(&rendering.image))
    }
}
