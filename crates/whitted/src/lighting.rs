use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray, Vectors};
use lancer_core::illumination::{Reflectance, ambient, lit};
use lancer_core::intersector::Hit;
use lancer_core::lanes::{FourLanes, Kernel};
use lancer_core::scene::{Material, PointSource, Scene};
use lancer_core::world::{SurfacePoint, World};

use crate::recorder::Recorder;

/// Shadow rays that wait, before they are asked together; a group of four surfaces may bring more.
const MOST: usize = 1 << 12;
/// A shadow ray reaches its light at 1.
const TO_LIGHT: Interval = Interval::up_to(1.0);

/// A world and its lights as points: what both methods of the chapter need at a surface.
///
/// Light is worked out for four surfaces at a time, by the formulas of one
/// ([`lancer_core::geometry::Vector`]), and all shadow rays are asked together.
#[derive(Clone)]
pub struct Lighting<'a> {
    /// The scene and its index.
    pub world: World<'a>,
    sources: Vec<PointSource>,
    kernel: Kernel,
}

impl<'a> Lighting<'a> {
    /// Collects the lights. An area light counts as a point at its centroid, see
    /// [`Scene::point_sources`](lancer_core::scene::Scene::point_sources).
    pub fn new(world: World<'a>) -> Self {
        Self::with_kernel(world, Kernel::best())
    }

    pub(crate) fn with_kernel(world: World<'a>, kernel: Kernel) -> Self {
        Self { world, sources: world.scene.point_sources(), kernel }
    }

    /// What a surface sends to the eye without the help of other surfaces: [`lit`] by the point sources,
    /// each of which a shadow ray may or may not reach.
    ///
    /// `to_eye` is unit and points away from the surface.
    pub fn surface<R: Recorder>(
        &self,
        surface: &SurfacePoint,
        to_eye: DVec3,
        recorder: &mut R,
    ) -> Rgb {
        let World { scene, index } = self.world;
        let reflectance = scene.reflectance(surface);
        let unlit = ambient(reflectance.diffuse, scene.ambient) + scene.emitted(surface, to_eye);
        let n = surface.shading_normal_towards(to_eye);
        let arriving = self.sources.iter().map(|source| source.arriving(surface));
        let radiance = lit(unlit, &reflectance, n, to_eye, arriving, |shadow_ray| {
            let visible = !index.occluded(shadow_ray, TO_LIGHT);
            recorder.shadow(shadow_ray, visible);
            visible
        });
        recorder.local(radiance);
        radiance
    }

    /// What computes with several surfaces at once.
    pub(crate) fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// Lights the surfaces that rays meet; shadow rays may still wait, for [`Lighting::answer`]. `onwards` is told of
    /// the last ones, up to four at a time, which stand side by side, lanes without any being copies of the last.
    #[inline(always)]
    pub(crate) fn surfaces<L: FourLanes, R: Recorder>(
        &self,
        lanes: L,
        (rays, hits): (&[Ray], &[Option<Hit>]),
        lit: &mut Lit,
        recorder: &mut R,
        mut onwards: impl FnMut(&Lit, &Four<L>),
    ) {
        let scene = self.world.scene;
        for (k, (ray, hit)) in rays.iter().zip(hits).enumerate() {
            if let Some(hit) = hit {
                let surface = scene.surface_at(ray, hit);
                recorder.hit(hit, &surface);
                lit.meet(scene, k, surface, ray.direction);
            }
            if lit.last.len() == 4 || k + 1 == rays.len() && !lit.last.is_empty() {
                let four = self.light(lanes, lit);
                onwards(lit, &four);
                lit.last.clear();
                if lit.shadow_rays.len() > MOST {
                    self.answer(lit, recorder);
                }
            }
        }
    }

