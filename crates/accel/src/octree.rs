use std::collections::VecDeque;

use glam::DVec3;
use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};
use lancer_core::intersector::{Hit, Observer, Probe, Query, Traversal};
use lancer_core::scene::{PrimitiveId, Scene, Subset};
use smallvec::SmallVec;

use crate::cells::{Cell, CellEntry, RayCells, search, visited};
use crate::margins::{regular_slack, rounding};
use crate::spatial::Leaf;
use crate::touching::{Footprint, overlap, surface_points};

/// The octree, one of the slides' irregular subdivisions of space: a cube around the scene, cut into
/// eight where too much lies in it.
///
/// *Built* level by level, O(n log n) for surfaces of equal triangles: a cube is cut until it holds few
/// primitives, and only where that spares tests. Each primitive goes into the cubes that its surface
/// touches, grown by more than planes and rays can err.
///
/// *Walked* from the root: the three planes in the middle of a cube cut the ray into at most four pieces
/// (and none of no length is lost: each is longer by the ray's own rounding), of which the nearest is
/// followed first. O(log n) cubes lead to a leaf, and few leaves hold anything.
///
/// *Wins* over the grid where the primitives are uneven, since empty space takes few cells at any scale.
/// *Loses* to hierarchies of boxes and to the kd-tree: the planes lie where halving puts them, not
/// where the primitives end, so a primitive is in several leaves and leaves are entered in vain.
///
/// *Sources:* Glassner, *Space Subdivision for Fast Ray Tracing*, IEEE CG&A 4(10), 1984; the pieces of the
/// ray: Gargantini and Atkinson, *Ray Tracing an Octree*, Computer Graphics Forum 12(4), 1993.
#[doc(alias = "subdivision spatiale irrégulière")]
#[doc(alias = "arbre octal")]
pub struct Octree<'s> {
    scene: &'s Scene,
    bounds: Bounds3,
    slack: f64,
    root: Cube,
    max_depth: u32,
    /// The first is the root; the eight children of a node stand together.
    nodes: Vec<Node>,
    /// The primitives of the leaves, leaf by leaf.
    primitives: Vec<PrimitiveId>,
    mailboxing: bool,
}

/// How an [`Octree`] is built and walked.
#[derive(Clone, Copy, Debug)]
pub struct OctreeBuilder {
    /// A cube with no more primitives than this is not cut.
    pub leaf_size: usize,
    /// A cube that is the result of so many cuts is not cut either.
    pub max_depth: u32,
    /// Whether a ray remembers what it was tested against last. The answers are the same.
    pub mailboxing: bool,
}

impl Default for OctreeBuilder {
    fn default() -> Self {
        Self { leaf_size: 8, max_depth: 24, mailboxing: true }
    }
}

/// References per primitive at most, on average. Then no more cubes are cut: large primitives that
/// overlap would fill the memory.
const MAX_REFERENCES: usize = 32;

/// What it costs to open a cube and to visit its parts, in primitive tests. Without it a vertex of more
/// triangles than a leaf may hold would be cut out of its surroundings down to the last level.
const OPENING: usize = 5;

#[derive(Clone, Copy, Debug)]
enum Node {
    /// Cut into eight: the first of its children.
    Inner(u32),
    /// The first of its primitives, and their number.
    Leaf(u32, u32),
}

/// An octree's cell.
#[derive(Clone, Copy, Debug)]
struct Cube {
    center: DVec3,
    half: f64,
}

impl Cube {
    /// One of the eight parts; bit k of its number is set if it is the upper one along axis k.
    #[inline]
    fn part(self, number: usize) -> Self {
        let half = 0.5 * self.half;
        let side = |axis: usize| if number >> axis & 1 == 1 { half } else { -half };
        Self { center: self.center + DVec3::new(side(0), side(1), side(2)), half }
    }

    #[inline(always)]
    fn bounds(self) -> Bounds3 {
        Bounds3 { min: self.center - self.half, max: self.center + self.half }
    }
}

/// A cube that may have to be cut.
struct Uncut {
    node: usize,
    cube: Cube,
    depth: u32,
    primitives: Vec<PrimitiveId>,
}

