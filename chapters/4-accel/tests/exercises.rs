//! The exercises of the chapter prove themselves: the right answer passes every check, an untouched stub
//! passes none, every known slip is caught by the check that names it and looks like no other.

use std::path::Path;

use chapter_4::exercises::{COURSE, Subject};

#[allow(dead_code, unused_imports, unused_variables)]
#[path = "../stubs"]
mod stubs {
    pub mod e01_slab_test;
    pub mod e02_median_split;
    pub mod e03_sah_cost;
    pub mod e04_ordered_walk;
    pub mod e05_dda_step;
    pub mod e06_kd_plane;
    pub mod e07_brute_force;
    pub mod e08_eight_boxes;
}

/// The stubs as they are handed out: their functions have the types that the course asks for.
const STUB: Subject = Subject {
    slab_test: stubs::e01_slab_test::slab_test,
    median_split: stubs::e02_median_split::median_split,
    sah_cost: stubs::e03_sah_cost::sah_cost,
    best_split: stubs::e03_sah_cost::best_split,
    visit: stubs::e04_ordered_walk::visit,
    next_cell: stubs::e05_dda_step::next_cell,
    plane_sides: stubs::e06_kd_plane::plane_sides,
    search_cells: stubs::e07_brute_force::search_cells,
    eight_boxes: stubs::e08_eight_boxes::eight_boxes,
    near_to_far: stubs::e08_eight_boxes::near_to_far,
};

#[test]
fn the_reference_passes_and_every_slip_is_caught() {
    COURSE.prove_checks();
}

#[test]
fn an_untouched_stub_passes_no_check_and_names_its_slide() {
    COURSE.prove_stubs(STUB);
}

#[test]
fn every_solution_stands_where_its_card_says() {
    COURSE.prove_solutions(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")));
}

/// Whoever draws it, and however often: what differs from it is the student's own.
#[test]
fn a_picture_is_the_same_every_time() {
    for exercise in COURSE.exercises {
        let [a, b] = [0; 2].map(|_| (exercise.draw)(&COURSE.reference));
        assert_eq!(a.pixels(), b.pixels(), "{}", exercise.card.id);
    }
}

#[test]
fn the_lesson_has_a_table_of_them() {
    let lesson = include_str!("../README.md");
    let row = |exercise: &lancer_exercise::Exercise<Subject>| {
        let card = exercise.card;
        format!(
            "| {} | `{}` | {} | {} | « {} » |",
            card.id, card.name, card.title, card.minutes, card.slide
        )
    };
    let table = COURSE.exercises.iter().map(row).collect::<Vec<_>>().join("\n");
    assert!(lesson.contains(&table), "the lesson should have:\n{table}");
}
