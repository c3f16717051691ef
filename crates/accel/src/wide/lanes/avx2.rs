//! Every intrinsic here needs AVX2 or FMA: a value of [`Avx2`] exists only where the processor was found to have both,
//! and what [`FourLanes::call`] compiles for. Loads and stores go through references or slices whose lengths are checked.

use std::arch::asm;
use std::arch::x86_64::*;

use lancer_core::lanes::{Avx2, Four, FourLanes};

use super::Lanes;

// SAFETY of all blocks below: see the module's documentation.
impl Lanes for Avx2 {
    type F = __m256;
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
    fn one(self, x: f64) -> Four {
        self.four([x; 4])
    }

    #[inline(always)]
    fn number(self, x: Four) -> f64 {
        unsafe { _mm256_cvtsd_f64(x.vector()) }
    }

    #[inline(always)]
    fn narrow(self, low: Four, high: Four) -> __m256 {
        unsafe { _mm256_set_m128(_mm256_cvtpd_ps(high.vector()), _mm256_cvtpd_ps(low.vector())) }
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
