//! What a student's file needs.

pub use glam::{DVec3, IVec3};
pub use lancer_accel::{Cell, Lattice, Sides};
pub use lancer_core::geometry::{Bounds3, Interval, Ray};
pub use lancer_core::scene::PrimitiveId;

pub use super::{Item, Lanes, Met, PreparedRay, Test, Walk};
