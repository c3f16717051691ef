//! What rays meet while the shutter is open.
//!
//! Everything that moves keeps its direction, so that a ray meets it at the time t where the ray, shifted against its
//! way, meets it at rest. That is exact, and what moves alike has an index like any other over a subset of the scene's
//! primitives: no index knows of time, and a ray has none, which would cost where nothing moves.
//!
//! A ray asks one index more for each group whose box it meets. That is little where groups keep to themselves, and
//! much where they fill the same space.

use std::ops::Range;

use glam::DVec3;

use crate::geometry::{Bounds3, Interval, Ray, Slabs};
use crate::illumination::Reflectance;
use crate::intersector::{Hit, Intersector, Observer, Query, Wanted};
use crate::method::BuildIndex;
use crate::scene::{PrimitiveId, Scene};
use crate::world::{SurfacePoint, World};

/// Indexes of a scene whose parts move: one of what stands still, and one of each group that moves alike.
pub struct Moving<'s> {
    scene: &'s Scene,
    still: Box<dyn Intersector + 's>,
    groups: Vec<Group<'s>>,
    /// The ids that move, in order, each range with the number of its group.
    ranges: Vec<(Range<u32>, usize)>,
}

/// What moves alike.
struct Group<'s> {
    /// From the shutter's opening to its closing.
    displacement: DVec3,
    /// Around all of it where the scene has it, with room for rounding.
    bounds: Bounds3,
    index: Box<dyn Intersector + 's>,
}

/// By what part of its largest coordinate a group's box is larger than the group.
const ROOM: f64 = 1e-9;

impl<'s> Moving<'s> {
    /// Builds the indexes. Where nothing moves there is one, over all primitives.
    ///
    /// # Panics
    /// If a motion of the scene names what the scene has not, or what another names.
    pub fn new(scene: &'s Scene, build: &BuildIndex) -> Self {
        let (mut groups, mut ranges) = (Vec::new(), Vec::<(Range<u32>, usize)>::new());
        for (displacement, primitives) in scene.moving() {
            for PrimitiveId(id) in primitives.iter() {
                match ranges.last_mut() {
                    Some((range, group)) if *group == groups.len() && range.end == id => {
                        range.end += 1;
                    }
                    _ => ranges.push((id..id + 1, groups.len())),
                }
            }
            let bounds = primitives.bounds();
            let bounds = bounds.grown(ROOM * bounds.reach());
            groups.push(Group { displacement, bounds, index: build(primitives) });
        }
        ranges.sort_unstable_by_key(|(range, _)| range.start);
        let is_apart = |pair: &[(Range<u32>, usize)]| pair[0].0.end <= pair[1].0.start;
        assert!(ranges.windows(2).all(is_apart), "a primitive moves in two ways");
        Self { scene, still: build(scene.still()), groups, ranges }
    }
}

impl Group<'_> {
    /// Where the group is at a time, from where the scene has it.
    #[inline]
    fn shift(&self, time: f64) -> DVec3 {
        time * self.displacement
    }

    /// Whether a ray that is shifted against the group's way may meet it.
    #[inline]
    fn may_meet(&self, ray: &Ray, range: Interval) -> bool {
        Slabs::new(ray).enter(self.bounds.min, self.bounds.max, range).is_some()
    }

    /// The better of two hits, one of them the answer of this group: the nearer, of equals that with the smaller id.
    #[inline]
    fn compete(
        &self,
        time: f64,
        query: Query<&Ray>,
        best: Option<Hit>,
        ask: impl FnOnce(&dyn Intersector, Query<&Ray>) -> Option<Hit>,
    ) -> Option<Hit> {
        let ray = &query.ray.shifted(-self.shift(time));
        // Equals must come, or the smaller id could not win.
        let max = best.map_or(query.range.max, |best| best.t.next_up());
        let range = Interval { max, ..query.range };
        if !self.may_meet(ray, range) {
            return best;
        }
        let hit = ask(&*self.index, Query { ray, range, ..query });
        hit.filter(|hit| best.is_none_or(|best| hit.is_before(&best))).or(best)
    }
}

/// A world at one time while the shutter is open: an [`Intersector`] of everything where it is then, and what a hit tells
/// about the surface there.
///
/// ```text
/// eq:shutter              x(t) = x(0) + t v,   0 ≤ t ≤ 1
///                         o + s D meets what moves  where  o − t v + s D meets it at rest
/// ```
///
/// v is [`Motion::displacement`](crate::scene::Motion::displacement), o and D are a ray's origin and direction.
///
/// Source: Cook, Porter, Carpenter, *Distributed Ray Tracing*, SIGGRAPH 1984, « motion blur ».
#[doc(alias = "eq:shutter")]
#[doc(alias = "flou de bougé")]
#[derive(Clone, Copy)]
pub struct Moment<'m> {
    scene: &'m Scene,
    still: &'m dyn Intersector,
    /// `None` if nothing moves.
    moving: Option<&'m Moving<'m>>,
    time: f64,
}

