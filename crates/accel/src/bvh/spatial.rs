//! Splits of space: a primitive may be on both sides, each with the part of its box that is needed there.

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
/// around its part on each side. What is cheaper on one side as a whole stays whole.
///
/// Source: Stich, Friedrich and Dietrich, *Spatial Splits in Bounding Volume Hierarchies*, HPG 2009.
pub(super) struct Splitter<'s> {
    scene: &'s Scene,
    frame: Frame,
    /// Parts whose boxes overlap by less are not worth the search for a better plane.
    least_overlap: f32,
}

/// The overlap, as a share of the root's area, from which space is split. On scans no boxes overlap so much.
const LEAST_OVERLAP: f32 = 1e-5;

/// An edge that spans less along an axis is not cut across it: see [`Splitter::halves`].
const LEAST_SPAN: f64 = 1.0 / (1 << 24) as f64;

/// Planes at equal distances across an axis.
#[derive(Clone, Copy)]
struct Slices {
    axis: usize,
    start: f32,
    width: f32,
    per_unit: f32,
}

impl Slices {
    fn of(bounds: FrameBox, axis: usize) -> Self {
        let extent = bounds.max[axis] - bounds.min[axis];
        let width = extent / BINS as f32;
        Self { axis, start: bounds.min[axis], width, per_unit: BINS as f32 / extent }
    }

    /// The slice of a coordinate.
    #[inline(always)]
    fn at(&self, x: f32) -> usize {
        ((x - self.start) * self.per_unit).clamp(0.0, BINS as f32 - 1.0) as usize
    }

    /// The first and the last slice of an item. By the margin of its box it does not reach into a slice.
    #[inline(always)]
    fn span(&self, bounds: FrameBox) -> [usize; 2] {
        let (low, high) = (bounds.min[self.axis], bounds.max[self.axis]);
        let margin = (2.0 * f32::EPSILON).min(0.5 * (high - low));
        [self.at(low + margin), self.at(high - margin)]
    }

    /// The plane before a slice.
    fn plane(&self, slice: usize) -> f32 {
        self.start + self.width * slice as f32
    }
}

/// A split: the last slice before it.
struct Plane {
    slices: Slices,
    last: usize,
    parts: Parts,
}

impl<'s> Splitter<'s> {
    /// What splits the primitives of a scene whose root has these bounds.
    pub(super) fn new(scene: &'s Scene, frame: Frame, root: FrameBox) -> Self {
        Self { scene, frame, least_overlap: LEAST_OVERLAP * root.half_area() }
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
        if room.len() == count
            || side.min_element() < 0.0
            || overlap.half_area() < self.least_overlap
        {
            return None;
        }
        let plane = self.best_plane(&room[..count], room.len(), bounds)?;
        (plane.parts.cost < parts.cost).then(|| self.partition(room, count, &plane))
    }

