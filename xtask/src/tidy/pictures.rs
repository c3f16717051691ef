use std::collections::BTreeMap;

use super::Violation;
use crate::repository::File;

/// 1.5 MiB.
const MOST_BYTES: u64 = 3 << 19;

/// The pictures of a chapter stay small together, so that the repository does.
pub fn check(files: &[File]) -> Vec<Violation> {
    let mut chapters: BTreeMap<&str, u64> = BTreeMap::new();
    for file in files {
        let is_picture =
            [".png", ".exr", ".jpg", ".svg", ".gif"].iter().any(|end| file.path.ends_with(end));
        let chapter = file.path.strip_prefix("chapters/").and_then(|path| path.split('/').next());
        if let (true, Some(chapter)) = (is_picture, chapter) {
            *chapters.entry(chapter).or_default() += file.length;
        }
    }
    let report = |(chapter, bytes): (&str, u64)| Violation {
        file: format!("chapters/{chapter}"),
        line: 1,
        problem: format!("{bytes} bytes of pictures, the most is {MOST_BYTES}"),
        cure: "make them smaller or fewer",
    };
    chapters.into_iter().filter(|(_, bytes)| *bytes > MOST_BYTES).map(report).collect()
}

#[cfg(test)]
mod tests {
    use insta::assert_snapshot;

    use super::super::lines;
    use super::*;

    #[test]
    fn a_chapters_pictures_are_weighed_together() {
        let files = |length| {
            [
                ("chapters/1/a.png", MOST_BYTES - 5),
                ("chapters/1/figures/b.svg", length),
                ("chapters/1/README.md", MOST_BYTES),
                ("chapters/2/c.exr", MOST_BYTES),
                ("crates/core/tests/d.png", MOST_BYTES + 1),
            ]
            .map(|(path, length)| File { path: path.to_owned(), length })
        };
        assert_eq!(lines(&check(&files(5))), "");
        assert_snapshot!(lines(&check(&files(6))), @"chapters/1:1: 1572865 bytes of pictures, the most is 1572864; make them smaller or fewer");
    }
}
