//! Splits of space: a primitive may be on both sides, each with the part of its box that is needed there.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DVec3, Vec3A};
use lancer_core::scene::{Scene, Shape};

use super::cuts::{BINS, Content, Parts};
use super::grow::halve;
use super::item::Item;
use crate::four_boxes::{Frame, FrameBox};

/// Splits primitives by planes across the axes, where their boxes overlap.
///
/// Boxes that contain much but the primitive, such as those of long diagonal triangles, overlap wherever
/// primitives are divided. There a plane divides space: what reaches across it becomes two items, with a box
/// around its part on each side.
///
/// Source: Stich, Friedrich and Dietrich, *Spatial Splits in Bounding Volume Hierarchies*, HPG 2009.
pub(super) struct Splitter<'s> {
    scene: &'s Scene,
    frame: Frame,
    /// Parts whose boxes overlap by less are not worth the search for a better plane.
    least_overlap: f32,
    crowded: AtomicUsize,
}

/// The overlap, as a share of the root's area, from which space is split; of less nothing is gained.
const LEAST_OVERLAP: f32 = 1e-3;

/// And as a share of the node's length along every axis. Next to a cut through a surface boxes overlap by a triangle's
/// width: a split would gain no more than that.
const LEAST_WIDTH: f32 = 1.0 / 8.0;

/// An edge that spans less along an axis is not cut across it: see [`Splitter::halves`].
const LEAST_SPAN: f64 = 1.0 / (1 << 24) as f64;

/// Planes at equal distances across each axis.
#[derive(Clone, Copy)]
struct Slices {
    start: Vec3A,
    width: Vec3A,
    per_unit: Vec3A,
}

impl Slices {
    fn of(bounds: FrameBox) -> Self {
        let extent = bounds.max - bounds.min;
        let per_unit = Vec3A::splat(BINS as f32) / extent.max(Vec3A::splat(f32::MIN_POSITIVE));
        Self { start: bounds.min, width: extent / BINS as f32, per_unit }
    }

    /// The slice of a point on each axis.
    #[inline(always)]
    fn at(&self, p: Vec3A) -> [usize; 3] {
        let place = ((p - self.start) * self.per_unit).max(Vec3A::ZERO);
        place.min(Vec3A::splat(BINS as f32 - 1.0)).to_array().map(|x| usize::from(x as u8))
    }

    /// The first and the last slice of a box on each axis. By its margin it does not reach into a slice.
    #[inline(always)]
    fn span(&self, bounds: FrameBox) -> [[usize; 3]; 2] {
        let half = 0.5 * (bounds.max - bounds.min);
        let margin = half.min(Vec3A::splat(2.0 * f32::EPSILON));
        [self.at(bounds.min + margin), self.at(bounds.max - margin)]
    }

    /// The plane before a slice.
    #[inline(always)]
    fn plane(&self, axis: usize, slice: usize) -> f32 {
        self.start[axis] + self.width[axis] * slice as f32
    }

    /// Adds the parts of a triangle, as far as they lie in its box, to the slices from the first to the last that it
    /// reaches: between two planes lie its corners there, and the points where the longest edge along the axis and one
    /// of the others cross the planes.
    #[inline(always)]
    fn add<const AXIS: usize>(
        &self,
        corners: [Vec3A; 3],
        whole: FrameBox,
        [first, last]: [usize; 2],
        slices: &mut [Slice; BINS],
    ) {
        let [mut low, mut middle, mut high] = corners;
        let sort = |a: &mut Vec3A, b: &mut Vec3A| {
            if a[AXIS] > b[AXIS] {
                std::mem::swap(a, b);
            }
        };
        sort(&mut low, &mut middle);
        sort(&mut middle, &mut high);
        sort(&mut low, &mut middle);
        let slope =
            |from: Vec3A, to: Vec3A| (to - from) / (to[AXIS] - from[AXIS]).max(f32::MIN_POSITIVE);
        let (longest, rise, fall) = (slope(low, high), slope(low, middle), slope(middle, high));
        let hull = |a: Vec3A, b: Vec3A| FrameBox { min: a.min(b), max: a.max(b) };
        let point = |p: Vec3A| FrameBox { min: p, max: p };
        let mut before = point(low);
        let mut is_before_middle = true;
        for (k, slice) in slices.iter_mut().enumerate().take(last + 1).skip(first) {
            let mut part = before;
            if k == last {
                part = part.union(point(high));
            } else {
                let x = self.plane(AXIS, k + 1).clamp(low[AXIS], high[AXIS]);
                let other = if x < middle[AXIS] {
                    low + rise * (x - low[AXIS])
                } else {
                    middle + fall * (x - middle[AXIS])
                };
                before = hull(low + longest * (x - low[AXIS]), other);
                part = part.union(before);
            }
            if is_before_middle && (k == last || before.max[AXIS] >= middle[AXIS]) {
                part = part.union(point(middle));
                is_before_middle = false;
            }
            slice.bounds = slice.bounds.union(part.intersection(whole));
        }
        slices[first].begin += 1;
        slices[last].end += 1;
    }
}

