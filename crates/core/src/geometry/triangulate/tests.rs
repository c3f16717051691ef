use std::f64::consts::TAU;

use super::*;
use crate::sampling::Uniform;
use glam::{DQuat, dvec3};

fn area(corners: &[DVec3]) -> f64 {
    0.5 * newell_normal(corners).length()
}

/// Cuts a polygon and returns the sum of its triangles' areas.
fn cut(corners: &[DVec3]) -> (f64, Defects) {
    let mut triangles = Vec::new();
    let defects = triangulate(corners, &mut triangles);
    assert_eq!(triangles.len(), corners.len() - 2);
    let areas = triangles.iter().map(|t| area(&t.map(|i| corners[i as usize])));
    (areas.sum(), defects)
}

fn fan_area(corners: &[DVec3]) -> f64 {
    (1..corners.len() - 1).map(|i| area(&[corners[0], corners[i], corners[i + 1]])).sum()
}

fn polygon(corners: &[[f64; 2]]) -> Vec<DVec3> {
    corners.iter().map(|&[x, y]| dvec3(x, y, 0.0)).collect()
}

/// The polygon in every position on its list of corners, turned over, and tilted in space.
fn poses(corners: &[DVec3]) -> Vec<Vec<DVec3>> {
    let tilt = DQuat::from_euler(glam::EulerRot::XYZ, 0.7, -1.9, 2.6);
    let mut poses = Vec::new();
    for start in 0..corners.len() {
        let mut turned = corners.to_vec();
        turned.rotate_left(start);
        poses.push(turned.iter().map(|&p| tilt * p + dvec3(3.0, -1.0, 2.0)).collect());
        poses.push(turned.iter().rev().map(|p| dvec3(p.z, p.x, p.y)).collect());
        poses.push(turned.iter().map(|p| dvec3(p.y, p.z, p.x)).collect());
        poses.push(turned);
    }
    poses
}

#[test]
fn areas_are_kept() {
    let cases: [(&[[f64; 2]], f64); 9] = [
        (&[[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0]], 1.0),
        (&[[4.0, 0.0], [1.0, 1.0], [0.0, 4.0], [0.0, 0.0]], 4.0),
        (&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 1.0),
        // An L, a comb, a square with straight corners, one with repeated corners.
        (&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]], 3.0),
        (
            &[
                [0.0, 0.0],
                [5.0, 0.0],
                [5.0, 3.0],
                [4.0, 3.0],
                [4.0, 1.0],
                [3.0, 1.0],
                [3.0, 3.0],
                [2.0, 3.0],
                [2.0, 1.0],
                [1.0, 1.0],
                [1.0, 3.0],
                [0.0, 3.0],
            ],
            11.0,
        ),
        (&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0]], 4.0),
        (&[[0.0, 0.0], [0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [3.0, 1.0], [0.0, 1.0]], 3.0),
        // A ring: the square (0 … 3)² with the hole (1 … 2)², joined by a bridge.
        (
            &[
                [0.0, 0.0],
                [3.0, 0.0],
                [3.0, 3.0],
                [0.0, 3.0],
                [0.0, 0.0],
                [1.0, 1.0],
                [1.0, 2.0],
                [2.0, 2.0],
                [2.0, 1.0],
                [1.0, 1.0],
            ],
            8.0,
        ),
        // An arrow with a spike of no area.
        (&[[0.0, 0.0], [4.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5], [0.0, 2.0]], 2.5),
    ];
    for (corners, expected) in cases {
        for pose in poses(&polygon(corners)) {
            let (area, defects) = cut(&pose);
            assert!((area - expected).abs() < 1e-12, "{area} for {expected}: {pose:?}");
            assert_eq!(defects, Defects::default(), "{pose:?}");
        }
    }
    // The naive fan, which this test must be able to tell from the truth.
    assert_eq!(fan_area(&polygon(cases[0].0)), 3.0);
    assert_eq!(fan_area(&polygon(cases[1].0)), 12.0);
}

