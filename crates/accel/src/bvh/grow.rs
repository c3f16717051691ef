use glam::Vec3A;
use lancer_core::scene::PrimitiveId;
use smallvec::SmallVec;

use super::{Item, Split};
use crate::binary_tree::{TreeNode, TreeStatistics};
use crate::four_boxes::FrameBox;

/// What a node's two box tests cost, in primitive tests.
const NODE_COST: f32 = 1.0;
/// Nodes with more primitives are always divided: so a leaf of boxes that overlap all the same does
/// not have all of them.
pub(super) const MAX_LEAF: usize = 4;
/// Bins along an axis. Twice as many lower the cost of a tree by less than 1 %.
const BINS: usize = 16;
/// The depth at which the heuristic is given up and nodes are halved, which ends within log2 of 2³²
/// further levels: no arrangement of primitives makes the recursion deeper than [`MAX_DEPTH`].
const SAH_DEPTH: usize = 64;
pub(crate) const MAX_DEPTH: usize = SAH_DEPTH + 32;
/// Subtrees of fewer primitives are not worth a task of their own.
const TASK: usize = 4096;

/// What a tree is to be like.
#[derive(Clone, Copy)]
pub(super) struct Rule {
    /// How nodes are divided.
    pub(super) split: Split,
    /// Primitives of a leaf at most.
    pub(super) max_leaf: usize,
}

/// Sorts the items into leaves and returns the nodes above them.
pub(super) fn tree(items: &mut [Item], rule: Rule) -> Vec<TreeNode> {
    if items.is_empty() { Vec::new() } else { subtree(items, 0, 0, rule) }
}

pub(super) fn check_depth(statistics: &TreeStatistics) -> Result<(), String> {
    let depth = statistics.depth;
    if depth > MAX_DEPTH { Err(format!("{depth} levels")) } else { Ok(()) }
}

const UNKNOWN: TreeNode = TreeNode { bounds: FrameBox::EMPTY, first: 0, count: 0 };

/// The nodes of a subtree, its root first. `first` is where its items stand among all.
fn subtree(items: &mut [Item], first: u32, depth: usize, rule: Rule) -> Vec<TreeNode> {
    let mut nodes = vec![UNKNOWN];
    grow(&mut nodes, 0, items, first, depth, rule);
    nodes
}

/// Makes a node of some items, and what is below it.
fn grow(
    nodes: &mut Vec<TreeNode>,
    node: usize,
    items: &mut [Item],
    first: u32,
    depth: usize,
    rule: Rule,
) {
    let bounds = items.iter().fold(FrameBox::EMPTY, |bounds, item| bounds.union(item.bounds));
    let Some(middle) = divide(items, bounds, depth, rule) else {
        nodes[node] = TreeNode { bounds, first, count: items.len() as u32 };
        return;
    };
    let left = nodes.len();
    let right = left + 1;
    nodes[node] = TreeNode { bounds, first: left as u32, count: 0 };
    nodes.extend([UNKNOWN; 2]);
    let parallel = items.len() >= TASK;
    let (lefts, rights) = items.split_at_mut(middle);
    let (first, second, depth) = (first, first + middle as u32, depth + 1);
    if parallel {
        let (below_left, below_right) = rayon::join(
            || subtree(lefts, first, depth, rule),
            || subtree(rights, second, depth, rule),
        );
        graft(nodes, left, below_left);
        graft(nodes, right, below_right);
    } else {
        grow(nodes, left, lefts, first, depth, rule);
        grow(nodes, right, rights, second, depth, rule);
    }
}

/// Puts a subtree's root in its place and the rest at the end.
fn graft(nodes: &mut Vec<TreeNode>, place: usize, subtree: Vec<TreeNode>) {
    let shift = nodes.len() as u32 - 1;
    let mut moved = subtree.into_iter().map(|node| TreeNode {
        first: if node.is_leaf() { node.first } else { node.first + shift },
        ..node
    });
    nodes[place] = moved.next().expect("a subtree has a root");
    nodes.extend(moved);
}

