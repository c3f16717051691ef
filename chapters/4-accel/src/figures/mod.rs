//! The figures of the chapter, one file each. To add one: write its `make`, name it in [`FIGURES`].

mod grid;

use lancer_figure::Figure;

/// All figures, in the lesson's order.
pub const FIGURES: &[Figure] = &[Figure { id: "4.5", name: "grid", make: grid::make }];
