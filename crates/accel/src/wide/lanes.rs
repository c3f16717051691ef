//! Eight `f32`, or four `f64`, at once: by AVX2 where the processor has it, and by a scalar twin everywhere.

use glam::{DVec3, DVec4};
use lancer_core::geometry::Real;

/// A way to compute with eight numbers, or four, at once.
///
/// The value says that the processor can do it. The twins may round differently (`mul_add` rounds once or
/// twice): the bounds of the tests hold for both, and so do their answers.
pub(super) trait Lanes: Copy {
    /// Eight numbers.
    type F: Copy;
    /// Four `f64`.
    type D: Real;
    /// One `f64`, perhaps several times.
    type One: Real;

    fn splat(self, x: f32) -> Self::F;
    fn load(self, x: &[f32; 8]) -> Self::F;
    /// `N` rows of `n` ≤ 8 numbers that stand one after another; what follows is in the other lanes.
    fn rows<const N: usize>(self, x: &[f32], n: usize) -> [Self::F; N];
    fn store(self, x: Self::F) -> [f32; 8];
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// a b + c
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// a b − c
    fn mul_sub(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// The smaller, `b` if one is NaN.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// The larger, `b` if one is NaN.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a` with its sign turned where `sign` is negative.
    fn turn(self, a: Self::F, sign: Self::F) -> Self::F;
    fn abs(self, a: Self::F) -> Self::F;
    /// One bit per lane: a ≥ b.
    fn at_least(self, a: Self::F, b: Self::F) -> u32;
    /// One bit per lane: a > b.
    fn above(self, a: Self::F, b: Self::F) -> u32;
    /// `a` in the lanes whose bit is set, `b` in the others.
    fn select(self, bits: u32, a: Self::F, b: Self::F) -> Self::F;
    fn four(self, x: [f64; 4]) -> Self::D;
    fn numbers(self, x: Self::D) -> [f64; 4];
    fn one(self, x: f64) -> Self::One;
    fn number(self, x: Self::One) -> f64;
    /// Eight `f64`, rounded.
    fn narrow(self, low: Self::D, high: Self::D) -> Self::F;
    /// The same reference, of which the compiler does not know what it refers to: it reads that where it is used,
    /// instead of broadcasting it beforehand and storing all lanes.
    fn read_here<T>(self, x: &T) -> &T;
    /// A number, read by itself and not together with its neighbours.
    fn read_alone(self, x: &f64) -> f64;
    /// Brings what will be read soon into the caches.
    fn prefetch<T>(self, soon: &T);
    /// Calls `f`, which is compiled for this way with everything inlined into it. Arguments go in registers:
    /// through the memory of a closure they would be read in other pieces than written.
    fn call<A, B, C, D, R>(
        self,
        a: A,
        b: B,
        c: C,
        d: D,
        f: impl FnOnce(Self, A, B, C, D) -> R,
    ) -> R;
    /// Calls `f`, compiled apart: what it needs in registers does not displace what its caller has there.
    fn apart<R>(self, f: impl FnOnce(Self) -> R) -> R;
}

/// Three coordinates, or directions, of eight things.
pub(super) type Vectors<L> = [<L as Lanes>::F; 3];

// Functions, not closures: only what is surely inlined is compiled for the processor that was found.

#[inline(always)]
pub(super) fn splat3<L: Lanes>(l: L, [x, y, z]: [f32; 3]) -> Vectors<L> {
    [l.splat(x), l.splat(y), l.splat(z)]
}

#[inline(always)]
pub(super) fn sub3<L: Lanes>(l: L, a: Vectors<L>, b: Vectors<L>) -> Vectors<L> {
    [l.sub(a[0], b[0]), l.sub(a[1], b[1]), l.sub(a[2], b[2])]
}

#[inline(always)]
pub(super) fn cross<L: Lanes>(l: L, a: Vectors<L>, b: Vectors<L>) -> Vectors<L> {
    [
        l.mul_sub(a[1], b[2], l.mul(a[2], b[1])),
        l.mul_sub(a[2], b[0], l.mul(a[0], b[2])),
        l.mul_sub(a[0], b[1], l.mul(a[1], b[0])),
    ]
}

#[inline(always)]
pub(super) fn dot<L: Lanes>(l: L, a: Vectors<L>, b: Vectors<L>) -> L::F {
    l.mul_add(a[0], b[0], l.mul_add(a[1], b[1], l.mul(a[2], b[2])))
}

/// The components of four vectors.
#[inline(always)]
pub(super) fn gather<L: Lanes>(l: L, [a, b, c, d]: [DVec3; 4]) -> [L::D; 3] {
    [l.four([a.x, b.x, c.x, d.x]), l.four([a.y, b.y, c.y, d.y]), l.four([a.z, b.z, c.z, d.z])]
}

/// The smallest of eight numbers, none of which is NaN.
#[inline(always)]
pub(super) fn least<L: Lanes>(l: L, x: L::F) -> f32 {
    let x = l.store(x);
    let four: [f32; 4] = each(|k| if x[k] < x[k + 4] { x[k] } else { x[k + 4] });
    let [a, b]: [f32; 2] = each(|k| if four[k] < four[k + 2] { four[k] } else { four[k + 2] });
    if a < b { a } else { b }
}

/// The largest.
#[inline(always)]
pub(super) fn most<L: Lanes>(l: L, x: L::F) -> f32 {
    -least(l, l.sub(l.splat(0.0), x))
}

/// One lane after the other. The compiler makes of it what the target always has: SSE2, NEON.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scalar;

#[inline(always)]
fn each<T, const N: usize>(f: impl FnMut(usize) -> T) -> [T; N] {
    std::array::from_fn(f)
}

#[inline(always)]
fn bits(f: impl Fn(usize) -> bool) -> u32 {
    (0..8).fold(0, |bits, lane| bits | u32::from(f(lane)) << lane)
}

impl Lanes for Scalar {
    type F = [f32; 8];
    type D = DVec4;
    type One = f64;