/// Sorts a node's items into those of its left child and those of its right one, and returns how many
/// are left, if it is to have children.
fn divide(items: &mut [Item], bounds: FrameBox, depth: usize, rule: Rule) -> Option<usize> {
    let too_many = items.len() > rule.max_leaf;
    if items.len() == 1 || (rule.split == Split::Median && !too_many) {
        return None;
    }
    if rule.split == Split::Median || depth >= SAH_DEPTH {
        return too_many.then(|| halve(items));
    }
    let area = bounds.half_area();
    let pays = |cost: f32| NODE_COST * area + cost < area * items.len() as f32;
    if items.len() <= FEW {
        let cut = Cut::best(items);
        return (too_many || pays(cut.cost)).then(|| cut.sort(items));
    }
    let Some(cut) = best_bin_cut(items) else { return too_many.then(|| halve(items)) };
    (too_many || pays(cut.cost)).then(|| cut.partition(items))
}

fn halve(items: &mut [Item]) -> usize {
    split_at_median(items, |item| (item.center(), item.primitive))
}

/// The object median: sorts the lower half, by the longest axis of the box around the centres, to the
/// front, and returns how many that are, of an odd number the smaller part. Where centres coincide the
/// smaller id is lower.
#[inline]
pub fn split_at_median<T>(items: &mut [T], key: impl Fn(&T) -> (Vec3A, PrimitiveId)) -> usize {
    let middle = items.len() / 2;
    let around = |(min, max): (Vec3A, Vec3A), item| {
        let (center, _) = key(item);
        (min.min(center), max.max(center))
    };
    let (min, max) = items.iter().fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), around);
    let axis = (max - min).max_position();
    items.select_nth_unstable_by(middle, |a, b| {
        let ((a, a_id), (b, b_id)) = (key(a), key(b));
        a[axis].total_cmp(&b[axis]).then(a_id.cmp(&b_id))
    });
    middle
}

fn around_centers(items: &[Item]) -> FrameBox {
    items.iter().fold(FrameBox::EMPTY, |bounds, item| {
        let center = item.center();
        bounds.union(FrameBox { min: center, max: center })
    })
}

/// The most items that are sorted along each axis, to compare all cuts: that is quicker than bins, most of
/// which would be empty.
const FEW: usize = BINS;

/// A cut of a few items into the `left` first ones of an order and the others.
struct Cut {
    /// Indices of the items.
    order: [u8; FEW],
    left: usize,
    cost: f32,
}

impl Cut {
    /// The cheapest: between neighbours in the order of centres along an axis, where centres coincide of ids.
    #[inline(never)] // As `best_bin_cut`.
    fn best(items: &[Item]) -> Self {
        let mut best = Self {
            order: std::array::from_fn(|k| k as u8),
            left: items.len() / 2,
            cost: f32::INFINITY,
        };
        // Two are cut between them whatever the axis.
        for axis in 0..if items.len() == 2 { 1 } else { 3 } {
            // The centres' bits are ordered as integers like the numbers, or the opposite way if negative.
            let mut keys = [(u64::MAX, 0); FEW];
            for ((k, item), key) in (0..).zip(items).zip(&mut keys) {
                let bits = item.center()[axis].to_bits();
                let rising = if bits >> 31 == 0 { bits | 1 << 31 } else { !bits };
                *key = (u64::from(rising) << 32 | u64::from(item.primitive.0), k);
            }
            keys[..items.len()].sort_unstable_by_key(|&(key, _)| key);
            let order = keys.map(|(_, k)| k);
            let mut contents = [Content::NONE; FEW];
            for (content, &k) in contents.iter_mut().zip(&order[..items.len()]) {
                *content = Content { bounds: items[usize::from(k)].bounds, count: 1 };
            }
            if let Some((last, cost)) = cheapest_cut(&contents[..items.len()])
                && cost < best.cost
            {
                best = Self { order, left: last + 1, cost };
            }
        }
        best
    }

