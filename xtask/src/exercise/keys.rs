//! Single keys of a terminal, read while something else is waited for.

use std::io::{IsTerminal, Read, stdin};
use std::sync::mpsc::{self, Receiver};
use std::thread;

pub use terminal::Unbuffered;

/// The keys typed at a terminal: at once where it is [`Unbuffered`], else after Enter.
pub struct Keys(Receiver<u8>);

impl Keys {
    /// Listens, if there is a terminal, and this program is the one that it talks to.
    pub fn listen() -> Option<Self> {
        if !stdin().is_terminal() || !terminal::is_ours() {
            return None;
        }
        let (sender, typed) = mpsc::channel();
        thread::spawn(move || {
            for byte in stdin().lock().bytes().map_while(Result::ok) {
                if sender.send(byte).is_err() {
                    break;
                }
            }
        });
        Some(Self(typed))
    }

    /// The next key that has been typed.
    pub fn next(&self) -> Option<char> {
        self.0.try_recv().ok().map(|byte| char::from(byte).to_ascii_lowercase())
    }
}

#[cfg(unix)]
mod terminal {
    use std::io::stdin;

    use rustix::process::getpgrp;
    use rustix::termios::{LocalModes, OptionalActions, Termios, tcgetattr, tcgetpgrp, tcsetattr};

    /// A program in the background is stopped when it changes the terminal.
    pub fn is_ours() -> bool {
        tcgetpgrp(stdin()).map_or(true, |group| group == getpgrp())
    }

    /// A terminal that hands on each key at once and does not show it, up to the drop. Ctrl-C stays what it is.
    pub struct Unbuffered(Option<Termios>);

    impl Unbuffered {
        pub fn new() -> Self {
            let before = tcgetattr(stdin()).ok();
            if let Some(mut modes) = before.clone() {
                modes.local_modes.remove(LocalModes::ICANON | LocalModes::ECHO);
                // A terminal that refuses shows the keys and waits for Enter.
                let _ = tcsetattr(stdin(), OptionalActions::Now, &modes);
            }
            Self(before)
        }
    }

    impl Drop for Unbuffered {
        fn drop(&mut self) {
            if let Some(before) = &self.0 {
                let _ = tcsetattr(stdin(), OptionalActions::Now, before);
            }
        }
    }
}

#[cfg(not(unix))]
mod terminal {
    pub fn is_ours() -> bool {
        true
    }

    /// Keys come after Enter.
    pub struct Unbuffered;

    impl Unbuffered {
        pub fn new() -> Self {
            Self
        }
    }
}
