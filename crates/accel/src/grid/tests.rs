use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

use super::*;

/// A lattice of unit cells from the origin.
fn units(x: i32, y: i32, z: i32) -> Lattice {
    Lattice { min: DVec3::ZERO, width: DVec3::ONE, resolution: IVec3::new(x, y, z) }
}

fn cells(lattice: Lattice, ray: &Ray) -> Vec<IVec3> {
    let Bounds3 { min, max } = Bounds3 { min: DVec3::ZERO, max: lattice.resolution.as_dvec3() };
    let enter = Slabs::new(ray).enter(min, max, Interval::POSITIVE);
    enter.map_or(Vec::new(), |enter| Dda::new(lattice, ray, enter).collect())
}

/// Coordinates of origins count in this part of a cell.
const PARTS: i64 = 16;

/// The cells whose inside the ray meets, in integers: at a corner all tied axes step at once.
fn exact(count: i64, origin: [i64; 3], direction: [i64; 3]) -> Vec<IVec3> {
    let [x, y, z] = [0, 1, 2].map(|k| match direction[k] {
        ..0 => (origin[k] + PARTS - 1).div_euclid(PARTS) - 1,
        0.. => origin[k].div_euclid(PARTS),
    });
    let mut cell = [x, y, z];
    let mut met = Vec::new();
    while cell.iter().all(|index| (0..count).contains(index)) {
        met.push(IVec3::from_array(cell.map(|index| index as i32)));
        // Numerator and denominator, the latter positive, of each plane's parameter.
        let crossing = [0, 1, 2].map(|k| {
            let plane = (cell[k] + i64::from(direction[k] > 0)) * PARTS;
            ((plane - origin[k]) * direction[k].signum(), direction[k].abs())
        });
        let before = |a: (i64, i64), b: (i64, i64)| a.0 * b.1 < b.0 * a.1;
        let axes = [0, 1, 2].into_iter().filter(|&k| direction[k] != 0);
        let first = axes.reduce(|a, b| if before(crossing[b], crossing[a]) { b } else { a });
        let Some(first) = first else { break };
        for k in 0..3 {
            if direction[k] != 0 && !before(crossing[first], crossing[k]) {
                cell[k] += direction[k].signum();
            }
        }
    }
    met
}

/// The textbook's analyser: a constant is added to the parameter of the plane ahead, in `f32`.
fn accumulated(count: i32, ray: &Ray) -> Vec<IVec3> {
    let (origin, direction) = (ray.origin.as_vec3(), ray.direction.as_vec3());
    let mut cell = origin.as_ivec3();
    let step = direction.signum().as_ivec3();
    let ahead = (cell + step.max(IVec3::ZERO)).as_vec3();
    let (mut crossing, delta) = ((ahead - origin) / direction, 1.0 / direction.abs());
    let mut met = Vec::new();
    while cell.cmpge(IVec3::ZERO).all() && cell.cmplt(IVec3::splat(count)).all() {
        met.push(cell);
        let axis = crossing.min_position();
        cell[axis] += step[axis];
        crossing[axis] += delta[axis];
    }
    met
}

/// Inputs are dyadic and small, so that quotients that differ still differ when they are rounded.
#[test]
fn no_cell_is_skipped_among_1024() {
    let mut random = Pcg64::new(21, 1);
    let mut below = move |count: u32| i64::from(random.next_u32() % count);
    let count = 1024;
    let (mut visited, mut skipped, mut naive) = (0, 0, 0);
    for number in 0..3_000 {
        let origin = [0, 1, 2].map(|_| below(1024 * PARTS as u32));
        let mut direction = [0, 1, 2].map(|_| 2 * below(1 << 14) - (1 << 14) + 1);
        if number % 3 == 0 {
            direction[number / 3 % 3] = 0;
        }
        let ray = Ray::new(
            DVec3::from_array(origin.map(|x| x as f64 / PARTS as f64)),
            DVec3::from_array(direction.map(|x| x as f64)),
        );
        let wanted = exact(count, origin, direction);
        let missing = |got: Vec<IVec3>| {
            let got: std::collections::HashSet<IVec3> = got.into_iter().collect();
            wanted.iter().filter(|cell| !got.contains(*cell)).count()
        };
        visited += wanted.len();
        skipped += missing(cells(units(1024, 1024, 1024), &ray));
        if number % 3 != 0 {
            naive += missing(accumulated(1024, &ray));
        }
    }
    assert!(visited > 1_000_000, "{visited}");
    assert_eq!(skipped, 0, "of {visited}");
    assert!(naive > 100, "the accumulated one skips {naive}");
}

/// Three equal parameters at every step.
#[test]
fn a_ray_through_corners_visits_the_diagonal() {
    for (origin, direction) in
        [(DVec3::splat(-1.0), DVec3::ONE), (DVec3::splat(5.0), DVec3::NEG_ONE)]
    {
        let visited = cells(units(4, 4, 4), &Ray::new(origin, direction));
        assert!((0..4).all(|k| visited.contains(&IVec3::splat(k))), "{visited:?}");
        assert!(visited.len() <= 12, "{visited:?}");
    }
}

#[test]
fn on_the_upper_face_a_ray_starts_in_the_last_cell() {
    let lattice = units(4, 1, 3);
    assert_eq!(lattice.cell_of(DVec3::new(4.0, 1.0, 3.0)), IVec3::new(3, 0, 2));
    let inwards = Ray::new(DVec3::new(4.0, 0.5, 2.5), DVec3::NEG_X);
    assert_eq!(cells(lattice, &inwards), [3, 2, 1, 0].map(|x| IVec3::new(x, 0, 2)));
}

#[test]
fn a_ray_in_a_plane_stays_in_its_row() {
    for zero in [0.0, -0.0] {
        let ray = Ray::new(DVec3::new(-1.0, 2.0, 0.5), DVec3::new(0.5, zero, zero));
        let row = [0, 1, 2, 3].map(|x| IVec3::new(x, 2, 0));
        assert_eq!(cells(units(4, 4, 1), &ray), row);
    }
}

#[test]
fn a_lattice_suits_the_shape_of_the_scene() {
    let of = |extent: DVec3, cells: f64| {
        let bounds = Bounds3 { min: DVec3::ZERO, max: extent };
        Lattice::of(bounds, regular_slack(bounds), cells).resolution
    };
    assert_eq!(of(DVec3::ONE, 1000.0), IVec3::new(10, 10, 10));
    assert_eq!(of(DVec3::new(1.0, 0.0, 4.0), 400.0), IVec3::new(10, 1, 40));
    assert_eq!(of(DVec3::new(0.0, 3.0, 0.0), 30.0), IVec3::new(1, 30, 1));
    assert_eq!(of(DVec3::new(0.0, 3e30, 0.0), 1e9), IVec3::new(1, 1024, 1));
    assert_eq!(of(DVec3::splat(1e-30), 8.0), IVec3::splat(2));
    assert_eq!(of(DVec3::ZERO, 8.0), IVec3::ONE);
}
