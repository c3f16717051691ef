//! Single keys of a terminal, read while something else is waited for.

use std::io::{IsTerminal, Read, stdin};
use std::sync::mpsc::{self, Receiver};
use std::thread;

/// The keys typed at a terminal: at once where the system lets us, after Enter where it does not.
pub struct Keys {
    typed: Receiver<u8>,
    _unbuffered: unbuffered::Guard,
}

impl Keys {
    /// Listens, if there is a terminal.
    pub fn listen() -> Option<Self> {
        if !stdin().is_terminal() {
            return None;
        }
        let guard = unbuffered::Guard::new();
        let (sender, typed) = mpsc::channel();
        thread::spawn(move || {
            for byte in stdin().lock().bytes().map_while(Result::ok) {
                if sender.send(byte).is_err() {
                    break;
                }
            }
        });
        Some(Self { typed, _unbuffered: guard })
    }

    /// The next key that has been typed.
    pub fn next(&self) -> Option<char> {
        self.typed.try_recv().ok().map(|byte| char::from(byte).to_ascii_lowercase())
    }
}

#[cfg(unix)]
mod unbuffered {
    use std::io::stdin;

    use rustix::termios::{LocalModes, OptionalActions, Termios, tcgetattr, tcsetattr};

    /// A terminal that hands on each key at once and does not show it, up to the drop. Ctrl-C stays what it is.
    pub struct Guard(Option<Termios>);

    impl Guard {
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

    impl Drop for Guard {
        fn drop(&mut self) {
            if let Some(before) = &self.0 {
                let _ = tcsetattr(stdin(), OptionalActions::Now, before);
            }
        }
    }
}

#[cfg(not(unix))]
mod unbuffered {
    /// Keys come after Enter.
    pub struct Guard;

    impl Guard {
        pub fn new() -> Self {
            Self
        }
    }
}
