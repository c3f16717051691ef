//! The outline of a lamp, for itself.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray, Sphere};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Hit, Intersector};
use lancer_core::method::Effect;
use lancer_core::moving::Moment;
use lancer_core::render::Estimator;
use lancer_core::sampling::{Pattern, Sample, concentric_disc};
use lancer_core::scene::{PrimaryRays, Scene};

use crate::numbers::{lens_and_time, of_sample};
use crate::rays::RayCounts;

/// More rays per sample from the eye, where the outline of a lamp crosses the pixel.
const RAYS: u32 = 16;

/// The pixels that the outline of a lamp crosses.
///
/// A lamp is many times brighter than what it lights, so most of a picture's error sits where pixels show it in part:
/// in a Cornell box more than half of it, in a hundredth of the pixels. What the eye sees surfaces emit is an integral
/// of its own, which needs rays from the eye and nothing else. Here it is taken from many more of them, and the rest
/// from the sample as ever:
///
/// ```text
/// P = ∫ ε dx dy + ∫ (I − ε) dx dy
/// ```
///
/// Which pixels these are follows from the scene alone, not from samples, so that both sums stay unbiased. They are
/// those of the outline as the middle of the lens sees it when the shutter opens: where it is blurred, or hidden in
/// part, what is beside it has the sample's noise.
#[derive(Clone, Debug)]
pub struct Outlines {
    size: ImageSize,
    crossed: Vec<bool>,
}

impl Outlines {
    /// Projects the outlines of all lamps, as the middle of the lens sees them when the shutter opens.
    pub fn new(scene: &Scene, size: ImageSize) -> Self {
        let rays = scene.camera.primary_rays(size);
        let mut outlines = Self { size, crossed: Vec::new() };
        let eye = scene.camera.eye;
        // Through a lens or in motion the eye may come to the other side.
        let is_sharp = !Effect::Lens.is_in(scene) && !Effect::Motion.is_in(scene);
        for lamp in scene.area_lights() {
            if is_sharp && (eye - lamp.centroid).dot(lamp.normal) <= 0.0 {
                continue;
            }
            for outline in scene.mesh.outline(lamp.face) {
                outlines.follow(&rays, outline.iter().map(|&k| scene.mesh.positions[k as usize]));
            }
        }
        for lamp in scene.sphere_lights() {
            outlines.follow(&rays, silhouette(&lamp.shape, eye));
        }
        outlines
    }

    /// Marks the pixels on a closed polygon.
    fn follow(&mut self, rays: &PrimaryRays, corners: impl Iterator<Item = DVec3>) {
        let corners: Vec<DVec3> = corners.map(|p| rays.homogeneous(p)).collect();
        for (k, &from) in corners.iter().enumerate() {
            self.cross(from, corners[(k + 1) % corners.len()]);
        }
    }

    /// Whether a pixel is one of them.
    #[inline]
    pub fn cross_pixel(&self, [x, y]: [u32; 2]) -> bool {
        let index = y as usize * self.size.width as usize + x as usize;
        self.crossed.get(index).copied().unwrap_or(false)
    }

    /// Marks the pixels on an edge, whose ends are homogeneous points of the film.
    fn cross(&mut self, from: DVec3, to: DVec3) {
        let [width, height] = [self.size.width, self.size.height].map(f64::from);
        // Inside the picture all of these are positive: x, w − x, y and h − y, times the depth.
        let sides = |p: DVec3| [p.x, width * p.z - p.x, p.y, height * p.z - p.y];
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for (a, b) in sides(from).into_iter().zip(sides(to)) {
            match (a > 0.0, b > 0.0) {
                (false, false) => return,
                (true, false) => last = last.min(a / (a - b)),
                (false, true) => first = first.max(a / (a - b)),
                (true, true) => (),
            }
        }
        if first >= last {
            return;
        }
        self.crossed.resize(self.size.pixels(), false);
        let [a, b] = [first, last].map(|t| from.lerp(to, t)).map(|p| p.truncate() / p.z);
        let (a, b) = if a.x <= b.x { (a, b) } else { (b, a) };
        for column in a.x as u32..=(b.x as u32).min(self.size.width - 1) {
            let at =
                |x: f64| if b.x > a.x { a.y + (x - a.x) / (b.x - a.x) * (b.y - a.y) } else { a.y };
            let left = at(f64::from(column).max(a.x));
            let right = if b.x > a.x { at(f64::from(column + 1).min(b.x)) } else { b.y };
            let (low, high) = (left.min(right) as u32, left.max(right) as u32);
            for row in low..=high.min(self.size.height - 1) {
                self.crossed[(row * self.size.width + column) as usize] = true;
            }
        }
    }
}

