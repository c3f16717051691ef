//! « Accélération matérielle », on the processor: eight boxes, then eight triangles at a time.

mod choice;
mod collapse;
mod decide;
mod few;
mod filter;
mod lanes;
mod leaf;
mod packet;
mod ray;
mod spheres;
mod walk;

use std::collections::HashSet;

use glam::DVec3;
use lancer_core::geometry::{ConvexVolume, Interval, Ray};
use lancer_core::intersector::{
    BeamIndex, BeamTraversal, Hit, Intersector, Observer, Probe, Query, Wanted,
};
use lancer_core::lanes::{Kernel, Scalar};
use lancer_core::scene::{PrimitiveId, Scene, Subset};
use lancer_core::with_lanes;

use crate::binary_tree::{BinaryTree, Coverage};
use crate::bvh::Items;
use crate::four_boxes::{Frame, FrameBox};
use crate::front::Front;
use collapse::WIDTH;
use few::{FEW, Few};
use lanes::Lanes;
use leaf::{HEADER, RECORD, UNIT, integer_of};

/// A hierarchy of eight children per node: culled eight at a time in `f32`, answered in `f64`.
///
/// *Built* from the binary tree of [`crate::Bvh`], grown down to pairs of primitives, by the cheapest
/// collapse (dynamic programming): a node takes in up to eight descendants, a leaf up to eight triangles. Where boxes
/// overlap, as those of long diagonal triangles do, a second tree is built in which triangles are split by planes
/// and may be in several leaves, each with a part of its box; rays of a fixed seed try both. [`Wide::fast`] takes the
/// first.
///
/// *Walked* near to far: eight boxes, then eight triangles are tested together.
///
/// *Wins* where the processor has vectors of eight (plates 4.7, 4.10). *Loses* what they gain where it has
/// none, and to [`crate::ObvhsCwbvh`] in memory.
///
/// *Sources:* Wald, Benthin and Boulos, *Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using
/// Multi-branching BVHs*, RT 2008; the collapse: Ylitie, Karras and Laine, HPG 2017; the splits: Stich, Friedrich and
/// Dietrich, HPG 2009.
///
/// ```text
/// node, 256 bytes     lowest x [8]  highest x [8]  lowest y [8]  …  highest z [8]   f32, rounded outwards
///                     child [8]     a node, or a leaf and its number of primitives
/// leaf                its triangles, row by row: see `leaf.rs`
/// ```
///
/// All coordinates are those of the scene's own frame, [−1, 1]³: `f32` keeps its digits wherever the scene
/// is.
///
/// # What makes it fast, and what keeps it exact
///
/// - Eight slabs take 6 multiply-adds, 6 minima and maxima and one comparison; one box takes as many. What
///   vectors gain over the same lane by lane, and threads over one, is plate 4.10's.
/// - Children are visited near to far. With one or two of them met the nearer never passes through the stack.
/// - Triangles are filtered eight at a time in `f32`, against *bounds* instead of 0: the filter keeps all that
///   `f64` might accept. Most that it keeps are *certain*: `f64` must accept them too, so they shorten
///   the ray at once, and a shadow ray ends there without any `f64`.
/// - `f64` decides among the few that are left, at the end of the walk. Nearly always that is one certain hit, of
///   which four rays are solved at once where many are asked together, and the triangle that the ray leaves, whose
///   plane it meets outside its range. The answer is that of [`lancer_core::intersector::LinearScan`], bit for bit.
/// - The ray stays in memory, and what tests boxes in registers. A ray's own numbers are read one by one: most rays
///   have been written just before.
/// - Rays of one origin are walked as a packet, [`Intersector::closest_hits`]; what that gains is plate 4.9's.
/// - Up to 16 primitives have no tree: `f64` asks them four at a time, or four rays at a time, by the formulas of
///   one, which stand once for any number of lanes ([`lancer_core::geometry::Real`]). So are the spheres of a leaf.
///
#[doc = include_str!("bounds.md")]
pub struct Wide<'s> {
    scene: &'s Scene,
    frame: Frame,
    /// The first is the root.
    nodes: Vec<Node>,
    /// Words of leaves.
    leaves: Vec<f32>,
    /// The primitives, if they are so few that there is no tree.
    few: Option<Few>,
    kernel: Kernel,
}

