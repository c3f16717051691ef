//! The loop over the picture. Tiles go to threads in any order; each pixel is computed by one of them
//! alone, from its coordinates, so the picture has the same bits for any number of threads.

use std::ops::AddAssign;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::DVec2;
use rayon::prelude::*;

use crate::Rgb;
use crate::image::{Image, ImageSize};
use crate::sampling::PixelSampling;

/// How a rendering is run; none of it changes the picture.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Side of the tiles handed to threads, in pixels, at least 1.
    pub tile: u32,
    /// Told after each tile how many pixels are done, from any thread.
    pub progress: &'a (dyn Fn(u64) + Sync),
    /// Set by anyone to stop early.
    pub cancelled: &'a AtomicBool,
}

static NEVER: AtomicBool = AtomicBool::new(false);

impl Default for Control<'_> {
    /// Tiles of 16 pixels, unwatched, until the end.
    fn default() -> Self {
        Self { tile: 16, progress: &|_| (), cancelled: &NEVER }
    }
}

/// A picture and what it took to compute it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendering<C> {
    /// The picture.
    pub image: Image,
    /// Deterministic counts of the work, summed over all tiles.
    pub counts: C,
}

/// The rendering was stopped before it was complete.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("rendering was cancelled")]
pub struct Cancelled;

/// A rectangle of the picture on its way to being filled.
#[derive(Debug)]
pub struct Tile {
    /// Column of its first pixel in the picture.
    pub x: u32,
    /// Row of its first pixel in the picture.
    pub y: u32,
    /// Width and height.
    pub size: ImageSize,
    pixels: Vec<[f32; 3]>,
}

impl Tile {
    /// Sets the pixel in column `x` and row `y` of the *picture*.
    #[inline]
    pub fn set(&mut self, x: u32, y: u32, radiance: Rgb) {
        let index = (y - self.y) as usize * self.size.width as usize + (x - self.x) as usize;
        self.pixels[index] = radiance.as_vec3().to_array();
    }
}

/// Renders tile by tile: `fill` computes every pixel of the tile it is given.
///
/// # Errors
/// [`Cancelled`] if [`Control::cancelled`] was set before the last tile was done.
pub fn render_tiles<C: AddAssign + Default + Send>(
    size: ImageSize,
    control: Control,
    fill: impl Fn(&mut Tile, &mut C) + Sync,
) -> Result<Rendering<C>, Cancelled> {
    let across = size.width.div_ceil(control.tile);
    let down = size.height.div_ceil(control.tile);
    let pixels_done = AtomicU64::new(0);
    let tiles: Option<Vec<(Tile, C)>> = (0..across * down)
        .into_par_iter()
        .map(|index| {
            if control.cancelled.load(Ordering::Relaxed) {
                return None;
            }
            let (x, y) = (index % across * control.tile, index / across * control.tile);
            let width = control.tile.min(size.width - x);
            let height = control.tile.min(size.height - y);
            let size = ImageSize::new(width, height);
            let mut tile = Tile { x, y, size, pixels: vec![[0.0; 3]; size.pixels()] };
            let mut counts = C::default();
            fill(&mut tile, &mut counts);
            let pixels = size.pixels() as u64;
            (control.progress)(pixels_done.fetch_add(pixels, Ordering::Relaxed) + pixels);
            Some((tile, counts))
        })
        .collect();

    let mut rendering = Rendering { image: Image::new(size), counts: C::default() };
    let tiles = tiles.filter(|_| !control.cancelled.load(Ordering::Relaxed)).ok_or(Cancelled)?;
    for (tile, counts) in tiles {
        rendering.image.paste(tile.x, tile.y, tile.size, &tile.pixels);
        rendering.counts += counts;
    }
    Ok(rendering)
}

/// Renders pixel by pixel: `radiance` answers for one film point, in pixels, and a pixel is the mean
/// of its samples, summed in `f64` in their order.
///
/// # Errors
/// As [`render_tiles`].
pub fn render_pixels<C: AddAssign + Default + Send>(
    size: ImageSize,
    sampling: PixelSampling,
    control: Control,
    radiance: impl Fn(DVec2, &mut C) -> Rgb + Sync,
) -> Result<Rendering<C>, Cancelled> {
    render_tiles(size, control, |tile, counts| {
        for y in tile.y..tile.y + tile.size.height {
            for x in tile.x..tile.x + tile.size.width {
                // A pixel of many samples may take long.
                if control.cancelled.load(Ordering::Relaxed) {
                    return;
                }
                let sum: Rgb = sampling.points(x, y).map(|film| radiance(film, counts)).sum();
                tile.set(x, y, sum / f64::from(sampling.samples));
            }
        }
    })
}
