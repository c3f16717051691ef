//! The one list of chapters: whatever the course has is found through it.

use lancer_core::method::Method;
use lancer_figure::Figure;
use lancer_lesson::Chapter;
use lancer_lesson::chapter::Walkthrough;
use lancer_lesson::scenes::{NamedScene, Source};

/// All chapters, in the slides' order.
pub static CHAPTERS: [&Chapter; 3] =
    [&chapter_1::CHAPTER, &chapter_3::CHAPTER, &chapter_4::CHAPTER];

/// All figures, each with its chapter.
pub fn figures() -> impl Iterator<Item = (&'static Chapter, &'static Figure)> {
    CHAPTERS.into_iter().flat_map(|chapter| chapter.figures.iter().map(move |f| (chapter, f)))
}

/// All methods.
pub fn methods() -> impl Iterator<Item = &'static Method> {
    CHAPTERS.into_iter().flat_map(|chapter| chapter.methods)
}

/// All scenes.
pub fn scenes() -> impl Iterator<Item = &'static NamedScene> {
    CHAPTERS.into_iter().flat_map(|chapter| chapter.scenes)
}

/// All walks.
pub fn walks() -> impl Iterator<Item = &'static Walkthrough> {
    CHAPTERS.into_iter().flat_map(|chapter| chapter.walks)
}

/// The scenes in a sentence: `whitted, room, or one of soup and scan with a number of triangles, such as …`.
pub fn scenes_in_words() -> String {
    let mut parts: Vec<String> = Vec::new();
    let mut kinds: Vec<(&str, Vec<&str>)> = Vec::new();
    for scene in scenes() {
        match scene.source {
            Source::Written(_) => parts.push(scene.name.to_owned()),
            Source::Generated { variants, .. } => {
                match kinds.iter_mut().find(|(known, _)| *known == variants) {
                    Some((_, names)) => names.push(scene.name),
                    None => kinds.push((variants, vec![scene.name])),
                }
            }
        }
    }
    parts.extend(
        kinds
            .iter()
            .map(|(variants, names)| format!("one of {} with {variants}", list(names, "and"))),
    );
    match parts.split_last() {
        Some((last, first)) if !first.is_empty() => format!("{}, or {last}", first.join(", ")),
        _ => parts.concat(),
    }
}

/// `a, b and c`.
pub fn list(words: &[&str], last: &str) -> String {
    match words {
        [] => String::new(),
        [only] => (*only).to_owned(),
        [first @ .., end] => format!("{} {last} {end}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nothing of the course is asked for by a name that two things share.
    #[test]
    fn names_are_unique() {
        let figures: Vec<Figure> = figures().map(|(_, figure)| *figure).collect();
        Figure::prove_names(&figures);
        let names: [Vec<&str>; 4] = [
            CHAPTERS.iter().map(|chapter| chapter.number).collect(),
            methods().map(|method| method.name).collect(),
            scenes().map(|scene| scene.name).collect(),
            walks().map(|walk| walk.name).collect(),
        ];
        for mut names in names {
            let count = names.len();
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), count, "{names:?}");
        }
    }

    #[test]
    fn words_make_a_list() {
        assert_eq!(list(&["a"], "or"), "a");
        assert_eq!(list(&["a", "b", "c"], "or"), "a, b or c");
    }
}
