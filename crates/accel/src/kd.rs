//! « Subdivision spatiale irrégulière »: planes across the axes.

mod sides;

use glam::DVec3;
use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};
use lancer_core::intersector::{Hit, Observer, Probe, Query, Traversal};
use lancer_core::scene::{PrimitiveId, Scene, Shape, Subset};
use smallvec::SmallVec;

pub use sides::Sides;
use sides::Thick;

use crate::cells::{Cell, CellEntry, RayCells, search, visited};
use crate::margins::{TIES, rounding, slack};
use crate::sah::sah_cost;
use crate::spatial::{
    Leaf, PARALLEL, Polygon, REFERENCES_PER_PRIMITIVE, clip, common, depth_limit, shared_allowance,
};

/// « Subdivision spatiale irrégulière »: a tree of planes perpendicular to an axis, each put where it
/// saves most.
///
/// *Built* from the top by the surface area heuristic: a random ray that meets a convex cell meets a
/// convex part of it with the probability S(part) / S(cell), so a plane costs
///
/// ```text
/// C = C_t + C_i (N_below S_below + N_above S_above) / S
/// ```
///
/// and the cheapest one is taken, or none when testing all N primitives, C_i N, is cheaper. Planes that
/// cut off empty space get a bonus. Only the bounds of primitives are candidates: between two of them
/// N_below and N_above stay. In large nodes 64 planes per axis stand for all of them. A primitive that
/// crosses the plane goes to both sides, and there only the part counts that is inside the cell
/// ("perfect splits": the triangle is clipped). Depth is at most 8 + 1.3 log₂ N.
///
/// *Walked* near cell first: the plane divides the ray's interval, the near side is visited, the far
/// side waits on a stack. As cells do not overlap, the first cell with a hit inside ends the walk; a
/// primitive that reaches into this cell but is met in a later one does not.
///
/// It takes O(n log n) steps to build, and about O(log n) cells for a ray.
///
/// *Wins* where primitives are of uneven size and density and much space is empty. *Loses* to a hierarchy of
/// volumes in memory and build time, because a primitive stands in several leaves, and is tested several
/// times.
///
/// *Sources:* Bentley, *Multidimensional Binary Search Trees Used for Associative Searching*, CACM 18(9),
/// 1975; MacDonald, Booth, *Heuristics for Ray Tracing Using Space Subdivision*, The Visual Computer 6,
/// 1990; Wald, Havran, *On Building Fast kd-Trees for Ray Tracing, and on Doing That in O(N log N)*,
/// RT 2006.
#[doc(alias = "subdivision spatiale irrégulière")]
#[doc(alias = "arbre kd")]
pub struct KdTree<'s> {
    scene: &'s Scene,
    /// The root's cell.
    bounds: Bounds3,
    /// The nodes in depth-first order; the first is the root.
    nodes: Vec<Node>,
    /// The primitives of the leaves, leaf by leaf.
    primitives: Vec<PrimitiveId>,
    max_depth: u32,
}

/// A node of 16 bytes.
#[derive(Clone, Copy)]
enum Node {
    /// A plane `axis` = `split`. What is below it is the next node.
    Inner { axis: u8, above: u32, split: f64 },
    /// A cell that is not divided: a range of the tree's primitives.
    Leaf { first: u32, count: u32 },
}

/// How a [`KdTree`] is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KdBuilder {
    /// C_i / C_t: the cost of testing a primitive, in steps down the tree. Measured, a step costs more
    /// than a test: where it goes and whether that is in the cache is unknown until it is made.
    pub test_cost: f64,
    /// A plane with nothing on one side counts this share less.
    pub empty_bonus: f64,
    /// Primitives are clipped to their cells; otherwise only their boxes are.
    pub perfect_splits: bool,
}

impl Default for KdBuilder {
    fn default() -> Self {
        Self { test_cost: 0.4, empty_bonus: 0.1, perfect_splits: true }
    }
}

/// Every candidate plane is tried for up to this many primitives; the planes between bins for more.
const SWEEP: usize = 32;
const BINS: usize = 64;

/// A primitive in a cell that is being divided.
struct Reference {
    primitive: PrimitiveId,
    /// Contains the part of the primitive that is in the cell, and what rounding adds.
    bounds: Bounds3,
}

