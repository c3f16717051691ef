use lancer_core::generate::icosphere;
use lancer_core::intersector::{Intersector, LinearScan};

use super::*;
use crate::spatial::hard;

fn leaves(tree: &BspTree) -> usize {
    tree.number(tree.nodes.len())
}

#[test]
fn trees_over_hard_scenes_are_valid() {
    for (name, scene) in hard::scenes() {
        let tree = BspTree::build(&scene);
        tree.validate(&scene).unwrap_or_else(|error| panic!("{name}: {error}"));
        let limit = REFERENCES_PER_PRIMITIVE * scene.primitives().len();
        assert!(tree.primitives.len() <= limit, "{name}: {}", tree.primitives.len());
    }
}

#[test]
fn scale_and_place_do_not_change_the_answer() {
    let mut point = hard::points(43);
    for (name, scene) in hard::scenes() {
        if scene.primitives().len() > 2000 {
            continue;
        }
        let (tree, oracle) = (BspTree::build(&scene), LinearScan::new(&scene));
        let bounds = scene.bounds();
        let (center, size) = (bounds.center(), (bounds.max - bounds.min).max_element());
        for _ in 0..500 {
            let ray = Ray::new(center + size * 1.5 * point(), point());
            let wanted = oracle.closest_hit(&ray, Interval::POSITIVE);
            assert_eq!(tree.closest_hit(&ray, Interval::POSITIVE), wanted, "{name}: {ray:?}");
        }
    }
}

/// All of a convex object is behind each of its faces: their planes part nothing.
#[test]
fn a_convex_object_needs_planes_on_edges() {
    let scene = Scene::of_mesh(icosphere(3));
    let faces = BspBuilder { planes: Planes::Faces }.build(&scene);
    assert_eq!(leaves(&faces), 1);
    faces.validate(&scene).unwrap();
    assert!(leaves(&BspTree::build(&scene)) > 300);
}

/// Walls in each other's planes are stored once, at the plane, and rays in the plane find them.
#[test]
fn what_lies_in_a_plane_stays_there() {
    let mut mesh = hard::soup(400, 0.05);
    for (k, p) in mesh.positions.iter_mut().enumerate() {
        p.z = [0.5, -0.5][k / 3 % 2];
    }
    let scene = Scene::of_mesh(mesh);
    let (tree, oracle) = (BspTree::build(&scene), LinearScan::new(&scene));
    tree.validate(&scene).unwrap();
    let within = |node: &Node| matches!(node, Node::Inner { count, .. } if *count > 100);
    assert!(tree.nodes.iter().any(within));
    let mut point = hard::points(47);
    for _ in 0..500 {
        let (mut origin, mut direction) = (point(), point());
        origin.z = 0.5;
        direction.z *= 1e-15;
        let ray = Ray::new(origin, direction);
        let wanted = oracle.closest_hit(&ray, Interval::POSITIVE);
        assert_eq!(tree.closest_hit(&ray, Interval::POSITIVE), wanted, "{ray:?}");
    }
}

#[test]
fn the_cell_of_the_origin_is_visited_first() {
    let scene = Scene::of_mesh(icosphere(4));
    let tree = BspTree::build(&scene);
    let mut point = hard::points(53);
    for _ in 0..200 {
        let ray = Ray::new(0.5 * point(), point());
        let visited = tree.visited_leaves(&ray, Interval::POSITIVE);
        assert_eq!(visited[0], tree.leaf_at(ray.origin).0, "{ray:?}");
        let hit = tree.closest_hit(&ray, Interval::POSITIVE).expect("inside a sphere");
        let unique: std::collections::HashSet<_> = visited.iter().collect();
        assert_eq!(unique.len(), visited.len(), "no cell twice");
        assert!(visited.contains(&tree.leaf_at(ray.at(hit.t)).0));
    }
}

#[test]
fn any_number_of_threads_builds_the_same_tree() {
    let scene = Scene::of_mesh(icosphere(5));
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| BspTree::build(&scene))
    });
    assert_eq!(one.primitives, three.primitives);
    assert_eq!(one.nodes.len(), three.nodes.len());
}
