//! Exercises: functions that a student writes, checks that judge them, and the slips the checks know.
//!
//! A chapter's *subject* is a struct of plain function pointers, one for each function to be written. Its
//! [`Course`] holds the reference (the right answers, as a student would write them) and, for each [`Exercise`], the
//! pristine stub, the [`Check`]s, and [`Slip`]s: what makes the reference wrong in one plausible way. Slips prove that the checks
//! can fail ([`Course::prove_checks`]), and when a student's answer behaves as the reference with a slip does, its
//! words say which one it is.
//!
//! The student's files live in a small workspace of their own, made by `cargo xtask exercise`; its program
//! puts their functions into a subject and calls [`run`].

mod course;
mod guard;
mod judge;
mod mismatch;
mod runner;
mod show;
mod verify;

pub use course::{Card, Check, Course, Exercise, Shelf, Slip, Solution};
pub use judge::{Failure, Outcome, Report, State};
pub use mismatch::{Mismatch, Shown, Verdict, ensure, same, within};
pub use runner::run;
pub use verify::{Proof, Verified, passed_by_stub};
