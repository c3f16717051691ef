//! Checks again whenever a file has changed. The times of files are looked at, since systems do not pass
//! on their notices from a host to its containers.

use std::io::{BufRead, IsTerminal, stdin};
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, SystemTime};

use anyhow::Result;

use super::catalogue::Entry;
use super::say_next;
use super::student::Student;
use super::workspace::Workspace;
use crate::progress::{self, INTERRUPTED};

const PERIOD: Duration = Duration::from_millis(300);

/// Checks one exercise, or without one the first that does not pass, until Ctrl-C.
///
/// # Errors
/// If there is nothing to check, or the folder cannot be written.
pub fn watch(mut entry: Option<Entry>) -> Result<()> {
    progress::watch_for_interrupt()?;
    let enter = listen();
    while !is_interrupted() {
        let mut student = Student::open()?;
        let seen = files(student.workspace());
        let result = student.check(entry, false);
        if is_interrupted() {
            break;
        }
        let checked = result?;
        say!("{}", checked.text.trim_end());
        let next = if checked.passes { student.first_not_passing()? } else { None };
        if let (Some(next), true) = (&next, enter.is_some()) {
            say!("Enter starts the next: {}", next.title());
        } else if checked.passes {
            say_next(next.as_ref());
        }
        say!("\n── waiting for a change; Ctrl-C ends ──");
        while !is_interrupted() && files(student.workspace()) == seen {
            if enter.as_ref().is_some_and(|lines| lines.try_recv().is_ok())
                && let Some(next) = next
            {
                say!("{}", student.start(&next)?);
                entry = None;
            }
            thread::sleep(PERIOD);
        }
    }
    say!("\nThe watch has ended.");
    Ok(())
}

fn is_interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// The student's files and when they were written.
fn files(workspace: &Workspace) -> Vec<(PathBuf, Option<SystemTime>)> {
    let started = workspace.started();
    started.iter().map(|entry| (workspace.path(entry), workspace.edited(entry))).collect()
}

/// The lines typed at a terminal, if there is one.
fn listen() -> Option<Receiver<String>> {
    if !stdin().is_terminal() {
        return None;
    }
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        for line in stdin().lock().lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                break;
            }
        }
    });
    Some(receiver)
}
