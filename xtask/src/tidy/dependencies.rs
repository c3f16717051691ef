use anyhow::{Context, Result};
use toml::{Table, Value};

use super::Violation;
use crate::repository::Source;

/// The arrows between packages: in `crates/`, core and figure use none of ours, exercise uses these two, lesson
/// these three, and the others use core alone, except in their own tests and benches. A chapter uses any of the
/// crates and no other chapter; tests and xtask may use all.
///
/// # Errors
/// If a manifest is no TOML.
pub fn check(sources: &[Source]) -> Result<Vec<Violation>> {
    let packages = sources
        .iter()
        .filter(|source| format!("/{}", source.path).ends_with("/Cargo.toml"))
        .map(Manifest::read)
        .collect::<Result<Vec<_>>>()?;
    let workspace = packages
        .iter()
        .find(|package| package.source.path == "Cargo.toml")
        .and_then(|root| root.table.get("workspace")?.get("dependencies")?.as_table().cloned())
        .unwrap_or_default();

    let mut violations = Vec::new();
    for package in &packages {
        let name = package.name().unwrap_or_default();
        if name == "core" {
            violations.push(package.violation(
                "name",
                "a package is called `core`".to_owned(),
                SHADOW,
            ));
        }
        for Dependency { key, value, is_dev } in package.dependencies() {
            let used =
                renamed(value).or_else(|| workspace.get(key).and_then(renamed)).unwrap_or(key);
            if key == "core" || used == "core" {
                let problem = format!("the dependency `{key}` is called `core`");
                violations.push(package.violation(key, problem, SHADOW));
            }
            let ours = packages.iter().find(|other| other.name() == Some(used));
            if ours.is_some_and(|other| !may_use(package.folder(), other.folder(), is_dev)) {
                let problem = format!("{name} must not know {used}");
                let cure = if used.starts_with("chapter") {
                    "move what both need to crates/lesson, or below it"
                } else {
                    "take what it needs as an argument, or move the code to a chapter"
                };
                violations.push(package.violation(key, problem, cure));
            }
        }
    }
    Ok(violations)
}

const SHADOW: &str = "rename it: it takes the place of Rust's own `core`";

fn may_use(user: &str, used: &str, is_dev: bool) -> bool {
    let crates: &[&str] = match user {
        "crates/core" | "crates/figure" => &[],
        "crates/exercise" => &["crates/core", "crates/figure"],
        "crates/lesson" => &["crates/core", "crates/figure", "crates/exercise"],
        _ if user.starts_with("chapters/") => return used.starts_with("crates/"),
        _ if user.starts_with("crates/") && is_dev => return used.starts_with("crates/"),
        _ if user.starts_with("crates/") => &["crates/core"],
        _ => return true,
    };
    crates.contains(&used)
}

struct Manifest<'a> {
    source: &'a Source,
    table: Table,
}

struct Dependency<'a> {
    key: &'a str,
    value: &'a Value,
    is_dev: bool,
}

impl<'a> Manifest<'a> {
    fn read(source: &'a Source) -> Result<Self> {
        let table = source.text.parse().with_context(|| format!("cannot read {}", source.path))?;
        Ok(Self { source, table })
    }

    fn name(&self) -> Option<&str> {
        self.table.get("package")?.get("name")?.as_str()
    }

    fn folder(&self) -> &str {
        self.source.path.strip_suffix("/Cargo.toml").unwrap_or_default()
    }

    /// All dependencies, of the workspace and of single targets too.
    fn dependencies(&self) -> Vec<Dependency<'_>> {
        let targets = self.table.get("target").and_then(Value::as_table);
        let workspace = self.table.get("workspace").and_then(Value::as_table);
        let tables = targets.into_iter().flat_map(|targets| targets.values());
        let tables = tables.filter_map(Value::as_table).chain(workspace).chain([&self.table]);
        let mut found = Vec::new();
        for table in tables {
            for section in ["dependencies", "dev-dependencies", "build-dependencies"] {
                let entries = table.get(section).and_then(Value::as_table).into_iter().flatten();
                let is_dev = section.starts_with("dev");
                found.extend(entries.map(|(key, value)| Dependency { key, value, is_dev }));
            }
        }
        found
    }

    /// A violation at the first line that starts with `key`.
    fn violation(&self, key: &str, problem: String, cure: &'static str) -> Violation {
        let starts = |line: &str| {
            let rest = line.trim_start().strip_prefix(key);
            rest.is_some_and(|rest| rest.starts_with(['.', ' ', '=']))
        };
        let line = 1 + self.source.text.lines().position(starts).unwrap_or(0);
        Violation { file: self.source.path.clone(), line, problem, cure }
    }
}

/// The package that a dependency under another name stands for.
fn renamed(value: &Value) -> Option<&str> {
    value.get("package")?.as_str()
}

#[cfg(test)]
mod tests {
    use insta::assert_snapshot;

    use super::super::lines;
    use super::*;

