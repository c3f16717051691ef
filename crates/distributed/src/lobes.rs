//! Where a path goes on from a surface.

use std::f64::consts::PI;

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::illumination::{Arriving, Reflectance, local};
use lancer_core::optics::{Branches, reflect};
use lancer_core::sampling::{
    cosine_hemisphere, cosine_hemisphere_density, phong_lobe, phong_lobe_density,
};

/// The ways a path may take from a surface, each with its probability: by the share of the light that it carries at
/// most, of its strongest channel.
#[derive(Clone, Copy, Debug)]
pub struct Lobes {
    reflectance: Reflectance,
    n: DVec3,
    to_eye: DVec3,
    branches: Branches,
    /// Matte, highlight, mirror, refracted.
    odds: [f64; 4],
}

/// A direction that a path takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onwards {
    /// Unit, away from the surface.
    pub direction: DVec3,
    /// What the radiance from there counts.
    pub weight: Rgb,
    /// Which way it was.
    pub way: Way,
}

/// Which of a surface's ways a direction was drawn from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// The matte part or the highlight, with this density per solid angle: light samples may find the same light.
    Lobe(f64),
    /// The mirror direction, which nothing else finds.
    Mirror,
    /// The refracted direction, which nothing else finds.
    Refracted,
}

impl Lobes {
    /// Of a surface with `eq:local`'s constants `reflectance`: `n` is the unit shading normal on the eye's side,
    /// `to_eye` unit and away from the surface, and `branches` are its mirror and refracted ray.
    #[inline]
    pub fn new(reflectance: Reflectance, n: DVec3, to_eye: DVec3, branches: Branches) -> Self {
        let highlight = 2.0 * reflectance.specular / (reflectance.shininess + 1.0);
        let [mirror, refracted] = branches.shares();
        let shares = [reflectance.diffuse, highlight, mirror, refracted].map(Rgb::max_element);
        let sum: f64 = shares.iter().sum();
        let odds = if sum > 0.0 { shares.map(|share| share / sum) } else { [0.0; 4] };
        Self { reflectance, n, to_eye, branches, odds }
    }

    /// The unit shading normal on the eye's side.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.n
    }

    /// Whether the surface has a highlight.
    #[inline]
    pub fn have_highlight(&self) -> bool {
        self.odds[1] > 0.0
    }

    /// What the surface sends to the eye of light that nothing blocks: one term of `eq:local`.
    #[inline]
    pub fn unshadowed<I: Fn(DVec3) -> Rgb>(&self, arriving: &Arriving<I>) -> Rgb {
        arriving.unshadowed(&self.reflectance, self.n, self.to_eye)
    }

    /// Whether light from some direction above the surface is sent to the eye.
    #[inline]
    pub fn scatter(&self) -> bool {
        self.odds[0] + self.odds[1] > 0.0
    }

    /// What the surface sends to the eye of radiance from the unit direction `to_light`, per solid angle.
    ///
    /// ```text
    /// f cos θ = ( ρ_d (N·L) + ρ_s (R·V)ⁿ ) / π
    /// ```
    ///
    /// The bracket is that of `eq:local`; its 1/π is in the intensities of lights, and here it stands.
    #[inline]
    pub fn reflected(&self, to_light: DVec3) -> Rgb {
        local(&self.reflectance, self.n, to_light, self.to_eye) / PI
    }

    /// The density with which [`Lobes::sample`] draws a direction from the matte part or from the highlight, per solid
    /// angle, the choice between all ways included.
    #[inline]
    pub fn density(&self, direction: DVec3) -> f64 {
        let [matte, highlight, ..] = self.odds;
        let mut density = 0.0;
        if matte > 0.0 {
            density += matte * cosine_hemisphere_density(self.n.dot(direction));
        }
        if highlight > 0.0 {
            // As `eq:local` has it: the mirrored V has another product with L, by roundings.
            let cos_mirror = reflect(-direction, self.n).dot(self.to_eye);
            density += highlight * phong_lobe_density(self.reflectance.shininess, cos_mirror);
        }
        density
    }

    /// A direction; `None` if the surface sends nothing to the eye, or nothing from there. `choice` and the two
    /// numbers are in [0, 1), and asked for if there is something to choose.
    ///
    /// What is drawn below the horizon is lost, not drawn again: that would be another density.
    #[inline]
    pub fn sample(
        &self,
        choice: impl FnOnce() -> f64,
        numbers: impl FnOnce() -> [f64; 2],
    ) -> Option<Onwards> {
        let [matte, highlight, mirror, refracted] = self.odds;
        let choice = if matte == 1.0 { 0.0 } else { choice() };
        let smooth = |branch: Option<(Rgb, DVec3)>, odds: f64, way| {
            branch.map(|(k, direction)| Onwards { direction, weight: k / odds, way })
        };
        let direction = if choice < matte {
            cosine_hemisphere(self.n, numbers())
        } else if choice < matte + highlight {
            // The angle of R and V is that of L and the mirrored V.
            let axis = reflect(-self.to_eye, self.n);
            phong_lobe(axis, self.reflectance.shininess, numbers())
        } else if choice < matte + highlight + mirror {
            return smooth(self.branches.mirror, mirror, Way::Mirror);
        } else {
            return smooth(self.branches.refracted, refracted, Way::Refracted);
        };
        let (reflected, density) = (self.reflected(direction), self.density(direction));
        if reflected == Rgb::ZERO || density == 0.0 {
            return None;
        }
        Some(Onwards { direction, weight: reflected / density, way: Way::Lobe(density) })
    }
}

#[cfg(test)]
mod tests {
    use lancer_core::scene::Material;

    use super::*;

    /// Drawn at the rim of the lobe, where R·V is rounding noise, a direction is lost or has a weight no larger than the
    /// highlight's over its odds, 2 ρ_s / (n + 1): the density must be 0 where R·V is.
    #[test]
    fn weights_at_the_rim_of_the_lobe_are_finite() {
        let specular = Rgb::new(0.9, 0.6, 0.3);
        let (mut drawn, n) = (0, DVec3::new(1.0, 2.0, 2.0) / 3.0);
        // Of rounding noise, some 1e-18, a higher power has not all digits.
        for shininess in [0.0, 1.0, 4.0, 8.0, 12.0] {
            let reflectance = Reflectance { diffuse: Rgb::ZERO, specular, shininess };
            for k in 0..2000 {
                let turn = f64::from(k) * 0.618;
                let to_eye = (n + DVec3::new(turn.sin(), turn.cos(), 0.3)).normalize();
                if n.dot(to_eye) <= 0.0 {
                    continue;
                }
                let branches = Branches::along(&Material::matte(Rgb::ZERO), n, None);
                let lobes = Lobes::new(reflectance, n, to_eye, branches);
                for numbers in [[0.0, turn.fract()], [turn.fract(), 0.0], [f64::MIN_POSITIVE, 0.5]]
                {
                    let Some(onwards) = lobes.sample(|| 0.5, || numbers) else { continue };
                    let most = 2.0 * specular / (shininess + 1.0);
                    let excess = (onwards.weight - most).abs().max_element();
                    assert!(excess < 1e-9, "{shininess} {numbers:?}: {:?}", onwards.weight);
                    drawn += 1;
                }
            }
        }
        assert!(drawn > 2_000, "{drawn}");
    }
}
