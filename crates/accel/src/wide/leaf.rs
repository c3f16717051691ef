//! The words of a leaf.
//!
//! ```text
//! longest edge component s, 64 u s, s²
//! a.x [n] a.y [n] a.z [n]   one corner
//! e.x [n] e.y [n] e.z [n]   from the second to it
//! f.x [n] f.y [n] f.z [n]   from it to the third
//! (id, corners [3]) [n]     what f64 will read; 54 bytes a triangle at n = 8
//! ```
//!
//! Spheres have their ids alone in these words, after the first three.

use lancer_core::scene::{PrimitiveId, Scene, Shape};

use super::filter::U;
use crate::binary_tree::BinaryTree;

/// Edges count as this long at least.
const SHORTEST: f32 = 1.0 / (1 << 20) as f32;
/// Leaves begin at multiples of this many words.
pub(super) const UNIT: usize = 4;
/// Words of a leaf before those of its triangles.
pub(super) const HEADER: usize = 3;
/// Words of a triangle's id and corners.
pub(super) const RECORD: usize = 4;

/// An integer among the words of a leaf. Where it is read as a number, for the sake of its neighbours, it is
/// never a denormal one: computing with those is slow.
///
/// # Panics
/// If it is 2³⁰ or more.
pub(super) fn word_of(integer: u32) -> f32 {
    assert!(integer < TAG, "`wide` takes no more than 2³⁰ triangles and corners");
    f32::from_bits(TAG | integer)
}

#[inline(always)]
pub(super) fn integer_of(word: f32) -> u32 {
    word.to_bits() & (TAG - 1)
}

const TAG: u32 = 1 << 30;

/// Words that a leaf takes.
pub(super) fn words(count: usize, has_spheres: bool) -> usize {
    let per_primitive = if has_spheres { 1 } else { 9 + RECORD };
    (HEADER + per_primitive * count).next_multiple_of(UNIT)
}

/// Whether a leaf of these primitives holds their ids alone.
pub(super) fn has_spheres(scene: &Scene, primitives: &[PrimitiveId]) -> bool {
    primitives.iter().any(|&id| matches!(scene.shape(id), Shape::Sphere(_)))
}

/// Writes a leaf.
pub(super) fn fill(tree: &BinaryTree, primitives: &[PrimitiveId], words: &mut [f32]) {
    let (header, words) = words.split_at_mut(HEADER);
    if has_spheres(tree.scene, primitives) {
        for (word, id) in words.iter_mut().zip(primitives) {
            *word = word_of(id.0);
        }
        return;
    }
    let (mesh, frame) = (&tree.scene.mesh, &tree.frame);
    let count = primitives.len();
    let mut longest = SHORTEST;
    let (rows, records) = words.split_at_mut(9 * count);
    for (lane, (id, record)) in primitives.iter().zip(records.chunks_mut(RECORD)).enumerate() {
        let [a, b, c] = mesh.corners(id.0 as usize);
        // Edges are rounded in proportion to their own length, not to their place.
        let parts = [frame.point(a), frame.vector(a - b), frame.vector(c - a)];
        for (k, part) in parts.into_iter().flat_map(|part| part.to_array()).enumerate() {
            rows[k * count + lane] = part as f32;
            if k >= 3 {
                longest = longest.max((part as f32).abs());
            }
        }
        let [a, b, c] = mesh.triangles[id.0 as usize].vertices;
        record.copy_from_slice(&[id.0, a, b, c].map(word_of));
    }
    header.copy_from_slice(&[longest, 64.0 * U * longest, longest * longest]);
}
