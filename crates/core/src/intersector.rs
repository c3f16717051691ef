//! The open traits of the course: what answers what a ray, or a beam, meets.
//!
//! Chapter 4 swaps the answerers; all of them must agree with [`LinearScan`] bit for bit.

use std::ops::AddAssign;

use glam::DVec3;

use crate::geometry::{Bounds3, ConvexVolume, Interval, Ray, Shear, intersect_triangle};
use crate::scene::{PrimitiveId, Scene, Shape, Subset};

/// The closest primitive that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray parameter.
    pub t: f64,
    /// What is met.
    pub primitive: PrimitiveId,
    /// Weights of a triangle's corners; zero on a sphere, which has none.
    pub barycentric: DVec3,
}

impl Hit {
    /// Whether it answers rather than `other` what one ray meets: it is nearer, or of equals has the smaller id.
    #[inline]
    pub fn is_before(&self, other: &Self) -> bool {
        self.t < other.t || self.t == other.t && self.primitive < other.primitive
    }
}

/// Which hit answers a [`Query`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// The closest.
    Closest,
    /// Any: the search ends with the one met first.
    Any,
}

/// What an index is asked: whether and where a ray meets something.
///
/// An index is asked about a [`Ray`] that somebody else holds: one copied on the way would be read again before it has
/// been written, for which the processor waits. Where queries are kept they hold their rays themselves.
#[derive(Clone, Copy, Debug)]
pub struct Query<R> {
    /// The ray, or a reference to it.
    pub ray: R,
    /// Where it looks.
    pub range: Interval,
    /// What answers it.
    pub wanted: Wanted,
}

impl<R> Query<R> {
    /// Asks for the closest hit.
    #[inline]
    pub const fn closest(ray: R, range: Interval) -> Self {
        Self { ray, range, wanted: Wanted::Closest }
    }

    /// Asks for any hit.
    #[inline]
    pub const fn any(ray: R, range: Interval) -> Self {
        Self { ray, range, wanted: Wanted::Any }
    }
}

impl Query<&Ray> {
    /// Asks an index whether there is such a hit.
    #[inline]
    pub fn hits(self, index: &dyn Intersector) -> bool {
        match self.wanted {
            Wanted::Closest => index.closest_hit(self.ray, self.range).is_some(),
            Wanted::Any => index.occluded(self.ray, self.range),
        }
    }
}

impl Query<Ray> {
    /// The same query by a reference to its ray.
    #[inline]
    pub const fn as_ref(&self) -> Query<&Ray> {
        Query { ray: &self.ray, range: self.range, wanted: self.wanted }
    }
}

/// An index of a scene's primitives.
///
/// An answer does not depend on the index: the smallest [`PrimitiveId`] is the hit where several primitives
/// have the same `t`.
pub trait Intersector: Sync {
    /// The first primitive that the ray meets in `range`.
    fn closest_hit(&self, ray: &Ray, range: Interval) -> Option<Hit>;

    /// The first primitives that many rays meet in `range`: the answers of [`Intersector::closest_hit`], each
    /// in its ray's place. Some indexes are faster if neighbours in the slice start in one point and go the
    /// same way.
    ///
    /// # Panics
    /// If the slices are not of one length.
    fn closest_hits(&self, rays: &[Ray], range: Interval, hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one answer for each ray");
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest_hit(ray, range);
        }
    }

    /// Whether the ray meets anything in `range`.
    fn occluded(&self, ray: &Ray, range: Interval) -> bool;

    /// Whether many rays meet anything in `range`: the answers of [`Intersector::occluded`], each in its ray's place.
    ///
    /// # Panics
    /// If the slices are not of one length.
    fn occluded_all(&self, rays: &[Ray], range: Interval, occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "one answer for each ray");
        for (ray, occluded) in rays.iter().zip(occluded) {
            *occluded = self.occluded(ray, range);
        }
    }

    /// Answers as [`Intersector::closest_hit`] or, if any hit will do, as [`Intersector::occluded`] with the
    /// hit met first, and tells the observer its work.
    fn watch(&self, query: Query<&Ray>, observer: &mut dyn Observer) -> Option<Hit>;

    /// The same index as beams ask it, if they can.
    fn beams(&self) -> Option<&dyn BeamIndex> {
        None
    }
}

/// An index whose every question is one traversal. It is an [`Intersector`].
pub trait Traversal: Sync {
    /// Visits primitives that the ray may meet in its range until none can be nearer than the closest met
    /// or, if any hit will do, one is met. Returns the closest.
    fn walk<O: Observer>(&self, query: Query<&Ray>, observer: &mut O) -> Option<Hit>;

