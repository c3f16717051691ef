use glam::DVec3;

use crate::Rgb;

/// The index of a [`Material`] in [`Scene::materials`](super::Scene::materials).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialId(pub u32);

/// The constants of the slides' illumination model.
///
/// | slide | here              | enters                                     |
/// |-------|-------------------|--------------------------------------------|
/// | ρ_d   | `rho_d`           | `eq:local`, and `eq:ambient` as its mean ρ̄ |
/// | ρ_s   | `rho_s`           | `eq:local`                                 |
/// | n     | `shininess`       | `eq:local`, the exponent of the highlight  |
/// | k_s   | `k_s`             | `eq:recursion`, the share of the mirror ray |
/// | k_t   | `k_t`             | `eq:recursion`, the share of the refracted ray |
/// | m     | `gloss`           | how far the rays of k_s and k_t are spread |
/// | n₂/n₁ | `refractive_index`| `eq:descartes`, inside the closed surface over what surrounds it |
/// | ε     | `emission`        | added to what leaves the surface           |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Diffuse reflectance, per channel: the share of the light received that is sent back, 0 to 1.
    pub rho_d: Pigment,
    /// Weight of the highlight, per channel.
    pub rho_s: Rgb,
    /// Exponent n of the highlight (R·V)ⁿ, at least 0. Below 1 the highlight ends in an edge.
    pub shininess: f64,
    /// Share of the mirror ray, per channel.
    pub k_s: Rgb,
    /// Share of the refracted ray, per channel.
    pub k_t: Rgb,
    /// Exponent m, above 0, of a rough surface: the rays of k_s and k_t are spread around R and T with the density
    /// (m + 1)/(2π) cosᵐ of the angle to them (« brillance », « translucidité »); `None` is perfectly smooth.
    pub gloss: Option<f64>,
    /// Refractive index of the inside, relative to what surrounds the surface: the outside is 1. Water (1.33) in
    /// glass (1.5) has 1.33/1.5.
    pub refractive_index: f64,
    /// Radiance emitted from the outside. A face or a sphere that emits is a lamp.
    pub emission: Rgb,
}

impl Material {
    /// A matte surface of reflectance `rho_d`.
    pub const fn matte(rho_d: Rgb) -> Self {
        Self {
            rho_d: Pigment::Solid(rho_d),
            rho_s: Rgb::ZERO,
            shininess: 1.0,
            k_s: Rgb::ZERO,
            k_t: Rgb::ZERO,
            gloss: None,
            refractive_index: 1.0,
            emission: Rgb::ZERO,
        }
    }

    /// The share of the light that a surface receives and sends back or lets pass, at most, of the channel with the
    /// largest: ρ_d + 2 ρ_s/(n + 1) + k_s + k_t. The second term is the highlight's, (R·V)ⁿ over a hemisphere,
    /// 2π/(n + 1), over the π of a matte surface.
    pub fn largest_albedo(&self) -> f64 {
        let highlight = 2.0 * self.rho_s / (self.shininess + 1.0);
        (self.rho_d.brightest() + highlight + self.k_s + self.k_t).max_element()
    }

    /// Whether nothing of the surface is seen: it sends no light, and all light passes straight through it.
    pub fn is_invisible(&self) -> bool {
        let Self { rho_d, rho_s, shininess: _, k_s, k_t, gloss, refractive_index, emission } =
            *self;
        let sends_nothing =
            [rho_s, k_s, emission, rho_d.brightest()].iter().all(|c| *c == Rgb::ZERO);
        sends_nothing && k_t == Rgb::ONE && gloss.is_none() && refractive_index == 1.0
    }

    /// Whether light changes its direction where it passes the surface.
    pub fn refracts(&self) -> bool {
        self.k_t != Rgb::ZERO && self.refractive_index != 1.0
    }

    /// Whether rays of k_s or k_t leave the surface spread.
    pub fn is_glossy(&self) -> bool {
        self.gloss.is_some() && (self.k_s != Rgb::ZERO || self.k_t != Rgb::ZERO)
    }

    /// Whether the material emits, so that a face or a sphere of it is a lamp.
    pub fn emits(&self) -> bool {
        self.emission != Rgb::ZERO
    }
}

/// The diffuse colour of a surface: one colour, or a checker of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pigment {
    /// The same colour everywhere.
    Solid(Rgb),
    /// Squares of alternating colour, laid out in the coordinate plane that the surface faces most.
    Checker {
        /// The colour of the squares with an even coordinate sum; one of them starts at the origin.
        even: Rgb,
        /// The colour of the other squares.
        odd: Rgb,
        /// The side of a square, in scene units.
        side: f64,
    },
}

impl Pigment {
    /// The largest value of each channel.
    fn brightest(&self) -> Rgb {
        match *self {
            Self::Solid(color) => color,
            Self::Checker { even, odd, .. } => even.max(odd),
        }
    }

    /// The colour at `position` of a surface with unit normal `n` (either sense).
    ///
    /// The checker ignores the coordinate along the largest component of `n`: on a floor y = 0 that
    /// coordinate is rounding noise around a square's edge, and a checker in space would flicker.
    #[inline]
    pub fn at(&self, position: DVec3, n: DVec3) -> Rgb {
        match *self {
            Self::Solid(color) => color,
            Self::Checker { even, odd, side } => {
                let p = position / side;
                let n = n.abs();
                let (a, b) = if n.y >= n.x && n.y >= n.z {
                    (p.x, p.z)
                } else if n.x >= n.z {
                    (p.y, p.z)
                } else {
                    (p.x, p.y)
                };
                if (floor(a) ^ floor(b)) & 1 == 0 { even } else { odd }
            }
        }
    }
}

/// ⌊a⌋ as an integer: `f64::floor` is a function call on processors of the x86-64 baseline.
#[inline]
fn floor(a: f64) -> i64 {
    let towards_zero = a as i64;
    towards_zero.wrapping_sub(i64::from(a < towards_zero as f64))
}
