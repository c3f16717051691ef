//! Words for a terminal of 80 columns: wrapped, and with colours where it has them.

use textwrap::{Options, core::display_width, wrap};

const WIDTH: usize = 80;
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
        wrap(line, options).join("\n")
    };
    let lines: Vec<String> = text.lines().map(wrapped).collect();
    lines.join("\n") + if text.ends_with('\n') { "\n" } else { "" }
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
    fn marks_have_colours() {
        assert_eq!(coloured("✓ a\n✗ b"), "\u{1b}[32m✓\u{1b}[0m a\n\u{1b}[31m✗\u{1b}[0m b");
    }
}
