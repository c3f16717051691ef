use glam::{DMat3, DVec2, DVec3};

use crate::geometry::{ConvexVolume, Ray};
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
        let corner = forward
            - across * (0.5 * f64::from(size.width))
            - down * (0.5 * f64::from(size.height));
        let to_film = DMat3::from_cols(across, down, corner).inverse();
        PrimaryRays { eye: self.eye, corner, across, down, to_film }
    }
}

/// « Ligne œil-pixel »: the primary rays of one picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimaryRays {
    eye: DVec3,
    /// The way from the eye to the picture's upper left corner, on the plane at distance 1.
    corner: DVec3,
    across: DVec3,
    down: DVec3,
    /// The inverse of (x, y, z) ↦ x · across + y · down + z · corner.
    to_film: DMat3,
}

impl PrimaryRays {
    /// The ray through the film point (x, y) in pixels: (0, 0) is the upper left corner of the
    /// picture and (0.5, 0.5) the centre of its first pixel. The direction has unit length.
    #[inline]
    pub fn through(&self, x: f64, y: f64) -> Ray {
        Ray::new(self.eye, (self.corner + x * self.across + y * self.down).normalize())
    }

    /// The beam through a window of the film, from one corner to the opposite one, in pixels as for
    /// [`PrimaryRays::through`]. Depth is measured along the view axis, for all beams of a picture alike.
    pub fn beam(&self, low: DVec2, high: DVec2) -> ConvexVolume {
        let corners = [(low.x, low.y), (high.x, low.y), (high.x, high.y), (low.x, high.y)];
        let directions = corners.map(|(x, y)| self.corner + x * self.across + y * self.down);
        ConvexVolume::pyramid(Ray::new(self.eye, self.across.cross(self.down)), &directions)
    }

    /// Where on the film a point of the world is seen, in pixels as for [`PrimaryRays::through`], beyond
    /// the picture's edges as well; `None` for a point that is not in front of the eye.
    pub fn film_point(&self, point: DVec3) -> Option<DVec2> {
        // point − eye = depth · (x · across + y · down + corner)
        let film = self.to_film * (point - self.eye);
        (film.z > 0.0).then(|| film.truncate() / film.z)
    }

    /// The solid angle of a pixel over its area on the film, 1, in the unit direction `direction`: it
    /// shrinks with the cube of the cosine to the view axis.
    pub fn solid_angle(&self, direction: DVec3) -> f64 {
        let axis = self.across.cross(self.down);
        axis.length() * axis.normalize().dot(direction).abs().powi(3)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const CAMERA: Camera = Camera {
        eye: DVec3::new(1.0, 2.0, 3.0),
        look_at: DVec3::new(-2.0, 0.5, 1.0),
        up: DVec3::Y,
        fov: 70.0,
    };

    #[test]
    fn a_point_is_seen_where_its_ray_passes() {
        // By hand: the picture's half height is 1 at distance 1, a pixel too.
        let camera = Camera { eye: DVec3::ZERO, look_at: DVec3::NEG_Z, up: DVec3::Y, fov: 90.0 };
        let rays = camera.primary_rays(ImageSize::new(4, 2));
        let film = rays.film_point(DVec3::new(1.5, 1.5, -3.0)).unwrap();
        assert!((film - DVec2::new(2.5, 0.5)).length() < 1e-14, "{film}");
        assert_eq!(rays.film_point(DVec3::Z), None);

        let rays = CAMERA.primary_rays(ImageSize::new(64, 48));
        for (x, y) in [(0.0, 0.0), (0.5, 47.5), (32.0, 24.0), (80.0, -3.0)] {
            let film = rays.film_point(rays.through(x, y).at(7.3)).unwrap();
            assert!((film - DVec2::new(x, y)).length() < 1e-12, "{film}");
            assert_eq!(rays.film_point(rays.through(x, y).at(-1.0)), None);
        }
    }

    #[test]
    fn a_beam_holds_the_rays_of_its_window() {
        let rays = CAMERA.primary_rays(ImageSize::new(64, 48));
        let beam = rays.beam(DVec2::new(8.0, 16.0), DVec2::new(16.0, 24.0));
        let forward = (CAMERA.look_at - CAMERA.eye).normalize();
        assert!((beam.axis().direction - forward).length() < 1e-15);
        let meets = |x, y| beam.may_meet_corners(&[rays.through(x, y).at(7.3)]);
        assert!(meets(8.01, 16.01) && meets(15.99, 23.99));
        assert!(
            ![(7.99, 20.0), (16.01, 20.0), (12.0, 15.99), (12.0, 24.01)]
                .iter()
                .any(|&(x, y)| meets(x, y))
        );
        assert!(!beam.may_meet_corners(&[rays.through(12.0, 20.0).at(-1.0)]));
    }

    /// A square picture of opening angle 90° is a face of a cube around the eye: a sixth of 4π.
    #[test]
    fn solid_angles_add_up() {
        let rays = Camera { fov: 90.0, ..CAMERA }.primary_rays(ImageSize::new(200, 200));
        let pixels = (0..200 * 200).map(|i| (f64::from(i % 200) + 0.5, f64::from(i / 200) + 0.5));
        let sum: f64 = pixels.map(|(x, y)| rays.solid_angle(rays.through(x, y).direction)).sum();
        // The midpoint rule's own error is about (1/200)² / 24 of it.
        assert!((sum / (4.0 * PI / 6.0) - 1.0).abs() < 1e-5, "{sum}");
    }
}
