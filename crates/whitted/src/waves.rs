//! The chapter's methods in waves: as many rays as possible are asked together.

use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::ImageSize;
use lancer_core::queue::Queue;
use lancer_core::render::Estimator;
use lancer_core::sampling::Sample;
use lancer_core::scene::PrimaryRays;
use lancer_core::world::SurfacePoint;

use crate::appel::{Appel, Lighting, TO_LIGHT};
use crate::recorder::{Call, RayCounts, RayKind, Recorder};
use crate::trace::{Whitted, recursion};

/// Rays of a wave after the first, at most; and shadow rays that wait.
const MOST: usize = 1 << 12;

/// A method that goes on from surfaces or not.
pub(crate) trait Follow: Sync {
    fn lighting(&self) -> &Lighting<'_>;
    /// By the mirror and by the refracted ray: the share of what the call returns.
    fn branches(&self, call: &Call, surface: &SurfacePoint) -> [(Rgb, Option<Call>); 2];
    /// Whether a call may wait for the next wave.
    fn may_wait(&self, call: &Call) -> bool;
    /// The radiance that a call returns, depth first.
    fn depth_first(&self, call: Call, counts: &mut RayCounts) -> Rgb;
}

impl Follow for Appel<'_> {
    fn lighting(&self) -> &Lighting<'_> {
        &self.lighting
    }

    #[inline]
    fn branches(&self, _: &Call, _: &SurfacePoint) -> [(Rgb, Option<Call>); 2] {
        [(Rgb::ZERO, None); 2]
    }

    fn may_wait(&self, _: &Call) -> bool {
        true
    }

    fn depth_first(&self, call: Call, counts: &mut RayCounts) -> Rgb {
        self.trace(&call.ray, counts)
    }
}

impl Follow for Whitted<'_> {
    fn lighting(&self) -> &Lighting<'_> {
        &self.lighting
    }

    #[inline]
    fn branches(&self, call: &Call, surface: &SurfacePoint) -> [(Rgb, Option<Call>); 2] {
        self.branches(call, surface)
    }

    #[inline]
    fn may_wait(&self, call: &Call) -> bool {
        self.is_followed(call)
    }

    fn depth_first(&self, call: Call, counts: &mut RayCounts) -> Rgb {
        self.lr(call, counts)
    }
}

/// Estimates a batch of samples in waves: all primary rays are asked together, then all shadow rays of what they meet,
/// then the rays that go on from there, and so forth; the tree of each sample is kept and summed up from its leaves.
/// The radiances are those of the recursion, bit for bit, and so are the counts.
pub(crate) struct Waves<M> {
    method: M,
    rays: PrimaryRays,
    /// Rays of a wave after the first, at most; those that find no room are followed depth first.
    most: usize,
}

/// What is known of a surface on the way: `eq:recursion` with what its two calls have returned so far.
struct Node {
    local: Rgb,
    shares: [Rgb; 2],
    returned: [Rgb; 2],
    to: To,
}

/// Where a radiance goes: to a sample, or to a branch of a node.
#[derive(Clone, Copy)]
enum To {
    Sample(usize),
    Mirror(usize),
    Refracted(usize),
}

/// What is known of a ray that waits, besides the ray.
struct Waiting {
    to: To,
    depth: u32,
    weight: f64,
    kind: RayKind,
}

impl Waiting {
    fn call(&self, ray: &Ray) -> Call {
        Call { ray: *ray, depth: self.depth, weight: self.weight, kind: self.kind }
    }
}

impl<M: Follow> Waves<M> {
    pub(crate) fn new(method: M, size: ImageSize) -> Self {
        let rays = method.lighting().world.scene.camera.primary_rays(size);
        Self { method, rays, most: MOST }
    }
}

