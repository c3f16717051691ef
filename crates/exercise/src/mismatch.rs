use std::fmt;
use std::ops::Range;

use glam::DVec3;
use lancer_core::geometry::Ray;

/// What a check says: the counter-example, if there is one.
pub type Verdict = Result<(), Mismatch>;

/// A counter-example: where an answer is not the expected one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mismatch {
    /// The input, in words and numbers.
    pub case: String,
    /// What the student's function answered.
    pub got: String,
    /// What it should have.
    pub wanted: String,
}

impl Mismatch {
    /// A counter-example in words.
    pub fn new(case: impl Into<String>, got: impl Into<String>, wanted: impl Into<String>) -> Self {
        Self { case: case.into(), got: got.into(), wanted: wanted.into() }
    }
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The lines of a longer text stand below each other.
        let [case, got, wanted] =
            [&self.case, &self.got, &self.wanted].map(|text| text.replace('\n', "\n          "));
        writeln!(f, "  case    {case}")?;
        writeln!(f, "  got     {got}")?;
        write!(f, "  wanted  {wanted}")
    }
}

/// Something that can be shown to a student, and compared within a tolerance.
pub trait Shown {
    /// Short, with six digits.
    fn shown(&self) -> String;

    /// The largest difference in any of its numbers; infinite if they cannot be compared.
    fn distance(&self, other: &Self) -> f64;
}

impl Shown for f64 {
    fn shown(&self) -> String {
        let (magnitude, value) = (self.abs(), *self);
        match magnitude {
            // A direction of −0 is not one of 0.
            0.0 => if value.is_sign_negative() { "-0" } else { "0" }.to_owned(),
            1e-3..1e6 => {
                let digits = (5.0 - magnitude.log10().floor()).max(0.0) as usize;
                let text = format!("{value:.digits$}");
                let text = if text.contains('.') {
                    text.trim_end_matches('0').trim_end_matches('.')
                } else {
                    &text
                };
                text.to_owned()
            }
            _ => format!("{value:.5e}"),
        }
    }

    fn distance(&self, other: &Self) -> f64 {
        // Equal infinities are no distance apart, and a NaN is far from everything.
        if self == other {
            0.0
        } else if (self - other).is_nan() {
            f64::INFINITY
        } else {
            (self - other).abs()
        }
    }
}

impl Shown for DVec3 {
    fn shown(&self) -> String {
        format!("({}, {}, {})", self.x.shown(), self.y.shown(), self.z.shown())
    }

    fn distance(&self, other: &Self) -> f64 {
        (0..3).map(|axis| self[axis].distance(&other[axis])).fold(0.0, f64::max)
    }
}

impl Shown for Ray {
    fn shown(&self) -> String {
        format!("origin {}, direction {}", self.origin.shown(), self.direction.shown())
    }

    fn distance(&self, other: &Self) -> f64 {
        Shown::distance(&self.origin, &other.origin)
            .max(Shown::distance(&self.direction, &other.direction))
    }
}

impl<T: Shown> Shown for Option<T> {
    fn shown(&self) -> String {
        self.as_ref().map_or("None".to_owned(), T::shown)
    }

    fn distance(&self, other: &Self) -> f64 {
        match (self, other) {
            (Some(a), Some(b)) => a.distance(b),
            (None, None) => 0.0,
            _ => f64::INFINITY,
        }
    }
}

impl<A: Shown, B: Shown> Shown for (A, B) {
    fn shown(&self) -> String {
        format!("({}, {})", self.0.shown(), self.1.shown())
    }

    fn distance(&self, other: &Self) -> f64 {
        self.0.distance(&other.0).max(self.1.distance(&other.1))
    }
}

macro_rules! shown_exactly {
    ($($type:ty),*) => {$(
        impl Shown for $type {
            fn shown(&self) -> String {
                self.to_string()
            }

            fn distance(&self, other: &Self) -> f64 {
                if self == other { 0.0 } else { f64::INFINITY }
            }
        }
    )*};
}

shown_exactly!(bool, u32, u64, usize);

/// How far numbers about as large as 1 are off where an `f32` has rounded them.
const ROUNDING_OF_F32: Range<f64> = 1e-9..1e-5;

