use std::iter;

use glam::DVec2;

use super::cross;

/// Corners that follow each other, in one block: about the square root of [`crate::scene::load::MAX_CORNERS`].
const BLOCK: usize = 256;

/// What is left of a polygon's outline, as a ring of corners.
pub(super) struct Outline<'a> {
    flat: &'a [DVec2],
    before: Vec<usize>,
    after: Vec<usize>,
    removed: Vec<bool>,
    blocks: Vec<Block>,
}

/// A part of the outline.
struct Block {
    /// The box around its corners, the removed ones included.
    min: DVec2,
    max: DVec2,
    /// Its first and its last corner; `None` if all are removed.
    ends: Option<[usize; 2]>,
}

impl<'a> Outline<'a> {
    pub(super) fn new(flat: &'a [DVec2]) -> Self {
        let count = flat.len();
        let blocks = flat.chunks(BLOCK).enumerate().map(|(i, corners)| {
            let bounds = (corners[0], corners[0]);
            let (min, max) = corners.iter().fold(bounds, |(min, max), &p| (min.min(p), max.max(p)));
            let first = i * BLOCK;
            Block { min, max, ends: Some([first, first + corners.len() - 1]) }
        });
        Self {
            flat,
            before: (0..count).map(|i| (i + count - 1) % count).collect(),
            after: (0..count).map(|i| (i + 1) % count).collect(),
            removed: vec![false; count],
            blocks: blocks.collect(),
        }
    }

    pub(super) fn before(&self, corner: usize) -> usize {
        self.before[corner]
    }

    pub(super) fn after(&self, corner: usize) -> usize {
        self.after[corner]
    }

    /// Whether the corner is removed.
    pub(super) fn lacks(&self, corner: usize) -> bool {
        self.removed[corner]
    }

    pub(super) fn corners(&self) -> impl Iterator<Item = usize> {
        (0..self.flat.len()).filter(|&corner| !self.removed[corner])
    }

    pub(super) fn remove(&mut self, corner: usize) {
        let (before, after) = (self.before[corner], self.after[corner]);
        self.removed[corner] = true;
        (self.after[before], self.before[after]) = (after, before);
        let ends = &mut self.blocks[corner / BLOCK].ends;
        *ends = match *ends {
            Some([first, last]) if first == last => None,
            Some([first, last]) if first == corner => Some([after, last]),
            Some([first, last]) if last == corner => Some([first, before]),
            ends => ends,
        };
    }

    /// The corners that tell how often the outline runs around a point: where the box of a block does not hold it,
    /// the block's first and last corner do.
    pub(super) fn around(&self, p: DVec2) -> impl Iterator<Item = DVec2> {
        let blocks = self.blocks.iter().filter_map(|block| Some((block, block.ends?)));
        let corners = blocks.flat_map(move |(block, [first, last])| {
            let is_inside = p.cmpge(block.min).all() && p.cmple(block.max).all();
            iter::successors(Some(first), move |&here| {
                let next = if is_inside { self.after[here] } else { last };
                (here != last).then_some(next)
            })
        });
        corners.map(|corner| self.flat[corner])
    }

    /// How often the outline runs around a point, counter-clockwise.
    pub(super) fn winding_number(&self, p: DVec2) -> i32 {
        let mut corners = self.around(p);
        let Some(start) = corners.next() else { return 0 };
        let (mut turns, mut a) = (0, start);
        for b in corners.chain([start]) {
            if a.y <= p.y && b.y > p.y && cross(a, b, p) > 0.0 {
                turns += 1;
            } else if a.y > p.y && b.y <= p.y && cross(a, b, p) < 0.0 {
                turns -= 1;
            }
            a = b;
        }
        turns
    }
}
