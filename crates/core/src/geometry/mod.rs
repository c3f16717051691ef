//! Rays, the shapes they meet and how they leave them again.
//!
//! Everything that decides or measures is `f64`. Error bounds use γ(n) = n·u / (1 − n·u), the usual
//! bound on n rounded operations, with u = 2⁻⁵³ (Higham, *Accuracy and Stability of Numerical
//! Algorithms*, §3.1).

mod bounds;
mod leave;
mod ray;
mod real;
mod sphere;
mod triangle;
mod triangulate;
mod vector;
mod volume;

pub use bounds::{Bounds3, Slabs};
pub use leave::leave_surface;
pub use ray::{Interval, Ray};
pub use real::Real;
pub(crate) use real::powers;
pub use sphere::{Sphere, intersect_spheres};
pub use triangle::{
    Axis, Shear, TriangleHit, intersect_triangle, intersect_triangles, solve_triangle,
};
#[cfg(test)]
pub(crate) use triangulate::newell_normal;
pub(crate) use triangulate::triangulate;
pub use vector::{Vector, Vectors};
pub use volume::{ConvexVolume, HalfSpace};

/// γ(n): bounds the relative error of n rounded `f64` operations.
pub(crate) const fn gamma(n: u32) -> f64 {
    let nu = n as f64 * (0.5 * f64::EPSILON);
    nu / (1.0 - nu)
}
