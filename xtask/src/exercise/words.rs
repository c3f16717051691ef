//! Words for a terminal of 80 columns: wrapped, and with colours where it has them.

use textwrap::{Options, core::display_width, wrap};

const WIDTH: usize = 80;
/// A space at which no line is broken.
const GLUE: &str = "\u{a0}";
const GREEN: &str = "\u{1b}[32m";
const RED: &str = "\u{1b}[31m";
const PLAIN: &str = "\u{1b}[0m";

/// Prints words, wrapped.
pub fn say_wrapped(text: &str) {
    say!("{}", wrapped(text.trim_end()));
}

/// Prints what a check has found, with colours.
pub fn say_report(text: &str) {
    say!("{}", coloured(text.trim_end()));
}

/// Breaks lines between words, each part below the line's own words; a last line that ends stays so.
pub fn wrapped(text: &str) -> String {
    let wrapped = |line: &str| {
        let indent = " ".repeat(hanging_indent(line));
        // No word is broken: a path or a number must stay whole.
        let options = Options::new(WIDTH)
            .subsequent_indent(&indent)
            .break_words(false)
            .word_splitter(textwrap::WordSplitter::NoHyphenation);
        wrap(&with_whole_tuples(line), options).join("\n").replace(GLUE, " ")
    };
    let lines: Vec<String> = text.lines().map(wrapped).collect();
    lines.join("\n") + if text.ends_with('\n') { "\n" } else { "" }
}

/// Glues what stands in short parentheses: a vector is one word.
fn with_whole_tuples(line: &str) -> String {
    let mut parts = line.split('(');
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (inside, after) = part.split_once(')').map_or(("", part), |(inside, _)| {
            part.split_at(if inside.len() <= WIDTH / 2 { inside.len() } else { 0 })
        });
        text.extend(["(", &inside.replace(' ', GLUE), after]);
    }
    text
}

/// Where a line's words begin: after its spaces, its mark and, in a row of two columns, the first of them.
fn hanging_indent(line: &str) -> usize {
    let words = line.trim_start_matches([' ', '✓', '✗', '→']);
    let start = display_width(&line[..line.len() - words.len()]);
    match words.split_once("  ") {
        Some((first, rest)) if !first.contains(' ') => {
            start + display_width(first) + 2 + rest.len() - rest.trim_start().len()
        }
        _ => start,
    }
}

/// Green for what is right, red for what is not. Whoever prints leaves the colours out where there are none.
fn coloured(text: &str) -> String {
    text.replace('✓', &format!("{GREEN}✓{PLAIN}")).replace('✗', &format!("{RED}✗{PLAIN}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_wrapped_below_their_own_words() {
        let long = "word ".repeat(20);
        for (start, indent) in [("", 0), ("  ✗ ", 4), ("      ", 6), ("      case    ", 14)] {
            let lines = wrapped(&format!("{start}{}", long.trim_end()));
            let lines: Vec<&str> = lines.lines().collect();
            assert_eq!(lines.len(), 2, "{lines:?}");
            assert!(lines[0].starts_with(&format!("{start}word ")));
            assert!(lines[1].starts_with(&format!("{}word ", " ".repeat(indent))), "{lines:?}");
            assert!(lines.iter().all(|line| line.chars().count() <= 80), "{lines:?}");
        }
    }

    #[test]
    fn what_fits_and_what_cannot_be_broken_stays() {
        let path = "x/".repeat(60);
        for line in ["a  b", "", "  ✓ a check", &path] {
            assert_eq!(wrapped(line), line);
        }
    }

    #[test]
    fn vectors_are_not_broken() {
        let line = format!(
            "{} (0.5, 0.25, 1), (an aside of {})",
            "word ".repeat(14),
            "many words ".repeat(8)
        );
        let wrapped = wrapped(&line);
        assert!(
            wrapped.lines().nth(1).unwrap().starts_with("(0.5, 0.25, 1), (an aside of many"),
            "{wrapped}"
        );
        assert_eq!(
            wrapped.split_whitespace().collect::<Vec<_>>(),
            line.split_whitespace().collect::<Vec<_>>()
        );
    }

    #[test]
    fn marks_have_colours() {
        assert_eq!(coloured("✓ a\n✗ b"), "\u{1b}[32m✓\u{1b}[0m a\n\u{1b}[31m✗\u{1b}[0m b");
    }
}