/// A tree as it is built, before it is laid out in memory.
enum Subtree {
    Inner { axis: usize, split: f64, children: Box<[Subtree; 2]> },
    Leaf(Box<[PrimitiveId]>),
}

/// A plane and what the heuristic says about it.
#[derive(Clone, Copy)]
struct Candidate {
    axis: usize,
    split: f64,
    cost: f64,
}

impl KdBuilder {
    /// Builds the tree.
    pub fn build<'s>(self, primitives: impl Into<Subset<'s>>) -> KdTree<'s> {
        let all = primitives.into();
        let scene = all.scene();
        let reference = |primitive| {
            let bounds = scene.primitive_bounds(primitive);
            Reference { primitive, bounds: bounds.grown(slack(bounds)) }
        };
        let references: Vec<Reference> = all.iter().map(reference).collect();
        let bounds = references.iter().map(|r| r.bounds).fold(Bounds3::EMPTY, Bounds3::union);
        let max_depth = depth_limit(references.len());
        let allowance = REFERENCES_PER_PRIMITIVE * references.len();
        let root = self.subtree(scene, bounds, references, max_depth, allowance);
        let mut tree =
            KdTree { scene, bounds, nodes: Vec::new(), primitives: Vec::new(), max_depth };
        tree.lay_out(root);
        tree
    }

    fn subtree(
        &self,
        scene: &Scene,
        cell: Bounds3,
        references: Vec<Reference>,
        levels: u32,
        allowance: usize,
    ) -> Subtree {
        let leaf = |references: &[Reference]| {
            Subtree::Leaf(references.iter().map(|reference| reference.primitive).collect())
        };
        let best = if levels == 0 { None } else { self.best_split(cell, &references) };
        let Some(Candidate { axis, split, .. }) = best else { return leaf(&references) };
        let is_on = |r: &Reference| [r.bounds.min[axis] < split, r.bounds.max[axis] > split];
        let crossing = references.iter().filter(|r| is_on(r) == [true; 2]).count();
        if references.len() + crossing > allowance {
            return leaf(&references);
        }

        let cells = halves(cell, axis, split);
        let (mut below, mut above) = (Vec::new(), Vec::new());
        for reference in references {
            match is_on(&reference) {
                [true, true] => {
                    let parts = cells.map(|half| self.part(scene, &reference, half));
                    for (side, bounds) in [&mut below, &mut above].into_iter().zip(parts) {
                        if !bounds.is_empty() {
                            side.push(Reference { bounds, ..reference });
                        }
                    }
                }
                [false, true] => above.push(reference),
                [_, false] => below.push(reference),
            }
        }
        let parallel = below.len() + above.len() > PARALLEL;
        let allowances = shared_allowance(allowance, [below.len(), above.len()]);
        let below = || self.subtree(scene, cells[0], below, levels - 1, allowances[0]);
        let above = || self.subtree(scene, cells[1], above, levels - 1, allowances[1]);
        let (below, above) = if parallel { rayon::join(below, above) } else { (below(), above()) };
        Subtree::Inner { axis, split, children: Box::new([below, above]) }
    }

    /// Bounds of the part of a primitive that is in a cell; empty when it does not come near.
    fn part(&self, scene: &Scene, reference: &Reference, cell: Bounds3) -> Bounds3 {
        let within = common(reference.bounds, cell);
        if !self.perfect_splits {
            return within;
        }
        let whole = scene.primitive_bounds(reference.primitive);
        let slack = slack(whole);
        let near = within.grown(slack);
        let part = match scene.shape(reference.primitive) {
            Shape::Triangle(index) => Bounds3::of_points(clipped(scene.mesh.corners(index), near)),
            // A sphere keeps its box unless the cell is in a corner of it.
            Shape::Sphere(_) => {
                let center = whole.center();
                let nearest = center.clamp(near.min, near.max);
                let radius = 0.5 * (whole.max - whole.min).max_element();
                if center.distance(nearest) > radius + slack { Bounds3::EMPTY } else { whole }
            }
        };
        if part.is_empty() { part } else { common(part.grown(slack), within) }
    }

    /// The cheapest plane, if it is cheaper than testing all.
    fn best_split(&self, cell: Bounds3, references: &[Reference]) -> Option<Candidate> {
        let leaf_cost = self.test_cost * references.len() as f64;
        let mut best = Candidate { axis: 0, split: f64::NAN, cost: leaf_cost };
        let mut bounds = [Vec::new(), Vec::new()];
        for axis in 0..3 {
            let mut consider = |split: f64, below: usize, above: usize| {
                if cell.min[axis] < split && split < cell.max[axis] {
                    let cost = self.cost(cell, axis, split, [below, above]);
                    if cost < best.cost {
                        best = Candidate { axis, split, cost };
                    }
                }
            };
            if references.len() > SWEEP {
                consider_bins(cell, axis, references, &mut consider);
            } else {
                consider_all(axis, references, &mut bounds, &mut consider);
            }
        }
        (best.cost < leaf_cost).then_some(best)
    }

    /// The cost C of a plane, for `counts` primitives below and above it.
    fn cost(&self, cell: Bounds3, axis: usize, split: f64, counts: [usize; 2]) -> f64 {
        let extent = cell.max - cell.min;
        // Only quotients of areas matter. Nothing over- or underflows in units of the cell.
        let unit = extent / extent.max_element();
        let share = (split - cell.min[axis]) / extent[axis];
        let parts = [share, 1.0 - share].map(|share| {
            let mut part = unit;
            part[axis] *= share;
            part
        });
        let bonus = if counts.contains(&0) { 1.0 - self.empty_bonus } else { 1.0 };
        bonus * sah_cost(unit, parts, counts, self.test_cost)
    }
}

