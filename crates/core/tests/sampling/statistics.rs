//! Tests with a stated false-alarm rate.

use lancer_core::sampling::{Estimate, Pattern, PixelSampling, Sample, Uniform};

/// Independent scramblings of one comparison.
const REPLICATES: u32 = 64;
/// Student's quantile with 63 degrees of freedom that 100 comparisons exceed once in a million.
const T: f64 = 6.60;
/// The normal quantile of the same.
pub const Z: f64 = 5.731;

/// The mean of `samples` samples of `f` in one scrambling.
pub fn scrambled_mean(seed: u32, samples: u32, f: impl Fn([f64; 2]) -> f64) -> f64 {
    let sampling = PixelSampling { pattern: Pattern::Owen, samples, seed: u64::from(seed) };
    let first = sampling.of_pixel(seed, 1).next().unwrap();
    let value = |index| {
        let [u, v, _, _] = Sample { index, ..first }.numbers(1);
        f([u, v])
    };
    (0..samples).map(value).collect::<Estimate>().mean()
}

/// The means of `samples` samples of `f` each, in 64 scramblings: what is within one depends on each other, so they
/// are never pooled.
pub fn replicated(samples: u32, f: impl Fn([f64; 2]) -> f64) -> Estimate {
    (0..REPLICATES).map(|seed| scrambled_mean(seed, samples, &f)).collect()
}

/// Whether the means of scramblings are what they should be, up to chance and rounding.
pub fn agrees(estimate: &Estimate, truth: f64) -> bool {
    assert_eq!(estimate.count(), u64::from(REPLICATES));
    let off = (estimate.mean() - truth).abs();
    off <= T * estimate.standard_error() + 1e-11 * truth.abs()
}

/// Independent samples.
pub fn independent(count: u32, f: impl Fn([f64; 2]) -> f64) -> Estimate {
    let mut random = Uniform::new(1, 2, count);
    (0..count).map(|_| f([random.number(), random.number()])).collect()
}

/// Whether the standard deviation of one sample, over the mean, is what it should be, up to chance: s² has the
/// relative standard deviation √((κ − 1)/N), with the kurtosis κ of one sample.
pub fn deviates(estimate: &Estimate, mean: f64, relative: f64, kurtosis: f64) -> bool {
    let ratio = estimate.variance() / (relative * mean).powi(2);
    // Truths have six digits.
    (ratio - 1.0).abs() <= Z * ((kurtosis - 1.0) / estimate.count() as f64).sqrt() + 3e-6
}

/// χ² with as many degrees of freedom as there are masses, less one, that is exceeded once in 10⁸ (Wilson, Hilferty
/// 1931, which is up to half a percent more).
pub fn chi_squared_limit(cells: usize) -> f64 {
    let k = (cells - 1) as f64;
    let z = 5.612;
    k * (1.0 - 2.0 / (9.0 * k) + z * (2.0 / (9.0 * k)).sqrt()).powi(3)
}

/// Pearson's χ² of `count` independent samples over cells with these probabilities; infinite if a sample lies in
/// none, or in one of probability 0.
pub fn chi_squared(count: u32, masses: &[f64], cell: impl Fn([f64; 2]) -> Option<usize>) -> f64 {
    let mut random = Uniform::new(5, 6, count);
    let mut counts = vec![0_u32; masses.len()];
    for _ in 0..count {
        match cell([random.number(), random.number()]) {
            Some(cell) => counts[cell] += 1,
            None => return f64::INFINITY,
        }
    }
    let term = |(&hits, mass): (&u32, f64)| {
        let (hits, expected) = (f64::from(hits), f64::from(count) * mass);
        assert!(expected == 0.0 || expected >= 5.0, "a cell of expectation {expected}");
        if hits == expected { 0.0 } else { (hits - expected).powi(2) / expected }
    };
    counts.iter().zip(masses.iter().copied()).map(term).sum()
}

/// Tables of the distribution, at 10⁻⁸.
#[test]
fn limits_are_those_of_tables() {
    for (freedom, limit) in [(63, 147.5), (127, 237.6), (199, 332.0), (255, 402.7), (511, 711.2)] {
        let found = chi_squared_limit(freedom + 1);
        assert!((0.0..5e-3).contains(&(found / limit - 1.0)), "{freedom}: {found}");
    }
}
