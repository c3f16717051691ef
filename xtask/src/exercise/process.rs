//! Runs a program that may do anything: never end, never stop talking, or leave others behind.

use std::collections::VecDeque;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

use crate::progress::is_interrupted;

/// How long a program's last words may take after its end: for ever, if a process that it has started
/// holds its output open.
const LAST_WORDS: Duration = Duration::from_secs(1);

/// What a program is allowed.
#[derive(Clone, Copy)]
pub struct Limits {
    /// How long it may run.
    time: Duration,
    /// What is kept of an output: its end, in bytes. A loop may print for as long as it runs.
    kept: usize,
    /// After how long what it says of its errors is passed on as it comes.
    patience: Duration,
}

impl Limits {
    /// Cargo says what it compiles as soon as that takes a while.
    pub const OF_CARGO: Self =
        Self { time: Duration::MAX, kept: usize::MAX, patience: Duration::from_secs(3) };
    /// A student's program stops endless functions itself; this is for what it cannot stop.
    const OF_STUDENT: Self =
        Self { time: Duration::from_secs(90), kept: 64 << 10, patience: Duration::MAX };
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
    let ended = run(&mut command, Limits::OF_STUDENT).context("cannot start your program")?;
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
    let mut text = match trouble {
        Some(trouble) => format!("{}{trouble}\n", ended.out),
        // What `dbg!` shows comes first.
        None => ended.err + &ended.out,
    };
    if ended.is_outlived {
        text.push_str("A process that your program has started still runs.\n");
    }
    Ok(Answer { text, is_right, is_crash })
}

/// Why a program ended otherwise than by itself.
fn death(err: &str, status: ExitStatus) -> String {
    if err.contains("memory allocation of") {
        let words =
            "your function takes more than 2 GiB of memory: does the loop that fills a list end?";
        return format!("  ✗ {words}");
    }
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
pub struct Ended {
    /// None if it was stopped.
    pub status: Option<ExitStatus>,
    /// What it printed.
    pub out: String,
    /// What it printed as errors.
    pub err: String,
    /// Whether another process holds its output open.
    is_outlived: bool,
}

/// Runs a command up to its limits and keeps the end of what it says.
///
/// # Errors
/// If it cannot be started, or on Ctrl-C.
pub fn run(command: &mut Command, limits: Limits) -> Result<Ended> {
    let start = Instant::now();
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    let out = child.stdout.take().map(|pipe| Listener::new(pipe, limits.kept));
    let err = child.stderr.take().map(|pipe| Listener::new(pipe, limits.kept));
    let mut status = wait(&mut child, start, limits.patience.min(limits.time))?;
    if status.is_none() && limits.patience < limits.time {
        err.iter().for_each(Listener::pass_on);
        status = wait(&mut child, start, limits.time)?;
    }
    if status.is_none() {
        child.kill()?;
        child.wait()?;
    }
    let deadline = Instant::now() + LAST_WORDS;
    let heard = |listener: Option<Listener>| {
        listener.map_or((String::new(), true), |listener| listener.until(deadline))
    };
    let ((out, out_ended), (err, err_ended)) = (heard(out), heard(err));
    Ok(Ended { status, out, err, is_outlived: !(out_ended && err_ended) })
}

/// Its status, unless it still runs so long after the start.
fn wait(child: &mut Child, start: Instant, limit: Duration) -> Result<Option<ExitStatus>> {
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if is_interrupted() {
            child.kill()?;
            child.wait()?;
            bail!("interrupted");
        }
        if start.elapsed() > limit {
            return Ok(None);
        }
        thread::sleep(Duration::from_millis(5));
    }
}

/// Reads a pipe in a thread of its own and keeps the last bytes.
struct Listener {
    heard: Arc<Mutex<Heard>>,
    ended: Receiver<()>,
}

#[derive(Default)]
struct Heard {
    last: VecDeque<u8>,
    is_cut: bool,
    is_passed_on: bool,
}

impl Listener {
    fn new(mut pipe: impl Read + Send + 'static, kept: usize) -> Self {
        let heard = Arc::new(Mutex::new(Heard::default()));
        let (sender, ended) = mpsc::channel::<()>();
        let into = Arc::clone(&heard);
        thread::spawn(move || {
            // Its end is told by being dropped.
            let _sender = sender;
            let mut buffer = [0; 4096];
            while let Ok(count @ 1..) = pipe.read(&mut buffer) {
                let Ok(mut heard) = into.lock() else { return };
                if heard.is_passed_on {
                    eprint!("{}", String::from_utf8_lossy(&buffer[..count]));
                }
                heard.last.extend(&buffer[..count]);
                let surplus = heard.last.len().saturating_sub(kept);
                heard.last.drain(..surplus);
                heard.is_cut |= surplus > 0;
            }
        });
        Self { heard, ended }
    }

    /// Says from now on what is heard, and what has been.
    fn pass_on(&self) {
        let Ok(mut heard) = self.heard.lock() else { return };
        heard.is_passed_on = true;
        eprint!("{}", String::from_utf8_lossy(heard.last.make_contiguous()));
    }

    /// What was said up to the end or the deadline, and whether that was the end.
    fn until(&self, deadline: Instant) -> (String, bool) {
        let patience = deadline.saturating_duration_since(Instant::now());
        let is_end = self.ended.recv_timeout(patience) != Err(mpsc::RecvTimeoutError::Timeout);
        let Ok(mut heard) = self.heard.lock() else { return (String::new(), is_end) };
        let text = String::from_utf8_lossy(heard.last.make_contiguous()).into_owned();
        (if heard.is_cut { format!("[…]\n{text}") } else { text }, is_end)
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    const SHORT: Limits = Limits { time: Duration::from_millis(300), ..Limits::OF_STUDENT };

    fn script(text: &str, limits: Limits) -> Ended {
        run(Command::new("sh").args(["-c", text]), limits).unwrap()
    }

    #[test]
    fn a_process_is_stopped_and_the_end_of_its_words_kept() {
        let endless = script("echo a; exec sleep 600", SHORT);
        assert_eq!((endless.status, &*endless.out), (None, "a\n"));
        let cut = script("printf 123456789", Limits { kept: 3, ..Limits::OF_STUDENT });
        assert_eq!((&*cut.out, cut.is_outlived), ("[…]\n789", false));
        assert_eq!(script("printf 123 >&2", Limits::OF_CARGO).err, "123");
    }

    /// The other one holds the output open for ten minutes.
    #[test]
    fn a_process_left_behind_delays_nothing() {
        for (text, limits) in [
            ("echo a; sleep 600 & echo $! >&2", Limits::OF_STUDENT),
            ("echo a; sleep 600 & echo $! >&2; exec sleep 600", SHORT),
        ] {
            let ended = script(text, limits);
            assert_eq!((&*ended.out, ended.is_outlived), ("a\n", true));
            Command::new("kill").arg(ended.err.trim()).status().unwrap();
        }
    }
}
