//! The loop over the picture. Tiles go to threads in any order; each pixel is computed by one of them
//! alone, from its coordinates, so the picture has the same bits for any number of threads.

use std::ops::AddAssign;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::DVec2;
use rayon::prelude::*;

use crate::Rgb;
use crate::geometry::{Interval, Ray};
use crate::image::{Image, ImageSize};
use crate::intersector::Hit;
use crate::sampling::PixelSampling;
use crate::scene::PrimaryRays;
use crate::world::World;

/// How a rendering is run; none of it changes the picture.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Side of the tiles handed to threads, in pixels, at least 1.
    pub tile: u32,
    /// Told after each tile how many pixels of the pass are done, from any thread.
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
        self.pixels[index] = radiance.to_array().map(narrow);
    }

    /// Column and row in the picture of one of its pixels, counted row by row.
    fn place(&self, pixel: usize) -> (u32, u32) {
        let (pixel, width) = (pixel as u32, self.size.width);
        (self.x + pixel % width, self.y + pixel / width)
    }

    /// Sets the wanted pixels; stops early when cancelled, since a pixel of many samples may take long.
    fn fill<C>(
        &mut self,
        sampling: PixelSampling,
        control: Control,
        wanted: impl Fn(u32, u32) -> bool,
        film: &impl Film<C>,
        counts: &mut C,
    ) {
        let mut sums = vec![Rgb::ZERO; self.pixels.len()];
        let (mut points, mut owners) = (Vec::with_capacity(BATCH), Vec::with_capacity(BATCH));
        let mut answers = vec![Rgb::ZERO; BATCH];
        let mut flush = |points: &mut Vec<DVec2>, owners: &mut Vec<usize>| {
            let answers = &mut answers[..points.len()];
            film.radiance(points, answers, counts);
            for (owner, answer) in owners.drain(..).zip(answers) {
                sums[owner] += *answer;
            }
            points.clear();
        };
        for (column, row) in neighbours_together(self.size) {
            let (x, y) = (self.x + column, self.y + row);
            if !wanted(x, y) {
                continue;
            }
            for point in sampling.points(x, y) {
                points.push(point);
                owners.push((row * self.size.width + column) as usize);
                if points.len() == BATCH {
                    if control.cancelled.load(Ordering::Relaxed) {
                        return;
                    }
                    flush(&mut points, &mut owners);
                }
            }
        }
        flush(&mut points, &mut owners);
        for (owner, sum) in sums.into_iter().enumerate() {
            let (x, y) = self.place(owner);
            if wanted(x, y) {
                self.set(x, y, sum / f64::from(sampling.samples));
            }
        }
    }
}

/// Samples that are answered at once, at most.
const BATCH: usize = 256;

/// Columns and rows of a rectangle along Morton's curve, the order in which a tile is rendered: 64 in a row
/// are a square of 8 × 8, or close to each other.
pub fn neighbours_together(size: ImageSize) -> impl Iterator<Item = (u32, u32)> {
    let side = u64::from(size.width.max(size.height).next_power_of_two());
    let places = (0..side * side).map(|code| (every_second_bit(code), every_second_bit(code >> 1)));
    places.filter(move |&(x, y)| x < size.width && y < size.height)
}

/// Bits 0, 2, 4, … of a number, moved together.
fn every_second_bit(code: u64) -> u32 {
    let mut bits = code & 0x5555_5555_5555_5555;
    for (shift, mask) in [
        (1, 0x3333_3333_3333_3333),
        (2, 0x0f0f_0f0f_0f0f_0f0f),
        (4, 0x00ff_00ff_00ff_00ff),
        (8, 0x0000_ffff_0000_ffff),
        (16, 0xffff_ffff),
    ] {
        bits = (bits | bits >> shift) & mask;
    }
    bits as u32
}

/// What arrives at points of the film. A function of one point, in pixels, and the counts is one;
/// [`Seen`] is another.
pub trait Film<C>: Sync {
    /// The radiance at each point, into the slice of the same length.
    fn radiance(&self, points: &[DVec2], radiance: &mut [Rgb], counts: &mut C);
}

impl<C, F: Fn(DVec2, &mut C) -> Rgb + Sync> Film<C> for F {
    fn radiance(&self, points: &[DVec2], radiance: &mut [Rgb], counts: &mut C) {
        for (point, radiance) in points.iter().zip(radiance) {
            *radiance = self(*point, counts);
        }
    }
}

