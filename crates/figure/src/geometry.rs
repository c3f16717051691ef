//! Points and rectangles on the canvas: x to the right, y downwards, in canvas px.

/// A point `[x, y]`, in canvas px (or in world units where a function says so).
pub type Point = [f64; 2];

/// An axis-parallel rectangle, in canvas px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// The left edge.
    pub x: f64,
    /// The upper edge.
    pub y: f64,
    /// The extent to the right, at least 0.
    pub width: f64,
    /// The extent downwards, at least 0.
    pub height: f64,
}

impl Rect {
    /// The rectangle whose upper left corner is (`x`, `y`).
    pub const fn new(x: f64, y: f64, width: f64, height: f64) -> Self {
        Self { x, y, width, height }
    }

    /// The rectangle of `width` × `height` around `center`.
    pub fn around(center: Point, width: f64, height: f64) -> Self {
        Self::new(center[0] - width / 2.0, center[1] - height / 2.0, width, height)
    }

    /// The right edge.
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    /// The lower edge.
    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }

    /// The middle.
    pub fn center(&self) -> Point {
        [self.x + self.width / 2.0, self.y + self.height / 2.0]
    }

    /// The rectangle grown by `margin` on every side (shrunk when it is negative).
    pub fn grown(&self, margin: f64) -> Self {
        Self::new(
            self.x - margin,
            self.y - margin,
            (self.width + 2.0 * margin).max(0.0),
            (self.height + 2.0 * margin).max(0.0),
        )
    }

    /// Whether the whole of `other` lies within.
    pub fn contains(&self, other: &Self) -> bool {
        self.x <= other.x
            && self.y <= other.y
            && self.right() >= other.right()
            && self.bottom() >= other.bottom()
    }

    /// Whether the two share more than an edge.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.x < other.right()
            && other.x < self.right()
            && self.y < other.bottom()
            && other.y < self.bottom()
    }

    /// The point of the rectangle nearest to `point`.
    pub(crate) fn nearest(&self, [x, y]: Point) -> Point {
        [x.clamp(self.x, self.right()), y.clamp(self.y, self.bottom())]
    }

    /// The part of the segment from `a` to `b` that lies within, as its two ends.
    pub fn clip(&self, a: Point, b: Point) -> Option<(Point, Point)> {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        let ranges = [(self.x, self.right()), (self.y, self.bottom())];
        for (axis, (low, high)) in ranges.into_iter().enumerate() {
            let run = b[axis] - a[axis];
            if run == 0.0 {
                if a[axis] < low || a[axis] > high {
                    return None;
                }
                continue;
            }
            let (to_low, to_high) = ((low - a[axis]) / run, (high - a[axis]) / run);
            enter = enter.max(to_low.min(to_high));
            leave = leave.min(to_low.max(to_high));
        }
        (enter <= leave).then(|| (along(a, b, enter), along(a, b, leave)))
    }
}

/// The point `part` of the way from `a` to `b`.
pub(crate) fn along(a: Point, b: Point, part: f64) -> Point {
    [a[0] + (b[0] - a[0]) * part, a[1] + (b[1] - a[1]) * part]
}

/// Whether the segments from `a` to `b` and from `c` to `d` have a point in common, but for parallel ones.
pub(crate) fn segments_cross(a: Point, b: Point, c: Point, d: Point) -> bool {
    let side = |p: Point, q: Point, r: Point| {
        (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    };
    side(a, b, c) * side(a, b, d) <= 0.0
        && side(c, d, a) * side(c, d, b) <= 0.0
        && (side(a, b, c) != 0.0 || side(a, b, d) != 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn touching_rectangles_do_not_overlap() {
        let left = Rect::new(0.0, 0.0, 10.0, 10.0);
        assert!(!left.overlaps(&Rect::new(10.0, 0.0, 5.0, 10.0)));
        assert!(left.overlaps(&Rect::new(9.9, 9.9, 5.0, 5.0)));
    }

    #[test]
    fn segments_cross_within_both() {
        let cross = |c, d| segments_cross([0.0, 0.0], [10.0, 0.0], c, d);
        assert!(cross([5.0, -1.0], [5.0, 1.0]));
        assert!(cross([10.0, 0.0], [12.0, 5.0]), "touching at the end");
        assert!(!cross([11.0, -1.0], [11.0, 1.0]));
        assert!(!cross([5.0, 1.0], [5.0, 2.0]));
        assert!(!cross([0.0, 1.0], [10.0, 1.0]));
    }

    #[test]
    fn clipping_keeps_the_part_inside() {
        let square = Rect::new(0.0, 0.0, 10.0, 10.0);
        assert_eq!(square.clip([-5.0, 5.0], [15.0, 5.0]), Some(([0.0, 5.0], [10.0, 5.0])));
        assert_eq!(square.clip([-5.0, 11.0], [15.0, 11.0]), None);
        assert_eq!(square.clip([-1.0, 9.5], [0.5, 12.0]), None, "passes the corner outside");
    }
}