/// The two parts of a cell.
fn halves(cell: Bounds3, axis: usize, split: f64) -> [Bounds3; 2] {
    let [mut below, mut above] = [cell; 2];
    below.max[axis] = split;
    above.min[axis] = split;
    [below, above]
}

/// The part of a triangle inside a box.
fn clipped(corners: [DVec3; 3], bounds: Bounds3) -> Polygon {
    let mut polygon = Polygon::from_slice(&corners);
    for axis in 0..3 {
        polygon = clip(&polygon, |p| bounds.min[axis] - p[axis]);
        polygon = clip(&polygon, |p| p[axis] - bounds.max[axis]);
    }
    polygon
}

/// Considers equidistant planes. Counting in which bins the references start and end tells for each
/// plane between two bins how many are on its sides.
fn consider_bins(
    cell: Bounds3,
    axis: usize,
    references: &[Reference],
    consider: &mut impl FnMut(f64, usize, usize),
) {
    let (from, width) = (cell.min[axis], (cell.max[axis] - cell.min[axis]) / BINS as f64);
    // A negative number becomes bin 0, and NaN, of a flat cell, too.
    let bin = |coordinate: f64| (((coordinate - from) / width) as usize).min(BINS - 1);
    let (mut starts, mut ends) = ([0; BINS], [0; BINS]);
    for reference in references {
        starts[bin(reference.bounds.min[axis])] += 1;
        ends[bin(reference.bounds.max[axis])] += 1;
    }
    let (mut below, mut above) = (0, references.len());
    for plane in 1..BINS {
        below += starts[plane - 1];
        above -= ends[plane - 1];
        consider(from + width * plane as f64, below, above);
    }
}

/// Considers the planes of all bounds of the references.
fn consider_all(
    axis: usize,
    references: &[Reference],
    [starts, ends]: &mut [Vec<f64>; 2],
    consider: &mut impl FnMut(f64, usize, usize),
) {
    starts.clear();
    starts.extend(references.iter().map(|reference| reference.bounds.min[axis]));
    starts.sort_unstable_by(f64::total_cmp);
    ends.clear();
    ends.extend(references.iter().map(|reference| reference.bounds.max[axis]));
    ends.sort_unstable_by(f64::total_cmp);

    // How many of the starts and ends, in order, lie before the plane.
    let (mut started, mut ended) = (0, 0);
    while ended < ends.len() {
        let split = match starts.get(started) {
            Some(&start) if start < ends[ended] => start,
            _ => ends[ended],
        };
        while ended < ends.len() && ends[ended] <= split {
            ended += 1;
        }
        consider(split, started, references.len() - ended);
        while started < starts.len() && starts[started] <= split {
            started += 1;
        }
    }
}