/// The opening of the shutter on a world in which nothing moves.
impl<'m> From<World<'m>> for Moment<'m> {
    fn from(World { scene, index }: World<'m>) -> Self {
        Self { scene, still: index, moving: None, time: 0.0 }
    }
}

/// The opening of the shutter.
impl<'m> From<&'m Moving<'_>> for Moment<'m> {
    fn from(moving: &'m Moving<'_>) -> Self {
        let moves = !moving.groups.is_empty();
        let (scene, still) = (moving.scene, &*moving.still);
        Self { scene, still, moving: moves.then_some(moving), time: 0.0 }
    }
}

impl<'m> Moment<'m> {
    /// The same world at another time, from 0, when the shutter opens, to 1, when it closes.
    #[inline]
    #[must_use]
    pub fn at(self, time: f64) -> Self {
        debug_assert!((0.0..=1.0).contains(&time), "{time}");
        Self { time, ..self }
    }

    /// Whether anything moves.
    #[inline]
    pub fn moves(&self) -> bool {
        self.moving.is_some()
    }

    /// The scene as the shutter opens.
    #[inline]
    pub fn scene(&self) -> &'m Scene {
        self.scene
    }

    /// How far a primitive is from where the scene has it; `None` if it stands still.
    #[inline]
    pub fn shift(&self, primitive: PrimitiveId) -> Option<DVec3> {
        let Moving { groups, ranges, .. } = self.moving?;
        let after = ranges.partition_point(|(range, _)| range.start <= primitive.0);
        let (range, group) = ranges.get(after.checked_sub(1)?)?;
        range.contains(&primitive.0).then(|| groups[*group].shift(self.time))
    }

    /// The surface at a hit of `ray`, where it is at this time.
    #[inline]
    pub fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        match self.shift(hit.primitive) {
            None => self.scene.surface_at(ray, hit),
            Some(shift) => self.scene.surface_at(&ray.shifted(-shift), hit).shifted(shift),
        }
    }

    /// The constants of `eq:local` at the surface of a hit: a checker moves with what it is on.
    #[inline]
    pub fn reflectance(&self, hit: &Hit, surface: &SurfacePoint) -> Reflectance {
        match self.shift(hit.primitive) {
            None => self.scene.reflectance(surface),
            Some(shift) => self.scene.reflectance(&surface.shifted(-shift)),
        }
    }

    /// The first primitives that many rays meet in `range`, each at its own time.
    ///
    /// # Panics
    /// If the slices are not of one length.
    pub fn closest_hits_at(
        &self,
        rays: &[Ray],
        times: &[f64],
        range: Interval,
        hits: &mut [Option<Hit>],
    ) {
        assert_eq!(rays.len(), times.len(), "one time for each ray");
        self.still.closest_hits(rays, range, hits);
        if self.moves() {
            for ((ray, &time), hit) in rays.iter().zip(times).zip(hits) {
                *hit = self.at(time).closest_with(Query::closest(ray, range), *hit);
            }
        }
    }

    /// The closest hit of all, if that of what stands still is known.
    #[inline]
    fn closest_with(&self, query: Query<&Ray>, still: Option<Hit>) -> Option<Hit> {
        self.groups().iter().fold(still, |best, group| {
            group.compete(self.time, query, best, |index, query| {
                index.closest_hit(query.ray, query.range)
            })
        })
    }

    #[inline]
    fn groups(&self) -> &[Group<'m>] {
        self.moving.map_or(&[], |moving| &moving.groups)
    }
}

impl Intersector for Moment<'_> {
    #[inline]
    fn closest_hit(&self, ray: &Ray, range: Interval) -> Option<Hit> {
        self.closest_with(Query::closest(ray, range), self.still.closest_hit(ray, range))
    }

    fn closest_hits(&self, rays: &[Ray], range: Interval, hits: &mut [Option<Hit>]) {
        self.still.closest_hits(rays, range, hits);
        if self.moves() {
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = self.closest_with(Query::closest(ray, range), *hit);
            }
        }
    }

    #[inline]
    fn occluded(&self, ray: &Ray, range: Interval) -> bool {
        let is_in_the_way = |group: &Group| {
            let ray = ray.shifted(-group.shift(self.time));
            group.may_meet(&ray, range) && group.index.occluded(&ray, range)
        };
        self.still.occluded(ray, range) || self.groups().iter().any(is_in_the_way)
    }

    /// The observer is told of the groups' boxes and cells as they are where the scene has them.
    fn watch(&self, query: Query<&Ray>, observer: &mut dyn Observer) -> Option<Hit> {
        let mut best = self.still.watch(query, observer);
        for group in self.groups() {
            if query.wanted == Wanted::Any && best.is_some() {
                break;
            }
            best =
                group.compete(self.time, query, best, |index, query| index.watch(query, observer));
        }
        best
    }
}
