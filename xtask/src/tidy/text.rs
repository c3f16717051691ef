use super::Violation;
use crate::repository::{Line, Source};

const MOST_LINES: usize = 600;

/// What can be seen in a text by itself.
pub fn check(sources: &[Source]) -> Vec<Violation> {
    let mut violations = Vec::new();
    for source in sources {
        let mut report = |line, problem: String, cure| {
            violations.push(Violation { file: source.path.clone(), line, problem, cure });
        };
        if is_module_root(source, sources) && !source.text.starts_with("//!") {
            report(
                1,
                "no documentation of the module".into(),
                "start the file with `//!`: what it is for",
            );
        }
        if source.is_rust() && source.text.lines().count() > MOST_LINES {
            report(MOST_LINES + 1, format!("more than {MOST_LINES} lines"), "split the file");
        }
        for line in source.lines() {
            let number = line.number;
            if line.text.ends_with(char::is_whitespace) {
                report(number, "space at the end of the line".into(), "remove it");
            }
            if line.text.contains('\t') {
                report(number, "a tab".into(), "use spaces, or \\t in a string");
            }
            for home in ["root", "home", "work", "tmp", "Users"] {
                if is_absolute(line.text, home) {
                    report(
                        number,
                        format!("a path below /{home}, of one machine only"),
                        "make it relative",
                    );
                }
            }
        }
        if source.is_rust() {
            for (line, code) in source.lines().zip(code_lines(&source.text)) {
                check_code(source, &line, &code, &mut report);
            }
        }
    }
    violations
}

/// Words that must not stand in code; comments and strings may speak of them.
fn check_code(
    source: &Source,
    line: &Line,
    code: &str,
    report: &mut impl FnMut(usize, String, &'static str),
) {
    let in_accel = source.path.starts_with("crates/accel/");
    // A stub is to be finished by whoever takes the course.
    let is_stub = source.path.contains("/stubs/");
    for name in ["todo", "dbg", "unimplemented"] {
        if !(is_stub && name == "todo") && has_word(code, name, "!") {
            report(line.number, format!("`{name}!` is left"), "finish the work or remove it");
        }
    }
    let in_lanes = source.path.starts_with("crates/core/src/lanes/");
    if !in_accel && !in_lanes && has_word(code, "unsafe", "") {
        let cure = "write it safely, or move it there and argue for it";
        report(line.number, "`unsafe` outside crates/accel and core's lanes".to_owned(), cure);
    }
    // A chapter's naive variants are wrong on purpose.
    let shows_mistakes = line.in_test || source.path.ends_with("/naive.rs");
    if !in_accel && !shows_mistakes && has_word(code, "mul_add", "") {
        let cure = "write a * b + c: without the CPU feature it is a library call";
        report(line.number, "`mul_add` outside crates/accel".to_owned(), cure);
    }
}

/// A file that speaks for others: of a package, or of a folder of modules.
fn is_module_root(source: &Source, sources: &[Source]) -> bool {
    let Some(stem) = source.path.strip_suffix(".rs") else { return false };
    let folder = format!("{stem}/");
    let is_named_so =
        ["/lib.rs", "/main.rs", "/mod.rs"].iter().any(|name| source.path.ends_with(name));
    is_named_so || sources.iter().any(|other| other.is_rust() && other.path.starts_with(&folder))
}

/// Whether `text` names a path that starts with this folder of the root, not one of its own.
fn is_absolute(text: &str, folder: &str) -> bool {
    text.match_indices(&format!("/{folder}/")).any(|(start, _)| {
        let before = text[..start].chars().next_back();
        !before.is_some_and(|c| c.is_alphanumeric() || "_-.~*/{}$)".contains(c))
    })
}

/// Whether the word stands in `text`, followed by `after`.
fn has_word(text: &str, word: &str, after: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(word).any(|(start, _)| {
        let rest = &text[start + word.len()..];
        !text[..start].ends_with(is_part) && !rest.starts_with(is_part) && rest.starts_with(after)
    })
}

/// The lines of a Rust file without comments and without what is between quotes.
fn code_lines(text: &str) -> Vec<String> {
    let mut code = String::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let (skipped, after) = rest.split_at(comment_or_literal(rest).unwrap_or(0));
        if skipped.is_empty() {
            code.push(first);
            rest = &rest[first.len_utf8()..];
        } else {
            code.extend(skipped.chars().filter(|c| *c == '\n'));
            rest = after;
        }
    }
    code.lines().map(str::to_owned).collect()
}

/// The length of the comment, text or character that `rest` starts with.
fn comment_or_literal(rest: &str) -> Option<usize> {
    let until = |start: usize, end: &str| {
        rest.get(start..)?.find(end).map(|length| start + length + end.len())
    };
    let end = if rest.starts_with("//") {
        rest.find('\n')
    } else if rest.starts_with("/*") {
        until(2, "*/")
    } else if let Some(raw) = rest.strip_prefix('r') {
        let hashes = raw.len() - raw.trim_start_matches('#').len();
        raw[hashes..].strip_prefix('"')?;
        until(2 + hashes, &format!("\"{}", "#".repeat(hashes)))
    } else if let Some(text) = rest.strip_prefix('"') {
        let mut escaped = false;
        let is_end = |c: char| {
            let ends = c == '"' && !escaped;
            escaped = c == '\\' && !escaped;
            ends
        };
        text.find(is_end).map(|length| length + 2)
    } else if rest.starts_with("'\\") {
        until(3, "'")
    } else {
        // 'x' is a character, 'x alone a lifetime.
        let after = rest.strip_prefix('\'')?;
        let length = 1 + after.chars().next()?.len_utf8();
        return rest[length..].starts_with('\'').then_some(length + 1);
    };
    Some(end.unwrap_or(rest.len()))
}

