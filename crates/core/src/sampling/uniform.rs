use std::f64::consts::TAU;

use glam::DVec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::keys::{STEP, mix, pixel_key};
use crate::geometry::Ray;

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

    pub(super) fn with_key(key: u64) -> Self {
        Self(Pcg32::new(key, key))
    }

    /// Leaves out so many numbers.
    pub(super) fn skip(&mut self, count: u64) {
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
