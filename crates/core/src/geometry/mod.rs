//! Rays and the shapes they meet. Everything that decides or measures is `f64`.

mod ray;
mod sphere;

pub use ray::{Interval, Ray};
pub use sphere::Sphere;
