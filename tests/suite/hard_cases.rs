//! One triangle and the inputs that break triangle tests, each with the answer to demand.

use glam::{DVec2, DVec3};
use lancer_core::geometry::{Ray, Shear, TriangleHit, intersect_triangle};
use lancer_lesson::naive::BySigns;

use crate::random::Random;

const fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

const UNIT: [DVec3; 3] = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)];

fn hit(corners: [DVec3; 3], origin: DVec3, direction: DVec3) -> Option<TriangleHit> {
    intersect_triangle(corners, &Ray::new(origin, direction), &Shear::new(direction))
}

fn t(corners: [DVec3; 3], origin: DVec3, direction: DVec3) -> Option<f64> {
    hit(corners, origin, direction).map(|hit| hit.t)
}

/// eq:ray-triangle by hand.
#[test]
fn plain_hits_have_the_worked_out_parameter_and_weights() {
    let got = hit(UNIT, v(0.25, 0.5, 1.0), v(0.0, 0.0, -2.0)).unwrap();
    assert_eq!(got.t, 0.5);
    assert_eq!(got.barycentric, v(0.25, 0.25, 0.5));
    let back = t(UNIT, v(0.25, 0.25, -1.0), v(0.0, 0.0, 1.0));
    assert_eq!(back, Some(1.0));
}

#[test]
fn what_is_in_the_plane_or_no_triangle_or_no_ray_is_missed() {
    let from = v(0.25, 0.25, 1.0);
    let down = v(0.0, 0.0, -1.0);
    assert_eq!(t(UNIT, v(-1.0, 0.25, 0.0), DVec3::X), None, "a ray in the plane");
    assert_eq!(t(UNIT, v(0.25, 0.25, 0.0), DVec3::Z), None, "a ray that starts on it");
    let a = v(0.5, 0.0, 0.0);
    assert_eq!(t([a, a, a], v(0.5, 0.0, 1.0), down), None, "a point");
    assert_eq!(t([UNIT[0], UNIT[1], a], v(0.5, 0.0, 1.0), down), None, "a segment");
    for direction in [DVec3::ZERO, -DVec3::ZERO, DVec3::NAN, v(0.0, f64::NAN, 1.0)] {
        assert_eq!(t(UNIT, from, direction), None, "{direction}");
    }
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX / 4.0] {
        for k in 0..3 {
            for axis in 0..3 {
                let mut corners = UNIT;
                corners[k][axis] = value;
                let got = t(corners, from, down);
                assert!(got.is_none_or(f64::is_finite), "{corners:?}");
            }
        }
        assert_eq!(t(UNIT, v(value, 0.25, 1.0), down), None);
    }
}

/// pbrt's regression case: the three corners are on a line, and `f32` reports a hit.
#[test]
fn the_published_degenerate_triangle_is_missed() {
    let corners = [
        v(-1113.45459, -79.049614, -56.2431908),
        v(-1113.45459, -87.0922699, -56.2431908),
        v(-1113.45459, -79.2090149, -56.2431908),
    ];
    let origin = v(-1081.47925, 99.9999542, 87.7701111);
    assert_eq!(t(corners, origin, v(-32.1072998, -183.355865, -144.607635)), None);
}

#[test]
fn extreme_sizes_and_distances_are_met() {
    let down = v(0.0, 0.0, -1.0);
    let sliver = [UNIT[0], UNIT[1], v(0.5, f64::EPSILON, 0.0)];
    assert_eq!(t(sliver, v(0.5, 0.25 * f64::EPSILON, 1.0), down), Some(1.0));
    let small = UNIT.map(|p| 1e-20 * p);
    let near = t(small, v(2e-21, 2e-21, 1e-20), down).unwrap();
    assert!((near / 1e-20 - 1.0).abs() <= 4.0 * f64::EPSILON, "{near:e}");
    assert_eq!(t(UNIT, v(0.25, 0.25, 1e15), down), Some(1e15));
    let slow = v(0.0, 0.0, -f64::MIN_POSITIVE);
    assert_eq!(t(UNIT, v(0.25, 0.25, 1.0), slow), Some(1.0 / f64::MIN_POSITIVE));
    let slower = v(0.0, 0.0, -f64::from_bits(1));
    assert_eq!(t(UNIT, v(0.25, 0.25, 1.0), slower), None, "the parameter would be infinite");
    let grazing = t(UNIT, v(-1.0, 0.25, 1e-7), v(1.0, 0.0, -8e-8)).unwrap();
    assert!((grazing - 1.25).abs() < 1e-12, "{grazing}");
}

