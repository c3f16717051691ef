//! The figures of the chapter, one file each. To add one: write its `make`, name it in [`FIGURES`].

pub(crate) mod acne;
mod aliasing;
mod camera_frame;
mod depth;
mod descartes;
mod diffuse;
mod directions;
mod edge_functions;
mod exponent;
mod image_space;
mod indirect;
mod inverse_square;
mod local_model;
mod pruning;
pub(crate) mod quadratic;
mod ray_tree;
mod refraction;
mod safety;
mod slab;
mod vanishing;
mod visible;
pub(crate) mod watertight;
mod where_time_goes;

use std::ops::AddAssign;

use glam::DVec3;
use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::geometry::Ray;
use lancer_core::image::ImageSize;
use lancer_core::render::{AlongRays, Control, Rendering, render_pixels};
use lancer_core::sampling::{PixelSampling, Sample};
use lancer_core::scene::Scene;
use lancer_core::world::World;
use lancer_figure::{Figure, Point};
use lancer_whitted::{RayCounts, Recorder, Settings, Whitted};

/// All figures, by number: the numerics, the course's plates, and the drawings of its geometry.
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
    Figure { id: "1.15", name: "camera-frame", make: camera_frame::make },
    Figure { id: "1.16", name: "edge-functions", make: edge_functions::make },
    Figure { id: "1.17", name: "directions", make: directions::make },
    Figure { id: "1.18", name: "refraction", make: refraction::make },
];

/// Whitted's method over a scene; `counts` is anything that follows many rays at once.
fn trace_picture<C: Recorder + Default + Send + AddAssign>(
    scene: &Scene,
    settings: Settings,
    size: ImageSize,
    sampling: PixelSampling,
) -> Rendering<C> {
    let index = ObvhsBvh2::build(scene);
    let world = World { scene, index: &index };
    let method = Whitted::new(world, settings);
    let trace = |rays: &[Ray], _: &[Sample], radiance: &mut [Rgb], counts: &mut C| {
        method.trace_all(rays, radiance, counts);
    };
    let rendering =
        render_pixels(size, sampling, Control::default(), AlongRays::new(world, size, trace));
    rendering.expect("nobody cancels a figure")
}

/// Whitted's method and its rays, one sample in the centre of each pixel.
fn whitted_picture(scene: &Scene, settings: Settings, size: ImageSize) -> Rendering<RayCounts> {
    trace_picture(scene, settings, size, PixelSampling::CENTER)
}

/// A direction in the plane of a drawing, whose z is 0.
fn flat(v: DVec3) -> Point {
    [v.x, v.y]
}

/// A direction in that plane, turned by `degrees` counter-clockwise.
fn turned(v: DVec3, degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    DVec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, 0.0)
}
