//! Grid and octree: what breaks subdivisions of space and nothing else.

use chapter_4::naive::first_hit_wins;
use glam::DVec3;
use lancer_accel::{Grid, GridBuilder, Octree, OctreeBuilder};
use lancer_core::generate::{cube, icosphere};
use lancer_core::geometry::{Bounds3, Interval, Ray};
use lancer_core::intersector::{Intersector, LinearScan, Query, TestCounts, Traversal};
use lancer_core::scene::{MaterialId, Mesh, Scene};

use crate::random::Random;

/// Small triangles, evenly spread in a box.
fn soup(count: usize, half: DVec3, size: f64) -> Mesh {
    let mut random = Random::new(31);
    let mut mesh = Mesh::default();
    for _ in 0..count {
        let center = half * random.in_cube(1.0);
        add(&mut mesh, [0; 3].map(|_| center + size * half * random.in_cube(1.0)));
    }
    mesh
}

fn add(mesh: &mut Mesh, corners: [DVec3; 3]) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    mesh.push_face(MaterialId(0), &[[first, first + 1, first + 2]]);
}

fn scaled(mut mesh: Mesh, factor: f64) -> Mesh {
    mesh.positions.iter_mut().for_each(|position| *position *= factor);
    mesh
}

/// A ray towards a vertex of a scene, from around its size away.
fn aimed(scene: &Scene, random: &mut Random) -> Ray {
    let bounds = scene.bounds();
    let size = (bounds.max - bounds.min).max_element();
    let origin = bounds.center() + size * random.in_cube(1.0);
    Ray::new(origin, scene.mesh.positions[random.below(scene.mesh.positions.len())] - origin)
}

fn assert_both_agree(name: &str, scene: &Scene, rays: usize) {
    let (oracle, grid, octree) = (LinearScan::new(scene), Grid::build(scene), Octree::build(scene));
    grid.validate(scene).unwrap_or_else(|error| panic!("{name}: {error}"));
    octree.validate(scene).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut random = Random::new(37);
    for _ in 0..rays {
        let ray = aimed(scene, &mut random);
        let wanted = oracle.closest_hit(&ray, Interval::POSITIVE);
        assert_eq!(grid.closest_hit(&ray, Interval::POSITIVE), wanted, "grid, {name}: {ray:?}");
        assert_eq!(octree.closest_hit(&ray, Interval::POSITIVE), wanted, "octree, {name}: {ray:?}");
    }
}

