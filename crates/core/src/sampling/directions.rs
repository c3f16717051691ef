//! Directions and lens points: warps of the unit square.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_4};

use glam::{DVec2, DVec3};

/// A point of the unit disc, of density 1/π everywhere.
///
/// ```text
///                         a = 2u − 1,  b = 2v − 1
///                         r = a,  φ = π/4 · b/a             where |a| > |b|
///                         r = b,  φ = π/2 − π/4 · a/b       elsewhere
/// ```
///
/// Squares around the centre become circles, so that strata stay compact: the polar map (√u, 2πv) has the same
/// density, but makes them long and thin.
///
/// Source: Shirley, Chiu, *A Low Distortion Map Between Disk and Square*, Journal of Graphics Tools 2(3), 1997.
#[inline]
pub fn concentric_disc(u: [f64; 2]) -> DVec2 {
    let (radius, direction) = concentric(u);
    radius * direction
}

/// The signed distance from the centre of [`concentric_disc`], from −1 to 1, and the unit direction that it counts
/// along.
#[inline]
pub(super) fn concentric([u, v]: [f64; 2]) -> (f64, DVec2) {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a.abs() > b.abs() {
        let (sin, cos) = (FRAC_PI_4 * (b / a)).sin_cos();
        (a, DVec2::new(cos, sin))
    } else if b != 0.0 {
        let (sin, cos) = (FRAC_PI_4 * (a / b)).sin_cos();
        (b, DVec2::new(sin, cos))
    } else {
        (0.0, DVec2::X)
    }
}

/// A direction above a surface, with density [`cosine_hemisphere_density`].
///
/// `n` is the unit normal; the result is unit and has N·ω ≥ 0 up to rounding. It is the point of the disc,
/// lifted onto the hemisphere (Malley).
#[inline]
pub fn cosine_hemisphere(n: DVec3, u: [f64; 2]) -> DVec3 {
    let (r, direction) = concentric(u);
    let cos_squared = (1.0 - r) * (1.0 + r);
    around(n, (r * direction).extend(cos_squared.sqrt()))
}

/// The density of [`cosine_hemisphere`], per solid angle.
///
/// ```text
/// eq:cosine-hemisphere    p(ω) = cos θ / π
/// ```
///
/// `cos_theta` is N·ω; below the horizon the density is 0.
///
/// Source: Pharr, Jakob, Humphreys, *Physically Based Rendering*, 4th ed., §A.5.3.
#[doc(alias = "eq:cosine-hemisphere")]
#[doc(alias = "hémisphère en cosinus")]
#[inline]
pub fn cosine_hemisphere_density(cos_theta: f64) -> f64 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// A direction of the lobe cosⁿ α around a unit axis, with density [`phong_lobe_density`].
///
/// ```text
///                         cos α = (1 − r²)^(1/(n+1)),  r and φ those of the disc
/// ```
///
/// `exponent` is n ≥ 0; the result is unit. Around the mirror direction part of the lobe lies below the surface: what
/// is drawn there counts as 0, or the density would have to be divided by the rest's share.
///
/// With n = 1 it is [`cosine_hemisphere`]. 1 − cos α comes from the logarithm: for n = 10⁵ it is 10⁻⁵, of which the
/// difference would lose five digits.
///
/// Source: Lafortune, Willems, *Using the Modified Phong Reflectance Model for Physically Based Rendering*, 1994.
#[inline]
pub fn phong_lobe(axis: DVec3, exponent: f64, u: [f64; 2]) -> DVec3 {
    let (r, direction) = concentric(u);
    let one_minus_cos = -((-r * r).ln_1p() / (exponent + 1.0)).exp_m1();
    let sin = (one_minus_cos * (2.0 - one_minus_cos)).sqrt();
    around(axis, (r.signum() * sin * direction).extend(1.0 - one_minus_cos))
}

/// The density of [`phong_lobe`], per solid angle.
///
/// ```text
/// eq:phong-lobe           p(ω) = (n + 1) / 2π · cosⁿ α
/// ```
///
/// `exponent` is n; `cos_alpha` is the product of ω and the axis, both unit. Beyond the lobe's equator the density
/// is 0.
#[doc(alias = "eq:phong-lobe")]
#[doc(alias = "lobe de Phong")]
#[inline]
pub fn phong_lobe_density(exponent: f64, cos_alpha: f64) -> f64 {
    if cos_alpha <= 0.0 {
        return 0.0;
    }
    0.5 * FRAC_1_PI * (exponent + 1.0) * cos_alpha.powf(exponent)
}

