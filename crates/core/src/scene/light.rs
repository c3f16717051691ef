use glam::DVec3;

use crate::Rgb;

/// A light without size that shines equally in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Where it stands.
    pub position: DVec3,
    /// I_i of `eq:local`: power per solid angle, so that a surface at distance d receives I_i / d².
    pub intensity: Rgb,
}
