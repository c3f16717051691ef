use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::intersector::Hit;
use lancer_core::lanes::FourLanes;
use lancer_core::with_lanes;
use lancer_core::world::World;

use crate::lighting::{Lighting, Lit};
use crate::recorder::{Call, Recorder};

/// The method of Appel (1968): what the eye sees and which lights see it too.
///
/// - *Follows* primary rays, and from what they meet a shadow ray to each light that would add something.
/// - *Wins* where surfaces are matte: visibility without sorting, exact shadows of points, and a cost known
///   beforehand, at most 1 + lights rays per sample.
/// - *Loses* mirrors, glass, penumbrae (an area light is a point) and the light between surfaces.
/// - *Sources*: Appel, *Some Techniques for Shading Machine Renderings of Solids*, AFIPS SJCC 1968; slides
///   « Élimination des parties cachées », « Modèle Local ».
#[derive(Clone)]
pub struct Appel<'a> {
    lighting: Lighting<'a>,
}

impl<'a> Appel<'a> {
    /// Prepares the method for a world.
    pub fn new(world: World<'a>) -> Self {
        Self { lighting: Lighting::new(world) }
    }

    /// The radiance that comes back along a primary ray of unit direction.
    pub fn trace<R: Recorder>(&self, ray: &Ray, recorder: &mut R) -> Rgb {
        let mut radiance = [Rgb::ZERO];
        self.trace_all(&[*ray], &mut radiance, recorder);
        radiance[0]
    }

    /// The same for many rays, each radiance in its ray's place: all of them are asked together, and all their shadow
    /// rays.
    ///
    /// # Panics
    /// If the slices are not of one length.
    pub fn trace_all<R: Recorder>(&self, rays: &[Ray], radiance: &mut [Rgb], recorder: &mut R) {
        assert_eq!(rays.len(), radiance.len(), "one answer for each ray");
        let World { scene, index } = self.lighting.world;
        rays.iter().for_each(|ray| recorder.enter(&Call::primary(ray)));
        let mut hits = vec![None; rays.len()];
        index.closest_hits(rays, Interval::POSITIVE, &mut hits);
        let mut lit = Lit::with_capacity(rays.len());
        let met = (rays, &*hits);
        with_lanes!(self.lighting.kernel(), self.surfaces(met, &mut lit, &mut *recorder));
        self.lighting.answer(&mut lit, recorder);
        radiance.fill(scene.background);
        for (&k, &local) in lit.of.iter().zip(&lit.local) {
            recorder.local(local);
            radiance[k] = local;
        }
        radiance.iter().for_each(|&radiance| recorder.leave(radiance));
    }

    #[inline(always)]
    fn surfaces<L: FourLanes, R: Recorder>(
        &self,
        lanes: L,
        met: (&[Ray], &[Option<Hit>]),
        lit: &mut Lit,
        recorder: &mut R,
    ) {
        self.lighting.surfaces(
            lanes,
            met,
            lit,
            recorder,
            #[inline(always)]
            |_, _| (),
        );
    }
}
