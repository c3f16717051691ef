//! The exercises of the chapter prove themselves: the right answer passes every check, an untouched stub
//! passes none, every known slip is caught by the check that names it and looks like no other.

use chapter_4::exercises::prelude::*;
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

/// Every check of an exercise accepts another answer that is right.
fn accept(id: &str, subject: Subject) {
    let exercise = COURSE.exercises.iter().find(|exercise| exercise.card.id == id);
    for check in exercise.expect("an exercise").checks {
        assert_eq!((check.run)(&subject), Ok(()), "{id}: {}", check.name);
    }
}

/// The checks ask for what the stub says, not for the reference's way to it.
#[test]
fn right_answers_of_another_kind_pass() {
    // No division by 0, and the factor once at the end of each slab.
    let slab_test = |bounds: &Bounds3, ray: &Ray, range: Interval| {
        let (mut near, mut far) = (range.min, range.max);
        for k in 0..3 {
            let (o, d) = (ray.origin[k], ray.direction[k]);
            let [min, max] = [bounds.min[k], bounds.max[k]];
            if d == 0.0 {
                if o < min || o > max {
                    return None;
                }
                continue;
            }
            let [a, b] = [(min - o) / d, (max - o) / d];
            near = near.max(a.min(b));
            far = far.min(a.max(b) * (1.0 + 4.0 * f64::EPSILON));
        }
        (near <= far).then_some(near)
    };
    accept("E4.1", Subject { slab_test, ..COURSE.reference });

    // Quotients first, then sums from left to right.
    let best_split = |boxes: &[Bounds3]| {
        let surface = |boxes: &[Bounds3]| {
            let around = boxes.iter().fold(Bounds3::EMPTY, |all, one| all.union(*one));
            let DVec3 { x, y, z } = around.max - around.min;
            2.0 * (x * y + y * z + z * x)
        };
        let (mut best, mut least) = (None, boxes.len() as f64);
        for left in 1..boxes.len() {
            let (a, b) = boxes.split_at(left);
            let [p, q] = [a, b].map(|side| surface(side) / surface(boxes) * side.len() as f64);
            if 1.0 + p + q < least {
                (best, least) = (Some(left), 1.0 + p + q);
            }
        }
        best
    };
    accept("E4.3", Subject { best_split, ..COURSE.reference });

    // Of children entered at once the other first, and nothing that begins just at the closest hit.
    fn visit(walk: &mut Walk, node: usize) {
        let Some([a, b]) = walk.children(node) else { return walk.test_leaf(node) };
        let [a, b] = [a, b].map(|child| (walk.enter(child).unwrap_or(f64::INFINITY), child));
        for (t, child) in if a.0 < b.0 { [a, b] } else { [b, a] } {
            if t < walk.closest() {
                visit(walk, child);
            }
        }
    }
    accept("E4.4", Subject { visit, ..COURSE.reference });

    // A quotient instead of the product with the reciprocal, and the case of NaN by itself.
    let plane_sides = |split: f64, origin: f64, direction: f64, inside: Interval| {
        let t = (split - origin) / direction;
        if t.is_nan() {
            Sides::Both { near: inside, far: inside }
        } else if t > inside.max {
            Sides::Near
        } else if t < inside.min {
            Sides::Far
        } else {
            Sides::Both { near: Interval { max: t, ..inside }, far: Interval { min: t, ..inside } }
        }
    };
    accept("E4.6", Subject { plane_sides, ..COURSE.reference });
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
