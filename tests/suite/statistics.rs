//! What a mean of random numbers may be off.

use lancer_core::Rgb;
use lancer_core::sampling::{Estimate, Pattern, PixelSampling, Sample};

/// Independent scramblings of a replicated estimate.
pub const REPLICATES: u32 = 64;
/// Student's t with 63 degrees of freedom that one of 100 comparisons exceeds by chance once in a million: all of the
/// suite's, some 600, once in 160,000. Seeds are fixed, so that what holds goes on holding.
const T: f64 = 6.60;
/// The same of a normal variable.
pub const Z: f64 = 5.731;

/// The estimate of `f` by the means of so many samples, each of another pixel: the samples of one stratify each other,
/// the means are independent.
pub fn replicated(samples: u32, seed: u64, f: impl Fn(&Sample) -> f64) -> Estimate {
    let sampling = PixelSampling { pattern: Pattern::Owen, samples, seed };
    let mean = |pixel| sampling.of_pixel(pixel, 0).map(|sample| f(&sample)).sum::<f64>();
    (0..REPLICATES).map(|pixel| mean(pixel) / f64::from(samples)).collect()
}

/// The estimate of `f` by independent samples, the first of so many pixels.
pub fn independent(count: u32, seed: u64, f: impl Fn(&Sample) -> f64) -> Estimate {
    let sampling = PixelSampling { pattern: Pattern::Owen, samples: 1, seed };
    let samples = (0..count).flat_map(|k| sampling.of_pixel(k % 65536, k / 65536));
    samples.map(|sample| f(&sample)).collect()
}

/// Whether an estimate of independent means agrees with the truth, up to chance and the rounding of sums.
pub fn agrees(estimate: &Estimate, truth: f64) -> bool {
    let bound = if estimate.count() == u64::from(REPLICATES) { T } else { Z };
    let off = (estimate.mean() - truth).abs();
    off <= bound * estimate.standard_error() + 1e-12 * truth.abs()
}

/// The mean of the channels.
pub fn grey(radiance: Rgb) -> f64 {
    radiance.element_sum() / 3.0
}