/// Twice the area of the triangle a b c in the integer grid.
fn turn([a, b, c]: [[i64; 2]; 3]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Twice the area of a polygon in the integer grid, positive where it turns counter-clockwise.
fn twice_area(polygon: &[[i64; 2]]) -> i64 {
    (1..polygon.len() - 1).map(|i| turn([polygon[0], polygon[i], polygon[i + 1]])).sum()
}

/// Whether two segments may have a point in common.
fn meet([p, q]: [[i64; 2]; 2], [r, s]: [[i64; 2]; 2]) -> bool {
    let differ = |a: i64, b: i64| a.signum() * b.signum() <= 0;
    differ(turn([p, q, r]), turn([p, q, s])) && differ(turn([r, s, p]), turn([r, s, q]))
}

/// A simple polygon in the integer grid, without straight corners: it grows from a triangle, as
/// a random edge gives way to two over a random point near it that meet no other edge.
fn grown(count: usize, random: &mut Uniform) -> Vec<[i64; 2]> {
    const SIZE: i64 = 1 << 20;
    let mut polygon = vec![[0, 0], [SIZE, 0], [SIZE / 2, SIZE]];
    while polygon.len() < count {
        let n = polygon.len();
        let edge = (random.number() * n as f64) as usize;
        let at = |i: usize| polygon[(edge + i) % n];
        let [a, b] = [at(0), at(1)];
        let length = (b[0] - a[0]).abs().max((b[1] - a[1]).abs()) as f64;
        let mut near =
            |k: usize| (a[k] + b[k]) / 2 + (2.0 * length * (random.number() - 0.5)) as i64;
        let x = [near(0), near(1)];
        let bends = [[a, b, x], [at(n - 1), a, x], [x, b, at(2)]].into_iter().all(|t| turn(t) != 0);
        let free = (1..n).all(|i| {
            let other = [at(i), at(i + 1)];
            (i == n - 1 || !meet([a, x], other)) && (i == 1 || !meet([x, b], other))
        });
        if bends && free {
            polygon.insert(edge + 1, x);
        }
    }
    polygon
}

/// Polygons whose corners are whole numbers, in planes of whole numbers: everything about them is
/// exact, up to a million times their size away.
#[test]
fn areas_of_random_polygons_are_exact() {
    let mut random = Uniform::new(10, 0, 0);
    for case in 0..400 {
        let polygon = grown(4 + case % 30 + case % 7 * (case % 40), &mut random);
        let twice: i64 =
            (1..polygon.len() - 1).map(|i| turn([polygon[0], polygon[i], polygon[i + 1]])).sum();
        let mut integer = || (16.0 * random.number() - 8.0).round();
        let [u, v] = [(); 2].map(|()| dvec3(integer(), integer(), integer()));
        let far = [0.0, 1e3, 1e6][case % 3] * f64::from(1 << 20);
        let offset = (far * dvec3(1.0, -0.7, 0.3)).round();
        let corners: Vec<DVec3> =
            polygon.iter().map(|&[x, y]| offset + x as f64 * u + y as f64 * v).collect();
        let expected = 0.5 * twice.abs() as f64 * u.cross(v).length();
        let (sum, defects) = cut(&corners);
        assert!((sum - expected).abs() <= 1e-12 * expected, "{sum} for {expected}: {polygon:?}");
        assert_eq!(defects, Defects::default(), "{polygon:?}");
    }
}

/// The same polygons in any plane: rounding takes their corners out of it by up to 1e-10 of their
/// size when they are a million times their size away, and of the areas it leaves 1e-12.
#[test]
fn areas_are_kept_in_any_plane_and_far_away() {
    let mut random = Uniform::new(11, 0, 0);
    for case in 0..400 {
        let polygon = grown(4 + case % 200, &mut random);
        let mut angle = || TAU * random.number();
        let tilt = DQuat::from_euler(glam::EulerRot::XYZ, angle(), angle(), angle());
        let offset = [0.0, 1e2, 1e4, 1e6][case % 4] * dvec3(1.0, -0.7, 0.3);
        let place = |&[x, y]: &[i64; 2]| dvec3(x as f64, y as f64, 0.0) / f64::from(1 << 20);
        let corners: Vec<DVec3> = polygon.iter().map(|p| tilt * place(p) + offset).collect();
        let ((sum, defects), whole) = (cut(&corners), area(&corners));
        assert!((sum - whole).abs() <= 1e-12 * whole, "{sum} for {whole}: {corners:?}");
        assert_eq!(defects, Defects::default());
    }
}

/// Star-shaped polygons of random radius, and spirals: simple, and hard on ears.
#[test]
fn areas_of_random_polygons_are_kept() {
    let mut numbers = Uniform::new(12, 0, 0);
    let mut random = || numbers.number();
    for case in 0..2000 {
        let count = 5 + case % 60;
        let tilt = DQuat::from_euler(glam::EulerRot::XYZ, random(), random(), random());
        let star = |i: usize, r: f64| {
            let angle = TAU * i as f64 / count as f64;
            r * dvec3(angle.cos(), angle.sin(), 0.0)
        };
        let spiral = |i: usize| {
            let (turn, r) = if i < count { (i, 1.0) } else { (2 * count - 1 - i, 1.2) };
            let angle = 0.3 * turn as f64;
            (r + 0.1 * angle) * dvec3(angle.cos(), angle.sin(), 0.0)
        };
        let corners: Vec<DVec3> = if case % 2 == 0 {
            (0..count).map(|i| tilt * star(i, 0.05 + random())).collect()
        } else {
            (0..2 * count).map(|i| tilt * spiral(i)).collect()
        };
        let (sum, defects) = cut(&corners);
        let whole = area(&corners);
        assert!((sum - whole).abs() <= 1e-12 * whole, "{sum} for {whole}: {corners:?}");
        assert_eq!(defects, Defects::default());
    }
}

#[test]
fn defects_are_seen() {
    let crossing: [&[[f64; 2]]; 4] = [
        // A bow-tie, one with lobes of the same area, a bow-tie with a tail, a pentagram.
        &[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 3.0]],
        &[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]],
        &[[0.0, 0.0], [2.0, 2.0], [3.0, 1.0], [2.0, 0.0], [0.0, 3.0]],
        &[[0.0, 1.0], [0.6, -0.8], [-1.0, 0.3], [1.0, 0.3], [-0.6, -0.8]],
    ];
    for corners in crossing {
        assert!(cut(&polygon(corners)).1.self_intersecting, "{corners:?}");
    }
    let lifted = |height| [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, height], [0.0, 1.0, 0.0]];
    assert!(cut(&lifted(0.1).map(DVec3::from)).1.non_planar);
    assert!(!cut(&lifted(1e-6).map(DVec3::from)).1.non_planar);
}

