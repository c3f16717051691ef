//! Every index of the course by name, the one list that figures, benches and the command line share.

use std::error::Error;
use std::fmt;

use lancer_core::intersector::{Intersector, LinearScan};
use lancer_core::scene::Subset;

use crate::{BspTree, Bvh, Grid, KdTree, ObvhsBvh2, ObvhsCwbvh, Octree, Wide};

/// An index by name.
#[derive(Clone, Copy)]
pub struct Structure {
    /// Its name on the command line, which is the name of its colour too.
    pub name: &'static str,
    /// About what it takes for each primitive where it takes most, among the chapter's kinds of scene but its buildings:
    /// in those an octree takes three times as much.
    pub bytes_per_primitive: usize,
    /// Whether beams can ask it: [`Intersector::beams`].
    pub beams: bool,
    builder: for<'s> fn(Subset<'s>) -> Built<'s>,
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
        builder: |all| Built::new(LinearScan::new(all), LinearScan::memory),
    },
    Structure {
        name: "wide",
        bytes_per_primitive: 76,
        beams: true,
        builder: |all| Built::new(Wide::build(all), Wide::memory),
    },
    Structure {
        name: "bvh",
        bytes_per_primitive: 66,
        beams: true,
        builder: |all| Built::new(Bvh::build(all), Bvh::memory),
    },
    Structure {
        name: "obvhs-bvh2",
        bytes_per_primitive: 64,
        beams: false,
        builder: |all| Built::new(ObvhsBvh2::build(all), ObvhsBvh2::memory),
    },
    Structure {
        name: "obvhs-cwbvh",
        bytes_per_primitive: 14,
        beams: false,
        builder: |all| Built::new(ObvhsCwbvh::build(all), ObvhsCwbvh::memory),
    },
    Structure {
        name: "grid",
        bytes_per_primitive: 21,
        beams: true,
        builder: |all| Built::new(Grid::build(all), Grid::memory),
    },
    Structure {
        name: "octree",
        bytes_per_primitive: 76,
        beams: false,
        builder: |all| Built::new(Octree::build(all), Octree::memory),
    },
    Structure {
        name: "kd",
        bytes_per_primitive: 43,
        beams: false,
        builder: |all| Built::new(KdTree::build(all), KdTree::memory),
    },
    Structure {
        name: "bsp",
        bytes_per_primitive: 76,
        beams: false,
        builder: |all| Built::new(BspTree::build(all), BspTree::memory),
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
    /// Builds it, with its default parameters, over all primitives of a scene or some.
    pub fn build<'s>(&self, primitives: impl Into<Subset<'s>>) -> Built<'s> {
        (self.builder)(primitives.into())
    }

    /// About how many bytes the index of so many primitives may take.
    pub fn expected_bytes(&self, primitives: usize) -> usize {
        self.bytes_per_primitive * primitives
    }
}

/// Beams cannot ask an index of this kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoBeams(&'static str);

impl fmt::Display for NoBeams {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let with_beams = STRUCTURES.iter().filter(|structure| structure.beams);
        let names: Vec<&str> = with_beams.map(|structure| structure.name).collect();
        write!(f, "beams cannot ask `{}`; they can ask one of these: {}", self.0, names.join(", "))
    }
}

impl Error for NoBeams {}

