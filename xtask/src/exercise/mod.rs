//! The exercises as a student meets them: their folder, their program, and what both say.

mod build;
mod catalogue;
mod keys;
mod process;
mod solution;
mod student;
mod verify;
mod watch;
mod words;
mod workspace;

use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::Subcommand;
use lancer_exercise::{Card, Solution};

use crate::repository::root;
use build::shown;
use catalogue::{Entry, entries, find};
use solution::line_of;
use student::{Checked, State, Student};
use words::{say_report, say_wrapped};
use workspace::Workspace;

/// Exercises: you write the functions of a ray tracer, one at a time, and see what they draw.
///
/// Your files are in the folder work, which git ignores. ID is E1.6, 1.6 or reflected-ray; without it, the
/// first exercise that does not pass yet is meant.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  cargo xtask exercise start      makes your file of the first exercise
  cargo xtask exercise check      says whether your answer is right, and where it is not
  cargo xtask exercise watch      the same after each change
  cargo xtask exercise hint       an idea; -n 2 the formula; -n 3 almost the code
  cargo xtask exercise show       your picture beside the course's")]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

/// An exercise.
#[derive(clap::Args)]
struct Choice {
    /// An exercise: E1.6, 1.6 or reflected-ray
    id: Option<String>,
}

#[derive(Subcommand)]
enum Action {
    /// All exercises and how far you are
    List,
    /// Makes your file of an exercise and says what to do in it
    Start(Choice),
    /// Starts the first exercise that does not pass yet
    Next,
    /// Compiles your file and runs the checks; succeeds if all pass
    Check {
        #[command(flatten)]
        choice: Choice,
        /// Goes on after the first check that fails
        #[arg(long)]
        all: bool,
    },
    /// Checks after each change, until Ctrl-C; at a terminal, single keys do the rest
    Watch(Choice),
    /// Helps: with the idea, the formula, or almost the code
    Hint {
        #[command(flatten)]
        choice: Choice,
        /// Which of the three
        #[arg(short, default_value_t = 1, value_name = "1|2|3", value_parser = clap::value_parser!(u8).range(1..=3))]
        n: u8,
    },
    /// Draws your picture beside the course's; succeeds if they are the same
    Show {
        #[command(flatten)]
        choice: Choice,
        /// Opens the picture in the system's viewer
        #[arg(long)]
        open: bool,
    },
    /// Prints our answer, and where the course's own code does the same
    Solution(Choice),
    /// Puts the stub back; your file is kept as .bak
    Reset {
        /// An exercise: E1.6, 1.6 or reflected-ray
        id: String,
    },
    /// For maintainers: proves that the checks pass right answers and catch every known slip
    Verify,
}

pub fn run(args: &Args) -> Result<ExitCode> {
    match &args.action {
        Action::List => list(&mut Student::open()?)?,
        Action::Start(choice) => start(choice)?,
        Action::Next => start(&Choice { id: None })?,
        Action::Check { choice, all } => {
            let chosen = choice.id.as_deref().map(find).transpose()?;
            let mut student = Student::open()?;
            let checked = student.check(chosen, *all)?;
            let code = report(&checked);
            if checked.passes {
                say_next(student.first_not_passing()?.as_ref());
            }
            return Ok(code);
        }
        Action::Watch(choice) => {
            watch::watch(choice.id.as_deref().map(find).transpose()?)?;
        }
        Action::Hint { choice, n } => hint(choice, usize::from(*n))?,
        Action::Show { choice, open } => {
            let mut student = Student::open()?;
            let Some(entry) = chosen(choice, &mut student)? else { return Ok(ExitCode::SUCCESS) };
            let shown = student.show(&entry)?;
            if *open {
                open_picture(&student.workspace().figure(&entry));
            }
            return Ok(report(&shown));
        }
        Action::Solution(choice) => solution(choice)?,
        Action::Reset { id } => reset(id)?,
        Action::Verify => verify::verify()?,
    }
    Ok(ExitCode::SUCCESS)
}