    /// Puts the items into this order, and returns how many are left.
    fn sort(&self, items: &mut [Item]) -> usize {
        let mut sorted: SmallVec<[Item; FEW]> = SmallVec::new();
        sorted.extend(self.order[..items.len()].iter().map(|&k| items[usize::from(k)]));
        items.copy_from_slice(&sorted);
        self.left
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
        let size = 2.0 * (item.bounds.max - item.bounds.min).max_element();
        let halvings = self.extent.to_bits().saturating_sub(size.to_bits()) >> 23;
        (halvings as usize).min(BINS - 1)
    }

    /// An item's bin in one of the orders.
    #[inline(always)]
    fn of(&self, item: &Item, order: Order) -> usize {
        match order {
            Order::Axis(axis) => self.of_place(item)[axis],
            Order::Size => self.of_size(item),
        }
    }

    /// An item's bin on each axis.
    #[inline(always)]
    fn of_place(&self, item: &Item) -> [usize; 3] {
        let position = (item.center() - self.start) * self.per_unit;
        // The last centre is at the far end of the last bin.
        position.min(Vec3A::splat(BINS as f32 - 1.0)).to_array().map(|x| x as usize)
    }
}

/// What lies in a bin, or in several.
#[derive(Clone, Copy)]
struct Content {
    bounds: FrameBox,
    count: u32,
}

impl Content {
    const NONE: Self = Self { bounds: FrameBox::EMPTY, count: 0 };

    fn and(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), count: self.count + other.count }
    }

    /// Area times primitives.
    fn cost(&self) -> f32 {
        self.bounds.half_area() * self.count as f32
    }
}

/// A cut between two bins, and what the primitives on its sides cost.
struct BinCut {
    bins: Bins,
    order: Order,
    /// The last bin on the left side.
    last: usize,
    cost: f32,
}

impl BinCut {
    fn partition(&self, items: &mut [Item]) -> usize {
        let mut left = 0;
        for k in 0..items.len() {
            if self.bins.of(&items[k], self.order) <= self.last {
                items.swap(left, k);
                left += 1;
            }
        }
        left
    }
}

/// The last of the contents before the cheapest cut with items on both sides, and its cost.
#[inline(always)]
fn cheapest_cut(contents: &[Content]) -> Option<(usize, f32)> {
    let mut right_of = [Content::NONE; BINS];
    for k in (1..contents.len()).rev() {
        right_of[k - 1] = right_of[k].and(contents[k]);
    }
    let mut best: Option<(usize, f32)> = None;
    let mut left = Content::NONE;
    for (last, (&content, right)) in contents.iter().zip(&right_of).enumerate() {
        left = left.and(content);
        if left.count == 0 || right.count == 0 {
            continue;
        }
        let cost = left.cost() + right.cost();
        if best.is_none_or(|best| cost < best.1) {
            best = Some((last, cost));
        }
    }
    best
}

