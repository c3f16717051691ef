//! Runs checks on functions that may be wrong in any way: they may panic, or never come back.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use lancer_core::image::Image;

use crate::show::{Comparison, compare};
use crate::{Check, Exercise, Mismatch, Slip};

/// No check and no picture takes a second with a right answer.
pub(crate) const LIMIT: Duration = Duration::from_secs(10);
/// A student's recursion may be deep, in a picture's worth of threads.
const STACK: usize = 16 << 20;
/// What a picture is called among the checks.
const PICTURE: &str = "its picture";

/// What a check found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The answer is right.
    Passed,
    /// It is not.
    Failed(Failure),
}

/// How an answer is not right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// Another result than the expected one.
    Wrong(Mismatch),
    /// `todo!()`: the function is still to be written.
    Unwritten,
    /// It panicked, with this message.
    Panicked(String),
    /// It did not come back in time.
    Endless,
}

/// Where a student stands with an exercise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// A function is still to be written.
    Unwritten,
    /// A check fails.
    Wrong,
    /// All checks pass.
    Passing,
}

/// What the checks of an exercise found and, once they pass, its picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// Each check's name and outcome; the last one is the last that was run.
    pub outcomes: Vec<(&'static str, Outcome)>,
    /// The slip whose every outcome is the same.
    pub slip: Option<&'static str>,
}

impl Report {
    /// Runs all checks on an answer, and if it is wrong looks for the slip. If it is right, so must be the picture
    /// that the reference draws with the functions of this exercise only, whatever the others are like.
    pub fn of<S: Copy + Send>(exercise: &Exercise<S>, subject: S, reference: S) -> Self {
        let outcomes = outcomes(exercise, subject);
        let mut report = Self { outcomes, slip: None };
        if report.state() == State::Passing {
            let own = (exercise.own)(subject, reference);
            let picture = judge_picture(exercise, own, &(exercise.draw)(&reference));
            if let Outcome::Failed(_) = picture {
                report.outcomes.push((PICTURE, picture));
            }
            return report;
        }
        if report.state() == State::Wrong && !report.is_endless() {
            let same = |slip: &&Slip<S>| {
                self::outcomes(exercise, slip.made_in(reference)) == report.outcomes
            };
            report.slip = exercise.slips.iter().find(same).map(|slip| slip.says);
        }
        report
    }

    /// Where the student stands.
    pub fn state(&self) -> State {
        match self.first_failure() {
            None => State::Passing,
            Some((_, Failure::Unwritten)) => State::Unwritten,
            Some(_) => State::Wrong,
        }
    }

    /// The first check that failed.
    pub fn first_failure(&self) -> Option<(&'static str, &Failure)> {
        self.outcomes.iter().find_map(|(name, outcome)| match outcome {
            Outcome::Passed => None,
            Outcome::Failed(failure) => Some((*name, failure)),
        })
    }

    fn is_endless(&self) -> bool {
        matches!(self.first_failure(), Some((_, Failure::Endless)))
    }
}

/// Every check's outcome, up to one that does not come back.
pub(crate) fn outcomes<S: Copy + Send>(
    exercise: &Exercise<S>,
    subject: S,
) -> Vec<(&'static str, Outcome)> {
    let mut outcomes = Vec::new();
    for check in exercise.checks {
        let outcome = judge(check, subject);
        let is_endless = outcome == Outcome::Failed(Failure::Endless);
        outcomes.push((check.name, outcome));
        if is_endless {
            break;
        }
    }
    outcomes
}

/// Runs one check.
fn judge<S: Copy + Send>(check: &Check<S>, subject: S) -> Outcome {
    let run = check.run;
    match guarded(check.name, LIMIT, move || run(&subject)) {
        Ok(Ok(())) => Outcome::Passed,
        Ok(Err(mismatch)) => Outcome::Failed(Failure::Wrong(mismatch)),
        Err(failure) => Outcome::Failed(failure),
    }
}

