use glam::{DVec2, DVec3};

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

    /// The film point, in pixels, at which the picture shows `point`, or `None` if that is not before the
    /// eye: the ray [`PrimaryRays::through`] it points there. It may lie beside the picture.
    pub fn film_point(&self, point: DVec3) -> Option<DVec2> {
        let forward = self.across.cross(self.down).normalize();
        let to_point = point - self.eye;
        let depth = to_point.dot(forward);
        (depth > 0.0).then(|| {
            let on_film = to_point / depth - self.corner;
            let along = |side: DVec3| on_film.dot(side) / side.length_squared();
            DVec2::new(along(self.across), along(self.down))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_shown_where_its_ray_passes() {
        // By hand: the picture's half height is 1 at distance 1, a pixel too.
        let camera = Camera { eye: DVec3::ZERO, look_at: DVec3::NEG_Z, up: DVec3::Y, fov: 90.0 };
        let rays = camera.primary_rays(ImageSize::new(4, 2));
        let film = rays.film_point(DVec3::new(1.5, 1.5, -3.0)).unwrap();
        assert!((film - DVec2::new(2.5, 0.5)).length() < 1e-14, "{film}");
        assert_eq!(rays.film_point(DVec3::Z), None);

        let eye = DVec3::new(0.3, 1.7, 4.9);
        let camera = Camera { eye, look_at: DVec3::new(-0.1, 1.2, 0.0), fov: 60.0, ..camera };
        let rays = camera.primary_rays(ImageSize::new(320, 240));
        for (x, y) in [(0.0, 0.0), (17.25, 239.5), (-40.0, 300.0)] {
            let film = rays.film_point(rays.through(x, y).at(7.0)).unwrap();
            assert!((film - DVec2::new(x, y)).length() < 1e-10, "{film}");
        }
    }
}
