//! Cuts between primitives: those that the surface area heuristic compares.

use glam::Vec3A;
use smallvec::SmallVec;

use super::item::Item;
use crate::four_boxes::FrameBox;

/// Bins along an axis. Twice as many lower the cost of a tree by less than 1 %.
pub(super) const BINS: usize = 16;

fn around_centers(items: &[Item]) -> FrameBox {
    items.iter().fold(FrameBox::EMPTY, |bounds, item| {
        let center = item.center();
        bounds.union(FrameBox { min: center, max: center })
    })
}

/// The most items that are sorted along each axis, to compare all cuts: that is quicker than bins, most of
/// which would be empty.
pub(super) const FEW: usize = BINS;

/// A cut of a few items into the first ones of an order and the others.
pub(super) struct OrderCut {
    /// Indices of the items.
    order: [u8; FEW],
    pub(super) parts: Parts,
}

impl OrderCut {
    /// The cheapest: between neighbours in the order of centres along an axis, where centres coincide of ids.
    #[inline(never)] // As `BinCut::best`.
    pub(super) fn best(items: &[Item]) -> Self {
        let mut best: Option<Self> = None;
        // Two are cut between them whatever the axis.
        for axis in 0..if items.len() == 2 { 1 } else { 3 } {
            // The centres' bits are ordered as integers like the numbers, or the opposite way if negative.
            let mut keys = [(u64::MAX, 0); FEW];
            for ((k, item), key) in (0..).zip(items).zip(&mut keys) {
                let bits = item.center()[axis].to_bits();
                let rising = if bits >> 31 == 0 { bits | 1 << 31 } else { !bits };
                *key = (u64::from(rising) << 32 | u64::from(item.primitive().0), k);
            }
            keys[..items.len()].sort_unstable_by_key(|&(key, _)| key);
            let order = keys.map(|(_, k)| k);
            let mut contents = [Content::NONE; FEW];
            for (content, &k) in contents.iter_mut().zip(&order[..items.len()]) {
                *content = Content { bounds: items[usize::from(k)].bounds(), count: 1 };
            }
            if let Some((_, parts)) = cheapest_cut(&contents[..items.len()])
                && best.as_ref().is_none_or(|best| parts.cost < best.parts.cost)
            {
                best = Some(Self { order, parts });
            }
        }
        best.expect("two items can be told apart by their ids")
    }

    /// Puts the items into this order.
    pub(super) fn sort(&self, items: &mut [Item]) {
        let mut sorted: SmallVec<[Item; FEW]> = SmallVec::new();
        sorted.extend(self.order[..items.len()].iter().map(|&k| items[usize::from(k)]));
        items.copy_from_slice(&sorted);
    }
}

/// Bins of equal width along the three axes of the box around the centres, and bins of sizes: a floor under a
/// teapot has its centre among the teapot's, and would make every box on the way down as large as itself.
#[derive(Clone, Copy)]
struct Bins {
    start: Vec3A,
    per_unit: Vec3A,
    /// The longest side of the box around the centres.
    extent: f32,
}

/// What items are thrown into bins by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Order {
    /// The places of their centres along an axis.
    Axis(usize),
    /// Their sizes, large ones first.
    Size,
}

/// Nodes of fewer items are not divided by size.
const FEWEST_BY_SIZE: usize = 64;

impl Bins {
    fn around(centers: FrameBox) -> Self {
        let width = centers.max - centers.min;
        // Where all centres coincide all are in bin 0.
        let per_unit = Vec3A::splat(BINS as f32) / width.max(Vec3A::splat(f32::MIN_POSITIVE));
        Self { start: centers.min, per_unit, extent: width.max_element() }
    }

    /// An item's bin by its size: half as large is one bin further.
    #[inline(always)]
    fn of_size(&self, item: &Item) -> usize {
        // Centres are doubled, sides are not.
        let size = 2.0 * (item.bounds().max - item.bounds().min).max_element();
        let halvings = self.extent.to_bits().saturating_sub(size.to_bits()) >> 23;
        (halvings as usize).min(BINS - 1)
    }

    /// An item's bin on each axis.
    #[inline(always)]
    fn of_place(&self, item: &Item) -> [usize; 3] {
        let position = (item.center() - self.start) * self.per_unit;
        // The last centre is at the far end of the last bin.
        position.min(Vec3A::splat(BINS as f32 - 1.0)).to_array().map(|x| usize::from(x as u8))
    }
}

/// What lies in a bin, or in several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Content {
    pub(super) bounds: FrameBox,
    pub(super) count: u32,
}

impl Content {
    pub(super) const NONE: Self = Self { bounds: FrameBox::EMPTY, count: 0 };

    #[inline(always)]
    pub(super) fn and(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), count: self.count + other.count }
    }

    /// Area times primitives.
    #[inline(always)]
    pub(super) fn cost(&self) -> f32 {
        self.bounds.half_area() * self.count as f32
    }
}

/// What is left and right of a cut, and what both cost together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Parts {
    pub(super) left: Content,
    pub(super) right: Content,
    pub(super) cost: f32,
}

impl Parts {
    #[inline(always)]
    pub(super) fn new(left: Content, right: Content) -> Self {
        Self { left, right, cost: left.cost() + right.cost() }
    }
}

