//! Two strategies with the weights of `eq:mis`: by the lamp and by the hemisphere.

use glam::DVec3;
use lancer_core::sampling::{
    Estimate, Patch, area_light_density, cosine_hemisphere, cosine_hemisphere_density,
    power_heuristic,
};

use super::rows::{Row, rows};
use super::statistics::{agrees, replicated};

/// The irradiance of a row's lamp by a sample of the lamp and one of the hemisphere, `density` being the lamp's as the
/// hemisphere's sample is told it.
fn by_both(row: &Row, density: impl Fn(&Patch, DVec3) -> f64) -> Estimate {
    let patch = row.patch();
    let normal = row.edges[0].cross(row.edges[1]).normalize();
    let by_lamp = |u: [f64; 2]| {
        let sample = patch.seen_from(row.from).sample(u).unwrap();
        let cosine = row.cosine(sample.position);
        let weight = power_heuristic(sample.density, cosine_hemisphere_density(cosine));
        weight * cosine / sample.density
    };
    let by_hemisphere = |u: [f64; 2]| {
        let direction = cosine_hemisphere(row.n, u);
        let t = (row.corner - row.from).dot(normal) / direction.dot(normal);
        let place = row.from + t * direction - row.corner;
        let inside = |edge: DVec3| (0.0..=1.0).contains(&(place.dot(edge) / edge.length_squared()));
        if !(t > 0.0 && row.edges.into_iter().all(inside)) {
            return 0.0;
        }
        let cosine = direction.dot(row.n);
        let own = cosine_hemisphere_density(cosine);
        let other = density(&patch, row.corner + place);
        power_heuristic(own, other) * cosine / own
    };
    // The same numbers for both, moved apart: what matters here are the means.
    replicated(1024, |[u, v]| by_lamp([u, v]) + by_hemisphere([v, 1.0 - u]))
}

/// `eq:mis`: the two make the irradiance together, whichever way the lamp is sampled.
#[test]
fn lamp_and_hemisphere_make_the_irradiance_together() {
    for row in rows() {
        let estimate = told(&row);
        assert!(agrees(&estimate, row.irradiance), "{}: {estimate:?}", row.name);
    }
}

/// The same on either side of both limits: κ = 1.3, where the square at height 1 has the side 1.1747, and Ω = 10⁻⁵, of
/// a square seen from beside its plane.
#[test]
fn at_the_limits_of_both_ways_the_irradiance_is_the_same() {
    let centred = |side: f64| {
        let half = 0.5 * side;
        let corner = DVec3::new(-half, -half, 1.0);
        // Lambert: four times the quarter's.
        let d = half.hypot(1.0);
        let irradiance = 4.0 * half / d * (half / d).atan();
        let edges = [side * DVec3::Y, side * DVec3::X];
        Row { corner, edges, irradiance, ..rows().remove(0) }
    };
    let beside = |height: f64, irradiance: f64| {
        let corner = DVec3::new(0.5, 0.0, height);
        let edges = [DVec3::Y, DVec3::X];
        Row { corner, edges, n: DVec3::X, irradiance, ..rows().remove(0) }
    };
    for (row, by_solid_angle) in [
        (centred(1.17), false),
        (centred(1.18), true),
        // Lambert, in 30 digits.
        (beside(1.05e-5, 9.567052421022037e-6), true),
        (beside(0.9e-5, 8.200330647363364e-6), false),
    ] {
        let patch = row.patch();
        let density = |u| patch.seen_from(row.from).sample(u).unwrap().density;
        assert_eq!(density([0.1, 0.2]) == density([0.4, 0.7]), by_solid_angle, "{}", row.corner);
        let estimate = told(&row);
        assert!(agrees(&estimate, row.irradiance), "{}: {estimate:?}", row.corner);
    }
}

/// Both with the density that the patch tells.
fn told(row: &Row) -> Estimate {
    let normal = row.edges[0].cross(row.edges[1]).normalize();
    by_both(row, |patch: &Patch, point| patch.seen_from(row.from).density(point, normal))
}

/// The weights of another way than the samples' are seen: a density by area for a lamp that is sampled by solid angle.
#[test]
fn weights_of_another_way_are_wrong() {
    for row in rows().iter().filter(|row| ["R7", "R10"].contains(&row.name)) {
        let estimate = by_both(row, |patch, point| {
            let back = row.from - point;
            let cos = row.edges[0].cross(row.edges[1]).normalize().dot(back) / back.length();
            area_light_density(back.length_squared(), cos, patch.area())
        });
        assert!(!agrees(&estimate, row.irradiance), "{}: {estimate:?}", row.name);
    }
}
