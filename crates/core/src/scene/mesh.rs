use std::collections::{HashMap, VecDeque};
use std::ops::Range;

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
    /// The number of its first triangle.
    pub first: u32,
    /// The number of its triangles.
    pub count: u32,
}

impl Face {
    /// The numbers of its triangles.
    pub fn triangles(&self) -> Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
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

    /// The borders of a face as closed loops of indices into [`Mesh::positions`], each along the direction of its
    /// triangles: an n-gon has one, counter-clockwise seen from the outside; each hole adds one, clockwise.
    ///
    /// An edge along which two of the face's triangles meet is no border. Where loops touch in a vertex they are
    /// told apart in the order of the triangles.
    pub fn outline(&self, face: FaceId) -> Vec<Vec<u32>> {
        let triangles = &self.triangles[self.faces[face.0 as usize].triangles()];
        let edges = triangles.iter().flat_map(|triangle| {
            let [a, b, c] = triangle.vertices;
            [[a, b], [b, c], [c, a]]
        });
        // A corner that is named twice in a row makes no edge.
        let edges: Vec<[u32; 2]> = edges.filter(|[from, to]| from != to).collect();
        let mut inner: HashMap<[u32; 2], u32> = HashMap::new();
        for &[from, to] in &edges {
            *inner.entry([to, from]).or_default() += 1;
        }
        let mut next: HashMap<u32, VecDeque<u32>> = HashMap::new();
        let mut starts = Vec::new();
        for [from, to] in edges {
            match inner.get_mut(&[from, to]) {
                Some(count) if *count > 0 => *count -= 1,
                _ => {
                    starts.push(from);
                    next.entry(from).or_default().push_back(to);
                }
            }
        }
        let mut step = |from: u32| next.get_mut(&from).and_then(VecDeque::pop_front);
        let mut loops = Vec::new();
        for start in starts {
            let Some(mut here) = step(start) else { continue };
            let mut outline = vec![start];
            while here != start {
                outline.push(here);
                let Some(after) = step(here) else { break };
                here = after;
            }
            loops.push(outline);
        }
        loops
    }

    /// Adds the convex or triangulated polygon `triangles`, given by indices into
    /// [`Mesh::positions`], as one flat face.
    pub fn push_face(&mut self, material: MaterialId, triangles: &[[u32; 3]]) {
        let face = FaceId(self.faces.len() as u32);
        let (first, count) = (self.triangles.len() as u32, triangles.len() as u32);
        self.faces.push(Face { material, first, count });
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
        let triangle = self.triangles.len() as u32;
        self.faces.extend(other.faces.iter().map(|f| Face {
            material: MaterialId(f.material.0 + first_material),
            first: f.first + triangle,
            count: f.count,
        }));
        self.triangles.extend(other.triangles.iter().map(|t| Triangle {
            vertices: turn(t.vertices.map(|k| k + vertex)),
            face: FaceId(t.face.0 + face),
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(positions: &[(f64, f64)], faces: &[&[[u32; 3]]]) -> Mesh {
        let positions = positions.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect();
        let mut mesh = Mesh { positions, ..Mesh::default() };
        faces.iter().for_each(|triangles| mesh.push_face(MaterialId(0), triangles));
        mesh
    }

    #[test]
    fn a_polygon_is_its_border_without_diagonals() {
        let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 2.0), (0.0, 1.0), (9.0, 9.0)];
        let pentagon = mesh(&corners, &[&[[0, 1, 5]], &[[0, 1, 2], [0, 2, 3], [0, 3, 4]]]);
        assert_eq!(pentagon.faces[1].triangles(), 1..4);
        assert_eq!(pentagon.outline(FaceId(1)), [[0, 1, 2, 3, 4]]);
        let mut twice = pentagon.clone();
        twice.append(&pentagon, DAffine3::IDENTITY, 0);
        assert_eq!(twice.faces[3].triangles(), 5..8);
        assert_eq!(twice.outline(FaceId(3)), [[6, 7, 8, 9, 10]]);
        let mirrored = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        twice.append(&pentagon, mirrored, 0);
        assert_eq!(twice.outline(FaceId(5)), [[14, 13, 12, 16, 15]]);
    }

    /// A square ring of eight triangles: the outer border counter-clockwise, the inner one clockwise.
    #[test]
    fn a_hole_is_a_loop_the_other_way_round() {
        let square = |half: f64| [(-half, -half), (half, -half), (half, half), (-half, half)];
        let corners = [square(2.0), square(1.0)].concat();
        let around = (0..4).flat_map(|k| {
            let next = (k + 1) % 4;
            [[k, next, next + 4], [k, next + 4, k + 4]]
        });
        let ring = mesh(&corners, &[&around.collect::<Vec<_>>()]);
        let area = |outline: &Vec<u32>| -> f64 {
            let next = outline.iter().cycle().skip(1);
            let cross = |(a, b): (&u32, &u32)| {
                let [a, b] = [a, b].map(|k| ring.positions[*k as usize]);
                0.5 * (a.x * b.y - a.y * b.x)
            };
            outline.iter().zip(next).map(cross).sum()
        };
        let loops = ring.outline(FaceId(0));
        assert_eq!(loops.iter().map(area).collect::<Vec<_>>(), [16.0, -4.0]);
    }

    /// A corner that is named twice, and a polygon so large that a search for each edge would take minutes.
    #[test]
    fn repeated_corners_and_large_polygons() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
        let repeated = mesh(&corners, &[&[[0, 0, 1], [0, 1, 2]]]);
        assert_eq!(repeated.outline(FaceId(0)), [[0, 1, 2]]);
        let count = 100_000;
        let fan: Vec<[u32; 3]> = (1..count - 1).map(|k| [0, k, k + 1]).collect();
        let large = mesh(&vec![(0.0, 0.0); count as usize], &[&fan]);
        assert_eq!(large.outline(FaceId(0)), [(0..count).collect::<Vec<_>>()]);
    }
}
