//! The exercises of the chapter prove themselves: the right answer passes every check, an untouched stub
//! passes none, every known slip is caught by the check that names it and looks like no other.

use std::path::Path;

use chapter_1::exercises::{COURSE, Subject};
use lancer_core::geometry::{Interval, Shear, intersect_triangle};

/// What the later stubs call: in a student's workspace, their own functions.
mod yours {
    pub use chapter_1::exercises::reference::*;
}

#[allow(dead_code, unused_imports, unused_variables)]
#[path = "../stubs"]
mod stubs {
    pub mod e01_primary_ray;
    pub mod e02_ray_triangle;
    pub mod e03_ray_sphere;
    pub mod e04_shadow_ray;
    pub mod e05_local_light;
    pub mod e06_reflected_ray;
    pub mod e07_refracted_ray;
    pub mod e08_lr;
    pub mod e09_ray_tree;
    pub mod e10_samples;
}

/// The stubs as they are handed out: their functions have the types that the course asks for.
const STUB: Subject = Subject {
    primary_ray: stubs::e01_primary_ray::primary_ray,
    ray_triangle: stubs::e02_ray_triangle::ray_triangle,
    ray_sphere: stubs::e03_ray_sphere::ray_sphere,
    shadow_ray: stubs::e04_shadow_ray::shadow_ray,
    local_light: stubs::e05_local_light::local_light,
    reflected_ray: stubs::e06_reflected_ray::reflected_ray,
    refracted_ray: stubs::e07_refracted_ray::refracted_ray,
    lr: stubs::e08_lr::lr,
    ray_tree: stubs::e09_ray_tree::ray_tree,
    count_rays: stubs::e09_ray_tree::count_rays,
    pixel_mean: stubs::e10_samples::pixel_mean,
    rms_error: stubs::e10_samples::rms_error,
};

#[test]
fn the_reference_passes_and_every_slip_is_caught() {
    COURSE.prove_checks();
}

#[test]
fn an_untouched_stub_passes_no_check_and_names_its_slide() {
    COURSE.prove_stubs(STUB);
}

/// The answers' triangle test takes every t > 0, whose noise the course's own cuts off: the stage does it for them.
#[test]
fn the_answers_draw_what_the_courses_own_intersections_do() {
    let subject = Subject {
        ray_triangle: |corners, ray| {
            let hit = intersect_triangle(corners, ray, &Shear::new(ray.direction))?;
            Some((hit.t, hit.barycentric))
        },
        ray_sphere: |sphere, ray| sphere.intersect(ray, Interval::POSITIVE),
        ..COURSE.reference
    };
    for exercise in COURSE.exercises {
        let (course, answers) = ((exercise.draw)(&subject), (exercise.draw)(&COURSE.reference));
        let pairs = course.pixels().iter().zip(answers.pixels());
        let wrong = pairs.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| (a - b).abs() > 1e-4));
        assert_eq!(wrong.count(), 0, "{}", exercise.card.id);
    }
}

/// A stub is read by itself: the files that it sends to are there.
#[test]
fn the_files_that_stubs_name_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut named = 0;
    for exercise in COURSE.exercises {
        let words = exercise.card.stub.split(|c: char| c.is_whitespace() || "(),;:".contains(c));
        for path in words.map(|word| word.trim_end_matches('.')) {
            if path.ends_with(".rs") {
                assert!(root.join(path).is_file(), "{}: {path}", exercise.card.id);
                named += 1;
            }
        }
    }
    assert!(named >= 10, "{named}");
}

#[test]
fn the_lesson_has_them_in_order() {
    let lesson = include_str!("../README.md");
    let places = COURSE.exercises.iter().map(|exercise| {
        let card = exercise.card;
        let entry = format!("**Exercise {}**, `cargo xtask exercise start {}`", card.id, card.name);
        lesson.find(&entry).unwrap_or_else(|| panic!("the lesson has no {entry}"))
    });
    assert!(places.collect::<Vec<_>>().is_sorted());
}
