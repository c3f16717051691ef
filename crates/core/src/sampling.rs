//! The samples of a pixel and their random numbers. Everything follows from (seed, pixel, sample index)
//! alone, so a picture does not depend on who renders which pixel when.
//!
//! A sample's numbers come in sets of four ([`Sample::numbers`]), each set a scrambled Sobol sequence of its own:
//! what belongs together must share one, since only within a set are many samples stratified together.
//!
//! | set | numbers 0 and 1                                       | numbers 2 and 3                          |
//! |-----|-------------------------------------------------------|------------------------------------------|
//! | 0   | the film point in its pixel, by [`Pattern::Owen`]     | reserved for the point on the first lamp |
//!
//! A method that needs more takes the next free sets and adds its rows here.

use std::f64::consts::TAU;
use std::ops::Range;

use glam::{DVec2, DVec3};
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use crate::geometry::Ray;

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
        let (index, seed) = sobol_place(self.index, set_key(self.key, set));
        sobol_burley::sample_4d(index, 0, seed).map(f64::from)
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
        numbers: Range<u32>,
    ) -> impl Iterator<Item = Sample> {
        let corner = DVec2::new(f64::from(x), f64::from(y));
        let key = pixel_key(self.seed, x, y);
        let cells = match self.pattern {
            Pattern::Regular | Pattern::Jittered => grid(self.samples),
            Pattern::Owen => [1, 1],
        };
        numbers.map(move |index| {
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
                Pattern::Owen => owen(index, key),
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

/// Independent random numbers of a pixel, or of anything else that has two coordinates: they follow
/// from (seed, x, y) alone.
#[derive(Clone, Debug)]
pub struct Uniform(Pcg32);

impl Uniform {
    /// The numbers of (`seed`, `x`, `y`), from the first on.
    pub fn new(seed: u64, x: u32, y: u32) -> Self {
        Self::with_key(pixel_key(seed, x, y))
    }

    /// The numbers of a ray: they follow from `seed` and the bits of its origin and direction alone.
    pub fn of_ray(seed: u64, ray: &Ray) -> Self {
        let coordinates = [ray.origin, ray.direction].into_iter().flat_map(|v| v.to_array());
        let key = coordinates
            .fold(mix(seed), |key, coordinate| mix(key.wrapping_add(STEP) ^ coordinate.to_bits()));
        Self::with_key(key)
    }

    fn with_key(key: u64) -> Self {
        Self(Pcg32::new(key, key))
    }

    /// Leaves out so many numbers.
    fn skip(&mut self, count: u64) {
        // The generator gives 32 bits at a time.
        self.0.advance(2 * count);
    }

    /// The next number in [0, 1), with 53 random bits.
    #[inline]
    pub fn number(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (0.5 * f64::EPSILON)
    }

    /// A unit vector, all directions being equally likely: a sphere's zones of equal height have equal
    /// areas (Archimedes).
    #[inline]
    pub fn direction(&mut self) -> DVec3 {
        let (z, (sin, cos)) = (2.0 * self.number() - 1.0, (TAU * self.number()).sin_cos());
        let r = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(r * cos, r * sin, z)
    }
}

/// Numbers 0 and 1 of a pixel's set 0.
#[inline]
fn owen(index: u32, key: u64) -> DVec2 {
    let (index, seed) = sobol_place(index, key);
    let coordinate = |dimension| f64::from(sobol_burley::sample(index, dimension, seed));
    DVec2::new(coordinate(0), coordinate(1))
}

/// Where sample `index` stands in the library's sequences: its index and seed there. The generator ends after
/// 2^16 points; each further block of that length is another scrambling.
#[inline]
fn sobol_place(index: u32, key: u64) -> (u32, u32) {
    const BLOCK: u32 = 1 << 16;
    (index % BLOCK, (key as u32).wrapping_add(index / BLOCK))
}

/// The key of a set of numbers; that of set 0 is the pixel's own.
#[inline]
fn set_key(key: u64, set: u32) -> u64 {
    if set == 0 { key } else { mix(key.wrapping_add(u64::from(set).wrapping_mul(STEP))) }
}

/// A well-mixed key for each (seed, pixel): the finaliser of SplitMix64 (Steele, Lea, Flood 2014).
fn pixel_key(seed: u64, x: u32, y: u32) -> u64 {
    let pixel = (u64::from(y) << 32) | u64::from(x);
    mix(mix(seed).wrapping_add(pixel.wrapping_mul(STEP)))
}

/// 2⁶⁴ divided by the golden ratio, SplitMix64's own step: it keeps zeros from staying zeros.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
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

    /// z and the square of the distance from the axis have the means 0 and 2/3, with standard deviations
    /// √(1/3) and √(4/45); a false alarm in a million.
    #[test]
    fn directions_favour_none() {
        let count = 100_000;
        let mut random = Uniform::new(1, 2, 3);
        let (mut mean, mut from_axes) = (DVec3::ZERO, DVec3::ZERO);
        for _ in 0..count {
            let d = random.direction();
            assert!((d.length() - 1.0).abs() < 4.0 * f64::EPSILON);
            mean += d / f64::from(count);
            from_axes += (1.0 - d * d) / f64::from(count);
        }
        let z = 5.3 / f64::from(count).sqrt();
        assert!(mean.abs().max_element() < z * (1.0_f64 / 3.0).sqrt(), "{mean}");
        let off = (from_axes - 2.0 / 3.0).abs().max_element();
        assert!(off < z * (4.0_f64 / 45.0).sqrt(), "{from_axes}");
    }

    /// The first numbers of rays that differ in one coordinate, one rounding apart, and of one ray under
    /// many seeds: means ½ and products of neighbours ¼, with standard deviations √(1/12) and √(7)/12; a
    /// false alarm in a million.
    #[test]
    fn rays_and_seeds_have_independent_numbers() {
        let count = 100_000_u64;
        let near = |k: u64| f64::from_bits(2.5_f64.to_bits() + k);
        let ray = |x: f64| Ray::new(DVec3::new(x, 0.0, -1.0), DVec3::Z);
        let first = |seed: u64, x: f64| Uniform::of_ray(seed, &ray(x)).number();
        let numbers: [Vec<f64>; 2] = [
            (0..count).map(|k| first(1, near(k))).collect(),
            (0..count).map(|seed| first(seed, 2.5)).collect(),
        ];
        for numbers in numbers {
            let mean = numbers.iter().sum::<f64>() / count as f64;
            let products = numbers.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>();
            let z = 5.1 / (count as f64).sqrt();
            assert!((mean - 0.5).abs() < z * (1.0_f64 / 12.0).sqrt(), "{mean}");
            let product = products / (count - 1) as f64;
            // Neighbouring products share a factor, which less than doubles the variance 7/144.
            assert!((product - 0.25).abs() < z * (2.0 * 7.0_f64).sqrt() / 12.0, "{product}");
        }
        assert_eq!(first(3, 2.5), first(3, 2.5));
        let turned = Ray::new(ray(2.5).origin, DVec3::Y);
        assert_ne!(Uniform::of_ray(3, &turned).number(), first(3, 2.5));
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
