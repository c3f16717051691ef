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
            Self::Broken => "not compiling",
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
    /// What the programs have said of the exercises, by their names.
    states: Vec<(&'static str, State)>,
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
        Ok(Self { workspace, states: Vec::new(), programs: Vec::new() })
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
        if let Some((_, state)) = self.states.iter().find(|(known, _)| *known == name) {
            return Ok(*state);
        }
        let program = match self.program(entry.chapter)? {
            Ok(program) => program.clone(),
            Err(broken) if broken.iter().any(|broken| broken.exercise == Some(name)) => {
                return Ok(State::Broken);
            }
            Err(_) => return Ok(State::Unknown),
        };
        // One run judges all of a chapter; where it crashes, it says nothing of the rest.
        let is_unknown = |name: &&str| !self.states.iter().any(|(known, _)| known == name);
        let started = self.workspace.started().into_iter();
        let of_chapter = started.filter(|other| other.chapter == entry.chapter);
        let names: Vec<&str> = of_chapter.map(|other| other.card.name).filter(is_unknown).collect();
        for asked in [&names[..], &[name]] {
            let answer = ask(&program, &[&["status"], asked].concat())?;
            self.states.extend(states(&answer.text, asked));
            if let Some((_, state)) = self.states.iter().find(|(known, _)| *known == name) {
                return Ok(*state);
            }
        }
        self.states.push((name, State::Wrong));
        Ok(State::Wrong)
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
        let mut passing = Vec::new();
        for entry in &started {
            if self.state(entry)? != State::Passing {
                let mut checked = self.check_one(entry, all)?;
                // Whoever has just mended one waits for a word about it, not about the next.
                if !passing.is_empty() {
                    checked.text.insert_str(0, &format!("Right: {}\n", passing.join(", ")));
                }
                return Ok(checked);
            }
            passing.push(entry.card.id);
        }
        let last = started.into_iter().max_by_key(|entry| self.workspace.edited(entry));
        self.check_one(&last.context("the files of the exercises are gone")?, all)
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
        // A picture that is there is the one of these functions.
        let _ = std::fs::remove_file(&figure);
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

/// What a program says of the exercises that it was asked for, in lines `state NAME STATE`; a student's own words may
/// stand between them.
fn states(text: &str, asked: &[&'static str]) -> Vec<(&'static str, State)> {
    let state = |line: &str| {
        let (name, word) = line.strip_prefix("state ")?.split_once(' ')?;
        let name = asked.iter().find(|asked| **asked == name)?;
        let state = match word {
            "passing" => State::Passing,
            "unwritten" => State::Started,
            "wrong" => State::Wrong,
            _ => return None,
        };
        Some((*name, state))
    };
    text.lines().filter_map(state).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_stand_among_a_students_own_words() {
        let text = "x = 3\nstate a passing\nstate of things\nstate c passing\nstate b unwritten\nA process …\n";
        let found = states(text, &["a", "b"]);
        assert_eq!(found, [("a", State::Passing), ("b", State::Started)]);
    }
}
