//! What a beam meets, by the grid.

use std::collections::HashSet;

use glam::{DVec3, IVec3};
use lancer_core::geometry::ConvexVolume;
use lancer_core::intersector::{BeamTraversal, Observer};
use lancer_core::scene::PrimitiveId;

use super::{Grid, Lattice};
use crate::front::Front;

impl BeamTraversal for Grid<'_> {
    /// Halves the lattice, and each half that the beam may meet, down to single cells, nearest first. The
    /// halves are computed, not stored. A primitive is tested in the first of its cells only, and visited
    /// once.
    fn walk_beam<O: Observer>(
        &self,
        volume: &ConvexVolume,
        far: f64,
        observer: &mut O,
        visit: impl FnMut(PrimitiveId) -> f64,
    ) {
        let mut tested = HashSet::new();
        let everything = [IVec3::ZERO, self.lattice.resolution - 1];
        let root = (!self.primitives.is_empty()).then_some(everything);
        Front::new(self.scene, volume, far, observer).search(
            root,
            visit,
            |front, [low, high], depth| {
                if low == high {
                    front.cell();
                    for &primitive in self.row(low) {
                        if tested.insert(primitive) {
                            front.primitive(primitive, depth);
                        }
                    }
                    return;
                }
                for [low, high] in self.lattice.halves([low, high]) {
                    let bounds =
                        self.lattice.bounds(low).union(self.lattice.bounds(high)).grown(self.slack);
                    front.node(&bounds, [low, high]);
                }
            },
        );
    }
}

impl Lattice {
    /// The cells from one to another in two halves, across their longest side.
    fn halves(&self, [low, high]: [IVec3; 2]) -> [[IVec3; 2]; 2] {
        let counts = high - low + 1;
        let sides =
            DVec3::select(counts.cmpgt(IVec3::ONE), counts.as_dvec3() * self.width, DVec3::NEG_ONE);
        let axis = sides.max_position();
        let (mut below, mut above) = (high, low);
        below[axis] = low[axis] + counts[axis] / 2 - 1;
        above[axis] = below[axis] + 1;
        [[low, below], [above, high]]
    }
}