#[test]
fn polygons_of_no_area_give_triangles_of_no_area() {
    for corners in [&[[1.0, 1.0]; 6][..], &[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]] {
        assert_eq!(cut(&polygon(corners)), (0.0, Defects::default()));
    }
}

/// Convex, and with every second corner reflex.
#[test]
fn large_polygons_are_cut_as_well() {
    for (count, depth) in [(100_000, 0.0), (20_000, 0.5)] {
        let corners: Vec<DVec3> = (0..count)
            .map(|i| {
                let angle = TAU * f64::from(i) / f64::from(count);
                (1.0 - depth * f64::from(i % 2)) * dvec3(angle.cos(), angle.sin(), 0.0)
            })
            .collect();
        let (sum, defects) = cut(&corners);
        assert!((sum - area(&corners)).abs() < 1e-12 * sum);
        assert_eq!(defects, Defects::default());
    }
}

/// The outline of a circle with waves, all of its corners nearer to each other than rounding: whether a point is
/// inside is told by few of them.
#[test]
fn dense_outlines_are_cut_in_few_steps() {
    let count = 100_000;
    let at = |i: usize, share: f64| {
        let angle = TAU * i as f64 / count as f64;
        share * (1.0 + 0.1 * (40.0 * angle).cos()) * DVec2::from_angle(angle)
    };
    let flat: Vec<DVec2> = (0..count).map(|i| at(i, 1.0)).collect();
    let outline = outline::Outline::new(&flat);
    for i in (0..count).step_by(97) {
        for (share, turns) in [(1.0 - 1e-6, 1), (1.0 + 1e-6, 0)] {
            assert_eq!(outline.winding_number(at(i, share)), turns);
            let steps = outline.around(at(i, share)).count();
            assert!(steps < 2000, "{steps} at {i}");
        }
    }
    let corners: Vec<DVec3> = flat.iter().map(|p| p.extend(0.0)).collect();
    let (sum, defects) = cut(&corners);
    assert!((sum - area(&corners)).abs() < 1e-12 * sum);
    assert_eq!(defects, Defects::default());
}