impl<M: Follow> Estimator<RayCounts> for Waves<M> {
    fn radiance(&self, samples: &[Sample], radiance: &mut [Rgb], counts: &mut RayCounts) {
        let count = samples.len();
        let (mut wave, mut next) = (Queue::with_capacity(count), Queue::with_capacity(count));
        for (k, sample) in samples.iter().enumerate() {
            let call = Call::primary(&self.rays.through(sample.film.x, sample.film.y));
            if self.method.may_wait(&call) {
                push(&mut wave, To::Sample(k), &call);
            } else {
                radiance[k] = self.method.depth_first(call, counts);
            }
        }
        let mut nodes = Vec::with_capacity(2 * count);
        let mut shadow_rays = Queue::with_capacity(2 * count);
        while !wave.is_empty() {
            self.answer(&mut wave, &mut next, &mut nodes, &mut shadow_rays, radiance, counts);
            self.light(&mut shadow_rays, &mut nodes, counts);
            std::mem::swap(&mut wave, &mut next);
        }
        // Calls come after what they return to.
        while let Some(Node { local, shares: [k_s, k_t], returned: [mirror, refracted], to }) =
            nodes.pop()
        {
            deliver(to, recursion(local, k_s, mirror, k_t, refracted), &mut nodes, radiance);
        }
    }
}

impl<M: Follow> Waves<M> {
    /// Adds the terms whose shadow rays reach their lights, in the order in which they came: for each node lamp by
    /// lamp.
    fn light(
        &self,
        shadow_rays: &mut Queue<(usize, Rgb)>,
        nodes: &mut [Node],
        counts: &mut RayCounts,
    ) {
        counts.shadow += shadow_rays.len() as u64;
        let index = self.method.lighting().world.index;
        shadow_rays.occluded(index, TO_LIGHT, |(node, term), is_occluded| {
            if !is_occluded {
                nodes[node].local += term;
            }
        });
    }

    /// Answers a wave: each surface that it meets becomes a node, with its shadow rays and the rays of the next wave.
    fn answer(
        &self,
        wave: &mut Queue<Waiting>,
        next: &mut Queue<Waiting>,
        nodes: &mut Vec<Node>,
        shadow_rays: &mut Queue<(usize, Rgb)>,
        radiance: &mut [Rgb],
        counts: &mut RayCounts,
    ) {
        let lighting = self.method.lighting();
        let scene = lighting.world.scene;
        wave.closest_hits(lighting.world.index, Interval::POSITIVE, |ray, waiting, hit| {
            let call = waiting.call(ray);
            counts.enter(&call);
            let Some(hit) = hit else {
                return deliver(waiting.to, scene.background, nodes, radiance);
            };
            let surface = scene.surface_at(ray, &hit);
            let n = surface.shading_normal_towards(-ray.direction);
            let node = nodes.len();
            let local = lighting.queued(&surface, n, -ray.direction, |shadow_ray, term| {
                shadow_rays.push(*shadow_ray, (node, term));
            });
            let [(k_s, mirror), (k_t, refracted)] = self.method.branches(&call, &surface);
            nodes.push(Node {
                local,
                shares: [k_s, k_t],
                returned: [Rgb::ZERO; 2],
                to: waiting.to,
            });
            if shadow_rays.len() > self.most {
                self.light(shadow_rays, nodes, counts);
            }
            for (call, to) in [(refracted, To::Refracted(node)), (mirror, To::Mirror(node))] {
                let Some(call) = call else { continue };
                if next.len() < self.most && self.method.may_wait(&call) {
                    push(next, to, &call);
                } else {
                    deliver(to, self.method.depth_first(call, counts), nodes, radiance);
                }
            }
        });
    }
}

fn push(queue: &mut Queue<Waiting>, to: To, &Call { ray, depth, weight, kind }: &Call) {
    queue.push(ray, Waiting { to, depth, weight, kind });
}

