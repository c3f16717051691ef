//! Checks again whenever a file says something else. Files are read again and again, since systems do not
//! pass on their notices from a host to its containers, and a file that is moved back has an old time.

use std::thread;
use std::time::{Duration, Instant};

use anyhow::Result;

use super::catalogue::{Entry, entries};
use super::keys::Keys;
use super::student::{State, Student};
use super::words::{say_report, say_wrapped};
use super::workspace::Workspace;
use super::{say_next, say_solution};
use crate::progress;

const PERIOD: Duration = Duration::from_millis(200);
/// Editors and sync tools take a file away before they put the new one there.
const GAP: Duration = Duration::from_secs(2);

/// Checks one exercise, or without one the first that does not pass, until Ctrl-C.
///
/// # Errors
/// If there is nothing to check, or the folder cannot be written.
pub fn watch(entry: Option<Entry>) -> Result<()> {
    progress::watch_for_interrupt()?;
    let mut watch = Watch { entry, last: entry, keys: Keys::listen(), hints: 0 };
    let mut student = Student::open()?;
    student.require_started(entry.as_ref())?;
    while !progress::is_interrupted() {
        let seen = contents(student.workspace());
        match watch.check(&mut student) {
            Ok(()) => {}
            Err(_) if progress::is_interrupted() => break,
            Err(error) => say!("error: {error:#}\n\n── waiting for a change; Ctrl-C ends ──"),
        }
        if !watch.wait(&mut student, seen) {
            break;
        }
        student = Student::open()?;
    }
    say!("\nThe watch has ended.");
    Ok(())
}

/// What is watched, and how far the student has asked.
struct Watch {
    /// The one that is checked; without one, the first begun that does not pass.
    entry: Option<Entry>,
    /// The one that was checked, which keys are about.
    last: Option<Entry>,
    keys: Option<Keys>,
    /// How many of its hints have been shown.
    hints: usize,
}

impl Watch {
    fn check(&mut self, student: &mut Student) -> Result<()> {
        let checked = student.check(self.entry, false)?;
        say_report(&checked.text);
        if self.last.replace(checked.entry).is_none_or(|last| last.card.id != checked.entry.card.id)
        {
            self.hints = 0;
        }
        if checked.passes {
            let next = student.first_not_passing()?;
            match (&next, &self.keys) {
                (Some(next), Some(_)) => say!("n goes on to {}", next.title()),
                _ => say_next(next.as_ref()),
            }
        }
        self.say_keys(student)
    }

    /// How far the student is, and what they may type.
    fn say_keys(&self, student: &mut Student) -> Result<()> {
        let (done, all) = student.progress()?;
        say!("\n── {done} of {all} exercises done; waiting for a change; Ctrl-C ends ──");
        if self.keys.is_some() {
            say!("   n next · h hint · s show · o solution · l list · c check · q quit");
        }
        Ok(())
    }

    /// Waits until a file says something else, and does meanwhile what the keys say. False at the end.
    fn wait(&mut self, student: &mut Student, seen: Vec<Option<u64>>) -> bool {
        let mut gap: Option<Instant> = None;
        while !progress::is_interrupted() {
            let now = contents(student.workspace());
            let is_gone = |(old, new): (&Option<u64>, &Option<u64>)| old.is_some() && new.is_none();
            if now == seen {
                gap = None;
            } else if !seen.iter().zip(&now).any(is_gone)
                || gap.get_or_insert_with(Instant::now).elapsed() > GAP
            {
                return true;
            }
            match self.keys.as_ref().and_then(Keys::next) {
                Some('q') => return false,
                Some('c') => return true,
                Some(key) => match self.press(key, student) {
                    Ok(true) => return true,
                    Ok(false) => {}
                    Err(error) => say!("error: {error:#}"),
                },
                None => thread::sleep(PERIOD),
            }
        }
        false
    }

    /// Does what a key says; whether to check again.
    fn press(&mut self, key: char, student: &mut Student) -> Result<bool> {
        if key == 'l' {
            super::list(student)?;
            return Ok(false);
        }
        if key == 'n' {
            let Some(next) = student.first_not_passing()? else {
                say!("All exercises pass.");
                return Ok(false);
            };
            if student.state(&next)? == State::New {
                say_wrapped(&student.start(&next)?);
            }
            self.entry = Some(next);
            return Ok(true);
        }
        let Some(entry) = self.last else { return Ok(false) };
        match key {
            'h' => {
                self.hints = (self.hints + 1).min(3);
                super::say_hint(&entry, self.hints);
            }
            's' => say_report(&student.show(&entry)?.text),
            'o' => say_solution(student, &entry)?,
            _ => {}
        }
        Ok(false)
    }
}

/// What stands in each exercise's file, as a number; nothing where there is none.
fn contents(workspace: &Workspace) -> Vec<Option<u64>> {
    let of_entry =
        |entry: &Entry| workspace.is_started(entry).then(|| workspace.contents(&[*entry]));
    entries().iter().map(of_entry).collect()
}
