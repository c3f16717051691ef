//! What a student's file needs.

pub use glam::DVec3;
pub use lancer_core::Rgb;
pub use lancer_core::geometry::{Ray, Sphere};
pub use lancer_core::illumination::Reflectance;
pub use lancer_core::image::ImageSize;
pub use lancer_core::scene::{Camera, Material};
pub use lancer_core::world::SurfacePoint;
pub use lancer_whitted::{Call, RayCounts, RayKind};

pub use super::{FilmFunction, Lit, Meeting, Node, Stage};
