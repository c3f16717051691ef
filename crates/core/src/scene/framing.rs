use std::error::Error;
use std::fmt;

use glam::{DQuat, DVec3};

use super::load::MAX_COORDINATE;
use super::{Camera, Lens, PointLight};
use crate::Rgb;
use crate::geometry::Sphere;

/// Why a [`Camera`] cannot make a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraError {
    /// A coordinate is NaN or beyond [`MAX_COORDINATE`].
    NotFinite,
    /// The eye is the point looked at, or so near to it that squared lengths vanish.
    NoDirection,
    /// `up` is zero or along the line of sight.
    UpAlongView,
    /// `fov` is not between 0 and 180 degrees.
    Fov,
    /// The radius of the lens is NaN, negative or beyond [`MAX_COORDINATE`].
    Lens,
    /// The distance of the plane of focus is NaN, not positive, or so small or large that squared lengths overflow.
    Focus,
}

impl CameraError {
    pub(super) fn problem_and_cure(self) -> (&'static str, &'static str) {
        match self {
            Self::NotFinite => {
                ("the camera is not finite or too far away", "use coordinates up to 1e50")
            }
            Self::NoDirection => ("look_at is the same point as eye", "move one of the two"),
            Self::UpAlongView => {
                ("up is zero or along the line of sight", "look another way or choose another `up`")
            }
            Self::Fov => ("fov is out of range", "it must be between 0 and 180 degrees"),
            Self::Lens => ("lens is out of range", "its radius must be between 0 and 1e50"),
            Self::Focus => ("focus is out of range", "the distance must be between 1e-50 and 1e50"),
        }
    }
}

impl fmt::Display for CameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (problem, cure) = self.problem_and_cure();
        write!(f, "{problem}; {cure}")
    }
}

impl Error for CameraError {}

impl Camera {
    /// Checks what [`Camera::primary_rays`] takes for granted.
    ///
    /// # Errors
    /// When the line of sight, the vertical or the opening angle is not defined.
    pub fn check(&self) -> Result<(), CameraError> {
        let view = self.look_at - self.eye;
        let across = view.cross(self.up).length();
        let is_in_space = |v: DVec3| v.abs().cmple(DVec3::splat(MAX_COORDINATE)).all();
        if !(is_in_space(self.eye) && is_in_space(self.look_at) && is_in_space(self.up)) {
            Err(CameraError::NotFinite)
        } else if view.length() < 1e-100 {
            Err(CameraError::NoDirection)
        } else if across <= 1e-12 * view.length() * self.up.length() {
            Err(CameraError::UpAlongView)
        } else if self.fov > 0.0 && self.fov < 180.0 {
            self.lens.map_or(Ok(()), Lens::check)
        } else {
            Err(CameraError::Fov)
        }
    }

    /// A camera that sees all of `bounds` in a square picture, from the front (+z), to the right
    /// and slightly above.
    pub fn framing(bounds: Sphere) -> Self {
        const FOV: f64 = 40.0;
        const FROM: DVec3 = DVec3::new(0.5, 0.35, 1.0);
        // The lines of sight along the picture's edges touch the sphere.
        let distance = bounds.radius / (0.5 * FOV.to_radians()).sin();
        Self {
            eye: bounds.center + distance * FROM.normalize(),
            look_at: bounds.center,
            up: DVec3::Y,
            fov: FOV,
            lens: None,
        }
    }

    /// The camera turned about what it looks at, with the shortest turn of its `up` to the new one. To
    /// z it takes the front of a model from +z to −y, as programs do where z points up.
    pub fn turned_to(self, up: DVec3) -> Self {
        let [Some(from), Some(to)] = [self.up, up].map(DVec3::try_normalize) else {
            return Self { up, ..self };
        };
        let turn = DQuat::from_rotation_arc(from, to);
        Self { eye: self.look_at + turn * (self.eye - self.look_at), up, ..self }
    }
}

impl Lens {
    fn check(self) -> Result<(), CameraError> {
        if !(0.0..=MAX_COORDINATE).contains(&self.radius) {
            Err(CameraError::Lens)
        } else if !(1.0 / MAX_COORDINATE..=MAX_COORDINATE).contains(&self.focus) {
            Err(CameraError::Focus)
        } else {
            Ok(())
        }
    }
}

