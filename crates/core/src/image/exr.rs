//! Writes a picture as an EXR file, and reads the one of an EXR file whose channels may have any names.

use std::io::{BufRead, Cursor, Seek};

use exr::block::reader::Reader;
use exr::math::Vec2;
use exr::meta::header::Header;
use exr::prelude::{
    ReadChannels, ReadLayers, ReadSpecificChannel, SpecificChannels, Text, WritableImage, read,
};

use super::Image;

/// The file of a picture: its channels R, G and B, bit for bit.
pub(super) fn encode(image: &Image) -> Result<Vec<u8>, exr::error::Error> {
    let [width, height] = [image.size.width, image.size.height].map(|side| side as usize);
    let pixel = |place: Vec2<usize>| {
        let [r, g, b] = image.pixels[place.y() * width + place.x()];
        (r, g, b)
    };
    let mut file = Cursor::new(Vec::new());
    exr::image::Image::from_channels((width, height), SpecificChannels::rgb(pixel))
        .write()
        // Several threads would write their blocks in the order in which these are ready.
        .non_parallel()
        .to_buffered(&mut file)?;
    Ok(file.into_inner())
}

/// An EXR file whose header is read.
pub(super) struct ExrFile<R> {
    reader: Reader<R>,
    channels: Channels,
    /// Columns and rows of the display window, which is the picture.
    pub(super) size: [usize; 2],
    /// Where the first pixel of the file's data is in the picture.
    offset: [i32; 2],
}

/// The channels that are the picture.
enum Channels {
    Rgb([Text; 3]),
    Grey(Text),
}

/// Why no picture could be read.
pub(super) enum ExrError {
    Damaged(exr::error::Error),
    /// Several layers have colours, and none is the picture: their names.
    Layers(Vec<String>),
    /// No channels are colours or a luminance: their names.
    Channels(Vec<String>),
}

impl From<exr::error::Error> for ExrError {
    fn from(error: exr::error::Error) -> Self {
        Self::Damaged(error)
    }
}

impl<R: BufRead + Seek> ExrFile<R> {
    /// Reads the header and chooses the picture, the first of these that there is: the channels R, G
    /// and B, the luminance Y, and the R, G and B of the only layer that has them (`beauty.R`).
    pub(super) fn open(source: R) -> Result<Self, ExrError> {
        let reader = exr::block::read(source, false)?;
        let (part, channels) = choose(reader.headers())?;
        let header = &reader.headers()[part];
        let window = header.shared_attributes.display_window;
        let offset = header.own_attributes.layer_position - window.position;
        Ok(Self {
            channels,
            size: [window.size.width(), window.size.height()],
            offset: [offset.x(), offset.y()],
            reader,
        })
    }

    /// The picture, row by row; pixels that the file does not have are black, and those beyond the
    /// display window are left out.
    pub(super) fn pixels(self) -> Result<Vec<[f32; 3]>, ExrError> {
        let ([width, height], offset) = (self.size, self.offset);
        let set = move |pixels: &mut Vec<[f32; 3]>, Vec2(x, y): Vec2<usize>, color: [f32; 3]| {
            let place = |at: usize, offset: i32, size: usize| {
                let place = i64::try_from(at).ok()? + i64::from(offset);
                usize::try_from(place).ok().filter(|&place| place < size)
            };
            if let (Some(x), Some(y)) = (place(x, offset[0], width), place(y, offset[1], height)) {
                pixels[y * width + x] = color;
            }
        };
        let channels = read().no_deep_data().largest_resolution_level().specific_channels();
        let pixels = match self.channels {
            Channels::Rgb([r, g, b]) => {
                let image = channels
                    .required(r)
                    .required(g)
                    .required(b)
                    .collect_pixels(
                        move |_, _| vec![[0.0; 3]; width * height],
                        move |pixels, at, (r, g, b): (f32, f32, f32)| set(pixels, at, [r, g, b]),
                    )
                    .first_valid_layer()
                    .all_attributes()
                    .from_chunks(self.reader)?;
                image.layer_data.channel_data.pixels
            }
            Channels::Grey(y) => {
                let image = channels
                    .required(y)
                    .collect_pixels(
                        move |_, _| vec![[0.0; 3]; width * height],
                        move |pixels, at, (y,): (f32,)| set(pixels, at, [y; 3]),
                    )
                    .first_valid_layer()
                    .all_attributes()
                    .from_chunks(self.reader)?;
                image.layer_data.channel_data.pixels
            }
        };
        Ok(pixels)
    }
}

/// The part of the file that has the picture, and the picture's channels.
fn choose(parts: &[Header]) -> Result<(usize, Channels), ExrError> {
    let names = |part: &Header| -> Vec<String> {
        part.channels.list.iter().map(|channel| channel.name.to_string()).collect()
    };
    let has = |part: &Header, wanted: &[String]| {
        let names = names(part);
        !part.deep && wanted.iter().all(|wanted| names.contains(wanted))
    };
    let text = |name: &String| Text::from(name.as_str());
    let of_layer = |layer: &str| ["R", "G", "B"].map(|channel| format!("{layer}{channel}"));
    let rgb = |part, layer: &str| (part, Channels::Rgb(of_layer(layer).each_ref().map(text)));

    if let Some(part) = parts.iter().position(|part| has(part, &of_layer(""))) {
        return Ok(rgb(part, ""));
    }
    let is_grey = |part: &Header| has(part, &["Y".to_owned()]) && !has(part, &["RY".to_owned()]);
    if let Some(part) = parts.iter().position(is_grey) {
        return Ok((part, Channels::Grey(Text::from("Y"))));
    }
    let mut layers: Vec<(usize, String)> = Vec::new();
    for (place, part) in parts.iter().enumerate() {
        let reds =
            names(part).into_iter().filter_map(|name| Some(name.strip_suffix('R')?.to_owned()));
        layers.extend(
            reds.filter(|layer| layer.ends_with('.') && has(part, &of_layer(layer)))
                .map(|layer| (place, layer)),
        );
    }
    match layers.as_slice() {
        [(part, layer)] => Ok(rgb(*part, layer)),
        [] => Err(ExrError::Channels(parts.iter().flat_map(names).collect())),
        _ => {
            let layers = layers.iter().map(|(_, layer)| layer.trim_end_matches('.').to_owned());
            Err(ExrError::Layers(layers.collect()))
        }
    }
}