/// A polygon on the circle where rays from the eye touch a sphere; empty from inside.
fn silhouette(sphere: &Sphere, eye: DVec3) -> impl Iterator<Item = DVec3> {
    /// Between two of them the circle is .03 % of the radius off: a pixel where it is 6000 wide.
    const CORNERS: u32 = 128;
    let to_eye = eye - sphere.center;
    let sin = sphere.radius / to_eye.length();
    let axis = to_eye.normalize_or(DVec3::Z);
    let (x, y) = axis.any_orthonormal_pair();
    let middle = sphere.center + sphere.radius * sin * axis;
    let reach = sphere.radius * (1.0 - sin * sin).max(0.0).sqrt();
    let corner = move |k| {
        let (sin, cos) = (TAU * f64::from(k) / f64::from(CORNERS)).sin_cos();
        middle + reach * (cos * x + sin * y)
    };
    (0..if sin < 1.0 { CORNERS } else { 0 }).map(corner)
}

/// What a method shades: a primary ray with its first hit, what the eye sees there emit if that is known, and the
/// sample.
pub struct Eye<'a, F> {
    world: Moment<'a>,
    rays: PrimaryRays,
    has_lens: bool,
    outlines: Option<Outlines>,
    shade: F,
}

impl<'a, F> Eye<'a, F>
where
    F: Fn(&Ray, Option<Hit>, Option<Rgb>, &Sample, &mut RayCounts) -> Rgb,
{
    /// For pictures of one size, whose samples are laid out by `pattern`: those of a regular grid are what they are, and
    /// outlines are not looked after.
    pub fn new(world: impl Into<Moment<'a>>, size: ImageSize, pattern: Pattern, shade: F) -> Self {
        let world = world.into();
        let Scene { camera, .. } = world.scene();
        let is_random = pattern != Pattern::Regular;
        let outlines = is_random.then(|| Outlines::new(world.scene(), size));
        let has_lens = camera.lens.is_some_and(|lens| lens.radius > 0.0);
        Self { world, rays: camera.primary_rays(size), has_lens, outlines, shade }
    }

    /// The rays of samples and, if anything moves, their times.
    fn rays(&self, samples: &[Sample]) -> (Vec<Ray>, Vec<f64>) {
        let (rays, moves) = (&self.rays, self.world.moves());
        let through = |sample: &Sample| rays.through(sample.film.x, sample.film.y);
        if !(self.has_lens || moves) {
            return (samples.iter().map(through).collect(), Vec::new());
        }
        let draw = |sample: &Sample| {
            let (lens, time) = lens_and_time(sample);
            if self.has_lens {
                (rays.through_lens(sample.film, concentric_disc(lens)), time)
            } else {
                (through(sample), time)
            }
        };
        samples.iter().map(draw).unzip()
    }

    /// What the rays of samples meet, each at its time.
    fn hits(&self, rays: &[Ray], times: &[f64]) -> Vec<Option<Hit>> {
        let mut hits = vec![None; rays.len()];
        if self.world.moves() {
            self.world.closest_hits_at(rays, times, Interval::POSITIVE, &mut hits);
        } else {
            self.world.closest_hits(rays, Interval::POSITIVE, &mut hits);
        }
        hits
    }

    /// What the eye sees surfaces emit in the sample's pixel: the mean over so many points of it.
    ///
    /// The points of all samples of the pixel together are one sequence.
    fn emission(&self, sample: &Sample, counts: &mut RayCounts) -> Rgb {
        let corner = DVec2::from(sample.pixel.map(f64::from));
        let points = sample.along(OWN_NUMBERS);
        let samples: [Sample; RAYS as usize] = std::array::from_fn(|k| {
            let index = sample.index.wrapping_mul(RAYS).wrapping_add(k as u32);
            let [x, y, ..] = Sample { index, ..points }.numbers(0);
            Sample { index, film: corner + DVec2::new(x, y), ..points }
        });
        let (rays, times) = self.rays(&samples);
        let hits = self.hits(&rays, &times);
        counts.outline += u64::from(RAYS);
        let emitted = |((sample, ray), hit): ((&Sample, &Ray), Option<Hit>)| {
            let world = of_sample(self.world, sample);
            let emitted = |hit| world.scene().emitted(&world.surface_at(ray, &hit), -ray.direction);
            hit.map_or(Rgb::ZERO, emitted)
        };
        let all = samples.iter().zip(&rays).zip(hits);
        all.map(emitted).sum::<Rgb>() / f64::from(RAYS)
    }
}

/// Beside 0 and 1, the mirror and the refracted ray.
const OWN_NUMBERS: u32 = 2;

impl<F> Estimator<RayCounts> for Eye<'_, F>
where
    F: Fn(&Ray, Option<Hit>, Option<Rgb>, &Sample, &mut RayCounts) -> Rgb + Sync,
{
    fn radiance(&self, samples: &[Sample], radiance: &mut [Rgb], counts: &mut RayCounts) {
        let (rays, times) = self.rays(samples);
        let hits = self.hits(&rays, &times);
        for (((ray, hit), sample), radiance) in rays.iter().zip(hits).zip(samples).zip(radiance) {
            let outlines = self.outlines.as_ref();
            let crossed = outlines.is_some_and(|outlines| outlines.cross_pixel(sample.pixel));
            let emission = crossed.then(|| self.emission(sample, counts));
            *radiance = (self.shade)(ray, hit, emission, sample, counts);
        }
    }
}
