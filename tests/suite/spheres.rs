//! Far, small, huge and grazed spheres against numbers computed to 40 digits or by hand.

use glam::DVec3;
use lancer_core::geometry::{Interval, Ray, Sphere};
use lancer_lesson::naive::textbook_sphere;

use crate::random::Random;

fn met(center: DVec3, radius: f64, origin: DVec3, direction: DVec3) -> Option<f64> {
    Sphere { center, radius }.intersect(&Ray::new(origin, direction), Interval::POSITIVE)
}

/// eq:ray-sphere: a ray parallel to the axis at height h over the centre of a unit sphere meets it
/// where t = D − √(1 − h²); the height is chosen so that the root is rational: h = 3/5, √ = 4/5.
#[test]
fn far_spheres_are_met_to_sixteen_digits() {
    for distance in [10.0, 1e3, 1e5, 1e8, 1e12] {
        let center = DVec3::new(0.0, 0.0, distance);
        let t = met(center, 5.0, DVec3::new(3.0, 0.0, 0.0), DVec3::Z).unwrap();
        let wanted = distance - 4.0;
        assert!((t - wanted).abs() <= 1e-15 * wanted, "{distance}: {t} for {wanted}");
    }
    // Obliquely, with an exact answer: the ray along (2, 3, 6)/7 through the centre.
    for distance in [7e3, 7e5, 7e8] {
        let unit = DVec3::new(2.0, 3.0, 6.0) / 7.0;
        let t = met(unit * distance, 1.0, DVec3::ZERO, DVec3::new(2.0, 3.0, 6.0)).unwrap();
        let wanted = (distance - 1.0) / 7.0;
        assert!((t - wanted).abs() <= 1e-15 * wanted, "{distance}: {t} for {wanted}");
    }
}

#[test]
fn the_textbook_formula_loses_the_far_sphere() {
    let mut random = Random::new(53);
    let (mut wrong, mut naive_wrong) = (0, 0);
    for _ in 0..1500 {
        // Dyadic points on a far plane: hit or miss is decided by integers.
        let (x, y) = (random.integer(1200) / 1024.0, random.integer(1200) / 1024.0);
        let inside = x * x + y * y < 1.0;
        let distance = f64::from(1 << 27);
        let (center, origin) = (DVec3::new(0.0, 0.0, distance), DVec3::new(x, y, 0.0));
        let direction = DVec3::Z;
        wrong += usize::from(met(center, 1.0, origin, direction).is_some() != inside);
        let sphere = Sphere { center, radius: 1.0 };
        let textbook = textbook_sphere(sphere, &Ray::new(origin, direction));
        naive_wrong += usize::from(textbook.is_some() != inside);
    }
    assert_eq!(wrong, 0);
    assert!(naive_wrong > 50, "the textbook formula errs {naive_wrong} times in 1500");
}

/// Heights f32(1 − 10^−k) over a unit sphere at z = 10; the parameters to ten digits from 40-digit
/// arithmetic.
#[test]
fn grazed_spheres_are_met_to_twelve_digits() {
    for (k, wanted) in [(3, 9.955290110), (5, 9.995524840), (6, 9.998576428)] {
        let height = f64::from((1.0 - 10.0_f64.powi(-k)) as f32);
        let t =
            met(DVec3::new(0.0, 0.0, 10.0), 1.0, DVec3::new(height, 0.0, 0.0), DVec3::Z).unwrap();
        assert!((t - wanted).abs() < 1e-9, "k = {k}: {t}");
        let exact = 10.0 - ((1.0 - height) * (1.0 + height)).sqrt();
        assert!((t - exact).abs() < 1e-12, "k = {k}: {t} for {exact}");
    }
}

/// A man looks down on the Earth: of the seven digits of f32 the difference of the squared radii leaves
/// none.
#[test]
fn the_ground_may_be_a_planet() {
    let (radius, eye) = (6.371e6, 1.7);
    let t = met(DVec3::new(0.0, -radius, 0.0), radius, DVec3::new(0.0, eye, 0.0), DVec3::NEG_Y)
        .unwrap();
    assert!((t - eye).abs() < 1e-10 * eye * 100.0, "{t}");
}

#[test]
fn special_rays() {
    let at = DVec3::new(0.0, 0.0, 5.0);
    assert_eq!(met(at, 1.0, DVec3::ZERO, DVec3::Z), Some(4.0));
    assert_eq!(met(at, 1.0, DVec3::ZERO, 2.0 * DVec3::Z), Some(2.0), "t counts directions");
    assert_eq!(met(at, 1.0, at, DVec3::Z), Some(1.0), "from the centre");
    assert_eq!(met(at, 1.0, at + 0.5 * DVec3::Z, DVec3::Z), Some(0.5), "from inside");
    assert_eq!(met(at, 1.0, DVec3::ZERO, DVec3::NEG_Z), None, "behind");
    assert_eq!(met(at, 1.0, DVec3::X, DVec3::Z), Some(5.0), "tangent");
    for radius in [0.0, -1.0, f64::NAN] {
        assert_eq!(met(at, radius, DVec3::ZERO, DVec3::Z), None, "radius {radius}");
    }
    for direction in [DVec3::ZERO, DVec3::NAN] {
        assert_eq!(met(at, 1.0, DVec3::ZERO, direction), None);
        assert_eq!(met(at, 1.0, at, direction), None);
    }
}
