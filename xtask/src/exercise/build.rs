//! Compiles a chapter's program of the student's functions, and says in the student's terms what is wrong
//! with them.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use serde_json::Value;

use super::catalogue::{Chapter, Entry};
use super::process::{Limits, run};
use super::words::wrapped;
use super::workspace::{Workspace, package};
use crate::repository::root;

/// Why a program could not be compiled.
#[derive(Debug)]
pub struct Broken {
    /// The exercise whose file is the cause, if it is one's.
    pub exercise: Option<&'static str>,
    /// What the student should know.
    pub message: String,
}

/// Compiles a chapter's program; returns where it is, or what is broken.
///
/// The program is a member of the course's own workspace, compiled with its profile and, since `xtask` is
/// asked for as well, with its features: all that it depends on is compiled already.
///
/// # Errors
/// If cargo cannot be started, or the student's files cannot be read.
pub fn build(
    workspace: &Workspace,
    chapter: Chapter,
    started: &[Entry],
) -> Result<Result<PathBuf, Vec<Broken>>> {
    let package = package(chapter);
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .args(["build", "--message-format=json-diagnostic-rendered-ansi"])
        .args(["--package", "xtask", "--package", "lancer-student"])
        .args(["--features", "lancer-student/begun", "--bin", &package])
        // As this program itself was.
        .args(["--profile", if cfg!(debug_assertions) { "dev" } else { "release" }])
        .env("LANCER_PROGRAM", workspace.sources(chapter).join("main.rs"))
        .env("LANCER_CONTENTS", workspace.contents(chapter).to_string())
        .current_dir(root());
    let ended = run(&mut cargo, Limits::OF_CARGO).context("cannot start cargo")?;
    let messages: Vec<Value> =
        ended.out.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    if ended.status.is_some_and(|status| status.success()) {
        let own = |message: &&Value| message["target"]["name"] == package.as_str();
        let program =
            messages.iter().filter(own).find_map(|message| message["executable"].as_str());
        return Ok(Ok(program.map(PathBuf::from).context("cargo has made no program")?));
    }
    let mut broken = explain(&messages, started, &workspace.sources(chapter));
    if broken.is_empty() {
        let message = format!("Cargo could not compile your folder:\n{}", ended.err.trim_end());
        broken.push(Broken { exercise: None, message });
    }
    Ok(Err(broken))
}

/// The compiler's errors by the student's files, in the exercises' order.
fn explain(messages: &[Value], started: &[Entry], sources: &Path) -> Vec<Broken> {
    let errors: Vec<&Value> = messages
        .iter()
        .map(|message| &message["message"])
        .filter(|message| message["level"] == "error")
        .collect();
    let rendered = |error: &Value| {
        let text = error["rendered"].as_str().unwrap_or_default();
        text.replace(&*sources.to_string_lossy(), &shown(sources))
    };
    let of_file = |entry: &Entry| -> Vec<&Value> {
        let file = sources.join(entry.card.file());
        let is_there = |error: &&&Value| places(error).any(|(path, _)| Path::new(path) == file);
        errors.iter().filter(is_there).copied().collect()
    };
    // A file without errors may still lack what the program and other files look for in it.
    let unfit: Vec<Unfit> = started
        .iter()
        .filter(|entry| of_file(entry).is_empty())
        .filter_map(|entry| Unfit::find(&errors, entry))
        .collect();
    let follows = |error: &Value| {
        let is_named = |line| unfit.iter().any(|unfit| names(line, unfit.function));
        places(error).any(|(_, line)| is_named(line))
    };
    let mut broken = Vec::new();
    for entry in started {
        let own: String = of_file(entry)
            .iter()
            .filter(|error| !follows(error))
            .map(|error| rendered(error))
            .collect();
        if !own.is_empty() {
            let path = shown(&sources.join(entry.card.file()));
            let message =
                format!("{} does not compile: {path}\n\n{}", entry.title(), own.trim_end());
            broken.push(Broken { exercise: Some(entry.card.name), message });
        }
        broken.extend(
            unfit
                .iter()
                .filter(|unfit| unfit.entry.card.id == entry.card.id)
                .map(|unfit| unfit.broken(sources)),
        );
    }
    if broken.is_empty() && !errors.is_empty() {
        let all: String = errors.iter().map(|error| rendered(error)).collect();
        let message = format!("Your folder does not compile:\n\n{}", all.trim_end());
        broken.push(Broken { exercise: None, message });
    }
    broken
}

/// A function that is not there, or not as the program needs it.
struct Unfit<'a> {
    entry: &'a Entry,
    function: &'static str,
    code: &'a str,
}

impl<'a> Unfit<'a> {
    /// The first of an exercise's functions over which the generated program stumbles.
    fn find(errors: &[&'a Value], entry: &'a Entry) -> Option<Self> {
        entry.card.functions.iter().find_map(|function| {
            let error = errors.iter().find(|error| {
                places(error).any(|(path, line)| path.ends_with("main.rs") && names(line, function))
            })?;
            Some(Self { entry, function, code: error["code"]["code"].as_str().unwrap_or_default() })
        })
    }

    fn broken(&self, sources: &Path) -> Broken {
        let Self { entry, function, code } = self;
        let file = shown(&sources.join(entry.card.file()));
        let problem = match *code {
            "E0432" => format!("{file} has no function `{function}`; is it called otherwise?"),
            "E0603" | "E0364" => {
                format!("`{function}` in {file} is private to that file; write `pub` before it")
            }
            _ => format!("`{function}` in {file} takes or returns other types than it should"),
        };
        let message = format!(
            "{}\nIt should begin with:\n\n    {}",
            wrapped(&format!("{}: {problem}", entry.title())),
            entry.signature(function)
        );
        Broken { exercise: Some(entry.card.name), message }
    }
}

/// Whether a line of code has that name in it.
fn names(line: &str, function: &str) -> bool {
    line.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|word| word == function)
}

