//! Trees laid out tidily: parents over the middle of their children, nothing overlapping.

use crate::canvas::Canvas;
use crate::geometry::{Point, Rect};
use crate::plate::Panel;
use crate::shape::{Color, Stroke, Style, Text};
use crate::style::{CAP_HEIGHT, LABEL, MUTED, TICK};

/// A tree, such as the rays of one pixel: each node has a label, and each edge down to it another.
#[derive(Clone, Debug)]
pub struct Tree {
    label: String,
    color: Color,
    edge: String,
    children: Vec<Tree>,
}

const NODE_HEIGHT: f64 = 38.0;
const LEVEL: f64 = 106.0;
/// The upright end of an edge, on which its label stands.
const STEM: f64 = 34.0;
const NODE_PAD: f64 = 14.0;
const BESIDE: f64 = 18.0;

impl Tree {
    /// A node without children.
    pub fn new(label: impl Into<String>, color: Color) -> Self {
        Self { label: label.into(), color, edge: String::new(), children: Vec::new() }
    }

    /// With one more child at the right, and the label of the edge to it.
    pub fn child(mut self, edge: impl Into<String>, child: Self) -> Self {
        self.children.push(Self { edge: edge.into(), ..child });
        self
    }

    fn depth(&self) -> usize {
        1 + self.children.iter().map(Self::depth).max().unwrap_or(0)
    }

    fn node_width(&self) -> f64 {
        Text::new(&self.label, LABEL).bold().width() + 2.0 * NODE_PAD
    }

    /// Half of the width that the node and the label of its edge take.
    fn half_width(&self) -> f64 {
        self.node_width().max(Text::new(&self.edge, TICK).width()) / 2.0
    }

    /// How wide it is.
    pub(crate) fn width(&self) -> f64 {
        let placed = self.laid_out();
        placed.right() - placed.left()
    }

    /// The nodes in the middle of `rect`, parents before their children, left before right.
    pub(crate) fn parts(&self, rect: Rect) -> Vec<Part<'_>> {
        let placed = self.laid_out();
        let root = rect.center()[0] - (placed.left() + placed.right()) / 2.0;
        let mut parts = Vec::new();
        placed.collect([root, rect.y + 2.0 + NODE_HEIGHT / 2.0], None, &mut parts);
        parts
    }

    /// The tree with the middle of each node, its root at 0, its children pushed apart just so far that
    /// their outlines keep their distance on every level.
    fn laid_out(&self) -> Placed<'_> {
        let mut children: Vec<(f64, Placed<'_>)> = Vec::new();
        let mut outline: Vec<(f64, f64)> = Vec::new();
        for child in &self.children {
            let child = child.laid_out();
            let pairs = outline.iter().zip(&child.outline);
            let shift = pairs
                .map(|(left, right)| left.1 - right.0 + BESIDE)
                .fold(None, |most: Option<f64>, gap| Some(most.map_or(gap, |most| most.max(gap))));
            let shift = shift.unwrap_or(0.0);
            for (level, &(left, right)) in child.outline.iter().enumerate() {
                match outline.get_mut(level) {
                    Some(sides) => sides.1 = right + shift,
                    None => outline.push((left + shift, right + shift)),
                }
            }
            children.push((shift, child));
        }
        let middle = match (children.first(), children.last()) {
            (Some((first, _)), Some((last, _))) => (first + last) / 2.0,
            _ => 0.0,
        };
        for (shift, _) in &mut children {
            *shift -= middle;
        }
        let own = (-self.half_width(), self.half_width());
        let below = outline.into_iter().map(|(left, right)| (left - middle, right - middle));
        Placed { tree: self, children, outline: std::iter::once(own).chain(below).collect() }
    }
}

/// A subtree with its children's places relative to its own, and its left and right end on each level.
struct Placed<'a> {
    tree: &'a Tree,
    children: Vec<(f64, Placed<'a>)>,
    outline: Vec<(f64, f64)>,
}

impl<'a> Placed<'a> {
    fn left(&self) -> f64 {
        self.outline.iter().map(|sides| sides.0).fold(0.0, f64::min)
    }

    fn right(&self) -> f64 {
        self.outline.iter().map(|sides| sides.1).fold(0.0, f64::max)
    }

