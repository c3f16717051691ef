//! 8-bit pictures: cropping, resampling, PNG.

use std::sync::OnceLock;

use image::{
    ExtendedColorType, ImageEncoder,
    codecs::png::{CompressionType, FilterType, PngEncoder},
};

/// A picture of sRGB pixels, row by row from the upper left corner.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    rgb: Vec<[u8; 3]>,
}

impl Picture {
    /// A picture from its sRGB pixels, row by row from the upper left corner.
    ///
    /// # Panics
    /// If a side is 0 or the number of pixels is not `width` × `height`.
    pub fn new(width: u32, height: u32, rgb: Vec<[u8; 3]>) -> Self {
        assert!(width > 0 && height > 0, "a picture has pixels");
        assert_eq!(
            rgb.len(),
            width as usize * height as usize,
            "a picture has width × height pixels"
        );
        Self { width, height, rgb }
    }

    /// A picture whose pixel in column `x` of row `y` is `color(x, y)`.
    pub fn from_fn(width: u32, height: u32, mut color: impl FnMut(u32, u32) -> [u8; 3]) -> Self {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Self::new(width, height, pixels.map(|(x, y)| color(x, y)).collect())
    }

    /// Pixels across, at least 1.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down, at least 1.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Height over width.
    pub fn aspect(&self) -> f64 {
        f64::from(self.height) / f64::from(self.width)
    }

    /// The pixel in column `x` of row `y`.
    ///
    /// # Panics
    /// If it lies outside.
    pub fn get(&self, x: u32, y: u32) -> [u8; 3] {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) lies outside the picture");
        self.rgb[y as usize * self.width as usize + x as usize]
    }

    /// The part of `width` × `height` pixels whose upper left pixel is (`x`, `y`).
    ///
    /// # Panics
    /// If a side is 0 or the part reaches outside.
    pub fn crop(&self, x: u32, y: u32, width: u32, height: u32) -> Self {
        Self::from_fn(width, height, |column, row| self.get(x + column, y + row))
    }

    /// The picture with a frame around the pixel in column `x` of row `y`, and lines that lead to it.
    pub fn marked(&self, x: u32, y: u32) -> Self {
        let is_mark = |column: u32, row: u32| {
            let (dx, dy) = (x.abs_diff(column), y.abs_diff(row));
            let away = dx.max(dy);
            (6..=7).contains(&away) || (8..22).contains(&away) && dx.min(dy) == 0
        };
        Self::from_fn(self.width, self.height, |column, row| {
            if is_mark(column, row) { [20, 20, 20] } else { self.get(column, row) }
        })
    }

    /// The picture as a PNG file.
    pub fn to_png(&self) -> Vec<u8> {
        let bytes: Vec<u8> = self.rgb.iter().flatten().copied().collect();
        let mut png = Vec::new();
        // Plates are mostly flat colour, which compresses best unfiltered.
        PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::NoFilter)
            .write_image(&bytes, self.width, self.height, ExtendedColorType::Rgb8)
            .expect("a picture has as many bytes as its size says, and memory takes them");
        png
    }

    /// The picture on a grid of `width` × `height` pixels, each the mean light of the area it covers.
    ///
    /// Enlarged by a whole factor this repeats pixels (nearest neighbour); by another factor pixels stay
    /// crisp with one blended row between them; shrunk it leaves out nothing.
    pub(crate) fn resampled(&self, width: u32, height: u32) -> Self {
        let columns = coverage(self.width, width);
        let rows = coverage(self.height, height);
        let light = linear_light();
        let stride = self.width as usize;
        let mut rgb = Vec::with_capacity(width as usize * height as usize);
        let mut mixed = vec![[0.0; 3]; stride];
        for row in &rows {
            for (x, mean) in mixed.iter_mut().enumerate() {
                *mean =
                    weighted(row, |y| self.rgb[y * stride + x].map(|byte| light[byte as usize]));
            }
            rgb.extend(columns.iter().map(|column| weighted(column, |x| mixed[x]).map(to_srgb)));
        }
        Self::new(width, height, rgb)
    }
}

/// For each of `to` equal parts of a line of `from` cells: the cells it covers, with the share of each.
fn coverage(from: u32, to: u32) -> Vec<Vec<(usize, f64)>> {
    // In units of 1 / (from · to) of the line all borders are integers, so shares are exact.
    let (from, to) = (u64::from(from), u64::from(to));
    (0..to)
        .map(|part| {
            let (begin, end) = (part * from, (part + 1) * from);
            (begin / to..end.div_ceil(to))
                .map(|cell| {
                    let shared = end.min((cell + 1) * to) - begin.max(cell * to);
                    (cell as usize, shared as f64 / from as f64)
                })
                .collect()
        })
        .collect()
}

