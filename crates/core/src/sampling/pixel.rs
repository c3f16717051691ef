use std::ops::Range;

use glam::DVec2;

use super::keys::{STEP, mix, pixel_key};
use super::{Uniform, sobol};

/// How the samples of a pixel are laid out on the film. Their other numbers are the same for all patterns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// The centres of a grid: one sample is the pixel's centre.
    Regular,
    /// One random point in each cell of that grid.
    Jittered,
    /// The Owen-scrambled Sobol sequence: any power of two of its points is stratified in both
    /// directions at once (Burley, *Practical Hash-based Owen Scrambling*, JCGT 9(4), 2020).
    Owen,
}

/// The samples of each pixel: their layout, number and seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelSampling {
    /// The layout.
    pub pattern: Pattern,
    /// Samples per pixel, at least 1.
    pub samples: u32,
    /// Picks one of the random layouts and of the random numbers.
    pub seed: u64,
}

/// One sample of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Where it lies on the film, in pixels; pixel (x, y) covers [x, x+1) × [y, y+1).
    pub film: DVec2,
    /// Column and row of its pixel.
    pub pixel: [u32; 2],
    /// Its number among the samples of the pixel, from 0.
    pub index: u32,
    /// The pixel's key, from which all of its numbers follow: another for each seed and pixel.
    pub key: u64,
}

impl Sample {
    /// The four numbers of a set, each in [0, 1); the table above says to whom a set belongs.
    ///
    /// In one set, the first 2^k samples of a pixel are stratified in any two of the four numbers as far as
    /// Sobol's sequence is. Two sets, and two pixels, are independent.
    #[inline]
    pub fn numbers(&self, set: u32) -> [f64; 4] {
        numbers(self.index, set_key(self.key, set))
    }

    /// What the sample is at a surface further on, along the ray of this number that leaves the one it is at: it has
    /// sets of its own, of which none is one of `self` or of another ray. A path of any length, or a tree of rays,
    /// needs no numbers of sets beyond the table's.
    #[inline]
    #[must_use]
    pub fn along(&self, ray: u32) -> Self {
        Self { key: set_key(self.key, u32::MAX - ray), ..*self }
    }
}

impl PixelSampling {
    /// One sample in the centre of each pixel.
    pub const CENTER: Self = Self { pattern: Pattern::Regular, samples: 1, seed: 0 };

    /// One sample in the centre of each pixel, to decide where `self` is worth its samples. It has other
    /// random numbers: a decision by a sample that counts too would bias the picture.
    #[must_use]
    pub fn pilot(self) -> Self {
        Self { seed: mix(self.seed ^ STEP), ..Self::CENTER }
    }

    /// The samples of pixel (x, y).
    #[inline]
    pub fn of_pixel(self, x: u32, y: u32) -> impl Iterator<Item = Sample> {
        self.some_of_pixel(x, y, 0..self.samples)
    }

    /// Those of them with these numbers. A picture may be continued with the next ones: with
    /// [`Pattern::Owen`] also beyond [`PixelSampling::samples`].
    #[inline]
    pub fn some_of_pixel(
        self,
        x: u32,
        y: u32,
        indices: Range<u32>,
    ) -> impl Iterator<Item = Sample> {
        let corner = DVec2::new(f64::from(x), f64::from(y));
        let key = pixel_key(self.seed, x, y);
        let cells = match self.pattern {
            Pattern::Regular | Pattern::Jittered => grid(self.samples),
            Pattern::Owen => [1, 1],
        };
        indices.map(move |index| {
            let in_cell = |place: DVec2| {
                if cells == [1, 1] {
                    return place;
                }
                let cell = DVec2::new(f64::from(index % cells[0]), f64::from(index / cells[0]));
                (cell + place) / DVec2::new(f64::from(cells[0]), f64::from(cells[1]))
            };
            let in_pixel = match self.pattern {
                Pattern::Regular => in_cell(DVec2::splat(0.5)),
                Pattern::Jittered => {
                    let mut random = Uniform::with_key(key);
                    random.skip(2 * u64::from(index));
                    in_cell(DVec2::new(random.number(), random.number()))
                }
                Pattern::Owen => {
                    let [x, y, _, _] = numbers(index, key);
                    DVec2::new(x, y)
                }
            };
            Sample { film: corner + in_pixel, pixel: [x, y], index, key }
        })
    }
}

