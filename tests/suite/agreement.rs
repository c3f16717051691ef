//! Every index returns the hit of brute force, the same t bit for bit and the same primitive, for rays
//! aimed where indexes go wrong.

use chapter_4::aimed::{CLASSES, aimed};
use chapter_4::scenes::BUILDINGS;
use glam::DVec3;
use lancer_accel::structures::STRUCTURES;
use lancer_accel::{BinaryTree, Bvh, ObvhsBvh2, Split, Wide};
use lancer_core::generate::{cube, icosphere};
use lancer_core::geometry::{Interval, Ray, Sphere};
use lancer_core::intersector::{Intersector, LinearScan, Query, TestCounts, Traversal};
use lancer_core::scene::{MaterialId, Mesh, Scene, SphereObject};

use crate::meshes::{OFFSETS, moved};
use crate::random::Random;

/// Every index of chapter 4 but the oracle, and the variants of hierarchies.
fn indexes(scene: &Scene) -> Vec<(&'static str, Box<dyn Intersector + '_>)> {
    let listed = STRUCTURES.into_iter().filter(|structure| structure.name != "linear");
    let mut indexes: Vec<(_, Box<dyn Intersector>)> = Vec::new();
    for structure in listed {
        indexes.push((structure.name, structure.build(scene).index));
    }
    indexes.push(("wide, scalar", Box::new(Wide::scalar(scene))));
    indexes.push(("bvh, median", Box::new(Bvh::with_split(scene, Split::Median))));
    indexes.push(("bvh, recursive", Box::new(BinaryTree::build(scene, Split::Sah))));
    indexes
}

fn assert_agreement(scene: &Scene, offset: DVec3, rays: usize) {
    for (name, index) in indexes(scene) {
        assert_index_agrees(name, &*index, scene, offset, rays);
    }
}

fn assert_index_agrees(
    name: &str,
    index: &dyn Intersector,
    scene: &Scene,
    offset: DVec3,
    rays: usize,
) {
    let oracle = LinearScan::new(scene);
    for class in CLASSES {
        let mut random = Random::new(11);
        let mut hits = 0;
        for _ in 0..rays {
            let ray = aimed(class, &scene.mesh, offset, &mut || random.unit());
            let wanted = oracle.closest_hit(&ray, Interval::POSITIVE);
            let got = index.closest_hit(&ray, Interval::POSITIVE);
            let key = |hit: Option<lancer_core::intersector::Hit>| {
                hit.map(|hit| (hit.t.to_bits(), hit.primitive))
            };
            assert_eq!(key(got), key(wanted), "{name}: {class} at {offset}: {ray:?}");
            let Some(hit) = wanted else { continue };
            hits += 1;
            // An interval that ends around the hit: occlusion and closest hit must agree with it.
            for max in [hit.t, hit.t.next_up(), 0.5 * hit.t, 2.0 * hit.t] {
                let range = Interval::up_to(max);
                let wanted = oracle.closest_hit(&ray, range).is_some();
                assert_eq!(
                    index.occluded(&ray, range),
                    wanted,
                    "{name}: {class} to {max}: {ray:?}"
                );
                assert_eq!(wanted, max > hit.t);
            }
        }
        assert!(hits * 10 > rays, "{class} at {offset}: {hits} hits test too little");
    }
}

#[test]
fn on_an_icosphere_at_three_offsets() {
    for offset in OFFSETS {
        assert_agreement(&Scene::of_mesh(moved(&icosphere(2), offset)), offset, 4_000);
    }
}

/// Sixty-four touching cubes: every inner face is there twice, so ties decide.
#[test]
fn on_doubled_faces() {
    let mut mesh = Mesh::default();
    for k in 0..64 {
        let cell = DVec3::new(f64::from(k % 4), f64::from(k / 4 % 4), f64::from(k / 16)) - 1.5;
        mesh.append(&moved(&cube(), 2.0 * cell), glam::DAffine3::from_scale(DVec3::splat(0.25)), 0);
    }
    assert_agreement(&Scene::of_mesh(mesh), DVec3::ZERO, 2_000);
}