/// A cell still to be visited, and where the ray is in it.
struct Pending {
    node: u32,
    inside: Interval,
}

/// What is still to be visited: never more than a tree is deep, which is less than 64 for any number
/// of primitives that fits an id.
type Stack = SmallVec<[Pending; 64]>;

impl<'s> KdTree<'s> {
    /// Builds the tree with the default parameters.
    pub fn build(primitives: impl Into<Subset<'s>>) -> Self {
        KdBuilder::default().build(primitives)
    }

    /// Appends a subtree to the nodes, what is below a plane first. As deep as the tree, which has a
    /// limit.
    fn lay_out(&mut self, subtree: Subtree) {
        match subtree {
            Subtree::Leaf(primitives) => {
                let (first, count) = (self.primitives.len() as u32, primitives.len() as u32);
                self.nodes.push(Node::Leaf { first, count });
                self.primitives.extend(primitives);
            }
            Subtree::Inner { axis, split, children } => {
                let index = self.nodes.len();
                let [below, above] = *children;
                let axis = axis as u8;
                self.nodes.push(Node::Inner { axis, above: 0, split });
                self.lay_out(below);
                let next = self.nodes.len() as u32;
                self.nodes[index] = Node::Inner { axis, above: next, split };
                self.lay_out(above);
            }
        }
    }

    /// Bytes held by the index, without the scene it borrows.
    pub fn memory(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.primitives.as_slice())
    }

    /// The cells that a ray visits in `range`, near ones first, whether or not it hits anything in them.
    pub fn cells(&self, ray: &Ray, range: Interval) -> impl Iterator<Item = Cell<'_>> {
        visited(self.descent(ray, range), range.max)
    }

    #[inline(always)]
    fn descent(&self, ray: &Ray, range: Interval) -> Option<Descent<'_>> {
        let thickness = TIES * rounding(ray, self.bounds)?;
        let Bounds3 { min, max } = self.bounds.grown(thickness);
        let inside = Slabs::new(ray).cross(min, max, range)?;
        let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
        let axes: [Thick; 3] = std::array::from_fn(|k| Thick::new(o[k], d[k], thickness));
        let mut pending = Stack::new();
        pending.push(Pending { node: 0, inside });
        Some(Descent { tree: self, axes, pending, at: 0 })
    }

    /// The cell of a node, from the planes above it.
    fn cell(&self, node: usize) -> Bounds3 {
        let (mut index, mut cell) = (0, self.bounds);
        while index < node
            && let Node::Inner { axis, above, split } = self.nodes[index]
        {
            let is_above = node >= above as usize;
            index = if is_above { above as usize } else { index + 1 };
            cell = halves(cell, usize::from(axis), split)[usize::from(is_above)];
        }
        cell
    }

    /// The cells that are not divided, in the order of the tree.
    pub fn leaves(&self) -> impl Iterator<Item = Leaf<'_>> {
        let mut pending = vec![(0, self.bounds)];
        std::iter::from_fn(move || {
            loop {
                let (index, bounds) = pending.pop()?;
                match self.nodes[index] {
                    Node::Leaf { first, count } => {
                        return Some(Leaf { bounds, primitives: self.leaf(first, count) });
                    }
                    Node::Inner { axis, above, split } => {
                        let [below_cell, above_cell] = halves(bounds, usize::from(axis), split);
                        pending.push((above as usize, above_cell));
                        pending.push((index + 1, below_cell));
                    }
                }
            }
        })
    }

    #[inline(always)]
    fn leaf(&self, first: u32, count: u32) -> &[PrimitiveId] {
        &self.primitives[first as usize..][..count as usize]
    }

    /// Checks that the tree is one: every node reached once, no deeper than allowed, planes inside
    /// their cells, and every one of these primitives, once, in all cells that it comes into.
    ///
    /// # Errors
    /// What is wrong, and where.
    pub fn validate<'p>(&self, all: impl Into<Subset<'p>>) -> Result<(), String> {
        let all: Vec<PrimitiveId> = all.into().iter().collect();
        let (mut next_node, mut next_primitive) = (0, 0);
        let mut pending = vec![(0, self.bounds, 0, all)];
        while let Some((index, cell, depth, inside)) = pending.pop() {
            if index != next_node {
                return Err(format!("node {index} follows {next_node} nodes"));
            }
            next_node += 1;
            if depth > self.max_depth {
                return Err(format!("node {index} is {depth} deep, more than {}", self.max_depth));
            }
            match self.nodes[index] {
                Node::Inner { axis, above, split } => {
                    let axis = usize::from(axis);
                    if !(cell.min[axis] < split && split < cell.max[axis]) {
                        return Err(format!("node {index} is split outside its cell"));
                    }
                    let [below_half, above_half] = halves(cell, axis, split);
                    let near = |half: Bounds3| {
                        inside.iter().copied().filter(|&p| self.comes_near(p, half)).collect()
                    };
                    pending.push((above as usize, above_half, depth + 1, near(above_half)));
                    pending.push((index + 1, below_half, depth + 1, near(below_half)));
                }
                Node::Leaf { first, count } => {
                    if first != next_primitive {
                        return Err(format!("leaf {index} does not follow the one before"));
                    }
                    next_primitive += count;
                    let listed = self.leaf(first, count);
                    if listed.windows(2).any(|pair| pair[0] >= pair[1]) {
                        return Err(format!("leaf {index} lists a primitive twice"));
                    }
                    if let Some(missing) = inside.iter().find(|p| !listed.contains(p)) {
                        return Err(format!("{missing:?} is missing in leaf {index}, {cell:?}"));
                    }
                }
            }
        }
        if next_node != self.nodes.len() || next_primitive as usize != self.primitives.len() {
            return Err(format!("{next_node} of {} nodes are reached", self.nodes.len()));
        }
        Ok(())
    }

    /// Whether a point of the primitive is in the cell.
    fn comes_near(&self, primitive: PrimitiveId, cell: Bounds3) -> bool {
        match self.scene.shape(primitive) {
            Shape::Triangle(index) => !clipped(self.scene.mesh.corners(index), cell).is_empty(),
            Shape::Sphere(index) => {
                let sphere = self.scene.spheres[index].shape;
                let nearest = sphere.center.clamp(cell.min, cell.max);
                sphere.center.distance(nearest) <= sphere.radius
            }
        }
    }
}

