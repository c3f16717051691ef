use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray, Real};
use lancer_core::illumination::recursion;
use lancer_core::intersector::Hit;
use lancer_core::lanes::FourLanes;
use lancer_core::optics::{Branches, directions};
use lancer_core::sampling::Uniform;
use lancer_core::with_lanes;
use lancer_core::world::World;

use crate::lighting::{Lighting, Lit};
use crate::recorder::{Call, RayKind, Recorder};

/// When the recursion ends, and with which colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Max_Prof: the largest number of bounces between the eye and a surface.
    pub max_depth: u32,
    /// A ray that would count less than this in its pixel is not traced, unless it survives
    /// [`AtLimit::Roulette`]; 0 traces all.
    pub min_weight: f64,
    /// What becomes of a ray at the limit.
    pub at_limit: AtLimit,
}

impl Default for Settings {
    /// Five bounces, and nothing below half a step of an 8-bit picture.
    fn default() -> Self {
        Self { max_depth: 5, min_weight: 0.5 / 255.0, at_limit: AtLimit::Black }
    }
}

impl Settings {
    /// The default, to another depth if there is one.
    pub fn to_depth(max_depth: Option<u32>) -> Self {
        let settings = Self::default();
        Self { max_depth: max_depth.unwrap_or(settings.max_depth), ..settings }
    }
}

/// « choix discutable mais que mettre ? »: the radiance of a ray at the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AtLimit {
    /// Black, the slide's choice.
    Black,
    /// The ambient radiance I_a.
    Ambient,
    /// The background, as if the ray met nothing.
    Background,
    /// Russian roulette: a ray of weight below [`Settings::min_weight`] is traced with the probability
    /// weight / `min_weight`, and its answer divided by that; otherwise it is black. What is so divided
    /// weighs `min_weight` again.
    ///
    /// The mean over all seeds is the picture without a minimum weight (Arvo and Kirk, *Particle Transport
    /// and Image Synthesis*, 1990). A ray beyond [`Settings::max_depth`] is black.
    Roulette {
        /// Picks one of the random pictures; who survives follows from it and the ray alone.
        seed: u64,
    },
}

/// The method of Whitted (1980), the slides' algorithm LR.
///
/// - *Follows* Appel's rays, and from each surface the mirror and the refracted ray, down to a depth or weight.
/// - *Wins* where surfaces are smooth and lights small: sharp reflections, refraction and shadows.
/// - *Loses* what takes more directions than these: penumbrae, gloss, light by way of mirrors or matte surfaces
///   (plates 1.9, 1.10); the tree doubles with each bounce between glass (plate 1.6).
/// - *Sources*: Whitted, *An Improved Illumination Model for Shaded Display*, CACM 23(6), 1980; slides
///   « Intensité lumineuse sur un rayon », « Algorithme ».
#[derive(Clone)]
pub struct Whitted<'a> {
    lighting: Lighting<'a>,
    settings: Settings,
}

impl<'a> Whitted<'a> {
    /// Prepares the method for a world.
    pub fn new(world: World<'a>, settings: Settings) -> Self {
        Self { lighting: Lighting::new(world), settings }
    }

    /// The radiance that comes back along a primary ray of unit direction.
    ///
    /// ```text
    /// algo:lr     Couleur LR(origine, direction, profondeur)
    ///             Si profondeur > Max_Prof            → couleur = Noir
    ///             Sinon, si intersection              → C_locale
    ///                                                 + LR(Pt_inter, D_réfléchi, profondeur + 1)
    ///                                                 + LR(Pt_inter, D_réfracté, profondeur + 1)
    ///             Sinon                               → couleur de fond
    /// ```
    ///
    /// Slide « Algorithme ».
    #[doc(alias = "algo:lr")]
    #[doc(alias = "LR")]
    pub fn trace<R: Recorder>(&self, ray: &Ray, recorder: &mut R) -> Rgb {
        let mut radiance = [Rgb::ZERO];
        self.lr(&[Call::primary(ray)], &mut radiance, recorder);
        radiance[0]
    }

    /// The same for many rays, each radiance in its ray's place: their calls of LR go side by side, so that all their
    /// rays of one depth and kind are asked together. The bits are those of one ray after the other; a recorder is
    /// told of one call of each before the next.
    ///
    /// # Panics
    /// If the slices are not of one length.
    pub fn trace_all<R: Recorder>(&self, rays: &[Ray], radiance: &mut [Rgb], recorder: &mut R) {
        let calls: Vec<Call> = rays.iter().map(Call::primary).collect();
        self.lr(&calls, radiance, recorder);
    }

