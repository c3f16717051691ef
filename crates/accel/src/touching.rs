//! Which cells a primitive belongs to.

use glam::DVec3;
use lancer_core::geometry::{Bounds3, Sphere};
use lancer_core::scene::{PrimitiveId, Scene, Shape};
use smallvec::SmallVec;

use crate::margins::ROUNDING;

/// Whether two closed boxes have a point in common.
pub(crate) fn overlap(a: Bounds3, b: Bounds3) -> bool {
    (a.min.cmple(b.max) & b.min.cmple(a.max)).all()
}

/// A primitive on its way into cells: tells which boxes its surface comes near.
///
/// The boxes around a slanted triangle and around a sphere hold many cells that the surface does not
/// touch: the test keeps them free of it.
#[expect(clippy::large_enum_variant, reason = "lives on the stack, one at a time")]
pub(crate) enum Footprint {
    Triangle([Projection; 10]),
    Sphere(Sphere, f64),
}

/// The interval of a·p over a grown triangle.
#[derive(Clone, Copy)]
pub(crate) struct Projection {
    a: DVec3,
    low: f64,
    high: f64,
}

impl Projection {
    /// Growing a box by the slack grows its interval by slack · (|a_x| + |a_y| + |a_z|).
    fn new(a: DVec3, corners: [DVec3; 3], slack: f64) -> Self {
        let [p, q, r] = corners.map(|corner| a.dot(corner));
        let wider = slack * a.abs().element_sum();
        Self { a, low: p.min(q).min(r) - wider, high: p.max(q).max(r) + wider }
    }

    /// Whether this direction shows a gap between triangle and box. A NaN shows none.
    #[inline]
    fn separates(&self, center: DVec3, half: DVec3) -> bool {
        let middle = self.a.dot(center);
        let reach = self.a.abs().dot(half);
        middle - reach > self.high || middle + reach < self.low
    }
}

impl Footprint {
    /// The surface of a primitive, grown by the slack.
    pub(crate) fn new(scene: &Scene, primitive: PrimitiveId, slack: f64) -> Self {
        let index = match scene.shape(primitive) {
            Shape::Triangle(index) => index,
            Shape::Sphere(index) => return Self::Sphere(scene.spheres[index].shape, slack),
        };
        let corners = scene.mesh.corners(index);
        let [a, b, c] = corners;
        let edges = [b - a, c - b, a - c];
        let normal = edges[0].cross(edges[1]);
        let mut projections = [Projection::new(normal, corners, slack); 10];
        for (k, edge) in edges.into_iter().enumerate() {
            for (axis, unit) in DVec3::AXES.into_iter().enumerate() {
                projections[1 + 3 * k + axis] = Projection::new(edge.cross(unit), corners, slack);
            }
        }
        Self::Triangle(projections)
    }

    /// Whether the surface comes near a box that its own bounds overlap.
    ///
    /// Two convex bodies are disjoint if and only if they leave a gap along a normal of a face of one, or
    /// along a product of an edge of each; the box's own normals are the comparison of the bounds. Source:
    /// Akenine-Möller, *Fast 3D Triangle-Box Overlap Testing*, JGT 6(1), 2001.
    pub(crate) fn touches(&self, cell: Bounds3) -> bool {
        let (center, half) = (cell.center(), 0.5 * (cell.max - cell.min));
        match self {
            Self::Triangle(projections) => !projections.iter().any(|p| p.separates(center, half)),
            Self::Sphere(sphere, slack) => {
                let away = (sphere.center - center).abs();
                let nearest = (away - half).max(DVec3::ZERO).length();
                let farthest = (away + half).length();
                // Along the diagonal a box grows by √3 of what its faces move.
                let (slack, rounding) = (2.0 * slack, ROUNDING * farthest);
                nearest <= sphere.radius + slack + rounding
                    && farthest >= sphere.radius - slack - rounding
            }
        }
    }
}

/// Some points of a primitive's surface, for validation: a triangle's corners, a sphere's poles.
pub(crate) fn surface_points(scene: &Scene, primitive: PrimitiveId) -> SmallVec<[DVec3; 10]> {
    match scene.shape(primitive) {
        Shape::Triangle(index) => {
            let [a, b, c] = scene.mesh.corners(index);
            let weights = (0..=3).flat_map(|i| (0..=3 - i).map(move |j| (i, j)));
            let at = |(i, j)| a + (b - a) * (f64::from(i) / 3.0) + (c - a) * (f64::from(j) / 3.0);
            weights.map(at).collect()
        }
        Shape::Sphere(index) => {
            let Sphere { center, radius } = scene.spheres[index].shape;
            DVec3::AXES.iter().flat_map(|&k| [center - radius * k, center + radius * k]).collect()
        }
    }
}