/// A vector given in a frame whose z is the unit vector `axis`. The frame's x and y are those of Duff et al.,
/// *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017: stable for every axis, and the same for the same.
#[inline]
pub(super) fn around(axis: DVec3, local: DVec3) -> DVec3 {
    let (x, y) = axis.any_orthonormal_pair();
    local.x * x + local.y * y + local.z * axis
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_1_SQRT_2, PI};

    use super::*;
    use crate::sampling::Uniform;

    const LAST: f64 = 1.0 - 0.5 * f64::EPSILON;
    const CORNERS: [[f64; 2]; 5] = [[0.0, 0.0], [0.0, LAST], [LAST, 0.0], [LAST, LAST], [0.5, 0.5]];

    #[test]
    fn the_disc_has_the_square_s_middle_edges_and_corners() {
        for (u, point) in [
            ([0.5, 0.5], [0.0, 0.0]),
            ([1.0, 0.5], [1.0, 0.0]),
            ([0.5, 1.0], [0.0, 1.0]),
            ([0.0, 0.5], [-1.0, 0.0]),
            ([0.5, 0.25], [0.0, -0.5]),
            ([1.0, 1.0], [FRAC_1_SQRT_2, FRAC_1_SQRT_2]),
            ([0.0, 1.0], [-FRAC_1_SQRT_2, FRAC_1_SQRT_2]),
            ([0.75, 0.25], [0.5 * FRAC_1_SQRT_2, -0.5 * FRAC_1_SQRT_2]),
        ] {
            let off = (concentric_disc(u) - DVec2::from(point)).length();
            assert!(off <= f64::EPSILON, "{u:?}: {off}");
        }
    }

    /// The square's four corners, the first and the last number of [0, 1), and its middle.
    #[test]
    fn corners_of_the_square_stay_in_the_domain() {
        for u in CORNERS {
            assert!(concentric_disc(u).length() <= 1.0 + f64::EPSILON, "{u:?}");
            let near_unit = |d: DVec3| (d.length() - 1.0).abs() <= 4.0 * f64::EPSILON;
            for axis in [DVec3::Z, DVec3::NEG_Z, DVec3::new(0.6, 0.0, -0.8), DVec3::Y] {
                let d = cosine_hemisphere(axis, u);
                assert!(near_unit(d) && d.dot(axis) >= -f64::EPSILON, "{u:?} {axis}: {d}");
                for exponent in [0.0, 1.0, 20.0, 1e5] {
                    let d = phong_lobe(axis, exponent, u);
                    assert!(near_unit(d) && d.dot(axis) >= -f64::EPSILON, "{u:?} {axis}: {d}");
                }
            }
        }
    }

    /// Duff et al.: directions near −z, where the frame of Frisvad (2012) breaks down, are as good as others.
    #[test]
    fn frames_are_orthonormal_around_every_axis() {
        let mut random = Uniform::new(3, 0, 0);
        let mut axes: Vec<DVec3> = (0..1000).map(|_| random.direction()).collect();
        for tilt in [0.0, -0.0, 1e-300, 1e-160, 1e-20, 1e-16, 1e-12, 1e-8, 1e-5, 1e-3] {
            for z in [1.0, -1.0] {
                axes.push(DVec3::new(tilt, -0.7 * tilt, z).normalize());
                axes.push(DVec3::new(z, tilt, -tilt).normalize());
            }
        }
        for axis in axes {
            let [x, y] = [DVec3::X, DVec3::Y].map(|v| around(axis, v));
            for product in [x.dot(y), x.dot(axis), y.dot(axis)] {
                assert!(product.abs() <= 4.0 * f64::EPSILON, "{axis}: {product}");
            }
            for length in [x.length(), y.length(), x.cross(y).dot(axis)] {
                assert!((length - 1.0).abs() <= 4.0 * f64::EPSILON, "{axis}: {length}");
            }
        }
    }

    /// `eq:cosine-hemisphere`, `eq:phong-lobe`: by hand.
    #[test]
    fn densities_by_hand() {
        let close = |a: f64, b: f64| (a - b).abs() <= 2.0 * f64::EPSILON * b;
        assert!(close(cosine_hemisphere_density(0.5), 0.5 / PI));
        assert_eq!(cosine_hemisphere_density(-0.5), 0.0);
        assert!(close(phong_lobe_density(0.0, 0.3), 0.5 / PI));
        assert!(close(phong_lobe_density(1.0, 0.3), 0.3 / PI));
        assert!(close(phong_lobe_density(3.0, 0.5), 0.25 / PI));
        assert!(close(phong_lobe_density(1e5, 1.0), 100_001.0 / (2.0 * PI)));
        assert_eq!([phong_lobe_density(2.0, -0.5), phong_lobe_density(0.0, 0.0)], [0.0, 0.0]);
    }

    /// A lobe of exponent 1 is the cosine hemisphere, and one of 0 takes the same disc to equal heights.
    #[test]
    fn lobes_grow_from_the_hemisphere() {
        let mut random = Uniform::new(1, 0, 0);
        for _ in 0..1000 {
            let (axis, u) = (random.direction(), [random.number(), random.number()]);
            let off = phong_lobe(axis, 1.0, u) - cosine_hemisphere(axis, u);
            assert!(off.length() < 1e-14, "{u:?}: {off}");
            let height = phong_lobe(axis, 0.0, u).dot(axis);
            let r = concentric_disc(u).length();
            assert!((height - (1.0 - r * r)).abs() < 1e-14, "{u:?}: {height}");
        }
    }

    /// Of a needle of a lobe: 1 − cos α by ln(1 − r²) ≈ −r² − r⁴/2, to 12 digits.
    #[test]
    fn a_narrow_lobe_keeps_its_digits() {
        let r: f64 = 0.01;
        let direction = phong_lobe(DVec3::Z, 1e5, [0.5 + 0.5 * r, 0.5]);
        let log = r.powi(2) + r.powi(4) / 2.0 + r.powi(6) / 3.0 + r.powi(8) / 4.0;
        let small = log / 100_001.0;
        let one_minus_cos = small - 0.5 * small * small;
        let sin = (one_minus_cos * (2.0 - one_minus_cos)).sqrt();
        assert!((direction.x / sin - 1.0).abs() < 1e-12, "{} {sin}", direction.x);
        let naive = {
            let cos = (1.0 - r * r).powf(1.0 / 100_001.0);
            (1.0 - cos * cos).sqrt()
        };
        assert!((naive / sin - 1.0).abs() > 1e-9, "{naive} {sin}");
    }
}