    /// LR of calls side by side.
    fn lr<R: Recorder>(&self, calls: &[Call], radiance: &mut [Rgb], recorder: &mut R) {
        assert_eq!(calls.len(), radiance.len(), "one answer for each call");
        let World { scene, index } = self.lighting.world;
        let mut rays = Vec::with_capacity(calls.len());
        let mut followed = Vec::with_capacity(calls.len());
        for (k, call) in calls.iter().enumerate() {
            match self.followed(call) {
                Some((call, divisor)) => {
                    recorder.enter(&call);
                    rays.push(call.ray);
                    followed.push(Followed { k, weight: call.weight, divisor });
                    radiance[k] = scene.background / divisor;
                }
                None => {
                    recorder.cut(call);
                    radiance[k] = self.at_limit();
                }
            }
        }
        let mut hits = vec![None; rays.len()];
        index.closest_hits(&rays, Interval::POSITIVE, &mut hits);

        let (mut lit, mut onwards) = (Lit::with_capacity(rays.len()), Onwards::new(rays.len()));
        let of = (calls, &*followed);
        let to = (&mut lit, &mut onwards, &mut *recorder);
        with_lanes!(self.lighting.kernel(), self.surfaces((&*rays, &*hits), of, to));
        self.lighting.answer(&mut lit, recorder);
        lit.local.iter().for_each(|&local| recorder.local(local));

        let Onwards { shares, refracted, mirror } = onwards;
        let [refracted, reflected] =
            [refracted, mirror].map(|next| self.returned(&next, shares.len(), recorder));
        for (surface, &ray) in lit.of.iter().enumerate() {
            let [k_s, k_t] = shares[surface];
            let sum =
                recursion(lit.local[surface], k_s, reflected[surface], k_t, refracted[surface]);
            radiance[followed[ray].k] = sum / followed[ray].divisor;
        }
        radiance.iter().for_each(|&radiance| recorder.leave(radiance));
    }

    /// What calls from surfaces return, 0 for a surface without one.
    fn returned<R: Recorder>(&self, next: &Next, surfaces: usize, recorder: &mut R) -> Vec<Rgb> {
        let mut returned = vec![Rgb::ZERO; surfaces];
        if !next.calls.is_empty() {
            let mut radiance = vec![Rgb::ZERO; next.calls.len()];
            self.lr(&next.calls, &mut radiance, recorder);
            for (&surface, radiance) in next.from.iter().zip(radiance) {
                returned[surface] = radiance;
            }
        }
        returned
    }

    /// Lights the surfaces, and collects what follows from them.
    #[inline(always)]
    fn surfaces<L: FourLanes, R: Recorder>(
        &self,
        lanes: L,
        met: (&[Ray], &[Option<Hit>]),
        (calls, followed): (&[Call], &[Followed]),
        (lit, onwards, recorder): (&mut Lit, &mut Onwards, &mut R),
    ) {
        self.lighting.surfaces(
            lanes,
            met,
            lit,
            recorder,
            #[inline(always)]
            |lit, four| {
                let scene = self.lighting.world.scene;
                let first = lit.local.len() - lit.last.len();
                let [a, b, c, d] = lit.four();
                let materials =
                    [a.material(scene), b.material(scene), c.material(scene), d.material(scene)];
                if !materials.iter().any(|m| m.k_s != Rgb::ZERO || m.k_t != Rgb::ZERO) {
                    onwards.shares.resize(lit.local.len(), [Rgb::ZERO; 2]);
                    return;
                }
                let [a, b, c, d] = materials;
                let refractive_index = lanes.four([
                    a.refractive_index,
                    b.refractive_index,
                    c.refractive_index,
                    d.refractive_index,
                ]);
                let (mirror, (refracted, is_refracted)) =
                    directions(&four.surface, refractive_index, four.incident);
                let mirror = lanes.rays(four.surface.spawn(mirror));
                let refracted = lanes.rays(four.surface.spawn(refracted));
                let is_refracted = L::D::bits(is_refracted);
                for lane in 0..lit.last.len() {
                    let direction =
                        (is_refracted >> lane & 1 != 0).then_some(refracted[lane].direction);
                    let branches =
                        Branches::along(materials[lane], mirror[lane].direction, direction);
                    onwards.shares.push(branches.shares());
                    let surface = first + lane;
                    let Followed { k, weight, .. } = followed[lit.of[surface]];
                    let depth = calls[k].depth + 1;
                    if let Some((k_t, _)) = branches.refracted {
                        onwards.refracted.push(surface, refracted[lane], depth, weight, k_t);
                    }
                    if let Some((k_s, _)) = branches.mirror {
                        onwards.mirror.push(surface, mirror[lane], depth, weight, k_s);
                    }
                }
            },
        );
    }

    /// The call as it is followed, and what its answer is divided by; `None` at the limit.
    fn followed(&self, call: &Call) -> Option<(Call, f64)> {
        let Settings { max_depth, min_weight, at_limit } = self.settings;
        if call.depth > max_depth {
            return None;
        }
        if call.weight >= min_weight {
            return Some((*call, 1.0));
        }
        let AtLimit::Roulette { seed } = at_limit else { return None };
        let survival = call.weight / min_weight;
        // A ray between two mirrors may come back bit for bit: the depth tells its turns apart.
        let turn = seed ^ u64::from(call.depth) << 32;
        let survives = Uniform::of_ray(turn, &call.ray).number() < survival;
        survives.then_some((Call { weight: min_weight, ..*call }, survival))
    }

