use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::intersector::{Hit, Intersector};
use lancer_core::method::Strategy;
use lancer_core::moving::Moment;
use lancer_core::optics::Branches;
use lancer_core::sampling::{Sample, power_heuristic};
use lancer_core::world::SurfacePoint;

use crate::gloss::spread;
use crate::lights::{Light, Lights};
use crate::lobes::{Lobes, Onwards, Way};
use crate::numbers::{Numbers, of_sample};
use crate::rays::RayCounts;

/// When a path ends, and how it finds lamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSettings {
    /// The largest number of bounces between the eye and a surface; `None` ends by roulette alone, without bias.
    pub max_depth: Option<u32>,
    /// From which bounce on a path survives at random only.
    pub roulette_from: u32,
    /// How the light of lamps is found.
    pub strategy: Strategy,
}

impl Default for PathSettings {
    /// No largest number of bounces, roulette from the third on, and lamps found both ways.
    fn default() -> Self {
        Self { max_depth: None, roulette_from: 3, strategy: Strategy::Mis }
    }
}

/// Whether a path goes on: « roulette russe ».
///
/// ```text
/// eq:roulette             ⟨F⟩ = X / q  with the probability q,   0 otherwise
/// ```
///
/// `throughput` is what an answer X will count; `number` in [0, 1) decides. Returns 1/q, or `None` for the end. The
/// probability q is the throughput's strongest channel, but at most 0.95: a path between surfaces that take nothing
/// ends too.
///
/// Source: Arvo, Kirk, *Particle Transport and Image Synthesis*, SIGGRAPH 1990.
#[doc(alias = "eq:roulette")]
#[doc(alias = "roulette russe")]
#[inline]
pub fn roulette(throughput: Rgb, number: f64) -> Option<f64> {
    let survival = throughput.max_element().min(LIKELIEST);
    (number < survival).then(|| survival.recip())
}

const LIKELIEST: f64 = 0.95;

/// Kajiya's method (1986): the slides' rendering equation, one random path per sample.
///
/// - *Follows* one ray from each surface, in a direction drawn from what the surface reflects, and a shadow ray to a
///   point of a lamp drawn among all.
/// - *Wins* wherever the other methods put a constant: light between matte surfaces, with no term left out.
/// - *Loses* time where light comes through glass or by a mirror from a small lamp, which only luck finds, and never
///   from a point light.
/// - *Sources*: Kajiya, *The Rendering Equation*, SIGGRAPH 1986; Veach, Guibas, *Optimally Combining Sampling
///   Techniques for Monte Carlo Rendering*, SIGGRAPH 1995; slides « Intégration de Monte Carlo ».
#[derive(Clone)]
pub struct PathTracer<'a> {
    world: Moment<'a>,
    lights: Lights,
    /// Whether nothing shines on a surface that light samples would not find.
    lights_are_all: bool,
    settings: PathSettings,
}

/// How a path came to a surface.
#[derive(Clone, Copy)]
struct Arrival {
    /// Where light samples would have started.
    receiver: DVec3,
    /// The density with which the direction was drawn; `None` if light samples do not look there.
    density: Option<f64>,
}

impl<'a> PathTracer<'a> {
    /// Prepares the method for a world, of which parts may move.
    pub fn new(world: impl Into<Moment<'a>>, settings: PathSettings) -> Self {
        let world = world.into();
        let lights = Lights::new(world.scene(), settings.strategy != Strategy::Lobe);
        let lights_are_all = lights.find_all_of(world.scene());
        Self { world, lights, lights_are_all, settings }
    }

