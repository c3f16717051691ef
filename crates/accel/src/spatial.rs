//! What the trees share that split space instead of sets of primitives.
//!
//! Space can be split exactly, rays and primitives cannot be computed exactly. A primitive may be met
//! a rounding error beside itself, and then it must still be found in the cell where it was met. So
//! a primitive is entered into every cell that it comes near, within [`margin`], and a ray
//! visits a cell a little before it gets there and until a little after, within [`thickness`].

use glam::DVec3;
use lancer_core::geometry::{Bounds3, Ray};
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

/// A primitive may be met this much beside its bounds because of their own rounding: clipping it
/// takes a dozen operations on numbers of its size.
pub(crate) fn margin(bounds: Bounds3) -> f64 {
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    16.0 * f64::EPSILON * (farthest + (bounds.max - bounds.min).max_element())
}

/// A box with `margin` more on all sides.
pub(crate) fn grown(bounds: Bounds3, margin: f64) -> Bounds3 {
    Bounds3 { min: bounds.min - margin, max: bounds.max + margin }
}

/// What two boxes have in common.
pub(crate) fn common(a: Bounds3, b: Bounds3) -> Bounds3 {
    Bounds3 { min: a.min.max(b.min), max: a.max.min(b.max) }
}

/// A ray is taken for this thick: it may meet a primitive that much beside the place where it passes.
///
/// Rounding moves a ray by a few ε of the way it goes, at most to the far end of the scene's box. Of
/// two primitives met at the same t one may so seem to be in a cell that the ray reaches later; the
/// factor is the one of [`lancer_core::geometry::Slabs`], measured there to lose no such tie.
pub(crate) fn thickness(ray: &Ray, scene: Bounds3) -> f64 {
    let reach = (scene.min - ray.origin).abs().max((scene.max - ray.origin).abs());
    256.0 * f64::EPSILON * reach.max_element()
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

/// Below this many references in a node its subtrees are built one after the other: handing them to
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
