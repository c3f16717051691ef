use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::intersector::Hit;
use lancer_core::optics::Branches;
use lancer_core::sampling::Uniform;
use lancer_core::world::{SurfacePoint, World};

use crate::appel::Lighting;
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

/// Radiance along a ray.
///
/// ```text
/// eq:recursion            I_R = I_Local + k_s I_Refl + k_t I_Trans
/// ```
///
/// (The algorithm's last line on the slides adds the three components without k_s and k_t; the
/// formula is right.)
///
/// Slide « Intensité lumineuse sur un rayon ».
#[doc(alias = "eq:recursion")]
#[inline]
pub fn recursion(local: Rgb, k_s: Rgb, reflected: Rgb, k_t: Rgb, refracted: Rgb) -> Rgb {
    local + k_s * reflected + k_t * refracted
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
    #[inline]
    pub fn trace<R: Recorder>(&self, ray: &Ray, recorder: &mut R) -> Rgb {
        self.lr(Call::primary(ray), recorder)
    }

    /// The same if what the ray hits first is known.
    #[inline]
    pub fn shade<R: Recorder>(&self, ray: &Ray, hit: Option<Hit>, recorder: &mut R) -> Rgb {
        self.lr_with(Call::primary(ray), recorder, |_| hit)
    }

    fn lr<R: Recorder>(&self, call: Call, recorder: &mut R) -> Rgb {
        let index = self.lighting.world.index;
        self.lr_with(call, recorder, |ray| index.closest_hit(ray, Interval::POSITIVE))
    }

    /// LR, where `first_hit` tells what a ray hits first.
    #[inline]
    fn lr_with<R: Recorder>(
        &self,
        call: Call,
        recorder: &mut R,
        first_hit: impl Fn(&Ray) -> Option<Hit>,
    ) -> Rgb {
        let radiance =
            if call.depth > self.settings.max_depth || call.weight < self.settings.min_weight {
                self.at_limit(call, recorder, first_hit)
            } else {
                self.follow(&call, recorder, first_hit)
            };
        recorder.leave(radiance);
        radiance
    }

    #[inline]
    fn follow<R: Recorder>(
        &self,
        call: &Call,
        recorder: &mut R,
        first_hit: impl Fn(&Ray) -> Option<Hit>,
    ) -> Rgb {
        let scene = self.lighting.world.scene;
        recorder.enter(call);
        match first_hit(&call.ray) {
            Some(hit) => {
                let surface = scene.surface_at(&call.ray, &hit);
                recorder.hit(&hit, &surface);
                self.at_surface(call, &surface, recorder)
            }
            None => scene.background,
        }
    }

    #[inline]
    fn at_surface<R: Recorder>(
        &self,
        call: &Call,
        surface: &SurfacePoint,
        recorder: &mut R,
    ) -> Rgb {
        let incident = call.ray.direction;
        let material = self.lighting.world.scene.material(surface.material);
        let n = surface.shading_normal_towards(-incident);
        let local = self.lighting.surface(surface, n, -incident, recorder);

        let branches = Branches::new(surface, material, incident);
        let [k_s, k_t] = branches.shares();
        let mut follow = |branch: Option<(Rgb, DVec3)>, kind| match branch {
            Some((k, direction)) => self.lr(call.next(surface, direction, k, kind), recorder),
            None => Rgb::ZERO,
        };
        let refracted = follow(branches.refracted, RayKind::Refracted);
        let reflected = follow(branches.mirror, RayKind::Mirror);
        recursion(local, k_s, reflected, k_t, refracted)
    }

    fn at_limit<R: Recorder>(
        &self,
        call: Call,
        recorder: &mut R,
        first_hit: impl Fn(&Ray) -> Option<Hit>,
    ) -> Rgb {
        let Settings { max_depth, min_weight, at_limit } = self.settings;
        if let AtLimit::Roulette { seed } = at_limit
            && call.depth <= max_depth
        {
            let survival = call.weight / min_weight;
            // A ray between two mirrors may come back bit for bit: the depth tells its turns apart.
            let turn = seed ^ u64::from(call.depth) << 32;
            if Uniform::of_ray(turn, &call.ray).number() < survival {
                let survivor = Call { weight: min_weight, ..call };
                return self.follow(&survivor, recorder, first_hit) / survival;
            }
        }
        recorder.cut(&call);
        let scene = self.lighting.world.scene;
        match at_limit {
            AtLimit::Black | AtLimit::Roulette { .. } => Rgb::ZERO,
            AtLimit::Ambient => scene.ambient,
            AtLimit::Background => scene.background,
        }
    }
}

impl Call {
    /// LR(Pt-inter, `direction`, profondeur + 1).
    #[inline]
    fn next(&self, surface: &SurfacePoint, direction: DVec3, k: Rgb, kind: RayKind) -> Self {
        Self {
            ray: surface.spawn(direction),
            depth: self.depth + 1,
            weight: self.weight * k.max_element(),
            kind,
        }
    }
}
