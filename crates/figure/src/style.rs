//! The one type scale and the neutral colours of the whole course.
//!
//! Sizes are in canvas px of a plate [`WIDTH`] px wide and are meant for the back row of a lecture room.

use crate::Color;

/// The width of a plate.
pub const WIDTH: f64 = 1400.0;

/// The title of a plate.
pub const TITLE: f64 = 34.0;
/// The claim of a plate.
pub const CLAIM: f64 = 25.0;
/// The title of a panel or of a picture.
pub const HEADING: f64 = 22.0;
/// Axis titles, direct labels, labels in diagrams.
pub const LABEL: f64 = 19.0;
/// Tick labels, knob values, metric lines under pictures.
pub const TICK: f64 = 17.0;
/// The caption block.
pub const CAPTION: f64 = 16.0;
/// No text is smaller; [`Canvas::faults`](crate::Canvas::faults) reports what is.
pub const SMALLEST: f64 = 15.0;

/// Text and axes.
pub const INK: Color = Color::rgb(0x1c, 0x1f, 0x24);
/// Text of the second rank: captions, ticks.
pub const MUTED: Color = Color::rgb(0x55, 0x5b, 0x66);
/// Grids and thin frames.
pub const FAINT: Color = Color::rgb(0xdf, 0xe3, 0xe8);
/// The colour of plates themselves (their number, their rules); no method has it.
pub const ACCENT: Color = Color::rgb(0x2b, 0x3a, 0x55);

/// From one line of text to the next, as a multiple of its size.
pub(crate) const LEADING: f64 = 1.35;
/// The height of capitals over the baseline, as a multiple of the size.
pub(crate) const CAP_HEIGHT: f64 = 0.73;
/// The room text takes over its baseline (accents of small letters included), as a multiple of its size.
pub(crate) const ASCENT: f64 = 0.8;
/// The room text takes under its baseline, as a multiple of its size.
pub(crate) const DESCENT: f64 = 0.24;
