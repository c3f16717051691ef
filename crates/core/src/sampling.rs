//! Where in a pixel its samples lie. Every position follows from (seed, pixel, sample index) alone, so
//! a picture does not depend on who renders which pixel when.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use crate::geometry::Ray;

/// How the samples of a pixel are laid out.
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
    /// Picks one of the random layouts; `Regular` ignores it.
    pub seed: u64,
}

impl PixelSampling {
    /// One sample in the centre of each pixel.
    pub const CENTER: Self = Self { pattern: Pattern::Regular, samples: 1, seed: 0 };

    /// The film points of pixel (x, y), in pixels; the pixel covers [x, x+1) × [y, y+1).
    #[inline]
    pub fn points(self, x: u32, y: u32) -> impl Iterator<Item = DVec2> {
        let corner = DVec2::new(f64::from(x), f64::from(y));
        let key = match self.pattern {
            Pattern::Regular => 0,
            Pattern::Jittered | Pattern::Owen => pixel_key(self.seed, x, y),
        };
        let mut random = Uniform::with_key(key);
        let cells = grid(self.samples);
        (0..self.samples).map(move |index| {
            let cell = DVec2::new(f64::from(index % cells[0]), f64::from(index / cells[0]));
            let cells = DVec2::new(f64::from(cells[0]), f64::from(cells[1]));
            corner
                + match self.pattern {
                    Pattern::Regular => (cell + 0.5) / cells,
                    Pattern::Jittered => {
                        (cell + DVec2::new(random.number(), random.number())) / cells
                    }
                    Pattern::Owen => owen(index, key),
                }
        })
    }
}

/// The columns and rows of the most nearly square grid with `samples` cells.
fn grid(samples: u32) -> [u32; 2] {
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

/// Point `index` of a pixel's Sobol sequence. The generator ends after 2^16 points; each further
/// block of that length is another scrambling.
fn owen(index: u32, key: u64) -> DVec2 {
    const BLOCK: u32 = 1 << 16;
    let seed = (key as u32).wrapping_add(index / BLOCK);
    let coordinate = |dimension| f64::from(sobol_burley::sample(index % BLOCK, dimension, seed));
    DVec2::new(coordinate(0), coordinate(1))
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

    #[test]
    fn one_regular_sample_is_the_centre_and_four_are_the_quarters() {
        let points = |samples| -> Vec<DVec2> {
            PixelSampling { pattern: Pattern::Regular, samples, seed: 7 }.points(3, 5).collect()
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
        let mut cells: Vec<u32> = sampling
            .points(9, 2)
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
            let points: Vec<DVec2> = sampling.points(0, 0).collect();
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
        let points: Vec<DVec2> = sampling.points(0, 0).collect();
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
            PixelSampling { pattern: Pattern::Jittered, samples: 1, seed }
                .points(x, 0)
                .next()
                .map(DVec2::fract)
        };
        assert_ne!(first(0, 0), first(1, 0));
        assert_ne!(first(0, 0), first(0, 1));
    }
}
