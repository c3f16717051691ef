use crate::Rgb;
use crate::geometry::{Interval, Ray};
use crate::image::ImageSize;
use crate::intersector::Hit;
use crate::sampling::Sample;
use crate::scene::PrimaryRays;
use crate::world::World;

/// Estimates the radiance that arrives at samples. A function of a sample and the counts is an estimator, and
/// so are [`PrimaryHits`] and [`AlongRays`].
pub trait Estimator<C>: Sync {
    /// The radiance at each sample, into the slice of the same length.
    fn radiance(&self, samples: &[Sample], radiance: &mut [Rgb], counts: &mut C);
}

impl<C, F: Fn(&Sample, &mut C) -> Rgb + Sync> Estimator<C> for F {
    fn radiance(&self, samples: &[Sample], radiance: &mut [Rgb], counts: &mut C) {
        for (sample, radiance) in samples.iter().zip(radiance) {
            *radiance = self(sample, counts);
        }
    }
}

/// What the scene's camera sees first at each sample: the primary rays of a batch are answered together, which
/// is faster with some indexes, and `shade` tells what comes back along each.
pub struct PrimaryHits<'a, F> {
    world: World<'a>,
    rays: PrimaryRays,
    shade: F,
}

impl<'a, F> PrimaryHits<'a, F> {
    /// For pictures of one size.
    pub fn new<C>(world: World<'a>, size: ImageSize, shade: F) -> Self
    where
        F: Fn(&Ray, Option<Hit>, &Sample, &mut C) -> Rgb,
    {
        Self { world, rays: world.scene.camera.primary_rays(size), shade }
    }
}

impl<C, F> Estimator<C> for PrimaryHits<'_, F>
where
    F: Fn(&Ray, Option<Hit>, &Sample, &mut C) -> Rgb + Sync,
{
    fn radiance(&self, samples: &[Sample], radiance: &mut [Rgb], counts: &mut C) {
        let rays = rays_through(&self.rays, samples);
        let mut hits = vec![None; rays.len()];
        self.world.index.closest_hits(&rays, Interval::POSITIVE, &mut hits);
        for (((ray, hit), sample), radiance) in rays.iter().zip(hits).zip(samples).zip(radiance) {
            *radiance = (self.shade)(ray, hit, sample, counts);
        }
    }
}

fn rays_through(rays: &PrimaryRays, samples: &[Sample]) -> Vec<Ray> {
    samples.iter().map(|sample| rays.through(sample.film.x, sample.film.y)).collect()
}

/// What comes back along the primary rays of the scene's camera, one through each sample: `trace` answers a batch.
pub struct AlongRays<F> {
    rays: PrimaryRays,
    trace: F,
}

impl<F> AlongRays<F> {
    /// For pictures of one size.
    pub fn new<C>(world: World, size: ImageSize, trace: F) -> Self
    where
        F: Fn(&[Ray], &[Sample], &mut [Rgb], &mut C),
    {
        Self { rays: world.scene.camera.primary_rays(size), trace }
    }
}

impl<C, F> Estimator<C> for AlongRays<F>
where
    F: Fn(&[Ray], &[Sample], &mut [Rgb], &mut C) + Sync,
{
    fn radiance(&self, samples: &[Sample], radiance: &mut [Rgb], counts: &mut C) {
        let rays = rays_through(&self.rays, samples);
        (self.trace)(&rays, samples, radiance, counts);
    }
}
