//! The sRGB curve, IEC 61966-2-1.

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
