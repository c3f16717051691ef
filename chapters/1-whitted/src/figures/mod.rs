//! The figures of the chapter, one file each. To add one: write its `make`, name it in [`FIGURES`].

pub(crate) mod acne;
mod aliasing;
mod depth;
mod descartes;
mod diffuse;
mod exponent;
mod image_space;
mod indirect;
mod inverse_square;
mod local_model;
mod pruning;
pub(crate) mod quadratic;
mod ray_tree;
mod safety;
mod slab;
mod vanishing;
mod visible;
pub(crate) mod watertight;
mod where_time_goes;

use std::ops::AddAssign;

use glam::DVec2;
use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::geometry::Ray;
use lancer_core::image::{Defects, Image, ImageSize};
use lancer_core::metric::{absolute_error_map, compare};
use lancer_core::render::{Control, Rendering, render_pixels};
use lancer_core::sampling::PixelSampling;
use lancer_core::scene::Scene;
use lancer_core::world::World;
use lancer_figure::{Figure, HeatScale, Picture, Tile};
use lancer_whitted::{RayCounts, Recorder, Settings, Whitted};

/// All figures, in the lesson's order.
pub const FIGURES: &[Figure] = &[
    Figure { id: "0.1", name: "quadratic", make: quadratic::make },
    Figure { id: "0.2", name: "acne", make: acne::make },
    Figure { id: "0.3", name: "watertight", make: watertight::make },
    Figure { id: "0.4", name: "slab", make: slab::make },
    Figure { id: "0.5", name: "safety", make: safety::make },
    Figure { id: "1.1", name: "visible", make: visible::make },
    Figure { id: "1.2", name: "local-model", make: local_model::make },
    Figure { id: "1.3", name: "exponent", make: exponent::make },
    Figure { id: "1.4", name: "inverse-square", make: inverse_square::make },
    Figure { id: "1.5", name: "descartes", make: descartes::make },
    Figure { id: "1.6", name: "ray-tree", make: ray_tree::make },
    Figure { id: "1.7", name: "depth", make: depth::make },
    Figure { id: "1.8", name: "pruning", make: pruning::make },
    Figure { id: "1.9", name: "indirect", make: indirect::make },
    Figure { id: "1.10", name: "diffuse", make: diffuse::make },
    Figure { id: "1.11", name: "aliasing", make: aliasing::make },
    Figure { id: "1.12", name: "vanishing", make: vanishing::make },
    Figure { id: "1.13", name: "where-time-goes", make: where_time_goes::make },
    Figure { id: "1.14", name: "image-space", make: image_space::make },
];

/// The picture as a display shows it.
///
/// # Panics
/// If it holds something that is no radiance: a figure would hide that.
pub fn shown(image: &Image) -> Picture {
    assert_eq!(image.defects(), Defects::default(), "a picture of radiances");
    let ImageSize { width, height, .. } = image.size();
    Picture::new(width, height, image.to_srgb8(0.0))
}

/// Two pictures' pixels combined.
fn pixelwise(a: &Image, b: &Image, combine: impl Fn(f32, f32) -> f32) -> Image {
    let pixels = a.pixels().iter().zip(b.pixels());
    let pixels = pixels.map(|(a, b)| [0, 1, 2].map(|channel| combine(a[channel], b[channel])));
    Image::from_pixels(a.size(), pixels.collect())
}

/// All errors of a picture of the reference's size, by name.
fn errors_of(reference: &Image, image: &Image) -> [(&'static str, f64); 5] {
    compare(reference, image).expect("pictures of one size").named()
}

/// The map of a picture's errors on a scale that it may share with others.
fn error_tile(
    title: impl Into<String>,
    scale: &HeatScale,
    reference: &Image,
    image: &Image,
) -> Tile {
    let errors = absolute_error_map(reference, image).expect("pictures of one size");
    let ImageSize { width, height, .. } = image.size();
    Tile::new(title, scale.paint(width, height, &errors))
}

/// A picture of a scene: `radiance` along each ray through the picture; `counts` is anything that adds up.
pub fn picture<C: Default + Send + AddAssign>(
    scene: &Scene,
    size: ImageSize,
    sampling: PixelSampling,
    radiance: impl Fn(&Ray, &mut C) -> Rgb + Sync,
) -> Rendering<C> {
    let rays = scene.camera.primary_rays(size);
    let radiance = |film: DVec2, counts: &mut C| radiance(&rays.through(film.x, film.y), counts);
    let rendering = render_pixels(size, sampling, Control::default(), radiance);
    rendering.expect("nobody cancels a figure")
}

/// Whitted's method over a scene; `counts` is anything that follows the recursion.
fn trace_picture<C: Recorder + Default + Send + AddAssign>(
    scene: &Scene,
    settings: Settings,
    size: ImageSize,
    sampling: PixelSampling,
) -> Rendering<C> {
    let index = ObvhsBvh2::build(scene);
    let method = Whitted::new(World { scene, index: &index }, settings);
    picture(scene, size, sampling, |ray, counts| method.trace(ray, counts))
}

/// Whitted's method and its rays, one sample in the centre of each pixel.
fn whitted_picture(scene: &Scene, settings: Settings, size: ImageSize) -> Rendering<RayCounts> {
    trace_picture(scene, settings, size, PixelSampling::CENTER)
}

/// The exponent p of y ≈ c xᵖ: the slope between log axes, by least squares.
pub fn fitted_exponent(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean_x = logs.iter().map(|(x, _)| x).sum::<f64>() / count;
    let mean_y = logs.iter().map(|(_, y)| y).sum::<f64>() / count;
    let covariance: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    covariance / logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum::<f64>()
}
