//! One step of the walk: which sides of a plane a ray visits.

use lancer_core::geometry::Interval;

/// A thick ray along one axis. It reaches a plane before its middle does, and leaves it after.
#[derive(Clone, Copy)]
pub(super) struct Thick {
    /// The origin of the side that is ahead.
    ahead: f64,
    /// The origin of the side that is behind.
    behind: f64,
    inverse: f64,
    /// The ray travels towards smaller coordinates.
    pub(super) negative: bool,
}

/// The sides of a plane that a ray visits: *near* is where it comes from, below the plane if it travels
/// towards larger coordinates, +0 among them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sides {
    /// The near one only.
    Near,
    /// The far one only.
    Far,
    /// First the near one, then the far one, and in which part of the ray.
    Both {
        /// Before the plane is left.
        near: Interval,
        /// After it is reached.
        far: Interval,
    },
}

impl Sides {
    /// Divides the part `inside` of a ray by the plane at `split`, given the ray's origin and direction
    /// along the plane's axis: one step of a [`crate::KdTree`]'s walk.
    ///
    /// Both sides are visited by a ray that runs in the plane, or meets it just where the part begins or
    /// ends: what lies in the plane may be on either side.
    pub fn of(split: f64, origin: f64, direction: f64, inside: Interval) -> Self {
        Thick::new(origin, direction, 0.0).divide(split, inside)
    }
}

impl Thick {
    pub(super) fn new(origin: f64, direction: f64, thickness: f64) -> Self {
        let inverse = 1.0 / direction;
        let forward = thickness.copysign(direction);
        Self {
            ahead: origin + forward,
            behind: origin - forward,
            // The overflow of a denormal direction would take a tiny way for a long one.
            inverse: if direction != 0.0 && inverse.is_infinite() { f64::NAN } else { inverse },
            negative: direction.is_sign_negative(),
        }
    }

    /// Which sides of the plane the part `inside` of the ray visits.
    #[inline(always)]
    pub(super) fn divide(&self, split: f64, inside: Interval) -> Sides {
        let [reached, left] = self.cross(split);
        if reached > inside.max {
            return Sides::Near;
        }
        if left < inside.min {
            return Sides::Far;
        }
        let (mut near, mut far) = (inside, inside);
        // A NaN leaves both as they are.
        if left < near.max {
            near.max = left;
        }
        if reached > far.min {
            far.min = reached;
        }
        Sides::Both { near, far }
    }

    /// When the ray reaches the plane and when it leaves it. In a ray parallel to the plane the two are ∞ on one
    /// side, −∞ and ∞ in the plane; NaN, when one of its sides runs in the plane, compares as neither
    /// before nor after anything.
    #[inline(always)]
    pub(super) fn cross(&self, split: f64) -> [f64; 2] {
        [(split - self.ahead) * self.inverse, (split - self.behind) * self.inverse]
    }
}