/// A result as it is compared: −0 equals 0 there.
fn unsigned_zeros(shown: &str) -> String {
    let mut parts = shown.split("-0");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let is_longer = part.starts_with(|c: char| c == '.' || c.is_ascii_digit());
        text += if is_longer { "-0" } else { "0" };
        text += part;
    }
    text
}

/// Whether something holds that an answer promises.
///
/// # Errors
/// The counter-example, if it does not.
pub fn ensure(holds: bool, mismatch: impl FnOnce() -> Mismatch) -> Verdict {
    if holds { Ok(()) } else { Err(mismatch()) }
}

/// Whether an answer is the expected one in every number, up to `tolerance`.
///
/// # Errors
/// The counter-example, if it is not. `case` names the input.
pub fn within<T: Shown>(
    tolerance: f64,
    case: impl FnOnce() -> String,
    got: &T,
    wanted: &T,
) -> Verdict {
    let distance = got.distance(wanted);
    ensure(distance <= tolerance, || {
        let (got, mut wanted) = (unsigned_zeros(&got.shown()), unsigned_zeros(&wanted.shown()));
        // Where six digits do not tell them apart, the difference does.
        if got == wanted {
            wanted += &format!(", to {}; this is off by {}", tolerance.shown(), distance.shown());
            if ROUNDING_OF_F32.contains(&distance) {
                wanted += ": is there an `f32` on the way?";
            }
        }
        Mismatch::new(case(), got, wanted)
    })
}

/// Whether an answer is the expected one exactly.
///
/// # Errors
/// The counter-example, if it is not. `case` names the input.
pub fn same<T: Shown>(case: impl FnOnce() -> String, got: &T, wanted: &T) -> Verdict {
    within(0.0, case, got, wanted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_shown_with_six_digits() {
        let shown =
            [0.0, 1.0, -0.5, 1.0 / 3.0, 123_456.7, 2e-5, 1e9, f64::INFINITY].map(|n| n.shown());
        let wanted = ["0", "1", "-0.5", "0.333333", "123457", "2.00000e-5", "1.00000e9", "inf"];
        assert_eq!(shown, wanted);
    }

    /// An input tells −0 from 0, as the function that takes it does; results are compared as numbers.
    #[test]
    fn a_negative_zero_is_shown_in_an_input_alone() {
        let direction = DVec3::new(-0.0, 0.5, -0.025);
        assert_eq!(direction.shown(), "(-0, 0.5, -0.025)");
        let off = within(1e-9, || direction.shown(), &direction, &DVec3::ONE).unwrap_err();
        assert_eq!((&*off.case, &*off.got), ("(-0, 0.5, -0.025)", "(0, 0.5, -0.025)"));
        assert_eq!(same(String::new, &-0.0, &0.0), Ok(()));
    }

    #[test]
    fn what_an_f32_has_rounded_is_said_to_be() {
        let rounded = f64::from((1.0 / 3.0) as f32);
        let off = within(1e-12, String::new, &rounded, &(1.0 / 3.0)).unwrap_err();
        assert!(off.wanted.ends_with("off by 9.93411e-9: is there an `f32` on the way?"), "{off}");
        let off = within(1e-15, String::new, &1.0, &(1.0 + 1e-12)).unwrap_err();
        assert!(!off.wanted.contains("f32"), "{off}");
    }

    #[test]
    fn longer_texts_keep_their_shape() {
        let text = Mismatch::new("tree", "a\n  b", "a").to_string();
        assert_eq!(text, "  case    tree\n  got     a\n            b\n  wanted  a");
    }

    #[test]
    fn nothing_is_near_what_is_no_number() {
        assert_eq!(f64::NAN.distance(&f64::NAN), f64::INFINITY);
        assert_eq!(f64::INFINITY.distance(&f64::INFINITY), 0.0);
        assert_eq!(Some(1.0).distance(&None), f64::INFINITY);
        assert!(within(1e-3, String::new, &DVec3::ONE, &(DVec3::ONE * 1.0001)).is_ok());
        let off = within(1e-9, || "x".to_owned(), &1.0, &(1.0 + 1e-8)).unwrap_err();
        assert!(off.wanted.contains("off by 1.00000e-8"), "{}", off.wanted);
    }
}
