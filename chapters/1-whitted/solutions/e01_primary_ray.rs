//! E1.1 The ray through a film point. Slide « Principe géométrique : ligne œil-pixel ».

use chapter_1::exercises::prelude::*;

/// The ray from the eye through a point of the film.
pub fn primary_ray(camera: &Camera, size: ImageSize, x: f64, y: f64) -> Ray {
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let forward = (camera.look_at - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let pixel = 2.0 * (0.5 * camera.fov.to_radians()).tan() / height;
    let (across, down) = (pixel * (x - 0.5 * width), pixel * (y - 0.5 * height));
    Ray::new(camera.eye, (forward + across * right - down * up).normalize())
}
