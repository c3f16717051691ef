//! The answers that `cargo xtask exercise solution` prints, compiled as a student's files are: from outside the
//! chapter's crate. That the reference, which is made of the same files, is the course's own code in other words
//! is tested beside it.

use std::path::Path;

use chapter_4::exercises::{COURSE, Subject};

#[path = "../solutions"]
mod solutions {
    pub mod e01_slab_test;
    pub mod e02_median_split;
    pub mod e03_sah_cost;
    pub mod e04_ordered_walk;
    pub mod e05_dda_step;
    pub mod e06_kd_plane;
    pub mod e07_brute_force;
    pub mod e08_eight_boxes;
}

const SOLVED: Subject = Subject {
    slab_test: solutions::e01_slab_test::slab_test,
    median_split: solutions::e02_median_split::median_split,
    sah_cost: solutions::e03_sah_cost::sah_cost,
    best_split: solutions::e03_sah_cost::best_split,
    visit: solutions::e04_ordered_walk::visit,
    next_cell: solutions::e05_dda_step::next_cell,
    plane_sides: solutions::e06_kd_plane::plane_sides,
    search_cells: solutions::e07_brute_force::search_cells,
    eight_boxes: solutions::e08_eight_boxes::eight_boxes,
    near_to_far: solutions::e08_eight_boxes::near_to_far,
};

#[test]
fn a_student_who_copies_the_answers_passes_every_check() {
    COURSE.prove_solutions(Path::new(env!("CARGO_MANIFEST_DIR")), SOLVED);
}
