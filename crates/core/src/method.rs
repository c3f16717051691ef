//! A method of the course as a value: what it is called, what it takes notice of, and how it draws.
//!
//! The command line and the figures ask any method for a picture by an [`Order`], and get an [`Outcome`]. A
//! method's value stands in its own crate, or, if it needs the rays of another, in its chapter's package.

use std::fmt;
use std::ops::AddAssign;

use crate::image::{Image, ImageSize};
use crate::intersector::Intersector;
use crate::render::{Cancelled, Control, Estimator, Film, render_adaptive, render_pixels};
use crate::sampling::PixelSampling;
use crate::scene::{Scene, Subset};

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
    /// [`Order::adaptive`].
    Adaptive,
    /// [`Order::max_depth`].
    MaxDepth,
    /// [`Order::index`], where the choice changes more than the time.
    Index,
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
}

impl Effect {
    /// Whether a scene has it.
    pub fn is_in(self, scene: &Scene) -> bool {
        let any = |has: fn(&crate::scene::Material) -> bool| scene.materials.iter().any(has);
        match self {
            Self::Mirrors => any(|material| material.k_s != crate::Rgb::ZERO),
            Self::Glass => any(|material| material.k_t != crate::Rgb::ZERO),
            Self::AreaLights => scene.has_area_light(),
        }
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mirrors => "mirrors (k_s)",
            Self::Glass => "glass (k_t)",
            Self::AreaLights => "the size of lamps (they count as points)",
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
            by_products: &[],
            control: Control::default(),
        }
    }

    /// Samples the picture as the order says: the whole of a method that works pixel by pixel, whose one
    /// by-product is [`SAMPLES`].
    ///
    /// # Errors
    /// If it is cancelled.
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
            let by_products = self.by_products.iter().map(|&name| (name, film.samples())).collect();
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
    use super::*;

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

    const WORK_KINDS: [WorkKind; 3] = [WorkKind::Rays, WorkKind::Tests, WorkKind::SetOperations];
}