/// What lies in a slice, and how many items begin and end there.
#[derive(Clone, Copy)]
struct Slice {
    bounds: FrameBox,
    begin: u32,
    end: u32,
}

impl Slice {
    const NONE: Self = Self { bounds: FrameBox::EMPTY, begin: 0, end: 0 };

    /// Adds an item that reaches into no other slice.
    #[inline(always)]
    fn add(&mut self, whole: FrameBox) {
        self.bounds = self.bounds.union(whole);
        self.begin += 1;
        self.end += 1;
    }
}

/// A plane across an axis, after a slice, and what is on its sides.
struct Plane {
    slices: Slices,
    axis: usize,
    last: usize,
    parts: Parts,
}

impl<'s> Splitter<'s> {
    /// What splits the primitives of a scene whose root has these bounds.
    pub(super) fn new(scene: &'s Scene, frame: Frame, root: FrameBox) -> Self {
        let least_overlap = LEAST_OVERLAP * root.half_area();
        Self { scene, frame, least_overlap, crowded: AtomicUsize::new(0) }
    }

    /// How many items the nodes had whose parts overlap.
    pub(super) fn crowded(self) -> usize {
        self.crowded.into_inner()
    }

    /// Divides the first `count` items by a plane, if the `parts` of the best cut between primitives overlap and
    /// there is a plane that is better, for which the room has free places.
    pub(super) fn divide(
        &self,
        room: &mut [Item],
        count: usize,
        bounds: FrameBox,
        parts: &Parts,
    ) -> Option<[Content; 2]> {
        let overlap = parts.left.bounds.intersection(parts.right.bounds);
        let side = overlap.max - overlap.min;
        let least_side = LEAST_WIDTH * (bounds.max - bounds.min);
        if side.cmplt(least_side).any() || overlap.half_area() < self.least_overlap {
            return None;
        }
        self.crowded.fetch_add(count, Ordering::Relaxed);
        if room.len() == count {
            return None;
        }
        let plane = self.best_plane(&room[..count], room.len(), bounds)?;
        (plane.parts.cost < parts.cost).then(|| self.partition(room, count, &plane))
    }