impl OctreeBuilder {
    /// Builds the octree.
    pub fn build<'s>(self, primitives: impl Into<Subset<'s>>) -> Octree<'s> {
        let all = primitives.into();
        let (scene, bounds) = (all.scene(), all.bounds());
        let slack = regular_slack(bounds);
        let bounds = bounds.grown(slack);
        // The scene is in the cube's lower corner: in the middle a flat one would lie on both sides of
        // a plane.
        let half = 0.5 * (bounds.max - bounds.min).max_element();
        let root = Cube { center: bounds.min + half, half };
        let mut nodes = vec![Node::Leaf(0, 0)];
        let mut primitives = Vec::new();
        let mut references = all.len();
        let most = MAX_REFERENCES * references;
        let everything = Uncut { node: 0, cube: root, depth: 0, primitives: all.iter().collect() };
        // Level by level, so that the limit of references, if it is met, is met everywhere alike.
        let mut queue = VecDeque::from([everything]);
        while let Some(uncut) = queue.pop_front() {
            let count = uncut.primitives.len();
            // Planes must be farther apart than what the primitives are grown by; with that slack in
            // proportion to the scene, it also limits the depth to 28.
            let cuttable = count > self.leaf_size
                && uncut.depth < self.max_depth
                && uncut.cube.half > 16.0 * slack;
            let parts = cuttable.then(|| cut(scene, slack, &uncut)).filter(|parts| {
                let after: usize = parts.iter().map(Vec::len).sum();
                // A ray that meets the cube meets each of its parts with a probability of 1/4, the
                // ratio of their surfaces.
                after + 4 * OPENING < 4 * count && references - count + after <= most
            });
            if let Some(parts) = parts {
                let first = nodes.len();
                nodes[uncut.node] = Node::Inner(first as u32);
                references -= count;
                for (number, primitives) in parts.into_iter().enumerate() {
                    nodes.push(Node::Leaf(0, 0));
                    references += primitives.len();
                    queue.push_back(Uncut {
                        node: first + number,
                        cube: uncut.cube.part(number),
                        depth: uncut.depth + 1,
                        primitives,
                    });
                }
            } else {
                nodes[uncut.node] = Node::Leaf(primitives.len() as u32, count as u32);
                primitives.extend(uncut.primitives);
            }
        }
        let Self { max_depth, mailboxing, .. } = self;
        Octree { scene, bounds, slack, root, max_depth, nodes, primitives, mailboxing }
    }
}

/// The primitives of the eight parts of a cube.
fn cut(scene: &Scene, slack: f64, uncut: &Uncut) -> [Vec<PrimitiveId>; 8] {
    let parts: [Bounds3; 8] = std::array::from_fn(|number| uncut.cube.part(number).bounds());
    let mut inside: [Vec<PrimitiveId>; 8] = Default::default();
    for &primitive in &uncut.primitives {
        let bounds = scene.primitive_bounds(primitive).grown(slack);
        let near = (0..8).filter(|&number| overlap(bounds, parts[number]));
        let near: SmallVec<[usize; 8]> = near.collect();
        // Most primitives are small: what is near one part only need not be looked at closely.
        let footprint = (near.len() > 1).then(|| Footprint::new(scene, primitive, slack));
        for number in near {
            if footprint.as_ref().is_none_or(|surface| surface.touches(parts[number])) {
                inside[number].push(primitive);
            }
        }
    }
    inside
}

impl<'s> Octree<'s> {
    /// Builds the octree with the default parameters.
    pub fn build(primitives: impl Into<Subset<'s>>) -> Self {
        OctreeBuilder::default().build(primitives)
    }

