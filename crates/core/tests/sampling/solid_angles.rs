//! Solid angles and places within rectangles against 40 digits.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use lancer_core::sampling::{Rectangle, parallelogram_solid_angle, triangle_solid_angle};

use super::rows::rows;

/// `eq:solid-angle`: an octant, and lamps of the closed forms.
#[test]
fn solid_angles_are_those_of_the_closed_form() {
    let octant = triangle_solid_angle([DVec3::X, DVec3::Y, DVec3::Z]);
    assert!((octant / FRAC_PI_2 - 1.0).abs() < 1e-15, "{octant}");
    for row in rows() {
        let found = parallelogram_solid_angle(row.corner - row.from, row.edges);
        // Truths have 12 to 15 digits, those of Cornell's lamp fewest.
        let bound = if row.name.starts_with('C') { 5e-13 } else { 4e-15 };
        assert!((found / row.solid_angle - 1.0).abs() < bound, "{}: {found}", row.name);
        let [left, right] = row.edges.map(|edge| row.corner + edge - row.from);
        let [corner, opposite] = [row.corner - row.from, left + row.edges[1]];
        let halves = triangle_solid_angle([corner, left, right])
            + triangle_solid_angle([opposite, right, left]);
        assert!((halves / found - 1.0).abs() < 4e-15, "{}: {halves}", row.name);
    }
}

/// Girard: the sum of a triangle's angles minus π.
fn girard([a, b, c]: [DVec3; 3]) -> f64 {
    let angle = |a: DVec3, b: DVec3, c: DVec3| a.cross(b).angle_between(a.cross(c));
    angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - std::f64::consts::PI
}

/// Squares that get smaller or are seen at ever more grazing angles: relative errors, to 40 digits from the same
/// coordinates. The sum of the angles loses the digits that these keep.
#[test]
fn small_and_grazing_rectangles_keep_their_digits() {
    let around = |w: f64| (DVec3::new(0.3 - w / 2.0, 0.2 - w / 2.0, 1.0), w);
    let beside = |h: f64| (DVec3::new(0.5, -0.5, h), 1.0);
    for ((corner, side), solid_angle, bound, naive) in [
        (around(1.0), 0.7159512580638312, 1e-15, 0.0),
        (around(1e-2), 8.324832230185327e-5, 4e-15, 1e-13),
        (around(1e-4), 8.324963423902155e-9, 4e-13, 1e-9),
        (around(1e-6), 8.324963437021673e-13, 4e-12, 1e-5),
        (beside(1e-4), 0.00014404839956856416, 1e-15, 1e-13),
        (beside(1e-6), 1.4404840359305161e-6, 1e-15, 1e-11),
        (beside(1e-8), 1.4404840359345407e-8, 1e-15, 1e-9),
        // Close above its middle, on the diagonal where its two triangles meet.
        ((DVec3::new(-1.0, -1.0, 1e-6), 2.0), 6.283179650325337, 1e-9, 0.0),
    ] {
        let edges = [side * DVec3::Y, side * DVec3::X];
        let found = parallelogram_solid_angle(corner, edges);
        let error = (found / solid_angle - 1.0).abs();
        assert!(error <= bound, "{corner} {side}: {error}");
        let [left, right] = edges.map(|edge| corner + edge);
        let by_angles = girard([corner, left, right]) + girard([left + edges[1], right, left]);
        let error = (by_angles / solid_angle - 1.0).abs();
        assert!(error >= naive, "{corner} {side}: {error}");
    }
}

/// Where numbers fall in a rectangle, as shares of its sides: S(x) = u Ω solved to 50 digits. At most the bound
/// is that of the least solid angle that is sampled so; rectangles that are not small do much better.
#[test]
fn places_in_rectangles_are_those_of_the_closed_form() {
    #[rustfmt::skip]
    let cases = [
        // Corner and height, width and depth, then for (0.3, 0.7) and (0.001, 0.999) the shares, and the bound.
        ([-0.5, -0.5, 1.0], [1.0, 1.0], [[0.3171106252490313, 0.6823310003562111], [0.0012322000624871212, 0.9988005227642932]], 1e-14),
        ([1.0, -0.5, 1.0], [1.0, 1.0], [[0.18398897788172047, 0.6917911991300131], [0.0005388073676972053, 0.9988754884989688]], 1e-14),
        ([-1.0, -1.0, 0.1], [2.0, 2.0], [[0.46758364009110366, 0.5257895477356365], [0.019492922749233599, 0.997935445795742]], 1e-14),
        ([-2.0, 0.95, 1.0], [4.0, 0.1], [[0.37787582201341664, 0.6856778270173288], [0.0029837752830753927, 0.998974121110524]], 1e-14),
        ([-0.2, -0.3, 1.0], [1.0, 1.0], [[0.2531563184658209, 0.6323071198853696], [0.0008777118425674917, 0.9984580839801251]], 1e-14),
        ([-1.0, -1.0, 1e-3], [2.0, 2.0], [[0.4996371604265809, 0.5002696212025107], [0.38743382398103645, 0.9804212702760585]], 1e-13),
        ([-50.0, 3.0, 1.0], [100.0, 0.01], [[0.4862109035568, 0.6992059450550806], [0.14680137146155566, 0.9989999641711719]], 1e-10),
        ([0.295, 0.195, 1.0], [0.01, 0.01], [[0.2991661892414419, 0.6994397732374836], [0.0009960507689914268, 0.998997315540572]], 1e-12),
        ([0.298, 0.198, 1.0], [0.0035, 0.0035], [[0.2997077812036923, 0.6998047361681048], [0.0009986120036818898, 0.9989990687353866]], 1e-10),
        ([0.5, 0.0, 1e-2], [1.0, 1.0], [[0.1076189705108709, 0.4536484534417739], [0.000289315588417854, 0.995035929205024]], 1e-13),
        ([0.5, 0.0, 1e-4], [1.0, 1.0], [[0.10760068943596678, 0.4536049108866053], [0.0002892565639468754, 0.9950343540555356]], 1e-10),
        ([1.0, 1.0, 1e-4], [1.0, 1.0], [[0.20478952371030616, 0.5587665979476628], [0.0006127745054332595, 0.9979089196927248]], 1e-10),
        ([0.5, 0.0, 1e-5], [1.0, 1.0], [[0.10760068762569009, 0.45360490657455015], [0.00028925655810207995, 0.9950343538995182]], 1e-10),
    ];
    for ([x, y, h], [width, depth], places, bound) in cases {
        // It shines down, and its first edge is the one along which the first number counts.
        let corner = DVec3::new(x, -y, h);
        let rectangle = Rectangle::new(corner, [width * DVec3::X, -depth * DVec3::Y]).unwrap();
        let seen = rectangle.seen_from(DVec3::ZERO).unwrap();
        for (u, [s, t]) in [[0.3, 0.7], [0.001, 0.999]].into_iter().zip(places) {
            let place = seen.sample(u) - corner;
            let error = (place.x / width - s).abs().max((-place.y / depth - t).abs());
            assert!(error <= bound, "{x} {y} {h} {u:?}: {error}");
        }
    }
}
