//! From the filter's findings to hits.

use glam::DVec3;
use lancer_core::geometry::{Axis, Real, Shear, solve_triangle};
use lancer_core::intersector::{Hit, Probe};

use super::super::collapse::WIDTH;
use super::super::decide::Decision;
use super::super::lanes::{Lanes, gather};
use super::{NONE, Packet, RAYS};

impl<L: Lanes> Packet<'_, '_, L> {
    /// Lets `f64` decide on what is left; four rays at a time where it is only where they meet a triangle.
    #[inline(always)]
    pub(in crate::wide) fn answer(&mut self, hits: &mut [Option<Hit>]) {
        self.doubts.sort_unstable();
        let mut doubts = self.doubts.iter().peekable();
        let (mut certain, mut count) = ([0; RAYS], 0);
        for (k, (ray, hit)) in self.rays.iter().zip(hits.iter_mut()).enumerate() {
            let best = self.best[k / WIDTH][k % WIDTH];
            *hit = None;
            if self.doubtful >> k & 1 != 0 {
                let mut decision = Decision::new(self.lanes, self.wide, ray, self.range, None);
                if best != NONE {
                    decision.test(best, true);
                }
                while let Some(doubt) = doubts.next_if(|&&doubt| doubt >> 32 == k as u64) {
                    decision.test(*doubt as u32, false);
                }
                *hit = decision.best();
            } else if best != NONE {
                certain[count] = k;
                count += 1;
            }
        }
        for four in certain[..count].chunks(4) {
            // Of fewer the last one as often as it takes.
            let ray = |k: usize| four[k.min(four.len() - 1)];
            let rays = [ray(0), ray(1), ray(2), ray(3)];
            let (packet, hits) = (&*self, &mut *hits);
            // Apart, so that it is optimised by itself.
            self.lanes.apart(
                #[inline(always)]
                move |_| packet.solve(rays, hits),
            );
        }
    }

    /// The hits of four rays that surely meet their best triangles.
    #[inline(always)]
    fn solve(&self, [i, j, k, m]: [usize; 4], hits: &mut [Option<Hit>]) {
        let (l, wide) = (self.lanes, self.wide);
        let rays = self.rays;
        let best = |k: usize| self.best[k / WIDTH][k % WIDTH];
        let axis = Axis::longest(rays[i].direction);
        if [j, k, m].iter().any(|&k| Axis::longest(rays[k].direction) != axis) {
            for k in [i, j, k, m] {
                let mut decision = Decision::new(l, wide, &rays[k], self.range, None);
                decision.test(best(k), true);
                hits[k] = decision.best();
            }
            return;
        }
        let origin = gather(l, [rays[i].origin; 4]);
        let triangle = |k: usize| wide.triangle(best(k));
        // One by one: what maps an array is not sure to be inlined.
        let (of_i, of_j, of_k, of_m) = (triangle(i), triangle(j), triangle(k), triangle(m));
        let ([a, b, c], [d, e, f]) = (wide.corners(of_i.1), wide.corners(of_j.1));
        let ([g, h, n], [p, q, r]) = (wide.corners(of_k.1), wide.corners(of_m.1));
        let corners = [
            relative(gather(l, [a, d, g, p]), origin),
            relative(gather(l, [b, e, h, q]), origin),
            relative(gather(l, [c, f, n, r]), origin),
        ];
        let directions =
            [rays[i].direction, rays[j].direction, rays[k].direction, rays[m].direction];
        let ids = [of_i.0, of_j.0, of_k.0, of_m.0];
        let shear = Shear::along(axis, gather(l, directions));
        let (t, [u, v, w]) = solve_triangle(corners, &shear);
        let (t, u, v, w) = (l.numbers(t), l.numbers(u), l.numbers(v), l.numbers(w));
        for (lane, k) in [i, j, k, m].into_iter().enumerate() {
            let mut probe = Probe::new(wide.scene, &rays[k], self.range);
            let barycentric = DVec3::new(u[lane], v[lane], w[lane]);
            probe.keep(Hit { t: t[lane], primitive: ids[lane], barycentric });
            hits[k] = probe.best();
        }
    }
}

#[inline(always)]
fn relative<T: Real>([x, y, z]: [T; 3], [ox, oy, oz]: [T; 3]) -> [T; 3] {
    [x - ox, y - oy, z - oz]
}
