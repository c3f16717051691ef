use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::Ray;
use lancer_core::intersector::Hit;
use lancer_core::world::SurfacePoint;

use crate::recorder::{Call, Recorder};

/// « Arbre de rayons »: the calls of LR for one primary ray, each with what it met and returned.
///
/// Label `fig:ray-tree`. Record one by passing it to [`Whitted::trace`](crate::Whitted::trace).
#[doc(alias = "fig:ray-tree")]
#[doc(alias = "arbre de rayons")]
#[derive(Clone, Debug, Default)]
pub struct RayTree {
    /// The calls in the order in which they begin; the first is the root.
    pub nodes: Vec<RayNode>,
    open: Vec<usize>,
}

/// One call of LR.
#[derive(Clone, Debug)]
pub struct RayNode {
    /// Index of the call that made this one; `None` for the root.
    pub parent: Option<usize>,
    /// Its arguments.
    pub call: Call,
    /// How it ended.
    pub end: RayEnd,
    /// The shadow rays cast from the surface it met.
    pub shadows: Vec<ShadowRay>,
    /// What it returned.
    pub radiance: Rgb,
}

/// How a call of LR ended.
#[derive(Clone, Copy, Debug)]
pub enum RayEnd {
    /// The ray met nothing.
    Background,
    /// The ray was not traced: depth or weight had reached its limit.
    Cut,
    /// The ray met a surface.
    Surface {
        /// What it met, and where along the ray.
        hit: Hit,
        /// The point.
        position: DVec3,
        /// Emission, ambient term and I_local there.
        local: Rgb,
    },
}

/// A ray from a surface to a light.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRay {
    /// It reaches the light at t = 1.
    pub ray: Ray,
    /// Whether nothing stands between.
    pub visible: bool,
}

impl RayTree {
    /// The number of rays that were traced, without shadow rays.
    pub fn traced(&self) -> usize {
        self.nodes.iter().filter(|node| !matches!(node.end, RayEnd::Cut)).count()
    }

    fn begin(&mut self, call: &Call, end: RayEnd) {
        self.nodes.push(RayNode {
            parent: self.open.last().copied(),
            call: *call,
            end,
            shadows: Vec::new(),
            radiance: Rgb::ZERO,
        });
        self.open.push(self.nodes.len() - 1);
    }

    fn current(&mut self) -> Option<&mut RayNode> {
        self.open.last().map(|&index| &mut self.nodes[index])
    }
}

impl Recorder for RayTree {
    fn enter(&mut self, call: &Call) {
        self.begin(call, RayEnd::Background);
    }

    fn cut(&mut self, call: &Call) {
        self.begin(call, RayEnd::Cut);
    }

    fn hit(&mut self, hit: &Hit, surface: &SurfacePoint) {
        if let Some(node) = self.current() {
            let (hit, position) = (*hit, surface.position);
            node.end = RayEnd::Surface { hit, position, local: Rgb::ZERO };
        }
    }

    fn shadow(&mut self, ray: &Ray, visible: bool) {
        if let Some(node) = self.current() {
            node.shadows.push(ShadowRay { ray: *ray, visible });
        }
    }

    fn local(&mut self, radiance: Rgb) {
        if let Some(RayNode { end: RayEnd::Surface { local, .. }, .. }) = self.current() {
            *local = radiance;
        }
    }

    fn leave(&mut self, radiance: Rgb) {
        if let Some(node) = self.current() {
            node.radiance = radiance;
        }
        self.open.pop();
    }
}
