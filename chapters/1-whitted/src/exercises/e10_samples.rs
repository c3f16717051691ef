//! E1.10: samples and their error.

use std::cell::Cell;

use glam::DVec2;
use lancer_core::Rgb;
use lancer_core::image::{Image, ImageSize};
use lancer_exercise::{Card, Check, Exercise, Shown, Solution, Verdict, same, slips, within};

use super::reference::{pixel_mean, rms_error};
use super::{FilmFunction, Stage, Subject, painted};
use crate::scenes;

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E1.10",
        name: "samples",
        title: "Samples and their error",
        slide: "Critiques du lancer de rayons : aliassage et disparition de petits objets",
        stub: include_str!("../../stubs/e10_samples.rs"),
        functions: &["pixel_mean", "rms_error"],
        minutes: 20,
        predict: "a checkered floor with 1, 4 and 16 samples per pixel, and below each its error as a bar: how \
                  long are the second and the third beside the first?",
        vary: "move every sample by the same tenth of a pixel: where do the patterns near the horizon go, and \
               what do the bars say?",
        hints: [
            "A pixel of n × n cells: the sample of a cell stands in its middle, half a cell from its corner.",
            "Cell (i, j) has the film point (x + (i + ½) / n, y + (j + ½) / n); the mean divides the sum by n². \
             RMSE = √( Σ (a − b)² / number of channels ).",
            "Two loops over `0..n` that add `radiance(f64::from(x) + (f64::from(i) + 0.5) / f64::from(n), …)`. For \
             the error, `(*a - *b).length_squared()` is the sum over a pixel's three channels.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e10_samples.rs"),
            file: "crates/core/src/sampling/pixel.rs",
            item: "pub fn some_of_pixel",
            notice: "the same grid beside two random layouts; `rmse` is in crates/core/src/metric/mod.rs",
        },
    },
    checks: &[
        Check { name: "one sample is the centre", run: centre },
        Check { name: "n × n samples", run: number_of_samples },
        Check { name: "a linear radiance is averaged exactly", run: linear },
        Check { name: "x² is short of its mean by 1 / (12 n²)", run: square },
        Check { name: "the error of one pixel, by hand", run: one_pixel },
        Check { name: "the error over pixels and channels, by hand", run: pixels },
    ],
    slips: slips! {
        pixel_mean(film, x, y, n):
        "the samples lie in the corners of their cells, not in the centres: ½ is missing":
            "one sample is the centre" catches {
                let half = 0.5 / f64::from(n);
                pixel_mean(&|a, b| film(a - half, b - half), x, y, n)
            };
        "the sum is not divided: more samples make the pixel brighter":
            "a linear radiance is averaged exactly" catches
                f64::from(n * n) * pixel_mean(film, x, y, n);
        "the sum is divided by n: there are n × n samples":
            "a linear radiance is averaged exactly" catches
                f64::from(n) * pixel_mean(film, x, y, n);
        "all samples are in one place: i / n of whole numbers is 0 for every i, so convert both by `f64::from` before \
         dividing":
            "a linear radiance is averaged exactly" catches {
                let first = 0.5 / f64::from(n);
                pixel_mean(&|_, _| film(f64::from(x) + first, f64::from(y) + first), x, y, n)
            };
        "only the cells of the diagonal have a sample: one loop is not enough":
            "n × n samples" catches diagonal(film, x, y, n);

        rms_error(a, b):
        "the mean of the absolute errors is taken, not the root of the mean square":
            "the error of one pixel, by hand" catches {
                let errors = a.iter().zip(b).map(|(a, b)| (*a - *b).abs().element_sum());
                errors.sum::<f64>() / channels(a)
            };
        "the square root is missing: this is the mean square error":
            "the error of one pixel, by hand" catches rms_error(a, b).powi(2);
        "the squares are divided by the number of pixels: a pixel has three channels":
            "the error of one pixel, by hand" catches 3.0_f64.sqrt() * rms_error(a, b);
        "the squares are added up, but never divided by their number":
            "the error of one pixel, by hand" catches channels(a).sqrt() * rms_error(a, b);
    },
    own: |yours, reference| Subject {
        pixel_mean: yours.pixel_mean,
        rms_error: yours.rms_error,
        ..reference
    },
    draw,
    explain: None,
};

fn diagonal(film: &FilmFunction, x: u32, y: u32, n: u32) -> Rgb {
    let corner = DVec2::new(f64::from(x), f64::from(y));
    let samples = (0..n).map(|i| corner + (f64::from(i) + 0.5) / f64::from(n));
    samples.map(|point| film(point.x, point.y)).sum::<Rgb>() / f64::from(n)
}

fn channels(pixels: &[Rgb]) -> f64 {
    (3 * pixels.len()) as f64
}

fn compare(
    subject: &Subject,
    film: &FilmFunction,
    text: &str,
    xyn: [u32; 3],
    wanted: Rgb,
) -> Verdict {
    let [x, y, n] = xyn;
    let case = || format!("pixel ({x}, {y}), n = {n}, radiance(x, y) = {text}");
    within(1e-12, case, &(subject.pixel_mean)(film, x, y, n), &wanted)
}

