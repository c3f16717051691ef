//! Chapter 4, « Accélération du lancer de rayons »: indexes that find what a ray meets without asking
//! every primitive.
//!
//! Each is exact: it returns the hit of [`lancer_core::intersector::LinearScan`], the same `t` bit for
//! bit and the same primitive. To that end boxes are culled conservatively and primitives are decided
//! by shared `f64` formulas, those of [`lancer_core::intersector::Probe`].

mod binary_tree;
mod bsp;
mod bvh;
mod cells;
mod four_boxes;
mod four_wide;
mod front;
mod grid;
#[cfg(test)]
mod hard_sets;
mod kd;
mod margins;
mod obvhs_bvh2;
mod obvhs_cwbvh;
mod octree;
mod pending;
mod sah;
mod spatial;
pub mod structures;
mod touching;
mod wide;

pub use binary_tree::{BinaryTree, TreeStatistics};
pub use bsp::{BspBuilder, BspTree, Planes};
pub use bvh::{Bvh, Split, split_at_median};
pub use cells::Cell;
pub use four_boxes::{FourSlabs, Frame};
pub use grid::{Grid, GridBuilder, Lattice};
pub use kd::{KdBuilder, KdTree, Sides};
pub use obvhs_bvh2::ObvhsBvh2;
pub use obvhs_cwbvh::ObvhsCwbvh;
pub use octree::{Octree, OctreeBuilder};
pub use sah::sah_cost;
pub use spatial::Leaf;
pub use wide::Wide;
