use smallvec::SmallVec;

/// A node still to be visited: the parameter at which the ray enters it, at least 0, in the upper half
/// and its index in the lower one. Such numbers are ordered near to far.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Entered(u64);

impl Entered {
    #[inline(always)]
    pub(crate) fn new(near: f32, node: u32) -> Self {
        Self(u64::from(near.to_bits()) << 32 | u64::from(node))
    }

    fn near(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    fn node(self) -> usize {
        self.0 as u32 as usize
    }
}

/// The nodes still to be visited. A tree that needs more than 64 is rare and pays for an allocation.
#[derive(Default)]
pub(crate) struct Pending(SmallVec<[Entered; 64]>);

impl Pending {
    /// The node to visit next: the nearest of those just entered, or, if there are none, the last of
    /// the others that is not entirely behind the closest hit, at `max`.
    #[inline(always)]
    pub(crate) fn next(
        &mut self,
        mut entered: impl Iterator<Item = Entered>,
        max: f32,
    ) -> Option<usize> {
        let Some(mut nearest) = entered.next() else { return self.pop(max) };
        for other in entered {
            self.0.push(nearest.max(other));
            nearest = nearest.min(other);
        }
        Some(nearest.node())
    }

    #[inline(always)]
    fn pop(&mut self, max: f32) -> Option<usize> {
        loop {
            let last = self.0.pop()?;
            if last.near() <= max {
                return Some(last.node());
            }
        }
    }
}

/// The set bits of a mask of `N` lanes.
pub(crate) struct Lanes<const N: usize>(pub(crate) u32);

impl<const N: usize> Iterator for Lanes<N> {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize % N;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}
