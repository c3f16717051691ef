//! Which of two trees is walked faster: a few rays try both.

use glam::DVec3;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::intersector::{Intersector, Query, TestCounts};
use lancer_core::sampling::Uniform;
use lancer_core::scene::{PrimitiveId, Scene, Shape, Subset};

use super::Wide;

/// Rays that try a tree.
const RAYS: usize = 1024;
/// What a primitive's test costs in visits of a node: they are tested eight at a time.
const TEST_COST: f64 = 0.25;

/// What a ray costs on average, in visits of nodes: of [`RAYS`] whose seed is fixed, so that the choice is the same
/// every time with one kind of lanes.
///
/// They begin at primitives drawn without regard to their size, since one looks where there is something to see, and
/// go anywhere or to another primitive.
pub(super) fn cost(wide: &Wide, primitives: &Subset) -> f64 {
    let scene = primitives.scene();
    let mut counts = TestCounts::default();
    for k in 0..RAYS {
        let mut random = Uniform::new(14, k as u32, 0);
        let mut draw = || {
            let place = (random.number() * primitives.len() as f64) as usize;
            point(scene, primitives.get(place.min(primitives.len() - 1)), &mut random)
        };
        let (from, to) = (draw(), draw());
        let direction = if k % 2 == 0 { to - from } else { random.direction() };
        wide.watch(Query::closest(&Ray::new(from, direction), Interval::POSITIVE), &mut counts);
    }
    (counts.boxes as f64 / super::WIDTH as f64 + TEST_COST * counts.primitives as f64) / RAYS as f64
}

/// A point of a primitive's surface.
fn point(scene: &Scene, primitive: PrimitiveId, random: &mut Uniform) -> DVec3 {
    match scene.shape(primitive) {
        Shape::Triangle(index) => {
            let [a, b, c] = scene.mesh.corners(index);
            let (mut u, mut v) = (random.number(), random.number());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            a + u * (b - a) + v * (c - a)
        }
        Shape::Sphere(index) => {
            let sphere = scene.spheres[index].shape;
            sphere.center + sphere.radius * random.direction()
        }
    }
}
