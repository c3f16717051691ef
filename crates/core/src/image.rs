//! Finished pictures: linear RGB in `f32`, read and written as PNG (sRGB) or EXR (linear).

use crate::Rgb;

/// The width and height of a picture in pixels, both at least 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageSize {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

impl ImageSize {
    /// A picture of `width` × `height` pixels.
    pub const fn new(width: u32, height: u32) -> Self {
        Self { width, height }
    }

    /// The number of pixels.
    pub const fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }
}

/// A picture of linear radiances, row by row from the upper left corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    size: ImageSize,
    pixels: Vec<[f32; 3]>,
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
}
