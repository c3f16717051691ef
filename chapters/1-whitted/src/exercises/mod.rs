//! The chapter's exercises, one file each, in the slides' order. A student writes the functions of
//! [`Subject`]; the stubs they start from are in `stubs/`.

mod e01_primary_ray;
mod e02_ray_triangle;
mod e03_ray_sphere;
mod e04_shadow_ray;
mod e05_local_light;
mod e06_reflected_ray;
mod stage;

pub mod prelude;
pub mod reference;

use glam::{DVec2, DVec3};
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray, Sphere};
use lancer_core::illumination::Reflectance;
use lancer_core::image::{Image, ImageSize};
use lancer_core::intersector::{Intersector, LinearScan};
use lancer_core::render::{Control, render_pixels};
use lancer_core::sampling::PixelSampling;
use lancer_core::scene::{Camera, Scene};
use lancer_core::world::SurfacePoint;
use lancer_exercise::Course;
use lancer_whitted::{Call, RayCounts};

use crate::figures::picture;

pub use stage::{Node, Stage};

/// t, and the weights of the triangle's corners in the point there, which add up to 1.
pub type Meeting = (f64, DVec3);

/// The radiance at a film point (x, y), in pixels.
pub type Film<'a> = dyn Fn(f64, f64) -> Rgb + 'a;

/// The functions that a student writes, as pointers: a tracer after Whitted, all of them together.
#[derive(Clone, Copy)]
pub struct Subject {
    /// The ray from the eye through the film point (x, y), in pixels from the upper left corner, with a
    /// unit direction.
    pub primary_ray: fn(&Camera, ImageSize, f64, f64) -> Ray,
    /// Where a ray meets a triangle.
    pub ray_triangle: fn([DVec3; 3], &Ray) -> Option<Meeting>,
    /// Where a ray first meets a sphere, from outside or inside.
    pub ray_sphere: fn(&Sphere, &Ray) -> Option<f64>,
    /// The ray from a surface to a lamp, which it reaches at t = 1.
    pub shadow_ray: fn(&SurfacePoint, DVec3) -> Ray,
    /// One lamp's part of `eq:local`: intensity, vis, distance, ρ_d ρ_s and n, N, L, V.
    pub local_light: fn(Rgb, bool, f64, &Reflectance, DVec3, DVec3, DVec3) -> Rgb,
    /// The mirror direction of an incident direction, given N.
    pub reflected_ray: fn(DVec3, DVec3) -> DVec3,
    /// The refracted direction of an incident one, given N, n₁ and n₂, unless it is totally reflected.
    pub refracted_ray: fn(DVec3, DVec3, f64, f64) -> Option<DVec3>,
    /// LR: the radiance along a ray that `depth` bounces have led to.
    pub lr: fn(&Stage, &Ray, u32) -> Rgb,
    /// The tree of a call of LR and of the calls that it makes.
    pub ray_tree: fn(&Stage, &Call) -> Node,
    /// The rays of a tree by kind.
    pub count_rays: fn(&Node) -> RayCounts,
    /// The mean radiance of a pixel (x, y) over a regular grid of n × n samples.
    pub pixel_mean: fn(&Film, u32, u32, u32) -> Rgb,
    /// The root mean square error over all pixels and channels: reference, estimate.
    pub rms_error: fn(&[Rgb], &[Rgb]) -> f64,
}

/// The chapter's exercises.
pub static COURSE: Course<Subject> = Course {
    package: "chapter-1",
    exercises: &[
        e01_primary_ray::EXERCISE,
        e02_ray_triangle::EXERCISE,
        e03_ray_sphere::EXERCISE,
        e04_shadow_ray::EXERCISE,
        e05_local_light::EXERCISE,
        e06_reflected_ray::EXERCISE,
    ],
    reference: reference::SUBJECT,
};

/// A picture of what the eye sees through each pixel's centre: `color` of its ray and the surface there.
fn drawn(
    scene: &Scene,
    size: ImageSize,
    color: impl Fn(&Ray, Option<SurfacePoint>) -> Rgb + Sync,
) -> Image {
    let oracle = LinearScan::new(scene);
    picture(scene, size, PixelSampling::CENTER, |ray, _: &mut u64| {
        let hit = oracle.closest_hit(ray, Interval::POSITIVE);
        color(ray, hit.map(|hit| scene.surface_at(ray, &hit)))
    })
    .image
}

/// A picture by film points, in pixels, one in each pixel's centre.
fn on_film(size: ImageSize, radiance: impl Fn(f64, f64) -> Rgb + Sync) -> Image {
    let radiance = |film: DVec2, _: &mut u64| radiance(film.x, film.y);
    let rendering = render_pixels(size, PixelSampling::CENTER, Control::default(), radiance);
    rendering.expect("nobody cancels an exercise").image
}