/// A teapot in a stadium.
fn stadium() -> Scene {
    let mut mesh = icosphere(4);
    let corner = |x: f64, z: f64| DVec3::new(1e6 * x, -1.0, 1e6 * z);
    add(&mut mesh, [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)]);
    add(&mut mesh, [corner(-1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
    Scene::of_mesh(mesh)
}

#[test]
fn hard_scenes_are_valid_and_exact() {
    let mut slanted = Mesh::default();
    (0..200).for_each(|k| {
        let shift = DVec3::splat(f64::from(k) * 1e-3);
        add(&mut slanted, [DVec3::X, DVec3::Y, DVec3::Z].map(|corner| corner + shift));
    });
    for (name, mesh) in [
        ("flat", soup(2_000, DVec3::new(1.0, 0.0, 1.0), 0.02)),
        ("a line", soup(500, DVec3::new(0.0, 1.0, 0.0), 0.02)),
        ("small", scaled(icosphere(2), 1e-30)),
        ("large", scaled(icosphere(2), 1e30)),
        ("on the planes of cells", cube()),
        ("large triangles that overlap", slanted),
        ("soup", soup(2_000, DVec3::ONE, 0.08)),
    ] {
        assert_both_agree(name, &Scene::of_mesh(mesh), 300);
    }
    assert_both_agree("stadium", &stadium(), 300);
}

/// None of them may hang or fill the memory; the rays are few, since each asks the oracle for 10⁵ triangles.
#[test]
fn large_degenerate_scenes_are_built() {
    let mut identical = Mesh { positions: vec![DVec3::X, DVec3::Y, DVec3::Z], ..Mesh::default() };
    let mut points = Mesh { positions: vec![DVec3::ONE], ..Mesh::default() };
    for _ in 0..100_000 {
        identical.push_face(MaterialId(0), &[[0, 1, 2]]);
        points.push_face(MaterialId(0), &[[0, 0, 0]]);
    }
    let mut uneven = soup(100_000, DVec3::ONE, 0.01);
    add(&mut uneven, [-1e6 * DVec3::X, 1e6 * DVec3::Y, 1e6 * DVec3::Z]);
    for (name, mesh) in [("identical", identical), ("points", points), ("uneven", uneven)] {
        let scene = Scene::of_mesh(mesh);
        assert_both_agree(name, &scene, 10);
        let most = 1_000 * scene.mesh.triangles.len();
        assert!(Grid::build(&scene).memory() < most && Octree::build(&scene).memory() < most);
    }
}

#[test]
fn an_octree_keeps_its_depth() {
    let mut mesh = Mesh { positions: vec![DVec3::X, DVec3::Y, DVec3::Z], ..Mesh::default() };
    (0..1_000).for_each(|_| mesh.push_face(MaterialId(0), &[[0, 1, 2]]));
    mesh.append(&icosphere(3), glam::DAffine3::IDENTITY, 0);
    let scene = Scene::of_mesh(mesh);
    let leaves = |max_depth| {
        let builder = OctreeBuilder { leaf_size: 0, max_depth, ..OctreeBuilder::default() };
        let octree = builder.build(&scene);
        octree.validate(&scene).unwrap();
        octree.leaves().count()
    };
    assert_eq!([0, 1].map(leaves), [1, 8]);
    assert!(leaves(3) <= 512);
    assert!(leaves(u32::MAX) > 512);
}

/// The leaves fill the cube: no two overlap, and the volumes add up.
#[test]
fn the_leaves_of_an_octree_fill_its_cube() {
    let scene = Scene::of_mesh(icosphere(3));
    let octree = Octree::build(&scene);
    let volume: f64 =
        octree.leaves().map(|leaf| (leaf.bounds.max - leaf.bounds.min).element_product()).sum();
    let whole = octree.leaves().map(|leaf| leaf.bounds).reduce(Bounds3::union).unwrap();
    let wanted = (whole.max - whole.min).element_product();
    assert!((volume / wanted - 1.0).abs() < 1e-12, "{volume} of {wanted}");
}

/// Each cell of a ray begins where the last one ended, and lies on the ray.
#[test]
fn the_cells_of_a_ray_are_in_order() {
    let scene = Scene::of_mesh(soup(3_000, DVec3::ONE, 0.05));
    let (grid, octree) = (Grid::build(&scene), Octree::build(&scene));
    let mut random = Random::new(41);
    for _ in 0..300 {
        let ray = aimed(&scene, &mut random);
        let cells = [
            grid.cells(&ray, Interval::POSITIVE).collect::<Vec<_>>(),
            octree.cells(&ray, Interval::POSITIVE).collect::<Vec<_>>(),
        ];
        for cells in cells {
            assert!(cells.is_sorted_by(|a, b| a.enter <= b.enter));
            for cell in cells {
                let point = ray.at(cell.enter);
                let beside = (cell.bounds.min - point).max(point - cell.bounds.max).max_element();
                assert!(beside < 1e-12, "{beside}");
            }
        }
    }
}

/// A mailbox spares tests and changes nothing else.
#[test]
fn mailboxes_change_no_bit() {
    let scene = Scene::of_mesh(soup(3_000, DVec3::ONE, 0.2));
    let grids = [true, false]
        .map(|mailboxing| GridBuilder { mailboxing, ..GridBuilder::default() }.build(&scene));
    let octrees = [true, false]
        .map(|mailboxing| OctreeBuilder { mailboxing, ..OctreeBuilder::default() }.build(&scene));
    let mut counts = [TestCounts::default(); 4];
    let mut random = Random::new(43);
    for _ in 0..2_000 {
        let ray = aimed(&scene, &mut random);
        let [a, b, c, d] = &mut counts;
        let hits = [
            grids[0].walk(Query::closest(&ray, Interval::POSITIVE), a),
            grids[1].walk(Query::closest(&ray, Interval::POSITIVE), b),
            octrees[0].walk(Query::closest(&ray, Interval::POSITIVE), c),
            octrees[1].walk(Query::closest(&ray, Interval::POSITIVE), d),
        ];
        assert!(hits.iter().all(|hit| *hit == hits[0]), "{hits:?}");
    }
    let [a, b, c, d] = counts;
    assert!(a.cells == b.cells && 10 * a.primitives < 9 * b.primitives, "{a:?} {b:?}");
    assert!(c.cells == d.cells && 10 * c.primitives < 9 * d.primitives, "{c:?} {d:?}");
}

#[test]
fn the_first_hit_of_a_grid_need_not_be_the_closest() {
    let scene = Scene::of_mesh(soup(3_000, DVec3::ONE, 0.2));
    let (oracle, grid) = (LinearScan::new(&scene), Grid::build(&scene));
    let mut random = Random::new(47);
    let mut wrong = 0;
    for _ in 0..1_000 {
        let ray = aimed(&scene, &mut random);
        let wanted = oracle.closest_hit(&ray, Interval::POSITIVE);
        assert_eq!(grid.closest_hit(&ray, Interval::POSITIVE), wanted);
        wrong += usize::from(first_hit_wins(&scene, &grid, &ray) != wanted);
    }
    assert!(wrong > 20, "{wrong}");
}

/// In the stadium the whole teapot is in a few cells of the grid; the octree finds its scale.
#[test]
fn a_grid_loses_the_teapot_in_the_stadium() {
    let scene = stadium();
    let (grid, octree) = (Grid::build(&scene), Octree::build(&scene));
    let (mut in_grid, mut in_octree) = (TestCounts::default(), TestCounts::default());
    let mut random = Random::new(53);
    for _ in 0..100 {
        let origin = 3.0 * random.direction();
        let ray = Ray::new(origin, random.in_cube(0.5) - origin);
        let hit = grid.walk(Query::closest(&ray, Interval::POSITIVE), &mut in_grid);
        assert_eq!(octree.walk(Query::closest(&ray, Interval::POSITIVE), &mut in_octree), hit);
    }
    assert!(in_grid.primitives > 100 * 1_000, "{in_grid:?}");
    assert!(in_octree.primitives < 100 * 100, "{in_octree:?}");
}
