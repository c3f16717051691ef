//! Every index of the course by name, the one list that figures, benches and the command line share.

use lancer_core::intersector::{BeamIndex, Intersector, LinearScan};
use lancer_core::scene::Scene;

use crate::{BspTree, Bvh, Grid, KdTree, ObvhsBvh2, ObvhsCwbvh, Octree, Wide};

/// An index by name.
#[derive(Clone, Copy)]
pub struct Structure {
    /// Its name on the command line, which is the name of its colour too.
    pub name: &'static str,
    /// About what it takes for each primitive where it takes most, among the chapter's kinds of scene.
    pub bytes_per_primitive: usize,
    /// Whether beams can ask it: [`Intersector::beams`].
    pub beams: bool,
    /// Builds it, with its default parameters, over all primitives of a scene.
    pub build: for<'s> fn(&'s Scene) -> Built<'s>,
}

/// An index of a scene.
pub struct Built<'s> {
    /// Answers.
    pub index: Box<dyn Intersector + 's>,
    /// Bytes that it holds, without the scene.
    pub bytes: usize,
}

impl<'s> Built<'s> {
    /// An index, and what it says of its memory.
    pub fn new<I: Intersector + 's>(index: I, memory: fn(&I) -> usize) -> Self {
        let bytes = memory(&index);
        Self { index: Box::new(index), bytes }
    }
}

/// All of them, the oracle first.
pub const STRUCTURES: [Structure; 9] = [
    Structure {
        name: "linear",
        bytes_per_primitive: 0,
        beams: true,
        build: |scene| Built::new(LinearScan::new(scene), |_| 0),
    },
    Structure {
        name: "wide",
        bytes_per_primitive: 68,
        beams: true,
        build: |scene| Built::new(Wide::build(scene), Wide::memory),
    },
    Structure {
        name: "bvh",
        bytes_per_primitive: 66,
        beams: true,
        build: |scene| Built::new(Bvh::build(scene), Bvh::memory),
    },
    Structure {
        name: "obvhs-bvh2",
        bytes_per_primitive: 64,
        beams: false,
        build: |scene| Built::new(ObvhsBvh2::build(scene), ObvhsBvh2::memory),
    },
    Structure {
        name: "obvhs-cwbvh",
        bytes_per_primitive: 14,
        beams: false,
        build: |scene| Built::new(ObvhsCwbvh::build(scene), ObvhsCwbvh::memory),
    },
    Structure {
        name: "grid",
        bytes_per_primitive: 21,
        beams: true,
        build: |scene| Built::new(Grid::build(scene), Grid::memory),
    },
    Structure {
        name: "octree",
        bytes_per_primitive: 76,
        beams: false,
        build: |scene| Built::new(Octree::build(scene), Octree::memory),
    },
    Structure {
        name: "kd",
        bytes_per_primitive: 43,
        beams: false,
        build: |scene| Built::new(KdTree::build(scene), KdTree::memory),
    },
    Structure {
        name: "bsp",
        bytes_per_primitive: 76,
        beams: false,
        build: |scene| Built::new(BspTree::build(scene), BspTree::memory),
    },
];

/// The structure of that name.
///
/// # Panics
/// If there is none.
pub fn structure(name: &str) -> Structure {
    let found = STRUCTURES.into_iter().find(|structure| structure.name == name);
    found.unwrap_or_else(|| panic!("no index is called {name:?}"))
}

impl Structure {
    /// About how many bytes the index of so many primitives may take.
    pub fn expected_bytes(&self, primitives: usize) -> usize {
        self.bytes_per_primitive * primitives
    }
}

/// The names of the structures that beams can ask.
pub fn names_with_beams() -> Vec<&'static str> {
    STRUCTURES.into_iter().filter(|structure| structure.beams).map(|s| s.name).collect()
}

impl Built<'_> {
    /// The index as beams ask it.
    ///
    /// # Errors
    /// If they cannot: which indexes they can ask.
    pub fn beams(&self) -> Result<&dyn BeamIndex, String> {
        self.index.beams().ok_or_else(|| {
            let names = names_with_beams().join(", ");
            format!("beams cannot ask this index; they can ask one of these: {names}")
        })
    }
}

#[cfg(test)]
mod tests {
    use lancer_core::generate::icosphere;

    use super::*;

    #[test]
    fn the_list_says_which_structures_beams_can_ask() {
        let scene = Scene::of_mesh(icosphere(1));
        for structure in STRUCTURES {
            let built = (structure.build)(&scene);
            assert_eq!(built.beams().is_ok(), structure.beams, "{}", structure.name);
        }
        assert_eq!(names_with_beams(), ["linear", "wide", "bvh", "grid"]);
        let refused = (structure("octree").build)(&scene).beams().err().unwrap();
        assert!(refused.ends_with(": linear, wide, bvh, grid"), "{refused}");
    }
}
