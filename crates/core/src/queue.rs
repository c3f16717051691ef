//! Rays that are asked together.

use crate::geometry::{Interval, Ray};
use crate::intersector::{Hit, Intersector};

/// Rays that wait to be asked together, each with what its answer is for: an index is asked once about all of them,
/// which is faster than one by one.
#[derive(Clone, Debug)]
pub struct Queue<T> {
    rays: Vec<Ray>,
    whose: Vec<T>,
}

impl<T> Queue<T> {
    /// An empty queue with room for so many rays, and for more when they come.
    pub fn with_capacity(rays: usize) -> Self {
        Self { rays: Vec::with_capacity(rays), whose: Vec::with_capacity(rays) }
    }

    /// Adds a ray.
    #[inline]
    pub fn push(&mut self, ray: Ray, whose: T) {
        self.rays.push(ray);
        self.whose.push(whose);
    }

    /// How many rays wait.
    #[inline]
    pub fn len(&self) -> usize {
        self.rays.len()
    }

    /// Whether no ray waits.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.rays.is_empty()
    }

    /// Hands the first hit of each ray over, in the order in which the rays came. The queue is empty then.
    #[inline]
    pub fn closest_hits(
        &mut self,
        index: &dyn Intersector,
        range: Interval,
        mut answer: impl FnMut(&Ray, T, Option<Hit>),
    ) {
        let mut hits = vec![None; self.rays.len()];
        index.closest_hits(&self.rays, range, &mut hits);
        for ((ray, whose), hit) in self.rays.iter().zip(self.whose.drain(..)).zip(hits) {
            answer(ray, whose, hit);
        }
        self.rays.clear();
    }

    /// Tells of each ray whether it meets anything, in the order in which the rays came. The queue is empty then.
    #[inline]
    pub fn occluded(
        &mut self,
        index: &dyn Intersector,
        range: Interval,
        mut answer: impl FnMut(T, bool),
    ) {
        let mut occluded = vec![false; self.rays.len()];
        index.occluded_all(&self.rays, range, &mut occluded);
        self.rays.clear();
        self.whose.drain(..).zip(occluded).for_each(|(whose, occluded)| answer(whose, occluded));
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::generate::icosphere;
    use crate::intersector::LinearScan;
    use crate::scene::Scene;

    /// Every second ray meets the sphere, from where the ray's number says.
    #[test]
    fn answers_come_in_order_each_to_its_owner() {
        let scene = Scene::of_mesh(icosphere(1));
        let index = LinearScan::new(&scene);
        let mut queue = Queue::with_capacity(2);
        let ray = |k: usize| {
            let away = if k.is_multiple_of(2) { -1.0 } else { 1.0 };
            Ray::new(DVec3::new(0.01, 0.02, 2.0 + k as f64), away * DVec3::Z)
        };
        let mut answers = Vec::new();
        for _ in 0..2 {
            (0..5).for_each(|k| queue.push(ray(k), k));
            assert_eq!(queue.len(), 5);
            queue.closest_hits(&index, Interval::POSITIVE, |asked, k, hit| {
                assert_eq!(*asked, ray(k));
                let depth = hit.map(|hit| hit.t.round());
                assert_eq!(depth, k.is_multiple_of(2).then_some(1.0 + k as f64));
                answers.push(k);
            });
            assert!(queue.is_empty());
        }
        (0..5).for_each(|k| queue.push(ray(k), k));
        queue.occluded(&index, Interval::up_to(3.5), |k, is_occluded| {
            assert_eq!(is_occluded, k == 0 || k == 2);
            answers.push(k);
        });
        assert_eq!(answers, [0, 1, 2, 3, 4, 0, 1, 2, 3, 4, 0, 1, 2, 3, 4]);
    }
}
