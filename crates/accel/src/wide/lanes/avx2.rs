//! Every intrinsic here needs AVX2 or FMA: a value of [`Avx2`] exists only where the processor was found to have both,
//! and what [`Avx2::call`] compiles for. Loads and stores go through references or slices whose lengths are checked.

use std::arch::asm;
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, Div, Mul, Neg, Not, Sub};

use lancer_core::geometry::Real;

use super::Lanes;

/// A processor with AVX2, FMA, BMI1, BMI2, LZCNT and POPCNT.
#[derive(Clone, Copy, Debug)]
pub(in crate::wide) struct Avx2(());

impl Avx2 {
    pub(in crate::wide) fn detect() -> Option<Self> {
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
pub(in crate::wide) struct Four(__m256d);

/// Which of four.
#[derive(Clone, Copy)]
pub(in crate::wide) struct FourBits(__m256d);

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
    fn smaller(self, y: Self) -> Self {
        Self(unsafe { _mm256_min_pd(self.0, y.0) })
    }

    #[inline(always)]
    fn larger(self, y: Self) -> Self {
        Self(unsafe { _mm256_max_pd(self.0, y.0) })
    }
}

impl Lanes for Avx2 {
    type F = __m256;
    type D = Four;
    type One = Four;

    #[inline(always)]
    fn splat(self, x: f32) -> __m256 {
        unsafe { _mm256_set1_ps(x) }
    }

    #[inline(always)]
    fn load(self, x: &[f32; 8]) -> __m256 {
        unsafe { _mm256_loadu_ps(x.as_ptr()) }
    }

    #[inline(always)]
    fn rows<const N: usize>(self, x: &[f32], n: usize) -> [__m256; N] {
        assert!(x.len() >= (N - 1) * n + 8);
        unsafe { std::array::from_fn(|row| _mm256_loadu_ps(x.as_ptr().add(row * n))) }
    }

    #[inline(always)]
    fn store(self, x: __m256) -> [f32; 8] {
        let mut lanes = [0.0; 8];
        unsafe { _mm256_storeu_ps(lanes.as_mut_ptr(), x) };
        lanes
    }

    #[inline(always)]
    fn add(self, a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_add_ps(a, b) }
    }

    #[inline(always)]
    fn sub(self, a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_sub_ps(a, b) }
    }

    #[inline(always)]
    fn mul(self, a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_mul_ps(a, b) }
    }

    #[inline(always)]
    fn div(self, a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_div_ps(a, b) }
    }

    #[inline(always)]
    fn mul_add(self, a: __m256, b: __m256, c: __m256) -> __m256 {
        unsafe { _mm256_fmadd_ps(a, b, c) }
    }

    #[inline(always)]
    fn mul_sub(self, a: __m256, b: __m256, c: __m256) -> __m256 {
        unsafe { _mm256_fmsub_ps(a, b, c) }
    }

    #[inline(always)]
    fn min(self, a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_min_ps(a, b) }
    }

    #[inline(always)]
    fn max(self, a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_max_ps(a, b) }
    }

    #[inline(always)]
    fn turn(self, a: __m256, sign: __m256) -> __m256 {
        unsafe { _mm256_xor_ps(a, _mm256_and_ps(sign, _mm256_set1_ps(-0.0))) }
    }

    #[inline(always)]
    fn abs(self, a: __m256) -> __m256 {
        unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), a) }
    }

    #[inline(always)]
    fn at_least(self, a: __m256, b: __m256) -> u32 {
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(a, b)) as u32 }
    }

    #[inline(always)]
    fn above(self, a: __m256, b: __m256) -> u32 {
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(a, b)) as u32 }
    }

    #[inline(always)]
    fn select(self, bits: u32, a: __m256, b: __m256) -> __m256 {
        unsafe {
            let lanes = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let set = _mm256_and_si256(_mm256_set1_epi32(bits as i32), lanes);
            let mask = _mm256_cmpeq_epi32(set, lanes);
            _mm256_blendv_ps(b, a, _mm256_castsi256_ps(mask))
        }
    }

    #[inline(always)]
    fn four(self, [a, b, c, d]: [f64; 4]) -> Four {
        Four(unsafe { _mm256_setr_pd(a, b, c, d) })
    }

    #[inline(always)]
    fn numbers(self, x: Four) -> [f64; 4] {
        let mut numbers = [0.0; 4];
        unsafe { _mm256_storeu_pd(numbers.as_mut_ptr(), x.0) };
        numbers
    }

    #[inline(always)]
    fn one(self, x: f64) -> Four {
        Four(unsafe { _mm256_set1_pd(x) })
    }

    #[inline(always)]
    fn number(self, x: Four) -> f64 {
        unsafe { _mm256_cvtsd_f64(x.0) }
    }

    #[inline(always)]
    fn narrow(self, low: Four, high: Four) -> __m256 {
        unsafe { _mm256_set_m128(_mm256_cvtpd_ps(high.0), _mm256_cvtpd_ps(low.0)) }
    }

    #[inline(always)]
    fn read_here<T>(self, x: &T) -> &T {
        let mut place = std::ptr::from_ref(x);
        // SAFETY: there is no instruction, so it is the same place.
        unsafe {
            asm!("/* {0} */", inout(reg) place, options(readonly, nostack, preserves_flags));
            &*place
        }
    }

    #[inline(always)]
    fn read_alone(self, x: &f64) -> f64 {
        // SAFETY: a reference can be read through.
        unsafe { std::ptr::from_ref(x).read_volatile() }
    }

    #[inline(always)]
    fn prefetch<T>(self, soon: &T) {
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(soon).cast()) }
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

    #[inline(always)]
    fn apart<R>(self, f: impl FnOnce(Self) -> R) -> R {
        #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
        #[inline(never)]
        fn inner<R>(lanes: Avx2, f: impl FnOnce(Avx2) -> R) -> R {
            f(lanes)
        }
        // SAFETY: as in `call`.
        unsafe { inner(self, f) }
    }
}
