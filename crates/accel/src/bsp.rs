//! « Subdivision spatiale irrégulière »: planes of the faces.

use glam::DVec3;
use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};
use lancer_core::intersector::{Hit, Observer, Probe, Query, Traversal, Wanted};
use lancer_core::scene::{PrimitiveId, Scene, Shape, Subset};
use smallvec::SmallVec;

use crate::margins::{TIES, rounding, slack};
use crate::spatial::{
    PARALLEL, Polygon, REFERENCES_PER_PRIMITIVE, clip, depth_limit, shared_allowance,
};
use crate::touching::surface_points;

/// « Subdivision spatiale irrégulière »: a binary space partition, a tree of planes in any direction,
/// taken from the scene's own polygons.
///
/// *Built* from the top: a few polygons of a cell are asked for their planes, and the plane that
/// parts the cell's primitives best, evenly and cutting few, divides it. What lies in the plane stays
/// at the node, what crosses it goes to both sides (a clipped copy of the polygon tells to which
/// cells further down; the primitive test stays the scene's). A cell becomes a leaf when it is small,
/// or when no plane leaves each side less than nine tenths.
///
/// A face's own plane has all of a convex object on one side: a partition by such planes alone ends
/// in a list. So the planes upright on the faces' edges are candidates as well ([`Planes`]), and for a
/// sphere the three coordinate planes through its centre.
///
/// *Walked* like a kd-tree, near side first, then what lies in the plane, then the far side; a step
/// costs two scalar products instead of a subtraction.
///
/// It takes O(n log n) steps to build when few polygons are cut, and about O(log n) cells for a ray. In the worst
/// case all cross each other and there would be O(n²) pieces: their number is limited, and the leaves grow
/// instead.
///
/// *Wins* where few large walls in oblique directions bound the space: rooms, the levels of games. *Loses* on
/// fine meshes to a kd-tree, since nothing makes it cut off empty space. A million triangles take about 10 s to
/// build.
///
/// *Sources:* Fuchs, Kedem, Naylor, *On Visible Surface Generation by A Priori Tree Structures*,
/// SIGGRAPH 1980; Kaplan, *Space-Tracing, a Constant Time Ray-Tracer*, SIGGRAPH 1985 course notes.
#[doc(alias = "subdivision spatiale irrégulière")]
#[doc(alias = "arbre BSP")]
#[doc(alias = "partition binaire")]
pub struct BspTree<'s> {
    scene: &'s Scene,
    bounds: Bounds3,
    /// What is this close to a plane may be on either side of it: each of up to 50 cuts moves a new corner by
    /// a few ε.
    slack: f64,
    /// The nodes in depth-first order; the first is the root.
    nodes: Vec<Node>,
    /// The primitives of the nodes, node by node.
    primitives: Vec<PrimitiveId>,
    max_depth: u32,
}

#[derive(Clone, Copy)]
enum Node {
    /// A plane and the range of the primitives that lie in it. What is behind it is the next node.
    Inner { plane: Plane, front: u32, first: u32, count: u32 },
    /// A cell that is not divided: a range of the tree's primitives.
    Leaf { first: u32, count: u32 },
}

/// A plane, in coordinates relative to the centre of the scene's box: far from the origin, these lose
/// no digits.
#[derive(Clone, Copy)]
struct Plane {
    /// The unit normal, which points to the front.
    normal: DVec3,
    offset: f64,
}

impl Plane {
    /// The plane through a point; `None` where the normal has no direction.
    fn new(normal: DVec3, point: DVec3) -> Option<Self> {
        let normal = normal.try_normalize()?;
        Some(Self { normal, offset: normal.dot(point) })
    }

    /// How far a point is in front.
    #[inline(always)]
    fn distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }
}

/// Which planes of a polygon may divide a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Planes {
    /// Its own plane: the textbook's auto-partition.
    Faces,
    /// Its own, and those upright on its edges.
    FacesAndEdges,
}

/// How a [`BspTree`] is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BspBuilder {
    /// The planes to choose from.
    pub planes: Planes,
}

impl Default for BspBuilder {
    fn default() -> Self {
        Self { planes: Planes::FacesAndEdges }
    }
}