    /// A small workspace of which one manifest is `text` instead.
    fn with(path: &str, text: &str) -> String {
        let mut sources: Vec<Source> = [
            ("Cargo.toml", "[workspace.dependencies]\nlancer-core.path = \"crates/core\"\n"),
            (
                "chapters/1/Cargo.toml",
                "[package]\nname = \"chapter-1\"\n[dependencies]\nlancer-a.workspace = true\n",
            ),
            (
                "crates/a/Cargo.toml",
                "[package]\nname = \"lancer-a\"\n[dependencies]\nlancer-core.workspace = true\n",
            ),
            (
                "crates/b/Cargo.toml",
                "[package]\nname = \"lancer-b\"\n[dev-dependencies]\nlancer-a.workspace = true\n",
            ),
            (
                "crates/core/Cargo.toml",
                "[package]\nname = \"lancer-core\"\n[dependencies]\nglam = \"1\"\n",
            ),
            ("crates/figure/Cargo.toml", "[package]\nname = \"lancer-figure\"\n"),
        ]
        .into_iter()
        .filter(|(known, _)| *known != path)
        .map(|(path, text)| Source::new(path, text))
        .collect();
        sources.push(Source::new(path, text));
        lines(&check(&sources).unwrap())
    }

    #[test]
    fn the_allowed_arrows_pass() {
        assert_eq!(
            with(
                "xtask/Cargo.toml",
                "[package]\nname = \"xtask\"\n[dependencies]\nchapter-1 = {}\n"
            ),
            ""
        );
        assert_eq!(
            with(
                "crates/exercise/Cargo.toml",
                "[package]\nname = \"lancer-exercise\"\n[dependencies]\nlancer-figure = {}\n"
            ),
            ""
        );
        assert_eq!(
            with(
                "crates/lesson/Cargo.toml",
                "[package]\nname = \"lancer-lesson\"\n[dependencies]\nlancer-figure = {}\nlancer-core = {}\n"
            ),
            ""
        );
    }

    #[test]
    fn every_other_arrow_is_reported() {
        let uses = |folder: &str, dependencies: &str| {
            let text = format!("[package]\nname = \"lancer-{folder}\"\n{dependencies}\n");
            with(&format!("crates/{folder}/Cargo.toml"), &text)
        };
        assert_snapshot!(uses("core", "[dependencies]\nlancer-a.workspace = true"), @"crates/core/Cargo.toml:4: lancer-core must not know lancer-a; take what it needs as an argument, or move the code to a chapter");
        assert_snapshot!(uses("core", "[dev-dependencies]\nlancer-a.workspace = true"), @"crates/core/Cargo.toml:4: lancer-core must not know lancer-a; take what it needs as an argument, or move the code to a chapter");
        assert_snapshot!(uses("figure", "[dependencies]\nlancer-core = { path = \"../core\" }"), @"crates/figure/Cargo.toml:4: lancer-figure must not know lancer-core; take what it needs as an argument, or move the code to a chapter");
        assert_snapshot!(uses("b", "[build-dependencies]\nlancer-a.workspace = true"), @"crates/b/Cargo.toml:4: lancer-b must not know lancer-a; take what it needs as an argument, or move the code to a chapter");
        assert_snapshot!(uses("b", "[dev-dependencies]\nchapter-1.workspace = true"), @"crates/b/Cargo.toml:4: lancer-b must not know chapter-1; move what both need to crates/lesson, or below it");
        assert_snapshot!(uses("lesson", "[dependencies]\nlancer-a.workspace = true"), @"crates/lesson/Cargo.toml:4: lancer-lesson must not know lancer-a; take what it needs as an argument, or move the code to a chapter");
        for section in ["dependencies", "dev-dependencies"] {
            let text = format!(
                "[package]\nname = \"chapter-2\"\n[{section}]\nchapter-1.workspace = true\n"
            );
            assert_eq!(
                with("chapters/2/Cargo.toml", &text),
                "chapters/2/Cargo.toml:4: chapter-2 must not know chapter-1; move what both need to crates/lesson, or below it\n"
            );
        }
        assert_snapshot!(uses("b", "[target.'cfg(unix)'.dependencies]\nother = { package = \"lancer-a\" }"), @"crates/b/Cargo.toml:4: lancer-b must not know lancer-a; take what it needs as an argument, or move the code to a chapter");
    }

    #[test]
    fn nothing_is_called_core() {
        assert_snapshot!(with("x/Cargo.toml", "[package]\nname = \"core\"\n"), @"x/Cargo.toml:2: a package is called `core`; rename it: it takes the place of Rust's own `core`");
        assert_snapshot!(with("x/Cargo.toml", "[package]\nname = \"x\"\n[dependencies]\ncore = { package = \"lancer-core\" }\n"), @"x/Cargo.toml:4: the dependency `core` is called `core`; rename it: it takes the place of Rust's own `core`");
        assert_snapshot!(with("Cargo.toml", "[workspace.dependencies]\ncore.path = \"crates/core\"\n"), @"Cargo.toml:2: the dependency `core` is called `core`; rename it: it takes the place of Rust's own `core`");
    }

    #[test]
    fn a_broken_manifest_is_named() {
        let error = check(&[Source::new("a/Cargo.toml", "[package")]).unwrap_err();
        assert_eq!(error.to_string(), "cannot read a/Cargo.toml");
    }
}
