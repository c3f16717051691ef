/// The weight of a sample that two strategies could have drawn, by the power heuristic with β = 2.
///
/// ```text
/// eq:mis                  w = p₁² / (p₁² + p₂²) = 1 / (1 + (p₂ / p₁)²)
/// ```
///
/// `own` is p₁ > 0, the density with which the sample was drawn, and `other` is p₂ ≥ 0, that with which the other
/// strategy would have drawn it, both per solid angle and with all choices in them. Of the two weights of a direction
/// the sum is 1. The quotient overflows nowhere: p₂ = 0 has the weight 1, and where the other is infinitely more
/// likely it is 0.
///
/// A point light, or a mirror, is found by one strategy only: there the weight is 1, without asking.
///
/// Source: Veach, Guibas, *Optimally Combining Sampling Techniques for Monte Carlo Rendering*, SIGGRAPH 1995.
#[doc(alias = "eq:mis")]
#[doc(alias = "échantillonnage préférentiel multiple")]
#[doc(alias = "multiple importance sampling")]
#[inline]
pub fn power_heuristic(own: f64, other: f64) -> f64 {
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `eq:mis`, by hand.
    #[test]
    fn weights_by_hand() {
        for (own, other, weight) in
            [(1.0, 1.0, 0.5), (2.0, 1.0, 0.8), (1.0, 2.0, 0.2), (3.0, 1.0, 0.9), (0.5, 0.0, 1.0)]
        {
            assert!((power_heuristic(own, other) - weight).abs() <= f64::EPSILON);
        }
    }

    /// Densities whose squares are no numbers: the naive form answers NaN.
    #[test]
    fn extreme_densities_have_weights() {
        let naive = |p1: f64, p2: f64| p1 * p1 / (p1 * p1 + p2 * p2);
        for (own, other, weight) in [
            (1e200, 1e200, 0.5),
            (1e-200, 1e-200, 0.5),
            (2e250, 1e250, 0.8),
            (f64::INFINITY, 1.0, 1.0),
            (1.0, f64::INFINITY, 0.0),
        ] {
            assert!((power_heuristic(own, other) - weight).abs() <= f64::EPSILON, "{own} {other}");
        }
        assert!(naive(1e200, 1e200).is_nan() && naive(1e-200, 1e-200).is_nan());
    }

    #[test]
    fn the_weights_of_a_direction_add_up_to_one() {
        for k in -300..300 {
            let p = 10_f64.powf(0.7 * f64::from(k));
            for q in [1.0, 0.3, 17.0] {
                let sum = power_heuristic(p, q) + power_heuristic(q, p);
                assert!((sum - 1.0).abs() <= f64::EPSILON, "{p} {q}: {sum}");
            }
        }
    }
}
