//! The right answers: the chapter's solutions, each of which is a student's file.

#[path = "../../solutions/e01_slab_test.rs"]
mod e01_slab_test;
#[path = "../../solutions/e02_median_split.rs"]
mod e02_median_split;
#[path = "../../solutions/e03_sah_cost.rs"]
mod e03_sah_cost;
#[path = "../../solutions/e04_ordered_walk.rs"]
mod e04_ordered_walk;
#[path = "../../solutions/e05_dda_step.rs"]
mod e05_dda_step;
#[path = "../../solutions/e06_kd_plane.rs"]
mod e06_kd_plane;
#[path = "../../solutions/e07_brute_force.rs"]
mod e07_brute_force;
#[path = "../../solutions/e08_eight_boxes.rs"]
mod e08_eight_boxes;

use super::Subject;

pub use e01_slab_test::slab_test;
pub use e02_median_split::median_split;
pub use e03_sah_cost::{best_split, sah_cost};
pub use e04_ordered_walk::visit;
pub use e05_dda_step::next_cell;
pub use e06_kd_plane::plane_sides;
pub use e07_brute_force::search_cells;
pub use e08_eight_boxes::{eight_boxes, near_to_far};

/// All of them.
pub const SUBJECT: Subject = Subject {
    slab_test,
    median_split,
    sah_cost,
    best_split,
    visit,
    next_cell,
    plane_sides,
    search_cells,
    eight_boxes,
    near_to_far,
};

/// The answers beside the course's own code, so that neither drifts from the other. [`eight_boxes`] has a check of
/// this kind, « as one box after the other ».
#[cfg(test)]
mod tests {
    use glam::{DVec3, IVec3};
    use lancer_accel::{Cell, Grid, Lattice, Sides, split_at_median};
    use lancer_core::geometry::{Bounds3, Interval, Ray, Shear, Slabs, intersect_triangle};
    use lancer_core::intersector::{Intersector, LinearScan};
    use lancer_core::sampling::Uniform;
    use lancer_core::scene::PrimitiveId;

    use super::super::walk::Tree;
    use super::super::{Item, Walk};
    use super::*;
    use crate::scenes;

    /// A point of the cube [−1, 1]³.
    fn point(random: &mut Uniform) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| 2.0 * random.number() - 1.0))
    }

    /// A box about half as wide as the cube.
    fn bounds(random: &mut Uniform) -> Bounds3 {
        Bounds3::of_points([point(random), point(random)])
    }

    /// The course rounds the near t down, by a factor, and is else the same.
    #[test]
    fn the_slab_test_is_the_courses_but_for_its_pad() {
        let mut random = Uniform::new(61, 0, 0);
        let mut met = 0;
        for _ in 0..2000 {
            let bounds = bounds(&mut random);
            let origin = 2.0 * point(&mut random);
            let ray = Ray::new(origin, point(&mut random) - origin);
            let enter = slab_test(&bounds, &ray, Interval::POSITIVE);
            let course = Slabs::new(&ray).enter(bounds.min, bounds.max, Interval::POSITIVE);
            assert_eq!(enter.map(|t| t * Slabs::NEAR), course, "{bounds:?} {ray:?}");
            met += u32::from(enter.is_some());
        }
        assert!((200..1800).contains(&met), "{met}");
    }

    #[test]
    fn the_median_split_has_the_courses_halves() {
        let mut random = Uniform::new(62, 0, 0);
        for count in 2..100 {
            let items: Vec<Item> = (0..count)
                .map(|id| Item { center: point(&mut random), id: PrimitiveId(id) })
                .collect();
            let front = |split: &dyn Fn(&mut [Item]) -> usize| {
                let mut items = items.clone();
                let middle = split(&mut items);
                let mut ids: Vec<PrimitiveId> =
                    items[..middle].iter().map(|item| item.id).collect();
                ids.sort_unstable();
                ids
            };
            let course = |items: &mut [Item]| {
                split_at_median(items, |item| (item.center.as_vec3a(), item.id))
            };
            assert_eq!(front(&median_split), front(&course));
        }
    }

    #[test]
    fn a_split_costs_what_the_course_says_to_the_bit() {
        let mut random = Uniform::new(63, 0, 0);
        let extent = |bounds: &Bounds3| bounds.max - bounds.min;
        for n in 0..200 {
            let [a, b] = [bounds(&mut random), bounds(&mut random)];
            let (node, counts) = (a.union(b), [n, 200 - n]);
            let course =
                lancer_accel::sah_cost(extent(&node), [a, b].map(|b| extent(&b)), counts, 1.0);
            assert_eq!(sah_cost(&node, [&a, &b], counts), course);
        }
    }

    #[test]
    fn the_ordered_walk_finds_the_closest_hit() {
        let scene = scenes::family("town").scene(300);
        let (tree, oracle) = (Tree::new(&scene), LinearScan::new(&scene));
        let rays = scene.camera.primary_rays(lancer_core::image::ImageSize::new(24, 18));
        for pixel in 0..24 * 18 {
            let ray = rays.through(f64::from(pixel % 24) + 0.5, f64::from(pixel / 24) + 0.5);
            let (hit, _) = Walk::new(&scene, &tree, &ray).run(visit);
            assert_eq!(hit, oracle.closest_hit(&ray, Interval::POSITIVE));
        }
    }

    #[test]
    fn a_step_of_the_grid_is_the_courses_to_the_bit() {
        let mut random = Uniform::new(65, 0, 0);
        for _ in 0..2000 {
            let (min, width) = (point(&mut random), point(&mut random).abs());
            let lattice = Lattice { min, width, resolution: IVec3::new(3, 4, 5) };
            let cell = (3.0 * point(&mut random).abs()).as_ivec3();
            let ray = Ray::new(point(&mut random), point(&mut random));
            assert_eq!(next_cell(&lattice, &ray, cell), lattice.step(&ray, cell));
        }
    }

    #[test]
    fn the_sides_of_a_plane_are_the_courses_to_the_bit() {
        let mut random = Uniform::new(66, 0, 0);
        let inside = Interval { min: 0.5, max: 4.0 };
        for k in 0..2000 {
            let [split, origin] = [random.number(), random.number()];
            let direction = match k % 10 {
                0 => 0.0,
                1 => -0.0,
                _ => random.number() - 0.5,
            };
            for split in [split, origin] {
                let course = Sides::of(split, origin, direction, inside);
                assert_eq!(plane_sides(split, origin, direction, inside), course);
            }
        }
    }

    #[test]
    fn the_search_of_a_grids_cells_finds_the_courses_hit() {
        let scene = scenes::family("town").scene(300);
        let grid = Grid::build(&scene);
        let rays = scene.camera.primary_rays(lancer_core::image::ImageSize::new(24, 18));
        for pixel in 0..24 * 18 {
            let ray = rays.through(f64::from(pixel % 24) + 0.5, f64::from(pixel / 24) + 0.5);
            let shear = Shear::new(ray.direction);
            let cells: Vec<Cell> = grid.cells(&ray, Interval::POSITIVE).collect();
            let met = search_cells(&cells, &mut |primitive| {
                let corners = scene.mesh.corners(primitive.0 as usize);
                intersect_triangle(corners, &ray, &shear).map(|hit| hit.t)
            });
            let course = grid.closest_hit(&ray, Interval::POSITIVE);
            assert_eq!(met, course.map(|hit| (hit.t, hit.primitive)));
        }
    }
}
