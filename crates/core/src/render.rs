//! The loop over the picture. Tiles go to threads in any order; each pixel is computed by one of them
//! alone, from its coordinates, so the picture has the same bits for any number of threads.

mod estimator;

use std::ops::AddAssign;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;

use crate::Rgb;
use crate::image::{Image, ImageSize};
use crate::sampling::{PixelSampling, Sample};
pub use estimator::{AlongRays, Estimator, PrimaryHits};

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

impl Control<'_> {
    /// Whether to stop: what fills a tile for long asks now and then.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
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

/// A picture in the making: for each pixel the sum of its samples in `f64`, in their order, and their number.
///
/// A picture that is continued with the sampling that it began with has the bits of one that never was
/// interrupted, be it after it was cancelled or, by [`Pattern::Owen`](crate::sampling::Pattern), with more samples: the
/// grids of the other patterns follow from the number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Film<C> {
    size: ImageSize,
    tiles: Vec<Tile<C>>,
}

/// A rectangle of a [`Film`], which one thread fills.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile<C> {
    /// Column of its first pixel in the picture.
    pub x: u32,
    /// Row of its first pixel in the picture.
    pub y: u32,
    /// Width and height.
    pub size: ImageSize,
    /// Counts of the work in it.
    pub counts: C,
    sums: Vec<Rgb>,
    taken: Vec<u32>,
}

impl<C: AddAssign + Default + Send> Film<C> {
    /// A black picture, in tiles of so many pixels a side, at least 1.
    pub fn new(size: ImageSize, side: u32) -> Self {
        let (across, down) = (size.width.div_ceil(side), size.height.div_ceil(side));
        let tile = |index: u32| {
            let (x, y) = (index % across * side, index / across * side);
            let size = ImageSize::new(side.min(size.width - x), side.min(size.height - y));
            // The thread that fills it makes its room.
            Tile { x, y, size, counts: C::default(), sums: Vec::new(), taken: Vec::new() }
        };
        Self { size, tiles: (0..across * down).map(tile).collect() }
    }

    /// Goes through all tiles: `fill` sets or samples as many pixels of the tile as it likes.
    ///
    /// # Errors
    /// [`Cancelled`] if [`Control::cancelled`] was set before the last tile was done.
    pub fn fill(
        &mut self,
        control: Control,
        fill: impl Fn(&mut Tile<C>) + Sync,
    ) -> Result<(), Cancelled> {
        let done = AtomicU64::new(0);
        self.tiles.par_iter_mut().for_each(|tile| tile.pass(control, &done, &fill));
        if control.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// Samples all pixels as [`Tile::sample`] does.
    ///
    /// # Errors
    /// As [`Film::fill`].
    pub fn sample(
        &mut self,
        sampling: PixelSampling,
        control: Control,
        estimator: &impl Estimator<C>,
    ) -> Result<(), Cancelled> {
        self.fill(control, |tile| tile.sample(sampling, control, |_, _| true, estimator))
    }

    /// How many samples are in each pixel, as a grey picture.
    pub fn samples(&self) -> Image {
        let mut image = Image::new(self.size);
        for tile in &self.tiles {
            let mut pixels: Vec<[f32; 3]> = tile.taken.iter().map(|&n| [n as f32; 3]).collect();
            pixels.resize(tile.size.pixels(), [0.0; 3]);
            image.paste(tile.x, tile.y, tile.size, &pixels);
        }
        image
    }

    /// The picture as it stands: a pixel is the mean of its samples, black without any.
    pub fn finish(self) -> Rendering<C> {
        Self::assembled(self.size, self.tiles.into_par_iter().map(Tile::developed).collect())
    }

    /// [`Film::fill`] and [`Film::finish`] in one: the sums of a tile are given back as soon as it is done.
    ///
    /// # Errors
    /// As [`Film::fill`].
    fn fill_and_finish(
        self,
        control: Control,
        fill: impl Fn(&mut Tile<C>) + Sync,
    ) -> Result<Rendering<C>, Cancelled> {
        let done = AtomicU64::new(0);
        let developed = |mut tile: Tile<C>| {
            tile.pass(control, &done, &fill);
            tile.developed()
        };
        let tiles = self.tiles.into_par_iter().map(developed).collect();
        if control.is_cancelled() { Err(Cancelled) } else { Ok(Self::assembled(self.size, tiles)) }
    }

    fn assembled(size: ImageSize, tiles: Vec<Developed<C>>) -> Rendering<C> {
        let (mut image, mut counts) = (Image::new(size), C::default());
        for tile in tiles {
            image.paste(tile.x, tile.y, tile.size, &tile.pixels);
            counts += tile.counts;
        }
        Rendering { image, counts }
    }
}

/// A tile whose sums have become pixels.
struct Developed<C> {
    x: u32,
    y: u32,
    size: ImageSize,
    pixels: Vec<[f32; 3]>,
    counts: C,
}

impl<C> Tile<C> {
    /// Sets the pixel in column `x` and row `y` of the *picture* to a radiance that is known: it counts as one
    /// sample, whatever was there.
    #[inline]
    pub fn set(&mut self, x: u32, y: u32, radiance: Rgb) {
        let index = self.index(x, y);
        (self.sums[index], self.taken[index]) = (radiance, 1);
    }

