//! What a student's program is held to.

use std::alloc::System;

use cap::Cap;

/// An endless `push` ends at 2 GiB with a word about it, before the machine begins to swap.
#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, 2 << 30);

/// The contents of the student's files in one number. Cargo compiles again when it changes, and not only
/// when the files' times do: a file that is moved back comes with an old one.
const _CONTENTS: &str = env!("LANCER_CONTENTS");