#[cfg(test)]
mod tests {
    use insta::assert_snapshot;

    use super::super::lines;
    use super::*;

    fn of(path: &str, text: &str) -> String {
        lines(&check(&[Source::new(path, text)]))
    }

    #[test]
    fn module_roots_speak_for_their_folder() {
        for path in ["a/src/lib.rs", "a/src/main.rs", "a/src/b/mod.rs"] {
            let expected = format!(
                "{path}:1: no documentation of the module; start the file with `//!`: what it is for\n"
            );
            assert_eq!(of(path, "mod c;\n"), expected);
            assert_eq!(of(path, "//! All of c.\n"), "");
        }
        assert_eq!(of("a/src/b.rs", "mod c;\n"), "");
        let sources = [Source::new("a/src/b.rs", "mod c;\n"), Source::new("a/src/b/c.rs", "")];
        assert_eq!(check(&sources).len(), 1);
    }

    #[test]
    fn long_files_are_split() {
        let lines = "x\n".repeat(600);
        assert_eq!(of("a.rs", &lines), "");
        assert_eq!(of("a.md", &(lines.clone() + "x\n")), "");
        assert_snapshot!(of("a.rs", &(lines + "x\n")), @"a.rs:601: more than 600 lines; split the file");
    }

    #[test]
    fn space_that_nobody_sees() {
        assert_snapshot!(of("a.md", "a \n\n\tb\n"), @r"
        a.md:1: space at the end of the line; remove it
        a.md:3: a tab; use spaces, or \t in a string
        ");
    }

    #[test]
    fn paths_of_one_machine() {
        for folder in ["root", "home", "work", "tmp"] {
            for (before, after) in [("\"", "a\""), ("cd ", ""), ("", "x"), ("(", "x)"), ("=", "x")]
            {
                let text = format!("{before}/{folder}/{after}\n");
                assert_eq!(check(&[Source::new("a.sh", &text)]).len(), 1, "{text}");
            }
            for before in ["target", "..", "~", "$HOME", "https:/", "{root}", "*"] {
                assert_eq!(of("a.sh", &format!("{before}/{folder}/x\n")), "");
            }
        }
        let text = format!("see {}", ["", "home", "me"].join("/"));
        assert_snapshot!(of("a.toml", &text), @"a.toml:1: a path below /home, of one machine only; make it relative");
    }

    #[test]
    fn words_in_code_only() {
        for (code, count) in [
            ("    todo!();", 1),
            ("dbg!(x); unimplemented!(\"{x}\")", 2),
            ("let todo = not_todo!();", 0),
            ("// todo!() and unsafe", 0),
            ("let s = \"unsafe // \\\" todo!()\";", 0),
            ("let s = \"//\"; unsafe { f() }", 1),
            ("let c = '\"'; unsafe { f() }", 1),
            ("let c = '\\''; unsafe { f() } // '", 1),
            ("fn f<'a>(x: &'a str) { unsafe { f() } }", 1),
            ("let s = r#\"unsafe \" //\"#; unsafe { f() }", 1),
            ("let r = r\"\\\"; unsafe { f() }", 1),
            ("let s = \"a\nunsafe\n\"; /* unsafe\nunsafe */ x", 0),
            ("#![allow(unsafe_code)]", 0),
            ("a.mul_add(b, c)", 1),
            ("f64::mul_add(a, b, c)", 1),
        ] {
            assert_eq!(check(&[Source::new("crates/core/src/a.rs", code)]).len(), count, "{code}");
        }
        assert_eq!(of("chapters/1/stubs/a.rs", "fn f() { todo!() }\n"), "");
        assert_ne!(of("chapters/1/stubs/a.rs", "fn f() { dbg!() }\n"), "");
    }

    #[test]
    fn accel_tests_and_naive_variants_are_freer() {
        assert_eq!(of("chapters/1/src/naive.rs", "a.mul_add(b, c)"), "");
        let unsafe_code = "unsafe { a.mul_add(b, c) }\n";
        assert_eq!(of("crates/accel/src/a.rs", unsafe_code), "");
        assert_snapshot!(of("crates/core/src/a.rs", unsafe_code), @r"
        crates/core/src/a.rs:1: `unsafe` outside crates/accel and core's lanes; write it safely, or move it there and argue for it
        crates/core/src/a.rs:1: `mul_add` outside crates/accel; write a * b + c: without the CPU feature it is a library call
        ");
        assert_snapshot!(of("tests/suite/a.rs", unsafe_code), @"tests/suite/a.rs:1: `unsafe` outside crates/accel and core's lanes; write it safely, or move it there and argue for it");
    }
}
