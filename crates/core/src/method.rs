//! A method of the course as a value: what it is called, what it takes notice of, and how it draws.
//!
//! The command line and the figures ask any method for a picture by an [`Order`], and get an [`Outcome`]. A
//! method's value stands in its own crate, or, if it needs the rays of another, in its chapter's package.

use std::fmt;
use std::ops::AddAssign;

use crate::Rgb;
use crate::image::{Image, ImageSize};
use crate::intersector::Intersector;
use crate::render::{Cancelled, Control, Estimator, Film, render_adaptive, render_pixels};
use crate::sampling::PixelSampling;
use crate::scene::{Motion, Scene, Subset};

/// A way to draw scenes.
pub struct Method {
    /// Its name on the command line, which is the name of its colour too.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// The settings of an [`Order`] that it takes notice of.
    pub uses: &'static [Setting],
    /// What a scene may have and the method leaves out.
    pub ignores: &'static [Effect],
    /// What it can tell beside the picture.
    pub by_products: &'static [ByProduct],
    /// Draws. The order asks for by-products of this list only.
    ///
    /// # Errors
    /// If it is cancelled.
    pub render: fn(&Order<'_>) -> Result<Outcome, Cancelled>,
}

/// A setting that not every method has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// [`Order::sampling`]: the number and the seed of a pixel's samples.
    Sampling,
    /// What a sample has beside its film point, [`Sample::numbers`](crate::sampling::Sample::numbers): with another
    /// seed one sample in a pixel's centre is another, too.
    Numbers,
    /// [`Order::adaptive`].
    Adaptive,
    /// [`Order::max_depth`].
    MaxDepth,
    /// [`Order::branching`].
    Branching,
    /// [`Order::strategy`].
    Strategy,
    /// [`Order::index`], where the choice changes more than the time.
    Index,
    /// [`Order::index`] as beams ask it, which not every kind of index can answer.
    Beams,
}

/// Which rays go on from a surface that both reflects and refracts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branching {
    /// The mirror ray and the refracted ray.
    Both,
    /// One of the two, at random: its answer counts for what it had of the chances.
    One,
}

impl Branching {
    /// All of them, each with its name on the command line.
    pub const ALL: [(&'static str, Self); 2] = [("both", Self::Both), ("one", Self::One)];
}

/// How the light of lamps is found that a surface sends to the eye. All find the same light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strategy {
    /// By rays to points drawn on lamps.
    Lamp,
    /// By rays in directions drawn from what the surface reflects, if they meet a lamp.
    Lobe,
    /// By both, weighted by [`power_heuristic`](crate::sampling::power_heuristic).
    Mis,
}

impl Strategy {
    /// All of them, each with its name on the command line.
    pub const ALL: [(&'static str, Self); 3] =
        [("lamp", Self::Lamp), ("lobe", Self::Lobe), ("mis", Self::Mis)];
}

/// What makes a scene harder to draw than matte surfaces lit by points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// A surface that reflects, k_s ≠ 0.
    Mirrors,
    /// A surface that lets light pass, k_t ≠ 0.
    Glass,
    /// A lamp that has a size, and so a penumbra.
    AreaLights,
    /// A rough surface that reflects or lets light pass, and spreads it.
    Gloss,
    /// A lens, which has one plane in focus.
    Lens,
    /// Something that moves while the shutter is open.
    Motion,
    /// The ambient constant.
    Ambient,
}

impl Effect {
    /// Whether a scene has it.
    pub fn is_in(self, scene: &Scene) -> bool {
        let of_faces = scene.mesh.faces.iter().map(|face| face.material);
        let mut used = of_faces.chain(scene.spheres.iter().map(|sphere| sphere.material));
        match self {
            Self::Mirrors => used.any(|id| scene.material(id).k_s != Rgb::ZERO),
            Self::Glass => used.any(|id| scene.material(id).k_t != Rgb::ZERO),
            Self::AreaLights => {
                !(scene.area_lights().is_empty() && scene.sphere_lights().is_empty())
            }
            Self::Gloss => used.any(|id| scene.material(id).is_glossy()),
            Self::Lens => scene.camera.lens.is_some_and(|lens| lens.radius > 0.0),
            Self::Motion => scene.motions.iter().any(Motion::is_seen),
            Self::Ambient => scene.ambient != Rgb::ZERO,
        }
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mirrors => "mirrors (k_s)",
            Self::Glass => "glass (k_t)",
            Self::AreaLights => "the size of lamps (they count as points)",
            Self::Gloss => "gloss (mirrors and glass count as smooth)",
            Self::Lens => "the lens (all is in focus)",
            Self::Motion => "motion (all is where it is as the shutter opens)",
            Self::Ambient => "the ambient constant (the light that it stands for is followed)",
        })
    }
}

/// A second picture that comes with the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ByProduct {
    /// Its name on the command line.
    pub name: &'static str,
    /// What its pixels say.
    pub about: &'static str,
}

