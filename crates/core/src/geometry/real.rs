use std::ops::{Add, BitAnd, Div, Mul, Neg, Not, Sub};

use glam::{BVec4, DVec4};

/// What intersections compute with: an `f64`, or several side by side, each rounded like one alone. So a formula
/// that stands once answers for one primitive or for several, with the same bits.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The answers of a comparison.
    type Mask: Copy + BitAnd<Output = Self::Mask> + Not<Output = Self::Mask>;

    /// The same number everywhere. `self` shows that there can be such numbers.
    fn all(self, x: f64) -> Self;
    /// √x
    fn sqrt(self) -> Self;
    /// |x|
    fn abs(self) -> Self;
    /// |x| with the sign of another number.
    fn copysign(self, sign: Self) -> Self;
    /// x < y, not where one is NaN.
    fn below(self, y: Self) -> Self::Mask;
    /// x ≤ y, not where one is NaN.
    fn at_most(self, y: Self) -> Self::Mask;
    /// x where the mask is set, y elsewhere.
    fn select(mask: Self::Mask, x: Self, y: Self) -> Self;
    /// A mask as bits, the first place being the lowest.
    fn bits(mask: Self::Mask) -> u32;
    /// x to a power where the mask is set, 0 elsewhere.
    fn power(self, exponent: Self, mask: Self::Mask) -> Self;

    /// 1 / x
    #[inline(always)]
    fn recip(self) -> Self {
        self.all(1.0) / self
    }

    /// The smaller, y where one is NaN: a single instruction, unlike `f64::min`.
    #[inline(always)]
    fn smaller(self, y: Self) -> Self {
        Self::select(self.below(y), self, y)
    }

    /// The larger, y where one is NaN.
    #[inline(always)]
    fn larger(self, y: Self) -> Self {
        Self::select(y.below(self), self, y)
    }
}

/// a·b, summed as glam sums it.
#[inline(always)]
pub(super) fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b
#[inline(always)]
pub(super) fn cross<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}

/// Of four numbers those powers whose bits are set.
#[inline]
pub(crate) fn powers(x: [f64; 4], exponent: [f64; 4], bits: u32) -> [f64; 4] {
    std::array::from_fn(|k| x[k].power(exponent[k], bits >> k & 1 != 0))
}

impl Real for f64 {
    type Mask = bool;

    #[inline(always)]
    fn all(self, x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        self.copysign(sign)
    }

    #[inline(always)]
    fn below(self, y: Self) -> bool {
        self < y
    }

    #[inline(always)]
    fn at_most(self, y: Self) -> bool {
        self <= y
    }

    #[inline(always)]
    fn select(mask: bool, x: Self, y: Self) -> Self {
        if mask { x } else { y }
    }

    #[inline(always)]
    fn bits(mask: bool) -> u32 {
        mask.into()
    }

    #[inline(always)]
    fn power(self, exponent: Self, mask: bool) -> Self {
        if mask { self.powf(exponent) } else { 0.0 }
    }
}

impl Real for DVec4 {
    type Mask = BVec4;

    #[inline(always)]
    fn all(self, x: f64) -> Self {
        Self::splat(x)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        self.copysign(sign)
    }

    #[inline(always)]
    fn below(self, y: Self) -> BVec4 {
        self.cmplt(y)
    }

    #[inline(always)]
    fn at_most(self, y: Self) -> BVec4 {
        self.cmple(y)
    }

    #[inline(always)]
    fn select(mask: BVec4, x: Self, y: Self) -> Self {
        Self::select(mask, x, y)
    }

    #[inline(always)]
    fn bits(mask: BVec4) -> u32 {
        mask.bitmask()
    }

    #[inline(always)]
    fn power(self, exponent: Self, mask: BVec4) -> Self {
        powers(self.to_array(), exponent.to_array(), mask.bitmask()).into()
    }
}