/// A cell with so few primitives is not divided.
const LEAF: usize = 4;
/// The number of a cell's primitives, spread over its list, that are asked for their planes.
const ASKED: usize = 8;
/// The number, spread in the same way, that tell what a plane is worth.
const JUDGES: usize = 128;
/// A cut polygon weighs this much more than one on the fuller side.
const CUT: usize = 2;

/// A primitive in a cell that is being divided.
struct Piece {
    primitive: PrimitiveId,
    part: Part,
}

/// What of a primitive is in a cell.
enum Part {
    /// The part of a triangle inside the cell.
    Polygon(Polygon),
    Sphere {
        center: DVec3,
        radius: f64,
    },
}

impl Part {
    /// The smallest and the largest distance from a plane.
    fn reach(&self, plane: &Plane) -> [f64; 2] {
        match self {
            Self::Polygon(corners) => corners
                .iter()
                .map(|&corner| plane.distance(corner))
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], d| [a.min(d), b.max(d)]),
            Self::Sphere { center, radius } => {
                let distance = plane.distance(*center);
                [distance - radius, distance + radius]
            }
        }
    }
}

/// Where a piece is, seen from a plane.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Behind,
    Within,
    Front,
    Both,
}

/// A tree as it is built, before it is laid out in memory.
enum Subtree {
    Inner { plane: Plane, within: Vec<PrimitiveId>, children: Box<[Subtree; 2]> },
    Leaf(Box<[PrimitiveId]>),
}

impl BspBuilder {
    /// Builds the tree.
    pub fn build<'s>(self, primitives: impl Into<Subset<'s>>) -> BspTree<'s> {
        let all = primitives.into();
        let (scene, bounds) = (all.scene(), all.bounds());
        let center = bounds.center();
        let pieces: Vec<Piece> = all
            .iter()
            .map(|primitive| {
                let part = match scene.shape(primitive) {
                    Shape::Triangle(index) => {
                        let corners = scene.mesh.corners(index).map(|corner| corner - center);
                        Part::Polygon(Polygon::from_slice(&corners))
                    }
                    Shape::Sphere(index) => {
                        let sphere = scene.spheres[index].shape;
                        Part::Sphere { center: sphere.center - center, radius: sphere.radius }
                    }
                };
                Piece { primitive, part }
            })
            .collect();
        let slack = 16.0 * slack(bounds);
        let max_depth = depth_limit(pieces.len());
        let allowance = REFERENCES_PER_PRIMITIVE * pieces.len();
        let root = self.subtree(pieces, slack, max_depth, allowance);
        let (nodes, primitives) = (Vec::new(), Vec::new());
        let mut tree = BspTree { scene, bounds, slack, nodes, primitives, max_depth };
        tree.lay_out(root);
        tree
    }

    fn subtree(&self, pieces: Vec<Piece>, slack: f64, levels: u32, allowance: usize) -> Subtree {
        let leaf =
            |pieces: &[Piece]| Subtree::Leaf(pieces.iter().map(|piece| piece.primitive).collect());
        if levels == 0 || pieces.len() <= LEAF {
            return leaf(&pieces);
        }
        let Some(plane) = self.best_plane(&pieces, slack) else { return leaf(&pieces) };
        let sides: Vec<Side> =
            pieces.iter().map(|piece| side(&piece.part, &plane, slack)).collect();
        let count = |wanted: Side| sides.iter().filter(|&&side| side == wanted).count();
        let cut = count(Side::Both);
        let fuller = cut + count(Side::Behind).max(count(Side::Front));
        if 10 * fuller > 9 * pieces.len() || pieces.len() + cut > allowance {
            return leaf(&pieces);
        }

        let (mut behind, mut within, mut front) = (Vec::new(), Vec::new(), Vec::new());
        for (piece, side) in pieces.into_iter().zip(sides) {
            match side {
                Side::Behind => behind.push(piece),
                Side::Within => within.push(piece.primitive),
                Side::Front => front.push(piece),
                Side::Both => {
                    let [back_half, front_half] = cut_in_two(piece, &plane);
                    behind.push(back_half);
                    front.push(front_half);
                }
            }
        }
        let parallel = behind.len() + front.len() > PARALLEL;
        let allowances = shared_allowance(allowance - within.len(), [behind.len(), front.len()]);
        let behind = || self.subtree(behind, slack, levels - 1, allowances[0]);
        let front = || self.subtree(front, slack, levels - 1, allowances[1]);
        let (behind, front) =
            if parallel { rayon::join(behind, front) } else { (behind(), front()) };
        Subtree::Inner { plane, within, children: Box::new([behind, front]) }
    }

    /// The plane that parts the pieces best, if there is a plane.
    fn best_plane(&self, pieces: &[Piece], slack: f64) -> Option<Plane> {
        let score = |plane: &Plane| {
            let (mut behind, mut front, mut cut) = (0_usize, 0_usize, 0);
            for piece in spread(pieces, JUDGES) {
                match side(&piece.part, plane, slack) {
                    Side::Behind => behind += 1,
                    Side::Within => {}
                    Side::Front => front += 1,
                    Side::Both => cut += 1,
                }
            }
            behind.max(front) + CUT * cut
        };
        spread(pieces, ASKED).flat_map(|piece| self.planes_of(&piece.part)).min_by_key(score)
    }

    fn planes_of(&self, part: &Part) -> SmallVec<[Plane; 4]> {
        match *part {
            Part::Polygon(ref corners) => {
                let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                let mut planes: SmallVec<[Plane; 4]> =
                    Plane::new(normal, corners[0]).into_iter().collect();
                if self.planes == Planes::FacesAndEdges
                    && let Some(face) = planes.first()
                {
                    let face_normal = face.normal;
                    let next = corners.iter().cycle().skip(1);
                    let edges = corners.iter().zip(next).map(|(&from, &to)| (from, to - from));
                    planes.extend(edges.filter_map(|(from, edge)| {
                        Plane::new(face_normal.cross(edge.normalize_or_zero()), from)
                    }));
                }
                planes
            }
            Part::Sphere { center, .. } => {
                DVec3::AXES.into_iter().filter_map(|axis| Plane::new(axis, center)).collect()
            }
        }
    }
}

