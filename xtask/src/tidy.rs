//! The rules of the house that no compiler checks. A test runs them all on the repository.

mod dependencies;
mod labels;
mod links;
mod pictures;
mod text;

use std::fmt;

use anyhow::{Result, bail};

use crate::repository::{File, files, sources};

pub fn run() -> Result<()> {
    let files = files()?;
    let violations = check(&files)?;
    for violation in &violations {
        say!("{violation}");
    }
    match violations.len() {
        0 => say!("{} files are tidy", files.len()),
        count => bail!("{count} rules of the house are broken; each line above names a cure"),
    }
    Ok(())
}

/// A rule broken at one place. Displays as `file:line: what is wrong; cure`.
#[derive(Debug)]
struct Violation {
    file: String,
    line: usize,
    problem: String,
    cure: &'static str,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line, problem, cure } = self;
        write!(f, "{file}:{line}: {problem}; {cure}")
    }
}

fn check(files: &[File]) -> Result<Vec<Violation>> {
    let sources = sources(files, &["rs", "md", "toml", "sh", "py", "pov"])?;
    let mut violations = text::check(&sources);
    violations.extend(labels::check(&sources));
    violations.extend(dependencies::check(&sources)?);
    violations.extend(links::check(&sources, files));
    violations.extend(pictures::check(files));
    violations.sort_by(|a, b| (&a.file, a.line).cmp(&(&b.file, b.line)));
    Ok(violations)
}

/// Violations as a test compares them.
#[cfg(test)]
fn lines(violations: &[Violation]) -> String {
    violations.iter().map(|violation| format!("{violation}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_repository_is_tidy() {
        let violations = check(&files().unwrap()).unwrap();
        assert!(violations.is_empty(), "\n{}", lines(&violations));
    }
}
