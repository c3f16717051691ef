use glam::{Vec3A, Vec4};
use lancer_core::scene::PrimitiveId;

use crate::four_boxes::FrameBox;

/// What is divided between nodes: a primitive, or a part of one, and the box around it.
///
/// The id stands where a box of three coordinates leaves room, so that an item is half a cache line.
#[derive(Clone, Copy)]
pub(super) struct Item {
    /// The box's smallest coordinates, and the id.
    low: Vec4,
    /// The box's largest coordinates, and nothing.
    high: Vec4,
}

/// Ids are kept as numbers that are not denormal, since they are computed with, in vain, beside coordinates.
const TAG: u32 = 1 << 30;

impl Item {
    /// # Panics
    /// If the id is 2³⁰ or more.
    pub(super) fn new(bounds: FrameBox, primitive: PrimitiveId) -> Self {
        assert!(primitive.0 < TAG, "a tree takes no more than 2³⁰ primitives");
        let id = f32::from_bits(TAG | primitive.0);
        Self { low: bounds.min.extend(id), high: bounds.max.extend(1.0) }
    }

    #[inline(always)]
    pub(super) fn bounds(&self) -> FrameBox {
        FrameBox { min: Vec3A::from_vec4(self.low), max: Vec3A::from_vec4(self.high) }
    }

    #[inline(always)]
    pub(super) fn primitive(&self) -> PrimitiveId {
        PrimitiveId(self.low.w.to_bits() ^ TAG)
    }

    /// The same primitive with another box.
    pub(super) fn with(&self, bounds: FrameBox) -> Self {
        Self { low: bounds.min.extend(self.low.w), high: bounds.max.extend(1.0) }
    }

    /// Twice the centre of the box: only comparisons are made with it.
    #[inline(always)]
    pub(super) fn center(&self) -> Vec3A {
        Vec3A::from_vec4(self.low + self.high)
    }
}

/// A box of half a unit around each point.
#[cfg(test)]
pub(super) fn items(centers: impl IntoIterator<Item = Vec3A>) -> Vec<Item> {
    let around = |center| FrameBox { min: center - 0.25, max: center + 0.25 };
    let item = |(id, center)| Item::new(around(center), PrimitiveId(id));
    (0..).zip(centers).map(item).collect()
}
