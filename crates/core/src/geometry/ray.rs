use glam::DVec3;

/// A half-line: the points `origin + t · direction`, t > 0.
///
/// `direction` need not be a unit vector; a hit parameter `t` is in units of its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray<V = DVec3> {
    /// The point where the ray starts.
    pub origin: V,
    /// The direction of travel.
    pub direction: V,
}

impl<V> Ray<V> {
    /// The ray from `origin` towards `direction`.
    #[inline]
    pub const fn new(origin: V, direction: V) -> Self {
        Self { origin, direction }
    }
}

impl Ray {
    /// The point `origin + t · direction`.
    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }

    /// The ray of the same direction that starts `by` farther on.
    #[inline]
    #[must_use]
    pub fn shifted(&self, by: DVec3) -> Self {
        Self::new(self.origin + by, self.direction)
    }
}

/// The open interval of ray parameters in which a hit counts: `min < t < max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Hits at or before this parameter are ignored.
    pub min: f64,
    /// Hits at or beyond this parameter are ignored.
    pub max: f64,
}

impl Interval {
    /// Everything in front of the origin.
    pub const POSITIVE: Self = Self { min: 0.0, max: f64::INFINITY };

    /// Everything in front of the origin and before `max`.
    #[inline]
    pub const fn up_to(max: f64) -> Self {
        Self { min: 0.0, max }
    }
}
