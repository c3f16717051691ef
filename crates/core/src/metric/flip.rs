//! FLIP for low dynamic range: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild,
//! "FLIP: A Difference Evaluator for Alternating Images", HPG 2020. The constants are the paper's.

use std::f64::consts::{PI, SQRT_2};

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::plane::Plane;
use super::{SizeMismatch, check_sizes, larger, mean};
use crate::image::Image;

/// How the pictures are looked at: 0.7 m before a monitor 0.7 m wide of 3840 pixels, which gives
/// 67.02 pixels per degree, as in the paper. Fixed, so that all FLIP values of the course compare.
pub const PIXELS_PER_DEGREE: f64 = 0.7 * (3840.0 / 0.7) * (PI / 180.0);

/// The mean of [`flip_map`], the difference that one sees on flipping between two pictures: 0 for
/// none, 1 for the most.
///
/// # Errors
/// If the sizes differ.
pub fn flip(reference: &Image, estimate: &Image) -> Result<f64, SizeMismatch> {
    Ok(mean(flip_map(reference, estimate)?.into_iter()))
}

/// The FLIP difference of each pixel from 0 to 1, row by row, at [`PIXELS_PER_DEGREE`].
///
/// The pictures are taken as a display shows them: linear channels, without exposure, are clamped
/// to [0, 1] (but not rounded to 8 bits). A NaN spreads as far as the filters reach, 10 pixels.
///
/// # Errors
/// If the sizes differ.
pub fn flip_map(reference: &Image, estimate: &Image) -> Result<Vec<f64>, SizeMismatch> {
    check_sizes(reference, estimate)?;
    let display = Display::srgb();
    let [reference, estimate] = [reference, estimate].map(|image| display.opponent(image));
    let color = color_differences(&display, &reference, &estimate);
    let feature = feature_differences(&reference[0], &estimate[0]);
    Ok(color
        .into_par_iter()
        .zip(feature)
        .map(|(color, feature)| color.powf(1.0 - feature))
        .collect())
}

/// The conversions between linear RGB and CIE XYZ of one kind of display.
struct Display {
    to_xyz: DMat3,
    to_rgb: DMat3,
    /// XYZ of white, of luminance Y = 1.
    white: DVec3,
}

impl Display {
    /// The primaries of ITU-R BT.709 and the white D65 to five digits, which is what NVIDIA's
    /// implementation uses. With the four digits of BT.709 itself, FLIP differs by 1e-5.
    fn srgb() -> Self {
        let at = |x: f64, y: f64| DVec3::new(x / y, 1.0, (1.0 - x - y) / y);
        let white = at(0.31271, 0.32902);
        let primaries = DMat3::from_cols(at(0.64, 0.33), at(0.30, 0.60), at(0.15, 0.06));
        let to_xyz = primaries * DMat3::from_diagonal(primaries.inverse() * white);
        Self { to_xyz, to_rgb: to_xyz.inverse(), white }
    }

    /// The picture in the linear opponent space Y_yC_xC_z: luminance, red-green and blue-yellow.
    fn opponent(&self, image: &Image) -> [Plane; 3] {
        let width = image.size().width as usize;
        let opponent = |pixel: &[f32; 3]| {
            let rgb = DVec3::from_array(pixel.map(|channel| f64::from(channel.clamp(0.0, 1.0))));
            let DVec3 { x, y, z } = self.to_xyz * rgb / self.white;
            DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
        };
        let pixels: Vec<DVec3> = image.pixels().par_iter().map(opponent).collect();
        [0, 1, 2].map(|i| Plane::new(width, pixels.iter().map(|pixel| pixel[i]).collect()))
    }

    /// The displayable linear RGB next to a Y_yC_xC_z colour.
    fn rgb_of_opponent(&self, opponent: DVec3) -> DVec3 {
        let y = (opponent.x + 16.0) / 116.0;
        let xyz = self.white * DVec3::new(y + opponent.y / 500.0, y, y - opponent.z / 200.0);
        // Not `DVec3::clamp`, which loses a NaN.
        (self.to_rgb * xyz).map(|channel| channel.clamp(0.0, 1.0))
    }

    /// CIE L*a*b*, with the chroma of dark colours reduced for the Hunt effect.
    fn hunt_lab(&self, rgb: DVec3) -> DVec3 {
        const KNEE: f64 = 6.0 / 29.0;
        let DVec3 { x, y, z } = (self.to_xyz * rgb / self.white).map(|t| {
            if t > KNEE.powi(3) { t.cbrt() } else { t / (3.0 * KNEE * KNEE) + 4.0 / 29.0 }
        });
        let lightness = 116.0 * y - 16.0;
        let chroma = 0.01 * lightness;
        DVec3::new(lightness, chroma * 500.0 * (x - y), chroma * 200.0 * (y - z))
    }
}

/// The colour pipeline: differences from 0 to 1 of what is left of the colours after the filters
/// of the eye's contrast sensitivity.
fn color_differences(display: &Display, a: &[Plane; 3], b: &[Plane; 3]) -> Vec<f64> {
    let seen = |planes: &[Plane; 3]| -> Vec<DVec3> {
        let [y, cx, cz] = contrast_filtered(planes);
        let pixels = y.values().par_iter().zip(cx.values()).zip(cz.values());
        pixels
            .map(|((&y, &cx), &cz)| {
                display.hunt_lab(display.rgb_of_opponent(DVec3::new(y, cx, cz)))
            })
            .collect()
    };
    let extreme = hyab(display.hunt_lab(DVec3::Y), display.hunt_lab(DVec3::Z)).powf(0.7);
    let difference = |(a, b)| redistribute(hyab(a, b).powf(0.7), extreme);
    seen(a).into_par_iter().zip(seen(b)).map(difference).collect()
}