    /// Where the pixel in column `x` and row `y` of the picture stands among its own.
    #[inline]
    fn index(&self, x: u32, y: u32) -> usize {
        (y - self.y) as usize * self.size.width as usize + (x - self.x) as usize
    }

    /// Columns and rows in the picture of its pixels, row by row.
    pub fn places(&self) -> impl Iterator<Item = (u32, u32)> + use<C> {
        let (x, y, size) = (self.x, self.y, self.size);
        (y..y + size.height)
            .flat_map(move |row| (x..x + size.width).map(move |column| (column, row)))
    }

    /// Takes the samples of the wanted pixels that they still lack. It stops early when cancelled, since a
    /// pixel of many samples may take long; what has been taken by then stays.
    pub fn sample(
        &mut self,
        sampling: PixelSampling,
        control: Control,
        wanted: impl Fn(u32, u32) -> bool,
        estimator: &impl Estimator<C>,
    ) {
        let mut samples = Vec::with_capacity(BATCH);
        let mut answers = vec![Rgb::ZERO; BATCH];
        for (column, row) in neighbours_together(self.size) {
            let (x, y) = (self.x + column, self.y + row);
            if !wanted(x, y) {
                continue;
            }
            let taken = self.taken[self.index(x, y)];
            for sample in sampling.some_of_pixel(x, y, taken..sampling.samples) {
                samples.push(sample);
                if samples.len() == BATCH {
                    if control.is_cancelled() {
                        return;
                    }
                    self.answer(&mut samples, &mut answers, estimator);
                }
            }
        }
        self.answer(&mut samples, &mut answers, estimator);
    }

    /// Adds what arrives at samples to the pixels that own them.
    fn answer(
        &mut self,
        samples: &mut Vec<Sample>,
        answers: &mut [Rgb],
        estimator: &impl Estimator<C>,
    ) {
        let answers = &mut answers[..samples.len()];
        estimator.radiance(samples, answers, &mut self.counts);
        for (sample, answer) in samples.drain(..).zip(answers) {
            let [x, y] = sample.pixel;
            let index = self.index(x, y);
            self.sums[index] += *answer;
            self.taken[index] += 1;
        }
    }

    /// Lets `fill` go through the tile unless it is cancelled, and tells how many pixels are done by then.
    fn pass(&mut self, control: Control, done: &AtomicU64, fill: &impl Fn(&mut Self)) {
        if control.is_cancelled() {
            return;
        }
        let pixels = self.size.pixels();
        self.sums.resize(pixels, Rgb::ZERO);
        self.taken.resize(pixels, 0);
        fill(self);
        let pixels = pixels as u64;
        (control.progress)(done.fetch_add(pixels, Ordering::Relaxed) + pixels);
    }