    /// Bytes held by the index, without the scene it borrows.
    pub fn memory(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.primitives.as_slice())
    }

    /// The leaves with their boxes, in depth-first order.
    pub fn leaves(&self) -> impl Iterator<Item = Leaf<'_>> {
        let mut pending = vec![(0, self.root)];
        std::iter::from_fn(move || {
            loop {
                let (node, cube) = pending.pop()?;
                match self.nodes[node] {
                    Node::Leaf(first, count) => {
                        let primitives = self.leaf(first, count);
                        return Some(Leaf { bounds: cube.bounds(), primitives });
                    }
                    Node::Inner(first) => {
                        let part = |number| (first as usize + number, cube.part(number));
                        pending.extend((0..8).rev().map(part));
                    }
                }
            }
        })
    }

    /// The leaves that a ray visits in `range`, near ones first, whether or not it hits anything in them.
    pub fn cells(&self, ray: &Ray, range: Interval) -> impl Iterator<Item = Cell<'_>> {
        visited(self.descent(ray, range), range.max)
    }

    #[inline(always)]
    fn leaf(&self, first: u32, count: u32) -> &[PrimitiveId] {
        &self.primitives[first as usize..first as usize + count as usize]
    }

    #[inline]
    fn descent(&self, ray: &Ray, range: Interval) -> Option<Descent<'_>> {
        let line = Line { ray: *ray, rounding: rounding(ray, self.bounds)? };
        let mut inside = Interval { min: range.min.max(0.0), max: range.max };
        for axis in 0..3 {
            inside = line.above(axis, self.bounds.min[axis], inside);
            inside = line.below(axis, self.bounds.max[axis], inside);
        }
        let mut pending = SmallVec::new();
        if inside.min <= inside.max {
            pending.push(Visit { node: 0, cube: self.root, inside });
        }
        Some(Descent { tree: self, line, pending, at: self.root })
    }

    /// Checks that every node is reached once and no deeper than the limit, that every one of these
    /// primitives is in the leaves of its corners, and that no leaf holds what does not come near it.
    pub fn validate<'p>(&self, all: impl Into<Subset<'p>>) -> Result<(), String> {
        let mut reached = vec![false; self.nodes.len()];
        let mut pending = vec![(0, self.root, 0)];
        while let Some((node, cube, depth)) = pending.pop() {
            if std::mem::replace(&mut reached[node], true) {
                return Err(format!("node {node} is reached twice"));
            }
            if depth > self.max_depth {
                return Err(format!("node {node} is at depth {depth}"));
            }
            match self.nodes[node] {
                Node::Inner(first) => pending
                    .extend((0..8).map(|part| (first as usize + part, cube.part(part), depth + 1))),
                Node::Leaf(first, count) => {
                    let primitives = self.leaf(first, count);
                    if !primitives.is_sorted_by(|a, b| a < b) {
                        return Err(format!("leaf {node} holds a primitive twice"));
                    }
                    let near = |&primitive: &PrimitiveId| {
                        let reach = self.scene.primitive_bounds(primitive).grown(2.0 * self.slack);
                        overlap(reach, cube.bounds())
                    };
                    if !primitives.iter().all(near) {
                        return Err(format!("leaf {node} holds a primitive that lies elsewhere"));
                    }
                }
            }
        }
        if reached.contains(&false) {
            return Err("a node is not reached".into());
        }
        for primitive in all.into().iter() {
            for point in surface_points(self.scene, primitive) {
                if self.leaf_at(point).binary_search(&primitive).is_err() {
                    return Err(format!("{primitive:?} is missing from the leaf at {point}"));
                }
            }
        }
        Ok(())
    }

    /// The primitives of the leaf that a point is in.
    fn leaf_at(&self, point: DVec3) -> &[PrimitiveId] {
        let (mut node, mut cube) = (0, self.root);
        loop {
            match self.nodes[node] {
                Node::Leaf(first, count) => return self.leaf(first, count),
                Node::Inner(first) => {
                    let number = point.cmpge(cube.center).bitmask() as usize;
                    (node, cube) = (first as usize + number, cube.part(number));
                }
            }
        }
    }
}

impl Traversal for Octree<'_> {
    /// Visits the primitives of leaf after leaf along the ray, until any hit will do or the closest is
    /// nearer than all other cubes.
    #[inline]
    fn walk<O: Observer>(&self, query: Query<&Ray>, observer: &mut O) -> Option<Hit> {
        let Query { ray, range, wanted } = query;
        let descent = self.descent(ray, range)?;
        search(descent, Probe::new(self.scene, ray, range), self.mailboxing, wanted, observer)
    }
}

