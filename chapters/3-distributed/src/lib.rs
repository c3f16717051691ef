//! Chapter 3, « Lancer de rayons distribués »: its methods and scenes. What there is of the lesson is `README.md` beside
//! this package's manifest.

pub mod scenes;

use lancer_exercise::Course;
use lancer_lesson::Chapter;

/// The chapter.
pub static CHAPTER: Chapter = Chapter {
    number: "3",
    folder: "3-distributed",
    title: "Lancer de rayons distribués",
    figures: &[],
    course: &Course::<()> { package: "chapter-3", exercises: &[], reference: () },
    scenes: &scenes::SCENES,
    methods: &lancer_distributed::METHODS,
    walks: &[],
};
