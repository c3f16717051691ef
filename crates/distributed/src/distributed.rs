use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::illumination::{Reflectance, ambient, lit, recursion};
use lancer_core::intersector::{Hit, Intersector};
use lancer_core::method::Branching;
use lancer_core::moving::Moment;
use lancer_core::optics::Branches;
use lancer_core::sampling::Sample;
use lancer_core::scene::PointSource;
use lancer_core::world::SurfacePoint;

use crate::gloss::spread;
use crate::lamps::Lamps;
use crate::numbers::{Numbers, of_sample};
use crate::rays::RayCounts;

/// When the recursion ends, and which of its branches it follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Max_Prof: the largest number of bounces between the eye and a surface.
    pub max_depth: u32,
    /// A ray whose k_s and k_t on the way have a smaller product than this is not traced; 0 traces all.
    pub min_weight: f64,
    /// Which way a ray goes on where a surface both reflects and refracts.
    pub branching: Branching,
}

impl Default for Settings {
    /// Five bounces, and nothing below half a step of an 8-bit picture, as LR. Both branches: of equal time, one at random
    /// has several times the squared error before mirrors and balls of glass, where what it skips is bright
    /// (`cargo xtask render whitted --method distributed --branches one` beside it, by `cargo xtask compare`).
    fn default() -> Self {
        Self { max_depth: 5, min_weight: 0.5 / 255.0, branching: Branching::Both }
    }
}

/// The method of Cook, Porter and Carpenter (1984): the slides' algorithm LR, in which each ray also draws what it is
/// averaged over.
///
/// - *Follows* LR's rays; each shadow ray ends in a random point of its lamp, the ray itself starts in a random point
///   of the lens at a random time and passes a random point of its pixel, and rough surfaces send it a random way around
///   R or T; where a surface both reflects and refracts it follows both ways, or one at random.
/// - *Wins* where what is seen is an average over few things that a ray can choose: soft shadows, gloss, depth of field,
///   motion blur and antialiasing for the rays of a sharp picture, with noise in place of steps.
/// - *Loses* the light between matte surfaces, for which it has the ambient constant; noise falls with the root of the
///   number of samples, and lamps are asked one by one, all of them.
/// - *Sources*: Cook, Porter, Carpenter, *Distributed Ray Tracing*, SIGGRAPH 1984; slides « Lancer de rayons
///   distribués : modèle d'illumination ».
#[derive(Clone)]
pub struct Distributed<'a> {
    world: Moment<'a>,
    points: Vec<PointSource>,
    lamps: Lamps,
    settings: Settings,
}

/// LR's arguments.
struct Call {
    ray: Ray,
    /// 0 for a primary ray, one more per bounce.
    depth: u32,
    /// The product of the k_s and k_t on the way here, each of its strongest channel.
    weight: f64,
    /// The random numbers for what the ray meets.
    numbers: Numbers,
}

impl<'a> Distributed<'a> {
    /// Prepares the method for a world, of which parts may move.
    pub fn new(world: impl Into<Moment<'a>>, settings: Settings) -> Self {
        let world = world.into();
        let (points, lamps) = (
            world.scene().lights.iter().map(PointSource::from).collect(),
            Lamps::new(world.scene()),
        );
        Self { world, points, lamps, settings }
    }

    /// The radiance that comes back along a primary ray of unit direction, whose first hit is known; the numbers are
    /// those of `sample`.
    ///
    /// ```text
    /// algo:distributed    LR, whose C_locale takes each lamp in one of its points,
    ///                     drawn with density p per solid angle:   I = L d² / (π p)
    /// ```
    ///
    /// With [`Branching::One`] LR calls itself for one D of D_réfléchi and D_réfracté, drawn with the probabilities
    /// P and 1 − P, and takes k LR / P.
    ///
    /// `emission` is what the eye sees the first surface emit, where that is known better than by this one ray.
    ///
    /// Slide « Lancer de rayons distribués ».
    #[doc(alias = "algo:distributed")]
    #[doc(alias = "lancer de rayons distribués")]
    #[inline]
    pub fn shade(
        &self,
        ray: &Ray,
        hit: Option<Hit>,
        emission: Option<Rgb>,
        sample: &Sample,
        rays: &mut RayCounts,
    ) -> Rgb {
        rays.primary += 1;
        let call = Call { ray: *ray, depth: 0, weight: 1.0, numbers: Numbers::new(sample) };
        self.at_end(&call, &of_sample(self.world, sample), hit, emission, rays)
    }

