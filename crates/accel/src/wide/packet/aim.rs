//! From rays to a packet.

use glam::DVec3;
use lancer_core::geometry::{Axis, Ray, Real};

use super::super::collapse::WIDTH;
use super::super::filter::{Bounds, U};
use super::super::lanes::{Lanes, least, most};
use super::{NONE, Packet, Side, Spread, VECTORS};

/// The farthest origin, in units of the scene's frame, and the steepest slope.
const FARTHEST: f64 = 8.0;
const STEEPEST: f32 = 2.0;

impl<'p, L: Lanes> Packet<'p, '_, L> {
    /// Takes rays. Returns whether they are a packet: not if they do not start in one point, go too different
    /// ways, or come from far away.
    #[inline(always)]
    pub(in crate::wide) fn aim(&mut self, rays: &'p [Ray]) -> bool {
        let Some(first) = rays.first() else { return false };
        let frame = &self.wide.frame;
        let origin = frame.point(first.origin);
        let direction = first.direction.to_array();
        let axis = Axis::longest(first.direction);
        let last = axis as usize;
        let axes = [(last + 1) % 3, (last + 2) % 3, last];
        let sign = direction[last].signum();
        let is_near = origin.abs().max_element() <= FARTHEST && frame.moved == 0.0;
        if self.wide.nodes.is_empty() || !is_near {
            return false;
        }

        let l = self.lanes;
        self.valid = [0; VECTORS];
        self.max = [[0.0; WIDTH]; VECTORS];
        // Vectors without rays meet nothing.
        self.spreads = [[[f32::NAN; WIDTH]; 2]; 2];
        let differs = rays.iter().fold(0, |bits, ray| bits | difference(ray.origin, first.origin));
        let mut alike = differs == 0;
        let (mut low, mut high) = ([l.splat(STEEPEST); 2], [l.splat(-STEEPEST); 2]);
        let mut along_most = l.splat(0.0);
        let mut farthest = l.splat(0.0);
        // A parameter is rounded up when it becomes an `f32`.
        let end = self.range.max * frame.to_unit * (1.0 + f64::from(f32::EPSILON));
        let end = l.four([end; 4]);
        for vector in 0..rays.len().div_ceil(WIDTH) {
            let count = (rays.len() - vector * WIDTH).min(WIDTH);
            self.valid[vector] = (1 << count) - 1;
            let [p0, q0, along0] = slopes(l, rays, vector * WIDTH, axes, sign);
            let [p1, q1, along1] = slopes(l, rays, vector * WIDTH + WIDTH / 2, axes, sign);
            let slopes = [l.narrow(p0, p1), l.narrow(q0, q1)];
            let along = l.narrow(along0, along1);
            // Accepting comparisons: NaN is none of it.
            alike &= l.at_least(l.splat(STEEPEST), l.abs(slopes[0]))
                & l.at_least(l.splat(STEEPEST), l.abs(slopes[1]))
                & l.above(along, l.splat(1e-9))
                == 0xff;
            along_most = l.max(along_most, along);
            let max = l.narrow(along0 * end, along1 * end);
            farthest = l.max(max, farthest);
            self.max[vector] = l.store(max);
            for axis in [0, 1] {
                let (of_low, of_high) = (least(l, slopes[axis]), most(l, slopes[axis]));
                self.slopes[axis][vector] = l.store(slopes[axis]);
                self.spreads[0][axis][vector] = 0.5 * (of_high + of_low);
                self.spreads[1][axis][vector] = 0.5 * (of_high - of_low);
                low[axis] = l.min(low[axis], slopes[axis]);
                high[axis] = l.max(high[axis], slopes[axis]);
            }
        }
        let from_min = self.range.min.max(0.0) * frame.to_unit * f64::from(most(l, along_most));
        if !alike || from_min > 1e9 {
            return false;
        }
        let low = [least(l, low[0]).next_down(), least(l, low[1]).next_down()];
        let high = [most(l, high[0]).next_up(), most(l, high[1]).next_up()];

        let o = origin.to_array();
        let reach = 1.0 + origin.abs().max_element() as f32;
        let pad = f64::from(16.0 * U * reach);
        for (k, side) in self.sides.iter_mut().enumerate() {
            let (axis, turned) = (k / 2, k % 2 == 1);
            let slope = if turned { low[axis] } else { high[axis] };
            // Beside: turn · (x − o_x − slope w) > 0 with the least x and the most of slope · w.
            let turn = if turned { -1.0 } else { 1.0 };
            let factor = -turn * f64::from(slope) * sign;
            *side = Side {
                turned,
                factor: factor as f32,
                offset: (-factor * o[last] - turn * o[axes[axis]] - pad) as f32,
            };
        }
        let steepest = low.iter().chain(&high).fold(1.0_f32, |most, slope| most.max(slope.abs()));
        self.rays = rays;
        self.axis = (low.iter().chain(&high).all(|slope| slope.abs() < 1.0)).then_some(axis);
        self.axes = axes;
        self.sign = sign as f32;
        self.spread = Spread::between(low, high);
        self.bounds = Bounds::new(reach, steepest);
        self.origin = o.map(|x| x as f32);
        self.depth = [sign, -sign * o[last] - pad, -sign * o[last] + pad].map(|x| x as f32);
        self.min = (from_min * (1.0 + 2.0 * f64::from(f32::EPSILON))) as f32;
        self.farthest = most(l, farthest);
        self.lowest = [[f32::INFINITY; WIDTH]; VECTORS];
        self.best = [[NONE; WIDTH]; VECTORS];
        self.doubts.clear();
        self.doubtful = 0;
        self.spent = 0;
        true
    }
}

/// The bits in which two points differ.
#[inline(always)]
fn difference(a: DVec3, b: DVec3) -> u64 {
    let differ = |a: f64, b: f64| a.to_bits() ^ b.to_bits();
    differ(a.x, b.x) | differ(a.y, b.y) | differ(a.z, b.z)
}

/// Slopes of four rays from the `first` on, and how far they go along the last axis; beyond the end it is the
/// last one.
#[inline(always)]
fn slopes<L: Lanes>(l: L, rays: &[Ray], first: usize, axes: [usize; 3], sign: f64) -> [L::D; 3] {
    let end = rays.len() - 1;
    let ray = |k: usize| rays[(first + k).min(end)].direction.to_array();
    let [a, b, c, d] = [ray(0), ray(1), ray(2), ray(3)];
    let [p, q, w] = axes.map(|axis| [a[axis], b[axis], c[axis], d[axis]]);
    let along = l.four(w) * l.four([sign; 4]);
    let inverse = along.recip();
    [l.four(p) * inverse, l.four(q) * inverse, along]
}
