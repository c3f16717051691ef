//! Compiles a chapter's program in the student's folder, runs it, and says in the student's terms why
//! either went wrong.

use std::collections::VecDeque;
use std::env;
use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::Ordering;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use serde_json::Value;

use super::catalogue::{Chapter, Entry};
use super::workspace::{Workspace, package};
use crate::progress::INTERRUPTED;

/// The program stops endless functions itself; this is for what it cannot stop.
const LIMIT: Duration = Duration::from_secs(90);
/// How long to compile without a word.
const PATIENCE: Duration = Duration::from_secs(5);
/// What is kept of an output: its end, in bytes. A loop may print for as long as it runs.
const KEPT: usize = 64 << 10;

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
/// # Errors
/// If cargo cannot be started.
pub fn build(
    workspace: &Workspace,
    chapter: Chapter,
    started: &[Entry],
) -> Result<Result<PathBuf, Vec<Broken>>> {
    let format = if std::io::stdout().is_terminal() {
        "--message-format=json-diagnostic-rendered-ansi"
    } else {
        "--message-format=json"
    };
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .args(["build", "--quiet", format, "--package", &package(chapter), "--target-dir"])
        .arg(workspace.target())
        .current_dir(workspace.folder());
    let ended = run(&mut cargo, None, usize::MAX).context("cannot start cargo")?;
    let messages: Vec<Value> =
        ended.out.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    if ended.status.is_some_and(|status| status.success()) {
        let own = |message: &&Value| message["target"]["name"] == package(chapter).as_str();
        let program =
            messages.iter().filter(own).find_map(|message| message["executable"].as_str());
        return Ok(Ok(program.map(PathBuf::from).context("cargo has made no program")?));
    }
    let sources = workspace.sources(chapter);
    let mut broken = explain(&messages, started, chapter, &sources);
    if broken.is_empty() {
        let message = format!("Cargo could not compile your folder:\n{}", ended.err.trim_end());
        broken.push(Broken { exercise: None, message });
    }
    Ok(Err(broken))
}

/// The compiler's errors by the student's files, in the exercises' order.
fn explain(messages: &[Value], started: &[Entry], chapter: Chapter, sources: &Path) -> Vec<Broken> {
    let errors: Vec<&Value> = messages
        .iter()
        .map(|message| &message["message"])
        .filter(|message| message["level"] == "error")
        .collect();
    // Rustc names files from the folder that cargo compiles in.
    let from = Path::new(chapter.package).join("src");
    let rendered = |error: &Value| {
        let text = error["rendered"].as_str().unwrap_or_default();
        text.replace(&*from.to_string_lossy(), &shown(sources))
    };
    let mut broken = Vec::new();
    for entry in started {
        let file = from.join(entry.card.file());
        let of_file: String = errors
            .iter()
            .filter(|error| places(error).any(|(path, _)| Path::new(path) == file))
            .map(|error| rendered(error))
            .collect();
        if !of_file.is_empty() {
            let path = shown(&sources.join(entry.card.file()));
            let message =
                format!("{} does not compile: {path}\n\n{}", entry.title(), of_file.trim_end());
            broken.push(Broken { exercise: Some(entry.card.name), message });
        }
    }
    // What the files themselves are not to blame for is a function that the program looks for in vain.
    if broken.is_empty() {
        for entry in started {
            broken.extend(missing_function(&errors, entry, sources));
        }
    }
    if broken.is_empty() && !errors.is_empty() {
        let all: String = errors.iter().map(|error| rendered(error)).collect();
        let message = format!("Your folder does not compile:\n\n{}", all.trim_end());
        broken.push(Broken { exercise: None, message });
    }
    broken
}

/// The first of an exercise's functions over which the generated program stumbles.
fn missing_function(errors: &[&Value], entry: &Entry, sources: &Path) -> Option<Broken> {
    let names = |line: &str, function: &str| {
        line.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|word| word == function)
    };
    entry.card.functions.iter().find_map(|function| {
        let error = errors.iter().find(|error| {
            places(error).any(|(path, line)| path.ends_with("main.rs") && names(line, function))
        })?;
        let file = shown(&sources.join(entry.card.file()));
        let problem = match error["code"]["code"].as_str() {
            Some("E0432") => {
                format!("{file} has no function `{function}`; is it called otherwise?")
            }
            Some("E0603" | "E0364") => {
                format!("`{function}` in {file} is private to that file; write `pub` before it")
            }
            _ => format!("`{function}` in {file} takes or returns other types than it should"),
        };
        let message = format!(
            "{}: {problem}\nIt should begin with:\n\n    {}",
            entry.title(),
            entry.signature(function)
        );
        Some(Broken { exercise: Some(entry.card.name), message })
    })
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

/// What a program said, and whether that was a right answer.
pub struct Answer {
    /// All of its output.
    pub text: String,
    /// Whether it ended with success.
    pub is_right: bool,
    /// Whether it ended otherwise than by itself, and says why instead of a report.
    pub is_crash: bool,
}

/// Runs a chapter's program.
///
/// # Errors
/// If it cannot be started.
pub fn ask(program: &Path, arguments: &[&str]) -> Result<Answer> {
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::null());
    let ended = run(&mut command, Some(LIMIT), KEPT).context("cannot start your program")?;
    let trouble = match ended.status {
        None => Some(
            "Your program was stopped after 90 seconds: does every loop end, and every recursion?"
                .to_owned(),
        ),
        Some(status) => match status.code() {
            // The program's own last words come with every answer.
            Some(0 | 1) if ended.out.is_empty() => {
                Some("Your program ended before its checks did: does it call `exit`?".to_owned())
            }
            Some(0 | 1) => None,
            _ => Some(death(&ended.err, status)),
        },
    };
    let is_right = trouble.is_none() && ended.status.is_some_and(|status| status.success());
    let is_crash = trouble.is_some();
    let text = match trouble {
        Some(trouble) => format!("{}{trouble}\n", ended.out),
        // What `dbg!` shows comes first.
        None => ended.err + &ended.out,
    };
    Ok(Answer { text, is_right, is_crash })
}