    /// The means as they are stored.
    fn developed(mut self) -> Developed<C> {
        let pixels = self.size.pixels();
        self.sums.resize(pixels, Rgb::ZERO);
        self.taken.resize(pixels, 0);
        let Self { x, y, size, counts, sums, taken } = self;
        let mean = |(sum, taken): (Rgb, &u32)| (sum / f64::from((*taken).max(1))).to_array();
        let means = sums.into_iter().zip(&taken).map(mean);
        let pixels = means.map(|mean| mean.map(narrow)).collect();
        Developed { x, y, size, pixels, counts }
    }
}

/// Samples that are answered at once, at most: with their rays, hits and radiances they fit into the first cache.
const BATCH: usize = 128;

/// Columns and rows of a rectangle along Morton's curve, the order in which a tile is rendered: 64 in a row
/// are a square of 8 × 8, or close to each other.
pub fn neighbours_together(size: ImageSize) -> impl Iterator<Item = (u32, u32)> {
    let side = u64::from(size.width.max(size.height).next_power_of_two());
    (0..side * side).map(place).filter(move |&(x, y)| x < size.width && y < size.height)
}

/// Column and row of a place on Morton's curve: bits 0, 2, 4, … of its number, and bits 1, 3, 5, ….
#[inline]
fn place(code: u64) -> (u32, u32) {
    /// Those of eight bits.
    const PLACES: [(u8, u8); 256] = {
        let mut places = [(0, 0); 256];
        let mut code = 0;
        while code < 256 {
            let mut bit = 0;
            while bit < 4 {
                places[code].0 |= ((code >> (2 * bit) & 1) << bit) as u8;
                places[code].1 |= ((code >> (2 * bit + 1) & 1) << bit) as u8;
                bit += 1;
            }
            code += 1;
        }
        places
    };
    let (mut x, mut y) = (0, 0);
    let (mut rest, mut shift) = (code, 0);
    loop {
        let (column, row) = PLACES[(rest & 0xff) as usize];
        x |= u32::from(column) << shift;
        y |= u32::from(row) << shift;
        (rest, shift) = (rest >> 8, shift + 4);
        if rest == 0 {
            return (x, y);
        }
    }
}

/// The nearest `f32`. A radiance beyond its range, next to a lamp, becomes the largest number there is;
/// what is not finite stays so, to be counted.
fn narrow(channel: f64) -> f32 {
    let nearest = channel as f32;
    if nearest.is_infinite() && channel.is_finite() { f32::MAX.copysign(nearest) } else { nearest }
}

/// Renders pixel by pixel: a pixel is the mean of its samples, summed in `f64` in their order.
///
/// # Errors
/// As [`Film::fill`].
pub fn render_pixels<C: AddAssign + Default + Send>(
    size: ImageSize,
    sampling: PixelSampling,
    control: Control,
    estimator: impl Estimator<C>,
) -> Result<Rendering<C>, Cancelled> {
    Film::new(size, control.tile)
        .fill_and_finish(control, |tile| tile.sample(sampling, control, |_, _| true, &estimator))
}

/// Renders pixels in detail only where the picture has some: first the centre of each, then all
/// `sampling` samples of those whose displayed value differs from a neighbour's above, below, left or
/// right by more than `contrast` (0 to 1, of the display's range, in any channel). Source: Whitted, *An Improved
/// Illumination Model for Shaded Display*, 1980, § « Anti-aliasing », which compares a pixel's corners.
///
/// What lies between the centres of equal pixels is missed, so this trades unbiased pixels for speed.
/// [`Control::progress`] is told of each of the two passes over the picture. The film holds the samples that are in the
/// picture, of which a pixel without detail has that of the first pass: it is finished, not to be continued. The counts
/// are those of both passes.
///
/// # Errors
/// As [`Film::fill`].
pub fn render_adaptive<C: AddAssign + Default + Send>(
    size: ImageSize,
    sampling: PixelSampling,
    contrast: f64,
    control: Control,
    estimator: impl Estimator<C>,
) -> Result<Film<C>, Cancelled> {
    let pilot = sampling.pilot();
    let centers = Film::new(size, control.tile)
        .fill_and_finish(control, |tile| tile.sample(pilot, control, |_, _| true, &estimator))?;
    let detailed = detailed(&centers.image, contrast);
    let is_detailed = |x: u32, y: u32| detailed[(y * size.width + x) as usize];
    let mut film = Film::new(size, control.tile);
    film.fill(control, |tile| {
        tile.sample(sampling, control, is_detailed, &estimator);
        for (x, y) in tile.places().filter(|&(x, y)| !is_detailed(x, y)) {
            tile.set(x, y, centers.image.get(x, y));
        }
    })?;
    if let Some(first) = film.tiles.first_mut() {
        first.counts += centers.counts;
    }
    Ok(film)
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
    use glam::DVec2;

    use super::*;
    use crate::sampling::Pattern;

    /// Counts samples.
    fn half_plane(sample: &Sample, samples: &mut u64) -> Rgb {
        *samples += 1;
        if sample.film.x + 0.3 * sample.film.y < 9.7 { Rgb::ONE } else { Rgb::ZERO }
    }

    /// A faulty sample is not spread over its neighbours, and a radiance beyond `f32` is no fault.
    #[test]
    fn a_nan_stains_one_pixel_and_a_huge_radiance_none() {
        let size = ImageSize::new(9, 7);
        for faulty in [f64::NAN, f64::INFINITY, 1e40, 1e300] {
            let first = AtomicBool::new(true);
            let radiance = |sample: &Sample, _: &mut u64| {
                let here = sample.film.floor() == DVec2::new(4.0, 3.0);
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
        let adaptive = render_adaptive(size, sampling, 0.1, control, half_plane).unwrap().finish();
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
        let flat = |_: &Sample, samples: &mut u64| {
            *samples += 1;
            Rgb::splat(0.5)
        };
        let size = ImageSize::new(5, 7);
        let film = render_adaptive(size, sampling, 0.0, Control::default(), flat).unwrap();
        assert_eq!(film.finish().counts, 35);
    }

    const SIZE: ImageSize = ImageSize::new(21, 9);

    fn noise(seed: u64, samples: u32) -> (PixelSampling, impl Fn(&Sample, &mut u64) -> Rgb + Sync) {
        let sampling = PixelSampling { pattern: Pattern::Owen, samples, seed };
        let radiance = |sample: &Sample, count: &mut u64| {
            *count += 1;
            let [a, b, c, _] = sample.numbers(1);
            // Sums of such numbers depend on their order.
            Rgb::new(a, b * 1e8, c / 3.0)
        };
        (sampling, radiance)
    }

    /// Continued in steps, by tiles of another size, or after it was cancelled in the middle of a tile: the same
    /// sums, samples and counts.
    #[test]
    fn a_continued_picture_equals_one_never_interrupted() {
        let (sampling, radiance) = noise(4, 300);
        let whole = render_pixels(SIZE, sampling, Control::default(), &radiance).unwrap();

        let mut film = Film::new(SIZE, 5);
        for samples in [1, 7, 64, 64, 299, 300] {
            let some = PixelSampling { samples, ..sampling };
            film.sample(some, Control::default(), &radiance).unwrap();
        }
        assert!(film.finish() == whole);

        let cancelled = AtomicBool::new(false);
        let answered = AtomicU64::new(0);
        let stopping = |sample: &Sample, count: &mut u64| {
            if answered.fetch_add(1, Ordering::Relaxed) == 1000 {
                cancelled.store(true, Ordering::Relaxed);
            }
            radiance(sample, count)
        };
        let mut film = Film::new(SIZE, 16);
        let control = Control { cancelled: &cancelled, ..Control::default() };
        assert_eq!(film.sample(sampling, control, &stopping), Err(Cancelled));
        let half = film.clone().finish();
        assert!(half.counts > 0 && half.counts < whole.counts && half.image != whole.image);
        cancelled.store(false, Ordering::Relaxed);
        film.sample(sampling, control, &radiance).unwrap();
        assert!(film.finish() == whole);
    }

    /// A tile set as a whole, one sampled in part, one pixel by pixel.
    #[test]
    fn a_tile_is_filled_as_its_owner_likes() {
        let (sampling, radiance) = noise(4, 3);
        let whole = render_pixels(SIZE, sampling, Control::default(), &radiance).unwrap();
        let mut film = Film::new(SIZE, 7);
        let is_set = |x: u32, y: u32| x < 7 || x < 14 && (x + y).is_multiple_of(2);
        film.fill(Control::default(), |tile| {
            for (x, y) in tile.places() {
                if is_set(x, y) {
                    tile.set(x, y, Rgb::splat(0.25));
                } else if tile.x == 14 {
                    tile.sample(sampling, Control::default(), |a, b| (a, b) == (x, y), &radiance);
                }
            }
            tile.sample(sampling, Control::default(), |x, y| !is_set(x, y), &radiance);
        })
        .unwrap();
        let samples = film.samples();
        let mixed = film.finish();
        for y in 0..9 {
            for x in 0..21 {
                let (pixel, samples) = (mixed.image.get(x, y), samples.get(x, y).x);
                if is_set(x, y) {
                    assert_eq!((pixel, samples), (Rgb::splat(0.25), 1.0));
                } else {
                    assert_eq!((pixel, samples), (whole.image.get(x, y), 3.0));
                }
            }
        }
        assert_eq!(
            mixed.counts,
            3 * (0..9).map(|y| (0..21).filter(|&x| !is_set(x, y)).count() as u64).sum::<u64>()
        );
    }
}
