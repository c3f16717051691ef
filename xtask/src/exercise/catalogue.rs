//! The exercises of all chapters, in the course's order.

use anyhow::{Result, bail};
use lancer_exercise::Card;

use crate::chapters::CHAPTERS;
use crate::names::choose;
use crate::repository::root;

/// A chapter, as far as its exercises are concerned.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Chapter {
    /// Its folder in `chapters/`.
    pub folder: &'static str,
    /// Its package.
    pub package: &'static str,
}

/// An exercise and its chapter.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Where it belongs.
    pub chapter: Chapter,
    /// What there is to know of it.
    pub card: Card,
}

/// All exercises.
pub fn entries() -> Vec<Entry> {
    let of_chapter = |known: &lancer_lesson::Chapter| {
        let chapter = Chapter { folder: known.folder, package: known.course.package() };
        known.course.cards().into_iter().map(move |card| Entry { chapter, card })
    };
    CHAPTERS.into_iter().flat_map(of_chapter).collect()
}

/// The exercise called `given`: by its id, E1.6, that without the letter or the chapter, or its name.
///
/// # Errors
/// An unknown one is answered with the known ones, the nearest first.
pub fn find(given: &str) -> Result<Entry> {
    find_in(&entries(), given)
}

fn find_in(entries: &[Entry], given: &str) -> Result<Entry> {
    let short_forms = |entry: &Entry| {
        let number = entry.card.id.trim_start_matches('E');
        [Some(number), number.split_once('.').map(|(_, own)| own)]
    };
    let meant: Vec<&Entry> =
        entries.iter().filter(|entry| short_forms(entry).contains(&Some(given))).collect();
    match meant[..] {
        [entry] => return Ok(*entry),
        [] => {}
        _ => {
            let ids: Vec<&str> = meant.iter().map(|entry| entry.card.id).collect();
            bail!("`{given}` is several exercises; name one: {}", ids.join(", "));
        }
    }
    let known: Vec<&str> =
        entries.iter().flat_map(|entry| [entry.card.id, entry.card.name]).collect();
    // Two names each.
    Ok(entries[choose("exercise", given, &known)? / 2])
}

impl Entry {
    /// Its id and name, `E1.6 reflected-ray`.
    pub fn title(&self) -> String {
        format!("{} {}", self.card.id, self.card.name)
    }

    /// The pristine stub, from the root of the repository.
    pub fn stub_path(&self) -> String {
        format!("chapters/{}/stubs/{}", self.chapter.folder, self.card.file())
    }

    /// How the stub writes a function, up to its body, on one line.
    pub fn signature(&self, function: &str) -> String {
        let text = self.card.stub;
        let start = text.find(&format!("pub fn {function}(")).unwrap_or(text.len());
        let signature = text[start..].split('{').next().unwrap_or_default();
        let line = signature.split_whitespace().collect::<Vec<_>>().join(" ");
        line.replace("( ", "(").replace(", )", ")")
    }

    /// Where the lesson comes to it: its file, and the heading above the first mention of the exercise, or
    /// else the one that the slide's title begins with.
    pub fn lesson(&self) -> String {
        let file = format!("chapters/{}/README.md", self.chapter.folder);
        let text = std::fs::read_to_string(root().join(&file)).unwrap_or_default();
        match self.section(&text) {
            Some(section) => format!("{file}, « {section} »"),
            None => file,
        }
    }

    fn section<'a>(&self, lesson: &'a str) -> Option<&'a str> {
        let mentions = |line: &str| {
            let mut words = line.split(|c: char| !(c.is_alphanumeric() || c == '.'));
            words.any(|word| word.trim_end_matches('.') == self.card.id)
        };
        let mut heading = None;
        let mut of_slide = None;
        for line in lesson.lines() {
            if let Some(title) = line.strip_prefix("## ") {
                heading = Some(title);
                let topic = title.split(':').next().unwrap_or(title).trim();
                if of_slide.is_none() && self.card.slide.starts_with(topic) {
                    of_slide = heading;
                }
            }
            if mentions(line) {
                return heading;
            }
        }
        of_slide
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHAPTER: Chapter = Chapter { folder: "1-whitted", package: "chapter-1" };

    fn entry(id: &'static str, name: &'static str) -> Entry {
        let mut entry = entries()[0];
        entry.chapter = CHAPTER;
        (entry.card.id, entry.card.name) = (id, name);
        entry
    }

    #[test]
    fn an_exercise_is_found_by_id_number_and_name() {
        let entries = [entry("E1.1", "a"), entry("E1.6", "b"), entry("E1.10", "c")];
        let name = |given| find_in(&entries, given).unwrap().card.name;
        let given = ["E1.6", "e1.6", "1.6", "6", "b", "B", "10", "1"];
        assert_eq!(given.map(name), ["b", "b", "b", "b", "b", "b", "c", "a"]);
        let error = find_in(&entries, "E1.66").err().unwrap().to_string();
        assert!(error.starts_with("unknown exercise `E1.66`; known: E1.6, "), "{error}");
    }

    #[test]
    fn a_number_of_several_chapters_is_ambiguous() {
        let entries = [entry("E1.6", "a"), entry("E2.6", "b")];
        let error = find_in(&entries, "6").err().unwrap().to_string();
        assert_eq!(error, "`6` is several exercises; name one: E1.6, E2.6");
        assert_eq!(find_in(&entries, "2.6").unwrap().card.name, "b");
    }

    #[test]
    fn a_signature_is_one_line_of_the_stub() {
        let mut entry = entry("E1.6", "a");
        entry.card.stub = "/// f\npub fn f(a: u32) -> u32 {\n    todo!()\n}\n\npub fn f_long(\n    a: &[f64],\n    b: f64,\n) -> f64 {\n}\n";
        assert_eq!(entry.signature("f"), "pub fn f(a: u32) -> u32");
        assert_eq!(entry.signature("f_long"), "pub fn f_long(a: &[f64], b: f64) -> f64");
    }

    #[test]
    fn the_lesson_is_opened_where_the_exercise_or_its_slide_is() {
        let mut entry = entry("E1.1", "a");
        entry.card.slide = "Reflets : calcul";
        let lesson = "# 1\n## Un: one\n## Reflets\n## Arbre\nDo E1.10, then **E1.1**.\n## E\n";
        assert_eq!(entry.section(lesson), Some("Arbre"));
        assert_eq!(entry.section(&lesson.replace("E1.1", "")), Some("Reflets"));
        assert_eq!(entry.section("## Un"), None);
    }
}
