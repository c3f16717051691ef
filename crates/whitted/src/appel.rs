use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::illumination::{ambient, lit};
use lancer_core::intersector::Hit;
use lancer_core::scene::PointSource;
use lancer_core::world::{SurfacePoint, World};

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
    /// [`Scene::point_sources`](lancer_core::scene::Scene::point_sources).
    pub fn new(world: World<'a>) -> Self {
        Self { world, sources: world.scene.point_sources() }
    }

    /// What a surface sends to the eye without the help of other surfaces: [`lit`] by the point sources, each of
    /// which a shadow ray may or may not reach.
    ///
    /// `n` is the unit shading normal on the eye's side; `to_eye` is unit and points away from the surface.
    #[inline]
    pub fn surface<R: Recorder>(
        &self,
        surface: &SurfacePoint,
        n: DVec3,
        to_eye: DVec3,
        recorder: &mut R,
    ) -> Rgb {
        let World { scene, index } = self.world;
        let reflectance = scene.reflectance(surface);
        let unlit = ambient(reflectance.diffuse, scene.ambient) + scene.emitted(surface, to_eye);
        let arriving = self.sources.iter().map(|source| source.arriving(surface));
        let radiance = lit(unlit, &reflectance, n, to_eye, arriving, |shadow_ray| {
            let visible = !index.occluded(shadow_ray, Interval::up_to(1.0));
            recorder.shadow(shadow_ray, visible);
            visible
        });
        recorder.local(radiance);
        radiance
    }
}

/// The method of Appel (1968): what the eye sees and which lights see it too.
///
/// - *Follows* primary rays, and from what they meet a shadow ray to each light that would add something.
/// - *Wins* where surfaces are matte: visibility without sorting, exact shadows of points, and a cost known
///   beforehand, at most 1 + lights rays per sample.
/// - *Loses* mirrors, glass, penumbrae (an area light is a point) and the light between surfaces.
/// - *Sources*: Appel, *Some Techniques for Shading Machine Renderings of Solids*, AFIPS SJCC 1968; slides
///   « Élimination des parties cachées », « Modèle Local ».
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