/// A cut between two bins.
pub(super) struct BinCut {
    bins: Bins,
    order: Order,
    /// The last bin on the left side.
    last: usize,
    pub(super) parts: Parts,
}

impl BinCut {
    /// Puts the items of the left side before the others.
    pub(super) fn partition(&self, items: &mut [Item]) {
        let Self { bins, last, .. } = self;
        match self.order {
            Order::Size => partition(items, |item| bins.of_size(item) <= *last),
            Order::Axis(axis) => {
                let (start, per_unit) = (bins.start[axis], bins.per_unit[axis]);
                let end = (last + 1) as f32;
                partition(items, |item| (item.center()[axis] - start) * per_unit < end);
            }
        }
    }

    /// The cheapest cut between bins with items on both sides; there is none if all centres coincide. One by size must
    /// cost less than the share `by_size` of the best one by place.
    #[inline(never)] // The bins must not take room on the stack of the recursion.
    pub(super) fn best(items: &[Item], by_size: f32) -> Option<Self> {
        let bins = Bins::around(around_centers(items));
        let (mut by_place, mut of_sizes) = ([[Content::NONE; BINS]; 3], [Content::NONE; BINS]);
        for item in items {
            for (contents, index) in by_place.iter_mut().zip(bins.of_place(item)) {
                contents[index] = contents[index].and(Content { bounds: item.bounds(), count: 1 });
            }
        }
        if items.len() >= FEWEST_BY_SIZE {
            for item in items {
                let content = &mut of_sizes[bins.of_size(item)];
                *content = content.and(Content { bounds: item.bounds(), count: 1 });
            }
        }
        let mut best: Option<Self> = None;
        let axes = (0..3).map(|axis| (Order::Axis(axis), &by_place[axis]));
        for (order, contents) in axes.chain([(Order::Size, &of_sizes)]) {
            let share = if order == Order::Size { by_size } else { 1.0 };
            if let Some((last, parts)) = cheapest_cut(contents)
                && best.as_ref().is_none_or(|best| parts.cost < share * best.parts.cost)
            {
                best = Some(Self { bins, order, last, parts });
            }
        }
        best
    }
}

/// Puts the items that are on the left before the others.
#[inline(always)]
fn partition(items: &mut [Item], is_left: impl Fn(&Item) -> bool) {
    let mut left = 0;
    for k in 0..items.len() {
        if is_left(&items[k]) {
            items.swap(left, k);
            left += 1;
        }
    }
}

/// The last of the contents before the cheapest cut with items on both sides, and the parts.
#[inline(always)]
fn cheapest_cut(contents: &[Content]) -> Option<(usize, Parts)> {
    let mut right_of = [Content::NONE; BINS];
    for k in (1..contents.len()).rev() {
        right_of[k - 1] = right_of[k].and(contents[k]);
    }
    let mut best: Option<(usize, Parts)> = None;
    let mut left = Content::NONE;
    for (last, (&content, right)) in contents.iter().zip(&right_of).enumerate() {
        left = left.and(content);
        if left.count == 0 || right.count == 0 {
            continue;
        }
        let parts = Parts::new(left, *right);
        if best.is_none_or(|(_, best)| parts.cost < best.cost) {
            best = Some((last, parts));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use lancer_core::scene::PrimitiveId;

    use super::*;
    use crate::bvh::item::items;

    /// By hand: cubes of side 1/2 stand at x = 0, 1 and 8. A cut before the last leaves a box of sides
    /// 3/2, 1/2, 1/2 and a cube, of half areas 7/4 and 3/4: 2 · 7/4 + 3/4.
    #[test]
    fn the_heuristic_cuts_where_there_is_nothing() {
        let mut row = items([8.0, 0.0, 1.0].map(|x| Vec3A::new(x, 0.0, 0.0)));
        let cut = BinCut::best(&row, 1.0).unwrap();
        assert_eq!((cut.order, cut.parts.cost), (Order::Axis(0), 4.25));
        cut.partition(&mut row);
        assert_eq!((cut.parts.left.count, row[2].primitive()), (2, PrimitiveId(0)));
        assert!(BinCut::best(&items([Vec3A::ONE; 3]), 1.0).is_none());
    }

    /// The same row, all cuts compared; and of boxes in one place the one with the least id is cut off.
    #[test]
    fn few_items_are_cut_at_the_best_place() {
        let mut row = items([0.0, 8.0, -1.0].map(|y| Vec3A::new(0.0, y, 0.0)));
        let cut = OrderCut::best(&row);
        cut.sort(&mut row);
        assert_eq!((cut.parts.cost, cut.parts.left.count), (4.25, 2));
        assert_eq!([2, 0, 1].map(PrimitiveId), [0, 1, 2].map(|k| row[k].primitive()));
        let mut alike = items([Vec3A::ONE; 3]);
        alike.reverse();
        let cut = OrderCut::best(&alike);
        cut.sort(&mut alike);
        assert_eq!((cut.parts.cost, cut.parts.left.count), (2.25, 1));
        assert_eq!(alike[0].primitive(), PrimitiveId(0));
    }
}
