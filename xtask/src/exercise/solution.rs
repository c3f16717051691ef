//! An item of the course's code, cut out of its file.

/// An item with its documentation and attributes.
#[derive(Debug, PartialEq, Eq)]
pub struct Item<'a> {
    /// The line on which the item itself begins, from 1.
    pub line: usize,
    /// From its documentation to its last brace.
    pub text: &'a str,
}

/// The item whose first line begins with `start`. The source is expected as rustfmt leaves it: an item ends
/// with a `}` or `;` that is indented as its first line is.
pub fn item<'a>(source: &'a str, start: &str) -> Option<Item<'a>> {
    let lines: Vec<&str> = source.lines().collect();
    let begins = |line: &&str| {
        // `pub fn reflect` is not `pub fn reflected`.
        let rest = line.trim_start().strip_prefix(start);
        rest.is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
    };
    let first = lines.iter().position(begins)?;
    let indent = |line: &str| line.len() - line.trim_start().len();
    let own = indent(lines[first]);
    let belongs = |line: &&&str| {
        let line = line.trim_start();
        line.starts_with("///") || line.starts_with("#[")
    };
    let top = first - lines[..first].iter().rev().take_while(belongs).count();
    let ends = |line: &&str| indent(line) == own && line.ends_with(['}', ';']);
    let last = first + lines[first..].iter().position(ends)?;
    let offset = |line: &str| line.as_ptr() as usize - source.as_ptr() as usize;
    let text = &source[offset(lines[top])..offset(lines[last]) + lines[last].len()];
    Some(Item { line: first + 1, text })
}

#[cfg(test)]
mod tests {
    use super::super::catalogue::entries;
    use super::*;
    use crate::repository::root;

    const SOURCE: &str = "//! Optics.\n\npub fn reflected() {}\n\n/// Mirrors.\n#[doc(alias = \"R\")]\n\
                          pub fn reflect(\n    v: V,\n) -> V {\n    if a {\n    }\n}\n\npub fn b() {\n}\n\
                          impl V {\n    /// Norm.\n    fn norm(&self) {\n        x;\n    }\n}\n\
                          const C: u32 = 1;\n";

    #[test]
    fn an_item_is_whole_with_its_documentation() {
        let reflect = item(SOURCE, "pub fn reflect").unwrap();
        assert_eq!(reflect.line, 7);
        assert!(reflect.text.starts_with("/// Mirrors.\n#[doc"), "{}", reflect.text);
        assert!(reflect.text.ends_with("    }\n}"), "{}", reflect.text);
        let norm = item(SOURCE, "fn norm").unwrap();
        assert_eq!(norm.text, "    /// Norm.\n    fn norm(&self) {\n        x;\n    }");
        assert_eq!(item(SOURCE, "const C").unwrap().text, "const C: u32 = 1;");
        assert_eq!(item(SOURCE, "pub fn reflected").unwrap().text, "pub fn reflected() {}");
        assert_eq!(item(SOURCE, "pub fn nothing"), None);
    }

    #[test]
    fn every_exercise_has_its_answer_in_the_course() {
        for entry in entries() {
            let solution = entry.card.solution;
            let source = std::fs::read_to_string(root().join(solution.file)).unwrap();
            assert!(item(&source, solution.item).is_some(), "{}: {solution:?}", entry.title());
        }
    }
}