/// Files and lines that an error points at, in a macro also where that is used.
fn places(error: &Value) -> impl Iterator<Item = (&str, &str)> {
    let spans = error["spans"].as_array().into_iter().flatten();
    let primary = spans.filter(|span| span["is_primary"] == true);
    let outwards = primary.flat_map(|span| {
        std::iter::successors(Some(span), |span| {
            Some(&span["expansion"]["span"]).filter(|outer| outer.is_object())
        })
    });
    outwards.map(|span| {
        (
            span["file_name"].as_str().unwrap_or_default(),
            span["text"][0]["text"].as_str().unwrap_or_default(),
        )
    })
}

/// A path as it is short from here.
pub fn shown(path: &Path) -> String {
    let here = env::current_dir().unwrap_or_default();
    path.strip_prefix(here).unwrap_or(path).display().to_string()
}

#[cfg(test)]
mod tests {
    use super::super::catalogue::find;
    use super::*;

    /// An error as cargo passes it on.
    fn error(code: &str, file: &str, line: &str) -> Value {
        serde_json::json!({ "message": {
            "level": "error",
            "code": { "code": code },
            "rendered": format!("error[{code}] --> {file}:1\n"),
            "spans": [{ "is_primary": true, "file_name": file, "text": [{ "text": line }], "expansion": null }],
        }})
    }

    /// Two exercises of one chapter, the second with a function g.
    fn two() -> [Entry; 2] {
        let first = find("reflected-ray").unwrap();
        let mut second = first;
        second.card.id = "E1.99";
        second.card.name = "second";
        second.card.functions = &["g"];
        second.card.stub = "pub fn g(x: f64) -> f64 {\n    todo!()\n}\n";
        [first, second]
    }

    fn explained(errors: &[Value]) -> Vec<Broken> {
        let two = two();
        explain(errors, &two, Path::new("/w/chapter-1/src"))
    }

    #[test]
    fn errors_are_told_by_file_and_what_follows_from_them_is_left_out() {
        let errors = [
            error("E0432", "/w/chapter-1/src/main.rs", "    pub use super::e99_second::g;"),
            error("E0308", "/w/chapter-1/src/e99_second.rs", "    1"),
        ];
        let broken = explained(&errors);
        assert_eq!(broken.len(), 1);
        assert_eq!(broken[0].exercise, Some("second"));
        let wanted = "E1.99 second does not compile: /w/chapter-1/src/e99_second.rs\n\n\
                      error[E0308] --> /w/chapter-1/src/e99_second.rs:1";
        assert_eq!(broken[0].message, wanted);
    }

    #[test]
    fn an_error_inside_a_macro_belongs_to_the_file_that_uses_it() {
        let mut inside = error("E0308", "library/macros.rs", "");
        let outer = error("E0308", "/w/chapter-1/src/e99_second.rs", "    m!()");
        inside["message"]["spans"][0]["expansion"] =
            serde_json::json!({ "span": outer["message"]["spans"][0] });
        assert_eq!(explained(&[inside])[0].exercise, Some("second"));
    }

    #[test]
    fn a_function_that_does_not_fit_is_named_with_its_signature() {
        for (code, line, says) in [
            (
                "E0432",
                "    pub use super::e99_second::g;",
                "has no function `g`; is it called otherwise?",
            ),
            (
                "E0603",
                "    pub use super::e99_second::g;",
                "is private to that file; write `pub` before it",
            ),
            ("E0308", "        g: yours::g,", "takes or returns other types than it should"),
        ] {
            let broken = explained(&[error(code, "/w/chapter-1/src/main.rs", line)]);
            assert_eq!(broken[0].exercise, Some("second"));
            let end = format!("{says} It should begin with:      pub fn g(x: f64) -> f64");
            let message = broken[0].message.replace('\n', " ");
            assert!(message.ends_with(&end), "{message}");
        }
    }

    #[test]
    fn a_function_that_does_not_fit_is_not_blamed_on_its_callers() {
        let errors = [
            error("E0308", "/w/chapter-1/src/e06_reflected_ray.rs", "    crate::yours::g(1)"),
            error("E0308", "/w/chapter-1/src/main.rs", "        g: yours::g,"),
        ];
        let broken = explained(&errors);
        assert_eq!(broken.len(), 1, "{broken:?}");
        assert_eq!(broken[0].exercise, Some("second"));
    }

    #[test]
    fn an_error_elsewhere_is_shown_whole() {
        let broken = explained(&[error("E0308", "elsewhere.rs", "")]);
        assert_eq!(broken[0].exercise, None);
        assert!(broken[0].message.contains("error[E0308] --> elsewhere.rs:1"));
        assert!(explained(&[]).is_empty());
    }
}
