//! Chapter 4, « Accélération du lancer de rayons »: what is compared, on which scenes and rays, the figures, the
//! exercises, and a ray's walk through the indexes. The lesson is `README.md` beside this package's manifest.

pub mod aimed;
pub mod exercises;
pub mod figures;
pub mod naive;
pub mod rays;
pub mod scenes;
pub mod step;
pub mod volumes;

// The solutions are a student's files, which name this crate as others do.
extern crate self as chapter_4;

use lancer_lesson::Chapter;

/// The chapter.
pub static CHAPTER: Chapter = Chapter {
    number: "4",
    folder: "4-accel",
    title: "Accélération du lancer de rayons",
    figures: figures::FIGURES,
    course: &exercises::COURSE,
    scenes: &scenes::SCENES,
    methods: &[],
    walks: &[step::WALK],
};
