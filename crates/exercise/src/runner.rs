//! The program of a student's workspace: their functions against the checks.

use std::fmt::Write;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::path::Path;
use std::process::exit;
use std::sync::{Mutex, mpsc};
use std::thread;
use std::time::Duration;

use lancer_core::image::write_atomically;

use crate::judge::Outcome;
use crate::show::compare;
use crate::{Card, Course, Exercise, Failure, Report, State};

/// No picture of an exercise takes more than a second with right functions.
const DRAWING: Duration = Duration::from_secs(60);

/// What panicked, and where: the file and the line. A hook cannot hand that on in any other way. It is kept
/// apart from the outcomes, which are compared with those of slips that panic elsewhere.
static PANICS: Mutex<Vec<(Failure, Place)>> = Mutex::new(Vec::new());

/// A file's name and a line in it.
#[derive(Clone)]
struct Place {
    file: String,
    line: u32,
}

fn remember(panic: &PanicHookInfo<'_>) {
    let (Some(location), Ok(mut panics)) = (panic.location(), PANICS.lock()) else { return };
    let name = Path::new(location.file()).file_name().unwrap_or_default();
    let place = Place { file: name.to_string_lossy().into_owned(), line: location.line() };
    panics.push((Failure::of_panic(panic.payload()), place));
}

/// Where the first panic of this kind was. The student's functions run before any slip does.
fn place_of(failure: &Failure) -> Option<Place> {
    let panics = PANICS.lock().ok()?;
    panics.iter().find(|(known, _)| known == failure).map(|(_, place)| place.clone())
}

/// Does what the arguments say: `status NAME`, `check NAME`, `check-all NAME` or `show NAME FILE.png`.
///
/// `status` prints the name of the exercise's [`State`]. `check` stops at the first failing
/// check, `check-all` shows every one. The exit code is 0 for a right answer, 1 for any other, 2 for
/// arguments that are none. Ends the program, since a function that does not come back cannot be stopped
/// otherwise.
pub fn run<S: Copy + Send + Sync + 'static>(course: &'static Course<S>, subject: S) -> ! {
    // What a panic says goes into the report, not before it.
    std::panic::set_hook(Box::new(remember));
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let named = |name: &str| course.exercises.iter().find(|exercise| exercise.card.name == name);
    let answer = match arguments[..] {
        ["status", name] => named(name).map(|exercise| status(course, exercise, subject)),
        ["check", name] => named(name).map(|exercise| check(course, exercise, subject, false)),
        ["check-all", name] => named(name).map(|exercise| check(course, exercise, subject, true)),
        ["show", name, file] => named(name).map(|exercise| show(course, exercise, subject, file)),
        _ => None,
    };
    let Some((text, is_right)) = answer else {
        eprintln!("this program is run by `cargo xtask exercise`");
        exit(2)
    };
    print!("{text}");
    exit(i32::from(!is_right))
}

fn status<S: Copy + Send>(
    course: &Course<S>,
    exercise: &Exercise<S>,
    subject: S,
) -> (String, bool) {
    let state = Report::of(exercise, subject, course.reference).state();
    (format!("{}\n", state.name()), state == State::Passing)
}

impl State {
    /// One word for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unwritten => "unwritten",
            Self::Wrong => "wrong",
            Self::Passing => "passing",
        }
    }
}