    /// What a call at the limit returns.
    fn at_limit(&self) -> Rgb {
        let scene = self.lighting.world.scene;
        match self.settings.at_limit {
            AtLimit::Black | AtLimit::Roulette { .. } => Rgb::ZERO,
            AtLimit::Ambient => scene.ambient,
            AtLimit::Background => scene.background,
        }
    }
}

/// A call that is not at the limit.
#[derive(Clone, Copy)]
struct Followed {
    /// Its place among all calls.
    k: usize,
    weight: f64,
    /// What its answer is divided by.
    divisor: f64,
}

/// What follows from surfaces.
struct Onwards {
    /// k_s and k_t of each surface.
    shares: Vec<[Rgb; 2]>,
    refracted: Next,
    mirror: Next,
}

/// The next calls of one kind.
struct Next {
    kind: RayKind,
    calls: Vec<Call>,
    /// The surface that each comes from.
    from: Vec<usize>,
}

impl Onwards {
    fn new(surfaces: usize) -> Self {
        let next = |kind| Next {
            kind,
            calls: Vec::with_capacity(surfaces),
            from: Vec::with_capacity(surfaces),
        };
        Self {
            shares: Vec::with_capacity(surfaces),
            refracted: next(RayKind::Refracted),
            mirror: next(RayKind::Mirror),
        }
    }
}

impl Next {
    /// LR(Pt-inter, direction, profondeur + 1): `weight` is that of the call before, `k` the branch's share.
    #[inline(always)]
    fn push(&mut self, surface: usize, ray: Ray, depth: u32, weight: f64, k: Rgb) {
        self.calls.push(Call { ray, depth, weight: weight * k.max_element(), kind: self.kind });
        self.from.push(surface);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use lancer_core::generate::icosphere;
    use lancer_core::geometry::Sphere;
    use lancer_core::image::ImageSize;
    use lancer_core::intersector::LinearScan;
    use lancer_core::lanes::{Kernel, Scalar};
    use lancer_core::scene::{Camera, Material, MaterialId, PointLight, Scene, SphereObject};

    use super::*;
    use crate::recorder::RayCounts;

    /// A ball of glass, a mirror and a sphere that emits before a shiny mesh, under so many lamps that shadow rays are
    /// asked before all surfaces are met.
    fn scene() -> Scene {
        let mut scene = Scene::of_mesh(icosphere(1));
        scene.materials[0].rho_s = Rgb::splat(0.7);
        scene.materials[0].shininess = 9.5;
        let plain = scene.materials[0];
        let glass = Material { k_s: Rgb::splat(0.2), k_t: Rgb::splat(0.8), ..plain };
        scene.materials.extend([
            Material { refractive_index: 1.5, ..glass },
            Material { k_s: Rgb::new(0.9, 0.7, 0.5), ..plain },
            Material { emission: Rgb::ONE, ..plain },
        ]);
        for (x, material) in [(-1.0, 1), (1.1, 2), (3.0, 3)] {
            let shape = Sphere { center: DVec3::new(x, 0.3, 1.2), radius: 0.7 };
            scene.spheres.push(SphereObject { shape, material: MaterialId(material) });
        }
        for k in 0..40 {
            let position = DVec3::new(f64::from(k) - 20.0, 5.0, 6.0);
            scene.lights.push(PointLight { position, intensity: Rgb::new(3.0, 2.0, 1.0) });
        }
        let look_at = DVec3::new(0.0, 0.2, 0.0);
        scene.camera = Camera { eye: DVec3::new(0.3, 0.4, 4.0), look_at, ..scene.camera };
        scene.background = Rgb::new(0.2, 0.3, 0.4);
        scene.ambient = Rgb::splat(0.1);
        scene
    }

    /// The processor's vectors and their scalar twin, many rays together and each alone: one picture.
    #[test]
    fn vectors_and_their_twin_light_alike() {
        let scene = scene();
        let index = LinearScan::new(&scene);
        let world = World { scene: &scene, index: &index };
        let through = scene.camera.primary_rays(ImageSize::new(24, 16));
        let pixels = (0..16).flat_map(|y| (0..24).map(move |x| (f64::from(x), f64::from(y))));
        let rays: Vec<Ray> = pixels.map(|(x, y)| through.through(x + 0.5, y + 0.5)).collect();
        let pictures = [Kernel::best(), Kernel::Scalar(Scalar)].map(|kernel| {
            let lighting = Lighting::with_kernel(world, kernel);
            let whitted = Whitted { lighting, settings: Settings::default() };
            let (mut together, mut counts) = (vec![Rgb::NAN; rays.len()], RayCounts::default());
            whitted.trace_all(&rays, &mut together, &mut counts);
            let mut alone = RayCounts::default();
            let each: Vec<Rgb> = rays.iter().map(|ray| whitted.trace(ray, &mut alone)).collect();
            assert!(together == each && counts == alone);
            (together, counts)
        });
        assert!(pictures[0] == pictures[1]);
        let RayCounts { mirror, refracted, shadow, .. } = pictures[0].1;
        assert!(mirror > 100 && refracted > 100 && shadow > 8192, "{mirror} {refracted} {shadow}");
    }
}
