//! E1.1 The ray through a film point. Slide « Principe géométrique : ligne œil-pixel ».

use chapter_1::exercises::prelude::*;

// Rust in five lines, for a reader of C++:
//   let half = 0.5 * camera.fov;                    names a value; one that is to change is `let mut`
//   let sign = if x < half { -1.0 } else { 1.0 };   `if` has a value: a block's is its last line, without `;`
//   f64::from(n) / 2.0, k as f64                    numbers from a `u32` n, a `usize` k; as integers 7 / 2 is 3
//   2.0 * a - b, a.dot(b), a.cross(b), a.length(), a.normalize(), a.x or a[0]      with `DVec3`, three `f64`
//   Some(t), None                                   an `Option<f64>`: a number, or none

/// The ray from the eye through a point of the film.
///
/// - `camera.eye`: where the ray starts; `camera.look_at`: what stands in the middle of the picture.
/// - `camera.up`: points upwards in the picture. It may have any length, and need not be perpendicular to
///   the view axis.
/// - `camera.fov`: the *vertical* opening angle in degrees, from the lower edge to the upper.
/// - `size.width`, `size.height`: of the picture in pixels, which are square. They are `u32`.
/// - `x` to the right and `y` *downwards*, in pixels: (0, 0) is the picture's upper left corner, and
///   (0.5, 0.5) the centre of its first pixel. Add nothing to them.
///
/// The answer is `Ray::new(origin, direction)` with a unit direction; both are `DVec3`.
/// (`Ray` is in crates/core/src/geometry/ray.rs, `Camera` in crates/core/src/scene/camera.rs; what a stub
/// may use is named in chapters/1-whitted/src/exercises/prelude.rs.)
pub fn primary_ray(camera: &Camera, size: ImageSize, x: f64, y: f64) -> Ray {
    todo!("E1.1: the ray through the film point")
}
