//! The exercises of the chapter prove themselves: the right answer passes every check, an untouched stub
//! passes none, every known slip is caught by the check that names it and looks like no other.

use std::path::Path;

use chapter_1::exercises::prelude::{DVec3, Meeting, Ray};
use chapter_1::exercises::{COURSE, Subject};

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

#[test]
fn every_solution_stands_where_its_card_says() {
    COURSE.prove_solutions(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")));
}

/// The third hint's triangle test takes every t > 0, whose noise the course's own cuts off.
#[test]
fn the_hinted_triangle_test_draws_the_title_picture_without_acne() {
    let subject = Subject { ray_triangle: hinted_triangle, ..COURSE.reference };
    for exercise in COURSE.exercises.iter().filter(|exercise| exercise.card.id != "E1.2") {
        let (yours, reference) = ((exercise.draw)(&subject), (exercise.draw)(&COURSE.reference));
        let pairs = yours.pixels().iter().zip(reference.pixels());
        let wrong = pairs.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| (a - b).abs() > 1e-4));
        assert_eq!(wrong.count(), 0, "{}", exercise.card.id);
    }
}

fn hinted_triangle(corners: [DVec3; 3], ray: &Ray) -> Option<Meeting> {
    let (d, z) = (ray.direction, ray.direction.abs().max_position());
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let inverse = 1.0 / d[z];
    let [a, b, c] = corners.map(|corner| {
        let v = corner - ray.origin;
        DVec3::new(v[x] - d[x] * inverse * v[z], v[y] - d[y] * inverse * v[z], v[z] * inverse)
    });
    let edge = |p: DVec3, q: DVec3| q.x * p.y - q.y * p.x;
    let (u, v, w) = (edge(b, c), edge(c, a), edge(a, b));
    let miss = u.min(v).min(w) < 0.0 && u.max(v).max(w) > 0.0;
    let beside = |a: f64, b: f64, c: f64| a.min(b).min(c) > 0.0 || a.max(b).max(c) < 0.0;
    if miss || beside(a.x, b.x, c.x) || beside(a.y, b.y, c.y) {
        return None;
    }
    let det = u + v + w;
    let t = (u * a.z + v * b.z + w * c.z) / det;
    (t > 0.0 && t.is_finite()).then(|| (t, DVec3::new(u, v, w) / det))
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