/// The distance HyAB of two L*a*b* colours: city block in lightness, Euclidean in chroma.
fn hyab(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}

/// Maps errors from 0 to `extreme` to 0 to 1, the lower 0.4 of them to 0 to 0.95.
fn redistribute(error: f64, extreme: f64) -> f64 {
    const TARGET: f64 = 0.95;
    let limit = 0.4 * extreme;
    if error < limit {
        TARGET / limit * error
    } else {
        TARGET + (error - limit) / (extreme - limit) * (1.0 - TARGET)
    }
}

/// A Gaussian of the eye's contrast sensitivity in space: a √(π/b) exp(−π² r²/b) at r degrees.
struct Sensitivity {
    a: f64,
    b: f64,
}

const LUMINANCE: [Sensitivity; 1] = [Sensitivity { a: 1.0, b: 0.0047 }];
const RED_GREEN: [Sensitivity; 1] = [Sensitivity { a: 1.0, b: 0.0053 }];
const BLUE_YELLOW: [Sensitivity; 2] =
    [Sensitivity { a: 34.1, b: 0.04 }, Sensitivity { a: 13.5, b: 0.025 }];

fn contrast_filtered([y, cx, cz]: &[Plane; 3]) -> [Plane; 3] {
    // Three standard deviations of the widest Gaussian, for all.
    let widest = (BLUE_YELLOW[0].b / (2.0 * PI * PI)).sqrt();
    let radius = (3.0 * widest * PIXELS_PER_DEGREE).ceil() as i32;
    [
        sum_of_gaussians(y, &LUMINANCE, radius),
        sum_of_gaussians(cx, &RED_GREEN, radius),
        sum_of_gaussians(cz, &BLUE_YELLOW, radius),
    ]
}

/// Filters with the sum of the Gaussians, scaled to weigh 1 in all. The sum is not separable, but
/// each of its terms is.
fn sum_of_gaussians(plane: &Plane, terms: &[Sensitivity], radius: i32) -> Plane {
    let kernels: Vec<(f64, Vec<f64>)> = terms
        .iter()
        .map(|term| {
            let degrees = |x: f64| x / PIXELS_PER_DEGREE;
            let profile = sampled(radius, |x| (-(PI * degrees(x)).powi(2) / term.b).exp());
            let sum: f64 = profile.iter().sum();
            (term.a * (PI / term.b).sqrt() * sum * sum, balanced(profile))
        })
        .collect();
    let total: f64 = kernels.iter().map(|(weight, _)| weight).sum();
    kernels.iter().fold(plane.zeros(), |sum, (weight, profile)| {
        let filtered = plane.filter_rows(profile).filter_columns(profile);
        sum.plus(weight / total, &filtered)
    })
}

/// The feature pipeline: differences from 0 to 1 of edges and points in the luminance Y_y.
fn feature_differences(a: &Plane, b: &Plane) -> Vec<f64> {
    let difference = |(a, b): (Features, Features)| {
        let largest = larger((a.edge - b.edge).abs(), (a.point - b.point).abs());
        (largest / SQRT_2).sqrt()
    };
    features(a).into_par_iter().zip(features(b)).map(difference).collect()
}

/// The magnitudes of first and second derivatives of the luminance Y.
struct Features {
    edge: f64,
    point: f64,
}

fn features(luminance: &Plane) -> Vec<Features> {
    // The features that the eye sees best are 0.082 degrees wide.
    let deviation = 0.5 * 0.082 * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as i32;
    let gaussian = |x: f64| (-0.5 * (x / deviation).powi(2)).exp();
    let smooth = balanced(sampled(radius, gaussian));
    let edge = balanced(sampled(radius, |x| -x * gaussian(x)));
    let point = balanced(sampled(radius, |x| ((x / deviation).powi(2) - 1.0) * gaussian(x)));

    let across = luminance.filter_rows(&smooth);
    let edge_x = luminance.filter_rows(&edge).filter_columns(&smooth);
    let edge_y = across.filter_columns(&edge);
    let point_x = luminance.filter_rows(&point).filter_columns(&smooth);
    let point_y = across.filter_columns(&point);

    // Y_y is 116 Y − 16; the −16 is lost on weights whose sum is 0.
    let magnitude = |(x, y): (&f64, &f64)| x.hypot(*y) / 116.0;
    let magnitudes = |x: &Plane, y: &Plane| -> Vec<f64> {
        x.values().par_iter().zip(y.values()).map(magnitude).collect()
    };
    let edges = magnitudes(&edge_x, &edge_y);
    let points = magnitudes(&point_x, &point_y);
    edges.into_iter().zip(points).map(|(edge, point)| Features { edge, point }).collect()
}

/// A profile at the pixels −radius to radius.
fn sampled(radius: i32, profile: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|x| profile(f64::from(x))).collect()
}

/// Scales the positive values to sum to 1 and the negative ones, if any, to −1.
fn balanced(mut profile: Vec<f64>) -> Vec<f64> {
    let positive: f64 = profile.iter().map(|value| value.max(0.0)).sum();
    let negative: f64 = profile.iter().map(|value| value.min(0.0)).sum();
    for value in &mut profile {
        *value /= if *value < 0.0 { -negative } else { positive };
    }
    profile
}
