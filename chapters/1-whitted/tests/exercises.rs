//! The exercises of the chapter prove themselves: the right answer passes every check, an untouched stub
//! passes none, every known slip is caught by the check that names it and looks like no other.

use chapter_1::exercises::{COURSE, Subject};
use lancer_exercise::{Verified, passed_by_stub};

/// What the later stubs call: in a student's workspace, their own functions.
mod yours {
    pub use chapter_1::exercises::reference::*;
}

#[allow(unused_imports, unused_variables)]
#[path = "../stubs"]
mod stubs {
    pub mod e06_reflected_ray;
    pub mod e07_refracted_ray;
    pub mod e08_lr;
    pub mod e09_ray_tree;
    pub mod e10_samples;
}

/// The stubs as they are handed out: their functions have the types that the course asks for.
const STUB: Subject = Subject {
    reflected_ray: stubs::e06_reflected_ray::reflected_ray,
    refracted_ray: stubs::e07_refracted_ray::refracted_ray,
    lr: stubs::e08_lr::lr,
    ray_tree: stubs::e09_ray_tree::ray_tree,
    count_rays: stubs::e09_ray_tree::count_rays,
    pixel_mean: stubs::e10_samples::pixel_mean,
    rms_error: stubs::e10_samples::rms_error,
    ..COURSE_REFERENCE
};

const COURSE_REFERENCE: Subject = chapter_1::exercises::reference::SUBJECT;

#[test]
fn the_reference_passes_and_every_slip_is_caught() {
    for exercise in COURSE.exercises {
        let verified = Verified::of(exercise, COURSE.reference);
        assert_eq!(verified.reference_fails, [""; 0], "{}", verified.name);
        assert!(verified.proofs.len() >= 3, "{}: three slips", verified.name);
        for proof in &verified.proofs {
            assert_eq!(proof.twin, None, "{}: {}", verified.name, proof.says);
            assert!(
                proof.holds(&verified.checks),
                "{}: {}: {:?}",
                verified.name,
                proof.says,
                proof.caught
            );
        }
    }
}

#[test]
fn an_untouched_stub_passes_no_check() {
    for exercise in COURSE.exercises {
        assert_eq!(passed_by_stub(exercise, STUB), [""; 0], "{}", exercise.card.name);
    }
}
