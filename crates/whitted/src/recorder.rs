use std::ops::AddAssign;

use lancer_core::Rgb;
use lancer_core::geometry::Ray;
use lancer_core::intersector::Hit;
use lancer_core::world::SurfacePoint;

/// Why a ray is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// From the eye through the picture.
    Primary,
    /// Along R of `eq:reflected-ray`.
    Mirror,
    /// Along T of `eq:descartes`.
    Refracted,
}

/// The arguments of one call of LR: the slide's « origine, direction, profondeur », and what the
/// answer will count in the pixel.
#[derive(Clone, Copy, Debug)]
pub struct Call {
    /// Origin and direction.
    pub ray: Ray,
    /// 0 for a primary ray, one more per bounce.
    pub depth: u32,
    /// The product of the k_s and k_t on the way here, each of its strongest channel: the most that the
    /// answer can count in any channel.
    pub weight: f64,
    /// Why the ray is traced.
    pub kind: RayKind,
}

impl Call {
    /// For a ray from the eye.
    pub fn primary(ray: &Ray) -> Self {
        Self { ray: *ray, depth: 0, weight: 1.0, kind: RayKind::Primary }
    }
}

/// Follows the recursion. The methods do nothing unless they are overridden, so that following costs
/// nothing when nobody does.
pub trait Recorder {
    /// A ray is about to be traced.
    fn enter(&mut self, _call: &Call) {}
    /// A ray is not traced, because the depth or the weight has reached its limit.
    fn cut(&mut self, _call: &Call) {}
    /// The ray has met a surface.
    fn hit(&mut self, _hit: &Hit, _surface: &SurfacePoint) {}
    /// A shadow ray, from the surface to a light at t = 1, has been answered.
    fn shadow(&mut self, _ray: &Ray, _visible: bool) {}
    /// I_local of the surface is known, with the ambient term and the emission.
    fn local(&mut self, _radiance: Rgb) {}
    /// The call returns; also after [`Recorder::cut`].
    fn leave(&mut self, _radiance: Rgb) {}
}

/// Nobody follows.
impl Recorder for () {}

/// The rays that were traced, by kind: the deterministic cost of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the eye.
    pub primary: u64,
    /// Along mirror directions.
    pub mirror: u64,
    /// Along refracted directions.
    pub refracted: u64,
    /// Towards lights.
    pub shadow: u64,
}

impl RayCounts {
    /// All rays.
    pub fn total(&self) -> u64 {
        self.primary + self.mirror + self.refracted + self.shadow
    }

    /// The count of the rays that are traced for that reason.
    pub fn count_mut(&mut self, kind: RayKind) -> &mut u64 {
        match kind {
            RayKind::Primary => &mut self.primary,
            RayKind::Mirror => &mut self.mirror,
            RayKind::Refracted => &mut self.refracted,
        }
    }
}

impl Recorder for RayCounts {
    fn enter(&mut self, call: &Call) {
        *self.count_mut(call.kind) += 1;
    }

    fn shadow(&mut self, _ray: &Ray, _visible: bool) {
        self.shadow += 1;
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.primary += other.primary;
        self.mirror += other.mirror;
        self.refracted += other.refracted;
        self.shadow += other.shadow;
    }
}
