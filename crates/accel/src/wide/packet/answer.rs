//! From the filter's findings to hits.

use lancer_core::geometry::Axis;
use lancer_core::intersector::Hit;

use super::super::collapse::WIDTH;
use super::super::decide::{Certain, Decision};
use super::super::lanes::Lanes;
use super::{NONE, Packet};

impl<L: Lanes> Packet<'_, '_, L> {
    /// Lets `f64` decide on what is left; four rays at a time where it is only where they meet a triangle.
    #[inline(always)]
    pub(in crate::wide) fn answer(&mut self, hits: &mut [Option<Hit>]) {
        self.doubts.sort_unstable();
        let mut doubts = self.doubts.iter().peekable();
        let mut certain = Certain::new();
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
                let axis = self.axis.unwrap_or_else(|| Axis::longest(ray.direction));
                certain.push(axis, k, best);
            }
        }
        certain.solve(self.lanes, self.wide, self.rays, self.range, hits);
    }
}