fn check<S: Copy + Send>(
    course: &Course<S>,
    exercise: &Exercise<S>,
    subject: S,
    all: bool,
) -> (String, bool) {
    let card = exercise.card;
    let report = Report::of(exercise, subject, course.reference);
    let mut text = title(&card);
    for (name, outcome) in &report.outcomes {
        match outcome {
            Outcome::Passed => line(&mut text, format_args!("  ✓ {name}")),
            Outcome::Failed(failure) => {
                line(&mut text, format_args!("  ✗ {name}"));
                describe(&mut text, &card.file(), failure);
                if !all {
                    break;
                }
            }
        }
    }
    let name = card.name;
    match report.state() {
        State::Passing => line(
            &mut text,
            format_args!(
                "\nRight. See it: cargo xtask exercise show {name}\nThen: {}\nCompare with ours: cargo xtask exercise solution {name}",
                card.vary
            ),
        ),
        State::Unwritten => (),
        State::Wrong => match report.slip {
            Some(slip) => line(&mut text, format_args!("\nThis looks like a known slip: {slip}")),
            None => line(&mut text, format_args!("\nA hint: cargo xtask exercise hint {name}")),
        },
    }
    if report.state() != State::Unwritten {
        let called = course.exercises.iter().filter(|other| card.calls(&other.card));
        for other in called {
            if Report::of(other, subject, course.reference).state() != State::Passing {
                let Card { id, name, .. } = other.card;
                line(
                    &mut text,
                    format_args!(
                        "\nIt calls your {id}, which is not right: cargo xtask exercise check {name}"
                    ),
                );
            }
        }
    }
    (text, report.state() == State::Passing)
}

fn title(card: &Card) -> String {
    format!("{} {}: {}\n", card.id, card.name, card.title)
}

fn describe(text: &mut String, file: &str, failure: &Failure) {
    match failure {
        Failure::Wrong(mismatch) => {
            for part in mismatch.to_string().lines() {
                line(text, format_args!("    {part}"));
            }
        }
        Failure::Unwritten => {
            // It may be another exercise's that this one calls.
            let file = place_of(failure).map_or(file.to_owned(), |place| place.file);
            line(text, format_args!("      still to be written: replace `todo!()` in {file}"));
        }
        Failure::Panicked(message) => {
            let place = place_of(failure)
                .map_or(String::new(), |Place { file, line }| format!(" in line {line} of {file}"));
            line(text, format_args!("      your function panicked{place}: {message}"));
        }
        Failure::Endless => {
            let endless = "your function did not come back within 10 seconds: does its loop end, or its recursion?";
            line(text, format_args!("      {endless}"));
        }
    }
}

fn show<S: Copy + Send + Sync + 'static>(
    course: &'static Course<S>,
    exercise: &'static Exercise<S>,
    subject: S,
    file: &str,
) -> (String, bool) {
    let (sender, receiver) = mpsc::channel();
    let drawing = move || {
        let drawn = catch_unwind(AssertUnwindSafe(|| {
            let (yours, reference) =
                ((exercise.draw)(&subject), (exercise.draw)(&course.reference));
            let comparison = compare(exercise, &yours, &reference);
            let explained = exercise.explain.zip(comparison.worst).map(|(explain, pixel)| {
                format!(
                    "\nThe reference there:\n{}\nYours there:\n{}",
                    explain(&course.reference, pixel),
                    explain(&subject, pixel)
                )
            });
            let canvas = comparison.plate.canvas();
            (
                comparison.plate.claim().to_owned() + &explained.unwrap_or_default(),
                canvas.to_png(1.0),
                comparison.worst.is_none(),
            )
        }));
        // Whoever waits may have left.
        let _ = sender.send(drawn);
    };
    thread::spawn(drawing);
    let mut text = title(&exercise.card);
    match receiver.recv_timeout(DRAWING) {
        Ok(Ok((claim, png, is_right))) => match write_atomically(file, &png) {
            Ok(()) => {
                line(&mut text, format_args!("{claim}\nThe plate is in {file}"));
                return (text, is_right);
            }
            Err(error) => line(&mut text, format_args!("{error}")),
        },
        Ok(Err(panic)) => {
            let failure = Failure::of_panic(&*panic);
            describe(&mut text, &exercise.card.file(), &failure);
        }
        Err(_) => describe(&mut text, &exercise.card.file(), &Failure::Endless),
    }
    (text, false)
}

fn line(text: &mut String, content: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{content}");
}
