use std::cell::OnceCell;

use lancer_core::moving::Moment;
use lancer_core::sampling::Sample;

/// The world at the time of a sample.
#[inline]
pub fn of_sample<'a>(world: Moment<'a>, sample: &Sample) -> Moment<'a> {
    if world.moves() { world.at(lens_and_time(sample).1) } else { world }
}

/// A sample's random numbers at one surface, drawn when they are asked for. Each surface on a path, or in a tree of
/// rays, has its own sets; the table of [`lancer_core::sampling`] says which decides what, and none decides twice.
#[derive(Clone, Debug)]
pub struct Numbers {
    sample: Sample,
    place: OnceCell<[f64; 4]>,
    choices: OnceCell<[f64; 4]>,
}

/// The set of the choices.
const CHOICES: u32 = 1;
/// The set of the camera.
const CAMERA: u32 = 2;
/// The first set of the lamps after the first one.
const MORE_LAMPS: u32 = 3;

/// The two numbers of a sample for the point of the lens, and that for the time.
#[inline]
pub fn lens_and_time(sample: &Sample) -> ([f64; 2], f64) {
    let [u, v, time, _] = sample.numbers(CAMERA);
    ([u, v], time)
}

impl Numbers {
    /// For the surface that the eye sees.
    #[inline]
    pub fn new(sample: &Sample) -> Self {
        Self { sample: *sample, place: OnceCell::new(), choices: OnceCell::new() }
    }

    /// For the surface that the ray of this number meets, of those that leave the surface.
    #[inline]
    #[must_use]
    pub fn along(&self, ray: u32) -> Self {
        Self::new(&self.sample.along(ray))
    }

    #[inline]
    fn place(&self) -> &[f64; 4] {
        self.place.get_or_init(|| self.sample.numbers(0))
    }

    #[inline]
    fn choices(&self) -> &[f64; 4] {
        self.choices.get_or_init(|| self.sample.numbers(CHOICES))
    }

    /// The direction of the ray that led to the surface; at the first surface these two are the film point.
    #[inline]
    pub fn direction(&self) -> [f64; 2] {
        let [u, v, ..] = *self.place();
        [u, v]
    }

    /// The point on a lamp, by its number among those that are asked.
    #[inline]
    pub fn on_lamp(&self, lamp: usize) -> [f64; 2] {
        let Some(more) = lamp.checked_sub(1) else {
            let [.., u, v] = *self.place();
            return [u, v];
        };
        let [a, b, c, d] = self.sample.numbers(MORE_LAMPS + more as u32 / 2);
        if more.is_multiple_of(2) { [a, b] } else { [c, d] }
    }

    /// Which way it goes on.
    #[inline]
    pub fn way(&self) -> f64 {
        self.choices()[0]
    }

    /// Whether it goes on.
    #[inline]
    pub fn survival(&self) -> f64 {
        self.choices()[1]
    }

    /// Which light is asked: of two numbers, since one has 23 bits, too few where there are many lights.
    #[inline]
    pub fn light(&self) -> f64 {
        let [.., coarse, fine] = self.choices();
        coarse + fine / f64::from(1 << 23)
    }
}

#[cfg(test)]
mod tests {
    use lancer_core::sampling::PixelSampling;

    use super::*;

    /// All numbers at the surfaces of a tree of rays, of depth 3, and at those of a path of a thousand: none twice.
    #[test]
    fn no_number_decides_twice() {
        fn numbers(at: &Numbers, depth: u32, all: &mut Vec<f64>) {
            all.extend(at.direction());
            all.extend((0..5).flat_map(|lamp| at.on_lamp(lamp)));
            all.extend([at.way(), at.survival(), at.light()]);
            let (lens, time) = lens_and_time(&at.sample);
            all.extend(lens.into_iter().chain([time]));
            if depth > 0 {
                numbers(&at.along(0), depth - 1, all);
                numbers(&at.along(1), depth - 1, all);
            }
        }
        let sample = PixelSampling::CENTER.of_pixel(3, 4).next().unwrap();
        let mut all = Vec::new();
        let mut at = Numbers::new(&sample);
        numbers(&at, 3, &mut all);
        for depth in 0..1000 {
            // Those of the tree are already there.
            if depth > 3 {
                numbers(&at, 0, &mut all);
            }
            at = at.along(0);
        }
        let count = all.len();
        assert_eq!(count, 15 * 18 + 996 * 18);
        all.sort_unstable_by(f64::total_cmp);
        all.dedup();
        // Of 23 random bits each a few of so many are equal by chance.
        let pairs = (count * count) as f64 / f64::from(1 << 24);
        assert!(count - all.len() < 3 + 2 * pairs as usize, "{} of {count}", count - all.len());
    }
}
