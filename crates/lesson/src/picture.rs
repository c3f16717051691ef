//! Pictures of scenes, and how they come onto a plate.

use std::ops::AddAssign;

use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::{Defects, Image, ImageSize};
use lancer_core::intersector::{Intersector, LinearScan};
use lancer_core::render::{Control, Rendering, render_pixels};
use lancer_core::sampling::{PixelSampling, Sample};
use lancer_core::scene::Scene;
use lancer_core::world::SurfacePoint;
use lancer_figure::Picture;

/// The longest side of the small picture beside a walk, in pixels.
const SMALL: u32 = 256;

/// The picture as a display shows it.
///
/// # Panics
/// If it holds something that is no radiance: a figure would hide that.
pub fn shown(image: &Image) -> Picture {
    assert_eq!(image.defects(), Defects::default(), "a picture of radiances");
    let ImageSize { width, height, .. } = image.size();
    Picture::new(width, height, image.to_srgb8(0.0))
}

/// A picture of a scene: `radiance` along each ray through the picture; `counts` is anything that adds up.
pub fn picture<C: Default + Send + AddAssign>(
    scene: &Scene,
    size: ImageSize,
    sampling: PixelSampling,
    radiance: impl Fn(&Ray, &mut C) -> Rgb + Sync,
) -> Rendering<C> {
    let rays = scene.camera.primary_rays(size);
    let radiance = |sample: &Sample, counts: &mut C| {
        radiance(&rays.through(sample.film.x, sample.film.y), counts)
    };
    let rendering = render_pixels(size, sampling, Control::default(), radiance);
    rendering.expect("nobody cancels a figure")
}

/// A picture of what the eye sees through each pixel's centre: `color` of its ray and the surface there.
pub fn drawn(
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

/// A picture from what there is in the centre of each pixel, at the film point (x, y).
pub fn painted(size: ImageSize, radiance: impl Fn(f64, f64) -> Rgb + Sync) -> Image {
    let radiance = |sample: &Sample, _: &mut u64| radiance(sample.film.x, sample.film.y);
    let painting = render_pixels(size, PixelSampling::CENTER, Control::default(), radiance);
    painting.expect("nobody cancels a picture").image
}

/// A small picture of a scene with a pixel of it marked, and what it shows: `size` is that of the picture
/// that the pixel belongs to.
pub fn marked_picture(
    scene: &Scene,
    size: ImageSize,
    [x, y]: [u32; 2],
    radiance: impl Fn(&Ray) -> Rgb + Sync,
) -> (Picture, String) {
    let small = |side: u32| (side * SMALL).div_ceil(size.width.max(size.height)).min(side);
    let small_size = ImageSize::new(small(size.width), small(size.height));
    let rendering =
        picture(scene, small_size, PixelSampling::CENTER, |ray, _: &mut u64| radiance(ray));
    let scaled =
        |at: u32, side: u32| (u64::from(at) * u64::from(small(side)) / u64::from(side)) as u32;
    let marked = shown(&rendering.image).marked(scaled(x, size.width), scaled(y, size.height));
    (marked, format!("pixel ({x}, {y}) of {size}"))
}
