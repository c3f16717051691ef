//! E1.10 Samples and their error. Slide « Critiques du lancer de rayons : aliassage et disparition de petits objets ».

use chapter_1::exercises::prelude::*;

/// The mean radiance of a pixel over n × n samples, one in the centre of each cell of a regular grid.
pub fn pixel_mean(radiance: &FilmFunction, x: u32, y: u32, n: u32) -> Rgb {
    let film = |pixel: u32, cell: u32| f64::from(pixel) + (f64::from(cell) + 0.5) / f64::from(n);
    let mut sum = Rgb::ZERO;
    for j in 0..n {
        for i in 0..n {
            sum += radiance(film(x, i), film(y, j));
        }
    }
    sum / f64::from(n * n)
}

/// The root mean square error of a picture: √ of the mean of (a − b)² over all channels of all pixels.
pub fn rms_error(reference: &[Rgb], estimate: &[Rgb]) -> f64 {
    let squares = reference.iter().zip(estimate).map(|(a, b)| (*a - *b).length_squared());
    (squares.sum::<f64>() / (3 * reference.len()) as f64).sqrt()
}
