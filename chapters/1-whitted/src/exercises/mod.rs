//! The chapter's exercises, one file each, in the slides' order. A student writes the functions of
//! [`Subject`]; the stubs they start from are in `stubs/`.

mod e01_primary_ray;
mod e02_ray_triangle;
mod e03_ray_sphere;
mod e04_shadow_ray;
mod e05_local_light;
mod e06_reflected_ray;
mod e07_refracted_ray;
mod e08_lr;
mod e09_ray_tree;
mod e10_samples;
mod stage;

pub mod prelude;
pub mod reference;

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Ray, Sphere};
use lancer_core::illumination::Reflectance;
use lancer_core::image::ImageSize;
use lancer_core::scene::{Camera, Scene};
use lancer_core::world::SurfacePoint;
use lancer_exercise::{Course, Shown};
use lancer_lesson::picture::{drawn, painted};
use lancer_whitted::{Call, RayCounts, RayKind};

use crate::scenes;

pub use stage::{Node, Stage};

/// t, and the weights of the triangle's corners in the point there, which add up to 1.
pub type Meeting = (f64, DVec3);

/// The radiance at a film point (x, y), in pixels.
pub type FilmFunction<'a> = dyn Fn(f64, f64) -> Rgb + 'a;

/// A point of a surface in the light of one lamp, and from where it is seen.
#[derive(Clone, Copy, Debug)]
pub struct Lit {
    /// Iᵢ of the lamp, per channel.
    pub intensity: Rgb,
    /// vis(i): whether the shadow ray reaches the lamp.
    pub visible: bool,
    /// dᵢ from the surface to the lamp, in scene units.
    pub distance: f64,
    /// ρ_d and ρ_s per channel, and the exponent n.
    pub reflectance: Reflectance,
    /// The unit normal N, on the eye's side.
    pub n: DVec3,
    /// L, unit, from the surface to the lamp, which may be behind the surface.
    pub to_light: DVec3,
    /// V, unit, from the surface to the eye.
    pub to_eye: DVec3,
}

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
    /// One lamp's part of `eq:local`.
    pub local_light: fn(&Lit) -> Rgb,
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
    pub pixel_mean: fn(&FilmFunction, u32, u32, u32) -> Rgb,
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
        e07_refracted_ray::EXERCISE,
        e08_lr::EXERCISE,
        e09_ray_tree::EXERCISE,
        e10_samples::EXERCISE,
    ],
    reference: reference::SUBJECT,
};

/// The call of LR for a primary ray.
fn from_eye(ray: Ray) -> Call {
    Call { ray, depth: 0, weight: 1.0, kind: RayKind::Primary }
}

/// A small mirror a million times its size from the origin, and rays that come down onto it: rounding leaves the points
/// that they meet above it or below.
fn far_mirror() -> (String, Vec<Ray>) {
    let place = DVec3::new(1e6, -7e5, 1.3e6);
    let corners = [[2.1, 0.3, 1.7], [1.3, -0.4, -2.2], [-2.3, 0.2, 0.6]]
        .map(|corner| place + DVec3::from(corner));
    let vertices = corners.map(|DVec3 { x, y, z }| format!("[{x}, {y}, {z}]")).join(", ");
    let text = format!(
        "background = [0.2, 0.3, 0.4]
        material.mirror = {{ k_s = [0.5, 0.25, 0.125] }}
        polygon = [{{ vertices = [{vertices}], material = 'mirror' }}]"
    );
    let rays = (0..24).map(|k| {
        let (turn, weight) = (f64::from(k), 0.1 + f64::from(k) / 30.0);
        let [a, b, c] = corners;
        let target = weight * a + (1.0 - weight) * b.lerp(c, (0.618 * turn).fract());
        let from = DVec3::new(turn.cos(), 2.0, turn.sin());
        Ray::new(target + from, -from.normalize())
    });
    (text, rays.collect())
}

/// What it is, in words.
const FAR_MIRROR: &str = "a mirror 4 units wide and a million units from the origin, k_s = (0.5, 0.25, 0.125), \
                          background (0.2, 0.3, 0.4)";

/// Primary rays all over the title scene and their places in words, those with the fewest calls first: the
/// simplest counter-example comes before the others.
fn title_rays(max_depth: u32) -> (Scene, Vec<(String, Ray)>) {
    let (scene, size) = (scenes::whitted(), ImageSize::new(64, 48));
    let rays = scene.camera.primary_rays(size);
    let pixels = (0..64).step_by(7).flat_map(|x| (0..48).step_by(5).map(move |y| (x, y)));
    let mut rays: Vec<_> = pixels
        .map(|(x, y)| {
            let ray = rays.through(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let place = format!("scene whitted, column {x} and row {y} of {size}");
            (format!("{place}; {}, Max_Prof {max_depth}", ray.shown()), ray)
        })
        .collect();
    rays.sort_by_cached_key(|(_, ray)| {
        let stage = Stage::new(&scene, max_depth, reference::SUBJECT);
        stage.recorded(&from_eye(*ray)).nodes.len()
    });
    (scene, rays)
}
