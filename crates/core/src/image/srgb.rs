//! The sRGB curve, IEC 61966-2-1.

use std::sync::LazyLock;

/// Which of 256 levels is nearest to a display value, found without a power for each channel.
pub(super) struct Levels {
    /// The least linear value of each level.
    first: [f64; 256],
    /// The level at the lower end of each part of [0, 1]. At most one more begins in the part, since the curve
    /// rises by no more than 12.92 · 255 / 4096 levels in it.
    at: [u8; PARTS],
}

const PARTS: usize = 4096;

impl Levels {
    /// All of them.
    pub(super) fn get() -> &'static Self {
        static LEVELS: LazyLock<Levels> = LazyLock::new(Levels::new);
        &LEVELS
    }

    fn new() -> Self {
        let mut first = [0.0; 256];
        for (level, first) in first.iter_mut().enumerate().skip(1) {
            // Rounding may have missed it by a few numbers.
            let mut least = decode((level as f64 - 0.5) / 255.0);
            while nearest_level(least) >= level as u8 {
                least = least.next_down();
            }
            while nearest_level(least) < level as u8 {
                least = least.next_up();
            }
            *first = least;
        }
        let at = std::array::from_fn(|part| nearest_level(part as f64 / PARTS as f64));
        Self { first, at }
    }

    /// The level of a linear value in [0, 1]; that of NaN is 0.
    #[inline]
    pub(super) fn of(&self, linear: f64) -> u8 {
        let part = (linear * PARTS as f64) as usize;
        let level = self.at[part.min(PARTS - 1)];
        let is_next = level < 255 && linear >= self.first[usize::from(level) + 1];
        level + u8::from(is_next)
    }
}

fn nearest_level(linear: f64) -> u8 {
    (255.0 * encode(linear)).round() as u8
}

/// The display value in [0, 1] of a linear value in [0, 1].
pub(super) fn encode(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The linear value in [0, 1] of a display value in [0, 1].
pub(super) fn decode(display: f64) -> f64 {
    if display <= 0.040_45 { display / 12.92 } else { ((display + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_those_of_the_curve() {
        let levels = Levels::get();
        let numbers = (0..=100_000).map(|k| f64::from(k) / 100_000.0);
        let limits =
            levels.first.into_iter().flat_map(|x| [x.next_down().max(0.0), x, x.next_up()]);
        for linear in numbers.chain(limits).chain([f64::NAN, f64::MIN_POSITIVE]) {
            assert_eq!(levels.of(linear), nearest_level(linear), "{linear}");
        }
    }

    #[test]
    fn the_two_parts_meet_at_the_knee() {
        let knee = 0.003_130_8;
        assert!((encode(knee) - 0.040_449_936).abs() < 1e-9);
        assert!((encode(knee.next_up()) - encode(knee)).abs() < 1e-7);
        assert!((decode(0.040_45_f64.next_up()) - decode(0.040_45)).abs() < 1e-7);
    }

    #[test]
    fn values_on_both_sides_of_the_knee() {
        // By mpmath; the other part of the curve differs in the fifth decimal.
        for (linear, display) in [(0.0031, 0.040_052), (0.0032, 0.041_323_358_627)] {
            assert!((encode(linear) - display).abs() < 1e-11, "{linear}");
        }
        for (display, linear) in [(0.04, 0.003_095_975_232), (0.041, 0.003_174_278_709)] {
            assert!((decode(display) - linear).abs() < 1e-11, "{display}");
        }
    }

    #[test]
    fn half_of_the_display_range_is_a_fifth_of_the_light() {
        // (0.555 / 1.055)^2.4 and 1.055 / 2^(1/2.4) - 0.055, to 10 digits by mpmath.
        assert!((decode(0.5) - 0.214_041_140_5).abs() < 1e-10);
        assert!((encode(0.5) - 0.735_356_983_1).abs() < 1e-10);
    }
}