impl PointLight {
    /// A white light to the upper left of `camera`, as far from it as a fifth of the way to what it
    /// looks at. The camera must pass [`Camera::check`].
    ///
    /// There a perpendicular white surface returns 0.6, so that the front of a model, which is nearer,
    /// is not too bright. The intensity grows with the square of the distance: small and large models
    /// come out equally bright.
    pub fn beside(camera: &Camera) -> Self {
        let view = camera.look_at - camera.eye;
        let right = view.cross(camera.up).normalize();
        let up = right.cross(view.normalize());
        let position = camera.eye + 0.2 * view.length() * (up - right).normalize();
        let intensity = 0.6 * position.distance_squared(camera.look_at);
        Self { position, intensity: Rgb::splat(intensity) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::ImageSize;
    use glam::{DVec2, dvec3};

    #[test]
    fn a_framed_sphere_touches_the_pictures_edges() {
        let bounds = Sphere { center: dvec3(3.0, -2.0, 7.0), radius: 0.15 };
        let camera = Camera::framing(bounds);
        let rays = camera.primary_rays(ImageSize { width: 100, height: 100 });
        for (x, y) in [(0.0, 50.0), (100.0, 50.0), (50.0, 0.0), (50.0, 100.0)] {
            let ray = rays.through(x, y);
            let distance = (bounds.center - ray.origin).cross(ray.direction).length();
            assert!((distance - 0.15).abs() < 1e-14, "{distance}");
        }
        let from = camera.eye - bounds.center;
        assert!(from.z > from.x && from.x > 0.0 && from.y > 0.0);
    }

    /// By hand: of a model with z up the front is at −y, the right at +x and the top at +z.
    #[test]
    fn a_framing_is_turned_upright() {
        let bounds = Sphere { center: dvec3(3.0, -2.0, 7.0), radius: 0.15 };
        let framing = Camera::framing(bounds);
        let from = framing.eye - bounds.center;
        let turned = framing.turned_to(4.0 * DVec3::Z);
        let wanted = bounds.center + dvec3(from.x, -from.z, from.y);
        assert!(turned.eye.distance(wanted) < 1e-15, "{turned:?}");
        assert_eq!(turned, Camera { eye: turned.eye, up: 4.0 * DVec3::Z, ..framing });
        // Upside down is the same height on the other side.
        let below = framing.turned_to(-DVec3::Y).eye - bounds.center;
        assert!((below.y + from.y).abs() < 1e-15 && (below.length() - from.length()).abs() < 1e-15);
        assert_eq!(framing.turned_to(DVec3::Y).eye.distance(framing.eye), 0.0);
        let none = framing.turned_to(DVec3::ZERO);
        assert_eq!(none.check(), Err(CameraError::UpAlongView));
    }

    #[test]
    fn cameras_without_a_picture_are_told() {
        let lens = |radius, focus| Some(Lens { radius, focus });
        let pinhole = lens(0.0, 3.0);
        let good =
            Camera { eye: DVec3::Z, look_at: DVec3::ZERO, up: DVec3::Y, fov: 40.0, lens: pinhole };
        assert_eq!(good.check(), Ok(()));
        let nan = Camera { eye: dvec3(0.0, f64::NAN, 0.0), ..good };
        assert_eq!(nan.check(), Err(CameraError::NotFinite));
        for eye in [DVec3::ZERO, 1e-150 * DVec3::Z] {
            assert_eq!(Camera { eye, ..good }.check(), Err(CameraError::NoDirection));
        }
        for up in [DVec3::ZERO, DVec3::Z, -2.0 * DVec3::Z] {
            assert_eq!(Camera { up, ..good }.check(), Err(CameraError::UpAlongView));
        }
        for fov in [0.0, -1.0, 180.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Camera { fov, ..good }.check(), Err(CameraError::Fov));
        }
        for radius in [-1e-9, f64::NAN, f64::INFINITY, 1.1e50] {
            assert_eq!(Camera { lens: lens(radius, 3.0), ..good }.check(), Err(CameraError::Lens));
        }
        for focus in [0.0, -3.0, f64::NAN, f64::INFINITY, 1e-51, 1.1e50] {
            assert_eq!(Camera { lens: lens(0.1, focus), ..good }.check(), Err(CameraError::Focus));
        }
        // The widest lens beside the nearest focus: the directions are still unit vectors.
        let extreme = Camera { lens: lens(1e50, 1e-50), ..good };
        assert_eq!(extreme.check(), Ok(()));
        let ray = extreme.primary_rays(ImageSize::new(4, 4)).through_lens(DVec2::ONE, DVec2::X);
        assert!((ray.direction.length() - 1.0).abs() < 1e-15, "{ray:?}");
    }

    #[test]
    fn brightness_does_not_depend_on_size() {
        for radius in [0.15, 6.0] {
            let camera = Camera::framing(Sphere { center: DVec3::ONE, radius });
            let light = PointLight::beside(&camera);
            let received = light.intensity / light.position.distance_squared(DVec3::ONE);
            assert!((received - 0.6).abs().max_element() < 1e-14);
            let aside = light.position.distance(camera.eye) / camera.eye.distance(DVec3::ONE);
            assert!((aside - 0.2).abs() < 1e-14);
        }
    }
}
