use std::ops::Range;

use glam::DVec3;

use super::{PrimitiveId, Scene, Subset};

/// Primitives that move alike along a line while the shutter is open.
///
/// The shutter opens at the time 0 and closes at 1. At 0 they are where the scene has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion {
    /// The way that they go by 1, in scene units.
    pub displacement: DVec3,
    /// What moves. No primitive is in two parts, of this motion or of another.
    pub parts: Vec<Part>,
}

/// Primitives of one kind that move.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// Triangles, by their indices in the scene's mesh. Those of a face move together.
    Triangles(Range<usize>),
    /// Spheres, by their indices in [`Scene::spheres`].
    Spheres(Range<usize>),
}

impl Part {
    /// The ids in `scene`.
    fn primitives(&self, scene: &Scene) -> impl Iterator<Item = PrimitiveId> + use<> {
        let (range, first) = match self {
            Self::Triangles(range) => (range.clone(), 0),
            Self::Spheres(range) => (range.clone(), scene.mesh.triangles.len()),
        };
        range.map(move |index| PrimitiveId((first + index) as u32))
    }
}

impl Motion {
    /// Whether anything comes to another place.
    pub fn is_seen(&self) -> bool {
        let names_any = |(Part::Triangles(range) | Part::Spheres(range)): &Part| !range.is_empty();
        self.displacement != DVec3::ZERO && self.parts.iter().any(names_any)
    }

    /// The ids in `scene` of what moves.
    fn primitives(&self, scene: &Scene) -> impl Iterator<Item = PrimitiveId> {
        self.parts.iter().flat_map(|part| part.primitives(scene))
    }
}

impl Scene {
    /// The motions that are seen, each with its primitives.
    ///
    /// # Panics
    /// If a motion names what the scene has not.
    pub fn moving(&self) -> impl Iterator<Item = (DVec3, Subset<'_>)> {
        let seen = self.motions.iter().filter(|motion| motion.is_seen());
        seen.map(|motion| (motion.displacement, self.subset(motion.primitives(self))))
    }

    /// The primitives that stand still; all of them are not listed.
    ///
    /// # Panics
    /// If a motion names what the scene has not.
    pub fn still(&self) -> Subset<'_> {
        let mut moves =
            vec![false; if self.motions.is_empty() { 0 } else { self.primitives().len() }];
        for motion in self.motions.iter().filter(|motion| motion.is_seen()) {
            motion.primitives(self).for_each(|primitive| moves[primitive.0 as usize] = true);
        }
        if moves.contains(&true) {
            self.subset(self.primitives().filter(|primitive| !moves[primitive.0 as usize]))
        } else {
            self.into()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{icosphere, sphere_flake};
    use crate::scene::MaterialId;

    /// By hand: 20 triangles are numbered before 10 spheres.
    #[test]
    fn what_moves_and_what_stands_still_are_all_primitives() {
        let mut scene = Scene::of_mesh(icosphere(0));
        scene.spheres = sphere_flake(1, MaterialId(0));
        assert_eq!((scene.mesh.triangles.len(), scene.spheres.len()), (20, 10));
        let ids = |subset: Subset| subset.iter().map(|id| id.0).collect::<Vec<_>>();
        assert_eq!((scene.moving().count(), scene.still().memory()), (0, 0));

        let (triangles, spheres) = (Part::Triangles, Part::Spheres);
        let motion = |displacement, parts: &[Part]| Motion { displacement, parts: parts.to_vec() };
        scene.motions = vec![
            motion(DVec3::X, &[triangles(0..2), spheres(1..2), triangles(5..6)]),
            motion(DVec3::ZERO, &[triangles(10..20), spheres(0..1)]),
            motion(DVec3::Y, &[triangles(3..3)]),
            motion(-DVec3::Z, &[spheres(7..10)]),
        ];
        let moving: Vec<_> = scene.moving().map(|(way, subset)| (way, ids(subset))).collect();
        let expected = [(DVec3::X, vec![0, 1, 5, 21]), (-DVec3::Z, vec![27, 28, 29])];
        assert_eq!(moving, expected);
        let mut all = ids(scene.still());
        assert_eq!(all.len(), 23);
        all.extend(moving.into_iter().flat_map(|(_, ids)| ids));
        all.sort_unstable();
        assert_eq!(all, (0..30).collect::<Vec<_>>());

        // Nothing comes to another place: nothing is listed.
        scene.motions.retain(|motion| !motion.is_seen());
        assert_eq!(
            (scene.motions.len(), scene.moving().count(), scene.still().memory()),
            (2, 0, 0)
        );
    }
}
