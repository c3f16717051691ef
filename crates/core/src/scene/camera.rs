use glam::{DMat3, DVec2, DVec3};

use crate::geometry::{ConvexVolume, Ray};
use crate::image::ImageSize;

/// A camera: a pinhole, or a thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye: the pinhole, or the middle of the lens.
    pub eye: DVec3,
    /// The point in the middle of the picture.
    pub look_at: DVec3,
    /// A direction that points up in the picture; not along the view axis.
    pub up: DVec3,
    /// Vertical opening angle in degrees, between 0 and 180.
    pub fov: f64,
    /// The lens; `None` is a pinhole, which sees everything in focus.
    pub lens: Option<Lens>,
}

/// A thin lens around the eye, perpendicular to the view axis: a disc through every point of which the whole picture
/// is seen. What lies in the plane of focus is sharp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Its radius, in scene units; 0 is a pinhole.
    pub radius: f64,
    /// The distance of the plane of focus from the eye, *along the view axis*, in scene units.
    pub focus: f64,
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
        let Lens { radius, focus } = self.lens.unwrap_or(Lens { radius: 0.0, focus: 1.0 });
        let lens = [right, up].map(|axis| radius * axis);
        PrimaryRays { eye: self.eye, corner, across, down, to_film, lens, focus }
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
    /// From the middle of the lens to its rim, to the right and upwards.
    lens: [DVec3; 2],
    focus: f64,
}

impl PrimaryRays {
    /// The ray from the eye through the film point (x, y) in pixels: (0, 0) is the upper left corner of the
    /// picture and (0.5, 0.5) the centre of its first pixel. The direction has unit length.
    #[inline]
    pub fn through(&self, x: f64, y: f64) -> Ray {
        Ray::new(self.eye, (self.corner + x * self.across + y * self.down).normalize())
    }

    /// The ray that a point of the lens sees at a film point: towards the point E + f d in the plane of focus that the
    /// eye sees there.
    ///
    /// ```text
    /// eq:lens                 o = E + ℓ,   D = (d − ℓ/f) / |d − ℓ/f|
    /// ```
    ///
    /// | formula | here   |                                                                                     |
    /// |---------|--------|-------------------------------------------------------------------------------------|
    /// | E       | inside | the eye                                                                             |
    /// | d       | `film` | in pixels as for [`PrimaryRays::through`], as the way from the eye to the film, at depth 1 |
    /// | ℓ       | `lens` | in the unit disc, x to the right and y upwards, as the way from the eye to a point of the lens |
    /// | f       | inside | [`Lens::focus`], along the axis like the depth of d: the points in focus lie in a plane |
    /// | o, D    | result | the ray; D has unit length                                                          |
    ///
    /// A point at depth z is blurred into a disc of radius r |1/f − 1/z| on the film at depth 1, r being
    /// [`Lens::radius`]. Without a lens, and from its middle, this is [`PrimaryRays::through`] to the bit. Source: Cook,
    /// Porter, Carpenter, *Distributed Ray Tracing*, SIGGRAPH 1984, « depth of field ».
    #[doc(alias = "eq:lens")]
    #[doc(alias = "profondeur de champ")]
    #[inline]
    pub fn through_lens(&self, film: DVec2, lens: DVec2) -> Ray {
        let aside = lens.x * self.lens[0] + lens.y * self.lens[1];
        let direction = self.corner + film.x * self.across + film.y * self.down;
        Ray::new(self.eye + aside, (direction - aside / self.focus).normalize())
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
        let film = self.homogeneous(point);
        (film.z > 0.0).then(|| film.truncate() / film.z)
    }

    /// (x z, y z, z) of a point that is seen at (x, y) and has the depth z along the view axis; behind the eye, where
    /// nothing is seen, z is not positive. It is linear along lines.
    pub fn homogeneous(&self, point: DVec3) -> DVec3 {
        // point − eye = depth · (x · across + y · down + corner)
        self.to_film * (point - self.eye)
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
        lens: None,
    };

    #[test]
    fn a_point_is_seen_where_its_ray_passes() {
        // By hand: the picture's half height is 1 at distance 1, a pixel too.
        let camera =
            Camera { eye: DVec3::ZERO, look_at: DVec3::NEG_Z, up: DVec3::Y, fov: 90.0, lens: None };
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

    /// eq:lens: all points of the lens see one point in the plane of focus; at depth z they see it r (1/z − 1/f) aside, on the
    /// film at depth 1: 0.025 at 2, 0.0083333 at 3, −0.0125 at 8 for r = 0.1, f = 4.
    #[test]
    fn a_lens_blurs_what_is_out_of_focus() {
        let lens = Some(Lens { radius: 0.1, focus: 4.0 });
        let rays = Camera { lens, ..CAMERA }.primary_rays(ImageSize::new(64, 48));
        let forward = (CAMERA.look_at - CAMERA.eye).normalize();
        let pixels_per_unit = 24.0 / 35.0_f64.to_radians().tan();
        for film in [DVec2::new(32.0, 24.0), DVec2::new(3.5, 40.25)] {
            for lens in [DVec2::X, DVec2::NEG_Y, DVec2::new(-0.6, 0.8), DVec2::new(0.1, 0.2)] {
                let ray = rays.through_lens(film, lens);
                assert!((ray.direction.length() - 1.0).abs() < 1e-15);
                let from_eye = ray.origin - CAMERA.eye;
                assert!((from_eye.length() - 0.1 * lens.length()).abs() < 1e-15);
                assert!(from_eye.dot(forward).abs() < 1e-15);
                for (z, aside) in [(4.0, 0.0), (2.0, 0.025), (3.0, 0.1 / 12.0), (8.0, -0.0125)] {
                    let point = ray.at(z / ray.direction.dot(forward));
                    let seen = rays.film_point(point).unwrap() - film;
                    // Upwards in the world is up in the picture, where y grows downwards.
                    let wanted = pixels_per_unit * aside * DVec2::new(lens.x, -lens.y);
                    assert!((seen - wanted).length() < 1e-12, "{z}: {seen} for {wanted}");
                }
            }
        }
    }

    #[test]
    fn the_middle_of_a_lens_and_a_pinhole_see_the_same() {
        let lens = Some(Lens { radius: 0.1, focus: 4.3 });
        let none = Some(Lens { radius: 0.0, focus: 4.3 });
        let rays = [CAMERA, Camera { lens, ..CAMERA }, Camera { lens: none, ..CAMERA }]
            .map(|camera| camera.primary_rays(ImageSize::new(64, 48)));
        for film in [DVec2::new(32.0, 24.0), DVec2::new(3.5, 40.25), DVec2::new(0.1, -0.7)] {
            let wanted = rays[0].through(film.x, film.y);
            assert_eq!(rays[1].through_lens(film, DVec2::ZERO), wanted);
            for pinhole in [rays[0], rays[2]] {
                assert_eq!(pinhole.through_lens(film, DVec2::new(0.6, 0.8)), wanted);
            }
            assert_ne!(rays[1].through_lens(film, DVec2::X), wanted);
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
