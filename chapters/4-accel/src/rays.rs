//! The rays that indexes are compared on: written once for a scene, given to all.

use lancer_core::geometry::{Interval, Ray, leave_surface};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Hit, Intersector, Query, TestCounts, Wanted};
use lancer_core::render::neighbours_together;
use lancer_core::sampling::Uniform;
use lancer_core::scene::{PointLight, Scene};

/// Where rays come from, which says how alike neighbours are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Rays from the eye through the pixels' centres, in the order of rendering: neighbours are alike.
    Primary,
    /// Rays from what those meet to a lamp beside the camera: they end in one point. Any hit will do.
    Shadow,
    /// Rays of one bounce from what the first meet, cosine distributed: neighbours have nothing in common.
    Diffuse,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Primary, Self::Shadow, Self::Diffuse];

    /// Its name in figures and benches.
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Diffuse => "diffuse",
        }
    }

    /// Which hit answers the question.
    pub fn wanted(self) -> Wanted {
        match self {
            Self::Primary | Self::Diffuse => Wanted::Closest,
            Self::Shadow => Wanted::Any,
        }
    }
}

/// All rays of one kind.
pub struct Rays {
    /// Where they come from.
    pub kind: Kind,
    /// The rays.
    pub queries: Vec<Query<Ray>>,
}

impl Rays {
    /// The three kinds of a scene's picture; `index` says what is met.
    pub fn of(scene: &Scene, size: ImageSize, index: &dyn Intersector) -> [Self; 3] {
        let light = PointLight::beside(&scene.camera).position;
        let camera = scene.camera.primary_rays(size);
        let [mut primary, mut shadow, mut diffuse] =
            Kind::ALL.map(|kind| Self { kind, queries: Vec::new() });
        for (x, y) in neighbours_together(size) {
            let ray = camera.through(f64::from(x) + 0.5, f64::from(y) + 0.5);
            primary.queries.push(Query::closest(ray, Interval::POSITIVE));
            let Some(hit) = index.closest_hit(&ray, Interval::POSITIVE) else { continue };
            let point = scene.surface_at(&ray, &hit);
            let facing = -point.geometric_normal.dot(ray.direction).signum();
            let normal = facing * point.geometric_normal;
            let leave = |d| leave_surface(point.position, point.error, normal, d);
            let origin = leave(light - point.position);
            if normal.dot(light - origin) > 0.0 {
                let ray = Ray::new(origin, light - origin);
                shadow.queries.push(Query::any(ray, Interval::up_to(1.0)));
            }
            let direction = normal + Uniform::new(1, x, y).direction();
            let ray = Ray::new(leave(direction), direction);
            diffuse.queries.push(Query::closest(ray, Interval::POSITIVE));
        }
        [primary, shadow, diffuse]
    }

    /// Asks an index everything, and returns how many rays hit.
    pub fn trace(&self, index: &dyn Intersector) -> usize {
        self.queries.iter().filter(|query| query.as_ref().hits(index)).count()
    }

    /// The answers of an index, and its work.
    pub fn watch(&self, index: &dyn Intersector) -> (Vec<Option<Hit>>, TestCounts) {
        let mut counts = TestCounts::default();
        let answer = |query: &Query<Ray>| index.watch(query.as_ref(), &mut counts);
        (self.queries.iter().map(answer).collect(), counts)
    }

    /// Whether two indexes have answered alike: the same hits or, where any will do, a hit to the same rays.
    pub fn agree(&self, a: &[Option<Hit>], b: &[Option<Hit>]) -> bool {
        match self.kind.wanted() {
            Wanted::Closest => a == b,
            Wanted::Any => a.iter().map(Option::is_some).eq(b.iter().map(Option::is_some)),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use lancer_core::scene::PrimitiveId;

    use super::*;

    #[test]
    fn only_shadow_rays_may_be_stopped_by_different_primitives() {
        let hit = |t, id| Some(Hit { t, primitive: PrimitiveId(id), barycentric: DVec3::ZERO });
        for kind in Kind::ALL {
            let rays = Rays { kind, queries: Vec::new() };
            let first = [hit(1.0, 2), None];
            assert!(rays.agree(&first, &first));
            assert!(!rays.agree(&first, &[None, None]));
            assert!(!rays.agree(&first, &first[..1]), "an answer is missing");
            assert_eq!(rays.agree(&first, &[hit(1.0, 3), None]), kind == Kind::Shadow);
            assert_eq!(
                rays.agree(&first, &[hit(1.0_f64.next_up(), 2), None]),
                kind == Kind::Shadow
            );
        }
    }
}
