//! A ray that leaves a surface does not meet it again where it starts, at any scale and place, and does
//! not jump over a neighbour either.

use glam::DVec3;
use lancer_core::generate::icosphere;
use lancer_core::geometry::{Interval, Ray, Sphere};
use lancer_core::intersector::{Intersector, LinearScan};
use lancer_core::scene::{MaterialId, Mesh, Scene, SphereObject};
use lancer_lesson::naive::moeller_trumbore;

use crate::random::Random;

fn one_triangle(corners: [DVec3; 3]) -> Scene {
    let mut mesh = Mesh { positions: corners.to_vec(), ..Mesh::default() };
    mesh.push_face(MaterialId(0), &[[0, 1, 2]]);
    Scene::of_mesh(mesh)
}

/// A coordinate of either sign whose size is uniform over 16 decades.
fn sixteen_decades(random: &mut Random) -> f64 {
    let size = 10.0_f64.powf(random.between(-8.0, 8.0));
    if random.unit() < 0.5 { -size } else { size }
}

/// pbrt's recipe: a triangle with corners of all sizes, a hit on it, rays out of that hit.
fn self_hits(
    triangles: u64,
    rays: usize,
    leave: impl Fn(&Scene, Ray, DVec3) -> Option<Ray>,
) -> usize {
    let mut random = Random::new(29);
    let mut count = 0;
    for _ in 0..triangles {
        let mut corner = || {
            DVec3::new(
                sixteen_decades(&mut random),
                sixteen_decades(&mut random),
                sixteen_decades(&mut random),
            )
        };
        let corners = [corner(), corner(), corner()];
        let scene = one_triangle(corners);
        let oracle = LinearScan::new(&scene);
        let weights = random.weights();
        let target = weights.x * corners[0] + weights.y * corners[1] + weights.z * corners[2];
        let origin = 1e3 * DVec3::splat(target.length()) * random.direction();
        let ray = Ray::new(origin, target - origin);
        for _ in 0..rays {
            let Some(out) = leave(&scene, ray, random.direction()) else { continue };
            count += usize::from(oracle.closest_hit(&out, Interval::POSITIVE).is_some());
        }
    }
    count
}

#[test]
fn no_self_hit_on_triangles_of_sixteen_decades() {
    let mut left = 0;
    let ours = {
        let left = std::cell::Cell::new(0);
        let count = self_hits(1000, 1000, |scene, ray, direction| {
            let hit = LinearScan::new(scene).closest_hit(&ray, Interval::POSITIVE)?;
            left.set(left.get() + 1);
            Some(scene.surface_at(&ray, &hit).spawn(direction))
        });
        (count, left.get())
    };
    left += ours.1;
    assert!(left > 500_000, "only {left} rays left a triangle");
    assert_eq!(ours.0, 0, "self-hits in {left} rays");
}

/// Without the offset and the error bound nearly half of all rays meet the triangle they leave.
#[test]
fn a_plain_hit_point_does_hit_itself() {
    let hits = std::cell::Cell::new(0);
    self_hits(200, 100, |scene, ray, direction| {
        let hit = LinearScan::new(scene).closest_hit(&ray, Interval::POSITIVE)?;
        let out = Ray::new(scene.surface_at(&ray, &hit).position, direction);
        hits.set(hits.get() + u32::from(moeller_trumbore(scene.mesh.corners(0), &out).is_some()));
        None
    });
    assert!(hits.get() > 1000, "only {} self-hits in 20 000", hits.get());
}