    /// LR(origine, direction, profondeur): `count` is that of the ray's kind.
    fn lr(
        &self,
        call: &Call,
        world: &Moment,
        count: fn(&mut RayCounts) -> &mut u64,
        rays: &mut RayCounts,
    ) -> Rgb {
        if call.depth > self.settings.max_depth || call.weight < self.settings.min_weight {
            return Rgb::ZERO;
        }
        *count(rays) += 1;
        let hit = world.closest_hit(&call.ray, Interval::POSITIVE);
        self.at_end(call, world, hit, None, rays)
    }

    /// What comes back along a ray that ends in `hit`.
    #[inline]
    fn at_end(
        &self,
        call: &Call,
        world: &Moment,
        hit: Option<Hit>,
        emission: Option<Rgb>,
        rays: &mut RayCounts,
    ) -> Rgb {
        let scene = world.scene();
        let Some(hit) = hit else { return scene.background + emission.unwrap_or(Rgb::ZERO) };
        let surface = world.surface_at(&call.ray, &hit);
        let incident = call.ray.direction;
        let emission = emission.unwrap_or_else(|| scene.emitted(&surface, -incident));
        let unlit = (world.reflectance(&hit, &surface), emission);
        let local = self.local(world, &surface, -incident, unlit, &call.numbers, rays);

        let material = scene.material(surface.material);
        let branches = Branches::new(&surface, material, incident);
        let [k_s, k_t] = branches.shares();
        let [mirror, refracted] = self.odds([k_s, k_t], &call.numbers);
        let mut follow = |branch: Option<(Rgb, DVec3)>, odds: f64, number, count| match branch {
            Some((k, axis)) if odds > 0.0 => {
                let numbers = call.numbers.along(number);
                let Some(direction) = spread(&surface, material, axis, || numbers.direction())
                else {
                    return Rgb::ZERO;
                };
                let next = Call {
                    ray: surface.spawn(direction),
                    depth: call.depth + 1,
                    weight: call.weight * k.max_element(),
                    numbers,
                };
                self.lr(&next, world, count, rays) / odds
            }
            _ => Rgb::ZERO,
        };
        let through = follow(branches.refracted, refracted, 1, |rays| &mut rays.refracted);
        let reflected = follow(branches.mirror, mirror, 0, |rays| &mut rays.mirror);
        recursion(local, k_s, reflected, k_t, through)
    }

    /// C_locale: emission and ambient term, the point lights, and each lamp by one of its points.
    #[inline]
    fn local(
        &self,
        world: &Moment,
        surface: &SurfacePoint,
        to_eye: DVec3,
        (reflectance, emission): (Reflectance, Rgb),
        numbers: &Numbers,
        rays: &mut RayCounts,
    ) -> Rgb {
        let n = surface.shading_normal_towards(to_eye);
        let mut visible = |shadow_ray: &Ray| {
            rays.shadow += 1;
            !world.occluded(shadow_ray, Interval::up_to(1.0))
        };
        let unlit = ambient(reflectance.diffuse, world.scene().ambient) + emission;
        let points = self.points.iter().map(|source| source.arriving(surface));
        let by_points = lit(unlit, &reflectance, n, to_eye, points, &mut visible);
        let receiver = surface.lit_from(n);
        let lamps = self.lamps.as_slice().iter().enumerate().filter_map(|(number, lamp)| {
            let point = lamp.sample_at(world, receiver, numbers.on_lamp(number))?;
            Some(lamp.arriving(surface, &point, 1.0))
        });
        lit(by_points, &reflectance, n, to_eye, lamps, visible)
    }

    /// The probabilities with which the mirror and the refracted ray were chosen, 0 for one that was not.
    #[inline]
    fn odds(&self, shares: [Rgb; 2], numbers: &Numbers) -> [f64; 2] {
        let [mirror, refracted] = shares.map(Rgb::max_element);
        if self.settings.branching == Branching::Both || mirror == 0.0 || refracted == 0.0 {
            return [1.0, 1.0];
        }
        let odds = mirror / (mirror + refracted);
        if numbers.way() < odds { [odds, 0.0] } else { [0.0, 1.0 - odds] }
    }
}