/// A machine without a viewer, or without a screen, still has the file.
fn open_picture(picture: &Path) {
    if picture.exists()
        && let Err(error) = open::that_detached(picture)
    {
        eprintln!("warning: cannot open {}: {error}", shown(picture));
    }
}

fn report(checked: &Checked) -> ExitCode {
    say_report(&checked.text);
    if checked.passes { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Says what to do after an exercise has passed.
fn say_next(next: Option<&Entry>) {
    match next {
        Some(next) => say_wrapped(&format!(
            "Next: {}, cargo xtask exercise start {}",
            next.title(),
            next.card.name
        )),
        None => say!("All exercises pass."),
    }
}

/// The exercise that is meant; if all pass, says so and returns none.
fn chosen(choice: &Choice, student: &mut Student) -> Result<Option<Entry>> {
    if let Some(id) = &choice.id {
        return find(id).map(Some);
    }
    let first = student.first_not_passing()?;
    if first.is_none() {
        say!("All exercises pass. Name one to look at it again: cargo xtask exercise list");
    }
    Ok(first)
}

fn list(student: &mut Student) -> Result<()> {
    let next = student.first_not_passing()?.map(|entry| entry.card.id);
    let entries = entries();
    let longest = |of: fn(&Card) -> &'static str| {
        entries.iter().map(|entry| of(&entry.card).chars().count()).max().unwrap_or(0)
    };
    let (name, title) = (longest(|card| card.name), longest(|card| card.title));
    for entry in &entries {
        let state = student.state(entry)?;
        let card = entry.card;
        let mark = if next == Some(card.id) { "→" } else { " " };
        say!(
            "{mark} {:<5} {:<name$} {:<title$} {:>3} min  {}",
            card.id,
            card.name,
            card.title,
            card.minutes,
            state.name()
        );
    }
    Ok(())
}

fn start(choice: &Choice) -> Result<()> {
    let mut student = Student::open()?;
    if let Some(entry) = chosen(choice, &mut student)? {
        say_wrapped(&student.start(&entry)?);
    }
    Ok(())
}

fn hint(choice: &Choice, n: usize) -> Result<()> {
    if let Some(entry) = chosen(choice, &mut Student::open()?)? {
        say_hint(&entry, n);
    }
    Ok(())
}

/// Says the n-th hint, from 1.
fn say_hint(entry: &Entry, n: usize) {
    let card = entry.card;
    say_wrapped(&format!("{}, hint {n} of 3: {}", entry.title(), card.hints[n - 1]));
    match n {
        3 => say!("The answer: cargo xtask exercise solution {}", card.name),
        _ => say!("More: cargo xtask exercise hint {} -n {}", card.name, n + 1),
    }
}

fn solution(choice: &Choice) -> Result<()> {
    let mut student = Student::open()?;
    match chosen(choice, &mut student)? {
        Some(entry) => say_solution(&mut student, &entry),
        None => Ok(()),
    }
}

fn say_solution(student: &mut Student, entry: &Entry) -> Result<()> {
    let Solution { answer, file, item, notice } = entry.card.solution;
    let source = std::fs::read_to_string(root().join(file))
        .with_context(|| format!("cannot read {file}"))?;
    let line = line_of(&source, item).with_context(|| format!("there is no `{item}` in {file}"))?;
    let path = shown(&student.workspace().path(entry));
    match student.state(entry)? {
        State::Passing => say!("{}: yours is in {path}", entry.title()),
        State::New => say!("{}: you have not begun this one", entry.title()),
        _ => say!("{}: yours, in {path}, does not pass yet", entry.title()),
    }
    say!("Ours, a whole file that could stand in its place:\n\n{answer}");
    say_wrapped(&format!("The course's own code: {file}:{line}, `{item}`"));
    say_wrapped(&format!("Notice: {notice}"));
    Ok(())
}

fn reset(id: &str) -> Result<()> {
    let entry = find(id)?;
    let workspace = Workspace::open()?;
    let kept = workspace.reset(&entry)?;
    say!("{}: the stub is in {}", entry.title(), shown(&workspace.path(&entry)));
    if let Some(kept) = kept {
        say!("Your file is kept as {}", shown(&kept));
    }
    Ok(())
}
