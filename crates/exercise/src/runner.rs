//! The program of a student's workspace: their functions against the checks.

use std::fmt::Write;
use std::panic::PanicHookInfo;
use std::path::Path;
use std::process::exit;
use std::sync::Mutex;

use lancer_core::image::write_atomically;

use crate::judge::{LIMIT, Outcome, drawn_beside, guarded, judge_picture};
use crate::{Card, Course, Exercise, Failure, Report, State};

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

/// Does what the arguments say: `status NAME…`, `check NAME`, `check-all NAME` or `show NAME FILE.png`.
///
/// `status` prints a line `state NAME STATE` for each exercise as soon as it is judged, with the name of its
/// [`State`]; the exit code is 0. `check` stops at the first failing check, `check-all` shows every one; there and
/// for `show` the exit code is 0 for a right answer and 1 for any other. It is 2 for arguments that are none. Ends the
/// program, since a function that does not come back cannot be stopped otherwise.
pub fn run<S: Copy + Send + Sync + 'static>(course: &'static Course<S>, subject: S) -> ! {
    // What a panic says goes into the report, not before it.
    std::panic::set_hook(Box::new(remember));
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let named = |name: &str| course.exercises.iter().find(|exercise| exercise.card.name == name);
    let answer = match arguments[..] {
        ["status", first, ref others @ ..] => {
            let names = [first].into_iter().chain(others.iter().copied());
            names.map(named).collect::<Option<Vec<_>>>().map(|exercises| {
                for exercise in exercises {
                    print!("{}", status(exercise, subject, course.reference));
                }
                (String::new(), true)
            })
        }
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

/// The line of an exercise's state. It begins with a line's end: the student's functions may have printed without one.
fn status<S: Copy + Send>(exercise: &Exercise<S>, subject: S, reference: S) -> String {
    let state = Report::of(exercise, subject, reference).state();
    format!("\nstate {} {}\n", exercise.card.name, state.name())
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
    let called = (report.state() != State::Unwritten)
        .then(|| first_wrong(course, subject, |other| card.calls(other)))
        .flatten();
    if let Some(Card { id, name, .. }) = called {
        line(
            &mut text,
            format_args!(
                "\nIt calls your {id}, which is not right: cargo xtask exercise check {name}"
            ),
        );
    }
    if report.state() == State::Passing
        && let Some(other) = spoiling(course, exercise, subject)
        && called.is_none_or(|called| called.name != other.card.name)
    {
        line(&mut text, format_args!("\n{}", needed(course, exercise, other, subject)));
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

/// The other exercise whose functions make the picture of one that is right wrong: the first with which it is, when
/// they join those of the exercise and of the ones before.
fn spoiling<'a, S: Copy + Send>(
    course: &'a Course<S>,
    exercise: &Exercise<S>,
    subject: S,
) -> Option<&'a Exercise<S>> {
    let reference = (exercise.draw)(&course.reference);
    let is_wrong = |subject| judge_picture(exercise, subject, &reference) != Outcome::Passed;
    if !is_wrong(subject) {
        return None;
    }
    let mut joined = (exercise.own)(subject, course.reference);
    course.exercises.iter().find(|other| {
        joined = (other.own)(subject, joined);
        other.card.name != exercise.card.name && is_wrong(joined)
    })
}

/// What is said of the exercise that spoils another one's picture. Its own checks and picture may not know of it.
fn needed<S: Copy + Send>(
    course: &Course<S>,
    exercise: &Exercise<S>,
    other: &Exercise<S>,
    subject: S,
) -> String {
    let Card { id, name, .. } = other.card;
    let (is_wrong, command) = match Report::of(other, subject, course.reference).state() {
        State::Passing => {
            ("passes its own checks but is wrong there", format!("show {}", exercise.card.name))
        }
        _ => ("is not right", format!("check {name}")),
    };
    format!("Its picture needs your {id} too, which {is_wrong}: cargo xtask exercise {command}")
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
            let limit = LIMIT.as_secs();
            line(
                text,
                format_args!(
                    "      your function did not come back within {limit} seconds: does its loop end, or its recursion?"
                ),
            );
        }
    }
}