    /// The cheapest plane with fewer items on each side than on both, and places for all.
    #[inline(never)] // The slices must not take room on the stack of the recursion.
    fn best_plane(&self, items: &[Item], places: usize, bounds: FrameBox) -> Option<Plane> {
        let slices = Slices::of(bounds);
        let mut all = [[Slice::NONE; BINS]; 3];
        for item in items {
            let whole = item.bounds();
            let [first, last] = slices.span(whole);
            let corners = if first == last { None } else { self.corners(item) };
            let Some(corners) = corners else {
                // What is not split belongs where its middle is.
                let middle = if first == last { first } else { slices.at(0.5 * item.center()) };
                for (slices, middle) in all.iter_mut().zip(middle) {
                    slices[middle].add(whole);
                }
                continue;
            };
            let span = |axis: usize| [first[axis], last[axis]];
            if first[0] == last[0] {
                all[0][first[0]].add(whole);
            } else {
                slices.add::<0>(corners, whole, span(0), &mut all[0]);
            }
            if first[1] == last[1] {
                all[1][first[1]].add(whole);
            } else {
                slices.add::<1>(corners, whole, span(1), &mut all[1]);
            }
            if first[2] == last[2] {
                all[2][first[2]].add(whole);
            } else {
                slices.add::<2>(corners, whole, span(2), &mut all[2]);
            }
        }
        let mut best: Option<Plane> = None;
        for (axis, all) in all.iter().enumerate() {
            let mut rights = [Content::NONE; BINS];
            for k in (1..BINS).rev() {
                let here = Content { bounds: all[k].bounds, count: all[k].end };
                rights[k - 1] = rights[k].and(here);
            }
            let mut left = Content::NONE;
            for last in 0..BINS - 1 {
                left = left.and(Content { bounds: all[last].bounds, count: all[last].begin });
                let parts = Parts::new(left, rights[last]);
                let counts = [left.count, rights[last].count].map(|count| count as usize);
                let divides = counts.iter().all(|count| (1..items.len()).contains(count));
                if divides
                    && counts[0] + counts[1] <= places
                    && best.as_ref().is_none_or(|best| parts.cost < best.parts.cost)
                {
                    best = Some(Plane { slices, axis, last, parts });
                }
            }
        }
        best
    }

    /// The corners of a triangle; spheres are not split.
    fn corners(&self, item: &Item) -> Option<[Vec3A; 3]> {
        match self.scene.shape(item.primitive()) {
            Shape::Triangle(index) => {
                Some(self.scene.mesh.corners(index).map(|p| self.frame.point(p).as_vec3a()))
            }
            Shape::Sphere(_) => None,
        }
    }

    /// Puts what is left of a plane first. What reaches across it is split.
    fn partition(&self, room: &mut [Item], count: usize, plane: &Plane) -> [Content; 2] {
        let &Plane { slices, axis, last: before, .. } = plane;
        let at = slices.plane(axis, before + 1);
        let mut parts = [Content::NONE; 2];
        let (mut lefts, mut all) = (0, count);
        for k in 0..count {
            let item = room[k];
            let whole = item.bounds();
            let [first, last] = slices.span(whole).map(|slices| slices[axis]);
            let halves = if last <= before {
                [Some(whole), None]
            } else if first > before {
                [None, Some(whole)]
            } else if let Some(halves) =
                self.halves(&item, axis, at).filter(|halves| halves.iter().any(Option::is_some))
            {
                halves
            } else if slices.at(0.5 * item.center())[axis] <= before {
                [Some(whole), None]
            } else {
                [None, Some(whole)]
            };
            for (part, half) in parts.iter_mut().zip(halves) {
                if let Some(bounds) = half {
                    *part = part.and(Content { bounds, count: 1 });
                }
            }
            let [on_left, on_right] = halves;
            if let Some(bounds) = on_left {
                room[k] = item.with(bounds);
                room.swap(lefts, k);
                lefts += 1;
            }
            if let Some(bounds) = on_right {
                let place = if on_left.is_some() { all } else { k };
                room[place] = item.with(bounds);
                all += usize::from(on_left.is_some());
            }
        }
        // Rounding may leave nothing on one side.
        if lefts == 0 || lefts == all { halve(&mut room[..all]) } else { parts }
    }

