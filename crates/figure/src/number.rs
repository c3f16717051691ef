//! Numbers as a reader wants them: `10⁻³`, `2.1×10⁻⁴`, `1.28`.

/// `exponent` in superscript characters: `superscript(-12)` is `⁻¹²`.
pub fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    exponent
        .to_string()
        .chars()
        .map(|c| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]))
        .collect()
}

/// Ten to the power `exponent`, as text; the powers 0 and 1 are `1` and `10`.
pub fn power_of_ten(exponent: i32) -> String {
    match exponent {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        _ => format!("10{}", superscript(exponent)),
    }
}

/// `value` to at most three significant digits: `0.25`, `1280`, `2.1×10⁻⁴`, `5×10⁶`, `∞`, `NaN`.
///
/// Integers below a million are printed in full.
pub fn number(value: f64) -> String {
    if value.is_nan() {
        return "NaN".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "∞" } else { "−∞" }.to_owned();
    }
    let size = value.abs();
    if size == 0.0 || (size < 1e6 && size.fract() == 0.0) {
        return signed(value.is_sign_negative() && size > 0.0, &format!("{size}"));
    }
    // Rounding may carry into the next decade (9.999 → 10.0), so the digits are read after it.
    let scientific = format!("{size:.2e}");
    let (mantissa, exponent) = scientific.split_once('e').expect("{:e} writes an exponent");
    let exponent: i32 = exponent.parse().expect("{:e} writes an integer exponent");
    let digits = if (-3..6).contains(&exponent) {
        let places = (2 - exponent).max(0) as usize;
        let rounded: f64 = scientific.parse().expect("{:e} writes a number");
        trim_zeros(&format!("{rounded:.places$}")).to_owned()
    } else {
        match trim_zeros(mantissa) {
            "1" => power_of_ten(exponent),
            mantissa => format!("{mantissa}×{}", power_of_ten(exponent)),
        }
    };
    signed(value < 0.0, &digits)
}

/// `value` with exactly `places` decimals and a true minus sign; never `−0`.
pub fn decimals(value: f64, places: usize) -> String {
    let digits = format!("{:.places$}", value.abs());
    let is_zero = digits.bytes().all(|byte| matches!(byte, b'0' | b'.'));
    signed(value < 0.0 && !is_zero, &digits)
}

fn signed(negative: bool, digits: &str) -> String {
    if negative { format!("−{digits}") } else { digits.to_owned() }
}

fn trim_zeros(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

/// A coordinate in an SVG: two decimals at most, no trailing zeros, no `-0`.
pub(crate) fn coordinate(value: f64) -> String {
    let text = format!("{value:.2}");
    match trim_zeros(&text) {
        "-0" => "0".to_owned(),
        trimmed => trimmed.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_ten_have_true_superscripts() {
        assert_eq!(power_of_ten(-3), "10⁻³");
        assert_eq!(power_of_ten(0), "1");
        assert_eq!(power_of_ten(12), "10¹²");
    }

    #[test]
    fn numbers_keep_three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1280.0, "1280"),
            (-7.0, "−7"),
            (0.25, "0.25"),
            (9.999, "10"),
            (0.0123456, "0.0123"),
            (1.2345e-4, "1.23×10⁻⁴"),
            (1e-5, "10⁻⁵"),
            (9.999e-5, "10⁻⁴"),
            (5e6, "5×10⁶"),
            (1234.5, "1230"),
            (f64::INFINITY, "∞"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(number(value), text, "{value}");
        }
    }

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(decimals(-0.001, 2), "0.00");
        assert_eq!(decimals(-1.5, 1), "−1.5");
        assert_eq!(coordinate(-0.001), "0");
        assert_eq!(coordinate(12.30), "12.3");
        assert_eq!(coordinate(100.0), "100");
    }
}
