//! What a SCENE argument means.

use std::path::Path;

use anyhow::{Result, anyhow};
use lancer_core::scene::load::{Loaded, load};

use crate::names::choose;

/// Loads a `.toml` or `.obj` file, or a scene of the course by name: `whitted`, `room`, or a generated
/// one with its level, `flake:4`, or number of triangles, `soup:5000`.
///
/// # Errors
/// As the loader; for what is neither a file nor a known name, the known names.
pub fn open(scene: &str) -> Result<Loaded> {
    let (name, level) = match scene.split_once(':') {
        Some((name, level)) => (name, Some(level)),
        None => (scene, None),
    };
    let generated = chapter_4::scenes::FAMILIES.map(|family| family.name);
    let known: Vec<&str> = chapter_1::scenes::NAMES.into_iter().chain(generated).collect();
    let chosen = choose("scene", name, &known);
    let path = Path::new(scene);
    if chosen.is_err() && (path.extension().is_some() || path.exists()) {
        return Ok(load(path)?);
    }
    let name = known[chosen.map_err(|error| anyhow!("{error}; or name a .toml or .obj file"))?];
    if generated.contains(&name) {
        return chapter_4::scenes::open(name, level);
    }
    chapter_1::scenes::open(name, level)
}
