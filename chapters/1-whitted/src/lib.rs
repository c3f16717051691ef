//! Chapter 1, « Introduction au lancer de rayons »: its scenes, its figures, and its algorithm step by step. The lesson is
//! `README.md` beside this package's manifest.

pub mod exercises;
pub mod figures;
pub mod hard_boxes;
pub mod naive;
pub mod scenes;
pub mod step;
