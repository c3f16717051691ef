//! What a SCENE argument means.

use std::path::Path;

use anyhow::{Result, anyhow};
use lancer_core::scene::load::{Loaded, load};

use crate::chapters::scenes;
use crate::names::choose;

/// Loads a `.toml` or `.obj` file, or a scene of the course by name: `whitted`, `room`, or a generated
/// one with its level, `flake:4`, or number of triangles, `soup:5000`.
///
/// # Errors
/// As the loader; for what is neither a file nor a known name, the known names.
pub fn open(scene: &str) -> Result<Loaded> {
    let (name, variant) = match scene.split_once(':') {
        Some((name, variant)) => (name, Some(variant)),
        None => (scene, None),
    };
    let all: Vec<_> = scenes().collect();
    let known: Vec<&str> = all.iter().map(|scene| scene.name).collect();
    let chosen = choose("scene", name, &known);
    let path = Path::new(scene);
    if chosen.is_err() && (path.extension().is_some() || path.exists()) {
        return Ok(load(path)?);
    }
    all[chosen.map_err(|error| anyhow!("{error}; or name a .toml or .obj file"))?].open(variant)
}
