//! The figures of the chapter, one file each. To add one: write its `make`, name it in [`FIGURES`].

mod aliasing;
mod depth;
mod descartes;
mod image_space;
mod local_model;
mod quadratic;
mod ray_tree;
mod vanishing;
mod visible;
mod watertight;

use std::ops::AddAssign;

use glam::DVec2;
use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::geometry::Ray;
use lancer_core::image::{Image, ImageSize};
use lancer_core::render::{Control, Rendering, render_pixels};
use lancer_core::sampling::PixelSampling;
use lancer_core::scene::Scene;
use lancer_core::world::World;
use lancer_figure::{Figure, Picture};
use lancer_whitted::{RayCounts, Recorder, Settings, Whitted};

/// All figures, in the lesson's order.
pub const FIGURES: &[Figure] = &[
    Figure { id: "0.1", name: "quadratic", make: quadratic::make },
    Figure { id: "0.3", name: "watertight", make: watertight::make },
    Figure { id: "1.1", name: "visible", make: visible::make },
    Figure { id: "1.2", name: "local-model", make: local_model::make },
    Figure { id: "1.5", name: "descartes", make: descartes::make },
    Figure { id: "1.6", name: "ray-tree", make: ray_tree::make },
    Figure { id: "1.7", name: "depth", make: depth::make },
    Figure { id: "1.11", name: "aliasing", make: aliasing::make },
    Figure { id: "1.12", name: "vanishing", make: vanishing::make },
    Figure { id: "1.14", name: "image-space", make: image_space::make },
];

/// The picture as a display shows it.
fn shown(image: &Image) -> Picture {
    let ImageSize { width, height, .. } = image.size();
    Picture::new(width, height, image.to_srgb8(0.0))
}

/// A picture of a scene: `radiance` along each ray through the picture; `counts` is anything that adds up.
fn picture<C: Default + Send + AddAssign>(
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
