//! What a student has done so far, found out by running it.

use std::fmt::Write;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};

use super::build::{Broken, build, shown};
use super::catalogue::{Chapter, Entry, entries};
use super::process::{Answer, ask};
use super::words::wrapped;
use super::workspace::{Started, Workspace};

/// Where a student stands with an exercise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// There is no file of theirs.
    New,
    /// A function is still to be written.
    Started,
    /// A check fails.
    Wrong,
    /// All checks pass.
    Passing,
    /// The file does not compile.
    Broken,
    /// It cannot be run, since something else does not compile.
    Unknown,
}

impl State {
    /// A word or two for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::New => "new",
            Self::Started => "started",
            Self::Wrong => "wrong",
            Self::Passing => "passing",
            Self::Broken => "does not compile",
            Self::Unknown => "unknown",
        }
    }
}

/// What came out of a check.
pub struct Checked {
    /// What was checked.
    pub entry: Entry,
    /// To be read by the student: wrapped, but for code.
    pub text: String,
    /// Whether the answer is right.
    pub passes: bool,
}

/// A student's folder and the programs made of it.
pub struct Student {
    workspace: Workspace,
    programs: Vec<(Chapter, Result<PathBuf, Vec<Broken>>)>,
}

impl Student {
    /// Opens the folder and makes what is generated in it.
    ///
    /// # Errors
    /// If it is no folder or cannot be written.
    pub fn open() -> Result<Self> {
        let workspace = Workspace::open()?;
        workspace.refresh()?;
        Ok(Self { workspace, programs: Vec::new() })
    }

    /// The folder.
    pub fn workspace(&self) -> &Workspace {
        &self.workspace
    }

    /// A chapter's program, compiled once.
    fn program(&mut self, chapter: Chapter) -> Result<&Result<PathBuf, Vec<Broken>>> {
        let known = self.programs.iter().position(|(known, _)| *known == chapter);
        let index = match known {
            Some(index) => index,
            None => {
                let started = self.workspace.started();
                let started: Vec<Entry> =
                    started.into_iter().filter(|entry| entry.chapter == chapter).collect();
                self.programs.push((chapter, build(&self.workspace, chapter, &started)?));
                self.programs.len() - 1
            }
        };
        Ok(&self.programs[index].1)
    }

    /// How far an exercise is.
    ///
    /// # Errors
    /// If nothing can be compiled or run at all.
    pub fn state(&mut self, entry: &Entry) -> Result<State> {
        if !self.workspace.is_started(entry) {
            return Ok(State::New);
        }
        let name = entry.card.name;
        Ok(match self.program(entry.chapter)? {
            Err(broken) if broken.iter().any(|broken| broken.exercise == Some(name)) => {
                State::Broken
            }
            Err(_) => State::Unknown,
            Ok(program) => match ask(program, &["status", name])?.text.lines().last() {
                Some("passing") => State::Passing,
                Some("unwritten") => State::Started,
                // It may have crashed.
                _ => State::Wrong,
            },
        })
    }

    /// The first exercise, in the course's order, that is not passing; where the files do not compile, the
    /// first that is the cause.
    ///
    /// # Errors
    /// As [`Student::state`].
    pub fn first_not_passing(&mut self) -> Result<Option<Entry>> {
        let mut unknown = None;
        for entry in entries() {
            match self.state(&entry)? {
                State::Passing => {}
                State::Unknown => unknown = unknown.or(Some(entry)),
                State::New if unknown.is_some() => {}
                _ => return Ok(Some(entry)),
            }
        }
        Ok(unknown)
    }

    /// Runs the checks of one exercise. Without one: of the first begun that does not pass, or if all do, of
    /// the last that was edited.
    ///
    /// # Errors
    /// If there is nothing to check, or nothing can be compiled or run at all.
    pub fn check(&mut self, entry: Option<Entry>, all: bool) -> Result<Checked> {
        if let Some(entry) = entry {
            self.require_started(Some(&entry))?;
            return self.check_one(&entry, all);
        }
        self.require_started(None)?;
        let started = self.workspace.started();
        let mut last_edited = None;
        let mut passing = Vec::new();
        for entry in &started {
            let mut checked = self.check_one(entry, all)?;
            if !checked.passes {
                // Whoever has just mended one waits for a word about it, not about the next.
                if !passing.is_empty() {
                    checked.text.insert_str(0, &format!("Right: {}\n", passing.join(", ")));
                }
                return Ok(checked);
            }
            passing.push(entry.card.id);
            let edited = self.workspace.edited(entry);
            if last_edited.as_ref().is_none_or(|(latest, _)| *latest <= edited) {
                last_edited = Some((edited, checked));
            }
        }
        last_edited.map(|(_, checked)| checked).context("the files of the exercises are gone")
    }