fn show<S: Copy + Send>(
    course: &Course<S>,
    exercise: &Exercise<S>,
    subject: S,
    file: &str,
) -> (String, bool) {
    let mut text = title(&exercise.card);
    let (said, png, is_right) = match compared(course, exercise, subject) {
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
    if !is_right
        && Report::of(exercise, subject, course.reference).state() == State::Passing
        && let Some(other) = spoiling(course, exercise, subject)
    {
        line(&mut text, format_args!("{}", needed(course, exercise, other, subject)));
    }
    line(&mut text, format_args!("The plate is in {file}"));
    (text, is_right)
}

/// What there is to say about the subject's picture, the plate as a PNG file, and whether the picture is right.
fn compared<S: Copy + Send>(
    course: &Course<S>,
    exercise: &Exercise<S>,
    subject: S,
) -> Result<(String, Vec<u8>, bool), Failure> {
    let reference = course.reference;
    let comparison = drawn_beside(exercise, subject, &(exercise.draw)(&reference))?;
    let mut said = comparison.plate.claim().to_owned();
    if let Some((explain, pixel)) = exercise.explain.zip(comparison.worst) {
        let theirs = guarded("the pixel", LIMIT, move || explain(&subject, pixel))?;
        let ours = explain(&reference, pixel);
        said += &format!("\nThe reference there:\n{ours}\nYours there:\n{theirs}");
    }
    Ok((said, comparison.plate.canvas().to_png(1.0), comparison.worst.is_none()))
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
        half: fn(u32) -> u32,
    }

    const fn card(
        id: &'static str,
        name: &'static str,
        functions: &'static [&'static str],
        stub: &'static str,
    ) -> Card {
        let solution = Solution { answer: "", file: "", item: "", notice: "" };
        Card {
            id,
            name,
            title: "",
            slide: "",
            stub,
            functions,
            minutes: 1,
            predict: "",
            vary: "",
            hints: [""; 3],
            solution,
        }
    }

    /// 64 × 48 pixels, the columns of which are the numbers from 0.
    fn columns(function: impl Fn(u32) -> u32) -> Image {
        let pixels = (0..48 * 64).map(|pixel| [function(pixel % 64) as f32; 3]).collect();
        Image::from_pixels(ImageSize::new(64, 48), pixels)
    }

    /// The file of the second calls the first, and the picture of the third shows the first.
    static COURSE: Course<Subject> = Course {
        package: "chapter-9",
        exercises: &[
            Exercise {
                card: card("E9.1", "square", &["square"], ""),
                checks: &[Check {
                    name: "3 squared",
                    run: |subject| same(String::new, &(subject.square)(3), &9),
                }],
                slips: &[],
                own: |yours, reference| Subject { square: yours.square, ..reference },
                draw: |subject| columns(subject.square),
                explain: None,
            },
            Exercise {
                card: card("E9.2", "fourth", &["fourth"], "use crate::yours::square;\n"),
                checks: &[Check {
                    name: "1 to the fourth",
                    run: |subject| same(String::new, &(subject.fourth)(1), &1),
                }],
                slips: &[],
                own: |yours, reference| Subject { fourth: yours.fourth, ..reference },
                draw: |subject| columns(|x| (subject.fourth)((subject.square)(x) % 100)),
                explain: None,
            },
            Exercise {
                card: card("E9.3", "half", &["half"], ""),
                checks: &[Check {
                    name: "half of 8",
                    run: |subject| same(String::new, &(subject.half)(8), &4),
                }],
                slips: &[],
                own: |yours, reference| Subject { half: yours.half, ..reference },
                draw: |subject| columns(|x| (subject.half)((subject.square)(x + 1))),
                explain: None,
            },
        ],
        reference: RIGHT,
    };
    const RIGHT: Subject =
        Subject { square: |x| x * x, fourth: |x| x * x * x * x, half: |x| x / 2 };

    /// Wrong in two columns of its picture, which no check looks at.
    const ALMOST: fn(u32) -> u32 = |x| if x == 40 || x == 41 { 0 } else { x * x };
    const WRONG: fn(u32) -> u32 = |x| 2 * x + 1;

    /// What `check`, `status` and `show` say of an exercise, and whether the first and the last say that it is right.
    fn said(name: &str, subject: Subject) -> ((String, bool), String, (String, bool)) {
        let exercise = COURSE.exercises.iter().find(|exercise| exercise.card.name == name).unwrap();
        let file = format!("lancer-show-{name}-{:?}.png", std::thread::current().id());
        let file = std::env::temp_dir().join(file);
        let shown = show(&COURSE, exercise, subject, &file.to_string_lossy());
        std::fs::remove_file(file).unwrap();
        let checked = check(&COURSE, exercise, subject, false);
        (checked, status(exercise, subject, COURSE.reference), shown)
    }

    #[test]
    fn a_right_answer_is_right() {
        let ((checked, is_right), state, (shown, is_shown_right)) = said("square", RIGHT);
        assert!(is_right && checked.contains("Compare with ours: "), "{checked}");
        assert_eq!(state, "\nstate square passing\n");
        assert!(is_shown_right && shown.contains("Your picture is the reference's."), "{shown}");
    }

    #[test]
    fn a_picture_that_differs_is_wrong_whatever_unrelated_exercises_are_like() {
        let square = ALMOST;
        // What `todo!()` says.
        let unwritten: fn(u32) -> u32 = |_| panic!("not yet implemented");
        for half in [RIGHT.half, WRONG, unwritten] {
            let ((checked, is_right), state, (shown, is_shown_right)) =
                said("square", Subject { square, half, ..RIGHT });
            assert!(!is_right && checked.contains("✗ its picture"), "{checked}");
            assert!(checked.contains("96 of 3072 pixels differ"), "{checked}");
            assert_eq!(state, "\nstate square wrong\n");
            assert!(!is_shown_right && shown.contains("96 of 3072 pixels differ"), "{shown}");
            assert!(!shown.contains("needs"), "{shown}");
        }
    }

    /// `check` and `show` name it, whether its own checks and picture know of it or not.
    #[test]
    fn a_picture_that_another_exercise_spoils_is_put_down_to_it() {
        for square in [ALMOST, WRONG] {
            let subject = Subject { square, ..RIGHT };
            let ((checked, is_right), state, (shown, is_shown_right)) = said("half", subject);
            let needed = "Its picture needs your E9.1 too, which is not right: cargo xtask exercise check square";
            assert!(is_right && checked.contains(needed), "{checked}");
            assert_eq!(state, "\nstate half passing\n");
            assert!(!is_shown_right && shown.contains(needed), "{shown}");
            let ((checked, is_right), ..) = said("fourth", subject);
            assert!(is_right, "{checked}");
            assert!(checked.contains("It calls your E9.1, which is not right"), "{checked}");
            assert!(!checked.contains("needs"), "{checked}");
        }
        let square: fn(u32) -> u32 = |x| if x == 64 { 0 } else { x * x };
        let subject = Subject { square, ..RIGHT };
        let ((checked, _), _, (shown, _)) = said("half", subject);
        let needed = "Its picture needs your E9.1 too, which passes its own checks but is wrong there: \
                      cargo xtask exercise show half";
        assert!(checked.contains(needed) && shown.contains(needed), "{checked}{shown}");
        let ((checked, is_right), ..) = said("square", subject);
        assert!(is_right, "{checked}");
    }
}