    /// What [`Intersector::beams`] says.
    fn beams(&self) -> Option<&dyn BeamIndex> {
        None
    }
}

impl<T: Traversal> Intersector for T {
    fn closest_hit(&self, ray: &Ray, range: Interval) -> Option<Hit> {
        self.walk(Query::closest(ray, range), &mut ())
    }

    fn occluded(&self, ray: &Ray, range: Interval) -> bool {
        self.walk(Query::any(ray, range), &mut ()).is_some()
    }

    fn watch(&self, query: Query<&Ray>, mut observer: &mut dyn Observer) -> Option<Hit> {
        self.walk(query, &mut observer)
    }

    fn beams(&self) -> Option<&dyn BeamIndex> {
        Traversal::beams(self)
    }
}

/// An [`Intersector`] that also finds what a beam may meet.
pub trait BeamIndex: Intersector {
    /// Visits the primitives whose surfaces meet the volume at a depth up to `far`, near first. The
    /// visitor returns the new bound, once it knows what hides the rest; larger ones count as the old.
    ///
    /// Primitives beside the volume may come, and one may come twice; none is missed. Near first means
    /// by [`Scene::depth_in`], as far as the index has boxes around whole primitives: one of cells, or of
    /// boxes around parts, may bring a primitive later, with the cell or box in which it meets the volume, but not
    /// behind its own end.
    fn visit_beam(
        &self,
        volume: &ConvexVolume,
        far: f64,
        visit: &mut dyn FnMut(PrimitiveId) -> f64,
    );

    /// The same, watched.
    fn watch_beam(
        &self,
        volume: &ConvexVolume,
        far: f64,
        observer: &mut dyn Observer,
        visit: &mut dyn FnMut(PrimitiveId) -> f64,
    );
}

/// A [`Traversal`] for beams: a type that has it is a [`BeamIndex`].
pub trait BeamTraversal: Intersector {
    /// Does what [`BeamIndex::visit_beam`] says.
    fn walk_beam<O: Observer>(
        &self,
        volume: &ConvexVolume,
        far: f64,
        observer: &mut O,
        visit: impl FnMut(PrimitiveId) -> f64,
    );
}

impl<T: BeamTraversal> BeamIndex for T {
    fn visit_beam(
        &self,
        volume: &ConvexVolume,
        far: f64,
        visit: &mut dyn FnMut(PrimitiveId) -> f64,
    ) {
        self.walk_beam(volume, far, &mut (), visit);
    }

    fn watch_beam(
        &self,
        volume: &ConvexVolume,
        far: f64,
        mut observer: &mut dyn Observer,
        visit: &mut dyn FnMut(PrimitiveId) -> f64,
    ) {
        self.walk_beam(volume, far, &mut observer, visit);
    }
}

/// Watches a traversal. The methods do nothing unless they are overridden, so watching costs nothing
/// when nobody does.
pub trait Observer {
    /// A bounding volume is tested.
    fn box_test(&mut self) {}
    /// A cell of a spatial subdivision is visited: of a grid, or a node of a tree that splits space.
    fn cell_visit(&mut self) {}
    /// A primitive is tested.
    fn primitive_test(&mut self, _primitive: PrimitiveId) {}
    /// Where the bounding volume or cell is that is told next; of a cell that is no box, around the ray's
    /// way through it. Worked out only for who asks.
    fn region(&mut self, _bounds: &dyn Fn() -> Bounds3) {}
}

/// Nobody watches.
impl Observer for () {}

impl Observer for &mut dyn Observer {
    fn box_test(&mut self) {
        (**self).box_test();
    }

    fn cell_visit(&mut self) {
        (**self).cell_visit();
    }

    fn primitive_test(&mut self, primitive: PrimitiveId) {
        (**self).primitive_test(primitive);
    }

    fn region(&mut self, bounds: &dyn Fn() -> Bounds3) {
        (**self).region(bounds);
    }
}

/// The work of traversals, the same on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TestCounts {
    /// Bounding volumes tested.
    pub boxes: u64,
    /// Cells of a spatial subdivision visited.
    pub cells: u64,
    /// Primitives tested.
    pub primitives: u64,
}

impl AddAssign for TestCounts {
    fn add_assign(&mut self, other: Self) {
        self.boxes += other.boxes;
        self.cells += other.cells;
        self.primitives += other.primitives;
    }
}

impl Observer for TestCounts {
    fn box_test(&mut self) {
        self.boxes += 1;
    }

    fn cell_visit(&mut self) {
        self.cells += 1;
    }

    fn primitive_test(&mut self, _primitive: PrimitiveId) {
        self.primitives += 1;
    }
}