    #[inline(always)]
    fn splat(self, x: f32) -> [f32; 8] {
        [x; 8]
    }

    #[inline(always)]
    fn load(self, x: &[f32; 8]) -> [f32; 8] {
        *x
    }

    #[inline(always)]
    fn rows<const N: usize>(self, x: &[f32], n: usize) -> [[f32; 8]; N] {
        std::array::from_fn(|row| std::array::from_fn(|lane| x[row * n + lane]))
    }

    #[inline(always)]
    fn store(self, x: [f32; 8]) -> [f32; 8] {
        x
    }

    #[inline(always)]
    fn add(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(|k| a[k] + b[k])
    }

    #[inline(always)]
    fn sub(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(|k| a[k] - b[k])
    }

    #[inline(always)]
    fn mul(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(|k| a[k] * b[k])
    }

    #[inline(always)]
    fn div(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(|k| a[k] / b[k])
    }

    #[inline(always)]
    fn mul_add(self, a: [f32; 8], b: [f32; 8], c: [f32; 8]) -> [f32; 8] {
        each(|k| a[k] * b[k] + c[k])
    }

    #[inline(always)]
    fn mul_sub(self, a: [f32; 8], b: [f32; 8], c: [f32; 8]) -> [f32; 8] {
        each(|k| a[k] * b[k] - c[k])
    }

    #[inline(always)]
    fn min(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(|k| if a[k] < b[k] { a[k] } else { b[k] })
    }

    #[inline(always)]
    fn max(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(|k| if a[k] > b[k] { a[k] } else { b[k] })
    }

    #[inline(always)]
    fn turn(self, a: [f32; 8], sign: [f32; 8]) -> [f32; 8] {
        each(|k| f32::from_bits(a[k].to_bits() ^ (sign[k].to_bits() & 1 << 31)))
    }

    #[inline(always)]
    fn abs(self, a: [f32; 8]) -> [f32; 8] {
        each(|k| a[k].abs())
    }

    #[inline(always)]
    fn at_least(self, a: [f32; 8], b: [f32; 8]) -> u32 {
        bits(|k| a[k] >= b[k])
    }

    #[inline(always)]
    fn above(self, a: [f32; 8], b: [f32; 8]) -> u32 {
        bits(|k| a[k] > b[k])
    }

    #[inline(always)]
    fn select(self, bits: u32, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(|k| if bits >> k & 1 != 0 { a[k] } else { b[k] })
    }

    #[inline(always)]
    fn four(self, x: [f64; 4]) -> DVec4 {
        x.into()
    }

    #[inline(always)]
    fn numbers(self, x: DVec4) -> [f64; 4] {
        x.into()
    }

    #[inline(always)]
    fn one(self, x: f64) -> f64 {
        x
    }

    #[inline(always)]
    fn number(self, x: f64) -> f64 {
        x
    }

    #[inline(always)]
    fn narrow(self, low: DVec4, high: DVec4) -> [f32; 8] {
        each(|k| (if k < 4 { low[k] } else { high[k - 4] }) as f32)
    }

    #[inline(always)]
    fn read_here<T>(self, x: &T) -> &T {
        x
    }

    #[inline(always)]
    fn read_alone(self, x: &f64) -> f64 {
        *x
    }

    #[inline(always)]
    fn prefetch<T>(self, _: &T) {}

    #[inline(never)]
    fn call<A, B, C, D, R>(
        self,
        a: A,
        b: B,
        c: C,
        d: D,
        f: impl FnOnce(Self, A, B, C, D) -> R,
    ) -> R {
        f(self, a, b, c, d)
    }

    #[inline(never)]
    fn apart<R>(self, f: impl FnOnce(Self) -> R) -> R {
        f(self)
    }
}

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
pub(super) mod avx2 {
    //! Every intrinsic here needs AVX2 or FMA and nothing else: a value
    //! of [`Avx2`] exists only where the processor was found to have both. Loads and stores go through
    //! references or slices whose lengths are checked.

    use std::arch::asm;
    use std::arch::x86_64::*;
    use std::ops::{Add, BitAnd, Div, Mul, Neg, Not, Sub};

    use lancer_core::geometry::Real;

    use super::Lanes;

    /// A processor with AVX2 and FMA.
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
            unsafe { inner(self, f) }
        }
    }
}
