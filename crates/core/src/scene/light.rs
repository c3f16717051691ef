use glam::DVec3;

use crate::Rgb;

/// A light without size that shines equally in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Where it stands.
    pub position: DVec3,
    /// I_i of `eq:local`: the radiance of a white surface (ρ_d = 1) that faces the light at distance 1.
    ///
    /// That is the power per solid angle over π: a matte surface spreads what it receives over all
    /// directions, so that ρ_d is the share of the light that it sends back.
    pub intensity: Rgb,
}
