//! What `f64` decides.

use glam::DVec3;
use lancer_core::geometry::{
    Axis, Interval, Ray, Real, Shear, intersect_triangles, solve_triangle,
};
use lancer_core::intersector::{Hit, Probe};
use smallvec::SmallVec;

use super::Wide;
use super::lanes::{Lanes, difference};
use super::packet::RAYS;

/// A ray that `f64` decides on, triangle by triangle: by the formulas of [`intersect_triangles`] in lanes of one
/// number each. Of several numbers the compiler would make vectors, and shuffle longer than it computes.
pub(super) struct Decision<'w, L: Lanes> {
    lanes: L,
    wide: &'w Wide<'w>,
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
        let origin = ones(lanes, ray.origin);
        let shear = Shear::along(Axis::longest(ray.direction), ones(lanes, ray.direction));
        Self { lanes, wide, origin, shear, probe }
    }

    /// Decides on a triangle, by its record, that the ray meets for certain if `is_certain`. Returns whether it is
    /// the closest so far.
    #[inline(always)]
    pub(super) fn test(&mut self, record: u32, is_certain: bool) -> bool {
        let (id, corners) = self.wide.triangle(record);
        if self.probe.best().is_some_and(|best| best.primitive == id) {
            return false;
        }
        let lanes = self.lanes;
        let [a, b, c] = self.wide.corners(corners);
        let [a, b, c] = [ones(lanes, a), ones(lanes, b), ones(lanes, c)];
        let origin = self.origin;
        let corners = [difference(a, origin), difference(b, origin), difference(c, origin)];
        let (t, [u, v, w]) = if is_certain {
            solve_triangle(corners, &self.shear)
        } else {
            let Interval { min, max } = self.probe.range();
            let range = [lanes.one(min), lanes.one(max)];
            match intersect_triangles(corners, &self.shear, range) {
                Some((t, weights, met)) if L::One::bits(met) & 1 != 0 => (t, weights),
                _ => return false,
            }
        };
        let barycentric = [lanes.number(u), lanes.number(v), lanes.number(w)].into();
        self.probe.keep(Hit { t: lanes.number(t), primitive: id, barycentric })
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

/// Rays of which each meets a triangle for certain, by the axis along which they go: `f64` has to say where, of four
/// at once.
pub(super) struct Certain {
    /// A ray's place, and the triangle's record.
    along: [SmallVec<[(u32, u32); RAYS]>; 3],
}

impl Certain {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { along: [SmallVec::new(), SmallVec::new(), SmallVec::new()] }
    }

    /// Adds a ray along an axis, by its place.
    #[inline(always)]
    pub(super) fn push(&mut self, axis: Axis, place: usize, record: u32) {
        self.along[axis as usize].push((place as u32, record));
    }

    /// The hits of all.
    #[inline(always)]
    pub(super) fn solve<L: Lanes>(
        &self,
        lanes: L,
        wide: &Wide,
        rays: &[Ray],
        range: Interval,
        hits: &mut [Option<Hit>],
    ) {
        for (axis, all) in [Axis::X, Axis::Y, Axis::Z].into_iter().zip(&self.along) {
            for some in all.chunks(4) {
                // Of fewer the last one as often as it takes.
                let certain = |k: usize| some[k.min(some.len() - 1)];
                let four = [certain(0), certain(1), certain(2), certain(3)];
                let hits = &mut *hits;
                // Apart, so that it is optimised by itself.
                lanes.apart(
                    #[inline(always)]
                    move |lanes| solve_four(lanes, wide, rays, range, axis, four, hits),
                );
            }
        }
    }
}

/// The hits of four rays along one axis.
#[inline(always)]
fn solve_four<L: Lanes>(
    l: L,
    wide: &Wide,
    rays: &[Ray],
    range: Interval,
    axis: Axis,
    four: [(u32, u32); 4],
    hits: &mut [Option<Hit>],
) {
    let [i, j, k, m] = four.map(|(place, _)| &rays[place as usize]);
    // One by one: what maps an array is not sure to be inlined.
    let triangle = |k: usize| wide.triangle(four[k].1);
    let (of_i, of_j, of_k, of_m) = (triangle(0), triangle(1), triangle(2), triangle(3));
    let ids = [of_i.0, of_j.0, of_k.0, of_m.0];
    let corners = if ids == [ids[0]; 4] {
        let [a, b, c] = wide.corners(of_i.1);
        [l.vectors([a; 4]).0, l.vectors([b; 4]).0, l.vectors([c; 4]).0]
    } else {
        let ([a, b, c], [d, e, f]) = (wide.corners(of_i.1), wide.corners(of_j.1));
        let ([g, h, n], [p, q, r]) = (wide.corners(of_k.1), wide.corners(of_m.1));
        [l.vectors([a, d, g, p]).0, l.vectors([b, e, h, q]).0, l.vectors([c, f, n, r]).0]
    };
    let origin = l.vectors([i.origin, j.origin, k.origin, m.origin]).0;
    let [a, b, c] = corners;
    let corners = [difference(a, origin), difference(b, origin), difference(c, origin)];
    let directions = l.vectors([i.direction, j.direction, k.direction, m.direction]).0;
    let (t, [u, v, w]) = solve_triangle(corners, &Shear::along(axis, directions));
    let (t, u, v, w) = (l.numbers(t), l.numbers(u), l.numbers(v), l.numbers(w));
    for (lane, (place, _)) in four.into_iter().enumerate() {
        let mut probe = Probe::new(wide.scene, &rays[place as usize], range);
        let barycentric = DVec3::new(u[lane], v[lane], w[lane]);
        probe.keep(Hit { t: t[lane], primitive: ids[lane], barycentric });
        hits[place as usize] = probe.best();
    }
}

/// The components of a vector.
#[inline(always)]
fn ones<L: Lanes>(l: L, DVec3 { x, y, z }: DVec3) -> [L::One; 3] {
    [l.one(x), l.one(y), l.one(z)]
}