    /// The cheapest plane with fewer items on each side than on both, and places for all.
    #[inline(never)] // The slices must not take room on the stack of the recursion.
    fn best_plane(&self, items: &[Item], places: usize, bounds: FrameBox) -> Option<Plane> {
        let mut slices = [Content::NONE; BINS];
        let all = [0, 1, 2].map(|axis| Slices::of(bounds, axis));
        // Per axis what lies in each slice, and how many items begin and end there.
        let mut contents = [[FrameBox::EMPTY; BINS]; 3];
        let (mut begin, mut end) = ([[0_u32; BINS]; 3], [[0_u32; BINS]; 3]);
        for item in items {
            let whole = item.bounds();
            let mut corners = None;
            for axis in 0..3 {
                if all[axis].width <= 0.0 {
                    continue;
                }
                let [first, last] = all[axis].span(whole);
                if first == last {
                    contents[axis][first] = contents[axis][first].union(whole);
                    begin[axis][first] += 1;
                    end[axis][first] += 1;
                    continue;
                }
                let corners = *corners.get_or_insert_with(|| self.corners(item));
                match corners {
                    Some(corners) => {
                        slice(corners, whole, &all[axis], [first, last], &mut contents[axis]);
                        begin[axis][first] += 1;
                        end[axis][last] += 1;
                    }
                    None => {
                        let middle = all[axis].at(0.5 * item.center()[axis]);
                        contents[axis][middle] = contents[axis][middle].union(whole);
                        begin[axis][middle] += 1;
                        end[axis][middle] += 1;
                    }
                }
            }
        }
        let mut best: Option<Plane> = None;
        for axis in 0..3 {
            let mut right = Content::NONE;
            for k in (1..BINS).rev() {
                right = right.and(Content { bounds: contents[axis][k], count: end[axis][k] });
                slices[k - 1] = right;
            }
            let mut left = Content::NONE;
            for last in 0..BINS - 1 {
                left = left.and(Content { bounds: contents[axis][last], count: begin[axis][last] });
                let right = slices[last];
                let [l, r] = [left.count as usize, right.count as usize];
                if l == items.len() || r == items.len() || l + r > places || l == 0 || r == 0 {
                    continue;
                }
                let parts = Parts::new(left, right);
                if best.as_ref().is_none_or(|best| parts.cost < best.parts.cost) {
                    best = Some(Plane { slices: all[axis], last, parts });
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

    /// Puts what is left of a plane first. What reaches across it is split, or belongs to one side as a whole
    /// where that is cheaper.
    fn partition(&self, room: &mut [Item], count: usize, plane: &Plane) -> [Content; 2] {
        let slices = &plane.slices;
        let Parts { mut left, mut right, .. } = plane.parts;
        let mut parts = [Content::NONE; 2];
        let (mut lefts, mut all) = (0, count);
        let at = slices.plane(plane.last + 1);
        for k in 0..count {
            let item = room[k];
            let whole = item.bounds();
            let [first, last] = slices.span(whole);
            let mut halves = [Some(whole); 2];
            if last <= plane.last {
                halves[1] = None;
            } else if first > plane.last {
                halves[0] = None;
            } else if let Some(cut) = self.halves(&item, slices.axis, at) {
                let fewer = |content: Content| Content { count: content.count - 1, ..content };
                let to_left =
                    Parts::new(Content { bounds: left.bounds.union(whole), ..left }, fewer(right));
                let to_right =
                    Parts::new(fewer(left), Content { bounds: right.bounds.union(whole), ..right });
                let cost = left.cost() + right.cost();
                if to_left.cost < cost.min(to_right.cost) {
                    (left, right, halves[1]) = (to_left.left, to_left.right, None);
                } else if to_right.cost < cost {
                    (left, right, halves[0]) = (to_right.left, to_right.right, None);
                } else {
                    halves = cut;
                }
            } else {
                let side = slices.at(0.5 * item.center()[slices.axis]) > plane.last;
                halves[usize::from(!side)] = None;
            }
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

/// Adds the parts of a triangle, as far as they lie in its box, to the slices from the first to the last that it
/// reaches: between the planes lie its corners there, and where its edges cross the planes.
#[inline(always)]
fn slice(
    corners: [Vec3A; 3],
    whole: FrameBox,
    slices: &Slices,
    [first, last]: [usize; 2],
    contents: &mut [FrameBox; BINS],
) {
    let axis = slices.axis;
    let mut parts = [FrameBox::EMPTY; BINS];
    let mut add = |slice: usize, p: Vec3A| {
        parts[slice] = parts[slice].union(FrameBox { min: p, max: p });
    };
    for k in 0..3 {
        let (mut from, mut to) = (corners[k], corners[(k + 1) % 3]);
        add(slices.at(from[axis]).clamp(first, last), from);
        if from[axis] > to[axis] {
            (from, to) = (to, from);
        }
        let [start, end] = [from, to].map(|p| slices.at(p[axis]).clamp(first, last));
        let slope = (to - from) / (to[axis] - from[axis]);
        for slice in start + 1..=end {
            let cut = from + slope * (slices.plane(slice) - from[axis]);
            add(slice - 1, cut);
            add(slice, cut);
        }
    }
    for slice in first..=last {
        contents[slice] = contents[slice].union(parts[slice].intersection(whole));
    }
}
