//! From the filter's findings to hits.

use glam::DVec3;
use lancer_core::geometry::{Axis, Shear, solve_triangle};
use lancer_core::intersector::{Hit, Probe};
use lancer_core::scene::PrimitiveId;

use super::super::collapse::WIDTH;
use super::super::lanes::Lanes;
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
                let mut probe = Probe::new(self.wide.scene, ray, self.range);
                if best != NONE {
                    self.wide.solve(&mut probe, best);
                }
                while let Some(doubt) = doubts.next_if(|&&doubt| doubt >> 32 == k as u64) {
                    self.wide.test(&mut probe, *doubt as u32);
                }
                *hit = probe.best();
            } else if best != NONE {
                certain[count] = k;
                count += 1;
            }
        }
        let mut rest = &certain[..count];
        while let [a, b, c, d, after @ ..] = rest {
            self.solve([*a, *b, *c, *d], hits);
            rest = after;
        }
        // The last ones as often as it takes.
        if let [first, others @ ..] = rest {
            let other = |k: usize| others.get(k).copied().unwrap_or(*first);
            self.solve([*first, other(0), other(1), other(2)], hits);
        }
    }

    /// The hits of four rays that surely meet their best triangles.
    #[inline(always)]
    fn solve(&self, rays: [usize; 4], hits: &mut [Option<Hit>]) {
        let (l, wide) = (self.lanes, self.wide);
        let axis = Axis::longest(self.rays[rays[0]].direction);
        let mut alike = true;
        let mut ids = [PrimitiveId(0); 4];
        let mut direction = [[0.0; 4]; 3];
        let mut corners = [[[0.0; 4]; 3]; 3];
        for (lane, k) in rays.into_iter().enumerate() {
            let ray = &self.rays[k];
            alike &= Axis::longest(ray.direction) == axis;
            let (id, indices) = wide.triangle(self.best[k / WIDTH][k % WIDTH]);
            ids[lane] = id;
            scatter(ray.direction, lane, &mut direction);
            for (corner, index) in corners.iter_mut().zip(indices) {
                scatter(wide.scene.mesh.positions[index], lane, corner);
            }
        }
        if !alike {
            for k in rays {
                let mut probe = Probe::new(wide.scene, &self.rays[k], self.range);
                wide.solve(&mut probe, self.best[k / WIDTH][k % WIDTH]);
                hits[k] = probe.best();
            }
            return;
        }
        let origin = self.rays[rays[0]].origin.to_array();
        let [a, b, c] = corners;
        let corners = [relative(l, a, origin), relative(l, b, origin), relative(l, c, origin)];
        let [x, y, z] = direction;
        let shear = Shear::along(axis, [l.four(x), l.four(y), l.four(z)]);
        let (t, [u, v, w]) = solve_triangle(corners, &shear);
        let (t, u, v, w) = (l.numbers(t), l.numbers(u), l.numbers(v), l.numbers(w));
        for (lane, k) in rays.into_iter().enumerate() {
            let mut probe = Probe::new(wide.scene, &self.rays[k], self.range);
            let barycentric = DVec3::new(u[lane], v[lane], w[lane]);
            probe.keep(Hit { t: t[lane], primitive: ids[lane], barycentric });
            hits[k] = probe.best();
        }
    }
}

/// Puts a vector's components into a lane of each.
#[inline(always)]
fn scatter(vector: DVec3, lane: usize, components: &mut [[f64; 4]; 3]) {
    let [x, y, z] = components;
    (x[lane], y[lane], z[lane]) = (vector.x, vector.y, vector.z);
}

/// Four points relative to the packet's origin.
#[inline(always)]
fn relative<L: Lanes>(l: L, [x, y, z]: [[f64; 4]; 3], origin: [f64; 3]) -> [L::D; 3] {
    let [ox, oy, oz] = origin;
    [l.four(x) - l.four([ox; 4]), l.four(y) - l.four([oy; 4]), l.four(z) - l.four([oz; 4])]
}
