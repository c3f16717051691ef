//! Chapter 1, « Introduction au lancer de rayons »: its scenes, figures and exercises, and its algorithm step by step.
//! The lesson is `README.md` beside this package's manifest.

pub mod exercises;
pub mod figures;
pub mod scenes;
pub mod step;

use lancer_lesson::Chapter;

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