/// What rays may cost in a tree of split primitives, as a share of the cost in one of whole primitives: it is larger.
const WORTH: f64 = 0.97;

/// An inner node. A lane without a child has an empty box, which no ray meets.
#[repr(align(64))]
#[derive(Clone, Debug)]
struct Node {
    /// Per axis the lowest coordinates and the highest.
    planes: [[[f32; WIDTH]; 2]; 3],
    children: [Child; WIDTH],
}

impl Node {
    const EMPTY: Self = {
        let (low, high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Self { planes: [[low, high]; 3], children: [Child(0); WIDTH] }
    };

    fn bounds(&self, lane: usize) -> FrameBox {
        let [x, y, z] = self.planes.map(|[low, high]| [low[lane], high[lane]]);
        FrameBox { min: [x[0], y[0], z[0]].into(), max: [x[1], y[1], z[1]].into() }
    }
}

/// A node's index; or a leaf: bit 31, whether it has spheres: bit 30, its primitives less one: bits 27 to
/// 29, and where its words begin, in units.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Child(u32);

impl Child {
    fn node(index: usize) -> Self {
        Self(index as u32)
    }

    /// # Panics
    /// If the words are too many: 2 GiB of them, some 35 million triangles.
    fn leaf(offset: usize, count: usize, spheres: bool) -> Self {
        let unit = (offset / UNIT) as u32;
        assert!(offset / UNIT < 1 << 27, "the leaves of `wide` take no more than 2 GiB");
        Self(1 << 31 | u32::from(spheres) << 30 | (count as u32 - 1) << 27 | unit)
    }

    #[inline(always)]
    fn is_leaf(self) -> bool {
        self.0 >> 31 != 0
    }

    #[inline(always)]
    fn has_spheres(self) -> bool {
        self.0 >> 30 & 1 != 0
    }

    #[inline(always)]
    fn count(self) -> usize {
        (self.0 >> 27 & 7) as usize + 1
    }

    #[inline(always)]
    fn offset(self) -> usize {
        (self.0 & ((1 << 27) - 1)) as usize * UNIT
    }
}

impl<'s> Wide<'s> {
    /// Builds the tree; of up to 16 primitives there is none.
    pub fn build(primitives: impl Into<Subset<'s>>) -> Self {
        Self::with_kernel(primitives.into(), Kernel::best())
    }

    /// Builds the tree of whole primitives alone: sooner where boxes overlap, but rays are slower there.
    pub fn fast(primitives: impl Into<Subset<'s>>) -> Self {
        Self::of(&Items::of(&primitives.into()).whole().0, Kernel::best())
    }

    /// What [`Wide::build`] builds, without the processor's vectors: what other processors have.
    pub fn scalar(primitives: impl Into<Subset<'s>>) -> Self {
        Self::with_kernel(primitives.into(), Kernel::Scalar(Scalar))
    }

    /// Whether [`Wide::build`] makes use of vectors of this processor.
    pub fn has_vectors() -> bool {
        !matches!(Kernel::best(), Kernel::Scalar(_))
    }

    fn with_kernel(primitives: Subset<'s>, kernel: Kernel) -> Self {
        if primitives.len() > FEW {
            return Self::tree(primitives, kernel);
        }
        let none = Self::tree(primitives.scene().subset([]), kernel);
        Self { few: Some(Few::new(&primitives)), ..none }
    }

    /// A tree, of however few.
    fn tree(primitives: Subset<'s>, kernel: Kernel) -> Self {
        let mut items = Items::of(&primitives);
        let (tree, overlap) = items.whole();
        let whole = Self::of(&tree, kernel);
        if !overlap {
            return whole;
        }
        let split = Self::of(&items.split(), kernel);
        let [of_whole, of_split] = [&whole, &split].map(|wide| choice::cost(wide, &primitives));
        if of_split < WORTH * of_whole { split } else { whole }
    }

    fn of(tree: &BinaryTree<'s>, kernel: Kernel) -> Self {
        let collapse::Collapsed { nodes, leaves } = collapse::collapse(tree);
        Self { scene: tree.scene, frame: tree.frame, nodes, leaves, few: None, kernel }
    }

    /// Bytes held by the index, without the scene it borrows.
    pub fn memory(&self) -> usize {
        let few = self.few.as_ref().map_or(0, Few::memory);
        size_of_val(self.nodes.as_slice()) + size_of_val(self.leaves.as_slice()) + few
    }