    /// Boxes around the parts of a triangle on both sides of a plane, as far as they lie in the item's box.
    ///
    /// What lies on the plane is in both, and each is grown by the margin by which all boxes are, since a ray may
    /// be met beside the triangle by its rounding. An edge is cut at a point that is off by
    /// 2⁻⁵¹ times its length over its span along the axis: less than a quarter of that margin, 2⁻²³, as long as
    /// the span is more than 2⁻²⁴ of the frame. Shorter ones count whole on both sides.
    ///
    /// So a ray that meets the triangle meets the box of the part where it does, up to the margin, and `f64` finds the
    /// same t as in a tree of whole primitives. Only where a ray runs so nearly in the triangle's plane that t is off by
    /// more than a box's margin may `f64` put the hit in front of that part, as it may put it in front of the whole box:
    /// then the part is visited, unless something else is met in between.
    ///
    /// There are none of a sphere, which is not split.
    fn halves(&self, item: &Item, axis: usize, plane: f32) -> Option<[Option<FrameBox>; 2]> {
        let Shape::Triangle(index) = self.scene.shape(item.primitive()) else { return None };
        let corners = self.scene.mesh.corners(index).map(|p| self.frame.point(p));
        let plane = f64::from(plane);
        let mut halves = [(DVec3::INFINITY, DVec3::NEG_INFINITY); 2];
        let mut add = |side: usize, p: DVec3| {
            let (min, max) = &mut halves[side];
            (*min, *max) = (min.min(p), max.max(p));
        };
        for k in 0..3 {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            let (x, y) = (from[axis], to[axis]);
            if x <= plane {
                add(0, from);
            }
            if x >= plane {
                add(1, from);
            }
            if (x < plane) == (y < plane) && (x > plane) == (y > plane) {
                continue;
            }
            if (x - y).abs() < LEAST_SPAN {
                for side in 0..2 {
                    add(side, from);
                    add(side, to);
                }
                continue;
            }
            let mut cut = from + (to - from) * ((plane - x) / (y - x));
            cut[axis] = plane;
            add(0, cut);
            add(1, cut);
        }
        Some(halves.map(|(min, max)| {
            let half = FrameBox::around(min, max).intersection(item.bounds());
            half.min.cmple(half.max).all().then_some(half)
        }))
    }
}

#[cfg(test)]
mod tests {
    use lancer_core::geometry::Bounds3;
    use lancer_core::scene::PrimitiveId;

    use super::*;
    use crate::hard_sets::triangles;

    fn splitter(scene: &Scene) -> Splitter<'_> {
        let frame = Frame::of(Bounds3 { min: DVec3::NEG_ONE, max: DVec3::ONE });
        Splitter::new(scene, frame, frame.outwards(scene.bounds()))
    }

    fn item(splitter: &Splitter) -> Item {
        let id = PrimitiveId(0);
        Item::new(splitter.frame.outwards(splitter.scene.primitive_bounds(id)), id)
    }

    /// By hand: the diagonal from (−1, −1) to (1, 1), as a thin triangle, at x = 1/2.
    #[test]
    fn the_parts_of_a_diagonal_lie_in_its_corners() {
        let [low, high] = [DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)];
        let scene = triangles([[low, high, high]]);
        let splitter = splitter(&scene);
        let [left, right] = splitter.halves(&item(&splitter), 0, 0.5).unwrap().map(Option::unwrap);
        let near = |a: Vec3A, b: DVec3| (a.as_dvec3() - b).abs().max_element() < 1e-6;
        let middle = DVec3::new(0.5, 0.5, 0.0);
        assert!(near(left.min, low) && near(left.max, middle), "{left:?}");
        assert!(near(right.min, middle) && near(right.max, high), "{right:?}");
        // Both have the margin beyond the plane.
        assert!(left.max.x > 0.5 && right.min.x < 0.5);
    }

    /// An edge that lies nearly in the plane counts whole: where it crosses it is not known.
    #[test]
    fn an_edge_along_the_plane_is_not_cut() {
        let lies = 0.25 * LEAST_SPAN;
        let scene = triangles([[
            DVec3::new(0.5 - lies, -1.0, 0.0),
            DVec3::new(0.5 + lies, 1.0, 0.0),
            DVec3::new(0.5 + lies, 0.0, 1.0),
        ]]);
        let splitter = splitter(&scene);
        let whole = item(&splitter).bounds();
        for half in splitter.halves(&item(&splitter), 0, 0.5).unwrap() {
            assert_eq!((half.unwrap().min.y, half.unwrap().max.y), (whole.min.y, whole.max.y));
        }
    }
}
