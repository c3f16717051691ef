//! What `f64` decides.

use glam::DVec3;
use lancer_core::geometry::{Axis, Interval, Ray, Shear, solve_triangle};
use lancer_core::intersector::{Hit, Probe};
use lancer_core::scene::PrimitiveId;

use super::Wide;
use super::lanes::Lanes;

/// A ray that `f64` decides on, triangle by triangle: by the formulas of [`solve_triangle`] in lanes of one number
/// each. Of several numbers the compiler would make vectors, and shuffle longer than it computes.
pub(super) struct Decision<'w, L: Lanes> {
    lanes: L,
    wide: &'w Wide<'w>,
    ray: &'w Ray,
    range: Interval,
    origin: [L::One; 3],
    shear: Shear<L::One>,
    probe: Probe<'w>,
}

impl<'w, L: Lanes> Decision<'w, L> {
    /// A ray that has met nothing yet, or `early`.
    #[inline(always)]
    pub(super) fn new(
        lanes: L,
        wide: &'w Wide,
        ray: &'w Ray,
        range: Interval,
        early: Option<Hit>,
    ) -> Self {
        let mut probe = Probe::new(wide.scene, ray, range);
        if let Some(hit) = early {
            probe.keep(hit);
        }
        let (origin, direction) = (ray.origin, ray.direction);
        let origin = [lanes.one(origin.x), lanes.one(origin.y), lanes.one(origin.z)];
        let along = [lanes.one(direction.x), lanes.one(direction.y), lanes.one(direction.z)];
        let shear = Shear::along(Axis::longest(direction), along);
        Self { lanes, wide, ray, range, origin, shear, probe }
    }

    /// Decides on a triangle, by its record, that the ray meets for certain if `is_certain`. Returns whether it is
    /// the closest so far.
    #[inline(always)]
    pub(super) fn test(&mut self, record: u32, is_certain: bool) -> bool {
        let (id, corners) = self.wide.triangle(record);
        if self.probe.best().is_some_and(|best| best.primitive == id) {
            return false;
        }
        let [a, b, c] = self.wide.corners(corners);
        let corners = [self.relative(a), self.relative(b), self.relative(c)];
        let (t, [u, v, w]) = solve_triangle(corners, &self.shear);
        let lanes = self.lanes;
        let t = lanes.number(t);
        if is_certain {
            let barycentric = [lanes.number(u), lanes.number(v), lanes.number(w)].into();
            return self.probe.keep(Hit { t, primitive: id, barycentric });
        }
        // The plane of a surface that a ray leaves is met outside the range, if only just.
        let Interval { min, max } = self.probe.range();
        if !(t > min && t <= max) {
            return false;
        }
        confirmed(self.wide, self.ray, self.range, id).is_some_and(|hit| self.probe.keep(hit))
    }

    #[inline(always)]
    fn relative(&self, corner: DVec3) -> [L::One; 3] {
        let (lanes, [x, y, z]) = (self.lanes, self.origin);
        [lanes.one(corner.x) - x, lanes.one(corner.y) - y, lanes.one(corner.z) - z]
    }

    /// Where the closest hit is, or the range ends.
    #[inline(always)]
    pub(super) fn end(&self) -> f64 {
        self.probe.range().max
    }

    /// The closest hit.
    #[inline(always)]
    pub(super) fn best(&self) -> Option<Hit> {
        self.probe.best()
    }
}

/// The hit of one primitive, if it has one.
#[inline(never)]
fn confirmed(wide: &Wide, ray: &Ray, range: Interval, primitive: PrimitiveId) -> Option<Hit> {
    let mut probe = Probe::new(wide.scene, ray, range);
    probe.test(primitive);
    probe.best()
}
