//! E1.1 The ray through a film point. Slide « Principe géométrique : ligne œil-pixel ».

use chapter_1::exercises::prelude::*;

/// The ray from the eye through a point of the film.
///
/// - `camera.eye`: where the ray starts; `camera.look_at`: what stands in the middle of the picture.
/// - `camera.up`: points upwards in the picture. It may have any length, and need not be perpendicular to
///   the view axis.
/// - `camera.fov`: the *vertical* opening angle in degrees, from the lower edge to the upper.
/// - `size.width`, `size.height`: of the picture in pixels, which are square. They are `u32`;
///   `f64::from(size.width)` is a number to calculate with.
/// - `x` to the right and `y` *downwards*, in pixels: (0, 0) is the picture's upper left corner, and
///   (0.5, 0.5) the centre of its first pixel. Add nothing to them.
///
/// The ray's direction is unit.
pub fn primary_ray(camera: &Camera, size: ImageSize, x: f64, y: f64) -> Ray {
    todo!("E1.1: the ray through the film point")
}
