//! How far a picture is from its reference: error metrics.
//!
//! All but [`flip`] and [`psnr_srgb8`] compare linear radiances in `f64`. A NaN is never averaged
//! away: every metric that meets one in either picture is itself NaN, and so is the entry of its
//! pixel in a map. Equal infinities differ by NaN too. Sums run in pixel order, so that results
//! have the same bits for any number of threads.

mod flip;
mod plane;

pub use flip::{PIXELS_PER_DEGREE, flip, flip_map};

use thiserror::Error;

use crate::image::{Image, ImageSize};

/// What keeps the squares in [`rel_mse`] finite where the reference is black.
const REL_MSE_FLOOR: f64 = 1e-2;

/// The errors of one picture against its reference; all 0 for equal pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// [`rmse`], a radiance.
    pub rmse: f64,
    /// [`rel_mse`], without unit.
    pub rel_mse: f64,
    /// [`max_abs`], a radiance.
    pub max: f64,
    /// [`percentile_99`], a radiance.
    pub p99: f64,
    /// [`flip`], from 0 to 1.
    pub flip: f64,
}

impl Errors {
    /// The errors with the names they have in tables and charts.
    pub fn named(&self) -> [(&'static str, f64); 5] {
        [
            ("RMSE", self.rmse),
            ("relMSE", self.rel_mse),
            ("max", self.max),
            ("p99", self.p99),
            ("FLIP", self.flip),
        ]
    }
}

/// The pictures to compare have different sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("cannot compare a picture of {estimate} with a reference of {reference} pixels")]
pub struct SizeMismatch {
    /// The size of the reference.
    pub reference: ImageSize,
    /// The size of the picture to judge.
    pub estimate: ImageSize,
}

/// All errors of `estimate` at once.
///
/// # Errors
/// If the sizes differ; so do all functions of this module.
pub fn compare(reference: &Image, estimate: &Image) -> Result<Errors, SizeMismatch> {
    let map = absolute_error_map(reference, estimate)?;
    Ok(Errors {
        rmse: rmse(reference, estimate)?,
        rel_mse: rel_mse(reference, estimate)?,
        max: largest(&map),
        p99: nearest_rank_99(map),
        flip: flip(reference, estimate)?,
    })
}

/// Root mean square error: √mean((a − b)²) over all channels of all pixels, a of the estimate and b
/// of the reference.
///
/// # Errors
/// If the sizes differ.
pub fn rmse(reference: &Image, estimate: &Image) -> Result<f64, SizeMismatch> {
    Ok(mean_of_channels(reference, estimate, |a, b| (a - b).powi(2))?.sqrt())
}

/// Relative mean square error: mean((a − b)² / (b² + 0.01)) over all channels of all pixels, a of
/// the estimate and b of the reference (Rousselle et al. 2011, "Adaptive sampling and
/// reconstruction using greedy error minimization").
///
/// # Errors
/// If the sizes differ.
pub fn rel_mse(reference: &Image, estimate: &Image) -> Result<f64, SizeMismatch> {
    mean_of_channels(reference, estimate, |a, b| (a - b).powi(2) / (b * b + REL_MSE_FLOOR))
}

/// The largest absolute error of any channel of any pixel.
///
/// # Errors
/// If the sizes differ.
pub fn max_abs(reference: &Image, estimate: &Image) -> Result<f64, SizeMismatch> {
    Ok(largest(&absolute_error_map(reference, estimate)?))
}

/// The 99th percentile by nearest rank of [`absolute_error_map`]: its smallest entry such that 99 %
/// of the pixels or more have no larger one.
///
/// # Errors
/// If the sizes differ.
pub fn percentile_99(reference: &Image, estimate: &Image) -> Result<f64, SizeMismatch> {
    Ok(nearest_rank_99(absolute_error_map(reference, estimate)?))
}

/// The absolute error of each pixel, row by row: the largest of |a − b| over its three channels.
///
/// # Errors
/// If the sizes differ.
pub fn absolute_error_map(reference: &Image, estimate: &Image) -> Result<Vec<f64>, SizeMismatch> {
    let error =
        |pixel: [(f64, f64); 3]| pixel.map(|(a, b)| (a - b).abs()).into_iter().fold(0.0, larger);
    Ok(pairs(reference, estimate)?.map(error).collect())
}

/// Peak signal-to-noise ratio in decibels of the pictures as a display shows them, by
/// [`Image::to_srgb8`] without exposure: 10 log₁₀(255² / mean((a − b)²)) over the levels, from 0 to
/// 255, of all channels. +∞ where no level differs.
///
/// # Errors
/// If the sizes differ.
pub fn psnr_srgb8(reference: &Image, estimate: &Image) -> Result<f64, SizeMismatch> {
    // The conversion to levels would hide a NaN.
    if pairs(reference, estimate)?.flatten().any(|(a, b)| a.is_nan() || b.is_nan()) {
        return Ok(f64::NAN);
    }
    let (levels_b, levels_a) = (reference.to_srgb8(0.0), estimate.to_srgb8(0.0));
    let levels = levels_a.as_flattened().iter().zip(levels_b.as_flattened());
    let squares = levels.map(|(&a, &b)| f64::from(a.abs_diff(b)).powi(2));
    Ok(10.0 * (255_f64.powi(2) / mean(squares)).log10())
}

fn check_sizes(reference: &Image, estimate: &Image) -> Result<(), SizeMismatch> {
    let (reference, estimate) = (reference.size(), estimate.size());
    if reference == estimate { Ok(()) } else { Err(SizeMismatch { reference, estimate }) }
}

/// The channels of each pixel, of the estimate and of the reference.
fn pairs<'a>(
    reference: &'a Image,
    estimate: &'a Image,
) -> Result<impl ExactSizeIterator<Item = [(f64, f64); 3]> + use<'a>, SizeMismatch> {
    check_sizes(reference, estimate)?;
    let pixels = estimate.pixels().iter().zip(reference.pixels());
    Ok(pixels.map(|(a, b)| std::array::from_fn(|i| (f64::from(a[i]), f64::from(b[i])))))
}

fn mean_of_channels(
    reference: &Image,
    estimate: &Image,
    error: impl Fn(f64, f64) -> f64,
) -> Result<f64, SizeMismatch> {
    Ok(mean(pairs(reference, estimate)?.flatten().map(|(a, b)| error(a, b))))
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_usize), |(sum, count), value| (sum + value, count + 1));
    sum / count as f64
}

/// The larger number, or NaN if there is one, unlike [`f64::max`].
fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

fn largest(map: &[f64]) -> f64 {
    map.iter().copied().fold(0.0, larger)
}

fn nearest_rank_99(mut map: Vec<f64>) -> f64 {
    if map.iter().any(|error| error.is_nan()) {
        return f64::NAN;
    }
    let rank = (99 * map.len()).div_ceil(100);
    *map.select_nth_unstable_by(rank - 1, f64::total_cmp).1
}
