use std::ops::{Add, Mul, Neg, Sub};

use glam::DVec3;

use super::Real;
use super::real::dot;

/// What the slides' formulas compute with: a point, a direction or a colour, or several of them side by side, each
/// rounded like one alone. So a formula that stands once answers for one ray or for several, with the same bits.
pub trait Vector:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + Mul<Output = Self>
    + Mul<Self::Scalar, Output = Self>
{
    /// Its components.
    type Scalar: Real;

    /// The same vector everywhere. `self` shows that there can be such vectors.
    fn all(self, v: DVec3) -> Self;
    /// The scalar product.
    fn dot(self, other: Self) -> Self::Scalar;
    /// Of each component the absolute value.
    fn abs(self) -> Self;
    /// `v` where the mask is set, `w` elsewhere.
    fn select(mask: <Self::Scalar as Real>::Mask, v: Self, w: Self) -> Self;
    /// Where all components are 0.
    fn is_zero(self) -> <Self::Scalar as Real>::Mask;
}

impl Vector for DVec3 {
    type Scalar = f64;

    #[inline(always)]
    fn all(self, v: DVec3) -> Self {
        v
    }

    #[inline(always)]
    fn dot(self, other: Self) -> f64 {
        self.dot(other)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn select(mask: bool, v: Self, w: Self) -> Self {
        if mask { v } else { w }
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        self == Self::ZERO
    }
}

/// Several vectors side by side, component by component.
#[derive(Clone, Copy, Debug)]
pub struct Vectors<T>(pub [T; 3]);

impl<T: Real> Vectors<T> {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        let ([x, y, z], [p, q, r]) = (self.0, other.0);
        Self([f(x, p), f(y, q), f(z, r)])
    }
}

impl<T: Real> Add for Vectors<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, T::add)
    }
}

impl<T: Real> Sub for Vectors<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, T::sub)
    }
}

impl<T: Real> Mul for Vectors<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, T::mul)
    }
}

impl<T: Real> Mul<T> for Vectors<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        self.zip(Self([factor; 3]), T::mul)
    }
}

impl<T: Real> Neg for Vectors<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let [x, y, z] = self.0;
        Self([-x, -y, -z])
    }
}

impl<T: Real> Vector for Vectors<T> {
    type Scalar = T;

    #[inline(always)]
    fn all(self, v: DVec3) -> Self {
        let [x, y, z] = self.0;
        Self([x.all(v.x), y.all(v.y), z.all(v.z)])
    }

    #[inline(always)]
    fn dot(self, other: Self) -> T {
        dot(self.0, other.0)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let [x, y, z] = self.0;
        Self([x.abs(), y.abs(), z.abs()])
    }

    #[inline(always)]
    fn select(mask: T::Mask, v: Self, w: Self) -> Self {
        v.zip(
            w,
            #[inline(always)]
            |v, w| T::select(mask, v, w),
        )
    }

    #[inline(always)]
    fn is_zero(self) -> T::Mask {
        let [x, y, z] = self.0;
        let zero = x.all(0.0);
        let [x, y, z] = [x.abs(), y.abs(), z.abs()];
        x.at_most(zero) & y.at_most(zero) & z.at_most(zero)
    }
}