    /// Refuses an exercise that the student has no file for, and if none is named, to have none at all.
    ///
    /// # Errors
    /// If there is none.
    pub fn require_started(&self, entry: Option<&Entry>) -> Result<()> {
        match entry {
            None if self.workspace.started().is_empty() => {
                bail!("no exercise is begun; begin with: cargo xtask exercise start")
            }
            Some(entry) if !self.workspace.is_started(entry) => bail!(
                "{}: there is no file {}; make it with: cargo xtask exercise start {}",
                entry.title(),
                shown(&self.workspace.path(entry)),
                entry.card.name
            ),
            _ => Ok(()),
        }
    }

    fn check_one(&mut self, entry: &Entry, all: bool) -> Result<Checked> {
        let name = entry.card.name;
        let how = if all { "check-all" } else { "check" };
        self.ask(entry, &[how, name])
    }

    /// How many exercises pass, and of how many.
    ///
    /// # Errors
    /// As [`Student::state`].
    pub fn progress(&mut self) -> Result<(usize, usize)> {
        let entries = entries();
        let mut done = 0;
        for entry in &entries {
            done += usize::from(self.state(entry)? == State::Passing);
        }
        Ok((done, entries.len()))
    }

    /// Draws an exercise's picture.
    ///
    /// # Errors
    /// If the student has not begun, or nothing can be compiled or run at all.
    pub fn show(&mut self, entry: &Entry) -> Result<Checked> {
        self.require_started(Some(entry))?;
        let figure = self.workspace.figure(entry);
        if let Some(folder) = figure.parent() {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        }
        self.ask(entry, &["show", entry.card.name, &shown(&figure)])
    }

    /// What the chapter's program says, or why there is none.
    fn ask(&mut self, entry: &Entry, arguments: &[&str]) -> Result<Checked> {
        let name = entry.card.name;
        Ok(match self.program(entry.chapter)? {
            Ok(program) => {
                let Answer { mut text, is_right, is_crash } = ask(program, arguments)?;
                if is_crash {
                    text = format!("{}: {}\n{text}", entry.title(), entry.card.title);
                }
                Checked { entry: *entry, text: wrapped(&text), passes: is_right }
            }
            Err(broken) => {
                let own = broken.iter().find(|broken| broken.exercise == Some(name));
                let text = match (own, broken.first()) {
                    (Some(own), _) => own.message.clone(),
                    (None, Some(Broken { exercise: Some(_), message })) => format!(
                        "All your files are one program, and another one's file is in the way.\n{message}"
                    ),
                    (None, other) => other.map(|other| other.message.clone()).unwrap_or_default(),
                };
                Checked { entry: *entry, text, passes: false }
            }
        })
    }

    /// Makes an exercise's file and says what to do.
    ///
    /// # Errors
    /// If the folder cannot be written.
    pub fn start(&self, entry: &Entry) -> Result<String> {
        let started = self.workspace.start(entry)?;
        let card = entry.card;
        let mut text =
            format!("{}: {} (about {} minutes)\n", entry.title(), card.title, card.minutes);
        let file = shown(&self.workspace.path(entry));
        let rows = [
            ("Slide", format!("« {} »", card.slide)),
            ("Lesson", entry.lesson()),
            ("Predict", card.predict.to_owned()),
            ("Write", format!("{} in {file}", card.functions.join(" and "))),
            ("Then", format!("cargo xtask exercise check {0}, or watch {0}", card.name)),
        ];
        for (word, content) in rows {
            let _ = writeln!(text, "  {word:<8} {content}");
        }
        text.push_str(&match started {
            Started::New => String::new(),
            Started::Kept => format!("Your file stays as it is: {file}\n"),
            Started::Renewed => format!("Its stub is a new one, as you had not touched it: {file}\n"),
            Started::StubChanged => format!(
                "Your file stays as it is: {file}\nThe course's stub has changed since you began; compare {}\n",
                entry.stub_path()
            ),
        });
        Ok(text)
    }
}