/// What the scene's camera sees: primary rays are answered together, which is faster with some indexes;
/// `shade` tells what comes back along each.
pub struct Seen<'a, F> {
    world: World<'a>,
    rays: PrimaryRays,
    shade: F,
}

impl<'a, F> Seen<'a, F> {
    /// For pictures of one size.
    pub fn new<C>(world: World<'a>, size: ImageSize, shade: F) -> Self
    where
        F: Fn(&Ray, Option<Hit>, &mut C) -> Rgb,
    {
        Self { world, rays: world.scene.camera.primary_rays(size), shade }
    }
}

impl<C, F: Fn(&Ray, Option<Hit>, &mut C) -> Rgb + Sync> Film<C> for Seen<'_, F> {
    fn radiance(&self, points: &[DVec2], radiance: &mut [Rgb], counts: &mut C) {
        let rays: Vec<Ray> =
            points.iter().map(|point| self.rays.through(point.x, point.y)).collect();
        let mut hits = vec![None; rays.len()];
        self.world.index.closest_hits(&rays, Interval::POSITIVE, &mut hits);
        for ((ray, hit), radiance) in rays.iter().zip(hits).zip(radiance) {
            *radiance = (self.shade)(ray, hit, counts);
        }
    }
}

/// The nearest `f32`. A radiance beyond its range, next to a lamp, becomes the largest number there is;
/// what is not finite stays so, to be counted.
fn narrow(channel: f64) -> f32 {
    if channel.is_finite() {
        channel.clamp(f32::MIN.into(), f32::MAX.into()) as f32
    } else {
        channel as f32
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

/// Renders pixel by pixel: a pixel is the mean of its samples, summed in `f64` in their order.
///
/// # Errors
/// As [`render_tiles`].
pub fn render_pixels<C: AddAssign + Default + Send>(
    size: ImageSize,
    sampling: PixelSampling,
    control: Control,
    film: impl Film<C>,
) -> Result<Rendering<C>, Cancelled> {
    render_tiles(size, control, |tile, counts| {
        tile.fill(sampling, control, |_, _| true, &film, counts);
    })
}

/// Renders pixels in detail only where the picture has some: first the centre of each, then all
/// `sampling` samples of those whose displayed value differs from a neighbour's above, below, left or
/// right by more than `contrast` (0 to 1, of the display's range, in any channel). Source: Whitted, *An Improved
/// Illumination Model for Shaded Display*, 1980, § « Anti-aliasing », which compares a pixel's corners.
///
/// What lies between the centres of equal pixels is missed, so this trades unbiased pixels for speed.
/// [`Control::progress`] is told of each of the two passes over the picture.
///
/// # Errors
/// As [`render_tiles`].
pub fn render_adaptive<C: AddAssign + Default + Send>(
    size: ImageSize,
    sampling: PixelSampling,
    contrast: f64,
    control: Control,
    film: impl Film<C>,
) -> Result<Rendering<C>, Cancelled> {
    let centers = render_tiles(size, control, |tile, counts| {
        tile.fill(PixelSampling::CENTER, control, |_, _| true, &film, counts);
    })?;
    let detailed = detailed(&centers.image, contrast);
    let is_detailed = |x: u32, y: u32| detailed[(y * size.width + x) as usize];
    let mut refined = render_tiles(size, control, |tile, counts| {
        tile.fill(sampling, control, is_detailed, &film, counts);
        for pixel in 0..tile.size.pixels() {
            let (x, y) = tile.place(pixel);
            if !is_detailed(x, y) {
                tile.set(x, y, centers.image.get(x, y));
            }
        }
    })?;
    refined.counts += centers.counts;
    Ok(refined)
}

/// Which pixels differ from a direct neighbour by more than `contrast` on a display.
fn detailed(image: &Image, contrast: f64) -> Vec<bool> {
    let (width, levels) = (image.size().width as usize, image.to_srgb8(0.0));
    let differ = |a: usize, b: usize| {
        let steps = (0..3).map(|k| levels[a][k].abs_diff(levels[b][k])).max();
        f64::from(steps.unwrap_or(0)) > 255.0 * contrast
    };
    let mut detailed = vec![false; levels.len()];
    for pixel in 0..levels.len() {
        let right = ((pixel + 1) % width != 0).then_some(pixel + 1);
        let below = (pixel + width < levels.len()).then_some(pixel + width);
        for neighbour in [right, below].into_iter().flatten() {
            if differ(pixel, neighbour) {
                (detailed[pixel], detailed[neighbour]) = (true, true);
            }
        }
    }
    detailed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Pattern;

    /// Counts samples.
    fn half_plane(film: DVec2, samples: &mut u64) -> Rgb {
        *samples += 1;
        if film.x + 0.3 * film.y < 9.7 { Rgb::ONE } else { Rgb::ZERO }
    }

    /// A faulty sample is not spread over its neighbours, and a radiance beyond `f32` is no fault.
    #[test]
    fn a_nan_stains_one_pixel_and_a_huge_radiance_none() {
        let size = ImageSize::new(9, 7);
        for faulty in [f64::NAN, f64::INFINITY, 1e40, 1e300] {
            let first = AtomicBool::new(true);
            let radiance = |film: DVec2, _: &mut u64| {
                let here = film.floor() == DVec2::new(4.0, 3.0);
                Rgb::splat(if here && first.swap(false, Ordering::Relaxed) { faulty } else { 0.5 })
            };
            let sampling = PixelSampling { pattern: Pattern::Owen, samples: 4, seed: 1 };
            let rendering = render_pixels(size, sampling, Control::default(), radiance).unwrap();
            let defects = rendering.image.defects();
            let expected = usize::from(!faulty.is_finite());
            assert_eq!((defects.not_finite, defects.negative), (expected, 0), "{faulty}");
            if expected == 0 {
                assert_eq!(rendering.image.get(4, 3), Rgb::splat(f32::MAX.into()));
            }
            assert_eq!(rendering.image.get(5, 3), Rgb::splat(0.5));
        }
    }

    #[test]
    fn all_pixels_come_once_and_neighbours_together() {
        for size in [ImageSize::new(16, 16), ImageSize::new(5, 13), ImageSize::new(1, 1)] {
            let places: Vec<_> = neighbours_together(size).collect();
            let all: std::collections::HashSet<_> = places.iter().copied().collect();
            assert_eq!((places.len(), all.len()), (size.pixels(), size.pixels()));
            assert!(places.iter().all(|&(x, y)| x < size.width && y < size.height));
        }
        let places: Vec<_> = neighbours_together(ImageSize::new(16, 16)).collect();
        for block in places.chunks(64) {
            let (x, y) = (block[0].0 / 8, block[0].1 / 8);
            assert!(block.iter().all(|place| (place.0 / 8, place.1 / 8) == (x, y)));
        }
    }

    #[test]
    fn only_pixels_at_an_edge_are_refined_and_those_fully() {
        let size = ImageSize::new(16, 8);
        let sampling = PixelSampling { pattern: Pattern::Owen, samples: 64, seed: 5 };
        let control = Control::default();
        let adaptive = render_adaptive(size, sampling, 0.1, control, half_plane).unwrap();
        let full = render_pixels(size, sampling, control, half_plane).unwrap();
        let center = render_pixels(size, PixelSampling::CENTER, control, half_plane).unwrap();
        let mut refined = 0;
        for y in 0..8 {
            for x in 0..16 {
                let value = |x: i64, y: i64| {
                    let inside = (0..16).contains(&x) && (0..8).contains(&y);
                    inside.then(|| center.image.get(x as u32, y as u32))
                };
                let here = value(x, y);
                let beside = [value(x - 1, y), value(x + 1, y), value(x, y - 1), value(x, y + 1)];
                let at_edge = beside.iter().any(|v| v.is_some() && *v != here);
                let (x, y) = (x as u32, y as u32);
                refined += u64::from(at_edge);
                let wanted = if at_edge { full.image.get(x, y) } else { center.image.get(x, y) };
                assert_eq!(adaptive.image.get(x, y), wanted, "{x} {y}");
            }
        }
        assert!((16..40).contains(&refined), "{refined}");
        assert_eq!(adaptive.counts, 16 * 8 + 64 * refined);
    }

    #[test]
    fn a_flat_picture_costs_one_sample_per_pixel() {
        let sampling = PixelSampling { pattern: Pattern::Owen, samples: 64, seed: 5 };
        let flat = |_: DVec2, samples: &mut u64| {
            *samples += 1;
            Rgb::splat(0.5)
        };
        let size = ImageSize::new(5, 7);
        let rendering = render_adaptive(size, sampling, 0.0, Control::default(), flat).unwrap();
        assert_eq!(rendering.counts, 35);
    }
}