/// A ray, and how far beside it a hit may lie.
#[derive(Clone, Copy)]
struct Line {
    ray: Ray,
    rounding: f64,
}

impl Line {
    /// The part of the ray's piece `inside` that lies below a plane, or hardly above it.
    #[inline(always)]
    fn below(&self, axis: usize, plane: f64, inside: Interval) -> Interval {
        let (origin, direction) = (self.ray.origin[axis], self.ray.direction[axis]);
        let plane = plane + self.rounding;
        let crossing = (plane - origin) / direction;
        if direction > 0.0 {
            until(crossing, inside)
        } else if direction < 0.0 {
            from(crossing, inside)
        } else if origin <= plane {
            // 0 and −0 cross no plane: the quotient is infinite, or NaN for a ray in the plane.
            inside
        } else {
            NOWHERE
        }
    }

    /// The part of the ray's piece `inside` that lies above a plane, or hardly below it.
    #[inline(always)]
    fn above(&self, axis: usize, plane: f64, inside: Interval) -> Interval {
        let (origin, direction) = (self.ray.origin[axis], self.ray.direction[axis]);
        let plane = plane - self.rounding;
        let crossing = (plane - origin) / direction;
        if direction > 0.0 {
            from(crossing, inside)
        } else if direction < 0.0 {
            until(crossing, inside)
        } else if origin >= plane {
            inside
        } else {
            NOWHERE
        }
    }
}

const NOWHERE: Interval = Interval { min: f64::INFINITY, max: f64::NEG_INFINITY };

#[inline(always)]
fn from(t: f64, Interval { min, max }: Interval) -> Interval {
    Interval { min: if t > min { t } else { min }, max }
}

#[inline(always)]
fn until(t: f64, Interval { min, max }: Interval) -> Interval {
    Interval { min, max: if t < max { t } else { max } }
}

/// A cube on the ray's way, and the ray's piece in it.
#[derive(Clone, Copy)]
struct Visit {
    node: u32,
    cube: Cube,
    inside: Interval,
}

/// The leaves along a ray. What is pending ends with the nearest; it has at most seven parts of a cube at each
/// depth, three but for rounding.
struct Descent<'i> {
    tree: &'i Octree<'i>,
    line: Line,
    pending: SmallVec<[Visit; 32]>,
    /// The leaf that came last.
    at: Cube,
}

impl Descent<'_> {
    /// Puts the parts of a cube that the ray meets in front of what is pending.
    #[inline(always)]
    fn open(&mut self, first: u32, cube: Cube, inside: Interval) {
        let Line { ray, .. } = self.line;
        let sides = [0, 1, 2].map(|axis| {
            let plane = cube.center[axis];
            [self.line.below(axis, plane, inside), self.line.above(axis, plane, inside)]
        });
        // Counting from the part at which the ray would start, a part comes after all those whose bits
        // it has: in the order of the numbers, whichever plane is met first.
        let start = ray.direction.cmplt(DVec3::ZERO).bitmask() as usize;
        for number in (0..8).rev().map(|number| number ^ start) {
            let [x, y, z] = [0, 1, 2].map(|axis| sides[axis][number >> axis & 1]);
            let inside = until(y.max, until(z.max, from(y.min, from(z.min, x))));
            if inside.min <= inside.max {
                let node = first + number as u32;
                self.pending.push(Visit { node, cube: cube.part(number), inside });
            }
        }
    }
}

impl<'i> RayCells<'i> for Descent<'i> {
    #[inline(always)]
    fn next<O: Observer>(&mut self, max: f64, observer: &mut O) -> Option<CellEntry<'i>> {
        loop {
            let Visit { node, cube, inside } = self.pending.pop()?;
            if inside.min * Slabs::NEAR > max {
                continue;
            }
            observer.region(&|| cube.bounds());
            observer.cell_visit();
            match self.tree.nodes[node as usize] {
                Node::Inner(first) => self.open(first, cube, inside),
                Node::Leaf(first, count) => {
                    self.at = cube;
                    return Some((inside.min, self.tree.leaf(first, count)));
                }
            }
        }
    }

    fn bounds(&self) -> Bounds3 {
        self.at.bounds()
    }
}
