use glam::{DAffine3, DVec3};

use super::MaterialId;

/// The index of a [`Face`] in [`Mesh::faces`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FaceId(pub u32);

/// A polygon as its author wrote it; its triangles name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// What the polygon is made of.
    pub material: MaterialId,
}

/// Three corners of one face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    /// Indices into [`Mesh::positions`], counter-clockwise seen from the outside.
    pub vertices: [u32; 3],
    /// The polygon it is a part of: an n-gon, a rectangle light, stays one face.
    pub face: FaceId,
}

/// Triangles over shared vertices.
///
/// Neighbours share vertex *indices*: the watertight test then computes the same number for a
/// common edge from both sides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<DVec3>,
    /// Triangles, in the order that numbers them as primitives.
    pub triangles: Vec<Triangle>,
    /// The polygons the triangles belong to. The triangles of one face are consecutive.
    pub faces: Vec<Face>,
    /// Unit vertex normals for smooth shading; empty in a flat mesh.
    pub normals: Vec<DVec3>,
    /// For each triangle its corners' indices into [`Mesh::normals`], or `None` where it is flat.
    /// Empty when no triangle is smooth.
    pub smooth: Vec<Option<[u32; 3]>>,
}

impl Mesh {
    /// The three corner positions of triangle `index`.
    #[inline]
    pub fn corners(&self, index: usize) -> [DVec3; 3] {
        let [a, b, c] = self.triangles[index].vertices;
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// The unit normals at the corners of triangle `index`, where the mesh is smooth there.
    #[inline]
    pub fn corner_normals(&self, index: usize) -> Option<[DVec3; 3]> {
        let [a, b, c] = (*self.smooth.get(index)?)?;
        Some([self.normals[a as usize], self.normals[b as usize], self.normals[c as usize]])
    }

    /// Adds the convex or triangulated polygon `triangles`, given by indices into
    /// [`Mesh::positions`], as one flat face.
    pub fn push_face(&mut self, material: MaterialId, triangles: &[[u32; 3]]) {
        let face = FaceId(self.faces.len() as u32);
        self.faces.push(Face { material });
        self.triangles.extend(triangles.iter().map(|&vertices| Triangle { vertices, face }));
        if !self.smooth.is_empty() {
            self.smooth.resize(self.triangles.len(), None);
        }
    }

    /// Appends `other` moved by `transform`; its material 0 becomes `first_material`.
    ///
    /// A transform that mirrors turns the triangles inside out; they are flipped back, so that
    /// counter-clockwise still means outside.
    pub fn append(&mut self, other: &Mesh, transform: DAffine3, first_material: u32) {
        let (vertex, face, normal) =
            (self.positions.len() as u32, self.faces.len() as u32, self.normals.len() as u32);
        let mirrors = transform.matrix3.determinant() < 0.0;
        let turn = |[a, b, c]: [u32; 3]| if mirrors { [a, c, b] } else { [a, b, c] };
        let to_normal = transform.matrix3.inverse().transpose();

        if !(self.smooth.is_empty() && other.smooth.is_empty()) {
            self.smooth.resize(self.triangles.len(), None);
            let corners = |i: usize| {
                other.smooth.get(i).copied().flatten().map(|n| turn(n.map(|k| k + normal)))
            };
            self.smooth.extend((0..other.triangles.len()).map(corners));
        }
        self.positions.extend(other.positions.iter().map(|&p| transform.transform_point3(p)));
        self.normals.extend(other.normals.iter().map(|&n| (to_normal * n).normalize()));
        self.faces.extend(
            other
                .faces
                .iter()
                .map(|f| Face { material: MaterialId(f.material.0 + first_material) }),
        );
        self.triangles.extend(other.triangles.iter().map(|t| Triangle {
            vertices: turn(t.vertices.map(|k| k + vertex)),
            face: FaceId(t.face.0 + face),
        }));
    }
}
