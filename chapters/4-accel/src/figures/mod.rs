//! The figures of the chapter, one file each. To add one: write its `make`, name it in [`FIGURES`].

mod grid;
mod heat;
mod irregular;

use chapter_1::figures::{picture, shown};
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::ImageSize;
use lancer_core::intersector::Hit;
use lancer_core::sampling::PixelSampling;
use lancer_core::scene::{Camera, Scene};
use lancer_figure::{Figure, Picture};

use crate::structures::structure;

/// All figures, in the lesson's order.
pub const FIGURES: &[Figure] = &[
    Figure { id: "4.5", name: "grid", make: grid::make },
    Figure { id: "4.6", name: "irregular", make: irregular::make },
    Figure { id: "4.8", name: "heat", make: heat::make },
];

/// A scene without light, the lighter the more it faces the eye.
fn shaded(scene: &Scene, camera: Camera, size: ImageSize) -> Picture {
    let index = (structure("bvh").build)(scene).index;
    let seen = Scene { camera, ..scene.clone() };
    let radiance = |ray: &Ray, _: &mut u32| {
        let facing = |hit: Hit| {
            let normal = seen.surface_at(ray, &hit).geometric_normal;
            normal.dot(ray.direction.normalize()).abs()
        };
        let hit = index.closest_hit(ray, Interval::POSITIVE);
        Rgb::splat(hit.map_or(1.0, |hit| 0.05 + 0.6 * facing(hit)))
    };
    shown(&picture(&seen, size, PixelSampling::CENTER, radiance).image)
}
