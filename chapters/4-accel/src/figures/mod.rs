//! The figures of the chapter, one file each. To add one: write its `make`, name it in [`FIGURES`].

use lancer_figure::Figure;

/// All figures, in the lesson's order.
pub const FIGURES: &[Figure] = &[];
