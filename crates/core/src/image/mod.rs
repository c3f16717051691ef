//! Finished pictures: linear RGB in `f32`, read and written as PNG (sRGB) or EXR (linear).

mod atomic;
mod exr;
mod file;
mod size;
mod srgb;

pub use atomic::{WriteError, check_writable, write_atomically};
pub use file::{ImageError, MAX_BYTES, check_target, load, save};
pub use size::{ImageSize, SizeError};

use crate::Rgb;

/// A picture of linear radiances, row by row from the upper left corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    size: ImageSize,
    pixels: Vec<[f32; 3]>,
}

/// How many pixels of a picture are no radiances, and so betray a faulty computation. No pixel is
/// counted twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Defects {
    /// Pixels with a NaN or infinite channel.
    pub not_finite: usize,
    /// Pixels of finite channels of which at least one is below zero.
    pub negative: usize,
}

impl Image {
    /// A black picture.
    pub fn new(size: ImageSize) -> Self {
        Self { size, pixels: vec![[0.0; 3]; size.pixels()] }
    }

    /// A picture from its pixels, row by row from the upper left corner.
    ///
    /// # Panics
    /// If the number of pixels is not that of `size`.
    pub fn from_pixels(size: ImageSize, pixels: Vec<[f32; 3]>) -> Self {
        assert_eq!(pixels.len(), size.pixels(), "a picture has width × height pixels");
        Self { size, pixels }
    }

    /// Overwrites the rectangle of `size` whose first pixel is in column `x` of row `y`.
    pub(crate) fn paste(&mut self, x: u32, y: u32, size: ImageSize, pixels: &[[f32; 3]]) {
        let width = size.width as usize;
        for (row, source) in pixels.chunks_exact(width).enumerate() {
            let start = (y as usize + row) * self.size.width as usize + x as usize;
            self.pixels[start..start + width].copy_from_slice(source);
        }
    }

    /// Width and height.
    pub fn size(&self) -> ImageSize {
        self.size
    }

    /// The pixels, row by row from the upper left corner.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// The radiance of the pixel in column `x` of row `y`.
    pub fn get(&self, x: u32, y: u32) -> Rgb {
        let [r, g, b] = self.pixels[y as usize * self.size.width as usize + x as usize];
        Rgb::new(f64::from(r), f64::from(g), f64::from(b))
    }

    /// Counts the pixels that no display can show. [`Image::to_srgb8`] and PNG files have no room
    /// for them: whoever writes a picture reports these counts.
    pub fn defects(&self) -> Defects {
        let is_negative = |pixel: &&[f32; 3]| {
            pixel.iter().all(|channel| channel.is_finite())
                && pixel.iter().any(|&channel| channel < 0.0)
        };
        Defects {
            not_finite: self.not_finite().count(),
            negative: self.pixels.iter().filter(is_negative).count(),
        }
    }

    /// The pixels with a NaN or infinite channel, by column and row.
    pub fn not_finite(&self) -> impl Iterator<Item = [u32; 2]> {
        let is_finite = |pixel: &[f32; 3]| pixel.iter().all(|channel| channel.is_finite());
        let width = self.size.width as usize;
        let place = move |i: usize| [(i % width) as u32, (i / width) as u32];
        let bad = self.pixels.iter().enumerate().filter(move |(_, pixel)| !is_finite(pixel));
        bad.map(move |(i, _)| place(i))
    }

    /// The picture as a display shows it, row by row: each channel is multiplied by
    /// 2^`exposure_ev` (in stops, finite), clamped to [0, 1], put through the sRGB curve
    /// (IEC 61966-2-1) and rounded to the nearest of 256 levels.
    ///
    /// Negative channels and NaN become 0, infinite ones 255; [`Image::defects`] counts them.
    pub fn to_srgb8(&self, exposure_ev: f64) -> Vec<[u8; 3]> {
        let scale = exposure_ev.exp2();
        let levels = srgb::Levels::get();
        let level = |channel: f32| levels.of((f64::from(channel) * scale).clamp(0.0, 1.0));
        self.pixels.iter().map(|pixel| pixel.map(level)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(pixels: &[[f32; 3]]) -> Image {
        Image::from_pixels(ImageSize::new(pixels.len() as u32, 1), pixels.to_vec())
    }

    fn grey_level(linear: f64, exposure_ev: f64) -> u8 {
        row(&[[linear as f32; 3]]).to_srgb8(exposure_ev)[0][0]
    }

    #[test]
    fn known_values_of_the_srgb_curve() {
        // Halfway between levels 127 and 128 lies ((0.5 + 0.055) / 1.055)^2.4 = 0.2140411…
        for (linear, level) in
            [(0.0, 0), (1.0, 255), (0.5, 188), (0.18, 118), (0.21403, 127), (0.21405, 128)]
        {
            assert_eq!(grey_level(linear, 0.0), level, "{linear}");
        }
        // On the straight foot: 12.92 * 255 * 0.0031308 = 10.31…
        assert_eq!(grey_level(0.003_130_8, 0.0), 10);
        assert_eq!(grey_level(0.5 / (12.92 * 255.0) - 1e-7, 0.0), 0);
        assert_eq!(grey_level(0.5 / (12.92 * 255.0) + 1e-7, 0.0), 1);
    }

    #[test]
    fn exposure_counts_in_stops() {
        assert_eq!(grey_level(0.25, 1.0), grey_level(0.5, 0.0));
        assert_eq!(grey_level(4.0, -3.0), grey_level(0.5, 0.0));
        assert_eq!(grey_level(0.25, 2.0), 255);
        assert_eq!(grey_level(0.25, 5000.0), 255);
        assert_eq!(grey_level(0.0, 5000.0), 0, "black stays black at any exposure");
    }

    #[test]
    fn what_no_display_shows_is_clamped() {
        let image = row(&[[f32::NEG_INFINITY, -1.0, f32::NAN], [f32::INFINITY, 7.0, -0.0]]);
        assert_eq!(image.to_srgb8(0.0), [[0, 0, 0], [255, 255, 0]]);
    }

    #[test]
    fn each_defective_pixel_is_counted_once() {
        let image = row(&[
            [0.0, -0.0, 1e30],
            [f32::NAN, f32::NAN, 1.0],
            [1.0, 2.0, f32::INFINITY],
            [f32::NEG_INFINITY, 0.0, 0.0],
            [f32::NAN, -1.0, 0.0],
            [-1e-30, 0.0, -2.0],
        ]);
        assert_eq!(image.defects(), Defects { not_finite: 4, negative: 1 });
        let in_columns = Image::from_pixels(ImageSize::new(2, 3), image.pixels.clone());
        let places: Vec<_> = in_columns.not_finite().collect();
        assert_eq!(places, [[1, 0], [0, 1], [1, 1], [0, 2]]);
        assert_eq!(Image::new(ImageSize::new(3, 2)).defects(), Defects::default());
    }
}
