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
use crate::show::{Comparison, compare};
use crate::{Card, Course, Exercise, Failure, Mismatch, Report, State};

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

fn status<S: Copy + Send + Sync + 'static>(
    course: &'static Course<S>,
    exercise: &'static Exercise<S>,
    subject: S,
) -> (String, bool) {
    let state = judged(course, exercise, subject).state();
    (format!("{}\n", state.name()), state == State::Passing)
}

/// What the checks find and, once they pass, the picture: what `show` calls wrong is not right, unless the
/// functions of another exercise are to blame.
fn judged<S: Copy + Send + Sync + 'static>(
    course: &'static Course<S>,
    exercise: &'static Exercise<S>,
    subject: S,
) -> Report {
    let mut report = Report::of(exercise, subject, course.reference);
    if report.state() == State::Passing
        && let Outcome::Failed(failure) = picture(course, exercise, subject)
        && first_wrong(course, subject, |_| true).is_none()
    {
        report.outcomes.push(("its picture", Outcome::Failed(failure)));
    }
    report
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

fn check<S: Copy + Send + Sync + 'static>(
    course: &'static Course<S>,
    exercise: &'static Exercise<S>,
    subject: S,
    all: bool,
) -> (String, bool) {
    let card = exercise.card;
    let report = judged(course, exercise, subject);
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
    if report.state() != State::Unwritten
        && let Some(Card { id, name, .. }) = first_wrong(course, subject, |other| card.calls(other))
    {
        line(
            &mut text,
            format_args!(
                "\nIt calls your {id}, which is not right: cargo xtask exercise check {name}"
            ),
        );
    }
    (text, report.state() == State::Passing)
}

/// The first of some exercises whose functions are not right.
fn first_wrong<S: Copy + Send>(
    course: &Course<S>,
    subject: S,
    among: impl Fn(&Card) -> bool,
) -> Option<Card> {
    let mut chosen = course.exercises.iter().filter(|exercise| among(&exercise.card));
    let is_wrong = |exercise: &&Exercise<S>| {
        Report::of(exercise, subject, course.reference).state() != State::Passing
    };
    chosen.find(is_wrong).map(|exercise| exercise.card)
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

/// What `judge` says of the student's picture and the reference's, unless drawing them panics or does not end.
fn drawn<S: Copy + Send + Sync + 'static, T: Send + 'static>(
    course: &'static Course<S>,
    exercise: &'static Exercise<S>,
    subject: S,
    judge: impl FnOnce(&Comparison) -> T + Send + 'static,
) -> Result<T, Failure> {
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        let judged = catch_unwind(AssertUnwindSafe(|| {
            let (yours, reference) =
                ((exercise.draw)(&subject), (exercise.draw)(&course.reference));
            judge(&compare(exercise, &yours, &reference))
        }));
        // Whoever waits may have left.
        let _ = sender.send(judged.map_err(|panic| Failure::of_panic(&*panic)));
    });
    receiver.recv_timeout(DRAWING).unwrap_or(Err(Failure::Endless))
}

/// Whether the student's picture is the reference's.
fn picture<S: Copy + Send + Sync + 'static>(
    course: &'static Course<S>,
    exercise: &'static Exercise<S>,
    subject: S,
) -> Outcome {
    let difference = drawn(course, exercise, subject, |comparison| {
        comparison.worst.map(|_| comparison.plate.claim().to_owned())
    });
    match difference {
        Ok(None) => Outcome::Passed,
        Ok(Some(claim)) => {
            let name = exercise.card.name;
            let case = format!("the picture of: cargo xtask exercise show {name}");
            Outcome::Failed(Failure::Wrong(Mismatch::new(case, claim, "the reference's picture")))
        }
        Err(failure) => Outcome::Failed(failure),
    }
}