    /// The radiance that comes back along a primary ray of unit direction, whose first hit is known; the numbers are
    /// those of `sample`.
    ///
    /// ```text
    /// algo:path           L = 0,  β = 1
    ///                     Répéter  Si aucune intersection              → L += β fond, fin
    ///                              L += β w ε
    ///                              L += β w I vis/d² ( … )             pour un point d'une lampe
    ///                              D tirée selon p,  β *= f cos θ / p
    ///                              Roulette : β /= q, ou fin
    /// ```
    ///
    /// `emission` is what the eye sees the first surface emit, where that is known better than by this one ray.
    ///
    /// Light that reaches a surface after [`PathSettings::max_depth`] bounces, directly from a lamp or the background,
    /// counts; none that was reflected to it.
    #[doc(alias = "algo:path")]
    #[doc(alias = "tracé de chemins")]
    #[inline]
    pub fn shade(
        &self,
        ray: &Ray,
        hit: Option<Hit>,
        emission: Option<Rgb>,
        sample: &Sample,
        rays: &mut RayCounts,
    ) -> Rgb {
        let world = &of_sample(self.world, sample);
        let scene = world.scene();
        let (mut radiance, mut throughput) = (Rgb::ZERO, Rgb::ONE);
        let (mut ray, mut hit, mut emission) = (*ray, hit, emission);
        let mut numbers = Numbers::new(sample);
        let mut arrival = Arrival { receiver: ray.origin, density: None };
        rays.primary += 1;
        for depth in 0.. {
            let Some(met) = hit else {
                let emission = emission.unwrap_or(Rgb::ZERO);
                return radiance + throughput * (scene.background + emission);
            };
            let surface = world.surface_at(&ray, &met);
            let to_eye = -ray.direction;
            let emitted = emission.take();
            let emitted =
                emitted.unwrap_or_else(|| self.emitted(world, &met, &surface, to_eye, arrival));
            radiance += throughput * emitted;
            if self.settings.max_depth.is_some_and(|most| depth > most) {
                break;
            }

            let material = scene.material(surface.material);
            let branches = Branches::new(&surface, material, -to_eye);
            let n = surface.shading_normal_towards(to_eye);
            let lobes = Lobes::new(world.reflectance(&met, &surface), n, to_eye, branches);
            let is_last = self.settings.max_depth == Some(depth);
            let strategy = self.strategy_at(&lobes, is_last);
            if lobes.scatter() {
                let direct = self.direct(world, &surface, &lobes, strategy, &numbers, rays);
                radiance += throughput * direct;
            }
            if is_last && strategy == Strategy::Lamp && self.lights_are_all {
                break;
            }

            let onwards = numbers.along(0);
            let way = lobes.sample(|| numbers.way(), || onwards.direction());
            let Some(Onwards { direction, weight, way }) = way else { break };
            throughput *= weight;
            if depth + 1 >= self.settings.roulette_from {
                let Some(compensation) = roulette(throughput, numbers.survival()) else { break };
                throughput *= compensation;
            }
            let count;
            (ray, arrival.density, count) = match way {
                Way::Lobe(density) => {
                    (surface.spawn_for_light(direction), Some(density), &mut rays.lobe)
                }
                // What a surface mirrors was reflected to it.
                Way::Mirror | Way::Refracted if is_last => break,
                Way::Mirror | Way::Refracted => {
                    let spread = spread(&surface, material, direction, || onwards.direction());
                    let Some(direction) = spread else { break };
                    let is_mirror = way == Way::Mirror;
                    let count = if is_mirror { &mut rays.mirror } else { &mut rays.refracted };
                    (surface.spawn(direction), None, count)
                }
            };
            *count += 1;
            arrival.receiver = surface.lit_from(n);
            numbers = onwards;
            hit = world.closest_hit(&ray, Interval::POSITIVE);
        }
        radiance
    }

    /// How lamps are found from a surface. At the end of a path a matte one needs no ray for them but the shadow ray.
    #[inline]
    fn strategy_at(&self, lobes: &Lobes, is_last: bool) -> Strategy {
        let strategy = self.settings.strategy;
        let enough = is_last && self.lights_are_all && !lobes.have_highlight();
        if strategy == Strategy::Mis && enough { Strategy::Lamp } else { strategy }
    }

    /// w ε: what a surface emits along a ray that has met it, as far as it is for that ray to find.
    #[inline]
    fn emitted(
        &self,
        world: &Moment,
        hit: &Hit,
        surface: &SurfacePoint,
        to_eye: DVec3,
        arrival: Arrival,
    ) -> Rgb {
        let scene = world.scene();
        let emitted = scene.emitted(surface, to_eye);
        if emitted == Rgb::ZERO {
            return emitted;
        }
        let Some(density) = arrival.density else { return emitted };
        let lamps = &self.lights.lamps;
        let Some(number) = lamps.of(scene, hit.primitive) else { return emitted };
        match self.settings.strategy {
            Strategy::Lobe => emitted,
            Strategy::Lamp => Rgb::ZERO,
            Strategy::Mis => {
                let (position, normal) = (surface.position, surface.geometric_normal);
                let lamp = &lamps.as_slice()[number];
                let lamp = lamp.density_at(world, arrival.receiver, position, normal);
                let sampled = self.lights.odds_of_lamp(number) * lamp;
                emitted * power_heuristic(density, sampled)
            }
        }
    }

    /// The light of one light that a surface sends to the eye, for that of all.
    #[inline]
    fn direct(
        &self,
        world: &Moment,
        surface: &SurfacePoint,
        lobes: &Lobes,
        strategy: Strategy,
        numbers: &Numbers,
        rays: &mut RayCounts,
    ) -> Rgb {
        let mut visible = |shadow_ray: &Ray| {
            rays.shadow += 1;
            !world.occluded(shadow_ray, Interval::up_to(1.0))
        };
        let Some((light, chosen)) = self.lights.choose(|| numbers.light()) else {
            return Rgb::ZERO;
        };
        match light {
            Light::Point(source) => {
                let arriving = source.arriving(surface);
                let unshadowed = lobes.unshadowed(&arriving) / chosen;
                let lit = unshadowed != Rgb::ZERO && visible(&arriving.shadow_ray);
                if lit { unshadowed } else { Rgb::ZERO }
            }
            Light::Lamp(lamp) => {
                let receiver = surface.lit_from(lobes.normal());
                let Some(point) = lamp.sample_at(world, receiver, numbers.on_lamp(0)) else {
                    return Rgb::ZERO;
                };
                let arriving = lamp.arriving(surface, &point, chosen);
                let mut unshadowed = lobes.unshadowed(&arriving);
                if unshadowed == Rgb::ZERO || !visible(&arriving.shadow_ray) {
                    return Rgb::ZERO;
                }
                if strategy == Strategy::Mis {
                    let to_light = arriving.shadow_ray.direction.normalize();
                    let drawn = lobes.density(to_light);
                    unshadowed *= power_heuristic(chosen * point.density, drawn);
                }
                unshadowed
            }
        }
    }
}