#[test]
fn on_spheres_among_triangles() {
    let mut random = Random::new(17);
    let mut scene = Scene::of_mesh(icosphere(1));
    scene.spheres = (0..300)
        .map(|_| SphereObject {
            shape: Sphere { center: random.in_cube(1.5), radius: random.between(0.01, 0.3) },
            material: MaterialId(0),
        })
        .collect();
    // The last two coincide: the smaller id must win.
    let last = *scene.spheres.last().unwrap();
    scene.spheres.push(last);
    assert_agreement(&scene, DVec3::ZERO, 4_000);

    // Along the silhouettes, where rounding decides between a hit and a miss.
    let oracle = LinearScan::new(&scene);
    let indexes = indexes(&scene);
    let mut hits = 0;
    for _ in 0..20_000 {
        let sphere = scene.spheres[random.below(scene.spheres.len())].shape;
        let origin = 10.0_f64.powf(random.between(0.5, 3.0)) * random.direction();
        let to_center = sphere.center - origin;
        let aside = to_center.any_orthogonal_vector().normalize();
        let sine = sphere.radius / to_center.length();
        let off = 1.0 + random.between(-4.0, 4.0) * f64::EPSILON;
        let rim = sphere.center + aside * (sphere.radius * off / (1.0 - sine * sine).sqrt());
        let ray = Ray::new(origin, rim - origin);
        let wanted = oracle.closest_hit(&ray, Interval::POSITIVE);
        for (name, index) in &indexes {
            assert_eq!(index.closest_hit(&ray, Interval::POSITIVE), wanted, "{name}: {ray:?}");
        }
        hits += usize::from(wanted.is_some());
    }
    assert!(hits > 5_000, "{hits}");
}

#[test]
#[ignore = "soak: 10^5 rays per class; cargo test --release -p lancer-tests -- --ignored"]
fn soak_on_an_icosphere() {
    for offset in OFFSETS {
        assert_agreement(&Scene::of_mesh(moved(&icosphere(3), offset)), offset, 100_000);
    }
}

/// A ray that a triangle's plane nearly contains: where it meets the triangle, `f64` can hardly tell.
fn edge_on(mesh: &Mesh, random: &mut Random) -> Ray {
    let [a, b, c] = mesh.corners(random.below(mesh.triangles.len()));
    let (u, v) = (random.unit(), random.unit());
    let point = a + u * (b - a) + v * (1.0 - u) * (c - a);
    let along = random.between(-1.0, 1.0) * (b - a) + random.between(-1.0, 1.0) * (c - a);
    let along = along.normalize_or(DVec3::X) * random.between(0.01, 2.0);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let mut tilted = || normal * 10.0_f64.powf(random.between(-17.0, -5.0));
    Ray::new(point - along + tilted(), along + tilted())
}

/// Buildings in whose trees primitives are split, so that a box holds a part of what may be hit elsewhere. `rays` of
/// each class are answered as by `oracle`, and where that differs by brute force.
fn assert_split_trees_agree(triangles: u32, rays: usize, offsets: &[DVec3]) {
    for building in BUILDINGS {
        for &offset in offsets {
            let mut mesh = building.scene(triangles).mesh;
            let bounds = Scene::of_mesh(mesh.clone()).bounds();
            let size = (bounds.max - bounds.min).max_element();
            for position in &mut mesh.positions {
                *position = offset + (*position - bounds.center()) * (2.0 / size);
            }
            let scene = Scene::of_mesh(mesh);
            let (whole, split) = (Wide::fast(&scene), Wide::build(&scene));
            assert!(split.memory() > whole.memory(), "nothing is split in {}", building.name);
            let (oracle, linear) = (Bvh::build(&scene), LinearScan::new(&scene));
            let scalar = Wide::scalar(&scene);
            for class in CLASSES.into_iter().chain(["edge-on"]) {
                let mut random = Random::new(19);
                let mut hits = 0;
                for _ in 0..rays {
                    let ray = if class == "edge-on" {
                        edge_on(&scene.mesh, &mut random)
                    } else {
                        aimed(class, &scene.mesh, offset, &mut || random.unit())
                    };
                    let mut wanted = oracle.closest_hit(&ray, Interval::POSITIVE);
                    for wide in [&split, &scalar, &whole] {
                        let got = wide.closest_hit(&ray, Interval::POSITIVE);
                        if got != wanted {
                            wanted = linear.closest_hit(&ray, Interval::POSITIVE);
                        }
                        assert_eq!(got, wanted, "{}, {class} at {offset}: {ray:?}", building.name);
                        let Some(hit) = wanted else { continue };
                        assert!(wide.occluded(&ray, Interval::up_to(hit.t.next_up())), "{ray:?}");
                        assert!(!wide.occluded(&ray, Interval::up_to(hit.t)), "{ray:?}");
                    }
                    hits += usize::from(wanted.is_some());
                }
                assert!(
                    hits * 20 > rays,
                    "{}, {class}: {hits} hits test too little",
                    building.name
                );
            }
        }
    }
}

