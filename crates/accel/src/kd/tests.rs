use lancer_core::generate::icosphere;
use lancer_core::intersector::{Intersector, LinearScan, TestCounts};

use super::*;
use crate::spatial::hard;

/// Rays between random points, and some in axis planes.
fn rays(count: usize) -> impl Iterator<Item = Ray> {
    let mut point = hard::points(41);
    (0..count).map(move |k| {
        let (origin, mut direction) = (1.5 * point(), point());
        if k % 3 == 0 {
            direction[k % 9 / 3] = 0.0;
        }
        Ray::new(origin, direction)
    })
}

#[test]
fn trees_over_hard_scenes_are_valid() {
    for (name, scene) in hard::scenes() {
        let tree = KdTree::build(&scene);
        tree.validate(&scene).unwrap_or_else(|error| panic!("{name}: {error}"));
        let limit = REFERENCES_PER_PRIMITIVE * scene.primitives().len();
        assert!(tree.primitives.len() <= limit, "{name}: {}", tree.primitives.len());
    }
}

#[test]
fn the_cell_of_a_leaf_is_found_from_the_root() {
    let scene = Scene::of_mesh(icosphere(3));
    let tree = KdTree::build(&scene);
    let is_leaf = |&node: &usize| matches!(tree.nodes[node], Node::Leaf { .. });
    let cells: Vec<Bounds3> =
        (0..tree.nodes.len()).filter(is_leaf).map(|node| tree.cell(node)).collect();
    let leaves: Vec<Bounds3> = tree.leaves().map(|leaf| leaf.bounds).collect();
    assert!(leaves.len() > 100);
    assert_eq!(cells, leaves);
}

#[test]
fn scale_and_place_do_not_change_the_answer() {
    for (name, scene) in hard::scenes() {
        if scene.primitives().len() > 2000 {
            continue;
        }
        let (tree, oracle) = (KdTree::build(&scene), LinearScan::new(&scene));
        let bounds = scene.bounds();
        let (center, size) = (bounds.center(), (bounds.max - bounds.min).max_element());
        for ray in rays(500) {
            let ray = Ray::new(center + size * ray.origin, ray.direction);
            let wanted = oracle.closest_hit(&ray, Interval::POSITIVE);
            assert_eq!(tree.closest_hit(&ray, Interval::POSITIVE), wanted, "{name}: {ray:?}");
        }
    }
}

/// (split − o) / d is 0 / 0 in the plane and comes out on the wrong side of rounding next to it.
#[test]
fn a_ray_in_the_plane_visits_both_sides() {
    for direction in [0.0, -0.0] {
        for (origin, sides) in [(1.0, "both"), (0.9, "near"), (1.1, "far")] {
            let axis = Thick::new(origin, direction, 1e-13);
            let [reached, left] = axis.cross(1.0);
            let ahead = if axis.negative { "far" } else { "near" };
            match sides {
                "both" => assert_eq!([reached, left], [f64::NEG_INFINITY, f64::INFINITY]),
                side if side == ahead => assert_eq!(reached, f64::INFINITY),
                _ => assert_eq!(left, f64::NEG_INFINITY),
            }
        }
        // Without thickness: 0 / 0, before and after nothing, so both sides.
        assert!(Thick::new(1.0, direction, 0.0).cross(1.0).iter().all(|t| t.is_nan()));
    }
    assert!(Thick::new(0.0, f64::MIN_POSITIVE / 4.0, 0.0).cross(1e-20)[0].is_nan());
}

/// The textbook's mistake: the first cell whose primitives are met ends the walk, though they
/// may be met in a later cell, behind others.
#[test]
fn the_first_hit_found_is_not_the_closest() {
    let scene = Scene::of_mesh(hard::soup(300, 1.0));
    let tree = KdTree::build(&scene);
    let mut wrong = 0;
    for ray in rays(5000) {
        let wanted = tree.closest_hit(&ray, Interval::POSITIVE);
        let naive = tree.cells(&ray, Interval::POSITIVE).find_map(|cell| {
            let mut probe = Probe::new(&scene, &ray, Interval::POSITIVE);
            cell.primitives.iter().for_each(|&primitive| {
                probe.test(primitive);
            });
            probe.best()
        });
        wrong += usize::from(naive != wanted);
    }
    assert!(wrong > 50, "{wrong}");
}

#[test]
fn leaves_fill_the_box_and_are_visited_in_order() {
    let scene = Scene::of_mesh(icosphere(4));
    let tree = KdTree::build(&scene);
    let volume = |b: Bounds3| (b.max - b.min).element_product();
    let sum: f64 = tree.leaves().map(|leaf| volume(leaf.bounds)).sum();
    assert!((sum / volume(tree.bounds) - 1.0).abs() < 1e-9, "{sum}");
    for ray in rays(200) {
        let cells: Vec<Cell> = tree.cells(&ray, Interval::POSITIVE).collect();
        for cell in &cells {
            let Bounds3 { min, max } = cell.bounds.grown(1e-12);
            let enter = Slabs::new(&ray).enter(min, max, Interval::POSITIVE).expect("visited: met");
            assert!((cell.enter - enter).abs() <= 1e-9 * (1.0 + enter), "{} {enter}", cell.enter);
        }
        assert!(cells.is_sorted_by(|a, b| a.enter <= b.enter), "{cells:?}");
        let distinct =
            |(k, cell): (usize, &Cell)| cells[..k].iter().all(|c| c.bounds != cell.bounds);
        assert!(cells.iter().enumerate().all(distinct), "no cell twice");
    }
}

#[test]
fn clipping_spares_tests() {
    let scene = Scene::of_mesh(hard::soup(2000, 0.5));
    let boxes = KdBuilder { perfect_splits: false, ..KdBuilder::default() };
    let [clipped, boxed] = [KdTree::build(&scene), boxes.build(&scene)].map(|tree| {
        tree.validate(&scene).unwrap();
        let mut counts = TestCounts::default();
        for ray in rays(1000) {
            tree.walk(Query::closest(&ray, Interval::POSITIVE), &mut counts);
        }
        counts.primitives
    });
    assert!(10 * clipped < 9 * boxed, "{clipped} {boxed}");
}

#[test]
fn any_number_of_threads_builds_the_same_tree() {
    let scene = Scene::of_mesh(icosphere(5));
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| KdTree::build(&scene))
    });
    assert!(one.leaves().eq(three.leaves()));
}
