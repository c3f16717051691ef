//! The slides' labels, `eq:…`, `algo:…` and `fig:…`: where each is defined and where it is mentioned.

use std::collections::BTreeMap;

use crate::repository::{Line, Source};

/// What a label does at a place, in the order in which places are listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// `#[doc(alias = "eq:…")]` on the item that is the formula.
    Definition,
    /// A formula that is not computed: a line of a text block in a module's documentation that starts
    /// with the label.
    Statement,
    /// Elsewhere in the crates.
    Crate,
    /// In a test of any package.
    Test,
    /// In a chapter's lesson.
    Lesson,
    /// In the map of the root's README.md.
    Map,
    /// In the code of a figure.
    Figure,
    /// In other code of a chapter.
    Chapter,
}

impl Kind {
    /// The word for it in lists.
    pub fn name(self) -> &'static str {
        match self {
            Self::Definition => "definition",
            Self::Statement => "statement",
            Self::Crate => "crate",
            Self::Test => "test",
            Self::Lesson => "lesson",
            Self::Map => "map",
            Self::Figure => "figure",
            Self::Chapter => "chapter",
        }
    }

    /// Whether the label means something because of this place.
    pub fn defines(self) -> bool {
        matches!(self, Self::Definition | Self::Statement)
    }
}

/// A line with a label on it. The place of a [`Kind::Definition`] is the line of its item.
#[derive(Debug)]
pub struct Place<'a> {
    /// The file, from the root.
    pub file: &'a str,
    /// The line, from 1.
    pub line: usize,
    /// What the label does there.
    pub kind: Kind,
    /// The line without the space around it.
    pub text: &'a str,
}

/// All places of all labels, by label; a label's places by kind, file and line.
pub fn find(sources: &[Source]) -> BTreeMap<&str, Vec<Place<'_>>> {
    let mut labels: BTreeMap<&str, Vec<Place>> = BTreeMap::new();
    for source in sources.iter().filter(|source| speaks_of_labels(&source.path)) {
        let lines: Vec<Line> = source.lines().collect();
        let mut in_text_block = false;
        for (index, line) in lines.iter().enumerate() {
            let in_crate = source.is_rust() && source.path.starts_with("crates/") && !line.in_test;
            let module_doc = line.text.strip_prefix("//!").filter(|_| in_crate).map(str::trim);
            if let Some(fence) = module_doc.and_then(|doc| doc.strip_prefix("```")) {
                in_text_block = fence == "text";
            }
            for label in labels_in(line.text) {
                let alias = format!("#[doc(alias = \"{label}\")]");
                let (place, kind) = if in_crate && line.text.trim() == alias {
                    (item_below(&lines[index..]), Kind::Definition)
                } else if in_text_block && module_doc.is_some_and(|doc| doc.starts_with(label)) {
                    (line, Kind::Statement)
                } else {
                    (line, kind_of_mention(&source.path, line.in_test))
                };
                let place =
                    Place { file: &source.path, line: place.number, kind, text: place.text.trim() };
                let places = labels.entry(label).or_default();
                let known = |p: &Place| (p.file, p.line, p.kind) == (place.file, place.line, kind);
                if !places.iter().any(known) {
                    places.push(place);
                }
            }
        }
    }
    for places in labels.values_mut() {
        places.sort_by_key(|place| (place.kind, place.file, place.line));
    }
    labels
}

fn speaks_of_labels(path: &str) -> bool {
    let in_scope = ["crates/", "chapters/", "tests/"].iter().any(|root| path.starts_with(root));
    path == "README.md" || in_scope && (path.ends_with(".rs") || path.ends_with(".md"))
}

fn kind_of_mention(path: &str, in_test: bool) -> Kind {
    let in_chapter = path.strip_prefix("chapters/").and_then(|path| path.split_once('/'));
    match in_chapter {
        _ if path == "README.md" => Kind::Map,
        _ if in_test => Kind::Test,
        Some((_, "README.md")) => Kind::Lesson,
        Some((_, file)) if file.starts_with("src/figures") => Kind::Figure,
        Some(_) => Kind::Chapter,
        None => Kind::Crate,
    }
}

/// The first line below that is neither an attribute nor documentation.
fn item_below<'l, 'a>(lines: &'l [Line<'a>]) -> &'l Line<'a> {
    let is_item = |line: &&Line| {
        let text = line.text.trim_start();
        !text.starts_with('#') && !text.starts_with("//")
    };
    lines.iter().find(is_item).unwrap_or(&lines[0])
}