#[test]
fn no_self_hit_on_spheres() {
    let mut random = Random::new(31);
    let mut left = 0;
    for _ in 0..1000 {
        let radius = 10.0_f64.powf(random.between(-6.0, 6.0));
        let center = 10.0_f64.powf(random.between(-6.0, 6.0)) * random.direction();
        let mut scene = Scene::of_mesh(Mesh::default());
        let shape = Sphere { center, radius };
        scene.spheres.push(SphereObject { shape, material: MaterialId(0) });
        let oracle = LinearScan::new(&scene);
        let origin = center + 3.0 * radius * random.direction();
        let ray = Ray::new(origin, center + 0.9 * radius * random.direction() - origin);
        let Some(hit) = oracle.closest_hit(&ray, Interval::POSITIVE) else { continue };
        let surface = scene.surface_at(&ray, &hit);
        let n = surface.geometric_normal;
        for k in 0..1000 {
            // Half of them graze: those start nearest to where they came from.
            let mut direction = random.direction();
            direction *= direction.dot(n).signum();
            if k % 2 == 0 {
                let sine = 10.0_f64.powf(random.between(-12.0, -1.0));
                direction = (direction.cross(n).normalize() + sine * n).normalize();
            }
            left += 1;
            let out = surface.spawn(direction);
            assert_eq!(
                oracle.closest_hit(&out, Interval::POSITIVE),
                None,
                "outwards, {center} {radius}"
            );
            // Inwards the ray must cross the sphere and meet the other side.
            let inwards = surface.spawn(-n);
            let across = oracle.closest_hit(&inwards, Interval::POSITIVE).map(|hit| hit.t / radius);
            // A small sphere far from the origin is only as round as its coordinates resolve.
            let resolved = 64.0 * f64::EPSILON * (center.length() + radius) / radius;
            assert!(
                across.is_some_and(|t| (t - 2.0).abs() < resolved),
                "{across:?}, {center} {radius}"
            );
        }
    }
    assert!(left > 500_000);
}

/// A plane of 512 triangles, tilted so that nothing is axis-aligned.
fn tilted_plane(offset: DVec3) -> Scene {
    let (x, y) = (DVec3::new(1.0, 0.3, 0.2), DVec3::new(-0.1, 0.2, 1.0));
    let mut mesh = Mesh::default();
    for row in 0..17 {
        for column in 0..17 {
            let at = f64::from(column) / 16.0 * x + f64::from(row) / 16.0 * y;
            mesh.positions.push(offset + at);
        }
    }
    for row in 0..16 {
        for column in 0..16 {
            let a = 17 * row + column;
            mesh.push_face(MaterialId(0), &[[a, a + 1, a + 18]]);
            mesh.push_face(MaterialId(0), &[[a, a + 18, a + 17]]);
        }
    }
    Scene::of_mesh(mesh)
}

/// Counts the rays leaving the plane upwards that `meets` something again.
fn plane_hits(distance: f64, meets: impl Fn(&Scene, &Ray, DVec3) -> bool) -> usize {
    let scene = tilted_plane(DVec3::splat(distance));
    let n = (scene.mesh.positions[1] - scene.mesh.positions[0])
        .cross(scene.mesh.positions[17] - scene.mesh.positions[0])
        .normalize();
    let mut random = Random::new(37);
    let mut count = 0;
    for _ in 0..4_000 {
        let [a, b, c] = scene.mesh.corners(random.below(512));
        // Half of the points lie on a shared edge.
        let w = if random.unit() < 0.5 { random.weights() } else { DVec3::new(0.25, 0.75, 0.0) };
        let target = w.x * a + w.y * b + w.z * c;
        let origin = target + random.direction() * 2.0;
        let ray = Ray::new(origin, target - origin);
        let mut up = random.direction();
        up *= up.dot(n).signum();
        // Upwards by more than the plane's own rounding.
        if up.dot(n) > 1e-3 {
            count += usize::from(meets(&scene, &ray, up));
        }
    }
    count
}

#[test]
fn no_ray_that_leaves_a_tessellated_plane_meets_it_again() {
    for distance in [0.0, 100.0, 1e4, 1e6] {
        let ours = plane_hits(distance, |scene, ray, up| {
            let oracle = LinearScan::new(scene);
            // An edge of the border may be missed: there is no neighbour.
            oracle.closest_hit(ray, Interval::POSITIVE).is_some_and(|hit| {
                let out = scene.surface_at(ray, &hit).spawn(up);
                oracle.closest_hit(&out, Interval::POSITIVE).is_some()
            })
        });
        assert_eq!(ours, 0, "at {distance}");
    }
    let skip_own = plane_hits(1e4, |scene, ray, up| {
        LinearScan::new(scene).closest_hit(ray, Interval::POSITIVE).is_some_and(|hit| {
            let out = Ray::new(scene.surface_at(ray, &hit).position, up);
            let mut others = (0..512).filter(|&index| index != hit.primitive.0 as usize);
            others.any(|index| moeller_trumbore(scene.mesh.corners(index), &out).is_some())
        })
    });
    assert!(skip_own > 100, "skipping the own primitive leaves only {skip_own} self-hits in 4 000");
}

