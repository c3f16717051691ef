//! Chapter 1, « Introduction au lancer de rayons »: Appel's visibility and shadows (1968) and Whitted's
//! recursion over mirror and refracted rays (1980).
//!
//! | slide                                   | label          | here                  |
//! |-----------------------------------------|----------------|-----------------------|
//! | Modèle Local, calcul des ombres portées | `algo:appel`   | [`Lighting::surface`], by [`lancer_core::illumination::lit`] |
//! | Intensité lumineuse sur un rayon        | `eq:recursion` | [`lancer_core::illumination::recursion`] |
//! | Algorithme                              | `algo:lr`      | [`Whitted::trace`]    |
//! | Arbre de rayons                         | `fig:ray-tree` | [`RayTree`]           |
//!
//! The formulas that other chapters share are in [`lancer_core::illumination`] and
//! [`lancer_core::optics`].

mod appel;
mod lighting;
mod methods;
mod ray_tree;
mod recorder;
mod trace;

pub use appel::Appel;
pub use lighting::Lighting;
pub use methods::METHODS;
pub use ray_tree::{RayEnd, RayNode, RayTree, ShadowRay};
pub use recorder::{Call, RayCounts, RayKind, Recorder};
pub use trace::{AtLimit, Settings, Whitted};