    /// Asks about the last surfaces how much light arrives if nothing is in its way: [`Arriving::unshadowed`], which
    /// the shadow rays then decide on.
    ///
    /// [`Arriving::unshadowed`]: lancer_core::illumination::Arriving::unshadowed
    #[inline(always)]
    fn light<L: FourLanes>(&self, lanes: L, lit: &mut Lit) -> Four<L> {
        let last = &lit.last;
        let first = lit.local.len() - last.len();
        let [a, b, c, d] = lit.four();
        let surface = lanes.surfaces([&a.surface, &b.surface, &c.surface, &d.surface]);
        let incident = lanes.vectors([a.incident, b.incident, c.incident, d.incident]);
        let reflectance =
            lanes.reflectances([&a.reflectance, &b.reflectance, &c.reflectance, &d.reflectance]);
        let to_eye = -incident;
        let n = surface.shading_normal_towards(to_eye);
        let sources = if last.iter().all(Met::is_dark) { &[] } else { &*self.sources };
        for source in sources {
            let light = source.arriving(&surface);
            let terms = lanes.separate(light.unshadowed(&reflectance, n, to_eye));
            let rays = lanes.rays(light.shadow_ray);
            for lane in 0..last.len() {
                if terms[lane] != Rgb::ZERO {
                    lit.shadow_rays.push(rays[lane]);
                    lit.terms.push((first + lane, terms[lane]));
                }
            }
        }
        Four { surface, incident }
    }

    /// Asks the shadow rays that wait, and adds the light of those that reach it: to each surface light by light.
    pub(crate) fn answer<R: Recorder>(&self, lit: &mut Lit, recorder: &mut R) {
        lit.occluded.resize(lit.shadow_rays.len(), false);
        self.world.index.occluded_all(&lit.shadow_rays, TO_LIGHT, &mut lit.occluded);
        let terms = lit.terms.drain(..).zip(lit.occluded.drain(..));
        for (ray, ((k, term), is_occluded)) in lit.shadow_rays.drain(..).zip(terms) {
            recorder.shadow(&ray, !is_occluded);
            if !is_occluded {
                lit.local[k] += term;
            }
        }
    }
}

/// Surfaces that rays have met, and the light that leaves them without the help of other surfaces.
pub(crate) struct Lit {
    /// Of each surface the ray that met it, by its place among all.
    pub of: Vec<usize>,
    /// I_local, with the emission and the ambient term.
    pub local: Vec<Rgb>,
    /// The last ones, up to four.
    pub last: Vec<Met>,
    shadow_rays: Vec<Ray>,
    /// Of each shadow ray the surface, and what the light adds there.
    terms: Vec<(usize, Rgb)>,
    occluded: Vec<bool>,
}

/// A surface that a ray has met.
pub(crate) struct Met {
    surface: SurfacePoint,
    /// The direction of the ray.
    incident: DVec3,
    reflectance: Reflectance,
}

impl Met {
    /// Whether it sends back nothing of what arrives from lights.
    #[inline(always)]
    fn is_dark(&self) -> bool {
        self.reflectance.diffuse == Rgb::ZERO && self.reflectance.specular == Rgb::ZERO
    }

    #[inline(always)]
    pub(crate) fn material<'s>(&self, scene: &'s Scene) -> &'s Material {
        scene.material(self.surface.material)
    }
}

/// Surfaces side by side.
pub(crate) struct Four<L: FourLanes> {
    pub surface: SurfacePoint<Vectors<L::D>, ()>,
    /// The directions of the rays that met them.
    pub incident: Vectors<L::D>,
}

impl Lit {
    /// None, with room for so many.
    pub(crate) fn with_capacity(count: usize) -> Self {
        Self {
            of: Vec::with_capacity(count),
            local: Vec::with_capacity(count),
            last: Vec::with_capacity(4),
            shadow_rays: Vec::with_capacity(2 * count),
            terms: Vec::with_capacity(2 * count),
            occluded: Vec::with_capacity(2 * count),
        }
    }

    #[inline(always)]
    fn meet(&mut self, scene: &Scene, ray: usize, surface: SurfacePoint, incident: DVec3) {
        let reflectance = scene.reflectance(&surface);
        let emitted = scene.emitted(&surface, -incident);
        self.of.push(ray);
        self.local.push(ambient(reflectance.diffuse, scene.ambient) + emitted);
        self.last.push(Met { surface, incident, reflectance });
    }

    /// The last ones; the last of all fills up.
    #[inline(always)]
    pub(crate) fn four(&self) -> [&Met; 4] {
        let last = self.last.len() - 1;
        [&self.last[0], &self.last[last.min(1)], &self.last[last.min(2)], &self.last[last]]
    }
}
