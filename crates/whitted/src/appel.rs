use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::illumination::{Reflectance, ambient, attenuation, local};
use lancer_core::intersector::Hit;
use lancer_core::world::{PointSource, SurfacePoint, World};

use crate::recorder::{Call, Recorder};

/// A world and its lights as points: what both methods of the chapter need at a surface.
#[derive(Clone)]
pub struct Lighting<'a> {
    /// The scene and its index.
    pub world: World<'a>,
    sources: Vec<PointSource>,
}

impl<'a> Lighting<'a> {
    /// Collects the lights. An area light counts as a point at its centroid, see
    /// [`lancer_core::scene::Scene::point_sources`].
    pub fn new(world: World<'a>) -> Self {
        Self { world, sources: world.scene.point_sources() }
    }

    /// What a surface sends to the eye without the help of other surfaces: emission, ambient term and
    /// the lights that a shadow ray can reach.
    ///
    /// ```text
    /// algo:appel              ε + ρ̄ I_a + Σᵢ Iᵢ vis(i)/dᵢ² ( ρ_d (N·L) + ρ_s (R·V)ⁿ )
    /// ```
    ///
    /// `n` is the unit shading normal on the eye's side; `to_eye` is unit and points away from the
    /// surface. vis(i) is asked last: no shadow ray is cast to a light that would add nothing, because
    /// it is behind the surface or makes only a highlight that the eye does not see.
    ///
    /// Slides « Élimination des parties cachées [Appel 68] », « Modèle Local : calcul des ombres
    /// portées ».
    #[doc(alias = "algo:appel")]
    #[doc(alias = "ombres portées")]
    #[inline]
    pub fn surface<R: Recorder>(
        &self,
        surface: &SurfacePoint,
        n: DVec3,
        to_eye: DVec3,
        recorder: &mut R,
    ) -> Rgb {
        let scene = self.world.scene;
        let material = scene.material(surface.material);
        let diffuse = material.rho_d.at(surface.position, surface.geometric_normal);
        let reflectance =
            Reflectance { diffuse, specular: material.rho_s, shininess: material.shininess };

        let mut radiance = ambient(diffuse, scene.ambient);
        if surface.geometric_normal.dot(to_eye) > 0.0 {
            radiance += material.emission;
        }
        if diffuse != Rgb::ZERO || material.rho_s != Rgb::ZERO {
            for source in &self.sources {
                let shadow_ray = surface.spawn_to(source.position);
                if n.dot(shadow_ray.direction) <= 0.0 {
                    continue;
                }
                let distance = shadow_ray.direction.length();
                let to_light = shadow_ray.direction * distance.recip();
                let intensity = source.intensity_towards(to_light);
                let g = attenuation(true, distance);
                let unshadowed = local(intensity, g, &reflectance, n, to_light, to_eye);
                if unshadowed != Rgb::ZERO {
                    let visible = !self.world.index.occluded(&shadow_ray, Interval::up_to(1.0));
                    recorder.shadow(&shadow_ray, visible);
                    if visible {
                        radiance += unshadowed;
                    }
                }
            }
        }
        recorder.local(radiance);
        radiance
    }
}

/// The method of Appel (1968): what the eye sees and which lights see it too.
#[derive(Clone)]
pub struct Appel<'a> {
    lighting: Lighting<'a>,
}

impl<'a> Appel<'a> {
    /// Prepares the method for a world.
    pub fn new(world: World<'a>) -> Self {
        Self { lighting: Lighting::new(world) }
    }

    /// The radiance that comes back along a primary ray of unit direction.
    #[inline]
    pub fn trace<R: Recorder>(&self, ray: &Ray, recorder: &mut R) -> Rgb {
        let hit = self.lighting.world.index.closest_hit(ray, Interval::POSITIVE);
        self.shade(ray, hit, recorder)
    }

    /// The same if what the ray hits first is known.
    #[inline]
    pub fn shade<R: Recorder>(&self, ray: &Ray, hit: Option<Hit>, recorder: &mut R) -> Rgb {
        let scene = self.lighting.world.scene;
        recorder.enter(&Call::primary(ray));
        let radiance = match hit {
            None => scene.background,
            Some(hit) => {
                let surface = scene.surface_at(ray, &hit);
                recorder.hit(&hit, &surface);
                let n = surface.shading_normal_towards(-ray.direction);
                self.lighting.surface(&surface, n, -ray.direction, recorder)
            }
        };
        recorder.leave(radiance);
        radiance
    }
}