fn show<S: Copy + Send + Sync + 'static>(
    course: &'static Course<S>,
    exercise: &'static Exercise<S>,
    subject: S,
    file: &str,
) -> (String, bool) {
    let comparison = drawn(course, exercise, subject, move |comparison| {
        let explained = exercise.explain.zip(comparison.worst).map(|(explain, pixel)| {
            format!(
                "\nThe reference there:\n{}\nYours there:\n{}",
                explain(&course.reference, pixel),
                explain(&subject, pixel)
            )
        });
        let said = comparison.plate.claim().to_owned() + &explained.unwrap_or_default();
        (said, comparison.plate.canvas().to_png(1.0), comparison.worst.is_none())
    });
    let mut text = title(&exercise.card);
    let (said, png, is_right) = match comparison {
        Ok(comparison) => comparison,
        Err(failure) => {
            describe(&mut text, &exercise.card.file(), &failure);
            return (text, false);
        }
    };
    if let Err(error) = write_atomically(file, &png) {
        line(&mut text, format_args!("{error}"));
        return (text, false);
    }
    line(&mut text, format_args!("{said}"));
    let own = Report::of(exercise, subject, course.reference).state();
    if !is_right
        && own == State::Passing
        && let Some(Card { id, name, .. }) = first_wrong(course, subject, |_| true)
    {
        line(
            &mut text,
            format_args!(
                "Its own checks pass; your {id} may be to blame, which is not right: cargo xtask exercise check {name}"
            ),
        );
    }
    line(&mut text, format_args!("The plate is in {file}"));
    (text, is_right)
}

fn line(text: &mut String, content: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{content}");
}

#[cfg(test)]
mod tests {
    use lancer_core::image::{Image, ImageSize};

    use super::*;
    use crate::{Check, Solution, same};

    #[derive(Clone, Copy)]
    struct Subject {
        square: fn(u32) -> u32,
        fourth: fn(u32) -> u32,
    }

    const fn card(id: &'static str, name: &'static str, stub: &'static str) -> Card {
        let solution = Solution { answer: "", file: "", item: "", notice: "" };
        let hints = [""; 3];
        Card {
            id,
            name,
            title: "",
            slide: "",
            stub,
            functions: if id.len() == 4 { &["square"] } else { &["fourth"] },
            minutes: 1,
            predict: "",
            vary: "",
            hints,
            solution,
        }
    }

    /// A row of 64 pixels.
    fn row(function: impl Fn(u32) -> u32) -> Image {
        let pixels = (0..64).map(|x| [function(x) as f32; 3]).collect();
        Image::from_pixels(ImageSize::new(64, 1), pixels)
    }

    static COURSE: Course<Subject> = Course {
        package: "chapter-9",
        exercises: &[
            Exercise {
                card: card("E9.1", "square", ""),
                checks: &[Check {
                    name: "3 squared",
                    run: |subject| same(String::new, &(subject.square)(3), &9),
                }],
                slips: &[],
                draw: |subject| row(subject.square),
                explain: None,
            },
            Exercise {
                card: card("E9.10", "fourth", "use crate::yours::square;\n"),
                checks: &[Check {
                    name: "1 to the fourth",
                    run: |subject| same(String::new, &(subject.fourth)(1), &1),
                }],
                slips: &[],
                draw: |subject| row(|x| (subject.fourth)((subject.square)(x))),
                explain: None,
            },
        ],
        reference: Subject { square: |x| x * x, fourth: |x| x * x * x * x },
    };

    #[test]
    fn a_picture_that_differs_is_not_right_whatever_the_checks_say() {
        let [square, fourth] = COURSE.exercises else { unreachable!() };
        let said = |exercise, subject| check(&COURSE, exercise, subject, false);
        let (text, is_right) = said(square, COURSE.reference);
        assert!(is_right && text.contains("Compare with ours: "), "{text}");
        // Wrong in two pixels of its picture, which no check looks at.
        let almost: fn(u32) -> u32 = |x| if x == 40 || x == 41 { 0 } else { x * x };
        let subject = Subject { square: almost, ..COURSE.reference };
        let (text, is_right) = said(square, subject);
        assert!(!is_right && text.contains("✗ its picture"), "{text}");
        assert_eq!(status(&COURSE, square, subject), ("wrong\n".to_owned(), false));
        assert!(text.contains("2 of 64 pixels differ"), "{text}");
        // The same where another exercise's function is to blame, which its own check catches.
        let wrong: fn(u32) -> u32 = |x| 2 * x;
        let (text, is_right) = said(fourth, Subject { square: wrong, ..COURSE.reference });
        assert!(is_right, "{text}");
        assert!(text.contains("It calls your E9.1, which is not right"), "{text}");
    }
}
