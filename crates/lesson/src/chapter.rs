//! A chapter as a value: all that the command line and other readers of the course ask it for.

use anyhow::Result;
use lancer_core::image::ImageSize;
use lancer_core::method::{Method, Setting};
use lancer_core::scene::load::Loaded;
use lancer_exercise::Shelf;
use lancer_figure::{Figure, Walk};

use crate::scenes::NamedScene;

/// A chapter of the course. What it has none of is an empty list.
pub struct Chapter {
    /// Its number in the course, `1`.
    pub number: &'static str,
    /// Its folder in `chapters/`, `1-whitted`.
    pub folder: &'static str,
    /// The slides' title, after the number.
    pub title: &'static str,
    /// Its figures, in the lesson's order.
    pub figures: &'static [Figure],
    /// Its exercises.
    pub course: &'static dyn Shelf,
    /// The scenes that it brings.
    pub scenes: &'static [NamedScene],
    /// The methods that it brings.
    pub methods: &'static [Method],
    /// Its algorithms, step by step.
    pub walks: &'static [Walkthrough],
}

/// An algorithm that can be walked through for one pixel.
pub struct Walkthrough {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is and what the steps are, in a sentence that follows the name.
    pub about: &'static str,
    /// The settings that it takes notice of.
    pub uses: &'static [Setting],
    /// Walks.
    ///
    /// # Errors
    /// If there is nothing to walk through.
    pub walk: fn(&WalkOrder<'_>) -> Result<Walk>,
}

/// A walk that is asked for.
#[derive(Clone, Copy)]
pub struct WalkOrder<'a> {
    /// What the scene is called.
    pub name: &'a str,
    /// The scene.
    pub loaded: &'a Loaded,
    /// The size of the whole picture.
    pub size: ImageSize,
    /// Column and row of the pixel, both in the picture; the ray passes through its centre.
    pub pixel: [u32; 2],
    /// The largest number of bounces between the eye and a surface; `None` is the algorithm's own choice.
    pub max_depth: Option<u32>,
    /// The one index to walk through, by a known name; `None` is all.
    pub index: Option<&'a str>,
}
