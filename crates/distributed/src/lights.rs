use lancer_core::Rgb;
use lancer_core::scene::{PointSource, Scene};

use crate::lamps::{Lamp, Lamps};

/// The lights of a scene, of which a path asks one per surface.
///
/// A light's probability is half its share of the power of all, and half the same for all: a weak light close by is
/// asked often enough. Source: Shirley, Wang, Zimmerman, *Monte Carlo Techniques for Direct Lighting Calculations*, ACM
/// Transactions on Graphics 15(1), 1996.
#[derive(Clone, Debug)]
pub struct Lights {
    points: Vec<PointSource>,
    /// The lamps, chosen or not.
    pub lamps: Lamps,
    /// The probability of each light that is chosen among, points first, and those of all up to it together.
    odds: Vec<f64>,
    up_to: Vec<f64>,
}

/// One light.
#[derive(Clone, Copy, Debug)]
pub enum Light<'a> {
    /// One without size.
    Point(&'a PointSource),
    /// One with a size.
    Lamp(&'a Lamp),
}

impl Lights {
    /// Collects them; `choose_lamps` tells whether lamps with a size are chosen, too, or left to those who meet them.
    pub fn new(scene: &Scene, choose_lamps: bool) -> Self {
        let points: Vec<PointSource> = scene.lights.iter().map(PointSource::from).collect();
        let lamps = Lamps::new(scene);
        let chosen = if choose_lamps { lamps.as_slice() } else { &[] };
        // π² times these are the powers: a lamp shines to one side, with a cosine.
        let of_points = points.iter().map(|point| 4.0 * point.intensity.element_sum());
        let of_lamps = chosen
            .iter()
            .map(|lamp| lamp.area() / std::f64::consts::PI * lamp.radiance().element_sum());
        let powers: Vec<f64> = of_points.chain(of_lamps).collect();
        let (sum, same) = (powers.iter().sum::<f64>(), 1.0 / powers.len() as f64);
        let share = |power: &f64| if sum > 0.0 { power / sum } else { same };
        let odds: Vec<f64> = powers.iter().map(|power| 0.5 * (share(power) + same)).collect();
        let up_to = odds.iter().scan(0.0, |sum, odds| {
            *sum += odds;
            Some(*sum)
        });
        Self { up_to: up_to.collect(), points, lamps, odds }
    }

    /// A light with its probability; `number` in [0, 1) is asked for if there are several.
    #[inline]
    pub fn choose(&self, number: impl FnOnce() -> f64) -> Option<(Light<'_>, f64)> {
        let index = match self.odds.len() {
            0 => return None,
            1 => 0,
            count => {
                let number = number();
                self.up_to.partition_point(|&up_to| up_to <= number).min(count - 1)
            }
        };
        let light = match index.checked_sub(self.points.len()) {
            None => Light::Point(&self.points[index]),
            Some(lamp) => Light::Lamp(&self.lamps.as_slice()[lamp]),
        };
        Some((light, self.odds[index]))
    }

    /// The probability with which a lamp is chosen, by its number; 0 if it is left to those who meet it.
    #[inline]
    pub fn odds_of_lamp(&self, lamp: usize) -> f64 {
        self.odds.get(self.points.len() + lamp).copied().unwrap_or(0.0)
    }

    /// Whether light samples find all light that comes to a surface without help: no background, and no emission but
    /// that of the lamps that are chosen.
    pub fn find_all_of(&self, scene: &Scene) -> bool {
        let emits = |id| scene.material(id).emits();
        let chosen = self.odds.len() - self.points.len();
        let of_faces = scene.mesh.faces.iter().filter(|face| emits(face.material)).count();
        let of_spheres = scene.spheres.iter().filter(|sphere| emits(sphere.material)).count();
        scene.background == Rgb::ZERO && chosen == of_faces + of_spheres
    }
}