/// At most `count` pieces from all over the list: all of a short one, and multiples of the golden ratio of
/// a long one. Equidistant ones would all be the same part of each house in a town.
fn spread(pieces: &[Piece], count: usize) -> impl Iterator<Item = &Piece> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let is_short = pieces.len() <= count;
    (0..count.min(pieces.len())).map(move |k| {
        let place = (k as f64 * GOLDEN).fract() * pieces.len() as f64;
        &pieces[if is_short { k } else { place as usize }]
    })
}

fn side(part: &Part, plane: &Plane, slack: f64) -> Side {
    let [min, max] = part.reach(plane);
    match (min < -slack, max > slack) {
        (true, true) => Side::Both,
        (true, false) => Side::Behind,
        (false, true) => Side::Front,
        (false, false) => Side::Within,
    }
}

/// The halves behind and in front of a plane. Both have the same new corners, so that nothing of the
/// piece is lost, wherever rounding puts the cut. A sphere stays whole.
fn cut_in_two(Piece { primitive, part }: Piece, plane: &Plane) -> [Piece; 2] {
    let parts = match part {
        Part::Polygon(corners) => [
            Part::Polygon(clip(&corners, |p| plane.distance(p))),
            Part::Polygon(clip(&corners, |p| -plane.distance(p))),
        ],
        Part::Sphere { center, radius } => [(); 2].map(|()| Part::Sphere { center, radius }),
    };
    parts.map(|part| Piece { primitive, part })
}

/// The far side of a plane, still to be visited after what lies in the plane.
struct Pending {
    plane: u32,
    far: u32,
    inside: Interval,
}

/// What is still to be visited: never more than a tree is deep, which is less than 64 for any number
/// of primitives that fits an id.
type Stack = SmallVec<[Pending; 64]>;

impl<'s> BspTree<'s> {
    /// Builds the tree with the default parameters.
    pub fn build(primitives: impl Into<Subset<'s>>) -> Self {
        BspBuilder::default().build(primitives)
    }