fn weighted(shares: &[(usize, f64)], color: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
    shares.iter().fold([0.0; 3], |sum, &(cell, share)| {
        let color = color(cell);
        std::array::from_fn(|c| sum[c] + share * color[c])
    })
}

/// The linear light, from 0 to 1, of each sRGB byte.
pub(crate) fn linear_light() -> &'static [f64; 256] {
    static TABLE: OnceLock<[f64; 256]> = OnceLock::new();
    TABLE.get_or_init(|| std::array::from_fn(|byte| to_linear(byte as f64 / 255.0)))
}

fn to_linear(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB byte nearest (on the encoded scale) to a linear light.
fn to_srgb(light: f64) -> u8 {
    static LIMITS: OnceLock<[f64; 255]> = OnceLock::new();
    let limits =
        LIMITS.get_or_init(|| std::array::from_fn(|byte| to_linear((byte as f64 + 0.5) / 255.0)));
    limits.partition_point(|&limit| limit <= light) as u8
}

/// Bytes as base64 with padding, for data URIs.
pub(crate) fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let bits =
            (0..3).fold(0, |bits, i| bits << 8 | u32::from(group.get(i).copied().unwrap_or(0)));
        for digit in 0..4 {
            let value = bits >> (18 - 6 * digit) & 63;
            text.push(if digit > group.len() { '=' } else { ALPHABET[value as usize].into() });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checker(width: u32, height: u32) -> Picture {
        Picture::from_fn(
            width,
            height,
            |x, y| if (x + y) % 2 == 0 { [255; 3] } else { [0, 10, 200] },
        )
    }

    #[test]
    fn whole_factors_repeat_pixels() {
        let small = checker(3, 2);
        let large = small.resampled(12, 8);
        let repeated = Picture::from_fn(12, 8, |x, y| small.get(x / 4, y / 4));
        assert_eq!(large, repeated);
    }

    #[test]
    fn shrinking_averages_light_not_bytes() {
        let half_black = Picture::new(2, 1, vec![[0; 3], [255; 3]]);
        assert_eq!(
            half_black.resampled(1, 1).get(0, 0),
            [188; 3],
            "half the light of white in sRGB"
        );
    }

    #[test]
    fn shares_of_a_part_sum_to_one() {
        for (from, to) in [(7, 3), (3, 7), (5, 5), (1, 4)] {
            for part in coverage(from, to) {
                let sum: f64 = part.iter().map(|&(_, share)| share).sum();
                assert!((sum - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn base64_follows_rfc_4648() {
        let examples =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        for (plain, encoded) in examples {
            assert_eq!(base64(plain.as_bytes()), encoded);
        }
    }

    #[test]
    fn a_png_reads_back_as_the_picture() {
        let picture = checker(5, 4);
        let read = image::load_from_memory(&picture.to_png()).unwrap().to_rgb8();
        assert_eq!((read.width(), read.height()), (5, 4));
        assert!(read.pixels().map(|pixel| pixel.0).eq(picture.rgb.iter().copied()));
    }

    #[test]
    fn a_mark_leaves_its_pixel_to_be_seen() {
        let white = Picture::from_fn(40, 40, |_, _| [255; 3]);
        let marked = white.marked(2, 20);
        let is_dark = |x, y| marked.get(x, y) == [20; 3];
        assert!(
            !is_dark(2, 20) && !is_dark(7, 20) && !is_dark(2, 15),
            "the pixel and what is around"
        );
        assert!(is_dark(8, 20) && is_dark(9, 20) && is_dark(2, 14) && is_dark(8, 26), "a frame");
        assert!(is_dark(23, 20) && !is_dark(24, 20) && !is_dark(23, 21), "a line to it");
    }

    #[test]
    fn a_crop_is_the_part_asked_for() {
        let part = Picture::from_fn(8, 8, |x, y| [x as u8, y as u8, 0]).crop(2, 3, 4, 2);
        assert_eq!((part.width(), part.height()), (4, 2));
        assert_eq!((part.get(0, 0), part.get(3, 1)), ([2, 3, 0], [5, 4, 0]));
    }
}