    /// Checks that every box contains what is below it, that the boxes of the leaves with one of these primitives cover
    /// it, and that primitives are not split into more parts than they may be.
    pub fn validate<'p>(&self, primitives: impl Into<Subset<'p>>) -> Result<(), String> {
        let primitives = primitives.into();
        if let Some(few) = &self.few {
            let are_all = few.primitives().eq(primitives.iter());
            return if are_all { Ok(()) } else { Err("it has not the primitives".into()) };
        }
        let most = Items::most_parts(primitives.len());
        let mut coverage = Coverage::new(primitives, self.nodes.len());
        let mut pending = if self.nodes.is_empty() { Vec::new() } else { vec![(0, 0)] };
        while let Some((index, depth)) = pending.pop() {
            coverage.node()?;
            if depth >= walk::MOST_LEVELS {
                return Err(format!("node {index} is {depth} levels deep"));
            }
            let node = &self.nodes[index];
            for (lane, &child) in node.children.iter().enumerate() {
                let bounds = node.bounds(lane);
                if bounds == FrameBox::EMPTY {
                    continue;
                }
                if child.is_leaf() {
                    let primitives: Vec<PrimitiveId> = self.primitives(child).collect();
                    coverage.parts(bounds, &primitives)?;
                    continue;
                }
                let child = child.0 as usize;
                let below =
                    self.nodes.get(child).ok_or_else(|| format!("there is no node {child}"))?;
                // An empty lane is in every box.
                if !(0..WIDTH).all(|lane| bounds.contains(below.bounds(lane))) {
                    return Err(format!("node {child} sticks out of node {index}"));
                }
                pending.push((child, depth + 1));
            }
        }
        coverage.all_parts(&self.frame, most)
    }

    /// The words of a leaf of triangles, as far as eight lanes of them are read at once.
    #[inline(always)]
    fn words(&self, leaf: Child) -> &[f32] {
        &self.leaves[leaf.offset()..][..HEADER + 8 * leaf.count() + WIDTH]
    }

    /// Where the record of a leaf's triangle begins, among all words.
    #[inline(always)]
    fn record(leaf: Child, lane: usize) -> u32 {
        (leaf.offset() + HEADER + 9 * leaf.count() + RECORD * lane) as u32
    }

    /// A triangle by its record, and its corners' indices.
    #[inline(always)]
    fn triangle(&self, record: u32) -> (PrimitiveId, [usize; 3]) {
        let words = &self.leaves[record as usize..][..RECORD];
        let index = |k: usize| integer_of(words[k]) as usize;
        (PrimitiveId(integer_of(words[0])), [index(1), index(2), index(3)])
    }

    #[inline(always)]
    fn corners(&self, [a, b, c]: [usize; 3]) -> [DVec3; 3] {
        let positions = &self.scene.mesh.positions;
        [positions[a], positions[b], positions[c]]
    }

    /// The primitives of a leaf.
    #[inline(always)]
    fn primitives(&self, leaf: Child) -> impl Iterator<Item = PrimitiveId> {
        (0..leaf.count()).map(move |lane| {
            let word = if leaf.has_spheres() {
                leaf.offset() + HEADER + lane
            } else {
                Self::record(leaf, lane) as usize
            };
            // Without a check nothing is left of an observer's loop where nobody watches.
            PrimitiveId(self.leaves.get(word).map_or(u32::MAX, |&word| integer_of(word)))
        })
    }

    #[inline(always)]
    fn watch_leaf<O: Observer>(&self, leaf: Child, observer: &mut O) {
        self.primitives(leaf).for_each(|primitive| observer.primitive_test(primitive));
    }

    #[inline(always)]
    fn watch_node<O: Observer>(&self, node: &Node, observer: &mut O) {
        for lane in 0..WIDTH {
            observer.region(&|| self.frame.in_scene(node.bounds(lane)));
            observer.box_test();
        }
    }

    #[inline(always)]
    fn closest<O: Observer>(&self, ray: &Ray, range: Interval, observer: &mut O) -> Option<Hit> {
        with_lanes!(self.kernel, self.closest_by(ray, range, observer))
    }

    #[inline(always)]
    fn any<O: Observer>(
        &self,
        ray: &Ray,
        range: Interval,
        observer: &mut O,
    ) -> Option<PrimitiveId> {
        with_lanes!(self.kernel, self.any_by(ray, range, observer))
    }

