//! Checks again whenever a file says something else. Files are read again and again, since systems do not
//! pass on their notices from a host to its containers, and a file that is moved back has an old time.

use std::thread;
use std::time::{Duration, Instant};

use anyhow::Result;

use super::catalogue::{Entry, entries};
use super::keys::{Keys, Unbuffered};
use super::student::{State, Student};
use super::words::{say_report, say_wrapped};
use super::workspace::Workspace;
use super::{say_next, say_solution};
use crate::progress;

/// How long a key waits at most; the files are looked at every fourth time.
const PERIOD: Duration = Duration::from_millis(50);
const TICKS: u64 = 4;
/// Editors and sync tools take a file away before they put the new one there.
const GAP: Duration = Duration::from_secs(2);

/// Checks one exercise, or without one the first that does not pass, until Ctrl-C.
///
/// # Errors
/// If there is nothing to check, or the folder cannot be written.
pub fn watch(entry: Option<Entry>) -> Result<()> {
    progress::watch_for_interrupt()?;
    let mut watch = Watch { entry, last: None, keys: Keys::listen(), hints: 0, done: None };
    let mut student = Student::open()?;
    student.require_started(entry.as_ref())?;
    while !progress::is_interrupted() {
        let seen = texts(student.workspace());
        match watch.check(&mut student) {
            Ok(()) => {}
            Err(_) if progress::is_interrupted() => break,
            Err(error) => say!("error: {error:#}\n\n── waiting for a change; Ctrl-C ends ──"),
        }
        if !watch.wait(&mut student, &seen) {
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
    /// The one that was checked, which keys are about, and whether it passed.
    last: Option<(Entry, bool)>,
    keys: Option<Keys>,
    /// How many exercises pass, of how many, when one last did.
    done: Option<(usize, usize)>,
    /// How many of its hints have been shown.
    hints: usize,
}

impl Watch {
    fn check(&mut self, student: &mut Student) -> Result<()> {
        let checked = match (self.entry, self.last) {
            // What did not pass is what is being changed; who mends it waits for a word about it.
            (None, Some((last, false))) if student.workspace().is_started(&last) => {
                student.check(Some(last), false)?
            }
            (entry, _) => student.check(entry, false)?,
        };
        say_report(&checked.text);
        let before = self.last.replace((checked.entry, checked.passes));
        if before.is_none_or(|(before, _)| before.card.id != checked.entry.card.id) {
            self.hints = 0;
        }
        if checked.passes {
            self.done = None;
            let next = student.first_not_passing()?;
            match (&next, &self.keys) {
                (Some(next), Some(_)) => say!("n goes on to {}", next.title()),
                _ => say_next(next.as_ref()),
            }
        }
        self.say_keys(student)
    }

    /// How far the student is, and what they may type.
    fn say_keys(&mut self, student: &mut Student) -> Result<()> {
        let (done, all) = match self.done {
            Some(known) => known,
            None => *self.done.insert(student.progress()?),
        };
        say!("\n── {done} of {all} exercises done; waiting for a change; Ctrl-C ends ──");
        if self.keys.is_some() {
            say!("   n next · h hint · s show · o solution · l list · c check · q quit");
        }
        Ok(())
    }

    /// Waits until a file says something else, and does meanwhile what the keys say. False at the end.
    fn wait(&mut self, student: &mut Student, seen: &[Option<Vec<u8>>]) -> bool {
        let _unbuffered = self.keys.as_ref().map(|_| Unbuffered::new());
        let mut gap: Option<Instant> = None;
        for tick in 0_u64.. {
            if progress::is_interrupted() {
                break;
            }
            if tick % TICKS == 0 {
                let now = texts(student.workspace());
                let is_gone = |(old, new): (&Option<_>, &Option<_>)| old.is_some() && new.is_none();
                if now == seen {
                    gap = None;
                } else if !seen.iter().zip(&now).any(is_gone)
                    || gap.get_or_insert_with(Instant::now).elapsed() > GAP
                {
                    return true;
                }
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
        let Some((entry, _)) = self.last else { return Ok(false) };
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

/// What stands in each exercise's file; nothing where there is none.
fn texts(workspace: &Workspace) -> Vec<Option<Vec<u8>>> {
    entries().iter().map(|entry| std::fs::read(workspace.path(entry)).ok()).collect()
}
