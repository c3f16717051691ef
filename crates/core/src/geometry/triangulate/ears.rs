use std::collections::VecDeque;

use glam::DVec2;

use super::cross;
use super::outline::Outline;

/// How far rounding may have moved a corner, as a part of the polygon's size: of files that are written
/// with six digits, by less than this.
const ROUNDING: f64 = 1.0 / (1 << 15) as f64;

/// Cuts off, again and again, a corner whose triangle is inside of the polygon and not entered by its
/// outline.
///
/// A polygon that touches itself, as a hole does that meets the outline, no longer touches once its
/// corners are rounded: there it crosses itself or leaves a gap, by as much as the last digit. What is
/// asked of an ear is therefore graded. First nothing may be near it; then nothing may enter it; and
/// where no such ear is left, nothing deeper than rounding, which begins with the last bit of the
/// polygon's size and grows, since files are written with any number of digits. Where something is near,
/// the polygon may be folded onto itself, and the winding number tells what is inside. So areas go wrong
/// by no more than the rounding of the corners times the outline's length.
pub(super) struct EarClipper<'a> {
    flat: &'a [DVec2],
    outline: Outline<'a>,
    /// All corners by x: most of them are to the left or right of an ear.
    by_x: Vec<(DVec2, usize)>,
    /// The larger side of the box around the polygon.
    size: f64,
}

/// What spoils an ear.
#[derive(Clone, Copy)]
struct Rule {
    /// A corner that is nearer than rounding.
    near: bool,
    /// An edge that enters it deeper than this.
    depth: f64,
}

impl<'a> EarClipper<'a> {
    pub(super) fn new(flat: &'a [DVec2]) -> Self {
        let mut by_x: Vec<(DVec2, usize)> = flat.iter().copied().zip(0..).collect();
        by_x.sort_by(|(p, _), (q, _)| p.x.total_cmp(&q.x));
        let (min, max) =
            flat.iter().fold((flat[0], flat[0]), |(min, max), &p| (min.min(p), max.max(p)));
        Self { flat, outline: Outline::new(flat), by_x, size: (max - min).max_element() }
    }

    pub(super) fn clip(mut self, triangles: &mut Vec<[u32; 3]>) {
        let mut left = self.flat.len();
        let strict = [true, false].map(|near| Rule { near, depth: 0.0 });
        let depths = std::iter::successors(Some(f64::EPSILON), |depth| Some(16.0 * depth));
        let lenient = depths.take_while(|&depth| depth < ROUNDING);
        let lenient = lenient.map(|depth| Rule { near: false, depth: depth * self.size });
        let rules: Vec<Rule> = strict.into_iter().chain(lenient).collect();
        for rule in rules {
            // Cutting an ear can make ears of its two neighbours, and of no other corner.
            let mut candidates: VecDeque<usize> = self.outline.corners().collect();
            let mut deferred = None;
            while left > 3
                && let Some(corner) = candidates.pop_front()
            {
                if self.outline.lacks(corner) || deferred == Some(corner) {
                    continue;
                }
                deferred = None;
                if !self.is_ear(corner, rule) {
                    continue;
                }
                let [a, _, c] = self.cut(corner, triangles);
                left -= 1;
                candidates.extend([a, c]);
                // Corner after corner would make a fan, whose ears grow as wide as the polygon. This one stands
                // in the list once more, behind its neighbour.
                deferred = Some(c);
            }
        }
        // One triangle is left, or a polygon that crosses itself.
        let corner = self.outline.corners().next().unwrap_or_default();
        for _ in 2..left {
            self.cut(self.outline.after(corner), triangles);
        }
    }

    fn triangle(&self, corner: usize) -> [usize; 3] {
        [self.outline.before(corner), corner, self.outline.after(corner)]
    }

    /// Cuts off a corner and returns its triangle.
    fn cut(&mut self, corner: usize, triangles: &mut Vec<[u32; 3]>) -> [usize; 3] {
        let triangle = self.triangle(corner);
        triangles.push(triangle.map(|i| i as u32));
        self.outline.remove(corner);
        triangle
    }

    fn is_ear(&self, corner: usize, rule: Rule) -> bool {
        let triangle = self.triangle(corner);
        let ear = Ear::new(triangle.map(|i| self.flat[i]));
        let thin = rule.depth * ear.sides.iter().sum::<f64>();
        if ear.twice_area.abs() <= thin {
            return true;
        } else if ear.twice_area < 0.0 {
            return false;
        }
        // An edge that enters an ear ends in it or, by rounding, just outside.
        let margin = ROUNDING * self.size;
        let (min, max) = (ear.min - margin, ear.max + margin);
        let start = self.by_x.partition_point(|(p, _)| p.x < min.x);
        let mut is_near = false;
        for &(p, i) in self.by_x[start..].iter().take_while(|(p, _)| p.x <= max.x) {
            if p.y < min.y || p.y > max.y || self.outline.lacks(i) || i == corner {
                continue;
            }
            is_near |= !triangle.contains(&i) && ear.is_near(p, margin);
            let enters = |&end: &usize| ear.is_entered(p, self.flat[end], rule.depth);
            if (is_near && rule.near)
                || [self.outline.before(i), self.outline.after(i)].iter().any(enters)
            {
                return false;
            }
        }
        !is_near || self.outline.winding_number(ear.middle()) == 1
    }
}

/// The triangle of a corner and its neighbours.
struct Ear {
    corners: [DVec2; 3],
    min: DVec2,
    max: DVec2,
    /// Negative where the corner is reflex.
    twice_area: f64,
    /// From each corner to the next.
    sides: [f64; 3],
}

impl Ear {
    fn new(corners: [DVec2; 3]) -> Self {
        let [a, b, c] = corners;
        Self {
            corners,
            min: a.min(b).min(c),
            max: a.max(b).max(c),
            twice_area: cross(a, b, c),
            sides: [a.distance(b), b.distance(c), c.distance(a)],
        }
    }

    /// The point that is furthest from all sides: the centre of the inscribed circle.
    fn middle(&self) -> DVec2 {
        let [a, b, c] = self.corners;
        let [ab, bc, ca] = self.sides;
        a + (ca * (b - a) + ab * (c - a)) / (ab + bc + ca)
    }

    /// How far a point is to the left of each side, times that side.
    fn inside(&self, p: DVec2) -> [f64; 3] {
        let [a, b, c] = self.corners;
        [cross(a, b, p), cross(b, c, p), cross(c, a, p)]
    }

    /// Whether a point is inside, or outside by no more than `margin`.
    fn is_near(&self, p: DVec2, margin: f64) -> bool {
        self.inside(p).iter().zip(self.sides).all(|(&inside, side)| inside >= -margin * side)
    }

    /// Whether the segment from `p` to `q` has a point that is further than `depth` from all sides.
    fn is_entered(&self, p: DVec2, q: DVec2, depth: f64) -> bool {
        let (from, to) = (self.inside(p), self.inside(q));
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        for side in 0..3 {
            let [s, t] = [from, to].map(|inside| inside[side] - depth * self.sides[side]);
            if s <= 0.0 && t <= 0.0 {
                return false;
            }
            if s < 0.0 {
                low = low.max(s / (s - t));
            } else if t < 0.0 {
                high = high.min(s / (s - t));
            }
        }
        low < high
    }
}