#[test]
fn on_buildings_of_split_primitives() {
    assert_split_trees_agree(20_000, 2_000, &OFFSETS[..1]);
}

#[test]
#[ignore = "soak: 3 · 10^5 rays per class; cargo test --release -p lancer-tests -- --ignored"]
fn soak_on_buildings() {
    assert_split_trees_agree(50_000, 300_000, &OFFSETS);
}

/// Sets on which builders recurse for ever or divide by zero.
#[test]
fn on_degenerate_sets() {
    let triangle = |a: DVec3, b: DVec3, c: DVec3| {
        let mut mesh = Mesh { positions: vec![a, b, c], ..Mesh::default() };
        mesh.push_face(MaterialId(0), &[[0, 1, 2]]);
        mesh
    };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let mut identical = triangle(x, y, z);
    for _ in 0..9_999 {
        identical.push_face(MaterialId(0), &[[0, 1, 2]]);
    }
    let mut points = triangle(x, x, x);
    for _ in 0..999 {
        points.push_face(MaterialId(0), &[[0, 0, 0]]);
    }
    let mut uneven = triangle(-1e6 * x, 1e6 * y, 1e6 * x);
    for k in 0..5_000 {
        let corner = DVec3::new(f64::from(k % 71), 0.5 * f64::from(k / 71), 0.0);
        let first = uneven.positions.len() as u32;
        uneven.positions.extend([corner, corner + 1e-3 * x, corner + 1e-3 * y]);
        uneven.push_face(MaterialId(0), &[[first, first + 1, first + 2]]);
    }
    for mesh in [Mesh::default(), triangle(x, y, z), identical, points, uneven] {
        let scene = Scene::of_mesh(mesh);
        let oracle = LinearScan::new(&scene);
        let indexes = indexes(&scene);
        let mut random = Random::new(23);
        for _ in 0..200 {
            let origin = random.in_cube(3.0);
            let target = match scene.mesh.positions.len() {
                0 => random.in_cube(1.0),
                count => scene.mesh.positions[random.below(count)],
            };
            let ray = Ray::new(origin, target + 1e-4 * random.in_cube(1.0) - origin);
            let wanted = oracle.closest_hit(&ray, Interval::POSITIVE);
            for (name, index) in &indexes {
                assert_eq!(index.closest_hit(&ray, Interval::POSITIVE), wanted, "{name}: {ray:?}");
            }
        }
    }
}

/// Rays of which `f64`, and more so `f32`, can hardly say where they go: from so far away, or of such a direction,
/// that something under- or overflows. (In a scene some 1e-107 large the products of the triangle test itself
/// are denormal, and hits lie beside their triangles: no index promises to find those.)
#[test]
fn extreme_rays_get_the_answer_of_brute_force() {
    let extreme = [5e-324, 1e-310, 1e-300, 1e-40, 1e20, 1e34, 1e60, 1e150, 1e160, 1e300];
    let directions =
        [DVec3::X, DVec3::new(1.0, 0.5, -0.3), DVec3::new(1.0, -0.0, 1e-30), DVec3::NEG_Z];
    for scale in [1.0, 1e12, 1e-30, 1e-100, 1e-310, 1e154] {
        let mut mesh = icosphere(1);
        for position in &mut mesh.positions {
            *position *= scale;
        }
        let scene = Scene::of_mesh(mesh);
        let oracle = LinearScan::new(&scene);
        let inside = scale * DVec3::new(0.05, 0.11, 0.17);
        let mut rays = Vec::new();
        for direction in directions {
            for size in extreme {
                rays.push(Ray::new(inside, size * direction));
                rays.push(Ray::new(inside - size * direction, direction));
                rays.push(Ray::new(inside - size * scale * direction, size * direction));
            }
        }
        let wanted: Vec<_> =
            rays.iter().map(|ray| oracle.closest_hit(ray, Interval::POSITIVE)).collect();
        for (name, index) in indexes(&scene) {
            for (ray, wanted) in rays.iter().zip(&wanted) {
                let got = index.closest_hit(ray, Interval::POSITIVE);
                assert_eq!(got, *wanted, "{name}: {scale} {ray:?}");
                let occluded = index.occluded(ray, Interval::POSITIVE);
                assert_eq!(occluded, wanted.is_some(), "{name}: {scale} {ray:?}");
            }
            let mut got = vec![None; rays.len()];
            index.closest_hits(&rays, Interval::POSITIVE, &mut got);
            assert_eq!(got, wanted, "{name}: {scale}, together");
        }
    }
}

