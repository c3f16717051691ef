//! Error metrics against numbers found by hand and by numpy.

use lancer_core::image::{Image, ImageSize};
use lancer_core::metric::{
    SizeMismatch, absolute_error_map, compare, flip, max_abs, percentile_99, psnr_srgb8, rel_mse,
    rmse,
};

fn row(pixels: &[[f32; 3]]) -> Image {
    Image::from_pixels(ImageSize::new(pixels.len() as u32, 1), pixels.to_vec())
}

/// 20 × 15 pixels whose channels are (i · `factor` mod `modulus`) / 64.
fn pattern(factor: usize, modulus: usize) -> Image {
    let channel = |i: usize| (i * factor % modulus) as f32 / 64.0;
    let pixels = (0..300).map(|i| [channel(3 * i), channel(3 * i + 1), channel(3 * i + 2)]);
    Image::from_pixels(ImageSize::new(20, 15), pixels.collect())
}

fn assert_close(value: f64, expected: f64) {
    assert!((value - expected).abs() <= 1e-13 * expected, "{value} not {expected}");
}

#[test]
fn two_pixels_by_hand() {
    let reference = row(&[[1.0, 0.0, 2.0], [0.5, 0.5, 0.5]]);
    let estimate = row(&[[1.5, 0.0, 1.0], [0.5, 0.25, 0.5]]);
    // The errors: 0.5, 0, 1; 0, 0.25, 0.
    let errors = compare(&reference, &estimate).unwrap();
    assert_close(errors.rmse, (1.3125_f64 / 6.0).sqrt());
    assert_close(errors.rel_mse, (0.25 / 1.01 + 1.0 / 4.01 + 0.0625 / 0.26) / 6.0);
    assert_eq!((errors.max, errors.p99), (1.0, 1.0));
    assert_eq!(absolute_error_map(&reference, &estimate).unwrap(), [1.0, 0.25]);
    assert_eq!(errors.flip, flip(&reference, &estimate).unwrap());
    // Over a black reference the floor of 0.01 is all there is.
    assert_close(rel_mse(&row(&[[0.0; 3]]), &row(&[[0.5; 3]])).unwrap(), 25.0);
}

/// ```python
/// import numpy as np
/// i = np.arange(900)
/// b, a = [((i * f % m) / 64).reshape(300, 3) for f, m in [(37, 101), (53, 97)]]
/// largest = np.abs(a - b).max(1)
/// srgb = lambda x: np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
/// levels = lambda x: np.rint(255 * srgb(np.clip(x, 0, 1)))
/// print(np.sqrt(((a - b) ** 2).mean()), ((a - b) ** 2 / (b ** 2 + 1e-2)).mean(), largest.max(),
///       np.percentile(largest, 99, method="inverted_cdf"),
///       10 * np.log10(255 ** 2 / ((levels(a) - levels(b)) ** 2).mean()))
/// ```
#[test]
fn patterns_by_numpy() {
    let (reference, estimate) = (pattern(37, 101), pattern(53, 97));
    let errors = compare(&reference, &estimate).unwrap();
    assert_close(errors.rmse, 0.632_252_409_887_876_8);
    assert_close(errors.rel_mse, 6.066_516_047_356_678);
    assert_eq!((errors.max, errors.p99), (1.46875, 1.421875));
    assert_close(psnr_srgb8(&reference, &estimate).unwrap(), 9.270_462_295_145_652);
    assert_eq!(errors.rmse, rmse(&reference, &estimate).unwrap());
    assert_eq!(errors.rel_mse, rel_mse(&reference, &estimate).unwrap());
    assert_eq!(errors.max, max_abs(&reference, &estimate).unwrap());
    assert_eq!(errors.p99, percentile_99(&reference, &estimate).unwrap());
}

#[test]
fn equal_pictures_have_no_error() {
    let picture = pattern(37, 101);
    let errors = compare(&picture, &picture).unwrap();
    assert_eq!([errors.rmse, errors.rel_mse, errors.max, errors.p99, errors.flip], [0.0; 5]);
    assert_eq!(psnr_srgb8(&picture, &picture), Ok(f64::INFINITY));
}

#[test]
fn the_percentile_is_that_of_the_nearest_rank() {
    // Errors of 1 to n in a shuffled order: the rank is ⌈0.99 n⌉.
    for (n, expected) in [(1, 1.0), (99, 99.0), (100, 99.0), (101, 100.0), (200, 198.0)] {
        let pixels: Vec<_> = (0..n).map(|i| [0.0, (i * 83 % n + 1) as f32, 0.5]).collect();
        let reference = Image::new(ImageSize::new(n as u32, 1));
        assert_eq!(percentile_99(&reference, &row(&pixels)), Ok(expected), "{n}");
    }
}

#[test]
fn psnr_is_that_of_8_bit_levels() {
    // One level of difference in all channels: 20 log₁₀(255) dB.
    let level = |level: f64| [(((level / 255.0 + 0.055) / 1.055).powf(2.4)) as f32; 3];
    let psnr = psnr_srgb8(&row(&[level(100.0)]), &row(&[level(101.0)])).unwrap();
    assert_close(psnr, 48.130_803_608_679_11);
    assert_eq!(psnr_srgb8(&row(&[[0.0; 3]]), &row(&[[9.0; 3]])), Ok(0.0));
}

#[test]
fn a_nan_in_either_picture_is_seen_by_every_metric() {
    let clean = pattern(37, 101);
    let mut pixels = clean.pixels().to_vec();
    pixels[123][1] = f32::NAN;
    let stained = Image::from_pixels(clean.size(), pixels);
    for (a, b) in [(&clean, &stained), (&stained, &clean), (&stained, &stained)] {
        let errors = compare(a, b).unwrap();
        for value in [errors.rmse, errors.rel_mse, errors.max, errors.p99, errors.flip] {
            assert!(value.is_nan(), "{errors:?}");
        }
        assert!(psnr_srgb8(a, b).unwrap().is_nan());
        let map = absolute_error_map(a, b).unwrap();
        assert!(map.iter().enumerate().all(|(i, error)| error.is_nan() == (i == 123)));
    }
}

#[test]
fn an_infinite_pixel_is_an_infinite_error() {
    let errors = compare(&row(&[[1.0; 3]; 2]), &row(&[[1.0; 3], [f32::INFINITY; 3]])).unwrap();
    let linear = [errors.rmse, errors.rel_mse, errors.max, errors.p99];
    assert_eq!(linear, [f64::INFINITY; 4]);
}

#[test]
fn other_sizes_are_refused_with_both() {
    // As many pixels, in another shape.
    let (reference, estimate) = (ImageSize::new(4, 3), ImageSize::new(6, 2));
    let mismatch = SizeMismatch { reference, estimate };
    let (a, b) = (Image::new(reference), Image::new(estimate));
    assert_eq!(compare(&a, &b), Err(mismatch));
    assert_eq!(flip(&a, &b), Err(mismatch));
    assert_eq!(psnr_srgb8(&a, &b), Err(mismatch));
    let message = mismatch.to_string();
    assert!(message.contains("4x3") && message.contains("6x2"), "{message}");
}
