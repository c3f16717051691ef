//! How far a picture is from its reference, and how fast something grows.

use lancer_core::image::{Image, ImageSize};
use lancer_core::metric::{absolute_error_map, compare};
use lancer_figure::{HeatScale, Tile};

/// All errors of a picture of the reference's size, by name.
pub fn errors_of(reference: &Image, image: &Image) -> [(&'static str, f64); 5] {
    compare(reference, image).expect("pictures of one size").named()
}

/// The map of a picture's errors on a scale that it may share with others.
pub fn error_tile(
    title: impl Into<String>,
    scale: &HeatScale,
    reference: &Image,
    image: &Image,
) -> Tile {
    let errors = absolute_error_map(reference, image).expect("pictures of one size");
    let ImageSize { width, height, .. } = image.size();
    Tile::new(title, scale.paint(width, height, &errors))
}

/// The mean over all pixels of the largest error of a channel.
pub fn mean_error(reference: &Image, image: &Image) -> f64 {
    let errors = absolute_error_map(reference, image).expect("pictures of one size");
    errors.iter().sum::<f64>() / errors.len() as f64
}

/// The mean of all channels of all pixels.
pub fn mean(image: &Image) -> f64 {
    let channels = image.pixels().as_flattened();
    channels.iter().copied().map(f64::from).sum::<f64>() / channels.len() as f64
}

/// Two pictures' pixels combined.
pub fn pixelwise(a: &Image, b: &Image, combine: impl Fn(f32, f32) -> f32) -> Image {
    let pixels = a.pixels().iter().zip(b.pixels());
    let pixels = pixels.map(|(a, b)| [0, 1, 2].map(|channel| combine(a[channel], b[channel])));
    Image::from_pixels(a.size(), pixels.collect())
}

/// The exponent p of y ≈ c xᵖ: the slope between log axes, by least squares.
pub fn fitted_exponent(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean_x = logs.iter().map(|(x, _)| x).sum::<f64>() / count;
    let mean_y = logs.iter().map(|(_, y)| y).sum::<f64>() / count;
    let covariance: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    covariance / logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_of_a_power_is_found() {
        let points: Vec<_> =
            (1..6).map(|k| (f64::from(k), 3.0 * f64::from(k).powf(-1.5))).collect();
        assert!((fitted_exponent(&points) + 1.5).abs() < 1e-12);
    }

    #[test]
    fn means_by_hand() {
        let size = ImageSize::new(2, 1);
        let image = |pixels: [[f32; 3]; 2]| Image::from_pixels(size, pixels.to_vec());
        let (a, b) =
            (image([[1.0, 2.0, 3.0], [0.0; 3]]), image([[1.0, 0.0, 3.5], [0.5, 0.0, 0.0]]));
        assert_eq!(mean(&a), 1.0);
        // The largest errors are 2 and ½.
        assert_eq!(mean_error(&a, &b), 1.25);
        assert_eq!(pixelwise(&a, &b, |a, b| a - b).pixels()[0], [0.0, 2.0, -0.5]);
    }
}
