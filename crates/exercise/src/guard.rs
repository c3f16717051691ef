//! What a chapter's own tests prove of its exercises.

use std::path::{Path, PathBuf};

use crate::{Course, Exercise, Report, State, Verified, passed_by_stub};

impl<S: Copy + Send> Course<S> {
    /// Proves the checks: the right answer passes them all, and each of at least three slips is caught by
    /// the check that it names and looks like no other.
    ///
    /// # Panics
    /// If not.
    pub fn prove_checks(&self) {
        for exercise in self.exercises {
            let verified = Verified::of(exercise, self.reference);
            let name = verified.name;
            assert_eq!(verified.reference_fails, [""; 0], "{name}");
            assert!(verified.proofs.len() >= 3, "{name}: three slips");
            for proof in &verified.proofs {
                assert_eq!(proof.twin, None, "{name}: {}", proof.says);
                assert!(
                    proof.holds(&verified.checks),
                    "{name}: {}: {:?}",
                    proof.says,
                    proof.caught
                );
            }
        }
    }

    /// Proves that untouched stubs pass no check, and that each names its exercise and slide; and by them, that an
    /// exercise's own functions are those which it judges.
    ///
    /// # Panics
    /// If not.
    pub fn prove_stubs(&self, stubs: S) {
        for exercise in self.exercises {
            let card = exercise.card;
            assert_eq!(passed_by_stub(exercise, stubs), [""; 0], "{}", card.name);
            self.prove_own(exercise, stubs);
            let first = card.stub.lines().next().unwrap_or_default();
            let (id, slide) = (format!("//! {} ", card.id), format!(" Slide « {} ».", card.slide));
            assert!(first.starts_with(&id) && first.ends_with(&slide), "{first}");
        }
    }

    /// All functions of the exercise are taken: among right ones its stubs pass no check. No other's are: right
    /// ones among stubs make no other exercise's check pass.
    fn prove_own(&self, exercise: &Exercise<S>, stubs: S) {
        let name = exercise.card.name;
        let own_stubs = (exercise.own)(stubs, self.reference);
        assert_eq!(passed_by_stub(exercise, own_stubs), [""; 0], "{name}: `own` lacks a function");
        let own_answers = (exercise.own)(self.reference, stubs);
        for other in self.exercises.iter().filter(|other| other.card.name != name) {
            let passed = passed_by_stub(other, own_answers);
            assert_eq!(passed, [""; 0], "{name}: `own` has a function of {}", other.card.name);
        }
    }

    /// Proves that what is printed as an answer is the file that was compiled into `solved`, that it is right as
    /// `check` judges, the picture included, and that the course's own code stands where the cards say. `chapter` is
    /// the chapter's folder.
    ///
    /// # Panics
    /// If not.
    pub fn prove_solutions(&self, chapter: &Path, solved: S) {
        let read = |path: PathBuf| {
            let text = std::fs::read_to_string(&path);
            text.unwrap_or_else(|error| panic!("{}: {error}", path.display()))
        };
        for exercise in self.exercises {
            let (name, solution) = (exercise.card.name, exercise.card.solution);
            let answer = read(chapter.join("solutions").join(exercise.card.file()));
            assert_eq!(solution.answer, answer, "{name}");
            let report = Report::of(exercise, solved, self.reference);
            assert_eq!(report.state(), State::Passing, "{name}: {:?}", report.first_failure());
            let course = read(chapter.join("../..").join(solution.file));
            let is_there = course.lines().any(|line| line.trim_start().starts_with(solution.item));
            assert!(is_there, "{name}: no `{}` in {}", solution.item, solution.file);
        }
    }
}
