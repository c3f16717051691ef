use glam::DVec3;

/// The size of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Vertices of the mesh that a face uses.
    pub vertices: usize,
    /// Polygons.
    pub faces: usize,
    /// Triangles the polygons were cut into.
    pub triangles: usize,
    /// Triangles of no area among them.
    pub zero_area: usize,
    /// Spheres.
    pub spheres: usize,
}

/// Whether a triangle's corners are on one line, up to the rounding of their coordinates.
pub(super) fn is_zero_area([a, b, c]: [DVec3; 3]) -> bool {
    let (u, v) = (b - a, c - a);
    u.cross(v).length() <= 4.0 * f64::EPSILON * u.length() * v.length()
}
