//! Lobes around the mirror direction: their share above the horizon, and what a cosine leaves of it.

use glam::DVec3;
use lancer_core::sampling::phong_lobe;

use super::statistics::{agrees, replicated};

/// n, then for views at some angles the share of the lobe above the horizon, and (n+2)/(n+1) times the mean cosine
/// there, in closed form.
type Row = (f64, [f64; 4], [f64; 4]);

#[rustfmt::skip]
const ROWS: [Row; 5] = [
    (1.0, [0.93301270189, 0.75, 0.58682408883, 0.5], [0.88084277958, 0.60899778104, 0.40994525359, 0.32708456708]),
    (10.0, [0.99993529915, 0.95906788442, 0.71476209601, 0.5], [0.86602852526, 0.50473594666, 0.22805629255, 0.13196043225]),
    (50.0, [1.0, 0.99993110424, 0.89315925674, 0.5], [0.86602540378, 0.50000211223, 0.18080803269, 0.065290738232]),
    (100.0, [1.0, 0.9999999622, 0.96030028237, 0.5], [0.86602540378, 0.50000000061, 0.17523262352, 0.04912536396]),
    (1000.0, [1.0, 1.0, 0.99999998441, 0.5], [0.86602540378, 0.5, 0.17364817775, 0.023212292717]),
];

fn normal(degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    DVec3::new(sin, 0.0, cos)
}

/// `eq:phong-lobe`: 64 scramblings of 16384 samples. Where less than a tenth of one of these is expected below the horizon, at
/// most 5 are: once in 10⁶.
#[test]
fn shares_above_the_horizon_are_those_of_the_closed_form() {
    for (exponent, shares, _) in ROWS {
        for (share, degrees) in shares.into_iter().zip([30.0, 60.0, 80.0, 90.0]) {
            let n = normal(degrees);
            let above = |u| f64::from(phong_lobe(DVec3::Z, exponent, u).dot(n) > 0.0);
            let estimate = replicated(16_384, above);
            let below = (64.0_f64 * 16_384.0 * (1.0 - estimate.mean())).round();
            if 64.0 * 16_384.0 * (1.0 - share) < 0.1 {
                assert!(below <= 5.0, "{exponent} {degrees}: {below}");
            } else {
                assert!(agrees(&estimate, share), "{exponent} {degrees}: {estimate:?}");
            }
        }
    }
}

/// The same lobe with a cosine, the albedo of Lafortune and Willems: at 89° for the last column. The lobe of n − 1
/// has another.
#[test]
fn cosines_of_lobes_are_those_of_the_closed_form() {
    for (exponent, _, albedos) in ROWS {
        for (albedo, degrees) in albedos.into_iter().zip([30.0, 60.0, 80.0, 89.0]) {
            let n = normal(degrees);
            let weight = (exponent + 2.0) / (exponent + 1.0);
            let cosine =
                |exponent: f64| move |u| weight * phong_lobe(DVec3::Z, exponent, u).dot(n).max(0.0);
            let estimate = replicated(4096, cosine(exponent));
            // Truths have 11 digits.
            let off = (estimate.mean() - albedo).abs() < 1e-11;
            assert!(off || agrees(&estimate, albedo), "{exponent} {degrees}: {estimate:?}");
            if exponent <= 100.0 {
                let mistaken = replicated(4096, cosine(exponent - 1.0));
                assert!(!agrees(&mistaken, albedo), "{exponent} {degrees}: {mistaken:?}");
            }
        }
    }
}
