//! Where the course's own files are, and their text line by line.

use std::path::Path;

use anyhow::{Context, Result};

/// The root of the workspace.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."))
}

/// A file of the repository.
#[derive(Debug)]
pub struct File {
    /// From the root, with `/` between its parts.
    pub path: String,
    /// Its length in bytes.
    pub length: u64,
}

/// All files below the root, sorted, without what git ignores.
///
/// # Errors
/// If a folder cannot be listed.
pub fn files() -> Result<Vec<File>> {
    let mut found = Vec::new();
    let mut folders = vec![String::new()];
    while let Some(folder) = folders.pop() {
        let absolute = root().join(&folder);
        let cannot_list = || format!("cannot list {}", absolute.display());
        for entry in absolute.read_dir().with_context(cannot_list)? {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let metadata = entry.metadata()?;
            let path = format!("{folder}{name}");
            if [".git", "target", "work"].contains(&path.as_str()) {
                continue;
            }
            if metadata.is_dir() {
                folders.push(path + "/");
            } else {
                found.push(File { path, length: metadata.len() });
            }
        }
    }
    found.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(found)
}

/// A file with its text.
pub struct Source {
    /// From the root, with `/` between its parts.
    pub path: String,
    /// All of it.
    pub text: String,
}

/// One line of a [`Source`].
pub struct Line<'a> {
    /// From 1.
    pub number: usize,
    /// Without its end.
    pub text: &'a str,
    /// Whether it is part of a test: in a folder `tests`, a file `tests.rs`, or under `#[cfg(test)]`.
    pub in_test: bool,
}

/// The text of those files that have one of these extensions.
///
/// # Errors
/// If one cannot be read, or is not UTF-8.
pub fn sources(files: &[File], extensions: &[&str]) -> Result<Vec<Source>> {
    let wanted = |file: &&File| {
        Path::new(&file.path)
            .extension()
            .is_some_and(|e| extensions.iter().any(|known| e == *known))
    };
    let read = |file: &File| {
        let text = std::fs::read_to_string(root().join(&file.path))
            .with_context(|| format!("cannot read {}", file.path))?;
        Ok(Source { path: file.path.clone(), text })
    };
    files.iter().filter(wanted).map(read).collect()
}

impl Source {
    /// A source that exists in a test only.
    #[cfg(test)]
    pub fn new(path: &str, text: &str) -> Self {
        Self { path: path.to_owned(), text: text.to_owned() }
    }

    /// Whether this is Rust.
    pub fn is_rust(&self) -> bool {
        self.path.ends_with(".rs")
    }

    /// Its lines. Rust is expected as rustfmt leaves it: an item ends with a `}` or `;` that is
    /// indented as its first line is.
    pub fn lines(&self) -> impl Iterator<Item = Line<'_>> {
        let all_tests =
            format!("/{}", self.path).contains("/tests/") || self.path.ends_with("/tests.rs");
        // The indentation of the item under `#[cfg(test)]` that we are in.
        let mut test_item = None;
        self.text.lines().enumerate().map(move |(index, text)| {
            let indent = text.len() - text.trim_start().len();
            if test_item.is_none() && text.trim() == "#[cfg(test)]" {
                test_item = Some(indent);
            }
            let in_test = all_tests || test_item.is_some();
            if test_item == Some(indent) && (text.ends_with('}') || text.ends_with(';')) {
                test_item = None;
            }
            Line { number: index + 1, text, in_test }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn test_items_end_where_their_brace_is() {
        let text = "a\n#[cfg(test)]\nmod tests {\n    fn f() {\n    }\n}\nb\n\
                    #[cfg(test)]\nuse x;\nc\nimpl X {\n    #[cfg(test)]\n    fn g() {\n    }\n    d\n}\n";
        let outside = |path| {
            let source = Source::new(path, text);
            let lines: Vec<&str> = source.lines().filter(|l| !l.in_test).map(|l| l.text).collect();
            lines.join(" ")
        };
        assert_eq!(outside("crates/a/src/b.rs"), "a b c impl X {     d }");
        assert_eq!(outside("crates/a/src/contests.rs"), "a b c impl X {     d }");
        for path in ["tests/suite/a.rs", "crates/a/tests/b.rs", "crates/a/src/b/tests.rs"] {
            assert_eq!(outside(path), "");
        }
    }

    #[test]
    fn the_repository_holds_this_file_once() {
        let files = files().unwrap();
        let own: Vec<&File> =
            files.iter().filter(|file| file.path == "xtask/src/repository.rs").collect();
        assert_eq!(own.len(), 1);
        let sources = sources(&files, &["rs"]).unwrap();
        assert!(sources.iter().all(Source::is_rust) && sources.len() < files.len());
    }
}