/// The cheapest cut between bins with items on both sides; there is none if all centres coincide.
#[inline(never)] // The bins must not take room on the stack of the recursion.
fn best_bin_cut(items: &[Item]) -> Option<BinCut> {
    let bins = Bins::around(around_centers(items));
    let (mut by_place, mut by_size) = ([[Content::NONE; BINS]; 3], [Content::NONE; BINS]);
    for item in items {
        for (contents, index) in by_place.iter_mut().zip(bins.of_place(item)) {
            contents[index] = contents[index].and(Content { bounds: item.bounds, count: 1 });
        }
    }
    if items.len() >= FEWEST_BY_SIZE {
        for item in items {
            let content = &mut by_size[bins.of_size(item)];
            *content = content.and(Content { bounds: item.bounds, count: 1 });
        }
    }
    let mut best: Option<BinCut> = None;
    let axes = (0..3).map(|axis| (Order::Axis(axis), &by_place[axis]));
    for (order, contents) in axes.chain([(Order::Size, &by_size)]) {
        if let Some((last, cost)) = cheapest_cut(contents)
            && best.as_ref().is_none_or(|best| cost < best.cost)
        {
            best = Some(BinCut { bins, order, last, cost });
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULE: Rule = Rule { split: Split::Sah, max_leaf: MAX_LEAF };

    /// A box of half a unit around each point.
    fn items(centers: impl IntoIterator<Item = Vec3A>) -> Vec<Item> {
        let around = |center| FrameBox { min: center - 0.25, max: center + 0.25 };
        let item = |(id, center)| Item { bounds: around(center), primitive: PrimitiveId(id) };
        (0..).zip(centers).map(item).collect()
    }

    fn depth(nodes: &[TreeNode], node: usize) -> usize {
        let node = &nodes[node];
        if node.is_leaf() {
            return 0;
        }
        let below = node.children().map(|child| depth(nodes, child));
        1 + below[0].max(below[1])
    }

    #[test]
    fn the_median_leaves_as_many_on_both_sides() {
        let mut row = items([5.0, 1.0, 3.0, 0.0, 4.0, 2.0].map(|x| Vec3A::new(0.0, x, 0.5 * x)));
        assert_eq!(halve(&mut row), 3);
        assert!(row[..3].iter().all(|item| item.center().y < 5.0));
        // Where centres coincide ids decide.
        let mut alike = items([Vec3A::ONE; 5]);
        alike.reverse();
        assert_eq!(halve(&mut alike), 2);
        assert!(alike[..2].iter().all(|item| item.primitive < PrimitiveId(2)));
    }

    /// By hand: cubes of side 1/2 stand at x = 0, 1 and 8. A cut before the last leaves a box of sides
    /// 3/2, 1/2, 1/2 and a cube, of half areas 7/4 and 3/4: 2 · 7/4 + 3/4.
    #[test]
    fn the_heuristic_cuts_where_there_is_nothing() {
        let mut row = items([8.0, 0.0, 1.0].map(|x| Vec3A::new(x, 0.0, 0.0)));
        let cut = best_bin_cut(&row).unwrap();
        assert_eq!((cut.order, cut.cost), (Order::Axis(0), 4.25));
        assert_eq!(cut.partition(&mut row), 2);
        assert_eq!(row[2].primitive, PrimitiveId(0));
        assert!(best_bin_cut(&items([Vec3A::ONE; 3])).is_none());
    }

    /// The same row, all cuts compared; and of boxes in one place the one with the least id is cut off.
    #[test]
    fn few_items_are_cut_at_the_best_place() {
        let mut row = items([0.0, 8.0, -1.0].map(|y| Vec3A::new(0.0, y, 0.0)));
        let cut = Cut::best(&row);
        assert_eq!((cut.cost, cut.sort(&mut row)), (4.25, 2));
        assert_eq!([2, 0, 1].map(PrimitiveId), [0, 1, 2].map(|k| row[k].primitive));
        let mut alike = items([Vec3A::ONE; 3]);
        alike.reverse();
        let cut = Cut::best(&alike);
        assert_eq!((cut.cost, cut.sort(&mut alike)), (2.25, 1));
        assert_eq!(alike[0].primitive, PrimitiveId(0));
    }

    /// Near boxes are cheaper to test than to tell apart; far ones are not.
    #[test]
    fn a_leaf_is_made_where_a_split_does_not_pay() {
        let parts = |distance| {
            let mut pair = items([Vec3A::ZERO, Vec3A::X * distance]);
            let around = pair[0].bounds.union(pair[1].bounds);
            divide(&mut pair, around, 0, RULE)
        };
        // With two cubes of half area 3/4 a split costs A + 3/2, a leaf 2 A, and A = 3/4 + distance.
        assert_eq!((parts(0.5), parts(1.0)), (None, Some(1)));
    }

    /// A subtree is halved at every step beyond the limit: so no tree is deeper than the limit says.
    #[test]
    fn below_the_limit_the_tree_is_halved() {
        // Each step along this row is nine tenths of the last: the heuristic takes off the first few.
        let row = || items((0..1 << 10).map(|k| Vec3A::X * 0.9_f32.powi(k)));
        let balanced = subtree(&mut row(), 0, SAH_DEPTH, RULE);
        assert_eq!(depth(&balanced, 0), 8);
        assert!(depth(&tree(&mut row(), RULE), 0) > 8);
    }
}
