//! Points of surfaces, each as likely as any other: warps of the unit square.

use glam::DVec3;

/// A point of a triangle, of density 1/A everywhere.
///
/// ```text
///                         (b₀, b₁) = (u/2, v − u/2)   where u < v,   (u − v/2, v/2)   elsewhere
/// ```
///
/// are the weights of the first two corners. The square is not folded along its diagonal, nor pressed into a corner as
/// by (1 − √u, v √u): strata stay compact.
///
/// Source: Heitz, *A Low-Distortion Map Between Triangle and Square*, 2019.
#[inline]
pub fn triangle([a, b, c]: [DVec3; 3], [u, v]: [f64; 2]) -> DVec3 {
    let (b0, b1) = if u < v { (0.5 * u, v - 0.5 * u) } else { (u - 0.5 * v, 0.5 * v) };
    b0 * a + b1 * b + (1.0 - b0 - b1) * c
}

/// A point of the parallelogram that two edges span from a corner, of density 1/A everywhere.
#[inline]
pub fn parallelogram(corner: DVec3, edges: [DVec3; 2], [u, v]: [f64; 2]) -> DVec3 {
    corner + u * edges[0] + v * edges[1]
}

/// The density, per solid angle, of the direction towards a point of a surface that is picked evenly by area.
///
/// ```text
/// eq:area-light           p(ω) = d² / (A cos θ')
/// ```
///
/// | formula | here               |                                                                              |
/// |---------|--------------------|------------------------------------------------------------------------------|
/// | d²      | `distance_squared` | from where it is seen to the point, squared                                  |
/// | cos θ'  | `cos_light`        | between the surface's normal and the direction back to where it is seen from |
/// | A       | `area`             | of the whole surface, not of one of its triangles                            |
///
/// It is 0 where `cos_light` is not positive: the surface turns its back, from where it is not seen.
///
/// Source: Pharr, Jakob, Humphreys, *Physically Based Rendering*, 4th ed., §4.2.3 and §6.5.
#[doc(alias = "eq:area-light")]
#[doc(alias = "source étendue")]
#[inline]
pub fn area_light_density(distance_squared: f64, cos_light: f64, area: f64) -> f64 {
    if cos_light > 0.0 { distance_squared / (area * cos_light) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAST: f64 = 1.0 - 0.5 * f64::EPSILON;

    #[test]
    fn corners_of_the_square_are_on_the_surface() {
        let [a, b, c] = [DVec3::X, DVec3::Y, DVec3::Z];
        for u in [[0.0, 0.0], [0.0, LAST], [LAST, 0.0], [LAST, LAST], [0.5, 0.5]] {
            // These corners make the point the weights themselves.
            let weights = triangle([a, b, c], u);
            assert!(weights.min_element() >= 0.0, "{u:?}: {weights}");
            assert!((weights.element_sum() - 1.0).abs() <= f64::EPSILON, "{u:?}: {weights}");
            let point = parallelogram(DVec3::ZERO, [a, b], u);
            assert_eq!(point, DVec3::new(u[0], u[1], 0.0));
        }
    }

    /// No 2^k points of a net are pressed together: of each quarter of a triangle, the cut through the middles of its
    /// edges, the map makes four strata of the square, two whole and four halves.
    #[test]
    fn a_triangle_s_quarters_get_a_quarter_each() {
        let mut hits = [0; 4];
        for i in 0..64 {
            for j in 0..64 {
                let u = [(f64::from(i) + 0.3) / 64.0, (f64::from(j) + 0.6) / 64.0];
                let weights = triangle([DVec3::X, DVec3::Y, DVec3::Z], u).to_array();
                hits[weights.iter().position(|w| *w > 0.5).unwrap_or(3)] += 1;
            }
        }
        for hits in hits {
            assert!((f64::from(hits) - 1024.0).abs() <= 64.0, "{hits}");
        }
    }

    /// `eq:area-light`, by hand.
    #[test]
    fn densities_by_hand() {
        assert_eq!(area_light_density(4.0, 0.5, 2.0), 4.0);
        assert_eq!([0.0, -0.5, f64::NAN].map(|cos| area_light_density(4.0, cos, 2.0)), [0.0; 3]);
    }
}