    #[inline(always)]
    fn closest_by<L: Lanes, O: Observer>(
        &self,
        lanes: L,
        ray: &Ray,
        range: Interval,
        observer: &mut O,
    ) -> Option<Hit> {
        match &self.few {
            Some(few) => few.closest(lanes, ray, range, observer),
            None => walk::closest(lanes, self, ray, range, observer),
        }
    }

    #[inline(always)]
    fn any_by<L: Lanes, O: Observer>(
        &self,
        lanes: L,
        ray: &Ray,
        range: Interval,
        observer: &mut O,
    ) -> Option<PrimitiveId> {
        match &self.few {
            Some(few) => few.any(lanes, ray, range, observer),
            None => walk::any(lanes, self, ray, range, observer),
        }
    }

    #[inline(always)]
    fn closest_hits_by<L: Lanes>(
        &self,
        lanes: L,
        rays: &[Ray],
        range: Interval,
        hits: &mut [Option<Hit>],
    ) {
        match &self.few {
            Some(few) => few.closest_hits(lanes, rays, range, hits),
            None => packet::closest(lanes, self, rays, range, hits),
        }
    }

    #[inline(always)]
    fn occluded_all_by<L: Lanes>(
        &self,
        lanes: L,
        rays: &[Ray],
        range: Interval,
        occluded: &mut [bool],
    ) {
        if let Some(few) = &self.few {
            return few.occluded_all(lanes, rays, range, occluded);
        }
        for (ray, occluded) in rays.iter().zip(occluded) {
            *occluded = walk::any(lanes, self, ray, range, &mut ()).is_some();
        }
    }
}

impl Intersector for Wide<'_> {
    fn closest_hit(&self, ray: &Ray, range: Interval) -> Option<Hit> {
        self.closest(ray, range, &mut ())
    }

    fn closest_hits(&self, rays: &[Ray], range: Interval, hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one answer for each ray");
        with_lanes!(self.kernel, self.closest_hits_by(rays, range, hits));
    }

    fn occluded(&self, ray: &Ray, range: Interval) -> bool {
        self.any(ray, range, &mut ()).is_some()
    }

    fn occluded_all(&self, rays: &[Ray], range: Interval, occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "one answer for each ray");
        with_lanes!(self.kernel, self.occluded_all_by(rays, range, occluded));
    }

    fn watch(&self, query: Query<&Ray>, mut observer: &mut dyn Observer) -> Option<Hit> {
        let Query { ray, range, wanted } = query;
        match wanted {
            Wanted::Closest => self.closest(ray, range, &mut observer),
            Wanted::Any => {
                let mut probe = Probe::new(self.scene, ray, range);
                probe.test(self.any(ray, range, &mut observer)?);
                probe.best()
            }
        }
    }

    fn beams(&self) -> Option<&dyn BeamIndex> {
        Some(self)
    }
}

impl BeamTraversal for Wide<'_> {
    /// Opens the nearest node that the beam may meet, until the nearest of all is a primitive. Each comes once, in
    /// order of depth and id; one of several parts with the nearest of those that the beam may meet. Boxes are
    /// decided in `f64`: a beam has a dozen half-spaces, and few boxes need them all.
    fn walk_beam<O: Observer>(
        &self,
        volume: &ConvexVolume,
        far: f64,
        observer: &mut O,
        visit: impl FnMut(PrimitiveId) -> f64,
    ) {
        let mut tested = HashSet::new();
        let root = (!self.nodes.is_empty()).then_some(Child::node(0));
        let mut front = Front::new(self.scene, volume, far, observer);
        for primitive in self.few.iter().flat_map(Few::primitives) {
            front.primitive(primitive, f64::NEG_INFINITY);
        }
        front.search(root, visit, |front, child, found| {
            if child.is_leaf() {
                for primitive in self.primitives(child) {
                    if tested.insert(primitive) {
                        front.primitive(primitive, found);
                    }
                }
                return;
            }
            let node = &self.nodes[child.0 as usize];
            for (lane, &child) in node.children.iter().enumerate() {
                let bounds = node.bounds(lane);
                if bounds != FrameBox::EMPTY {
                    front.node(&self.frame.in_scene(bounds), child);
                }
            }
        });
    }
}

#[cfg(test)]
mod tests;
