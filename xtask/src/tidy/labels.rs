use super::Violation;
use crate::labels::{Kind, find};
use crate::repository::Source;

/// Each label is defined once, tested, taught in a lesson and on the map; none is mentioned that is
/// not defined. A formula that is stated but not computed needs no test.
pub fn check(sources: &[Source]) -> Vec<Violation> {
    let mut violations = Vec::new();
    for (label, places) in find(sources) {
        let mut report = |at: usize, problem: String, cure| {
            let (file, line) = (places[at].file.to_owned(), places[at].line);
            violations.push(Violation { file, line, problem, cure });
        };
        // Definitions come first.
        let definitions = places.iter().take_while(|place| place.kind.defines()).count();
        for again in 1..definitions {
            let problem =
                format!("`{label}` is defined at {}:{} too", places[0].file, places[0].line);
            report(again, problem, "keep one definition");
        }
        if definitions == 0 {
            for at in 0..places.len() {
                let cure = "correct it, or put #[doc(alias)] on the item in crates/ that it names";
                report(at, format!("`{label}` is defined nowhere"), cure);
            }
            continue;
        }
        let wanted = [
            (Kind::Test, "is in no test", "name it in the comment of the test that proves it"),
            (Kind::Lesson, "is in no lesson", "name it in chapters/*/README.md"),
            (Kind::Map, "is not on the map", "add a row to the map in README.md"),
        ];
        for (kind, problem, cure) in wanted {
            let needed = kind != Kind::Test || places[0].kind == Kind::Definition;
            if needed && !places.iter().any(|place| place.kind == kind) {
                report(0, format!("`{label}` {problem}"), cure);
            }
        }
    }
    violations
}

#[cfg(test)]
mod tests {
    use insta::assert_snapshot;

    use super::super::lines;
    use super::*;

    const DEFINITION: &str = "#[doc(alias = \"eq:x\")]\npub fn x() {\n}\n";

    fn tidy() -> Vec<Source> {
        vec![
            Source::new("README.md", "eq:x eq:stated"),
            Source::new("chapters/1/README.md", "eq:stated eq:x"),
            Source::new("crates/a/src/lib.rs", "//! ```text\n//! eq:stated  a = b\n//! ```\n"),
            Source::new("crates/a/src/x.rs", DEFINITION),
            Source::new("crates/a/tests/x.rs", "// eq:x"),
        ]
    }

    #[test]
    fn labels_that_are_defined_tested_taught_and_mapped_pass() {
        assert_eq!(lines(&check(&tidy())), "");
    }

    #[test]
    fn each_missing_place_is_reported() {
        let without = |path: &str| {
            let rest: Vec<Source> = tidy().into_iter().filter(|s| s.path != path).collect();
            lines(&check(&rest))
        };
        assert_snapshot!(without("README.md"), @r"
        crates/a/src/lib.rs:2: `eq:stated` is not on the map; add a row to the map in README.md
        crates/a/src/x.rs:2: `eq:x` is not on the map; add a row to the map in README.md
        ");
        assert_snapshot!(without("chapters/1/README.md"), @r"
        crates/a/src/lib.rs:2: `eq:stated` is in no lesson; name it in chapters/*/README.md
        crates/a/src/x.rs:2: `eq:x` is in no lesson; name it in chapters/*/README.md
        ");
        assert_snapshot!(without("crates/a/tests/x.rs"), @"crates/a/src/x.rs:2: `eq:x` is in no test; name it in the comment of the test that proves it");
        assert_snapshot!(without("crates/a/src/x.rs"), @r"
        crates/a/tests/x.rs:1: `eq:x` is defined nowhere; correct it, or put #[doc(alias)] on the item in crates/ that it names
        chapters/1/README.md:1: `eq:x` is defined nowhere; correct it, or put #[doc(alias)] on the item in crates/ that it names
        README.md:1: `eq:x` is defined nowhere; correct it, or put #[doc(alias)] on the item in crates/ that it names
        ");
    }

    #[test]
    fn a_second_definition_is_reported() {
        let mut sources = tidy();
        sources.push(Source::new("crates/b/src/x.rs", DEFINITION));
        assert_snapshot!(lines(&check(&sources)), @"crates/b/src/x.rs:2: `eq:x` is defined at crates/a/src/x.rs:2 too; keep one definition");
    }
}