fn centre(subject: &Subject) -> Verdict {
    let film = |x: f64, y: f64| Rgb::new(x, y, x * y);
    compare(subject, &film, "(x, y, x y)", [3, 5, 1], Rgb::new(3.5, 5.5, 19.25))
}

fn number_of_samples(subject: &Subject) -> Verdict {
    for n in [2, 5] {
        let samples = Cell::new(0);
        let film = |_: f64, _: f64| {
            samples.set(samples.get() + 1);
            Rgb::ZERO
        };
        (subject.pixel_mean)(&film, 0, 0, n);
        same(|| format!("how often radiance is asked for, n = {n}"), &samples.get(), &(n * n))?;
    }
    Ok(())
}

fn linear(subject: &Subject) -> Verdict {
    let film = |x: f64, y: f64| Rgb::new(1.0, x + 2.0 * y, 4.0 - y);
    for n in [2, 3, 8] {
        let wanted = Rgb::new(1.0, 2.5 + 2.0 * 7.5, 4.0 - 7.5);
        compare(subject, &film, "(1, x + 2 y, 4 − y)", [2, 7, n], wanted)?;
    }
    Ok(())
}

/// The midpoint rule on [0, 1]: Σ ((i + ½) / n)² / n = 1/3 − 1 / (12 n²).
fn square(subject: &Subject) -> Verdict {
    let film = |x: f64, y: f64| Rgb::new(x * x, y * y, x * x * y * y);
    for n in [1, 2, 3, 10] {
        let mean = 1.0 / 3.0 - 1.0 / (12.0 * f64::from(n * n));
        let wanted = Rgb::new(mean, mean, mean * mean);
        compare(subject, &film, "(x², y², x² y²)", [0, 0, n], wanted)?;
    }
    Ok(())
}

fn compare_error(subject: &Subject, reference: &[Rgb], estimate: &[Rgb], wanted: f64) -> Verdict {
    let list = |pixels: &[Rgb]| pixels.iter().map(Shown::shown).collect::<Vec<_>>().join(" ");
    let case = || format!("reference {}, estimate {}", list(reference), list(estimate));
    within(1e-13, case, &(subject.rms_error)(reference, estimate), &wanted)
}

/// The channels are off by 1, −1 and 5: √(27 / 3).
fn one_pixel(subject: &Subject) -> Verdict {
    let (a, b) = (Rgb::new(1.0, 2.0, 3.0), Rgb::new(2.0, 1.0, 8.0));
    compare_error(subject, &[a], &[a], 0.0)?;
    compare_error(subject, &[a], &[b], 3.0)
}

/// (3, 0, 4), (0, 12, 0) and 0: √(169 / 9).
fn pixels(subject: &Subject) -> Verdict {
    let reference = [Rgb::new(4.0, 1.0, 0.0), Rgb::new(0.5, 13.0, 2.0), Rgb::splat(0.25)];
    let estimate = [Rgb::new(1.0, 1.0, 4.0), Rgb::new(0.5, 1.0, 2.0), Rgb::splat(0.25)];
    compare_error(subject, &reference, &estimate, 13.0 / 3.0)
}

const SIDE: u32 = 112;
/// Rows of a bar and of the gap above it.
const BAR: u32 = 8;
const GAP: u32 = 4;
/// Columns of the first bar.
const LONGEST: f64 = 0.9 * SIDE as f64;

/// The checkered floor with 1 × 1, 2 × 2 and 4 × 4 samples per pixel by the subject's own tracer, and below
/// each picture its error against 8 × 8 samples, in bars of which the first is nearly as wide as the picture.
fn draw(subject: &Subject) -> Image {
    let pictures = [1, 2, 4].map(|n| floor(subject, n));
    let converged = floor(subject, 8);
    let errors = pictures.each_ref().map(|picture| (subject.rms_error)(&converged, picture));
    painted(ImageSize::new(3 * SIDE, SIDE + GAP + BAR), |x, y| {
        let (column, row) = (x as u32, y as u32);
        let (part, column) = ((column / SIDE) as usize, column % SIDE);
        let is_bar = f64::from(column) < LONGEST * errors[part] / errors[0];
        match row.checked_sub(SIDE) {
            None => pictures[part][(row * SIDE + column) as usize],
            Some(below) if below >= GAP && is_bar => Rgb::new(0.9, 0.4, 0.0),
            Some(_) => Rgb::ONE,
        }
    })
}

fn floor(subject: &Subject, n: u32) -> Vec<Rgb> {
    let scene = scenes::horizon();
    let size = ImageSize::new(SIDE, SIDE);
    let film = |x: f64, y: f64| {
        let ray = (subject.primary_ray)(&scene.camera, size, x, y);
        (subject.lr)(&Stage::new(&scene, 0, *subject), &ray, 0)
    };
    let image = painted(size, |x, y| (subject.pixel_mean)(&film, x as u32, y as u32, n));
    (0..SIDE * SIDE).map(|index| image.get(index % SIDE, index / SIDE)).collect()
}