impl Structure {
    /// Whether beams can ask what it builds: before it is built.
    ///
    /// # Errors
    /// If they cannot; the message lists the structures that they can ask.
    pub fn check_beams(&self) -> Result<(), NoBeams> {
        if self.beams { Ok(()) } else { Err(NoBeams(self.name)) }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use lancer_core::generate::{icosphere, sphere_flake};
    use lancer_core::geometry::{Interval, Ray};
    use lancer_core::intersector::Query;
    use lancer_core::scene::{MaterialId, PrimitiveId, Scene};
    use rand_pcg::Pcg64;
    use rand_pcg::rand_core::Rng;

    use super::*;
    use crate::hard_sets::hard_sets;

    /// The hard sets, and spheres among triangles.
    fn scenes() -> Vec<(&'static str, Scene)> {
        let mut scenes = hard_sets(300);
        let mut mixed = Scene::of_mesh(icosphere(2));
        mixed.spheres = sphere_flake(2, MaterialId(0));
        scenes.push(("spheres and triangles", mixed));
        scenes
    }

    /// Rays at the middles of a scene's primitives, from inside and outside.
    fn rays(scene: &Scene, count: usize) -> Vec<Ray> {
        let bounds = scene.bounds();
        let size = (bounds.max - bounds.min).max_element();
        let mut random = Pcg64::new(3, 1);
        let mut number = move || f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
        let primitives: Vec<PrimitiveId> = scene.primitives().collect();
        let ray = |k: usize| {
            let away = size * [0.8, 4.0][k % 2];
            let origin = bounds.center() + away * DVec3::new(number(), number(), number());
            let target = primitives[k * 7919 % primitives.len()];
            Ray::new(origin, scene.primitive_bounds(target).center() - origin)
        };
        (0..if primitives.is_empty() { 0 } else { count }).map(ray).collect()
    }

    /// What the first ray met first is left out: an index over all primitives would answer otherwise.
    #[test]
    fn over_a_subset_all_answer_as_brute_force_does() {
        let mut random = Pcg64::new(1, 1);
        let (mut hits, mut changed) = (0, 0);
        for (name, scene) in scenes() {
            let whole = LinearScan::new(&scene);
            let rays = rays(&scene, 60);
            for share in [0, 1, 8, 15, 16] {
                let is_in = |_: &PrimitiveId| random.next_u32() % 16 < share;
                let mut some: Vec<PrimitiveId> = scene.primitives().filter(is_in).collect();
                // Nearest first, so not in order.
                some.reverse();
                let first = rays.first().and_then(|ray| whole.closest_hit(ray, Interval::POSITIVE));
                if let Some(first) = first {
                    some.retain(|&primitive| primitive != first.primitive);
                }
                let of = scene.subset(some);
                let oracle = LinearScan::new(of.clone());
                if let Some(first) = first {
                    let next = oracle.closest_hit(&rays[0], Interval::POSITIVE);
                    assert!(next.is_none_or(|next| next.primitive != first.primitive), "{name}");
                }
                for structure in STRUCTURES {
                    let Built { index, .. } = structure.build(of.clone());
                    for ray in &rays {
                        let wanted = oracle.closest_hit(ray, Interval::POSITIVE);
                        let got = index.closest_hit(ray, Interval::POSITIVE);
                        assert_eq!(got, wanted, "{name}, {share}: {} {ray:?}", structure.name);
                        let any = index.watch(Query::any(ray, Interval::POSITIVE), &mut ());
                        let is_among = any.is_none_or(|hit| of.place(hit.primitive).is_some());
                        assert!(any.is_some() == wanted.is_some() && is_among, "{name}: {any:?}");
                        hits += usize::from(wanted.is_some());
                        let all = whole.closest_hit(ray, Interval::POSITIVE);
                        changed += usize::from(all != wanted);
                    }
                }
            }
        }
        assert!(hits > 5_000 && changed > 5_000, "{hits} {changed}");
    }

    #[test]
    fn the_list_says_which_structures_beams_can_ask() {
        let scene = Scene::of_mesh(icosphere(1));
        for structure in STRUCTURES {
            let built = structure.build(&scene);
            let has_beams = built.index.beams().is_some();
            assert_eq!(has_beams, structure.check_beams().is_ok(), "{}", structure.name);
        }
        let refused = structure("octree").check_beams().unwrap_err().to_string();
        assert_eq!(
            refused,
            "beams cannot ask `octree`; they can ask one of these: linear, wide, bvh, grid"
        );
    }
}
