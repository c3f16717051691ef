//! The filter of triangles: see [`super::Wide`] for its formulas and their bounds.

use super::lanes::{Lanes, Vectors};

/// Unit roundoff of `f32`.
pub(super) const U: f32 = 0.5 * f32::EPSILON;

/// What the bounds are made of that a ray has, or several have: D and δ.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    reach: f32,
    length: f32,
}

/// The bounds of eight triangles: see [`super::Wide`].
#[derive(Clone, Copy)]
pub(super) struct TriangleBounds<F> {
    e: F,
    /// 2 e_T
    e_behind: F,
    e_det: F,
}

impl Bounds {
    /// D is `reach`, δ is `length`.
    #[inline(always)]
    pub(super) fn new(reach: f32, length: f32) -> Self {
        Self { reach, length }
    }

    /// p, of triangles seen along C = `from_origin` in a leaf with these words.
    #[inline(always)]
    pub(super) fn noise<L: Lanes>(&self, l: L, words: &[f32], from_origin: Vectors<L>) -> L::F {
        let [x, y, z] = from_origin;
        let c = l.max(l.abs(x), l.max(l.abs(y), l.abs(z)));
        let of_ray = l.mul_add(c, l.splat(128.0 * U), l.splat(16.0 * U * self.reach));
        l.add(of_ray, l.splat(words[1]))
    }

    /// Of triangles with `noise` p.
    #[inline(always)]
    pub(super) fn of<L: Lanes>(&self, l: L, words: &[f32], noise: L::F) -> TriangleBounds<L::F> {
        let scale = self.length * words[0];
        TriangleBounds {
            e: l.mul(noise, l.splat(scale)),
            e_behind: l.mul(noise, l.splat(words[2])),
            e_det: l.splat(scale * words[1]),
        }
    }
}

impl<F: Copy> TriangleBounds<F> {
    /// Twice e.
    #[inline(always)]
    pub(super) fn margin<L: Lanes<F = F>>(&self, l: L) -> F {
        l.add(self.e, self.e)
    }
}

/// Eight pairs of a ray and a triangle after the filter.
pub(super) struct Filtered<F> {
    /// What `f64` might accept, a bit per lane.
    pub(super) kept: u32,
    /// The least of U, V and W.
    inside: F,
    t: F,
    det: F,
    det_most: F,
    bounds: TriangleBounds<F>,
}

impl<F: Copy> Filtered<F> {
    /// Keeps what may be a hit before `max`, among the lanes of `valid`: see [`super::Wide`] for the comparisons.
    #[inline(always)]
    pub(super) fn new<L: Lanes<F = F>>(
        l: L,
        [u, v, det, t]: [F; 4],
        bounds: TriangleBounds<F>,
        max: F,
        valid: u32,
    ) -> Self {
        let (u, v, t) = (l.turn(u, det), l.turn(v, det), l.turn(t, det));
        let det = l.abs(det);
        let inside = l.min(u, l.min(v, l.sub(l.sub(det, u), v)));
        let det_most = l.add(det, bounds.e_det);
        let before_max = l.add(l.mul_sub(max, det_most, t), bounds.e_behind);
        let worst = l.min(l.add(inside, bounds.e), l.min(l.add(t, bounds.e_behind), before_max));
        let kept = l.at_least(worst, l.splat(0.0)) & valid;
        Self { kept, inside, t, det, det_most, bounds }
    }

    /// Which of the kept hits are certain and lie beyond `min`, and between which parameters they lie.
    #[inline(always)]
    pub(super) fn certain<L: Lanes<F = F>>(&self, l: L, min: f32) -> (u32, F, F) {
        let Self { kept, inside, t, det, det_most, bounds } = *self;
        let e_t = l.mul(bounds.e_behind, l.splat(0.5));
        // The quotients round too.
        let lowest = l.mul(l.div(l.sub(t, e_t), det_most), l.splat(1.0 - 4.0 * f32::EPSILON));
        let det_least = l.sub(det, bounds.e_det);
        let highest = l.mul(l.div(l.add(t, e_t), det_least), l.splat(1.0 + 4.0 * f32::EPSILON));
        let certain = kept
            & l.above(inside, bounds.e)
            & l.above(t, e_t)
            & l.above(det_least, bounds.e_det)
            & l.above(lowest, l.splat(min));
        (certain, lowest, highest)
    }
}
