//! A scene's primitives: how they are numbered, what they are, and sets of them.

use super::Scene;
use super::counts::{Counts, is_zero_area};
use crate::geometry::{Bounds3, ConvexVolume, Sphere};

/// One primitive of a scene: triangles are numbered first, in mesh order, then spheres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PrimitiveId(pub u32);

/// What a primitive is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A triangle, by its index in the scene's mesh.
    Triangle(usize),
    /// A sphere, by its index in [`Scene::spheres`].
    Sphere(usize),
}

impl Scene {
    /// The ids of all primitives, in order.
    pub fn primitives(&self) -> impl ExactSizeIterator<Item = PrimitiveId> + use<> {
        (0..(self.mesh.triangles.len() + self.spheres.len()) as u32).map(PrimitiveId)
    }

    /// What a primitive is.
    #[inline(always)]
    pub fn shape(&self, primitive: PrimitiveId) -> Shape {
        let index = primitive.0 as usize;
        let triangles = self.mesh.triangles.len();
        if index < triangles { Shape::Triangle(index) } else { Shape::Sphere(index - triangles) }
    }

    /// The smallest box around one primitive, up to the rounding of a sphere's extent. A hit may lie
    /// beside it by the rounding of the ray: indexes widen their boxes by that much.
    pub fn primitive_bounds(&self, primitive: PrimitiveId) -> Bounds3 {
        match self.shape(primitive) {
            Shape::Triangle(index) => Bounds3::of_points(self.mesh.corners(index)),
            Shape::Sphere(index) => self.spheres[index].shape.bounds(),
        }
    }

    /// The depth of a primitive's nearest point along the axis of a beam, inside it or not, or less by its
    /// rounding; `None` if the primitive is entirely beside it. A sphere counts as its box.
    pub fn depth_in(&self, volume: &ConvexVolume, primitive: PrimitiveId) -> Option<f64> {
        if let Shape::Triangle(index) = self.shape(primitive) {
            let corners = self.mesh.corners(index);
            return volume.may_meet_corners(&corners).then(|| volume.depth_of_corners(&corners));
        }
        // The rounding of a sphere's extent.
        let Bounds3 { min, max } = self.primitive_bounds(primitive);
        let bounds = Bounds3 { min: min.map(f64::next_down), max: max.map(f64::next_up) };
        volume.may_meet(&bounds).then(|| volume.depth(&bounds))
    }

    /// The smallest box around everything.
    pub fn bounds(&self) -> Bounds3 {
        Subset::from(self).bounds()
    }

    /// A sphere around every shape, centred in their bounding box; `None` in an empty scene.
    pub fn bounding_sphere(&self) -> Option<Sphere> {
        let points = || {
            let vertices = self.mesh.positions.iter().map(|&p| (p, 0.0));
            vertices.chain(self.spheres.iter().map(|s| (s.shape.center, s.shape.radius)))
        };
        let (min, max) = points()
            .map(|(p, r)| (p - r, p + r))
            .reduce(|(a, b), (min, max)| (a.min(min), b.max(max)))?;
        let center = 0.5 * (min + max);
        let radius = points().map(|(p, r)| (p - center).length() + r).fold(0.0, f64::max);
        Some(Sphere { center, radius })
    }

    /// Counts what the scene is made of.
    pub fn counts(&self) -> Counts {
        let mesh = &self.mesh;
        Counts {
            vertices: mesh.positions.len(),
            faces: mesh.faces.len(),
            triangles: mesh.triangles.len(),
            zero_area: (0..mesh.triangles.len()).filter(|&i| is_zero_area(mesh.corners(i))).count(),
            spheres: self.spheres.len(),
        }
    }

    /// Some primitives, in any order; what is named twice counts once.
    ///
    /// # Panics
    /// If the scene has no such primitive.
    pub fn subset(&self, primitives: impl IntoIterator<Item = PrimitiveId>) -> Subset<'_> {
        let mut ids: Vec<PrimitiveId> = primitives.into_iter().collect();
        ids.sort_unstable();
        ids.dedup();
        let exists = |id: &PrimitiveId| (id.0 as usize) < self.primitives().len();
        assert!(ids.last().is_none_or(exists), "the scene has no {:?}", ids.last());
        Subset { scene: self, ids: Some(ids) }
    }
}

/// What an index is built over: some primitives of a scene, or all, in order of their ids.
#[derive(Clone, Debug)]
pub struct Subset<'s> {
    scene: &'s Scene,
    /// Nothing is listed if it is all of them.
    ids: Option<Vec<PrimitiveId>>,
}

/// All primitives.
impl<'s> From<&'s Scene> for Subset<'s> {
    fn from(scene: &'s Scene) -> Self {
        Self { scene, ids: None }
    }
}

impl<'s> Subset<'s> {
    /// The scene, by which the primitives are numbered.
    #[inline]
    pub fn scene(&self) -> &'s Scene {
        self.scene
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.ids.as_ref().map_or_else(|| self.scene.primitives().len(), Vec::len)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The primitive at a place among them.
    #[inline(always)]
    pub fn get(&self, place: usize) -> PrimitiveId {
        match &self.ids {
            Some(ids) => ids[place],
            None => PrimitiveId(place as u32),
        }
    }

    /// The place of a primitive among them, if it is one of them.
    pub fn place(&self, primitive: PrimitiveId) -> Option<usize> {
        match &self.ids {
            Some(ids) => ids.binary_search(&primitive).ok(),
            None => Some(primitive.0 as usize).filter(|&place| place < self.len()),
        }
    }

    /// All of them, in order.
    #[inline]
    pub fn iter(&self) -> impl ExactSizeIterator<Item = PrimitiveId> {
        (0..self.len()).map(|place| self.get(place))
    }

    /// The smallest box around them.
    pub fn bounds(&self) -> Bounds3 {
        let boxes = self.iter().map(|primitive| self.scene.primitive_bounds(primitive));
        boxes.fold(Bounds3::EMPTY, Bounds3::union)
    }

    /// Bytes of the list.
    pub fn memory(&self) -> usize {
        self.ids.as_deref().map_or(0, size_of_val)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{icosphere, sphere_flake};
    use crate::scene::MaterialId;

    #[test]
    fn a_subset_is_in_order_and_has_each_primitive_once() {
        let mut scene = Scene::of_mesh(icosphere(0));
        scene.spheres = sphere_flake(0, MaterialId(0));
        let ids = |subset: &Subset| subset.iter().map(|id| id.0).collect::<Vec<_>>();
        let some = scene.subset([20, 3, 7, 3].map(PrimitiveId));
        assert_eq!((ids(&some), some.len(), some.memory()), (vec![3, 7, 20], 3, 12));
        assert_eq!(some.iter().map(|id| scene.shape(id)).last(), Some(Shape::Sphere(0)));
        assert_eq!([7, 8].map(|id| some.place(PrimitiveId(id))), [Some(1), None]);
        let all = Subset::from(&scene);
        assert_eq!([20, 21].map(|id| all.place(PrimitiveId(id))), [Some(20), None]);
        assert_eq!((ids(&all), all.memory()), ((0..21).collect(), 0));
        assert_eq!(all.bounds(), scene.bounds());
        let none = scene.subset([]);
        assert!(none.is_empty() && none.bounds().is_empty());
        let missing = std::panic::catch_unwind(|| scene.subset([PrimitiveId(21)]).len());
        assert!(missing.is_err());
    }
}
