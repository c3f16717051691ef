use glam::DVec3;

use crate::geometry::Ray;
use crate::image::ImageSize;

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye, where all primary rays start.
    pub eye: DVec3,
    /// The point in the middle of the picture.
    pub look_at: DVec3,
    /// A direction that points up in the picture; not along the view axis.
    pub up: DVec3,
    /// Vertical opening angle in degrees, between 0 and 180.
    pub fov: f64,
}

impl Camera {
    /// Prepares the primary rays of a picture of this size. Pixels are square.
    pub fn primary_rays(&self, size: ImageSize) -> PrimaryRays {
        let forward = (self.look_at - self.eye).normalize();
        let right = forward.cross(self.up).normalize();
        let up = right.cross(forward);
        let half_height = (0.5 * self.fov.to_radians()).tan();
        let pixel = 2.0 * half_height / f64::from(size.height);
        let (across, down) = (right * pixel, -up * pixel);
        PrimaryRays {
            eye: self.eye,
            corner: forward
                - across * (0.5 * f64::from(size.width))
                - down * (0.5 * f64::from(size.height)),
            across,
            down,
        }
    }
}

/// « Ligne œil-pixel »: the primary rays of one picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimaryRays {
    eye: DVec3,
    /// From the eye to the picture's upper left corner, on the plane at distance 1.
    corner: DVec3,
    across: DVec3,
    down: DVec3,
}

impl PrimaryRays {
    /// The ray through the film point (x, y) in pixels: (0, 0) is the upper left corner of the
    /// picture and (0.5, 0.5) the centre of its first pixel. The direction has unit length.
    #[inline]
    pub fn through(&self, x: f64, y: f64) -> Ray {
        Ray::new(self.eye, (self.corner + x * self.across + y * self.down).normalize())
    }
}
