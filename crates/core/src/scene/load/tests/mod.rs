//! Whole files, good and hostile, read from memory.

mod closed;
mod harmless;
mod highlight;
mod limits;
mod mtl;
mod obj;
mod scene_toml;

use std::io::{self, Cursor, Read};
use std::path::Path;

use super::*;

/// Loads `name` from the files given by name and content.
fn load_from(files: &[(&str, &[u8])], name: &str) -> Result<Loaded, LoadError> {
    let open = |path: &Path, _: Option<&Path>| -> io::Result<Box<dyn Read>> {
        let found = files.iter().find(|(name, _)| Path::new(name) == path);
        let (_, bytes) = found.ok_or(io::ErrorKind::NotFound)?;
        Ok(Box::new(Cursor::new(bytes.to_vec())))
    };
    load_with(Path::new(name), &open)
}

fn obj(text: impl AsRef<[u8]>) -> Result<Loaded, LoadError> {
    load_from(&[("a.obj", text.as_ref())], "a.obj")
}

fn warnings(loaded: &Loaded) -> Vec<String> {
    loaded.warnings.iter().map(ToString::to_string).collect()
}

#[track_caller]
fn assert_refused(result: Result<Loaded, LoadError>, message: &str) {
    assert_eq!(result.expect_err("refused").to_string(), message);
}

/// Names of files that are in no folder of ours, as the systems write them.
const OUTSIDE: [&str; 8] = [
    "../m.mtl",
    "/etc/passwd",
    "lib/../../m.mtl",
    "..\\m.mtl",
    "C:\\m.mtl",
    "c:m.mtl",
    "\\m.mtl",
    "\\\\server\\share\\m.mtl",
];

fn is_outside(name: &str) -> String {
    let name = name.replace('\\', "/");
    format!(
        "`{name}` is outside this file's folder; \
         put it beside this file or in a folder below, and name it from here"
    )
}

fn area(mesh: &Mesh) -> f64 {
    let corners = (0..mesh.triangles.len()).map(|i| mesh.corners(i));
    corners.map(|c| 0.5 * crate::geometry::newell_normal(&c).length()).sum()
}
