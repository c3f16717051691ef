use std::collections::HashMap;

use glam::DVec3;

use super::inside_out::{BUDGET, inside_out};
use crate::geometry::Sphere;
use crate::scene::{Face, Material, MaterialId, Mesh, Scene};

/// What is wrong with the refracting triangles of one material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Flaws {
    /// Edges of one triangle, or of an odd number of triangles of one material.
    pub open: usize,
    /// Edges along which as many triangles meet as should, but not half of them in each direction.
    pub mixed: usize,
    /// Closed surfaces that are wound the wrong way round, and their edges.
    pub inside_out: usize,
    pub inside_out_edges: usize,
}

/// Checks that the surfaces that refract are closed and wound counter-clockwise seen from outside; a hole in glass is
/// wound the other way round. Surfaces of several materials may close each other. Costs nothing where no triangle
/// refracts.
///
/// An edge is told by the positions of its ends: exporters split vertices along seams. A surface is closed if each of
/// its edges is run through as often in one direction as in the other.
///
/// Where three spaces meet, as water, glass and air do along the rim of the water, each two of them have a surface of
/// its own between them. An edge of three or more triangles of several materials is such a joint, and no flaw.
pub(super) fn flaws(scene: &Scene) -> Vec<(MaterialId, Flaws)> {
    let refracts: Vec<bool> = scene.materials.iter().map(Material::refracts).collect();
    if !refracts.contains(&true) {
        return Vec::new();
    }
    let mesh = &scene.mesh;
    let is_refracting = |id: MaterialId| refracts[id.0 as usize];
    let faces = mesh.faces.iter().filter(|face| is_refracting(face.material));
    let triangles: Vec<usize> = faces.flat_map(Face::triangles).collect();
    let mut flaws = vec![Flaws::default(); scene.materials.len()];
    let material = |triangle: u32| {
        mesh.faces[mesh.triangles[triangles[triangle as usize]].face.0 as usize].material.0 as usize
    };

    let edges = sorted_edges(mesh, &triangles);
    let mut surfaces = Surfaces::new(triangles.len());
    let mut not_closed = Vec::new();
    for around in edges.chunk_by(|a, b| a.ends == b.ends) {
        let first = around[0].triangle;
        around.iter().for_each(|edge| surfaces.join(first, edge.triangle));
        let forwards = around.iter().filter(|edge| edge.forwards).count();
        if 2 * forwards != around.len() {
            not_closed.push(first);
            let is_other = |edge: &Edge| material(edge.triangle) != material(first);
            if around.len() > 2 && around.iter().any(is_other) {
                continue;
            }
            let of_material = &mut flaws[material(first)];
            *if around.len() % 2 == 1 { &mut of_material.open } else { &mut of_material.mixed } +=
                1;
        }
    }
    let spheres = scene.spheres.iter().filter(|sphere| is_refracting(sphere.material));
    let corners: Vec<[DVec3; 3]> = triangles.iter().map(|&index| mesh.corners(index)).collect();
    let spheres: Vec<Sphere> = spheres.map(|sphere| sphere.shape).collect();
    let roots: Vec<u32> =
        (0..corners.len() as u32).map(|triangle| surfaces.find(triangle)).collect();
    let mut is_closed = vec![true; corners.len()];
    not_closed.iter().for_each(|&triangle| is_closed[roots[triangle as usize] as usize] = false);
    for (first, size) in inside_out(&corners, &roots, &is_closed, &spheres, BUDGET) {
        let of_material = &mut flaws[material(first)];
        of_material.inside_out += 1;
        // Two triangles meet at each edge.
        of_material.inside_out_edges += size * 3 / 2;
    }
    let ids = (0..).map(MaterialId);
    ids.zip(flaws).filter(|(_, flaws)| *flaws != Flaws::default()).collect()
}

/// A side of a triangle, between two numbered positions, the smaller first.
struct Edge {
    ends: [u32; 2],
    triangle: u32,
    forwards: bool,
}

/// The edges of the `triangles`, which are numbered in this order; equal ones follow each other.
fn sorted_edges(mesh: &Mesh, triangles: &[usize]) -> Vec<Edge> {
    let mut numbers: HashMap<[u64; 3], u32> = HashMap::new();
    let mut of_vertex: Vec<Option<u32>> = vec![None; mesh.positions.len()];
    let mut number = |vertex: u32| {
        *of_vertex[vertex as usize].get_or_insert_with(|| {
            // −0 is 0.
            let key = (mesh.positions[vertex as usize] + 0.0).to_array().map(f64::to_bits);
            let next = numbers.len() as u32;
            *numbers.entry(key).or_insert(next)
        })
    };
    let mut edges = Vec::with_capacity(3 * triangles.len());
    for (triangle, &index) in triangles.iter().enumerate() {
        let [a, b, c] = mesh.triangles[index].vertices.map(&mut number);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            if from != to {
                let ends = [from.min(to), from.max(to)];
                edges.push(Edge { ends, triangle: triangle as u32, forwards: from < to });
            }
        }
    }
    edges.sort_unstable_by_key(|edge| (edge.ends, edge.triangle, edge.forwards));
    edges
}

/// Triangles that hang together by edges, as a forest (union–find): a surface is named by its root.
struct Surfaces(Vec<u32>);

impl Surfaces {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn find(&mut self, triangle: u32) -> u32 {
        let mut here = triangle as usize;
        while self.0[here] as usize != here {
            self.0[here] = self.0[self.0[here] as usize];
            here = self.0[here] as usize;
        }
        here as u32
    }

    /// The root is the smallest number of a surface.
    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
