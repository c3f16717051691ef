//! Repeatable random geometry.

use glam::DVec3;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

pub struct Random(Pcg64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(Pcg64::new(u128::from(seed), 0x0a02_bdbf_7bb3_c0a7_ac28_fa16_a64a_bf96))
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (0.5 * f64::EPSILON)
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// An integer from `-size` to `size`.
    pub fn integer(&mut self, size: i32) -> f64 {
        (self.below(2 * size as usize + 1) as i32 - size).into()
    }

    pub fn in_cube(&mut self, half: f64) -> DVec3 {
        DVec3::new(self.between(-half, half), self.between(-half, half), self.between(-half, half))
    }

    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.in_cube(1.0);
            if (1e-3..=1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    /// Barycentric weights, uniform over a triangle.
    pub fn weights(&mut self) -> DVec3 {
        let (a, b) = (self.unit().sqrt(), self.unit());
        DVec3::new(1.0 - a, a * (1.0 - b), a * b)
    }
}