/// How many samples are in each pixel.
pub const SAMPLES: ByProduct =
    ByProduct { name: "samples", about: "how many samples are in each pixel" };

/// Builds an index over some primitives of a scene, or over all.
pub type BuildIndex<'a> = dyn for<'s> Fn(Subset<'s>) -> Box<dyn Intersector + 's> + 'a;

/// A picture that is asked for.
#[derive(Clone, Copy)]
pub struct Order<'a> {
    /// What there is.
    pub scene: &'a Scene,
    /// Builds an index of the kind that is asked for.
    pub index: &'a BuildIndex<'a>,
    /// Width and height.
    pub size: ImageSize,
    /// The samples of each pixel.
    pub sampling: PixelSampling,
    /// The contrast above which pixels get all of their samples, as in [`render_adaptive`]; `None` is everywhere.
    pub adaptive: Option<f64>,
    /// The largest number of bounces between the eye and a surface; `None` is the method's own choice.
    pub max_depth: Option<u32>,
    /// Which rays go on where there are two; `None` is the method's own choice.
    pub branching: Option<Branching>,
    /// How the light of lamps is found; `None` is the method's own choice.
    pub strategy: Option<Strategy>,
    /// Names of by-products, of which the method has all.
    pub by_products: &'a [&'static str],
    /// How it is run.
    pub control: Control<'a>,
}

impl<'a> Order<'a> {
    /// A picture of one sample in the centre of each pixel, and nothing special.
    pub fn new(scene: &'a Scene, index: &'a BuildIndex<'a>, size: ImageSize) -> Self {
        Self {
            scene,
            index,
            size,
            sampling: PixelSampling::CENTER,
            adaptive: None,
            max_depth: None,
            branching: None,
            strategy: None,
            by_products: &[],
            control: Control::default(),
        }
    }

    /// Samples the picture as the order says: the whole of a method that works pixel by pixel, whose one
    /// by-product is [`SAMPLES`].
    ///
    /// # Errors
    /// If it is cancelled.
    ///
    /// # Panics
    /// If the order asks for another by-product: a method's list names those that it has.
    pub fn sample<C: AddAssign + Default + Send + Into<Work>>(
        &self,
        estimator: impl Estimator<C>,
    ) -> Result<Outcome, Cancelled> {
        let Self { size, sampling, control, .. } = *self;
        let (rendering, by_products) = if self.adaptive.is_none() && self.by_products.is_empty() {
            (render_pixels(size, sampling, control, estimator)?, Vec::new())
        } else {
            let film = match self.adaptive {
                Some(contrast) => render_adaptive(size, sampling, contrast, control, estimator)?,
                None => {
                    let mut film = Film::new(size, control.tile);
                    film.sample(sampling, control, &estimator)?;
                    film
                }
            };
            let by_product = |&name: &&'static str| {
                assert_eq!(name, SAMPLES.name, "a by-product that the method has");
                (name, film.samples())
            };
            let by_products = self.by_products.iter().map(by_product).collect();
            (film.finish(), by_products)
        };
        Ok(Outcome { image: rendering.image, work: rendering.counts.into(), by_products })
    }
}

/// A picture, and what it took.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The picture.
    pub image: Image,
    /// The work, the same on every machine.
    pub work: Work,
    /// The by-products that the order names, in its order.
    pub by_products: Vec<(&'static str, Image)>,
}

/// A kind of work: only counts of one kind add up to something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorkKind {
    /// Rays that are traced.
    Rays,
    /// Volumes and primitives that are tested.
    Tests,
    /// Polygons that are cut, joined or taken away.
    SetOperations,
}

impl fmt::Display for WorkKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rays => "rays",
            Self::Tests => "tests",
            Self::SetOperations => "set operations",
        })
    }
}

/// Named counts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Each with its kind and name.
    pub counts: Vec<(WorkKind, &'static str, u64)>,
}

impl Work {
    /// The sum of all counts of a kind.
    pub fn total(&self, kind: WorkKind) -> u64 {
        self.counts.iter().filter(|(known, ..)| *known == kind).map(|(.., count)| count).sum()
    }
}

