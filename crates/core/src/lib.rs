//! What every chapter of the course shares: geometry, the scene, the slides' equations, sampling,
//! pictures, error metrics and the render loop.
//!
//! ```text
//! scene.toml / model.obj ─▶ Scene ─▶ an Intersector built from it ─▶ World ─▶ a method ─▶ Image
//! ```
//!
//! Files are touched in two places only, [`scene::load`] and [`image`]; everything else is values in,
//! values out, with no globals, clocks or entropy, so that a run with the same seed gives the same
//! bits for any number of threads.

pub mod generate;
pub mod geometry;
pub mod illumination;
pub mod image;
pub mod intersector;
pub mod lanes;
pub mod method;
pub mod metric;
pub mod moving;
pub mod optics;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod world;

/// Linear RGB: a radiance, an intensity or a reflectance, one `f64` per channel.
pub type Rgb = glam::DVec3;