/// Whether a subject's picture of an exercise is the reference's.
pub(crate) fn judge_picture<S: Copy + Send>(
    exercise: &Exercise<S>,
    subject: S,
    reference: &Image,
) -> Outcome {
    match drawn_beside(exercise, subject, reference) {
        Ok(Comparison { worst: None, .. }) => Outcome::Passed,
        Ok(comparison) => {
            let case = format!("the picture of: cargo xtask exercise show {}", exercise.card.name);
            let (got, wanted) = (comparison.plate.claim(), "the reference's picture");
            Outcome::Failed(Failure::Wrong(Mismatch::new(case, got, wanted)))
        }
        Err(failure) => Outcome::Failed(failure),
    }
}

/// A subject's picture of an exercise beside the reference's.
pub(crate) fn drawn_beside<S: Copy + Send>(
    exercise: &Exercise<S>,
    subject: S,
    reference: &Image,
) -> Result<Comparison, Failure> {
    let yours = drawn(exercise.draw, subject, LIMIT)?;
    Ok(compare(exercise, &yours, reference))
}

/// A picture by threads of its own: those that do not come back are not missed by the next picture.
fn drawn<S: Send + 'static>(
    draw: fn(&S) -> Image,
    subject: S,
    limit: Duration,
) -> Result<Image, Failure> {
    guarded(PICTURE, limit, move || {
        let named = |_| PICTURE.to_owned();
        let pool = rayon::ThreadPoolBuilder::new().stack_size(STACK).thread_name(named).build();
        pool.expect("threads can be started").install(move || draw(&subject))
    })
}

/// What some work with a student's functions comes to, in a thread of its own, which is left behind if it does not
/// come back.
pub(crate) fn guarded<T: Send + 'static>(
    name: &str,
    limit: Duration,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, Failure> {
    let (sender, receiver) = mpsc::channel();
    let working = move || {
        let result = catch_unwind(AssertUnwindSafe(work));
        // Whoever waits may have left.
        let _ = sender.send(result.map_err(|panic| Failure::of_panic(&*panic)));
    };
    let thread = thread::Builder::new().name(name.to_owned()).stack_size(STACK);
    if thread.spawn(working).is_err() {
        return Err(Failure::Panicked("no thread could be started".to_owned()));
    }
    receiver.recv_timeout(limit).unwrap_or(Err(Failure::Endless))
}

impl Failure {
    pub(crate) fn of_panic(panic: &(dyn Any + Send)) -> Self {
        let message = panic
            .downcast_ref::<&str>()
            .map(|text| (*text).to_owned())
            .or_else(|| panic.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "a panic without a message".to_owned());
        // What `todo!()` says.
        if message.starts_with("not yet implemented") {
            Self::Unwritten
        } else {
            Self::Panicked(message)
        }
    }
}

#[cfg(test)]
mod tests {
    use lancer_core::image::ImageSize;
    use rayon::prelude::*;

    use super::*;

    /// Rows that as many threads draw as there are, each of which takes so long.
    fn rows(pause: Duration) -> Image {
        (0..64).into_par_iter().for_each(|_| thread::sleep(pause));
        Image::from_pixels(ImageSize::new(1, 64), vec![[0.0; 3]; 64])
    }

    #[test]
    fn a_picture_without_end_keeps_no_other_from_being_drawn() {
        let limit = Duration::from_millis(200);
        let endless = drawn(|()| rows(Duration::from_secs(3600)), (), limit);
        assert_eq!(endless.map(drop), Err(Failure::Endless));
        assert_eq!(drawn(|()| rows(Duration::ZERO), (), LIMIT).map(drop), Ok(()));
        let panics = drawn(|()| panic!("no picture"), (), LIMIT);
        assert_eq!(panics.map(drop), Err(Failure::Panicked("no picture".to_owned())));
    }
}