#[test]
fn nothing_passes_between_plates_a_millionth_of_their_distance_apart() {
    for distance in [0.0, 1.0, 1e3] {
        let gap = 1e-6 * (1.0 + distance);
        let offset = DVec3::splat(distance);
        let v = |x, y, z| offset + DVec3::new(x, y, z);
        let mut mesh = Mesh::default();
        for height in [0.0, gap] {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend([
                v(-9.0, height, -9.0),
                v(-9.0, height, 9.0),
                v(9.0, height, 9.0),
                v(9.0, height, -9.0),
            ]);
            mesh.push_face(
                MaterialId(0),
                &[[first, first + 1, first + 2], [first, first + 2, first + 3]],
            );
        }
        let scene = Scene::of_mesh(mesh);
        let oracle = LinearScan::new(&scene);
        let mut random = Random::new(41);
        let mut tunnelled = 0;
        for _ in 0..100_000 {
            // From below onto the lower plate, then on from its upper side.
            let start =
                offset + DVec3::new(random.between(-1.0, 1.0), -1.0, random.between(-1.0, 1.0));
            let up = DVec3::new(random.between(-1.0, 1.0), 1.0, random.between(-1.0, 1.0));
            let ray = Ray::new(start, up);
            let hit = oracle.closest_hit(&ray, Interval::POSITIVE).unwrap();
            assert!(hit.primitive.0 < 2, "the lower plate is met first");
            let next = scene.surface_at(&ray, &hit).spawn(up.normalize());
            let second = oracle.closest_hit(&next, Interval::POSITIVE);
            assert!(second.is_some_and(|hit| hit.primitive.0 >= 2), "gap {gap:e}: {next:?}");
            let epsilon = Ray::new(ray.at(hit.t) + 1e-4 * DVec3::Y, up);
            tunnelled += usize::from(oracle.closest_hit(&epsilon, Interval::POSITIVE).is_none());
        }
        assert!(
            gap > 1e-4 || tunnelled == 100_000,
            "an epsilon of 1e-4 jumps over the second plate"
        );
    }
}

#[test]
fn nothing_passes_between_spheres_a_millionth_apart() {
    let mut scene = Scene::of_mesh(Mesh::default());
    for radius in [1.0, 1.0 + 1e-6] {
        let shape = Sphere { center: DVec3::new(3.0, 4.0, 5.0), radius };
        scene.spheres.push(SphereObject { shape, material: MaterialId(0) });
    }
    let oracle = LinearScan::new(&scene);
    let mut random = Random::new(43);
    for _ in 0..100_000 {
        let origin = scene.spheres[0].shape.center + random.in_cube(0.5);
        let direction = random.direction();
        let ray = Ray::new(origin, direction);
        let hit = oracle.closest_hit(&ray, Interval::POSITIVE).unwrap();
        assert_eq!(hit.primitive.0, 0);
        let next = scene.surface_at(&ray, &hit).spawn(direction);
        assert_eq!(oracle.closest_hit(&next, Interval::POSITIVE).unwrap().primitive.0, 1);
    }
}

/// Watertight from close by as well: the error bound that drops self-hits must not drop true ones.
#[test]
fn no_leak_from_origins_close_to_a_surface() {
    let scene = Scene::of_mesh(icosphere(3));
    let oracle = LinearScan::new(&scene);
    let mut random = Random::new(47);
    for _ in 0..10_000 {
        let [a, b, _] = scene.mesh.corners(random.below(scene.mesh.triangles.len()));
        let edge = if random.unit() < 0.5 { a } else { a + random.unit() * (b - a) };
        let off = 10.0_f64.powf(random.between(-6.0, -1.0));
        let origin = edge * (1.0 - off);
        assert!(
            oracle.closest_hit(&Ray::new(origin, edge - origin), Interval::POSITIVE).is_some(),
            "{off:e} from the surface"
        );
    }
}
