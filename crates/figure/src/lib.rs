//! Plates: the pictures, charts and diagrams the course shows, as PNG and as SVG.
//!
//! Everything is drawn as a list of primitives on a [`Canvas`]; the PNG and the SVG come from that one
//! list, so they show the same geometry. Text is drawn from one committed font: no system font is read,
//! and the bytes are the same on every run.
//!
//! A figure stacks [`Panel`]s (a [`Montage`], a [`Chart`], a [`SpeedError`], a [`Tree`], a [`Drawing`],
//! a [`Row`] of them) in a [`Plate`], which adds the title, the claim with its verdict, and the caption.
//! ```
//! use lancer_figure::{HeatScale, Inset, Montage, Picture, Plate, Tile, method_color};
//!
//! let picture = |grey: u8| Picture::from_fn(96, 64, |x, _| [grey, x as u8, grey]);
//! let errors = vec![0.01; 96 * 64];
//! let scale = HeatScale::log("|error|", 1e-4, 1.0);
//! let plate = Plate::new("2.9", "Penumbra", "Beams show no noise.", errors[0] < 0.05)
//!     .panel(
//!         Montage::new()
//!             .tile(Tile::new("Reference", picture(90)).color(method_color("reference")))
//!             .tile(Tile::new("Beams", picture(80)).color(method_color("precise")).subtitle("0.4 s"))
//!             .tile(Tile::new("Error", scale.paint(96, 64, &errors)))
//!             .color_bar(&scale)
//!             .inset(Inset::new(10, 20, 24, 16)),
//!     )
//!     .note("Reference", "closed form");
//! let canvas = plate.canvas();
//! assert!(canvas.faults().is_empty());
//! let (png, svg) = (canvas.to_png(1.0), canvas.to_svg());
//! # assert!(png.starts_with(b"\x89PNG") && svg.ends_with("</svg>\n"));
//! ```
//!
//! This crate knows no renderer: pictures come in as 8-bit RGB, measurements as `f64`.

mod axis;
mod bars;
mod canvas;
mod chart;
mod chart_layout;
mod data;
mod diagram;
mod figure;
mod font;
mod geometry;
mod heat;
mod index;
mod labels;
mod montage;
mod number;
mod palette;
mod picture;
mod plate;
mod raster;
mod shape;
mod speed_error;
mod study;
mod style;
mod svg;
mod tree;
mod walk;
mod wrap;

pub use axis::Axis;
pub use bars::BarChart;
pub use canvas::{Canvas, Fault};
pub use chart::{Chart, Datum, Series, Spread};
pub use data::{Record, Table, Value};
pub use diagram::{Drawing, Pen};
pub use figure::{Effort, Figure, Finished};
pub use font::{Weight, missing_glyphs, text_width};
pub use geometry::{Point, Rect};
pub use heat::{HeatScale, heat_color};
pub use index::{Entry, index_html};
pub use montage::{Inset, Montage, Tile};
pub use number::{decimals, number, power_of_ten, superscript};
pub use palette::{METHODS, category_color, method_color};
pub use picture::Picture;
pub use plate::{Panel, Plate, Row, Verdict};
pub use shape::{Anchor, Color, Stroke, Style, Text};
pub use speed_error::{CurvePoint, MethodCurve, SpeedError};
pub use study::{Contender, Study, Trial, time_in_turn};
pub use tree::Tree;
pub use walk::{Backdrop, Step, Walk};
pub use wrap::wrap;

pub use style::{
    ACCENT, CAPTION, CLAIM, FAINT, HEADING, INK, LABEL, MUTED, SMALLEST, TICK, TITLE, WIDTH,
};
