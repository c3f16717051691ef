use std::error::Error;
use std::fs::File;
use std::io::{self, BufReader, Cursor, ErrorKind};
use std::path::{Path, PathBuf};

use ::image::error::{EncodingError, ImageError as ImageCrateError};
use ::image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, RgbImage};
use thiserror::Error;

use super::exr::{self, ExrError, ExrFile};
use super::{Image, ImageSize, SizeError, WriteError, check_writable, srgb, write_atomically};

/// Why a picture was not saved or loaded.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The name ends in neither `.png` nor `.exr`.
    #[error("what kind of picture is `{}`? Its name must end in .png (sRGB) or .exr (linear)", path.display())]
    UnknownExtension {
        /// The picture file.
        path: PathBuf,
    },
    /// The exposure is infinite or NaN.
    #[error("cannot write `{}` with an exposure of {exposure_ev}: give a number of stops such as -1.5", path.display())]
    Exposure {
        /// The picture file.
        path: PathBuf,
        /// The exposure asked for, in stops.
        exposure_ev: f64,
    },
    /// The picture could not be put into its format.
    #[error("cannot write `{}`: the picture does not fit its format", path.display())]
    Encode {
        /// The picture file.
        path: PathBuf,
        /// What the encoder says.
        source: ::image::ImageError,
    },
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// There is no such file.
    #[error("there is no picture `{}`; check its name and the current folder", path.display())]
    Missing {
        /// The picture file.
        path: PathBuf,
    },
    /// A folder has that name.
    #[error("cannot read `{}`: it is a folder; name a picture in it", path.display())]
    IsFolder {
        /// The picture file.
        path: PathBuf,
    },
    /// The operating system refused to read the file.
    #[error("cannot read `{}`", path.display())]
    Read {
        /// The picture file.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// The bytes are no whole picture of the format.
    #[error("cannot decode `{}`: it is damaged, or of another format than its name tells: {reason}; make it anew", path.display())]
    Decode {
        /// The picture file.
        path: PathBuf,
        /// What the decoder says.
        reason: Box<dyn Error + Send + Sync>,
    },
    /// Several layers of an EXR file have colours, and none of them is the picture by its name.
    #[error("cannot read `{}`: which of its layers is the picture: {}? Keep one, or rename its channels R, G and B", path.display(), layers.join(", "))]
    Layers {
        /// The picture file.
        path: PathBuf,
        /// The layers' names.
        layers: Vec<String>,
    },
    /// An EXR file has neither colours nor a luminance.
    #[error("cannot read `{}`: there is no picture in its channels {}; save it with channels R, G and B, or Y", path.display(), channels.join(", "))]
    Channels {
        /// The picture file.
        path: PathBuf,
        /// The channels' names.
        channels: Vec<String>,
    },
    /// The picture would take more memory than [`MAX_BYTES`], whatever the size of its file.
    #[error("cannot read `{}`: a picture of {size} is too large: {bytes} bytes, the maximum is {MAX_BYTES}; make it smaller", path.display())]
    TooLarge {
        /// The picture file.
        path: PathBuf,
        /// Its size as it says.
        size: ImageSize,
        /// What it takes in memory.
        bytes: u64,
    },
    /// The file holds a picture of a size that we refuse.
    #[error("cannot read `{}`: {reason}", path.display())]
    Size {
        /// The picture file.
        path: PathBuf,
        /// What is wrong with its size.
        reason: SizeError,
    },
}

/// The most bytes of a picture that is loaded: 512 MiB, or 44 million pixels.
pub const MAX_BYTES: u64 = 1 << 29;

/// Saves a picture in the format that the file's name tells, in either case: `.png`, 8-bit sRGB
/// under this exposure as [`Image::to_srgb8`] gives it, or `.exr`, the linear `f32` channels bit
/// for bit. An EXR file holds radiances to measure, not a display's picture: the exposure is *not*
/// applied to it, just as other renderers do.
///
/// `exposure_ev` is in stops, 0 for none. An old file of that name is replaced whole or not at
/// all, see [`write_atomically`].
///
/// # Errors
/// If the extension is unknown, the exposure not finite, or the file cannot be written; every
/// message names the file.
pub fn save(path: impl AsRef<Path>, image: &Image, exposure_ev: f64) -> Result<(), ImageError> {
    let path = path.as_ref();
    let format = format_of(path)?;
    if !exposure_ev.is_finite() {
        return Err(ImageError::Exposure { path: path.into(), exposure_ev });
    }
    let bytes = encode(image, format, exposure_ev)
        .map_err(|source| ImageError::Encode { path: path.into(), source })?;
    Ok(write_atomically(path, &bytes)?)
}

/// Refuses a name under which [`save`] could not write, before the picture is computed.
///
/// # Errors
/// As [`save`], but for a disk that fills up in the meantime.
pub fn check_target(path: impl AsRef<Path>) -> Result<(), ImageError> {
    format_of(path.as_ref())?;
    Ok(check_writable(path)?)
}

