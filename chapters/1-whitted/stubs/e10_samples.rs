//! E1.10 Samples and their error. Slide « Critiques du lancer de rayons : aliassage et disparition de petits objets ».

use chapter_1::exercises::prelude::*;

/// The mean radiance of a pixel over n × n samples, one in the centre of each cell of a regular grid.
///
/// - `radiance(x, y)`: the radiance at a point of the film, in pixels; an `Rgb` is a `DVec3`.
/// - The pixel covers [x, x + 1] × [y, y + 1]. `x`, `y` and `n` are whole numbers; `f64::from(n)` is one to
///   calculate with. `for i in 0..n { … }` counts from 0 to n − 1.
pub fn pixel_mean(radiance: &FilmFunction, x: u32, y: u32, n: u32) -> Rgb {
    todo!("E1.10: average the samples")
}

/// The root mean square error of a picture: √ of the mean of (a − b)² over all channels of all pixels.
///
/// Both pictures have the same number of pixels, `reference.len()`, at least 1; `reference.iter().zip(estimate)`
/// goes through both together.
pub fn rms_error(reference: &[Rgb], estimate: &[Rgb]) -> f64 {
    todo!("E1.10: measure the error")
}
