use super::Violation;
use crate::repository::{File, Source};

/// Links in Markdown to files and folders of the repository lead somewhere; built files do not count.
pub fn check(sources: &[Source], files: &[File]) -> Vec<Violation> {
    let exists = |path: String| {
        let folder = format!("{path}/");
        path.is_empty() || files.iter().any(|f| f.path == path || f.path.starts_with(&folder))
    };
    let mut violations = Vec::new();
    for source in sources.iter().filter(|source| source.path.ends_with(".md")) {
        let mut in_code = false;
        for line in source.lines() {
            if line.text.trim_start().starts_with("```") {
                in_code = !in_code;
            }
            if in_code {
                continue;
            }
            for target in targets(line.text) {
                let path = target.split(['#', '?']).next().unwrap_or_default();
                let elsewhere = path.is_empty() || path.contains(':');
                let reached = elsewhere || resolve(&source.path, path).is_some_and(exists);
                if !reached {
                    violations.push(Violation {
                        file: source.path.clone(),
                        line: line.number,
                        problem: format!("the link to `{target}` leads nowhere"),
                        cure: "name a file of the repository, seen from this one",
                    });
                }
            }
        }
    }
    violations
}

/// Where the links of a line lead: `[…](target "title")`, `src="target"`, `href="target"`.
fn targets(line: &str) -> Vec<String> {
    // Every second part is between backquotes.
    let text: String = line.split('`').step_by(2).collect();
    let starts = [("](", ')'), ("src=\"", '"'), ("href=\"", '"')];
    let mut found = Vec::new();
    for (start, end) in starts {
        for part in text.split(start).skip(1) {
            let inside = part.split(end).next().unwrap_or_default();
            let target = inside.split_whitespace().next().unwrap_or_default();
            found.push(target.trim_matches(['<', '>']).to_owned());
        }
    }
    found
}

/// A path from the root; `None` outside the repository.
fn resolve(from: &str, link: &str) -> Option<String> {
    let mut parts: Vec<&str> = from.split('/').collect();
    parts.pop();
    for part in link.split('/') {
        match part {
            "." | "" => {}
            ".." => drop(parts.pop()?),
            _ => parts.push(part),
        }
    }
    Some(parts.join("/"))
}

#[cfg(test)]
mod tests {
    use insta::assert_snapshot;

    use super::super::lines;
    use super::*;

    fn of(text: &str) -> String {
        let files = ["README.md", "a/b.md", "a/p.png"];
        let files = files.map(|path| File { path: path.to_owned(), length: 0 });
        lines(&check(&[Source::new("a/b.md", text)], &files))
    }

    #[test]
    fn links_that_lead_somewhere_pass() {
        let text = "[x](b.md) [a](../a/) [`x`](../README.md#map) ![p](./p.png \"title\") [w](https://a.b/c)\n\
                    <img src=\"p.png\"> [here](#there) <a href=\"mailto:a@b.c\"> `[no](link)`\n\
                    ```\n[no](link)\n```\n";
        assert_eq!(of(text), "");
    }

    #[test]
    fn links_that_lead_nowhere_are_reported() {
        let text = "[x](b.md) [y](c.md#z)\n[z](../../README.md)\n```\n```\n<img src=\"q.png\">\n";
        assert_snapshot!(of(text), @r"
        a/b.md:1: the link to `c.md#z` leads nowhere; name a file of the repository, seen from this one
        a/b.md:2: the link to `../../README.md` leads nowhere; name a file of the repository, seen from this one
        a/b.md:5: the link to `q.png` leads nowhere; name a file of the repository, seen from this one
        ");
    }
}
