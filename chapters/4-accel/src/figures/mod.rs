//! The figures of the chapter, one file each. To add one: write its `make`, name it in [`FIGURES`].

mod agreement;
mod beams;
mod builders;
mod coherence;
mod grid;
mod hardware;
mod heat;
mod irregular;
mod nothing;
mod sah;
mod slab_test;
mod split;
mod structures;
mod volumes;
mod walk;

use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::ImageSize;
use lancer_core::intersector::Hit;
use lancer_core::sampling::PixelSampling;
use lancer_core::scene::{Camera, Scene};
use lancer_figure::{Figure, Picture};
use lancer_lesson::picture::{picture, shown};

use lancer_accel::structures::structure;

/// All figures, by their numbers.
pub const FIGURES: &[Figure] = &[
    Figure { id: "4.1", name: "nothing", make: nothing::make },
    Figure { id: "4.2", name: "volumes", make: volumes::make },
    Figure { id: "4.3", name: "builders", make: builders::make },
    Figure { id: "4.4", name: "sah", make: sah::make },
    Figure { id: "4.5", name: "grid", make: grid::make },
    Figure { id: "4.6", name: "irregular", make: irregular::make },
    Figure { id: "4.7", name: "structures", make: structures::make },
    Figure { id: "4.8", name: "heat", make: heat::make },
    Figure { id: "4.9", name: "coherence", make: coherence::make },
    Figure { id: "4.10", name: "hardware", make: hardware::make },
    Figure { id: "4.11", name: "agreement", make: agreement::make },
    Figure { id: "4.12", name: "beams", make: beams::make },
    // Drawings, which the lesson shows before the measurements of their sections.
    Figure { id: "4.13", name: "slab-test", make: slab_test::make },
    Figure { id: "4.14", name: "split", make: split::make },
    Figure { id: "4.15", name: "walk", make: walk::make },
];

/// A wrong answer of what decides in `f32`: nothing where there is something, something where there is nothing, or a
/// parameter off by a thousandth.
fn is_off(t: Option<f32>, truth: Option<Hit>) -> bool {
    match (t, truth) {
        (Some(t), Some(hit)) => (f64::from(t) / hit.t - 1.0).abs() > 1e-3,
        (t, truth) => t.is_some() || truth.is_some(),
    }
}

/// A scene without light, the lighter the more it faces the eye.
fn shaded(scene: &Scene, camera: Camera, size: ImageSize) -> Picture {
    let index = structure("bvh").build(scene).index;
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