/// Ears are as narrow as can be: of a circle with fine teeth, those of each sweep are twice as wide and half as many.
/// A fan's are a circle's width each, 10⁵ in all.
#[test]
fn ears_stay_narrow() {
    let count = 100_000_i32;
    let corners: Vec<DVec3> = (0..count)
        .map(|i| {
            let angle = TAU * f64::from(i) / f64::from(count);
            (1.0 - 1e-4 * f64::from(i % 2)) * dvec3(angle.cos(), angle.sin(), 0.0)
        })
        .collect();
    let mut triangles = Vec::new();
    triangulate(&corners, &mut triangles);
    let longest_sides = triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|i| corners[i as usize]);
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    });
    // One turn per sweep, and one of the teeth.
    let sweeps = f64::from(count.ilog2() + 2);
    assert!(longest_sides.sum::<f64>() < 2.0 * TAU * sweeps);
}

/// Polygons that touch themselves, on whole numbers.
const CONTACTS: [(&str, &[[i64; 2]]); 13] = [
    (
        "a hole's corner on an edge",
        &[[0, 0], [8, 0], [8, 8], [0, 8], [2, 3], [6, 3], [4, 0], [2, 3], [0, 8]],
    ),
    (
        "a hole's corner on a corner",
        &[[0, 0], [8, 0], [8, 8], [5, 2], [0, 0], [2, 5], [5, 2], [8, 8], [0, 8]],
    ),
    (
        "a hole's edge on an edge",
        &[[0, 0], [8, 0], [8, 8], [0, 8], [2, 2], [4, 2], [4, 0], [2, 0], [2, 2], [0, 8]],
    ),
    (
        "a hole's edges on two edges",
        &[[0, 0], [8, 0], [8, 8], [3, 3], [3, 0], [0, 0], [0, 3], [3, 3], [8, 8], [0, 8]],
    ),
    (
        "a hole's corners on all edges",
        &[[0, 0], [4, 0], [0, 4], [4, 8], [8, 4], [4, 0], [8, 0], [8, 8], [0, 8]],
    ),
    (
        "two holes and the outline in a row",
        &[
            [0, 0],
            [8, 0],
            [8, 8],
            [7, 4],
            [8, 3],
            [4, 4],
            [7, 4],
            [8, 8],
            [0, 8],
            [1, 4],
            [4, 4],
            [2, 0],
            [1, 4],
            [0, 8],
        ],
    ),
    ("a notch down to an edge", &[[0, 0], [8, 0], [8, 8], [5, 8], [4, 0], [3, 8], [0, 8]]),
    (
        "a notch down to a straight corner",
        &[[0, 0], [4, 0], [8, 0], [8, 8], [5, 8], [4, 0], [3, 8], [0, 8]],
    ),
    ("a notch with an upright side", &[[0, 0], [8, 0], [8, 8], [5, 8], [5, 0], [3, 8], [0, 8]]),
    ("squares corner to corner", &[[0, 0], [2, 0], [2, 2], [4, 2], [4, 4], [2, 4], [2, 2], [0, 2]]),
    ("a quadrilateral's corner on its edge", &[[0, 0], [4, 0], [4, 4], [2, 0]]),
    ("a slit", &[[0, 0], [8, 0], [8, 8], [0, 8], [0, 5], [3, 2], [6, 5], [3, 2], [0, 5]]),
    (
        "straight corners on both sides",
        &[
            [0, 0],
            [2, 0],
            [4, 0],
            [6, 0],
            [8, 0],
            [8, 4],
            [8, 8],
            [4, 8],
            [0, 8],
            [0, 4],
            [2, 2],
            [3, 2],
            [4, 2],
            [4, 1],
            [4, 0],
            [3, 1],
            [2, 2],
            [0, 4],
        ],
    ),
];

