//! Every intrinsic here needs AVX2: a value of [`Avx2`] exists only where the processor was found to have it,
//! and what [`FourLanes::call`] compiles for. Stores go to arrays.

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, Div, Mul, Neg, Not, Sub};

use super::FourLanes;
use crate::geometry::{Real, powers};

/// A processor with AVX2, FMA, BMI1, BMI2, LZCNT and POPCNT.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

impl Avx2 {
    /// The value, if the processor is one.
    pub fn detect() -> Option<Self> {
        let found = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        found.then_some(Self(()))
    }
}

// SAFETY of all blocks below: see the module's documentation.
/// Four `f64`, which only a value of [`Avx2`] makes.
#[derive(Clone, Copy)]
pub struct Four(__m256d);

/// Which of four.
#[derive(Clone, Copy)]
pub struct FourBits(__m256d);

impl Four {
    #[inline(always)]
    fn from_array([a, b, c, d]: [f64; 4]) -> Self {
        Self(unsafe { _mm256_setr_pd(a, b, c, d) })
    }

    #[inline(always)]
    fn to_array(self) -> [f64; 4] {
        let mut numbers = [0.0; 4];
        unsafe { _mm256_storeu_pd(numbers.as_mut_ptr(), self.0) };
        numbers
    }

    /// The processor's own type.
    #[inline(always)]
    pub fn vector(self) -> __m256d {
        self.0
    }
}

impl Add for Four {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self(unsafe { _mm256_add_pd(self.0, b.0) })
    }
}

impl Sub for Four {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self(unsafe { _mm256_sub_pd(self.0, b.0) })
    }
}

impl Mul for Four {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self(unsafe { _mm256_mul_pd(self.0, b.0) })
    }
}

impl Div for Four {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        Self(unsafe { _mm256_div_pd(self.0, b.0) })
    }
}

impl Neg for Four {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

impl BitAnd for FourBits {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, b: Self) -> Self {
        Self(unsafe { _mm256_and_pd(self.0, b.0) })
    }
}

impl Not for FourBits {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        unsafe {
            let all = _mm256_castsi256_pd(_mm256_set1_epi64x(-1));
            Self(_mm256_xor_pd(self.0, all))
        }
    }
}

impl Real for Four {
    type Mask = FourBits;

    #[inline(always)]
    fn all(self, x: f64) -> Self {
        Self(unsafe { _mm256_set1_pd(x) })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        unsafe {
            let sign = _mm256_and_pd(_mm256_set1_pd(-0.0), sign.0);
            Self(_mm256_or_pd(self.abs().0, sign))
        }
    }

    #[inline(always)]
    fn below(self, y: Self) -> FourBits {
        FourBits(unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, y.0) })
    }

    #[inline(always)]
    fn at_most(self, y: Self) -> FourBits {
        FourBits(unsafe { _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, y.0) })
    }

    #[inline(always)]
    fn select(mask: FourBits, x: Self, y: Self) -> Self {
        Self(unsafe { _mm256_blendv_pd(y.0, x.0, mask.0) })
    }

    #[inline(always)]
    fn bits(mask: FourBits) -> u32 {
        unsafe { _mm256_movemask_pd(mask.0) as u32 }
    }

    #[inline(always)]
    fn power(self, exponent: Self, mask: FourBits) -> Self {
        let bits = Self::bits(mask);
        if bits == 0 {
            return self.all(0.0);
        }
        Self::from_array(powers(self.to_array(), exponent.to_array(), bits))
    }

    #[inline(always)]
    fn smaller(self, y: Self) -> Self {
        Self(unsafe { _mm256_min_pd(self.0, y.0) })
    }

    #[inline(always)]
    fn larger(self, y: Self) -> Self {
        Self(unsafe { _mm256_max_pd(self.0, y.0) })
    }
}

impl FourLanes for Avx2 {
    type D = Four;

    #[inline(always)]
    fn four(self, x: [f64; 4]) -> Four {
        Four::from_array(x)
    }

    #[inline(always)]
    fn numbers(self, x: Four) -> [f64; 4] {
        x.to_array()
    }

    #[inline(always)]
    fn call<A, B, C, D, R>(
        self,
        a: A,
        b: B,
        c: C,
        d: D,
        f: impl FnOnce(Self, A, B, C, D) -> R,
    ) -> R {
        #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
        #[inline]
        fn inner<A, B, C, D, R>(
            lanes: Avx2,
            a: A,
            b: B,
            c: C,
            d: D,
            f: impl FnOnce(Avx2, A, B, C, D) -> R,
        ) -> R {
            f(lanes, a, b, c, d)
        }
        // SAFETY: `self` says that the processor has these features.
        unsafe { inner(self, a, b, c, d, f) }
    }
}
