//! The figures of the chapter, one file each. To add one: write its `make`, name it in [`FIGURES`].

mod agreement;
mod beams;
mod builders;
mod nothing;
mod sah;
mod structures;
mod volumes;

use lancer_figure::Figure;

/// All figures, in the lesson's order.
pub const FIGURES: &[Figure] = &[
    Figure { id: "4.1", name: "nothing", make: nothing::make },
    Figure { id: "4.2", name: "volumes", make: volumes::make },
    Figure { id: "4.3", name: "builders", make: builders::make },
    Figure { id: "4.4", name: "sah", make: sah::make },
    Figure { id: "4.7", name: "structures", make: structures::make },
    Figure { id: "4.11", name: "agreement", make: agreement::make },
    Figure { id: "4.12", name: "beams", make: beams::make },
];
