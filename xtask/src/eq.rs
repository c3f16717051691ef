use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use anyhow::{Result, bail};

use crate::labels::{Kind, Place, find, item_name};
use crate::names::choose;
use crate::repository::{Source, files, sources};

/// Lists where a formula of the slides stands: definition, mentions, tests, lesson, map, figures.
///
/// Without LABEL, lists all labels with the function or type that each names.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  cargo xtask eq\n  cargo xtask eq reflected-ray")]
pub struct Args {
    /// A label, with or without its prefix: reflected-ray is eq:reflected-ray
    label: Option<String>,
}

pub fn run(args: &Args) -> Result<()> {
    let sources = sources(&files()?, &["rs", "md"])?;
    say!("{}", report(&sources, args.label.as_deref())?.trim_end());
    Ok(())
}

fn report(sources: &[Source], label: Option<&str>) -> Result<String> {
    let labels = find(sources);
    let rows: Vec<[String; 3]> = match label {
        None => labels.iter().flat_map(|(label, places)| definitions(label, places)).collect(),
        Some(given) => labels[resolve(given, &labels)?].iter().map(mention).collect(),
    };
    Ok(aligned(&rows))
}

/// The label that `given` stands for.
fn resolve<'a>(given: &str, labels: &BTreeMap<&'a str, Vec<Place>>) -> Result<&'a str> {
    let known: Vec<&str> = labels.keys().copied().collect();
    if given.contains(':') {
        return Ok(known[choose("label", given, &known)?]);
    }
    let without_prefix = |label: &&'a str| label.split_once(':').map_or(*label, |(_, name)| name);
    let names: BTreeSet<&str> = known.iter().map(without_prefix).collect();
    let names: Vec<&str> = names.into_iter().collect();
    let name = names[choose("label", given, &names)?];
    let matching: Vec<&str> =
        known.iter().copied().filter(|label| without_prefix(label) == name).collect();
    match matching[..] {
        [label] => Ok(label),
        _ => bail!("`{given}` is several labels; name one: {}", matching.join(", ")),
    }
}

fn definitions(label: &str, places: &[Place]) -> Vec<[String; 3]> {
    let row = |place: &Place| {
        let name = match place.kind {
            Kind::Definition => item_name(place.text),
            _ => "(stated, not computed)",
        };
        [label.to_owned(), position(place), name.to_owned()]
    };
    let rows: Vec<_> = places.iter().filter(|place| place.kind.defines()).map(row).collect();
    if rows.is_empty() {
        return vec![[label.to_owned(), "(defined nowhere)".to_owned(), String::new()]];
    }
    rows
}

fn mention(place: &Place) -> [String; 3] {
    const WIDTH: usize = 100;
    let mut text = place.text.to_owned();
    if let Some((end, _)) = text.char_indices().nth(WIDTH) {
        text.truncate(end);
        text.push('…');
    }
    [position(place), place.kind.name().to_owned(), text]
}

fn position(place: &Place) -> String {
    format!("{}:{}", place.file, place.line)
}

/// Rows with their first two columns filled up to the longest.
fn aligned(rows: &[[String; 3]]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].len()).max().unwrap_or(0);
    let (first, second) = (width(0), width(1));
    let mut text = String::new();
    for [a, b, c] in rows {
        let line = format!("{a:first$}  {b:second$}  {c}");
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

#[cfg(test)]
mod tests {
    use insta::assert_snapshot;

    use super::*;

    fn sources() -> Vec<Source> {
        let optics = "//! Optics.\n//!\n//! ```text\n//! eq:rendering   L = ε + ∫ ρ L\n//! ```\n\n\
            /// ```text\n/// eq:reflected-ray   R = V − 2 (N·V) N\n/// ```\n\
            #[doc(alias = \"eq:reflected-ray\")]\n#[doc(alias = \"rayon réfléchi\")]\n\
            pub fn reflect(incident: DVec3, n: DVec3) -> DVec3 {\n}\n";
        vec![
            Source::new("README.md", "| Reflets | `eq:reflected-ray` |\n"),
            Source::new("chapters/1-whitted/README.md", "By `eq:reflected-ray` and algo:none.\n"),
            Source::new(
                "chapters/1-whitted/src/figures/mirror.rs",
                ".note(\"eq:reflected-ray\")\n",
            ),
            Source::new("crates/core/src/optics.rs", optics),
            Source::new("crates/whitted/src/trace.rs", "    // eq:reflected-ray, again\n"),
            Source::new("tests/suite/optics.rs", "/// eq:reflected-ray in a corner\n"),
        ]
    }

    #[test]
    fn without_a_label_all_definitions_are_listed() {
        assert_snapshot!(report(&sources(), None).unwrap(), @r"
        algo:none         (defined nowhere)
        eq:reflected-ray  crates/core/src/optics.rs:12  reflect
        eq:rendering      crates/core/src/optics.rs:4   (stated, not computed)
        ");
    }

    #[test]
    fn a_label_is_followed_everywhere_with_or_without_its_prefix() {
        let sources = sources();
        let report = |label| report(&sources, Some(label)).unwrap();
        assert_snapshot!(report("reflected-ray"), @r#"
        crates/core/src/optics.rs:12                definition  pub fn reflect(incident: DVec3, n: DVec3) -> DVec3 {
        crates/core/src/optics.rs:8                 crate       /// eq:reflected-ray   R = V − 2 (N·V) N
        crates/whitted/src/trace.rs:1               crate       // eq:reflected-ray, again
        tests/suite/optics.rs:1                     test        /// eq:reflected-ray in a corner
        chapters/1-whitted/README.md:1              lesson      By `eq:reflected-ray` and algo:none.
        README.md:1                                 map         | Reflets | `eq:reflected-ray` |
        chapters/1-whitted/src/figures/mirror.rs:1  figure      .note("eq:reflected-ray")
        "#);
        assert_eq!(report("eq:reflected-ray"), report("reflected-ray"));
    }

    #[test]
    fn an_unknown_or_ambiguous_label_is_answered_with_the_known_ones() {
        let mut sources = sources();
        sources.push(Source::new("tests/a.rs", "// eq:none"));
        let message = |label| report(&sources, Some(label)).unwrap_err().to_string();
        assert_snapshot!(message("reflected"), @"unknown label `reflected`; known: reflected-ray, rendering, none");
        assert_snapshot!(message("eq:rendring"), @"unknown label `eq:rendring`; known: eq:rendering, eq:none, algo:none, eq:reflected-ray");
        assert_snapshot!(message("none"), @"`none` is several labels; name one: algo:none, eq:none");
    }

    #[test]
    fn long_lines_are_cut() {
        let sources = [Source::new("README.md", &format!("eq:x {}", "é".repeat(200)))];
        let report = report(&sources, Some("x")).unwrap();
        assert_eq!(report.trim_end().chars().filter(|c| *c == 'é').count(), 95);
        assert!(report.ends_with("…\n"));
    }
}
