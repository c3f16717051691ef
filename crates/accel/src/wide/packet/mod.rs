//! The walk of rays that start in one point and go about the same way, together.

mod aim;
mod answer;

use std::ops::ControlFlow;

use lancer_core::geometry::{Axis, Interval, Ray};
use lancer_core::intersector::Hit;
use lancer_core::scene::Shape;
use smallvec::SmallVec;

use super::collapse::WIDTH;
use super::filter::{Bounds, Filtered, TriangleBounds};
use super::lanes::{Lanes, Vectors, cross, dot, most, splat3, sub3};
use super::leaf::HEADER;
use super::walk::{self, Walker};
use super::{Child, Node, Wide};
use crate::pending::Lanes as Bits;

/// Rays of a packet at most: 8 × 8 pixels.
pub(super) const RAYS: usize = 64;
const VECTORS: usize = RAYS / WIDTH;
/// A packet pays where a triangle is at least this part of the packet wide.
const WIDEST: f64 = 0.25;
/// With more work than this each ray goes alone: about what all of them cost alone.
const MOST_WORK: usize = 16 * RAYS;
/// With no more than this the next packet surely pays.
const LITTLE_WORK: usize = 4 * RAYS;
/// So many packets go alone without being asked after one that did not pay.
const PAUSE: usize = 3;
/// Hits that cannot be told apart in `f32`, at most; with more of them each ray goes alone.
const DOUBTS: usize = 256;

/// Answers all rays: packet by packet where that pays, ray by ray elsewhere.
#[inline(always)]
pub(super) fn closest<L: Lanes>(
    lanes: L,
    wide: &Wide,
    rays: &[Ray],
    range: Interval,
    hits: &mut [Option<Hit>],
) {
    let mut packet = Packet::new(lanes, wide, range);
    let (mut pause, mut paid) = (0, false);
    for (rays, hits) in rays.chunks(RAYS).zip(hits.chunks_mut(RAYS)) {
        if pause > 0 {
            pause -= 1;
        } else if packet.aim(rays) && (paid || packet.pays()) && packet.walk() {
            packet.answer(hits);
            paid = packet.spent <= LITTLE_WORK;
            continue;
        } else {
            (pause, paid) = (PAUSE, false);
        }
        walk::closest_each(lanes, wide, rays, range, hits);
    }
}

/// Rays o + t (p, q, σ), where the last axis is that along which all of them go, in the direction σ = ±1:
/// then t is the depth along this axis.
///
/// # Which boxes
///
/// With the slopes p between p₀ and p₁ a box is beside the packet if x − o_x − p₁ w > 0 in all of it, w being
/// the depth, or < 0 with p₀; the same for q. Of the box only one corner counts. Slopes are rounded apart,
/// and what multiplies the origin is worked out in `f64` with the rounded slopes, so each side errs by
/// 2⁻²⁴ (8 + 6 D), D = 1 + |o|, for slopes up to 2: less than the pad of 2⁻²⁴ 16 D.
///
/// # Which triangles
///
/// U, V and Δ of [`Wide`] are linear in the direction: U = d·(f × C), V = d·(e × C), Δ = d·N, and T is the
/// same for all rays. f × C and e × C are off by u s (2 D + 8 c), as R there by u δ (2 D + 8 c), so the same
/// bounds hold, and the same comparisons: first for the range of all slopes, eight triangles at a time, then
/// for what is left eight rays at a time.
pub(super) struct Packet<'p, 's, L: Lanes> {
    lanes: L,
    wide: &'p Wide<'s>,
    rays: &'p [Ray],
    range: Interval,
    /// Along which all rays are longest, if they are for sure.
    axis: Option<Axis>,
    /// The axes of p, q and depth.
    axes: [usize; 3],
    sign: f32,
    /// Of all rays.
    spread: Spread<f32>,
    /// Of each vector: the middle of p and of q, and half their ranges.
    spreads: [[[f32; WIDTH]; 2]; 2],
    bounds: Bounds,
    origin: [f32; 3],
    sides: [Side; 4],
    /// σ, and −σ o along the axis of depth less and more the pad.
    depth: [f32; 3],
    /// A hit must be this far away to be certain.
    min: f32,
    slopes: [[[f32; WIDTH]; VECTORS]; 2],
    valid: [u32; VECTORS],
    /// Nothing beyond can be the closest hit, of each ray, and of any.
    max: [[f32; WIDTH]; VECTORS],
    farthest: f32,
    /// The closest certain hit so far: its lower end, and its record.
    lowest: [[f32; WIDTH]; VECTORS],
    best: [[u32; WIDTH]; VECTORS],
    /// Ray and record of what might be closer, or not.
    doubts: SmallVec<[u64; DOUBTS]>,
    /// A bit for each ray that has some.
    doubtful: u64,
    /// The work so far, in visits of a node: a leaf counts as two, eight rays and a triangle as one.
    spent: usize,
}

