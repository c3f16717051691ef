use lancer_core::image::Image;

use crate::Mismatch;
use crate::verify::Verified;

/// A chapter's exercises, in the order of its lesson.
pub struct Course<S: 'static> {
    /// The chapter's package, `chapter-1`.
    pub package: &'static str,
    /// The exercises.
    pub exercises: &'static [Exercise<S>],
    /// The chapter's own code.
    pub reference: S,
}

/// Up to some 25 lines to write, and how they are judged.
pub struct Exercise<S: 'static> {
    /// What there is to know without the answer.
    pub card: Card,
    /// The checks, the easiest first.
    pub checks: &'static [Check<S>],
    /// Plausible mistakes.
    pub mutants: &'static [Mutant<S>],
    /// A picture drawn by the subject's functions.
    pub draw: fn(&S) -> Image,
    /// What happened at one pixel of that picture, for whoever looks for the first wrong one.
    pub explain: Option<fn(&S, [u32; 2]) -> String>,
}

/// What is known of an exercise without its checks.
#[derive(Clone, Copy, Debug)]
pub struct Card {
    /// Its number in the course: `1.3` is the third of chapter 1.
    pub id: &'static str,
    /// Its short name, `ray-sphere`.
    pub name: &'static str,
    /// What is to be done, in one line.
    pub title: &'static str,
    /// The slide it belongs to.
    pub slide: &'static str,
    /// The name of the student's file.
    pub file: &'static str,
    /// The file before the student has touched it.
    pub stub: &'static str,
    /// The functions to be written there, which are fields of the subject too.
    pub functions: &'static [&'static str],
    /// About how long it takes.
    pub minutes: u32,
    /// A question about the picture, to be answered before it is drawn.
    pub predict: &'static str,
    /// A parameter to change afterwards, and a question about that.
    pub vary: &'static str,
    /// The idea, the formula, almost the code.
    pub hints: [&'static str; 3],
    /// Where the course's own answer stands.
    pub solution: Solution,
}

/// An item of the course's code.
#[derive(Clone, Copy, Debug)]
pub struct Solution {
    /// Its file, from the root of the repository.
    pub file: &'static str,
    /// How its first line begins, `pub fn reflect`.
    pub item: &'static str,
    /// What to notice in it.
    pub notice: &'static str,
}

/// Something that a right answer does.
pub struct Check<S: 'static> {
    /// What it looks at, `a ray from inside`.
    pub name: &'static str,
    /// Judges; of several counter-examples the simplest is to be reported.
    pub run: fn(&S) -> Result<(), Mismatch>,
}

/// The reference with one plausible mistake.
pub struct Mutant<S: 'static> {
    /// The slip in words, as a student is told: `the factor 2 is missing: …`.
    pub says: &'static str,
    /// The check that must fail.
    pub caught_by: &'static str,
    /// Makes the mistake.
    pub mistake: fn(&mut S),
}

/// A course whose subject does not matter, for whoever handles those of several chapters.
pub trait Shelf: Sync {
    /// The chapter's package.
    fn package(&self) -> &'static str;

    /// What there is to know of each exercise.
    fn cards(&self) -> Vec<Card>;

    /// Proves the checks: see [`Verified`].
    fn verify(&self) -> Vec<Verified>;
}

impl<S: Copy + Send + Sync> Shelf for Course<S> {
    fn package(&self) -> &'static str {
        self.package
    }

    fn cards(&self) -> Vec<Card> {
        self.exercises.iter().map(|exercise| exercise.card).collect()
    }

    fn verify(&self) -> Vec<Verified> {
        self.exercises.iter().map(|exercise| Verified::of(exercise, self.reference)).collect()
    }
}