fn deliver(to: To, returned: Rgb, nodes: &mut [Node], radiance: &mut [Rgb]) {
    match to {
        To::Sample(k) => radiance[k] = returned,
        To::Mirror(node) => nodes[node].returned[0] = returned,
        To::Refracted(node) => nodes[node].returned[1] = returned,
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use lancer_accel::Wide;
    use lancer_core::generate::icosphere;
    use lancer_core::geometry::Sphere;
    use lancer_core::render::PrimaryHits;
    use lancer_core::sampling::{Pattern, PixelSampling};
    use lancer_core::scene::{Camera, Material, MaterialId, PointLight, Scene, SphereObject};
    use lancer_core::world::World;

    use super::*;
    use crate::trace::{AtLimit, Settings};

    /// A ball of glass and one of mirror before a matte mesh, under two lamps.
    fn scene() -> Scene {
        let mut scene = Scene::of_mesh(icosphere(2));
        let glass = Material { k_s: Rgb::splat(0.2), k_t: Rgb::splat(0.8), ..scene.materials[0] };
        let mirror = Material { k_s: Rgb::new(0.9, 0.7, 0.5), ..scene.materials[0] };
        scene.materials.extend([Material { refractive_index: 1.5, ..glass }, mirror]);
        for (x, material) in [(-1.0, 1), (1.1, 2)] {
            let shape = Sphere { center: DVec3::new(x, 0.3, 1.2), radius: 0.7 };
            scene.spheres.push(SphereObject { shape, material: MaterialId(material) });
        }
        for x in [-4.0, 3.0] {
            let position = DVec3::new(x, 5.0, 6.0);
            scene.lights.push(PointLight { position, intensity: Rgb::new(30.0, 20.0, 10.0) });
        }
        let look_at = DVec3::new(0.0, 0.2, 0.0);
        scene.camera = Camera { eye: DVec3::new(0.3, 0.4, 4.0), look_at, ..scene.camera };
        scene.background = Rgb::new(0.2, 0.3, 0.4);
        scene.ambient = Rgb::splat(0.1);
        scene
    }

    /// The same bits and counts as depth first, for any batch and room, whatever ends the recursion.
    #[test]
    fn waves_are_the_recursion_in_another_order() {
        let scene = scene();
        let index = Wide::build(&scene);
        let world = World { scene: &scene, index: &index };
        let size = ImageSize::new(24, 16);
        let sampling = PixelSampling { pattern: Pattern::Owen, samples: 2, seed: 1 };
        let pixels = (0..16).flat_map(|y| (0..24).map(move |x| (x, y)));
        let samples: Vec<Sample> = pixels.flat_map(|(x, y)| sampling.of_pixel(x, y)).collect();
        let mut bounces = Vec::new();
        for (max_depth, min_weight, at_limit) in [
            (0, 0.0, AtLimit::Background),
            (4, 0.3, AtLimit::Ambient),
            (7, 0.0, AtLimit::Black),
            (7, 0.3, AtLimit::Roulette { seed: 5 }),
        ] {
            let whitted = Whitted::new(world, Settings { max_depth, min_weight, at_limit });
            let depth_first =
                PrimaryHits::new(world, size, |ray, hit, _, counts: &mut RayCounts| {
                    whitted.shade(ray, hit, counts)
                });
            let mut wanted = vec![Rgb::ZERO; samples.len()];
            let mut wanted_counts = RayCounts::default();
            depth_first.radiance(&samples, &mut wanted, &mut wanted_counts);
            bounces.push(wanted_counts.mirror + wanted_counts.refracted);
            for (batch, most) in [(1, MOST), (7, 3), (128, MOST), (samples.len(), 0), (300, 40)] {
                let waves = Waves { most, ..Waves::new(whitted.clone(), size) };
                let mut got = vec![Rgb::NAN; samples.len()];
                let mut counts = RayCounts::default();
                for (samples, got) in samples.chunks(batch).zip(got.chunks_mut(batch)) {
                    waves.radiance(samples, got, &mut counts);
                }
                assert_eq!(counts, wanted_counts, "{max_depth} {at_limit:?} {batch} {most}");
                assert!(got == wanted, "{max_depth} {at_limit:?} {batch} {most}");
            }
        }
        assert!(bounces[0] == 0 && bounces[1] > 100 && bounces[2] > 2 * bounces[1], "{bounces:?}");

        let appel = Appel::new(world);
        let shade =
            |ray: &Ray, hit, _: &Sample, counts: &mut RayCounts| appel.shade(ray, hit, counts);
        let estimators: [&dyn Estimator<RayCounts>; 2] =
            [&PrimaryHits::new(world, size, shade), &Waves::new(appel.clone(), size)];
        let answers = estimators.map(|estimator| {
            let (mut radiance, mut counts) = (vec![Rgb::NAN; samples.len()], RayCounts::default());
            estimator.radiance(&samples, &mut radiance, &mut counts);
            (radiance, counts)
        });
        assert!(answers[0] == answers[1] && answers[0].1.shadow > 100);
    }
}
