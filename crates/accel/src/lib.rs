//! Chapter 4, « Accélération du lancer de rayons »: indexes that find what a ray meets without asking
//! every primitive.
//!
//! Each is exact: it returns the hit of [`lancer_core::intersector::LinearScan`], the same `t` bit for
//! bit and the same primitive. To that end boxes are culled conservatively and primitives are decided
//! by one shared `f64` test, [`lancer_core::intersector::Probe`].

mod bsp;
mod four_boxes;
mod kd;
mod obvhs_bvh2;
mod spatial;

pub use bsp::{BspBuilder, BspTree, Planes};
pub use kd::{KdBuilder, KdTree};
pub use obvhs_bvh2::ObvhsBvh2;
pub use spatial::Leaf;