/// A grown polygon with a triangular hole that touches its outline, at the middle of an edge or at a
/// corner: the hole is in a triangle of the polygon, which has that edge and the bridge's corner.
fn grown_with_hole(count: usize, random: &mut Uniform) -> Vec<[i64; 2]> {
    let mut outline: Vec<[i64; 2]> =
        grown(count, random).into_iter().map(|corner| corner.map(|k| 32 * k)).collect();
    if twice_area(&outline) < 0 {
        outline.reverse();
    }
    let flat: Vec<DVec3> = outline.iter().map(|&[x, y]| dvec3(x as f64, y as f64, 0.0)).collect();
    let mut triangles = Vec::new();
    triangulate(&flat, &mut triangles);
    // Every triangulation has ears: triangles with two edges of the outline.
    let ears: Vec<[usize; 3]> = triangles
        .iter()
        .map(|t| t.map(|i| i as usize))
        .filter(|&[a, b, c]| (a + 1) % count == b && (b + 1) % count == c)
        .collect();
    let [a, b, c] = ears[(random.number() * ears.len() as f64) as usize];
    let mix = |weights: [i64; 3]| {
        let corners = [a, b, c].map(|i| outline[i]);
        [0, 1].map(|axis| (0..3).map(|k| weights[k] * corners[k][axis]).sum::<i64>() / 32)
    };
    let [on_edge, on_corner] = [mix([16, 16, 0]), outline[a]];
    let contact = if random.number() < 0.5 { on_edge } else { on_corner };
    // Clockwise, from the corner that the bridge leads to.
    let hole = [mix([4, 4, 24]), contact, mix([6, 8, 18])];
    let hole = if turn(hole) < 0 { hole } else { [hole[0], hole[2], hole[1]] };
    let mut polygon = outline.clone();
    polygon.splice(c + 1..c + 1, [hole[0], hole[1], hole[2], hole[0], outline[c]]);
    polygon
}

/// What touches exactly in the plane touches up to rounding once it is turned in space and moved: there
/// the polygon crosses itself or leaves a gap, by the last bit, or by the last digit of a file. The area
/// is known in whole numbers; rounding moves it by no more than the corners times the outline's length.
#[test]
fn polygons_that_touch_themselves_are_cut_in_any_pose() {
    let mut random = Uniform::new(13, 0, 0);
    for case in 0..6000 {
        let (name, mut polygon) = match CONTACTS.get(case % (2 * CONTACTS.len())) {
            Some(&(name, polygon)) => (name, polygon.to_vec()),
            None => ("a hole in a grown polygon", grown_with_hole(4 + case % 50, &mut random)),
        };
        let twice = twice_area(&polygon);
        let size = polygon.iter().flatten().map(|k| k.abs()).max().unwrap() as f64;
        let first = case % 7 % polygon.len();
        polygon.rotate_left(first);
        let mut number = || 2.0 * random.number() - 1.0;
        let pose = DQuat::from_xyzw(number(), number(), number(), number()).normalize();
        let away = size * [0.0, 1.0, 1e3, 1e6][case % 4];
        let offset = away * dvec3(number(), number(), number());
        let placed = polygon.iter().map(|&[x, y]| pose * dvec3(x as f64, y as f64, 0.0) + offset);
        let (corners, rounding): (Vec<DVec3>, f64) = if case % 3 == 0 {
            // A file with six digits for the polygon's size, and more for its place.
            let unit = 10_f64.powi(size.log10().ceil() as i32 - 6);
            (placed.map(|p| (p / unit).round() * unit).collect(), unit)
        } else {
            (placed.collect(), 4.0 * f64::EPSILON * size.max(away))
        };
        let next = corners.iter().cycle().skip(1);
        let length: f64 = corners.iter().zip(next).map(|(a, &b)| a.distance(b)).sum();
        let tolerance = rounding * length;

        let mut triangles = Vec::new();
        let defects = triangulate(&corners, &mut triangles);
        let up = twice.signum() as f64 * (pose * DVec3::Z);
        let areas = triangles.iter().map(|t| {
            let [a, b, c] = t.map(|i| corners[i as usize]);
            0.5 * (b - a).cross(c - a).dot(up)
        });
        let (sum, least) =
            areas.fold((0.0, 0.0_f64), |(sum, least), area| (sum + area.abs(), least.min(area)));
        let whole = 0.5 * twice.abs() as f64;
        assert!((sum - whole).abs() <= tolerance, "{name}, {case}: {sum} for {whole}: {corners:?}");
        assert!(least >= -tolerance, "{name}, {case}: {least} is turned over: {corners:?}");
        assert_eq!(triangles.len(), corners.len() - 2);
        assert_eq!(defects, Defects::default(), "{name}, {case}: {corners:?}");
    }
}
