//! The course's scenes by name: written ones, and generated ones of a size that one chooses.

use std::path::Path;

use anyhow::{Result, ensure};
use lancer_core::scene::Scene;
use lancer_core::scene::load::{Loaded, parse_scene};

/// A scene of a chapter.
#[derive(Clone, Copy)]
pub struct NamedScene {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is made from.
    pub source: Source,
}

/// What a scene is made from.
#[derive(Clone, Copy)]
pub enum Source {
    /// The text of a scene file.
    Written(&'static str),
    /// A function.
    Generated {
        /// What may follow the name and a colon, with an example: `a level of detail, such as flake:4`.
        variants: &'static str,
        /// Makes the scene of that name, with what followed it.
        make: fn(&'static str, Option<&str>) -> Result<Loaded>,
    },
}

impl NamedScene {
    /// A scene from the text of a scene file.
    pub const fn written(name: &'static str, text: &'static str) -> Self {
        Self { name, source: Source::Written(text) }
    }

    /// Opens the scene; `variant` is what followed its name and a colon.
    ///
    /// # Errors
    /// If there is no such variant.
    pub fn open(&self, variant: Option<&str>) -> Result<Loaded> {
        match self.source {
            Source::Written(text) => {
                let name = self.name;
                ensure!(
                    variant.is_none(),
                    "{name}: only generated scenes have a level; leave it out"
                );
                Ok(parse_scene(text, name, Path::new(""))?)
            }
            Source::Generated { make, .. } => make(self.name, variant),
        }
    }
}

/// The scene of a text in the code.
///
/// # Panics
/// If it is none.
pub fn parsed(name: &str, text: &str) -> Scene {
    let loaded = parse_scene(text, name, Path::new(""));
    loaded.unwrap_or_else(|error| panic!("a test loads every scene of the course: {error}")).scene
}
