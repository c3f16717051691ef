//! What the trees share that split space instead of sets of primitives.

use glam::DVec3;
use lancer_core::geometry::Bounds3;
use lancer_core::scene::PrimitiveId;
use smallvec::SmallVec;

/// A leaf of a tree that splits space: a cell and the primitives in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaf<'t> {
    /// The cell. Neighbours share a face, all leaves together fill the tree's box.
    pub bounds: Bounds3,
    /// What comes near the cell.
    pub primitives: &'t [PrimitiveId],
}

/// What two boxes have in common.
pub(crate) fn common(a: Bounds3, b: Bounds3) -> Bounds3 {
    Bounds3 { min: a.min.max(b.min), max: a.max.min(b.max) }
}

/// The deepest a tree over `primitives` primitives may be, after Havran, *Heuristic Ray Shooting
/// Algorithms*, 2000, as Pharr, Jakob and Humphreys round it.
pub(crate) fn depth_limit(primitives: usize) -> u32 {
    8 + (1.3 * (primitives.max(1) as f64).log2()) as u32
}

/// A tree's leaves name at most this many primitives for each of the scene: where primitives cross
/// each other the same ones end up on both sides of every plane, and a tree would fill the memory.
/// A node that may not be split any more becomes a leaf.
pub(crate) const REFERENCES_PER_PRIMITIVE: usize = 16;

/// Shares what a node may still name between its children, in proportion to what they name already.
pub(crate) fn shared_allowance(allowance: usize, children: [usize; 2]) -> [usize; 2] {
    let [first, second] = children;
    let to_first = (allowance as u128 * first as u128 / (first + second).max(1) as u128) as usize;
    [to_first, allowance - to_first]
}

/// A node of fewer references has its subtrees built one after the other: handing them to
/// another thread would take as long.
pub(crate) const PARALLEL: usize = 4096;

/// A convex polygon.
pub(crate) type Polygon = SmallVec<[DVec3; 4]>;

/// The part of a convex polygon that is on the side of a plane where `distance` is at most 0.
///
/// The other half, clipped by −`distance`, has the very same new corners. Source: Sutherland, Hodgman,
/// *Reentrant Polygon Clipping*, CACM 17(1), 1974.
pub(crate) fn clip(polygon: &[DVec3], distance: impl Fn(DVec3) -> f64) -> Polygon {
    let mut part = Polygon::new();
    let Some(&last) = polygon.last() else { return part };
    let (mut from, mut from_distance) = (last, distance(last));
    for &to in polygon {
        let to_distance = distance(to);
        if (from_distance < 0.0 && to_distance > 0.0) || (from_distance > 0.0 && to_distance < 0.0)
        {
            part.push(from + (to - from) * (from_distance / (from_distance - to_distance)));
        }
        if to_distance <= 0.0 {
            part.push(to);
        }
        (from, from_distance) = (to, to_distance);
    }
    part
}

/// Scenes on which builders of trees go wrong.
#[cfg(test)]
pub(crate) mod hard {
    use glam::{DAffine3, DVec3};
    use lancer_core::generate::{icosphere, sphere_flake};
    use lancer_core::scene::{MaterialId, Mesh, Scene};
    use rand_pcg::Pcg64;
    use rand_pcg::rand_core::Rng;

    /// Random points in the cube [−1, 1]³.
    pub(crate) fn points(seed: u128) -> impl FnMut() -> DVec3 {
        let mut random = Pcg64::new(seed, 1);
        let mut coordinate = move || f64::from(random.next_u32()) / f64::from(1_u32 << 31) - 1.0;
        move || DVec3::new(coordinate(), coordinate(), coordinate())
    }

    /// Triangles of a given size at random.
    pub(crate) fn soup(count: usize, size: f64) -> Mesh {
        let mut point = points(3);
        let mut mesh = Mesh::default();
        for _ in 0..count {
            let corner = point();
            push(&mut mesh, [corner, corner + size * point(), corner + size * point()]);
        }
        mesh
    }

    fn push(mesh: &mut Mesh, corners: [DVec3; 3]) {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners);
        mesh.push_face(MaterialId(0), &[[first, first + 1, first + 2]]);
    }

    fn scaled(mesh: &Mesh, scale: DVec3) -> Mesh {
        let mut result = Mesh::default();
        result.append(mesh, DAffine3::from_scale(scale), 0);
        result
    }

    pub(crate) fn scenes() -> Vec<(&'static str, Scene)> {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let repeated = |corners: [DVec3; 3], count: usize| {
            let mut mesh = Mesh::default();
            (0..count).for_each(|_| push(&mut mesh, corners));
            mesh
        };
        let mut uneven = scaled(&soup(100_000, 1e-3), DVec3::new(1.0, 1.0, 0.01));
        push(&mut uneven, [-1e6 * x, 1e6 * y, 1e6 * x + z]);
        let mut far = Mesh::default();
        far.append(&icosphere(3), DAffine3::from_translation(DVec3::new(1e6, -2e6, 3e6)), 0);
        let mut meshes = vec![
            ("nothing", Mesh::default()),
            ("one triangle", repeated([x, y, z], 1)),
            ("identical", repeated([x, y, z], 100_000)),
            ("identical, in an axis plane", repeated([x, y, DVec3::ZERO], 1000)),
            ("points", repeated([x, x, x], 1000)),
            ("points at the origin", repeated([DVec3::ZERO; 3], 1000)),
            ("coplanar", scaled(&soup(3000, 0.1), DVec3::new(1.0, 1.0, 0.0))),
            ("on a line", scaled(&soup(3000, 0.1), DVec3::new(1.0, 0.0, 0.0))),
            ("uneven", uneven),
            ("far from the origin", far),
            ("crossing each other", soup(1000, 1.5)),
        ];
        for scale in [1e-30, 1e30] {
            meshes.push(("of extreme size", scaled(&icosphere(3), DVec3::splat(scale))));
        }
        let mut scenes: Vec<_> =
            meshes.into_iter().map(|(name, mesh)| (name, Scene::of_mesh(mesh))).collect();
        let mut mixed = Scene::of_mesh(icosphere(2));
        mixed.spheres = sphere_flake(3, MaterialId(0));
        scenes.push(("spheres and triangles", mixed));
        scenes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clipped_square_keeps_its_half() {
        let square = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)];
        let square = square.map(|(x, y)| DVec3::new(x, y, 0.0));
        let below = clip(&square, |p| p.x - 0.5);
        assert_eq!(Bounds3::of_points(below.clone()).max, DVec3::new(0.5, 2.0, 0.0));
        let above = clip(&square, |p| 0.5 - p.x);
        assert_eq!(Bounds3::of_points(above).min, DVec3::new(0.5, 0.0, 0.0));
        // A corner, an edge, nothing.
        assert_eq!(clip(&square, |p| p.x + p.y).as_slice(), [DVec3::ZERO]);
        assert_eq!(clip(&square, |p| p.x).len(), 2);
        assert!(clip(&square, |p| p.x + 1.0).is_empty());
        assert!(clip(&[], |p| p.x).is_empty());
    }

    #[test]
    fn an_allowance_is_shared_out_entirely() {
        assert_eq!(shared_allowance(16, [3, 1]), [12, 4]);
        assert_eq!(shared_allowance(16, [0, 0]), [0, 16]);
        let [first, second] = shared_allowance(usize::MAX, [7, 9]);
        assert_eq!(first + second, usize::MAX);
    }
}