/// One side of the packet: a box is beside it if ±x + `factor` · z + `offset` > 0, x being the box's lowest
/// coordinate (+) or its highest (−, turned) on the axis of the slope, z the one on the axis of depth that makes
/// the sum small.
#[derive(Clone, Copy)]
struct Side {
    turned: bool,
    factor: f32,
    offset: f32,
}

/// No record.
const NONE: u32 = u32::MAX;

impl<'p, 's, L: Lanes> Packet<'p, 's, L> {
    /// A packet without rays.
    #[inline(always)]
    pub(super) fn new(lanes: L, wide: &'p Wide<'s>, range: Interval) -> Self {
        Self {
            lanes,
            wide,
            rays: &[],
            range,
            axis: None,
            axes: [0, 1, 2],
            sign: 1.0,
            spread: Spread::between([0.0; 2], [0.0; 2]),
            spreads: [[[0.0; WIDTH]; 2]; 2],
            bounds: Bounds::new(0.0, 0.0),
            origin: [0.0; 3],
            sides: [Side { turned: false, factor: 0.0, offset: 0.0 }; 4],
            depth: [0.0; 3],
            min: 0.0,
            slopes: [[[0.0; WIDTH]; VECTORS]; 2],
            valid: [0; VECTORS],
            max: [[0.0; WIDTH]; VECTORS],
            farthest: 0.0,
            lowest: [[0.0; WIDTH]; VECTORS],
            best: [[NONE; WIDTH]; VECTORS],
            doubts: SmallVec::new(),
            doubtful: 0,
            spent: 0,
        }
    }

    /// Whether the triangles are large enough, judged by what two of the rays hit.
    #[inline(always)]
    fn pays(&self) -> bool {
        let width = 2.0 * f64::from(self.spread.half[0].max(self.spread.half[1]));
        for k in [0, self.rays.len() / 4 * 3] {
            let ray = &self.rays[k];
            let (wide, range) = (self.wide, self.range);
            let hit = self.lanes.apart(
                #[inline(always)]
                move |lanes| walk::closest(lanes, wide, ray, range, &mut ()),
            );
            let Some(hit) = hit else { continue };
            let scene = self.wide.scene;
            let Shape::Triangle(index) = scene.shape(hit.primitive) else { return false };
            let [a, b, c] = scene.mesh.corners(index);
            let size = (b - a).abs().max((c - a).abs()).max_element();
            let depth = hit.t * ray.direction.to_array()[self.axes[2]].abs();
            if size < WIDEST * width * depth {
                return false;
            }
        }
        true
    }

    /// Walks to the leaves that the packet meets, near ones first. Returns whether all is well: not if it is
    /// too much work, or too many hits cannot be told apart.
    #[inline(always)]
    pub(super) fn walk(&mut self) -> bool {
        let (lanes, wide) = (self.lanes, self.wide);
        walk::walk(lanes, wide, self, &mut ()).is_continue()
    }

    /// What multiplies a direction's third component, σ, turned once for all.
    #[inline(always)]
    fn turned(&self, [x, y, z]: Vectors<L>) -> Vectors<L> {
        [x, y, self.lanes.mul(z, self.lanes.splat(self.sign))]
    }

    /// A bit for each vector of rays.
    #[inline(always)]
    fn vectors_that_may_meet(&self, triangle: &Triangle<L::F>) -> u32 {
        let l = self.lanes;
        let [[p, q], [half_p, half_q]] = &self.spreads;
        let spread =
            Spread { middle: [l.load(p), l.load(q)], half: [l.load(half_p), l.load(half_q)] };
        let rows = [splat3(l, triangle.u), splat3(l, triangle.v), splat3(l, triangle.det)];
        spread.may_meet(l, rows, triangle.bounds)
    }

