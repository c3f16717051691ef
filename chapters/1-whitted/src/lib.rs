//! Chapter 1, « Introduction au lancer de rayons »: its scenes, figures and exercises, and its algorithm step by step.
//! The lesson is `README.md` beside this package's manifest.

pub mod exercises;
pub mod figures;
pub mod scenes;
pub mod step;

// The solutions are a student's files, which name this crate as others do.
extern crate self as chapter_1;

use lancer_lesson::Chapter;

/// What the solutions call of each other.
mod yours {
    pub use crate::exercises::reference::*;
}

/// The chapter.
pub static CHAPTER: Chapter = Chapter {
    number: "1",
    folder: "1-whitted",
    title: "Introduction au lancer de rayons",
    figures: figures::FIGURES,
    course: &exercises::COURSE,
    scenes: &scenes::SCENES,
    methods: &lancer_whitted::METHODS,
    walks: &[step::WALK],
};
