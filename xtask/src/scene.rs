//! What a SCENE argument means.

use std::path::Path;

use anyhow::{Result, anyhow};
use lancer_core::scene::load::{Loaded, load};

use crate::names::choose;

/// Loads a `.toml` or `.obj` file, or a scene of the course by name: `whitted`, `room`, or a generated
/// one with its level, `flake:4`.
///
/// # Errors
/// As the loader; for what is neither a file nor a known name, the known names.
pub fn open(scene: &str) -> Result<Loaded> {
    let (name, level) = match scene.split_once(':') {
        Some((name, level)) => (name, Some(level)),
        None => (scene, None),
    };
    let known: Vec<&str> = chapter_1::scenes::NAMES.to_vec();
    let chosen = choose("scene", name, &known);
    let path = Path::new(scene);
    if chosen.is_err() && (path.extension().is_some() || path.exists()) {
        return Ok(load(path)?);
    }
    let name = known[chosen.map_err(|error| anyhow!("{error}; or name a .toml or .obj file"))?];
    chapter_1::scenes::open(name, level)
}