/// The columns and rows of the most nearly square grid with `samples` cells.
#[inline]
fn grid(samples: u32) -> [u32; 2] {
    if samples <= 1 {
        return [1, 1];
    }
    let rows = (1..=samples.isqrt()).rev().find(|rows| samples.is_multiple_of(*rows)).unwrap_or(1);
    [samples / rows, rows]
}

/// The four numbers that follow from a sample's index and the key of a set. The generator ends after 2^16 points; each
/// further block of that length is another scrambling.
#[inline]
fn numbers(index: u32, key: u64) -> [f64; 4] {
    let seed = (key as u32).wrapping_add(index / sobol::POINTS);
    sobol::scrambled(index % sobol::POINTS, seed).map(f64::from)
}

/// The key of a set of numbers; that of set 0 is the pixel's own.
#[inline]
fn set_key(key: u64, set: u32) -> u64 {
    if set == 0 { key } else { mix(key.wrapping_add(u64::from(set).wrapping_mul(STEP))) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film_points(sampling: PixelSampling, x: u32, y: u32) -> Vec<DVec2> {
        sampling.of_pixel(x, y).map(|sample| sample.film).collect()
    }

    const PATTERNS: [Pattern; 3] = [Pattern::Regular, Pattern::Jittered, Pattern::Owen];

    /// The library's own single dimensions are the oracle, and set 0 holds the film point.
    #[test]
    fn numbers_are_the_dimensions_of_one_sequence() {
        let sampling = PixelSampling { pattern: Pattern::Owen, samples: 64, seed: 9 };
        for sample in sampling.of_pixel(4, 7) {
            let seed = sample.key as u32;
            let expected =
                [0, 1, 2, 3].map(|k| f64::from(sobol_burley::sample(sample.index, k, seed)));
            assert_eq!(sample.numbers(0), expected);
            assert_eq!(sample.film - DVec2::new(4.0, 7.0), DVec2::new(expected[0], expected[1]));
        }
    }

    /// By Owen scrambling all of it is the same for every count, and for every pattern all but the film point.
    #[test]
    fn a_sample_does_not_depend_on_how_many_there_are() {
        let of = |pattern, samples, numbers: Range<u32>| -> Vec<Sample> {
            let sampling = PixelSampling { pattern, samples, seed: 3 };
            sampling.some_of_pixel(5, 6, numbers).collect()
        };
        let long = of(Pattern::Owen, (1 << 16) + 8, (1 << 16) - 8..(1 << 16) + 8);
        assert_eq!(long, of(Pattern::Owen, 1, (1 << 16) - 8..(1 << 16) + 8));
        for pattern in PATTERNS {
            let whole = of(pattern, 16, 0..16);
            let parts = [of(pattern, 16, 0..5), of(pattern, 16, 5..6), of(pattern, 16, 6..16)];
            assert_eq!(whole, parts.concat());
            for (sample, other) in whole.iter().zip(of(Pattern::Owen, 16, 0..16)) {
                assert_eq!((sample.key, sample.numbers(3)), (other.key, other.numbers(3)));
            }
        }
    }

    /// 2^k samples put one number into each of 2^k intervals, in every set and dimension, in the second block
    /// of the generator as well.
    #[test]
    fn every_number_of_every_set_is_stratified() {
        let sampling = PixelSampling { pattern: Pattern::Regular, samples: 1, seed: 11 };
        for (first, set) in [(0, 0), (0, 1), (0, 40), (1 << 16, 0), (3 << 16, 5)] {
            for dimension in 0..4 {
                let samples = sampling.some_of_pixel(1, 2, first..first + 64);
                let mut cells: Vec<u32> =
                    samples.map(|s| (64.0 * s.numbers(set)[dimension]) as u32).collect();
                cells.sort_unstable();
                assert_eq!(cells, (0..64).collect::<Vec<_>>(), "{first} {set} {dimension}");
            }
        }
    }

    /// Two sets, two pixels and a picture and its pilot have correlations 0, with standard deviation
    /// 1/√N; a false alarm in a thousand for all together. The naive form, sets that share a seed, has 1.
    #[test]
    fn sets_pixels_and_pilots_are_independent() {
        let sampling = PixelSampling { pattern: Pattern::Owen, samples: 1, seed: 5 };
        let sample = |sampling: PixelSampling, x: u32| sampling.of_pixel(x, 3).next().unwrap();
        let count = 20_000;
        let correlation = |a: &dyn Fn(u32) -> f64, b: &dyn Fn(u32) -> f64| {
            let product = |x: u32| 12.0 * (a(x) - 0.5) * (b(x) - 0.5);
            (0..count).map(product).sum::<f64>() / f64::from(count)
        };
        let first = |x: u32| sample(sampling, x).numbers(0)[2];
        let others: [&dyn Fn(u32) -> f64; 5] = [
            &|x| sample(sampling, x).numbers(1)[2],
            &|x| sample(sampling, x).numbers(2)[2],
            &|x| sample(sampling, x).numbers(0)[3],
            &|x| sample(sampling, x + 1).numbers(0)[2],
            &|x| sample(sampling.pilot(), x).numbers(0)[2],
        ];
        // Along one pixel too: sets that were scrambled alike would be the same sequence.
        let one: Vec<Sample> = sampling.some_of_pixel(4, 3, 0..20_000).collect();
        for (k, other) in others.into_iter().enumerate() {
            let found = correlation(&first, other);
            assert!(found.abs() < 3.7 / f64::from(count).sqrt(), "{k}: {found}");
        }
        assert!(correlation(&first, &first) > 0.97);
        for set in [1, 2, 9] {
            let of = |k: u32, set| one[k as usize].numbers(set)[2];
            let found = correlation(&|k| of(k, 0), &|k| of(k, set));
            assert!(found.abs() < 3.7 / f64::from(count).sqrt(), "{set}: {found}");
        }
    }

    #[test]
    fn one_regular_sample_is_the_centre_and_four_are_the_quarters() {
        let points = |samples| -> Vec<DVec2> {
            let sampling = PixelSampling { pattern: Pattern::Regular, samples, seed: 7 };
            film_points(sampling, 3, 5)
        };
        assert_eq!(points(1), [DVec2::new(3.5, 5.5)]);
        let quarters = [(3.25, 5.25), (3.75, 5.25), (3.25, 5.75), (3.75, 5.75)];
        assert_eq!(points(4), quarters.map(DVec2::from));
    }

    #[test]
    fn grids_are_as_square_as_the_count_allows() {
        assert_eq!(
            [1, 2, 6, 7, 16, 64].map(grid),
            [[1, 1], [2, 1], [3, 2], [7, 1], [4, 4], [8, 8]]
        );
    }

    #[test]
    fn every_cell_holds_one_jittered_point() {
        let sampling = PixelSampling { pattern: Pattern::Jittered, samples: 16, seed: 1 };
        let mut cells: Vec<u32> = film_points(sampling, 9, 2)
            .into_iter()
            .map(|p| 4 * ((p.y - 2.0) * 4.0) as u32 + ((p.x - 9.0) * 4.0) as u32)
            .collect();
        cells.sort_unstable();
        assert_eq!(cells, (0..16).collect::<Vec<_>>());
    }

    /// The defining property of a (0, 2)-sequence: of the first 2^k points, every elementary interval
    /// of area 2^−k holds exactly one, whatever its shape.
    #[test]
    fn every_elementary_interval_holds_one_owen_point() {
        for k in 2..=10u32 {
            let sampling = PixelSampling { pattern: Pattern::Owen, samples: 1 << k, seed: 3 };
            let points = film_points(sampling, 0, 0);
            for split in 0..=k {
                let (columns, rows) = (1u32 << split, 1u32 << (k - split));
                let mut seen = vec![false; 1 << k];
                for p in &points {
                    let column = (p.x * f64::from(columns)) as u32;
                    let row = (p.y * f64::from(rows)) as u32;
                    let cell = &mut seen[(row * columns + column) as usize];
                    assert!(!*cell, "two points in one interval, k = {k}, {columns} x {rows}");
                    *cell = true;
                }
            }
        }
    }

    #[test]
    fn a_sequence_longer_than_its_generator_goes_on() {
        let sampling = PixelSampling { pattern: Pattern::Owen, samples: (1 << 16) + 4, seed: 3 };
        let points = film_points(sampling, 0, 0);
        assert_ne!(points[..4], points[1 << 16..]);
        assert!(points.iter().all(|p| p.min_element() >= 0.0 && p.max_element() < 1.0));
    }

    #[test]
    fn neighbouring_pixels_and_seeds_differ() {
        let first = |x, seed| {
            let sampling = PixelSampling { pattern: Pattern::Jittered, samples: 1, seed };
            film_points(sampling, x, 0)[0].fract()
        };
        assert_ne!(first(0, 0), first(1, 0));
        assert_ne!(first(0, 0), first(0, 1));
    }
}