/// A ray in the plane of a triangle but beside it. The edge functions are rounding noise that may agree
/// in sign; without the range rule some of these are reported as hits. Corners and rays are integer
/// combinations of two integer vectors, so that they lie in one plane exactly.
#[test]
fn edge_on_rays_beside_a_triangle_are_missed() {
    let mut random = Random::new(7);
    let (mut tested, mut naive) = (0, 0);
    while tested < 200_000 {
        let mut vector = || v(random.integer(999), random.integer(999), random.integer(999));
        let (p, q) = (vector(), vector());
        let mut combination = || DVec2::new(random.integer(9), random.integer(9));
        let corners = [combination(), combination(), combination()];
        let (origin, direction) = (combination(), combination());
        let sides = corners.map(|corner| direction.perp_dot(corner - origin));
        let beside = sides.iter().all(|&side| side > 0.0) || sides.iter().all(|&side| side < 0.0);
        if !beside || p.cross(q) == DVec3::ZERO {
            continue;
        }
        let in_space = |c: DVec2| c.x * p + c.y * q;
        let (corners, ray) =
            (corners.map(in_space), Ray::new(in_space(origin), in_space(direction)));
        assert_eq!(hit(corners, ray.origin, ray.direction), None, "{corners:?} {ray:?}");
        naive += usize::from(BySigns::new(&ray).plain(corners).is_some());
        tested += 1;
    }
    assert!(naive > 0, "the signs of the edge functions alone do as well");
}

/// Random bits as coordinates: nothing panics, and every reported hit is a number.
#[test]
fn random_bits_give_no_nan() {
    let mut random = Random::new(13);
    let mut hits = 0;
    let bits = |random: &mut Random| {
        let number = |random: &mut Random| {
            f64::from_bits(
                (random.unit() * 2.0_f64.powi(53)) as u64 * 2048 + random.below(2048) as u64,
            )
        };
        v(number(random), number(random), number(random))
    };
    for _ in 0..1_000_000 {
        let corners = [bits(&mut random), bits(&mut random), bits(&mut random)];
        let got = hit(corners, bits(&mut random), bits(&mut random));
        if let Some(hit) = got {
            hits += 1;
            assert!(hit.t.is_finite() && hit.t > 0.0);
        }
    }
    assert!(hits < 1_000_000);
}

/// Interior hits against integers: corners and weights are chosen so that the exact answer is known.
#[test]
fn interior_hits_are_accurate_to_a_few_ulps() {
    let mut random = Random::new(19);
    for _ in 0..100_000 {
        let mut point = |size| v(random.integer(size), random.integer(size), random.integer(size));
        let corners = [point(1 << 10) * 64.0, point(1 << 10) * 64.0, point(1 << 10) * 64.0];
        // From about as far away as the triangle is large: nearer, its corners' depths cancel.
        let origin_offset = point(1 << 10) * 32.0;
        let weights = [20.0, 27.0, 17.0];
        let target = (0..3).map(|k| corners[k] * (weights[k] / 64.0)).sum::<DVec3>();
        let n = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        // A well-conditioned triangle, seen at less than 80 degrees from its normal.
        if n.length() < 1e9
            || origin_offset.dot(n).abs() < 0.17 * n.length() * origin_offset.length()
        {
            continue;
        }
        let origin = target - 3.0 * origin_offset;
        let got = hit(corners, origin, origin_offset).expect("the target is inside");
        let ulps = |a: f64, b: f64| (a - b).abs() / (b.abs() * f64::EPSILON);
        assert!(ulps(got.t, 3.0) <= 16.0, "t = {} for {corners:?}", got.t);
        let error = (got.barycentric - DVec3::from(weights) / 64.0).abs().max_element();
        assert!(error <= 64.0 * f64::EPSILON, "weights {}: {error:e}", got.barycentric);
        let sum = got.barycentric.element_sum();
        assert!((sum - 1.0).abs() <= 4.0 * f64::EPSILON);
        assert!(got.barycentric.min_element() >= 0.0);
    }
}
