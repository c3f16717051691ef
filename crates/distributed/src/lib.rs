//! Chapter 3, « Lancer de rayons distribués »: Cook's rays that draw what they average over (1984), and Kajiya's paths
//! that solve the rendering equation (1986).
//!
//! | slide                    | label              | here                                   |
//! |--------------------------|--------------------|----------------------------------------|
//! | Modèle d'illumination    | `algo:distributed` | [`Distributed::shade`]                 |
//! | Intégration de Monte Carlo | `algo:path`      | [`PathTracer::shade`]                  |
//! |                          | `eq:roulette`      | [`roulette`]                           |
//!
//! The warps, densities, weights and means that estimators are made of are in [`lancer_core::sampling`].

mod distributed;
mod gloss;
mod lamps;
mod lights;
mod lobes;
mod methods;
mod numbers;
mod outlines;
mod path;
mod rays;

pub use distributed::{Distributed, Settings};
pub use gloss::spread;
pub use lamps::{Lamp, Lamps};
pub use lights::{Light, Lights};
pub use lobes::{Lobes, Onwards, Way};
pub use methods::METHODS;
pub use numbers::{Numbers, lens_and_time};
pub use outlines::{Eye, Outlines};
pub use path::{PathSettings, PathTracer, roulette};
pub use rays::RayCounts;
