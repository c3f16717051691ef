//! Runs checks on functions that may be wrong in any way: they may panic, or never come back.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use crate::{Check, Exercise, Mismatch, Slip};

/// No check takes a second with a right answer.
const LIMIT: Duration = Duration::from_secs(10);
/// A student's recursion may be deep, in a picture's worth of threads.
const STACK: usize = 16 << 20;

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

/// What the checks of an exercise found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// Each check's name and outcome; the last one is the last that was run.
    pub outcomes: Vec<(&'static str, Outcome)>,
    /// The slip whose every outcome is the same.
    pub slip: Option<&'static str>,
}

impl Report {
    /// Runs all checks on an answer, and if it is wrong looks for the slip.
    pub fn of<S: Copy + Send>(exercise: &Exercise<S>, subject: S, reference: S) -> Self {
        let outcomes = outcomes(exercise, subject);
        let mut report = Self { outcomes, slip: None };
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
        let outcome = judge(check, subject, LIMIT);
        let is_endless = outcome == Outcome::Failed(Failure::Endless);
        outcomes.push((check.name, outcome));
        if is_endless {
            break;
        }
    }
    outcomes
}

/// Runs one check in a thread of its own, which is left behind if it does not come back.
fn judge<S: Copy + Send>(check: &Check<S>, subject: S, limit: Duration) -> Outcome {
    let (sender, receiver) = mpsc::channel();
    let run = check.run;
    let checking = move || {
        let result = catch_unwind(AssertUnwindSafe(|| run(&subject)));
        // The judge may have left.
        let _ = sender.send(match result {
            Ok(Ok(())) => Outcome::Passed,
            Ok(Err(mismatch)) => Outcome::Failed(Failure::Wrong(mismatch)),
            Err(panic) => Outcome::Failed(Failure::of_panic(&*panic)),
        });
    };
    let thread = thread::Builder::new().name(check.name.to_owned()).stack_size(STACK);
    if thread.spawn(checking).is_err() {
        return Outcome::Failed(Failure::Panicked("no thread could be started".to_owned()));
    }
    receiver.recv_timeout(limit).unwrap_or(Outcome::Failed(Failure::Endless))
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