impl fmt::Display for Work {
    /// `12 rays: 8 primary, 4 shadow; 7 tests: 7 boxes`: kinds in the order in which they first come.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut kinds: Vec<WorkKind> = Vec::new();
        for (kind, ..) in &self.counts {
            if !kinds.contains(kind) {
                kinds.push(*kind);
            }
        }
        for (k, kind) in kinds.into_iter().enumerate() {
            let own = self.counts.iter().filter(|(known, ..)| *known == kind);
            let own: Vec<String> = own.map(|(_, name, count)| format!("{count} {name}")).collect();
            let separator = if k == 0 { "" } else { "; " };
            write!(f, "{separator}{} {kind}: {}", self.total(kind), own.join(", "))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::ops::Range;

    use glam::DVec3;

    use super::*;
    use crate::generate::icosphere;
    use crate::geometry::Sphere;
    use crate::intersector::LinearScan;
    use crate::sampling::{Pattern, Sample};
    use crate::scene::{Lens, Material, MaterialId, Part, SphereObject};

    #[test]
    fn only_counts_of_one_kind_are_added() {
        let counts = vec![
            (WorkKind::Rays, "primary", 8),
            (WorkKind::SetOperations, "inserted", 3),
            (WorkKind::Rays, "shadow", 4),
        ];
        let work = Work { counts };
        assert_eq!(WORK_KINDS.map(|kind| work.total(kind)), [12, 0, 3]);
        assert_eq!(work.to_string(), "12 rays: 8 primary, 4 shadow; 3 set operations: 3 inserted");
    }

    /// With a film and without, of one sample and of several: the same picture.
    #[test]
    fn a_by_product_does_not_change_the_picture() {
        #[derive(Default)]
        struct Count(u64);
        impl AddAssign for Count {
            fn add_assign(&mut self, other: Self) {
                self.0 += other.0;
            }
        }
        impl From<Count> for Work {
            fn from(count: Count) -> Self {
                Self { counts: vec![(WorkKind::Tests, "samples", count.0)] }
            }
        }
        let estimator = |sample: &Sample, count: &mut Count| {
            count.0 += 1;
            Rgb::splat((sample.film.x * 0.7).sin() * sample.film.y)
        };
        let scene = Scene::of_mesh(icosphere(0));
        let order = Order::new(
            &scene,
            &|primitives| Box::new(LinearScan::new(primitives)),
            ImageSize::new(19, 7),
        );
        let several = PixelSampling { pattern: Pattern::Owen, samples: 5, seed: 2 };
        for sampling in [PixelSampling::CENTER, several] {
            for adaptive in [None, Some(0.2)] {
                let order = Order { sampling, adaptive, ..order };
                let alone = order.sample(estimator).unwrap();
                let beside =
                    Order { by_products: &["samples"], ..order }.sample(estimator).unwrap();
                assert!(alone.image == beside.image && alone.work == beside.work);
                let [(name, samples)] = &beside.by_products[..] else { panic!("one by-product") };
                let most = samples.pixels().iter().map(|pixel| pixel[0]).fold(0.0, f32::max);
                assert_eq!((*name, most), ("samples", sampling.samples as f32));
            }
        }
    }

    /// Each effect is told when something that is used has it.
    #[test]
    fn effects_are_found() {
        let plain = Scene::of_mesh(icosphere(0));
        let all = [
            Effect::Mirrors,
            Effect::Glass,
            Effect::AreaLights,
            Effect::Gloss,
            Effect::Lens,
            Effect::Motion,
        ];
        let found = |change: &dyn Fn(&mut Scene)| {
            let mut scene = plain.clone();
            change(&mut scene);
            all.into_iter().filter(|effect| effect.is_in(&scene)).collect::<Vec<_>>()
        };
        let ball = |material| SphereObject {
            shape: Sphere { center: DVec3::ZERO, radius: 1.0 },
            material: MaterialId(material),
        };
        let lens = |radius| Some(Lens { radius, focus: 1.0 });
        let lamp = Material { emission: Rgb::ONE, ..Material::matte(Rgb::ZERO) };
        assert_eq!(found(&|_| ()), []);
        assert_eq!(found(&|scene| scene.materials[0].gloss = Some(9.0)), []);
        let rough = found(&|scene| {
            (scene.materials[0].gloss, scene.materials[0].k_t) = (Some(9.0), Rgb::ONE);
        });
        assert_eq!(rough, [Effect::Glass, Effect::Gloss]);
        assert_eq!(found(&|scene| scene.materials.push(lamp)), []);
        let lit = found(&|scene| {
            scene.materials.push(lamp);
            scene.spheres.push(ball(1));
        });
        assert_eq!(lit, [Effect::AreaLights]);
        assert_eq!(found(&|scene| scene.camera.lens = lens(0.0)), []);
        assert_eq!(found(&|scene| scene.camera.lens = lens(0.1)), [Effect::Lens]);
        let moved = |displacement, spheres: Range<usize>| {
            found(&|scene| {
                scene.spheres.push(ball(0));
                let parts = vec![Part::Spheres(spheres.clone())];
                scene.motions.push(Motion { displacement, parts });
            })
        };
        assert_eq!(moved(DVec3::X, 0..1), [Effect::Motion]);
        assert_eq!((moved(DVec3::X, 0..0), moved(DVec3::ZERO, 0..1)), (vec![], vec![]));
    }

    const WORK_KINDS: [WorkKind; 3] = [WorkKind::Rays, WorkKind::Tests, WorkKind::SetOperations];
}