/// A ray on its way through an index: the primitive tests, and the closest hit so far.
///
/// Indexes decide through it, so that the rule which hit wins stands once; `Wide`, where it asks several
/// primitives at once, takes the first of equals.
#[derive(Clone, Copy, Debug)]
pub struct Probe<'s> {
    scene: &'s Scene,
    ray: &'s Ray,
    range: Interval,
    /// Prepared when the first triangle is tested: many rays meet none.
    shear: Option<Shear>,
    best: Option<Hit>,
}

impl<'s> Probe<'s> {
    /// A ray that has met nothing yet.
    #[inline]
    pub fn new(scene: &'s Scene, ray: &'s Ray, range: Interval) -> Self {
        Self { scene, ray, range, shear: None, best: None }
    }

    /// Tests one primitive and keeps it if it wins. Returns whether it does.
    #[inline(always)]
    pub fn test(&mut self, primitive: PrimitiveId) -> bool {
        match self.scene.shape(primitive) {
            Shape::Triangle(index) => self.test_triangle(primitive, self.scene.mesh.corners(index)),
            Shape::Sphere(index) => {
                // The sphere's own range test would hide ties at the far end.
                let range = Interval { min: self.range.min, max: f64::INFINITY };
                let t = self.scene.spheres[index].shape.intersect(self.ray, range);
                t.is_some_and(|t| self.keep(Hit { t, primitive, barycentric: DVec3::ZERO }))
            }
        }
    }

    #[inline(always)]
    fn test_triangle(&mut self, primitive: PrimitiveId, corners: [DVec3; 3]) -> bool {
        let shear = self.shear.get_or_insert_with(|| Shear::new(self.ray.direction));
        intersect_triangle(corners, self.ray, shear)
            .is_some_and(|hit| self.keep(Hit { t: hit.t, primitive, barycentric: hit.barycentric }))
    }

    /// Keeps a hit that the ray is known to have if it lies in the range, and wins. Returns whether it does.
    #[inline(always)]
    pub fn keep(&mut self, hit: Hit) -> bool {
        let Hit { t, primitive, .. } = hit;
        let wins = t < self.range.max
            || self.best.is_some_and(|best| t == best.t && primitive < best.primitive);
        if t > self.range.min && wins {
            self.range.max = t;
            self.best = Some(hit);
            return true;
        }
        false
    }

    /// The interval in which a hit still counts: it ends at the closest one so far.
    #[inline]
    pub fn range(&self) -> Interval {
        self.range
    }

    /// The closest hit so far.
    #[inline]
    pub fn best(&self) -> Option<Hit> {
        self.best
    }
}

/// Brute force: every primitive for every ray. The oracle of all other indexes.
///
/// *Built* from nothing, *walked* in the order of the ids. *Wins* by being right at sight, and on a handful of
/// primitives. *Loses* everywhere else: a ray costs O(n).
#[derive(Clone, Debug)]
pub struct LinearScan<'s>(Subset<'s>);

impl<'s> LinearScan<'s> {
    /// There is nothing to build: the primitives are tested in order.
    pub fn new(primitives: impl Into<Subset<'s>>) -> Self {
        Self(primitives.into())
    }

    /// Bytes held by the index, without the scene it borrows: nothing over all primitives.
    pub fn memory(&self) -> usize {
        self.0.memory()
    }
}

impl Traversal for LinearScan<'_> {
    /// Visits the primitives in order until any hit will do.
    #[inline]
    fn walk<O: Observer>(&self, query: Query<&Ray>, observer: &mut O) -> Option<Hit> {
        let mut probe = Probe::new(self.0.scene(), query.ray, query.range);
        for primitive in self.0.iter() {
            observer.primitive_test(primitive);
            if probe.test(primitive) && query.wanted == Wanted::Any {
                break;
            }
        }
        probe.best()
    }

    fn beams(&self) -> Option<&dyn BeamIndex> {
        Some(self)
    }
}

impl BeamTraversal for LinearScan<'_> {
    /// Tests all primitives, then visits those that are left in order of depth and id.
    fn walk_beam<O: Observer>(
        &self,
        volume: &ConvexVolume,
        mut far: f64,
        observer: &mut O,
        mut visit: impl FnMut(PrimitiveId) -> f64,
    ) {
        let depth = |primitive| {
            observer.primitive_test(primitive);
            Some((self.0.scene().depth_in(volume, primitive)?, primitive))
        };
        let mut met: Vec<(f64, PrimitiveId)> = self.0.iter().filter_map(depth).collect();
        met.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (depth, primitive) in met {
            if depth > far {
                break;
            }
            far = far.min(visit(primitive));
        }
    }
}