    /// What is linear in the direction, for eight rays.
    #[inline(always)]
    fn along(&self, [x, y, z]: [f32; 3], vector: usize) -> L::F {
        let l = self.lanes;
        let (p, q) = (l.load(&self.slopes[0][vector]), l.load(&self.slopes[1][vector]));
        l.mul_add(l.splat(x), p, l.mul_add(l.splat(y), q, l.splat(z)))
    }

    /// Tests eight rays. Returns whether one of them has now a nearer end.
    #[inline(always)]
    fn test(&mut self, triangle: &Triangle<L::F>, vector: usize) -> bool {
        let l = self.lanes;
        let det = self.along(triangle.det, vector);
        let (u, v) = (self.along(triangle.u, vector), self.along(triangle.v, vector));
        let max = l.load(&self.max[vector]);
        let t = l.splat(triangle.t);
        let valid = self.valid[vector];
        let filtered = Filtered::new(l, [u, v, det, t], triangle.bounds, max, valid);
        if filtered.kept == 0 {
            return false;
        }
        let (certain, lowest, highest) = filtered.certain(l, self.min);
        // Surely before the closest one so far, which then cannot be it.
        let before = l.load(&self.lowest[vector]);
        let nearer = certain & l.above(before, highest);
        self.lowest[vector] = l.store(l.select(nearer, lowest, before));
        let shorter = certain & l.above(max, highest);
        self.max[vector] = l.store(l.select(shorter, highest, max));
        for lane in Bits::<WIDTH>(nearer) {
            self.best[vector][lane] = triangle.record;
        }
        for lane in Bits::<WIDTH>(filtered.kept & !nearer) {
            let (ray, best) = (vector * WIDTH + lane, self.best[vector][lane]);
            // The same triangle in another leaf is no rival.
            if best != NONE && self.wide.triangle(best).0 == self.wide.triangle(triangle.record).0 {
                continue;
            }
            self.doubtful |= 1 << ray;
            self.doubts.push((ray as u64) << 32 | u64::from(triangle.record));
        }
        shorter != 0
    }
}

impl<L: Lanes> Walker<L> for Packet<'_, '_, L> {
    const SORTS: bool = true;
    type Boxes = ();

    #[inline(always)]
    fn boxes(&self) {}

    /// The depths of eight boxes, and which of them the packet may meet, a bit per lane.
    #[inline(always)]
    fn enter(&mut self, (): &(), node: &Node) -> (L::F, u32) {
        self.spent += 1;
        let l = self.lanes;
        let mut beside = l.splat(f32::NEG_INFINITY);
        let [x_rows, y_rows, z_rows] = self.axes.map(|axis| &node.planes[axis % 3]);
        for (side, rows) in self.sides.iter().zip([x_rows, x_rows, y_rows, y_rows]) {
            let x = l.load(&rows[usize::from(side.turned)]);
            let z = l.load(&z_rows[usize::from(side.factor < 0.0)]);
            let sum = l.mul_add(z, l.splat(side.factor), l.splat(side.offset));
            beside = l.max(if side.turned { l.sub(sum, x) } else { l.add(sum, x) }, beside);
        }
        let [sign, near, far] = self.depth;
        let nearest = usize::from(sign < 0.0);
        let first = l.mul_add(l.load(&z_rows[nearest]), l.splat(sign), l.splat(near));
        let last = l.mul_add(l.load(&z_rows[1 - nearest]), l.splat(sign), l.splat(far));
        let first = l.max(first, l.splat(0.0));
        let zero = l.splat(0.0);
        let met = l.at_least(zero, beside)
            & l.at_least(last, zero)
            & l.at_least(l.splat(self.farthest), first);
        (first, met)
    }

    #[inline(always)]
    fn max(&self) -> f32 {
        self.farthest
    }

