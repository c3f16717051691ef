use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::illumination::Reflectance;
use lancer_core::intersector::{Hit, Intersector, Observer, Query, Traversal, Wanted};
use lancer_core::scene::{PointSource, Scene, Shape};
use lancer_core::world::{SurfacePoint, World};
use lancer_exercise::Shown;
use lancer_whitted::{AtLimit, Call, RayKind, RayTree, Settings, Whitted};

use super::Subject;

/// A scene whose shapes are met by a subject's own functions, set up for one primary ray and all that
/// follows from it.
pub struct Stage<'a> {
    /// What stands on it.
    pub scene: &'a Scene,
    /// Its lamps.
    pub lamps: Vec<PointSource>,
    /// Max_Prof: the largest number of bounces between the eye and a surface.
    pub max_depth: u32,
    subject: Subject,
    traced: AtomicU64,
}

impl<'a> Stage<'a> {
    /// A stage on which `subject` intersects.
    pub fn new(scene: &'a Scene, max_depth: u32, subject: Subject) -> Self {
        let lamps = scene.point_sources();
        Self { scene, lamps, max_depth, subject, traced: AtomicU64::new(0) }
    }

    /// The surface that a ray meets first.
    pub fn surface(&self, ray: &Ray) -> Option<SurfacePoint> {
        let hit = self.closest_hit(ray, Interval::POSITIVE)?;
        Some(self.scene.surface_at(ray, &hit))
    }

    /// ρ_d, ρ_s and n at a point of a surface.
    pub fn reflectance(&self, surface: &SurfacePoint) -> Reflectance {
        self.scene.reflectance(surface)
    }

    /// vis(i): whether a shadow ray reaches its lamp, at t = 1.
    pub fn is_lit(&self, shadow_ray: &Ray) -> bool {
        !self.occluded(shadow_ray, Interval::up_to(1.0))
    }

    /// What the course's own LR calls from a call on, with depths and weights counted from it; nothing beyond
    /// Max_Prof.
    pub(super) fn recorded(&self, call: &Call) -> RayTree {
        let mut tree = RayTree::default();
        if let Some(max_depth) = self.max_depth.checked_sub(call.depth) {
            let settings = Settings { max_depth, min_weight: 0.0, at_limit: AtLimit::Black };
            let world = World { scene: self.scene, index: self };
            Whitted::new(world, settings).trace(&call.ray, &mut tree);
        }
        tree
    }

    /// Ends a recursion that does not end, before it fills the stack.
    ///
    /// # Panics
    /// If there have been far more rays than any tree of depth Max_Prof has, 2^(Max_Prof + 1) − 1.
    fn count_traced(&self) {
        let full = (2_u64 << self.max_depth.min(32)) - 1;
        let traced = self.traced.fetch_add(1, Ordering::Relaxed);
        assert!(
            traced < 8 * full,
            "{traced} rays have been traced where Max_Prof = {} allows {full}: is the depth one more in each call?",
            self.max_depth
        );
    }

    fn hits<'s>(&'s self, ray: &'s Ray, range: Interval) -> impl Iterator<Item = Hit> + 's {
        self.scene.primitives().filter_map(move |primitive| {
            let (t, barycentric) = match self.scene.shape(primitive) {
                Shape::Triangle(index) => {
                    let corners = self.scene.mesh.corners(index);
                    let hit = (self.subject.ray_triangle)(corners, ray)?;
                    (!starts_on(corners, ray, hit.0)).then_some(hit)?
                }
                Shape::Sphere(index) => {
                    let sphere = &self.scene.spheres[index].shape;
                    ((self.subject.ray_sphere)(sphere, ray)?, DVec3::ZERO)
                }
            };
            let counts = t > range.min && t < range.max;
            counts.then_some(Hit { t, primitive, barycentric })
        })
    }
}

/// Whether a ray leaves a triangle's plane from it, up to rounding: a t > 0 is noise then. The course's own test
/// knows a bound for each t, which no student is asked for; without any there is acne.
fn starts_on(corners: [DVec3; 3], ray: &Ray, t: f64) -> bool {
    let [a, b, c] = corners;
    let n = (b - a).cross(c - a).normalize_or_zero();
    let reach = corners.map(|corner| (corner - ray.origin).abs().max_element());
    let height = t * n.dot(ray.direction).abs();
    height <= 64.0 * f64::EPSILON * reach.into_iter().fold(0.0, f64::max)
}

impl Traversal for Stage<'_> {
    fn walk<O: Observer>(&self, query: Query<&Ray>, _observer: &mut O) -> Option<Hit> {
        let mut hits = self.hits(query.ray, query.range);
        match query.wanted {
            Wanted::Closest => {
                self.count_traced();
                hits.min_by(|a, b| a.t.total_cmp(&b.t))
            }
            Wanted::Any => hits.next(),
        }
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
    /// Shadow rays cast where it met a surface: one to each lamp in front, N·L > 0, with N on the side that
    /// the ray came from.
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

/// A line for each call, those that it made below it.
impl Shown for Node {
    fn shown(&self) -> String {
        let Self { kind, depth, weight, traced, shadows, children } = self;
        let kind = format!("{kind:?}").to_lowercase();
        let end = if *traced {
            format!("traced, shadow rays: {shadows}")
        } else {
            "cut at Max_Prof".to_owned()
        };
        let mut text = format!("{kind}, depth {depth}, weight {}, {end}", weight.shown());
        for line in children.iter().map(Shown::shown).collect::<Vec<_>>().join("\n").lines() {
            text += &format!("\n  {line}");
        }
        text
    }

    fn distance(&self, other: &Self) -> f64 {
        let exact =
            |node: &Self| (node.kind, node.depth, node.traced, node.shadows, node.children.len());
        if exact(self) != exact(other) {
            return f64::INFINITY;
        }
        let children = self.children.iter().zip(&other.children);
        let children = children.map(|(a, b)| a.distance(b));
        children.fold(self.weight.distance(&other.weight), f64::max)
    }
}