/// The name of the item that a line begins: `reflect` for `pub fn reflect(incident: DVec3`.
pub fn item_name(line: &str) -> &str {
    let keywords = ["fn", "struct", "enum", "trait", "const", "static", "type", "mod"];
    let mut words = line.split([' ', '(', '<', ':', ';', '=', '{']);
    // `const fn f` is a function.
    words.by_ref().find(|word| keywords.contains(word));
    words.find(|word| !keywords.contains(word)).unwrap_or_default()
}

fn labels_in(text: &str) -> impl Iterator<Item = &str> {
    ["eq:", "algo:", "fig:"].into_iter().flat_map(move |prefix| {
        text.match_indices(prefix).filter_map(move |(start, _)| {
            let is_name = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            let after = &text[start + prefix.len()..];
            let name = &after[..after.find(|c| !is_name(c)).unwrap_or(after.len())];
            let name = name.trim_end_matches('-');
            let whole_word = !text[..start].ends_with(|c: char| c.is_alphanumeric() || c == '_');
            (whole_word && !name.is_empty())
                .then(|| &text[start..start + prefix.len() + name.len()])
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_whole_words() {
        let labels: Vec<&str> =
            labels_in("`eq:local`, eq:ray-2: algo:lr. (fig:tree-) eq:… seq:no eq::path eq:X")
                .collect();
        assert_eq!(labels, ["eq:local", "eq:ray-2", "algo:lr", "fig:tree"]);
    }

    #[test]
    fn items_have_names() {
        for (line, name) in [
            ("pub fn reflect(incident: DVec3, n: DVec3) -> DVec3 {", "reflect"),
            ("    pub(crate) const fn attenuation<T>(t: T) -> f64 {", "attenuation"),
            ("pub struct RayTree {", "RayTree"),
            ("pub trait Recorder: Sized {", "Recorder"),
            ("const K: f64 = 1.0;", "K"),
            ("}", ""),
        ] {
            assert_eq!(item_name(line), name, "{line}");
        }
    }

    #[test]
    fn every_kind_of_place_is_told_apart() {
        let label = "eq:x";
        let kinds = |path: &str, text: &str| {
            let sources = [Source::new(path, text)];
            let labels = find(&sources);
            let places = labels.get(label).map(Vec::as_slice).unwrap_or_default();
            places.iter().map(|place| (place.kind, place.line)).collect::<Vec<_>>()
        };
        let alias = "/// eq:x\n#[doc(alias = \"eq:x\")]\n#[inline]\n/// more\npub fn x() {\n}\n";
        assert_eq!(kinds("crates/a/src/lib.rs", alias), [(Kind::Definition, 5), (Kind::Crate, 1)]);
        // A copy of the function in an exercise, or in a test, defines nothing.
        assert_eq!(kinds("chapters/1/src/a.rs", alias), [(Kind::Chapter, 1), (Kind::Chapter, 2)]);
        assert_eq!(kinds("crates/a/tests/b.rs", alias), [(Kind::Test, 1), (Kind::Test, 2)]);

        let block = "//! ```text\n//! eq:x   a = b\n//! or eq:x\n//! ```\n//! eq:x\n";
        let expected = [(Kind::Statement, 2), (Kind::Crate, 3), (Kind::Crate, 5)];
        assert_eq!(kinds("crates/a/src/lib.rs", block), expected);
        let function_doc = block.replace("//!", "///");
        let expected = [(Kind::Crate, 2), (Kind::Crate, 3), (Kind::Crate, 5)];
        assert_eq!(kinds("crates/a/src/lib.rs", &function_doc), expected);

        let test = "#[cfg(test)]\nmod tests {\n    // eq:x, eq:x\n}\n// eq:x\n";
        let expected = [(Kind::Crate, 5), (Kind::Test, 3)];
        assert_eq!(kinds("crates/a/src/lib.rs", test), expected);
        assert_eq!(kinds("chapters/1/README.md", label), [(Kind::Lesson, 1)]);
        assert_eq!(kinds("README.md", label), [(Kind::Map, 1)]);
        for path in ["chapters/1/src/figures.rs", "chapters/1/src/figures/a.rs"] {
            assert_eq!(kinds(path, label), [(Kind::Figure, 1)]);
        }
        for path in ["xtask/src/a.rs", "CHANGELOG.md", "crates/a/x.toml"] {
            assert_eq!(kinds(path, label), []);
        }
    }
}
