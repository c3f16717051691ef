//! E1.2 Where a ray meets a triangle. Slide « Algorithme : calcul et tri des intersections ».

use chapter_1::exercises::prelude::*;

/// Where a ray meets a triangle, from either side: t, and the weights of the corners a, b and c there.
///
/// - `corners`: a, b and c, in any order of rotation.
/// - `ray`: the points `ray.origin + t * ray.direction`. The direction has any length; t is in units of it.
///
/// The answer is `Some((t, weights))`, a `Meeting` (in chapters/1-whitted/src/exercises/mod.rs), or `None`
/// unless t > 0 and finite; t may be as small as it likes. The weights, a `DVec3`, are at least 0 and add up
/// to 1: they are the share of each corner in the point.
///
/// A ray through an edge or a corner *meets* the triangle, so that none slips between neighbours. A ray in
/// the triangle's plane does not: there E_A, E_B and E_C are rounding noise, whose signs may agree by chance. So
/// demand besides that 0 is neither below nor above the x of all three sheared corners, nor the y of all.
pub fn ray_triangle(corners: [DVec3; 3], ray: &Ray) -> Option<Meeting> {
    let [a, b, c] = corners.map(|corner| sheared(corner, ray));
    todo!("E1.2: the signs of the edge functions of a, b and c, then t")
}

/// A corner in coordinates in which the ray is the z axis: it starts at 0, and z is the ray parameter t.
///
/// After Woop, Benthin and Wald (2013). Nothing is to be done here. Notice that the answer depends on the
/// ray and on this corner alone: all triangles around the corner get the same numbers.
fn sheared(corner: DVec3, ray: &Ray) -> DVec3 {
    let (v, d) = (corner - ray.origin, ray.direction);
    // The axis along which the direction is longest becomes z.
    let z = d.abs().max_position();
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let inverse = 1.0 / d[z];
    DVec3::new(v[x] - d[x] * inverse * v[z], v[y] - d[y] * inverse * v[z], v[z] * inverse)
}