    /// Appends a subtree to the nodes, what is behind a plane first. As deep as the tree, which has a
    /// limit.
    fn lay_out(&mut self, subtree: Subtree) {
        let index = self.nodes.len();
        let first = self.primitives.len() as u32;
        match subtree {
            Subtree::Leaf(primitives) => {
                self.nodes.push(Node::Leaf { first, count: primitives.len() as u32 });
                self.primitives.extend(primitives);
            }
            Subtree::Inner { plane, within, children } => {
                let count = within.len() as u32;
                self.primitives.extend(within);
                let [behind, in_front] = *children;
                self.nodes.push(Node::Inner { plane, front: 0, first, count });
                self.lay_out(behind);
                let front = self.nodes.len() as u32;
                self.nodes[index] = Node::Inner { plane, front, first, count };
                self.lay_out(in_front);
            }
        }
    }

    /// Bytes held by the index, without the scene it borrows.
    pub fn memory(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.primitives.as_slice())
    }

    /// The primitives of a leaf, or in the plane of an inner node.
    #[inline(always)]
    fn primitives_of(&self, node: &Node) -> &[PrimitiveId] {
        let (&Node::Inner { first, count, .. } | &Node::Leaf { first, count }) = node;
        &self.primitives[first as usize..][..count as usize]
    }

    /// [`BspTree::walk`] that also tells the nodes that are leaves.
    #[inline(always)]
    fn walk_leaves<O: Observer>(
        &self,
        query: Query<&Ray>,
        observer: &mut O,
        mut enter_leaf: impl FnMut(usize),
    ) -> Option<Hit> {
        let Query { ray, range, wanted } = query;
        let mut probe = Probe::new(self.scene, ray, range);
        // Rounding may move the ray, or the polygon that it meets, across a plane.
        let thickness = TIES * rounding(ray, self.bounds)? + 2.0 * self.slack;
        let bounds = self.bounds.grown(thickness);
        let mut inside = Slabs::new(ray).cross(bounds.min, bounds.max, range)?;
        let origin = ray.origin - self.bounds.center();
        let test_all = |probe: &mut Probe, observer: &mut O, node: &Node| {
            self.primitives_of(node).iter().any(|&primitive| {
                observer.primitive_test(primitive);
                probe.test(primitive) && wanted == Wanted::Any
            })
        };
        let mut stack = Stack::new();
        let mut index = 0;
        loop {
            // A copy: `inside` itself stays in registers only if nobody borrows it.
            let piece = [inside.min, inside.max];
            observer.region(&|| Bounds3::of_points(piece.map(|t| ray.at(t))));
            observer.cell_visit();
            let node = &self.nodes[index];
            if let Node::Inner { plane, front, .. } = node {
                let height = plane.distance(origin);
                let rise = plane.normal.dot(ray.direction);
                // In a ray parallel to the plane the two are ∞ on one side, −∞ and ∞ in the plane;
                // NaN compares as neither before nor after anything.
                let half = thickness.copysign(rise);
                let (reached, left) = ((-half - height) / rise, (half - height) / rise);
                let (behind, front) = (index + 1, *front as usize);
                let rises = rise.is_sign_positive();
                let (near, far) = if rises { (behind, front) } else { (front, behind) };
                index = if reached > inside.max {
                    near
                } else if left < inside.min {
                    far
                } else {
                    let mut later = inside;
                    if reached > later.min {
                        later.min = reached;
                    }
                    stack.push(Pending { plane: index as u32, far: far as u32, inside: later });
                    if left < inside.max {
                        inside.max = left;
                    }
                    near
                };
                continue;
            }
            enter_leaf(index);
            if test_all(&mut probe, observer, node) {
                return probe.best();
            }
            // A hit may lie beyond the cell that it was found in: what comes before it still counts.
            let best = probe.range().max;
            let next = loop {
                match stack.pop() {
                    Some(pending) if pending.inside.min <= best => break pending,
                    Some(_) => {}
                    None => return probe.best(),
                }
            };
            if test_all(&mut probe, observer, &self.nodes[next.plane as usize]) {
                return probe.best();
            }
            index = next.far as usize;
            inside = Interval { min: next.inside.min, max: next.inside.max.min(best) };
        }
    }

    /// The node that is the cell around a point, of two neighbours the one in front.
    fn node_at(&self, point: DVec3) -> usize {
        let point = point - self.bounds.center();
        let mut index = 0;
        while let Node::Inner { plane, front, .. } = &self.nodes[index] {
            index = if plane.distance(point) < 0.0 { index + 1 } else { *front as usize };
        }
        index
    }

    /// The number of a leaf among all leaves, in the order of the tree.
    fn number(&self, leaf: usize) -> usize {
        self.nodes[..leaf].iter().filter(|node| matches!(node, Node::Leaf { .. })).count()
    }

    /// The number of the cell around a point, and what is in it. The cells are convex polyhedra; for a
    /// drawing it is enough to ask at every pixel.
    pub fn leaf_at(&self, point: DVec3) -> (usize, &[PrimitiveId]) {
        let node = self.node_at(point);
        (self.number(node), self.primitives_of(&self.nodes[node]))
    }

    /// The numbers of the cells that the search for the closest hit visits, in this order.
    pub fn visited_leaves(&self, ray: &Ray, range: Interval) -> Vec<usize> {
        let mut visited = Vec::new();
        self.walk_leaves(Query::closest(ray, range), &mut (), |node| visited.push(node));
        visited.into_iter().map(|node| self.number(node)).collect()
    }

    /// Checks that the tree is one: every node reached once, no deeper than allowed, and every one of
    /// these primitives, at points all over it, in the cells or the planes that are there.
    ///
    /// # Errors
    /// What is wrong, and where.
    pub fn validate<'p>(&self, all: impl Into<Subset<'p>>) -> Result<(), String> {
        let center = self.bounds.center();
        let points: Vec<(PrimitiveId, DVec3)> = all
            .into()
            .iter()
            .flat_map(|primitive| {
                surface_points(self.scene, primitive)
                    .into_iter()
                    .map(move |p| (primitive, p - center))
            })
            .collect();
        let (mut next_node, mut next_primitive) = (0, 0);
        let mut pending = vec![(0, 0, points)];
        while let Some((index, depth, mut points)) = pending.pop() {
            if index != next_node {
                return Err(format!("node {index} follows {next_node} nodes"));
            }
            next_node += 1;
            if depth > self.max_depth {
                return Err(format!("node {index} is {depth} deep, more than {}", self.max_depth));
            }
            let node = &self.nodes[index];
            let (&Node::Inner { first, count, .. } | &Node::Leaf { first, count }) = node;
            if first != next_primitive {
                return Err(format!("node {index}: primitives do not follow the ones before"));
            }
            next_primitive += count;
            let listed = self.primitives_of(node);
            if listed.windows(2).any(|pair| pair[0] >= pair[1]) {
                return Err(format!("node {index} lists a primitive twice"));
            }
            match node {
                Node::Inner { plane, front, .. } => {
                    // Where a point is within rounding of a plane, both of its sides will do.
                    let height = |point: DVec3| plane.distance(point);
                    points.retain(|&(primitive, point)| {
                        height(point).abs() > 2.0 * self.slack
                            && listed.binary_search(&primitive).is_err()
                    });
                    let (behind, in_front) =
                        points.into_iter().partition(|&(_, point)| height(point) < 0.0);
                    pending.push((*front as usize, depth + 1, in_front));
                    pending.push((index + 1, depth + 1, behind));
                }
                Node::Leaf { .. } => {
                    let missing = points.iter().find(|(primitive, _)| !listed.contains(primitive));
                    if let Some((primitive, point)) = missing {
                        return Err(format!("{primitive:?} is missing in leaf {index} at {point}"));
                    }
                }
            }
        }
        if next_node != self.nodes.len() || next_primitive as usize != self.primitives.len() {
            return Err(format!("{next_node} of {} nodes are reached", self.nodes.len()));
        }
        Ok(())
    }
}

impl Traversal for BspTree<'_> {
    /// Visits the cells along the ray until one holds a hit, or any will do.
    #[inline]
    fn walk<O: Observer>(&self, query: Query<&Ray>, observer: &mut O) -> Option<Hit> {
        self.walk_leaves(query, observer, |_| {})
    }
}

#[cfg(test)]
mod tests;