    /// Adds the node, whose parent is at `above`, and what hangs below it.
    fn collect(&self, at: Point, above: Option<Point>, parts: &mut Vec<Part<'a>>) {
        parts.push(Part { tree: self.tree, at, above });
        for (shift, child) in &self.children {
            child.collect([at[0] + shift, at[1] + LEVEL], Some(at), parts);
        }
    }
}

/// A node in its place, with the edge that leads down to it.
pub(crate) struct Part<'a> {
    tree: &'a Tree,
    at: Point,
    above: Option<Point>,
}

impl Part<'_> {
    /// The box of the node.
    pub fn node(&self) -> Rect {
        Rect::around(self.at, self.tree.node_width(), NODE_HEIGHT)
    }

    pub fn draw(&self, canvas: &mut Canvas) {
        let Self { tree, at: [x, y], above } = *self;
        if let Some([from, over]) = above {
            let bend = [x, y - NODE_HEIGHT / 2.0 - STEM];
            let line = vec![[from, over + NODE_HEIGHT / 2.0], bend, [x, y]];
            canvas.polyline(line, Stroke::new(MUTED, 1.8));
            let text = Text::new(&tree.edge, TICK).color(MUTED).centered().halo();
            canvas.text([x, bend[1] + (STEM + CAP_HEIGHT * TICK) / 2.0], text);
        }
        let style = Style::fill(tree.color.mix(Color::WHITE, 0.86)).outlined(tree.color, 2.5);
        canvas.rounded_rect(self.node(), 9.0, style);
        let text = Text::new(&tree.label, LABEL).bold().color(tree.color.for_text()).centered();
        canvas.text([x, y + CAP_HEIGHT / 2.0 * LABEL], text);
    }
}

impl Panel for Tree {
    fn height(&self, _width: f64) -> f64 {
        (self.depth() - 1) as f64 * LEVEL + NODE_HEIGHT + 4.0
    }

    /// Draws the tree in the middle; one too wide for `rect` reaches over its sides.
    fn draw(&self, canvas: &mut Canvas, rect: Rect) {
        for part in self.parts(rect) {
            part.draw(canvas);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leaf(label: &str) -> Tree {
        Tree::new(label, Color::rgb(0, 0, 200))
    }

    fn boxes(placed: &Placed<'_>, x: f64, level: usize, found: &mut Vec<Rect>) {
        let width = 2.0 * placed.tree.half_width();
        found.push(Rect::around([x, level as f64 * LEVEL], width, NODE_HEIGHT));
        for (shift, child) in &placed.children {
            boxes(child, x + shift, level + 1, found);
        }
    }

    #[test]
    fn nodes_never_overlap() {
        let deep = leaf("deep")
            .child("a", leaf("left").child("", leaf("a wide leaf").child("", leaf("x"))));
        let bushy = (0..5)
            .fold(leaf("bushy"), |tree, i| tree.child(format!("weight 0.{i}2345"), leaf("n")));
        let tree = leaf("root")
            .child("", deep.clone())
            .child("b", bushy.clone())
            .child("", deep.child("", bushy));
        let mut found = Vec::new();
        boxes(&tree.laid_out(), 0.0, 0, &mut found);
        assert_eq!(found.len(), 1 + 4 + 6 + 4 + 6);
        for (i, a) in found.iter().enumerate() {
            assert!(
                found[..i]
                    .iter()
                    .all(|b| !a.grown(BESIDE / 2.0 - 1e-9).overlaps(&b.grown(BESIDE / 2.0 - 1e-9)))
            );
        }
        let mut canvas = Canvas::new(2400.0, tree.height(2400.0));
        tree.draw(&mut canvas, Rect::new(0.0, 0.0, 2400.0, tree.height(2400.0)));
        assert_eq!(canvas.faults(), []);
    }

    #[test]
    fn a_parent_stands_over_the_middle_of_its_children() {
        let tree = leaf("root").child("", leaf("a")).child("", leaf("bb")).child("", leaf("ccc"));
        let placed = tree.laid_out();
        assert!((placed.children[0].0 + placed.children[2].0).abs() < 1e-12);
    }
}
