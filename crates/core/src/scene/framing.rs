use glam::DVec3;

use super::{Camera, PointLight, Scene};
use crate::Rgb;
use crate::geometry::Sphere;

impl Scene {
    /// A sphere around every shape, centred in their bounding box; `None` in an empty scene.
    pub fn bounding_sphere(&self) -> Option<Sphere> {
        let points = || {
            let vertices = self.mesh.positions.iter().map(|&p| (p, 0.0));
            vertices.chain(self.spheres.iter().map(|s| (s.shape.center, s.shape.radius)))
        };
        let (min, max) = points()
            .map(|(p, r)| (p - r, p + r))
            .reduce(|(a, b), (min, max)| (a.min(min), b.max(max)))?;
        let center = 0.5 * (min + max);
        let radius = points().map(|(p, r)| (p - center).length() + r).fold(0.0, f64::max);
        Some(Sphere { center, radius })
    }

    /// Whether anything shines: a point light, a face that emits, or the ambient term.
    pub fn has_light(&self) -> bool {
        !self.lights.is_empty() || self.ambient != Rgb::ZERO || self.has_area_light()
    }

    /// Whether a face of the mesh emits.
    pub fn has_area_light(&self) -> bool {
        self.mesh.faces.iter().any(|face| self.materials[face.material.0 as usize].emits())
    }
}

impl Camera {
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
        }
    }
}

impl PointLight {
    /// A white light to the upper left of `camera`, as far from it as a fifth of the way to what it
    /// looks at.
    ///
    /// There it gives what a perpendicular white surface returns as 1: its intensity grows with the
    /// square of the distance, so that small and large models come out equally bright.
    pub fn beside(camera: &Camera) -> Self {
        let view = camera.look_at - camera.eye;
        let right = view.cross(camera.up).normalize();
        let up = right.cross(view.normalize());
        let position = camera.eye + 0.2 * view.length() * (up - right).normalize();
        Self { position, intensity: Rgb::splat(position.distance_squared(camera.look_at)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::ImageSize;
    use glam::dvec3;

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

    #[test]
    fn brightness_does_not_depend_on_size() {
        for radius in [0.15, 6.0] {
            let camera = Camera::framing(Sphere { center: DVec3::ONE, radius });
            let light = PointLight::beside(&camera);
            let received = light.intensity / light.position.distance_squared(DVec3::ONE);
            assert!((received - 1.0).abs().max_element() < 1e-14);
            let aside = light.position.distance(camera.eye) / camera.eye.distance(DVec3::ONE);
            assert!((aside - 0.2).abs() < 1e-14);
        }
    }
}
