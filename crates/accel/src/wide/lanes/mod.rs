//! Eight `f32` at once, besides four `f64`: by AVX2 where the processor has it, and by a scalar twin everywhere.

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
mod avx2;

use glam::DVec4;
use lancer_core::geometry::Real;
use lancer_core::lanes::{FourLanes, Scalar};

/// A way to compute with eight numbers, or four, at once. The twins may round differently (`mul_add` rounds once or
/// twice): the bounds of the tests hold for both, and so do their answers.
pub(super) trait Lanes: FourLanes {
    /// Eight numbers.
    type F: Copy;
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

/// a − b
#[inline(always)]
pub(super) fn difference<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
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
    fn apart<R>(self, f: impl FnOnce(Self) -> R) -> R {
        f(self)
    }
}