/// Among the rays of a packet some are no rays: the others get their answers, and so do later packets.
#[test]
fn rays_beside_invalid_ones_are_answered() {
    let scene = Scene::of_mesh(icosphere(2));
    let oracle = LinearScan::new(&scene);
    let origin = DVec3::new(0.01, 0.02, -3.0);
    let direction = |k: usize| {
        DVec3::new(0.02 * ((k % 8) as f64 - 3.5), 0.02 * ((k / 8 % 8) as f64 - 3.5), 1.0)
    };
    let bad = [0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    for (value, place) in bad.into_iter().flat_map(|value| [(value, 0), (value, 63), (value, 120)])
    {
        for axes in [&[0][..], &[1], &[2], &[0, 1, 2]] {
            // The last packet is smaller than those before it.
            let mut rays: Vec<Ray> =
                (0..5 * 64 - 8).map(|k| Ray::new(origin, direction(k))).collect();
            for &axis in axes {
                rays[place].direction[axis] = value;
            }
            let wanted: Vec<_> =
                rays.iter().map(|ray| oracle.closest_hit(ray, Interval::POSITIVE)).collect();
            assert!(wanted.iter().flatten().count() > 300);
            for (name, index) in indexes(&scene) {
                let mut got = vec![None; rays.len()];
                index.closest_hits(&rays, Interval::POSITIVE, &mut got);
                assert_eq!(got, wanted, "{name}: {value} at {place}, {axes:?}");
            }
        }
    }
}

/// A ray that is no ray meets nothing, and nothing panics.
#[test]
fn invalid_rays_meet_nothing() {
    let scene = Scene::of_mesh(icosphere(2));
    let oracle = LinearScan::new(&scene);
    let indexes = indexes(&scene);
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    let mut rays = vec![Ray::new(DVec3::ZERO, DVec3::ZERO), Ray::new(DVec3::ZERO, -DVec3::ZERO)];
    for value in bad {
        for axis in 0..3 {
            let (mut origin, mut direction) = (DVec3::splat(0.1), DVec3::X);
            origin[axis] = value;
            rays.push(Ray::new(origin, DVec3::X));
            direction[axis] = value;
            rays.push(Ray::new(DVec3::splat(0.1), direction));
            for other in bad {
                let mut both = direction;
                both[(axis + 1) % 3] = other;
                rays.push(Ray::new(DVec3::splat(0.1), both));
                rays.push(Ray::new(DVec3::splat(0.1), DVec3::new(value, other, value)));
            }
        }
    }
    for ray in rays {
        assert_eq!(oracle.closest_hit(&ray, Interval::POSITIVE), None, "{ray:?}");
        for (name, index) in &indexes {
            assert_eq!(index.closest_hit(&ray, Interval::POSITIVE), None, "{name}: {ray:?}");
            assert!(!index.occluded(&ray, Interval::POSITIVE), "{name}: {ray:?}");
        }
    }
}

/// The tree spares almost all primitive tests, and never makes one that brute force would not.
#[test]
fn the_tree_tests_few_primitives() {
    let scene = Scene::of_mesh(icosphere(4));
    let (oracle, index) = (LinearScan::new(&scene), ObvhsBvh2::build(&scene));
    let (mut all, mut few) = (TestCounts::default(), TestCounts::default());
    let mut random = Random::new(29);
    for _ in 0..500 {
        let ray = aimed("at an edge", &scene.mesh, DVec3::ZERO, &mut || random.unit());
        let before = few;
        let wanted = oracle.walk(Query::closest(&ray, Interval::POSITIVE), &mut all);
        assert_eq!(index.walk(Query::closest(&ray, Interval::POSITIVE), &mut few), wanted);
        assert!(few.primitives > before.primitives && few.boxes > before.boxes, "a hit was tested");
    }
    assert_eq!((all.primitives, all.boxes), (500 * 5120, 0));
    assert!(few.primitives < all.primitives / 200, "{few:?}");
}