impl Traversal for KdTree<'_> {
    /// Visits the cells along the ray until one holds a hit, or any will do.
    #[inline]
    fn walk<O: Observer>(&self, query: Query<&Ray>, observer: &mut O) -> Option<Hit> {
        let Query { ray, range, wanted } = query;
        let descent = self.descent(ray, range)?;
        search(descent, Probe::new(self.scene, ray, range), false, wanted, observer)
    }
}

/// The leaves along a ray. What is pending ends with the nearest.
struct Descent<'t> {
    tree: &'t KdTree<'t>,
    axes: [Thick; 3],
    pending: Stack,
    /// The leaf that came last.
    at: usize,
}

impl<'t> RayCells<'t> for Descent<'t> {
    #[inline(always)]
    fn next<O: Observer>(&mut self, max: f64, observer: &mut O) -> Option<CellEntry<'t>> {
        let tree = self.tree;
        let Pending { node, mut inside } = loop {
            let pending = self.pending.pop()?;
            if pending.inside.min <= max {
                break pending;
            }
        };
        inside.max = inside.max.min(max);
        let mut index = node as usize;
        loop {
            observer.region(&|| tree.cell(index));
            observer.cell_visit();
            match tree.nodes[index] {
                Node::Inner { axis, above, split } => {
                    let axis = &self.axes[usize::from(axis)];
                    let (below, above) = (index + 1, above as usize);
                    let (near, far) = if axis.negative { (above, below) } else { (below, above) };
                    index = match axis.divide(split, inside) {
                        Sides::Near => near,
                        Sides::Far => far,
                        Sides::Both { near: first, far: later } => {
                            self.pending.push(Pending { node: far as u32, inside: later });
                            inside = first;
                            near
                        }
                    };
                }
                Node::Leaf { first, count } => {
                    self.at = index;
                    return Some((inside.min, tree.leaf(first, count)));
                }
            }
        }
    }

    fn bounds(&self) -> Bounds3 {
        self.tree.cell(self.at)
    }
}

#[cfg(test)]
mod tests;
