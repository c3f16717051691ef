use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// The width and height of a picture in pixels, both at least 1, and at most 2²⁸ pixels in all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ImageSize {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

/// Why two numbers are not the size of a picture.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SizeError {
    /// The text is not two whole numbers with an `x` between them.
    #[error("`{text}` is no picture size: write WIDTHxHEIGHT in pixels, such as 512x384")]
    Syntax {
        /// What was written.
        text: String,
    },
    /// There is no pixel.
    #[error("a picture of {width}x{height} has no pixel: both numbers must be at least 1")]
    Empty {
        /// Pixels across.
        width: u64,
        /// Pixels down.
        height: u64,
    },
    /// There are more pixels than memory.
    #[error(
        "a picture of {width}x{height} is too large: at most {} pixels (16384x16384)",
        ImageSize::MAX_PIXELS
    )]
    TooLarge {
        /// Pixels across.
        width: u64,
        /// Pixels down.
        height: u64,
    },
}

impl ImageSize {
    /// The largest number of pixels: 3 GiB of an [`Image`](super::Image).
    pub const MAX_PIXELS: u64 = 1 << 28;

    /// A picture of `width` × `height` pixels, for sizes that stand in the code.
    ///
    /// # Panics
    /// If [`ImageSize::checked`] refuses the size.
    pub const fn new(width: u32, height: u32) -> Self {
        let pixels = width as u64 * height as u64;
        assert!(0 < pixels && pixels <= Self::MAX_PIXELS, "a picture has 1 to 2^28 pixels");
        Self { width, height }
    }

    /// A picture of `width` × `height` pixels, for sizes that come from outside.
    ///
    /// # Errors
    /// If there are no pixels, or more than [`ImageSize::MAX_PIXELS`].
    pub fn checked(width: u64, height: u64) -> Result<Self, SizeError> {
        if width == 0 || height == 0 {
            Err(SizeError::Empty { width, height })
        } else if width.saturating_mul(height) > Self::MAX_PIXELS {
            Err(SizeError::TooLarge { width, height })
        } else {
            Ok(Self::new(width as u32, height as u32))
        }
    }

    /// The number of pixels.
    pub const fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }
}

impl FromStr for ImageSize {
    type Err = SizeError;

    /// Reads `512x384`, with a small or a capital x.
    fn from_str(text: &str) -> Result<Self, SizeError> {
        let numbers = text.split_once(['x', 'X']).and_then(|(width, height)| {
            Some((width.parse::<u64>().ok()?, height.parse::<u64>().ok()?))
        });
        let Some((width, height)) = numbers else {
            return Err(SizeError::Syntax { text: text.to_owned() });
        };
        Self::checked(width, height)
    }
}

impl fmt::Display for ImageSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_written() {
        for (text, width, height) in
            [("512x384", 512, 384), ("1X1", 1, 1), ("16384x16384", 16384, 16384)]
        {
            let size: ImageSize = text.parse().unwrap();
            assert_eq!((size.width, size.height), (width, height));
            assert_eq!(size.to_string(), text.to_lowercase());
        }
    }

    #[test]
    fn other_texts_are_refused() {
        for text in [
            "",
            "x",
            "512",
            "512x",
            "x512",
            "-1x5",
            "5x5x5",
            "5.5x5",
            "5 x 5",
            "99999999999999999999x1",
        ] {
            let error = text.parse::<ImageSize>().unwrap_err();
            assert_eq!(error, SizeError::Syntax { text: text.to_owned() });
        }
    }

    #[test]
    fn empty_and_absurd_sizes_are_refused_with_both_numbers() {
        for text in ["0x0", "0x480", "640x0", "16385x16384", "5000000000x4294967296", "268435457x1"]
        {
            let error = text.parse::<ImageSize>().unwrap_err();
            assert!(!matches!(error, SizeError::Syntax { .. }), "{error}");
            assert!(error.to_string().contains(text), "{error}");
        }
    }

    #[test]
    #[should_panic(expected = "1 to 2^28 pixels")]
    fn a_size_in_the_code_without_pixels_panics() {
        ImageSize::new(3, 0);
    }
}
