use lancer_core::image::Image;

use crate::Verdict;
use crate::verify::Verified;

/// A chapter's exercises, in the order of its lesson.
pub struct Course<S: 'static> {
    /// The chapter's package, `chapter-1`.
    pub package: &'static str,
    /// The exercises.
    pub exercises: &'static [Exercise<S>],
    /// The right answers.
    pub reference: S,
}

/// Up to some 25 lines to write, and how they are judged.
pub struct Exercise<S: 'static> {
    /// What there is to know without the answer.
    pub card: Card,
    /// The checks, the easiest first.
    pub checks: &'static [Check<S>],
    /// What a beginner gets wrong, written with [`slips!`](crate::slips).
    pub slips: &'static [Slip<S>],
    /// The second subject, with the functions of this exercise taken from the first.
    pub own: fn(S, S) -> S,
    /// A picture drawn by the subject's functions.
    pub draw: fn(&S) -> Image,
    /// What happened at one pixel of that picture, where most of it is wrong.
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
    /// The student's file before they have touched it.
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
    /// The answer, and where the course's own code does the same.
    pub solution: Solution,
}

impl Card {
    /// The name of the student's file: `e03_ray_sphere.rs`.
    pub fn file(&self) -> String {
        let number = self.id.rsplit('.').next().unwrap_or_default();
        format!("e{number:0>2}_{}.rs", self.name.replace('-', "_"))
    }

    /// Whether the student's file calls functions of another exercise's, `use crate::yours::…`.
    pub fn calls(&self, other: &Self) -> bool {
        let uses = self.stub.lines().filter_map(|line| line.strip_prefix("use crate::yours::"));
        let mut words =
            uses.flat_map(|names| names.split(|c: char| !(c.is_alphanumeric() || c == '_')));
        words.any(|word| other.functions.contains(&word))
    }
}

/// A right answer, and the item of the course's code that does the same.
#[derive(Clone, Copy, Debug)]
pub struct Solution {
    /// A student's whole file that passes every check; the reference is made of it.
    pub answer: &'static str,
    /// The file of the course's item, from the root of the repository.
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
    pub run: fn(&S) -> Verdict,
}

/// Something plausible that makes one function wrong.
pub struct Slip<S: 'static> {
    /// In words, as a student is told: `the factor 2 is missing: …`.
    pub says: &'static str,
    /// The check that must fail.
    pub caught_by: &'static str,
    /// Puts the wrong function into a subject.
    pub make: fn(&mut S),
}

impl<S> Slip<S> {
    /// A subject that is right but for the slip.
    pub fn made_in(&self, mut reference: S) -> S {
        (self.make)(&mut reference);
        reference
    }
}

/// An exercise's slips: each in words, the check that must catch it, and what the function answers with it.
///
/// ```
/// use lancer_exercise::{Slip, slips};
///
/// #[derive(Clone, Copy)]
/// struct Subject {
///     doubled: fn(f64) -> f64,
///     mean: fn(f64, f64) -> f64,
/// }
///
/// const SLIPS: &[Slip<Subject>] = slips! {
///     doubled(x):
///     "the number is squared: that is right for 0 and 2 only":
///         "a number below 1" catches x * x;
///
///     mean(a, b):
///     "the sum is not halved":
///         "equal numbers" catches a + b;
///     "the second number is forgotten":
///         "different numbers" catches a;
/// };
///
/// let right = Subject { doubled: |x| 2.0 * x, mean: |a, b| 0.5 * (a + b) };
/// assert_eq!((SLIPS[1].made_in(right).mean)(3.0, 4.0), 7.0);
/// ```
///
/// Above its slips stands the function that is wrong, a field of the subject, with names for its arguments. Where an
/// answer calls a function of that name, it is the reference's: the slip shows what differs from it. Rustfmt leaves
/// these lines alone: an answer of more than a few is a function further down.
#[macro_export]
macro_rules! slips {
    (@ ($($argument:ident),+) $answer:expr) => {
        |$($argument),+| {
            // A slip may leave out an argument.
            $(let _ = &$argument;)+
            $answer
        }
    };
    ($($function:ident $arguments:tt: $($says:literal: $caught_by:literal catches $answer:expr;)+)+) => {
        &[$($($crate::Slip {
            says: $says,
            caught_by: $caught_by,
            make: |subject| subject.$function = $crate::slips!(@ $arguments $answer),
        }),+),+]
    };
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
