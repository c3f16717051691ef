//! « Accélération matérielle », on the processor: four `f64` at once, by AVX2 where the processor has it, and by a
//! scalar twin everywhere.

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
mod avx2;

use glam::{DVec3, DVec4};

use crate::geometry::{Ray, Real, Vectors};
use crate::illumination::Reflectance;
use crate::world::SurfacePoint;

#[cfg(target_arch = "x86_64")]
pub use avx2::{Avx2, Four, FourBits};

/// A way to compute with four `f64` at once. The value says that the processor can do it; the twins round alike.
pub trait FourLanes: Copy {
    /// Four numbers.
    type D: Real;

    /// Puts numbers side by side.
    fn four(self, x: [f64; 4]) -> Self::D;
    /// Takes them apart.
    fn numbers(self, x: Self::D) -> [f64; 4];
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

    /// Puts vectors side by side.
    #[inline(always)]
    fn vectors(self, [a, b, c, d]: [DVec3; 4]) -> Vectors<Self::D> {
        Vectors([
            self.four([a.x, b.x, c.x, d.x]),
            self.four([a.y, b.y, c.y, d.y]),
            self.four([a.z, b.z, c.z, d.z]),
        ])
    }

    /// Takes them apart.
    #[inline(always)]
    fn separate(self, Vectors([x, y, z]): Vectors<Self::D>) -> [DVec3; 4] {
        let [x, y, z] = [self.numbers(x), self.numbers(y), self.numbers(z)];
        [
            DVec3::new(x[0], y[0], z[0]),
            DVec3::new(x[1], y[1], z[1]),
            DVec3::new(x[2], y[2], z[2]),
            DVec3::new(x[3], y[3], z[3]),
        ]
    }

    /// Puts points of surfaces side by side.
    #[inline(always)]
    fn surfaces(self, [a, b, c, d]: [&SurfacePoint; 4]) -> SurfacePoint<Vectors<Self::D>, ()> {
        let geometric =
            [a.geometric_normal, b.geometric_normal, c.geometric_normal, d.geometric_normal];
        let shading = [a.shading_normal, b.shading_normal, c.shading_normal, d.shading_normal];
        SurfacePoint {
            position: self.vectors([a.position, b.position, c.position, d.position]),
            error: self.vectors([a.error, b.error, c.error, d.error]),
            geometric_normal: self.vectors(geometric),
            shading_normal: self.vectors(shading),
            lifted: self.vectors([a.lifted, b.lifted, c.lifted, d.lifted]),
            material: (),
        }
    }

    /// Puts constants of surfaces side by side.
    #[inline(always)]
    fn reflectances(self, [a, b, c, d]: [&Reflectance; 4]) -> Reflectance<Vectors<Self::D>> {
        Reflectance {
            diffuse: self.vectors([a.diffuse, b.diffuse, c.diffuse, d.diffuse]),
            specular: self.vectors([a.specular, b.specular, c.specular, d.specular]),
            shininess: self.four([a.shininess, b.shininess, c.shininess, d.shininess]),
        }
    }

    /// Takes rays apart.
    #[inline(always)]
    fn rays(self, ray: Ray<Vectors<Self::D>>) -> [Ray; 4] {
        let [o, d] = [self.separate(ray.origin), self.separate(ray.direction)];
        [Ray::new(o[0], d[0]), Ray::new(o[1], d[1]), Ray::new(o[2], d[2]), Ray::new(o[3], d[3])]
    }
}

/// One lane after the other. The compiler makes of it what the target always has: SSE2, NEON.
#[derive(Clone, Copy, Debug)]
pub struct Scalar;

impl FourLanes for Scalar {
    type D = DVec4;

    #[inline(always)]
    fn four(self, x: [f64; 4]) -> DVec4 {
        x.into()
    }

    #[inline(always)]
    fn numbers(self, x: DVec4) -> [f64; 4] {
        x.into()
    }

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
}

/// What computes with several lanes.
#[derive(Clone, Copy, Debug)]
pub enum Kernel {
    /// The processor's vectors.
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    /// None.
    Scalar(Scalar),
}

impl Kernel {
    /// The fastest that there is.
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = Avx2::detect() {
            return Self::Avx2(avx2);
        }
        Self::Scalar(Scalar)
    }
}

/// Calls a method with the lanes of a [`Kernel`], compiled for them.
#[macro_export]
macro_rules! with_lanes {
    ($kernel:expr, $this:ident.$method:ident($a:expr, $b:expr, $c:expr)) => {
        match $kernel {
            #[cfg(target_arch = "x86_64")]
            $crate::lanes::Kernel::Avx2(lanes) => $crate::lanes::FourLanes::call(
                lanes,
                $this,
                $a,
                $b,
                $c,
                #[inline(always)]
                |lanes, this, a, b, c| this.$method(lanes, a, b, c),
            ),
            $crate::lanes::Kernel::Scalar(lanes) => {
                $crate::lanes::FourLanes::call(lanes, $this, $a, $b, $c, |lanes, this, a, b, c| {
                    this.$method(lanes, a, b, c)
                })
            }
        }
    };
}
