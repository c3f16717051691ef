use lancer_core::geometry::{Interval, Ray};
use lancer_core::intersector::{Hit, Intersector};
use lancer_core::scene::Scene;
use lancer_core::world::{PointSource, SurfacePoint};
use lancer_whitted::{Call, RayKind};

use super::Subject;

/// A scene whose shapes are met by a subject's own functions, for the exercises that need all of them.
pub struct Stage<'a> {
    /// What stands on it.
    pub scene: &'a Scene,
    /// Its lamps.
    pub lamps: Vec<PointSource>,
    /// Max_Prof: the largest number of bounces between the eye and a surface.
    pub max_depth: u32,
    subject: Subject,
}

impl<'a> Stage<'a> {
    /// A stage on which `subject` intersects.
    pub fn new(scene: &'a Scene, max_depth: u32, subject: Subject) -> Self {
        Self { scene, lamps: scene.point_sources(), max_depth, subject }
    }

    /// The surface that a ray meets first.
    pub fn surface(&self, ray: &Ray) -> Option<SurfacePoint> {
        let hit = self.closest_hit(ray, Interval::POSITIVE)?;
        Some(self.scene.surface_at(ray, &hit))
    }

    /// vis(i): whether a shadow ray reaches its lamp, at t = 1.
    pub fn is_lit(&self, shadow_ray: &Ray) -> bool {
        !self.occluded(shadow_ray, Interval::up_to(1.0))
    }

    fn hits<'s>(&'s self, ray: &'s Ray, range: Interval) -> impl Iterator<Item = Hit> + 's {
        let triangles = self.scene.mesh.triangles.len();
        self.scene.primitives().filter_map(move |primitive| {
            let index = primitive.0 as usize;
            let (t, barycentric) = match index.checked_sub(triangles) {
                None => (self.subject.ray_triangle)(self.scene.mesh.corners(index), ray)?,
                Some(index) => {
                    let sphere = &self.scene.spheres[index].shape;
                    ((self.subject.ray_sphere)(sphere, ray)?, glam::DVec3::ZERO)
                }
            };
            let counts = t > range.min && t < range.max;
            counts.then_some(Hit { t, primitive, barycentric })
        })
    }
}

impl Intersector for Stage<'_> {
    fn closest_hit(&self, ray: &Ray, range: Interval) -> Option<Hit> {
        self.hits(ray, range).min_by(|a, b| a.t.total_cmp(&b.t))
    }

    fn occluded(&self, ray: &Ray, range: Interval) -> bool {
        self.hits(ray, range).next().is_some()
    }
}

/// One call of LR in the tree of a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Why the ray is traced.
    pub kind: RayKind,
    /// Bounces before it.
    pub depth: u32,
    /// The product of the k_s and k_t before it, each of its strongest channel.
    pub weight: f64,
    /// Whether it was traced: not beyond Max_Prof.
    pub traced: bool,
    /// Shadow rays cast where it met a surface.
    pub shadows: u32,
    /// The calls that it made: the refracted ray first, then the mirror ray.
    pub children: Vec<Node>,
}

impl Node {
    /// A call that has made no other and traced nothing.
    pub fn untraced(call: &Call) -> Self {
        let Call { kind, depth, weight, .. } = *call;
        Self { kind, depth, weight, traced: false, shadows: 0, children: Vec::new() }
    }
}
