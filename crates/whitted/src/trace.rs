use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::optics::{reflect, refract};
use lancer_core::world::{SurfacePoint, World};

use crate::appel::Lighting;
use crate::recorder::{Call, RayKind, Recorder};

/// When the recursion ends, and with which colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Max_Prof: the largest number of bounces between the eye and a surface.
    pub max_depth: u32,
    /// A ray that would count less than this in its pixel is not traced; 0 traces all.
    pub min_weight: f64,
    /// The colour of a ray that is not traced.
    pub at_limit: AtLimit,
}

impl Default for Settings {
    /// Five bounces, and nothing below half a step of an 8-bit picture.
    fn default() -> Self {
        Self { max_depth: 5, min_weight: 0.5 / 255.0, at_limit: AtLimit::Black }
    }
}

/// « choix discutable mais que mettre ? »: the radiance of a ray that is not traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AtLimit {
    /// Black, the slide's choice.
    Black,
    /// The ambient radiance I_a.
    Ambient,
    /// The background, as if the ray met nothing.
    Background,
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
        self.lr(Call { ray: *ray, depth: 0, weight: 1.0, kind: RayKind::Primary }, recorder)
    }

    fn lr<R: Recorder>(&self, call: Call, recorder: &mut R) -> Rgb {
        let World { scene, index } = self.lighting.world;
        let radiance =
            if call.depth > self.settings.max_depth || call.weight < self.settings.min_weight {
                recorder.cut(&call);
                self.at_limit()
            } else {
                recorder.enter(&call);
                match index.closest_hit(&call.ray, Interval::POSITIVE) {
                    Some(hit) => {
                        let surface = scene.surface_at(&call.ray, &hit);
                        recorder.hit(&hit, &surface);
                        self.at_surface(&call, &surface, recorder)
                    }
                    None => scene.background,
                }
            };
        recorder.leave(radiance);
        radiance
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

        let (mut k_s, mut k_t) = (material.k_s, material.k_t);
        let mut refracted = Rgb::ZERO;
        let n = surface.optical_normal(incident);
        if k_t != Rgb::ZERO {
            let (n1, n2) = if surface.geometric_normal.dot(incident) < 0.0 {
                (1.0, material.refractive_index)
            } else {
                (material.refractive_index, 1.0)
            };
            if let Some(direction) = refract(incident, n, n1, n2) {
                refracted =
                    self.lr(call.next(surface, direction, k_t, RayKind::Refracted), recorder);
            } else {
                // Total reflection: what does not pass goes the way of the mirror.
                k_s += k_t;
                k_t = Rgb::ZERO;
            }
        }
        let mut reflected = Rgb::ZERO;
        if k_s != Rgb::ZERO {
            let direction = reflect(incident, n);
            reflected = self.lr(call.next(surface, direction, k_s, RayKind::Mirror), recorder);
        }
        recursion(local, k_s, reflected, k_t, refracted)
    }

    fn at_limit(&self) -> Rgb {
        let scene = self.lighting.world.scene;
        match self.settings.at_limit {
            AtLimit::Black => Rgb::ZERO,
            AtLimit::Ambient => scene.ambient,
            AtLimit::Background => scene.background,
        }
    }
}

impl Call {
    /// LR(Pt-inter, `direction`, profondeur + 1).
    #[inline]
    fn next(&self, surface: &SurfacePoint, direction: glam::DVec3, k: Rgb, kind: RayKind) -> Self {
        Self {
            ray: surface.spawn(direction),
            depth: self.depth + 1,
            weight: self.weight * k.max_element(),
            kind,
        }
    }
}
