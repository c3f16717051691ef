use super::cuts::{BinCut, Content, FEW, OrderCut, Parts};
use super::item::Item;
use super::spatial::Splitter;
use super::{Split, split_at_median};
use crate::binary_tree::{TreeNode, TreeStatistics};
use crate::four_boxes::FrameBox;

/// What a node's two box tests cost, in primitive tests.
const NODE_COST: f32 = 1.0;
/// Nodes with more primitives are always divided: so a leaf of boxes that overlap all the same does
/// not have all of them.
pub(super) const MAX_LEAF: usize = 4;
/// The depth at which the heuristic is given up and nodes are halved, which ends within log2 of 2³²
/// further levels: no arrangement of primitives makes the recursion deeper than [`MAX_DEPTH`].
const SAH_DEPTH: usize = 64;
pub(crate) const MAX_DEPTH: usize = SAH_DEPTH + 32;
/// Subtrees of fewer primitives are not worth a task of their own.
const TASK: usize = 4096;

/// What a tree is to be like.
pub(super) struct Rule<'s> {
    /// How nodes are divided.
    pub(super) split: Split,
    /// Primitives of a leaf at most.
    pub(super) max_leaf: usize,
    /// As many are a leaf even where dividing them pays.
    pub(super) whole_leaf: usize,
    /// The share of the best other cut's cost below which primitives are divided by their sizes.
    pub(super) by_size: f32,
    /// What splits primitives, if they may be.
    pub(super) splitter: Option<Splitter<'s>>,
}

/// Items of a subtree, the first ones of a room in which they may become more.
struct Crowd<'i> {
    room: &'i mut [Item],
    count: usize,
    /// Where the room begins, among all.
    first: u32,
}

/// The nodes below a node, twice as many as its room has places, less two.
struct Below<'n> {
    nodes: &'n mut [TreeNode],
    /// Where they begin, among all.
    first: u32,
}

const UNKNOWN: TreeNode = TreeNode { bounds: FrameBox::EMPTY, first: 0, count: 0 };

/// Sorts the first `count` items into leaves and returns the nodes above them. Below a node stand first its two
/// children, then what is below the left one, then what is below the right one, with gaps where leaves have
/// several items or places are free. Where primitives are split, items fill free places.
pub(super) fn tree(
    room: &mut [Item],
    count: usize,
    bounds: FrameBox,
    rule: &Rule,
) -> Vec<TreeNode> {
    if count == 0 {
        return Vec::new();
    }
    let mut nodes = vec![UNKNOWN; 2 * room.len() - 1];
    let (root, below) = nodes.split_first_mut().expect("a root");
    let crowd = Crowd { room, count, first: 0 };
    grow(root, Below { nodes: below, first: 1 }, crowd, bounds, 0, rule);
    nodes
}

pub(super) fn check_depth(statistics: &TreeStatistics) -> Result<(), String> {
    let depth = statistics.depth;
    if depth > MAX_DEPTH { Err(format!("{depth} levels")) } else { Ok(()) }
}

fn around(items: &[Item]) -> FrameBox {
    items.iter().fold(FrameBox::EMPTY, |bounds, item| bounds.union(item.bounds()))
}

/// Makes a node of some items, and what is below it.
fn grow(
    node: &mut TreeNode,
    below: Below,
    crowd: Crowd,
    bounds: FrameBox,
    depth: usize,
    rule: &Rule,
) {
    let Crowd { room, count, first } = crowd;
    let Some([left, right]) = divide(room, count, bounds, depth, rule) else {
        *node = TreeNode { bounds, first, count: count as u32 };
        return;
    };
    *node = TreeNode { bounds, first: below.first, count: 0 };
    let [left_count, right_count] = [left.count as usize, right.count as usize];
    let middle = share(room, left_count, right_count);
    let (lefts, rights) = room.split_at_mut(middle);
    let (children, nodes) = below.nodes.split_at_mut(2);
    let [left_node, right_node] = children else { unreachable!("two children") };
    let (below_left, below_right) = nodes.split_at_mut(2 * middle - 2);
    let below_left = Below { nodes: below_left, first: below.first + 2 };
    let below_right = Below { nodes: below_right, first: below.first + 2 * middle as u32 };
    let lefts = Crowd { room: lefts, count: left_count, first };
    let rights = Crowd { room: rights, count: right_count, first: first + middle as u32 };
    let depth = depth + 1;
    let grow_left = || grow(left_node, below_left, lefts, left.bounds, depth, rule);
    let grow_right = || grow(right_node, below_right, rights, right.bounds, depth, rule);
    if count >= TASK {
        rayon::join(grow_left, grow_right);
    } else {
        grow_left();
        grow_right();
    }
}

/// Shares the free places at the end of a room between two parts, in proportion to their items, and moves the
/// second part to its place, which is returned.
fn share(room: &mut [Item], left: usize, right: usize) -> usize {
    let free = room.len() - left - right;
    let to_left = (free as u64 * left as u64 / (left + right) as u64) as usize;
    // Their order among each other is of no importance.
    let moved = to_left.min(right);
    room.copy_within(left..left + moved, left + to_left + right - moved);
    left + to_left
}