/// Why a program ended otherwise than by itself.
fn death(err: &str, status: ExitStatus) -> String {
    let Some(at) = err.find("has overflowed its stack") else {
        return format!("{err}Your program ended unexpectedly ({status}).");
    };
    // The thread has the check's name; those that draw have none.
    let check = err[..at].rsplit("thread '").next().and_then(|rest| rest.split('\'').next());
    let check = check.filter(|name| !name.starts_with('<'));
    format!(
        "  ✗ {}\n      your function called itself until the stack was full: does the recursion end?",
        check.unwrap_or("the picture")
    )
}

/// How a process ended.
struct Ended {
    /// None if it was stopped.
    status: Option<ExitStatus>,
    out: String,
    err: String,
}

/// Runs a command up to a limit of time and keeps the end of what it says.
fn run(command: &mut Command, limit: Option<Duration>, kept: usize) -> Result<Ended> {
    let start = Instant::now();
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    let out = child.stdout.take().map(|pipe| collect(pipe, kept));
    let err = child.stderr.take().map(|pipe| collect(pipe, kept));
    let status = wait(&mut child, start, limit)?;
    let text = |thread: Option<JoinHandle<String>>| {
        thread.and_then(|thread| thread.join().ok()).unwrap_or_default()
    };
    Ok(Ended { status, out: text(out), err: text(err) })
}

fn wait(child: &mut Child, start: Instant, limit: Option<Duration>) -> Result<Option<ExitStatus>> {
    let mut is_announced = false;
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        let is_interrupted = INTERRUPTED.load(Ordering::Relaxed);
        if is_interrupted || limit.is_some_and(|limit| start.elapsed() > limit) {
            child.kill()?;
            child.wait()?;
            if is_interrupted {
                bail!("interrupted");
            }
            return Ok(None);
        }
        if limit.is_none() && !is_announced && start.elapsed() > PATIENCE {
            is_announced = true;
            eprintln!(
                "Compiling … The first time, and when the course has changed, this takes minutes."
            );
        }
        thread::sleep(Duration::from_millis(5));
    }
}

/// Reads to the end, in a thread, and keeps the last bytes.
fn collect(mut pipe: impl Read + Send + 'static, kept: usize) -> JoinHandle<String> {
    thread::spawn(move || {
        let mut last = VecDeque::new();
        let mut buffer = [0; 4096];
        let mut is_cut = false;
        while let Ok(count @ 1..) = pipe.read(&mut buffer) {
            last.extend(&buffer[..count]);
            let surplus = last.len().saturating_sub(kept);
            last.drain(..surplus);
            is_cut |= surplus > 0;
        }
        let text = String::from_utf8_lossy(last.make_contiguous()).into_owned();
        if is_cut { format!("[…]\n{text}") } else { text }
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
        explain(errors, &two, two[0].chapter, Path::new("w/chapter-1/src"))
    }

    #[test]
    fn errors_are_told_by_file_and_what_follows_from_them_is_left_out() {
        let errors = [
            error("E0432", "chapter-1/src/main.rs", "    pub use super::e99_second::g;"),
            error("E0308", "chapter-1/src/e99_second.rs", "    1"),
        ];
        let broken = explained(&errors);
        assert_eq!(broken.len(), 1);
        assert_eq!(broken[0].exercise, Some("second"));
        let wanted = "E1.99 second does not compile: w/chapter-1/src/e99_second.rs\n\n\
                      error[E0308] --> w/chapter-1/src/e99_second.rs:1";
        assert_eq!(broken[0].message, wanted);
    }

    #[test]
    fn an_error_inside_a_macro_belongs_to_the_file_that_uses_it() {
        let mut inside = error("E0308", "library/macros.rs", "");
        let outer = error("E0308", "chapter-1/src/e99_second.rs", "    m!()");
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
            let broken = explained(&[error(code, "chapter-1/src/main.rs", line)]);
            assert_eq!(broken[0].exercise, Some("second"));
            let end = format!("{says}\nIt should begin with:\n\n    pub fn g(x: f64) -> f64");
            assert!(broken[0].message.ends_with(&end), "{}", broken[0].message);
        }
    }

    #[test]
    fn an_error_elsewhere_is_shown_whole() {
        let broken = explained(&[error("E0308", "elsewhere.rs", "")]);
        assert_eq!(broken[0].exercise, None);
        assert!(broken[0].message.contains("error[E0308] --> elsewhere.rs:1"));
        assert!(explained(&[]).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn a_process_is_stopped_and_the_end_of_its_words_kept() {
        let script = |text: &str, limit, kept| {
            run(Command::new("sh").args(["-c", text]), limit, kept).unwrap()
        };
        let endless = script("echo a; exec sleep 600", Some(Duration::from_millis(300)), KEPT);
        assert_eq!((endless.status, &*endless.out), (None, "a\n"));
        assert_eq!(script("printf 123456789", None, 3).out, "[…]\n789");
        assert_eq!(script("printf 123 >&2", None, 3).err, "123");
    }
}
