//! Where the course's own code does what an answer does.

/// The line on which an item begins, from 1, given how its first line begins: `pub fn reflect` is not
/// `pub fn reflected`.
pub fn line_of(source: &str, start: &str) -> Option<usize> {
    let begins = |line: &str| {
        let rest = line.trim_start().strip_prefix(start);
        rest.is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
    };
    source.lines().position(begins).map(|before| before + 1)
}

#[cfg(test)]
mod tests {
    use super::super::catalogue::entries;
    use super::*;
    use crate::repository::root;

    #[test]
    fn an_item_is_found_by_its_whole_name() {
        let source = "//! Optics.\n\npub fn reflected() {}\n\n/// Mirrors.\npub fn reflect(\n    v: V,\n) -> V {\n}\n\
                      impl V {\n    fn norm(&self) {}\n}\n";
        let lines = ["pub fn reflected", "pub fn reflect", "fn norm", "pub fn nothing"];
        assert_eq!(lines.map(|item| line_of(source, item)), [Some(3), Some(6), Some(11), None]);
    }

    /// What is printed can stand in the place of the stub: it has the same first line, no more of it to write, and
    /// the functions with the same types. That it passes every check is proved in the chapters.
    #[test]
    fn every_exercise_has_a_whole_answer_and_a_place_in_the_course() {
        for entry in entries() {
            let (title, card) = (entry.title(), entry.card);
            let (stub, answer) = (card.stub, card.solution.answer);
            assert_eq!(answer.lines().next(), stub.lines().next(), "{title}");
            assert!(!answer.contains("todo!"), "{title}");
            let mut answered = entry;
            answered.card.stub = answer;
            for function in card.functions {
                let wanted = entry.signature(function);
                assert!(!wanted.is_empty(), "{title}");
                assert_eq!(answered.signature(function), wanted, "{title}");
            }
            let source = std::fs::read_to_string(root().join(card.solution.file)).unwrap();
            assert!(line_of(&source, card.solution.item).is_some(), "{title}");
        }
    }
}