    #[inline(always)]
    fn visit(&mut self, leaf: Child) -> ControlFlow<()> {
        self.spent += 2;
        // Spheres are tested ray by ray.
        if self.spent > MOST_WORK || leaf.has_spheres() {
            return ControlFlow::Break(());
        }
        let l = self.lanes;
        let count = leaf.count();
        let words = self.wide.words(leaf);
        let rows = l.rows::<9>(&words[HEADER..], count);
        let [p, q, w] = self.axes;
        let a = [rows[p], rows[q], rows[w]];
        let (e, f) =
            ([rows[3 + p], rows[3 + q], rows[3 + w]], [rows[6 + p], rows[6 + q], rows[6 + w]]);
        let c = sub3(l, a, splat3(l, [self.origin[p], self.origin[q], self.origin[w]]));
        let normal = cross(l, f, e);
        let t = dot(l, normal, c);
        let u = self.turned(cross(l, f, c));
        let v = self.turned(cross(l, e, c));
        let det = self.turned(normal);

        let noise = self.bounds.noise(l, words, c);
        let bounds = self.bounds.of(l, words, noise);
        let spread = Spread {
            middle: [l.splat(self.spread.middle[0]), l.splat(self.spread.middle[1])],
            half: [l.splat(self.spread.half[0]), l.splat(self.spread.half[1])],
        };
        let met = spread.may_meet(l, [u, v, det], bounds) & ((1 << count) - 1);
        if met == 0 {
            return ControlFlow::Continue(());
        }
        let stored = [u[0], u[1], u[2], v[0], v[1], v[2], det[0], det[1], det[2], t, noise];
        let mut rows = [[0.0; WIDTH]; 11];
        for (row, x) in rows.iter_mut().zip(stored) {
            *row = l.store(x);
        }
        let mut found = false;
        for lane in Bits::<WIDTH>(met) {
            let triangle = Triangle {
                u: [rows[0][lane], rows[1][lane], rows[2][lane]],
                v: [rows[3][lane], rows[4][lane], rows[5][lane]],
                det: [rows[6][lane], rows[7][lane], rows[8][lane]],
                t: rows[9][lane],
                bounds: self.bounds.of(l, words, l.splat(rows[10][lane])),
                record: Wide::record(leaf, lane),
            };
            for vector in Bits::<VECTORS>(self.vectors_that_may_meet(&triangle)) {
                self.spent += 1;
                if self.doubts.len() + WIDTH > DOUBTS {
                    return ControlFlow::Break(());
                }
                found |= self.test(&triangle, vector);
            }
        }
        if found {
            let mut farthest = l.splat(0.0);
            for max in &self.max {
                farthest = l.max(l.load(max), farthest);
            }
            self.farthest = most(l, farthest);
        }
        ControlFlow::Continue(())
    }
}

/// Between which slopes rays go.
#[derive(Clone, Copy)]
struct Spread<F> {
    middle: [F; 2],
    half: [F; 2],
}

impl Spread<f32> {
    fn between(low: [f32; 2], high: [f32; 2]) -> Self {
        Self {
            middle: [0.5 * (high[0] + low[0]), 0.5 * (high[1] + low[1])],
            half: [0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1])],
        }
    }
}

impl<F: Copy> Spread<F> {
    /// Which triangles, of given U, V and Δ, some of the rays may meet: all three weights must reach 0 on one
    /// side, by twice their bound.
    #[inline(always)]
    fn may_meet<L: Lanes<F = F>>(
        &self,
        l: L,
        [u, v, det]: [Vectors<L>; 3],
        bounds: TriangleBounds<F>,
    ) -> u32 {
        let w = sub3(l, sub3(l, det, u), v);
        let (u, v, w) = (self.extremes(l, u), self.extremes(l, v), self.extremes(l, w));
        let most = l.min(u.1, l.min(v.1, w.1));
        let least = l.max(u.0, l.max(v.0, w.0));
        let margin = bounds.margin(l);
        l.at_least(most, l.sub(l.splat(0.0), margin)) | l.at_least(margin, least)
    }

    /// The least and the most of what is linear in the direction.
    #[inline(always)]
    fn extremes<L: Lanes<F = F>>(&self, l: L, [x, y, z]: Vectors<L>) -> (F, F) {
        let center = l.mul_add(x, self.middle[0], l.mul_add(y, self.middle[1], z));
        let reach = l.mul_add(l.abs(x), self.half[0], l.mul(l.abs(y), self.half[1]));
        (l.sub(center, reach), l.add(center, reach))
    }
}

/// A triangle as all rays of a packet see it: U, V and Δ by the direction's components, and T.
struct Triangle<F> {
    u: [f32; 3],
    v: [f32; 3],
    det: [f32; 3],
    t: f32,
    bounds: TriangleBounds<F>,
    record: u32,
}