/// Sorts a node's items into those of its left child and those of its right one, if it is to have children.
fn divide(
    room: &mut [Item],
    count: usize,
    bounds: FrameBox,
    depth: usize,
    rule: &Rule,
) -> Option<[Content; 2]> {
    let too_many = count > rule.max_leaf;
    if count <= rule.whole_leaf || (rule.split == Split::Median && !too_many) {
        return None;
    }
    if rule.split == Split::Median || depth >= SAH_DEPTH {
        return too_many.then(|| halve(&mut room[..count]));
    }
    let area = bounds.half_area();
    let pays = |parts: &Parts| NODE_COST * area + parts.cost < area * count as f32;
    if count <= FEW {
        let cut = OrderCut::best(&room[..count]);
        if !too_many && !pays(&cut.parts) {
            return None;
        }
        if let Some(split) = rule.split_instead(room, count, bounds, &cut.parts) {
            return Some(split);
        }
        cut.sort(&mut room[..count]);
        return Some([cut.parts.left, cut.parts.right]);
    }
    let Some(cut) = BinCut::best(&room[..count], rule.by_size) else {
        return too_many.then(|| halve(&mut room[..count]));
    };
    if !too_many && !pays(&cut.parts) {
        return None;
    }
    if let Some(split) = rule.split_instead(room, count, bounds, &cut.parts) {
        return Some(split);
    }
    cut.partition(&mut room[..count]);
    Some([cut.parts.left, cut.parts.right])
}

impl Rule<'_> {
    /// Splits primitives where that is allowed and better than the best cut between them.
    fn split_instead(
        &self,
        room: &mut [Item],
        count: usize,
        bounds: FrameBox,
        parts: &Parts,
    ) -> Option<[Content; 2]> {
        self.splitter.as_ref()?.divide(room, count, bounds, parts)
    }
}

pub(super) fn halve(items: &mut [Item]) -> [Content; 2] {
    let middle = split_at_median(items, |item| (item.center(), item.primitive()));
    let (left, right) = items.split_at(middle);
    [left, right].map(|part| Content { bounds: around(part), count: part.len() as u32 })
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;
    use lancer_core::scene::PrimitiveId;

    use super::*;
    use crate::bvh::item::items;

    const RULE: Rule =
        Rule { split: Split::Sah, max_leaf: MAX_LEAF, whole_leaf: 1, by_size: 1.0, splitter: None };

    /// The steps from the root to the deepest leaf.
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
        let counts = |items: &mut [Item]| halve(items).map(|part| part.count);
        let mut row = items([5.0, 1.0, 3.0, 0.0, 4.0, 2.0].map(|x| Vec3A::new(0.0, x, 0.5 * x)));
        assert_eq!(counts(&mut row), [3, 3]);
        assert!(row[..3].iter().all(|item| item.center().y < 5.0));
        // Where centres coincide ids decide.
        let mut alike = items([Vec3A::ONE; 5]);
        alike.reverse();
        assert_eq!(counts(&mut alike), [2, 3]);
        assert!(alike[..2].iter().all(|item| item.primitive() < PrimitiveId(2)));
    }

    /// Near boxes are cheaper to test than to tell apart; far ones are not.
    #[test]
    fn a_leaf_is_made_where_a_split_does_not_pay() {
        let parts = |distance| {
            let mut pair = items([Vec3A::ZERO, Vec3A::X * distance]);
            let bounds = around(&pair);
            divide(&mut pair, 2, bounds, 0, &RULE).map(|parts| parts.map(|part| part.count))
        };
        // With two cubes of half area 3/4 a split costs A + 3/2, a leaf 2 A, and A = 3/4 + distance.
        assert_eq!((parts(0.5), parts(1.0)), (None, Some([1, 1])));
    }

    /// A subtree is halved at every step beyond the limit: so no tree is deeper than the limit says.
    #[test]
    fn below_the_limit_the_tree_is_halved() {
        // Each step along this row is nine tenths of the last: the heuristic takes off the first few.
        const COUNT: usize = 1 << 10;
        let row = || items((0..COUNT).map(|k| Vec3A::X * 0.9_f32.powi(k as i32)));
        let mut room = row();
        let bounds = around(&room);
        let mut nodes = vec![UNKNOWN; 2 * COUNT - 1];
        let (root, below) = nodes.split_first_mut().unwrap();
        let crowd = Crowd { room: &mut room, count: COUNT, first: 0 };
        grow(root, Below { nodes: below, first: 1 }, crowd, bounds, SAH_DEPTH, &RULE);
        assert_eq!(depth(&nodes, 0), 8);
        assert!(depth(&tree(&mut row(), COUNT, bounds, &RULE), 0) > 8);
    }

    /// Free places are shared 2 : 1, and nothing is lost.
    #[test]
    fn a_room_is_shared() {
        let ids = |items: &[Item]| items.iter().map(|item| item.primitive().0).collect::<Vec<_>>();
        let mut room = items([Vec3A::ZERO; 12]);
        assert_eq!(share(&mut room, 6, 3), 8);
        assert_eq!(ids(&room[..6]), [0, 1, 2, 3, 4, 5]);
        let mut moved = ids(&room[8..11]);
        moved.sort_unstable();
        assert_eq!(moved, [6, 7, 8]);
    }
}
