use std::ops::AddAssign;

use lancer_core::method::{Work, WorkKind};

/// The rays that were traced, by kind: the deterministic cost of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the eye.
    pub primary: u64,
    /// From the eye, in pixels on the outline of a lamp: see [`Outlines`](crate::Outlines).
    pub outline: u64,
    /// Along mirror directions.
    pub mirror: u64,
    /// Along refracted directions.
    pub refracted: u64,
    /// Along directions drawn from the matte part and the highlight of a surface.
    pub lobe: u64,
    /// Towards lights.
    pub shadow: u64,
}

impl RayCounts {
    /// All rays.
    pub fn total(&self) -> u64 {
        self.primary + self.outline + self.mirror + self.refracted + self.lobe + self.shadow
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.primary += other.primary;
        self.outline += other.outline;
        self.mirror += other.mirror;
        self.refracted += other.refracted;
        self.lobe += other.lobe;
        self.shadow += other.shadow;
    }
}

impl From<RayCounts> for Work {
    fn from(rays: RayCounts) -> Self {
        let RayCounts { primary, outline, mirror, refracted, lobe, shadow } = rays;
        let counts = [
            ("primary", primary),
            ("outline", outline),
            ("mirror", mirror),
            ("refracted", refracted),
            ("lobe", lobe),
            ("shadow", shadow),
        ];
        Self { counts: counts.map(|(name, count)| (WorkKind::Rays, name, count)).to_vec() }
    }
}