/// Loads a picture in the format that the file's name tells, in either case: `.png`, of 8 or 16
/// bits, colour or grey, taken as sRGB and decoded to linear, or `.exr`, taken as linear: its
/// channels R, G and B, or its luminance Y as grey, or the colours of its only layer. Alpha is left
/// out.
///
/// # Errors
/// If the extension is unknown or the file cannot be read, is no whole picture of its format, or
/// would take more than [`MAX_BYTES`]; every message names the file.
pub fn load(path: impl AsRef<Path>) -> Result<Image, ImageError> {
    let path = path.as_ref();
    let format = format_of(path)?;
    if path.is_dir() {
        return Err(ImageError::IsFolder { path: path.into() });
    }
    let file = File::open(path).map_err(|source| {
        let path = path.to_owned();
        match source.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => ImageError::Missing { path },
            _ => ImageError::Read { path, source },
        }
    })?;
    let damaged =
        |reason: Box<dyn Error + Send + Sync>| ImageError::Decode { path: path.into(), reason };
    let checked = |width: usize, height: usize, bytes: u64| {
        let size = ImageSize::checked(width as u64, height as u64)
            .map_err(|reason| ImageError::Size { path: path.into(), reason })?;
        let bytes = bytes.max((size.pixels() * size_of::<[f32; 3]>()) as u64);
        if bytes > MAX_BYTES {
            return Err(ImageError::TooLarge { path: path.into(), size, bytes });
        }
        Ok(size)
    };
    let file = BufReader::new(file);
    if format == ImageFormat::OpenExr {
        let unread = |error| match error {
            ExrError::Damaged(error) => damaged(error.into()),
            ExrError::Layers(layers) => ImageError::Layers { path: path.into(), layers },
            ExrError::Channels(channels) => ImageError::Channels { path: path.into(), channels },
        };
        let file = ExrFile::open(file).map_err(unread)?;
        let [width, height] = file.size;
        let size = checked(width, height, 0)?;
        return Ok(Image::from_pixels(size, file.pixels().map_err(unread)?));
    }
    let decoder = ImageReader::with_format(file, format)
        .into_decoder()
        .map_err(|reason| damaged(reason.into()))?;
    let (width, height) = decoder.dimensions();
    let size = checked(width as usize, height as usize, decoder.total_bytes())?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(|reason| damaged(reason.into()))?;
    Ok(Image::from_pixels(size, linear_pixels(&decoded)))
}

fn format_of(path: &Path) -> Result<ImageFormat, ImageError> {
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("png") => Ok(ImageFormat::Png),
        Some(extension) if extension.eq_ignore_ascii_case("exr") => Ok(ImageFormat::OpenExr),
        _ => Err(ImageError::UnknownExtension { path: path.into() }),
    }
}

fn encode(image: &Image, format: ImageFormat, ev: f64) -> Result<Vec<u8>, ImageCrateError> {
    if format == ImageFormat::OpenExr {
        return exr::encode(image)
            .map_err(|error| ImageCrateError::Encoding(EncodingError::new(format.into(), error)));
    }
    let ImageSize { width, height } = image.size;
    let picture = RgbImage::from_raw(width, height, image.to_srgb8(ev).into_flattened());
    let picture = picture.expect("an Image has width × height pixels");
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format)?;
    Ok(bytes.into_inner())
}

fn linear_pixels(decoded: &DynamicImage) -> Vec<[f32; 3]> {
    // Exact for 8-bit levels too: v/255 = 257·v/65535.
    let linear: Vec<f32> =
        (0..=u16::MAX).map(|v| srgb::decode(f64::from(v) / 65535.0) as f32).collect();
    let channel = |level: u16| linear[usize::from(level)];
    decoded.to_rgb16().pixels().map(|pixel| pixel.0.map(channel)).collect()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_picture_that_cannot_be_encoded_leaves_the_old_one() {
        let folder = tempfile::tempdir().unwrap();
        let empty = Image::new(ImageSize { width: 0, height: 0 });
        for name in ["old.png", "old.exr"] {
            let path = folder.path().join(name);
            fs::write(&path, "old").unwrap();
            let error = save(&path, &empty, 0.0).unwrap_err();
            assert!(matches!(error, ImageError::Encode { .. }), "{error:?}");
            assert!(error.to_string().contains(name), "{error}");
            assert_eq!(fs::read(&path).unwrap(), b"old");
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    /// The encoder must not write its blocks in the order in which threads have them ready.
    #[test]
    fn a_picture_makes_the_same_file_every_time() {
        let size = ImageSize::new(300, 300);
        // Some blocks are compressed sooner than others.
        let pixel = |k: usize| [k as f32, if k < 40_000 { 0.5 } else { 1.0 / k as f32 }, 0.25];
        let image = Image::from_pixels(size, (0..size.pixels()).map(pixel).collect());
        let file = || encode(&image, ImageFormat::OpenExr, 0.0).unwrap();
        let first = file();
        assert!((0..50).all(|_| file() == first));
    }
}
