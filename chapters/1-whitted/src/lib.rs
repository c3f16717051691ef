//! Chapter 1, « Introduction au lancer de rayons »: its scenes and its figures. The lesson is
//! `README.md` beside this package's manifest.

pub mod exercises;
pub mod figures;
pub mod hard_boxes;
pub mod naive;
pub mod scenes;
