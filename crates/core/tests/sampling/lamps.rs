//! Irradiances of rectangles: means and deviations of every way to sample them.

use glam::DVec3;
use lancer_core::sampling::{Estimate, Patch, Uniform, area_light_density};

use super::rows::{Row, rows};
use super::statistics::{
    agrees, chi_squared, chi_squared_limit, deviates, independent, replicated, scrambled_mean,
};

/// cos θ over the density by area.
fn by_area(row: &Row) -> impl Fn([f64; 2]) -> f64 {
    let patch = row.patch();
    move |u| {
        let (point, normal) = patch.point(u);
        let back = row.from - point;
        let cos = normal.dot(back) / back.length();
        row.cosine(point) / area_light_density(back.length_squared(), cos, patch.area())
    }
}

/// The same by solid angle.
fn by_solid_angle(row: &Row) -> impl Fn([f64; 2]) -> f64 {
    let rectangle = row.rectangle();
    move |u| {
        let seen = rectangle.seen_from(row.from).unwrap();
        row.cosine(seen.sample(u)) / seen.density()
    }
}

/// The same as the patch decides.
fn as_decided(row: &Row) -> impl Fn([f64; 2]) -> f64 {
    let patch = row.patch();
    move |u| {
        let sample = patch.seen_from(row.from).sample(u).unwrap();
        row.cosine(sample.position) / sample.density
    }
}

/// `eq:area-light`, `eq:solid-angle`, `eq:monte-carlo`: 15 lamps and receivers, each by area and by solid angle, with
/// 64 scramblings of 1024 samples.
#[test]
fn irradiances_are_those_of_the_closed_form() {
    for row in rows() {
        for (way, estimate) in [
            ("area", replicated(1024, by_area(&row))),
            ("solid angle", replicated(1024, by_solid_angle(&row))),
        ] {
            assert!(agrees(&estimate, row.irradiance), "{} by {way}: {estimate:?}", row.name);
        }
    }
}

/// What the test above would say of usual mistakes: in each row that can show it.
#[test]
fn irradiances_tell_mistakes() {
    for row in rows() {
        let patch = row.patch();
        let mistaken = |wrong: &dyn Fn(DVec3, DVec3) -> f64| {
            let estimate = replicated(1024, |u| {
                let (point, normal) = patch.point(u);
                wrong(point, normal)
            });
            agrees(&estimate, row.irradiance)
        };
        let back = |point: DVec3| row.from - point;
        let density = |point: DVec3, normal: DVec3, area| {
            let cos = normal.dot(back(point)) / back(point).length();
            area_light_density(back(point).length_squared(), cos, area)
        };
        let area = patch.area();
        let right = |point: DVec3, normal: DVec3| row.cosine(point) / density(point, normal, area);
        assert!(mistaken(&right), "{}", row.name);
        // Without the lamp's cosine.
        let no_cosine =
            |point: DVec3, _: DVec3| row.cosine(point) * area / back(point).length_squared();
        assert!(!mistaken(&no_cosine), "{}", row.name);
        // One triangle's area for the face's.
        let half = |point: DVec3, n: DVec3| row.cosine(point) / density(point, n, 0.5 * area);
        assert!(!mistaken(&half), "{}", row.name);
        // |N·ω|, where a part of the lamp is below the horizon.
        let both_sides = |point: DVec3, normal: DVec3| {
            let cosine = (point - row.from).normalize().dot(row.n).abs();
            cosine / density(point, normal, area)
        };
        let is_cut = ["R4", "R5", "R10"].contains(&row.name);
        assert_eq!(mistaken(&both_sides), !is_cut, "{}", row.name);
    }
}

/// One sample's standard deviation, exact moments against 10⁵ independent samples, 10⁶ where the kurtosis is large.
#[test]
fn deviations_are_those_of_the_closed_form() {
    for row in rows() {
        let count = if row.by_area[1] > 100.0 { 1_000_000 } else { 100_000 };
        let estimate = independent(count, by_area(&row));
        let [deviation, kurtosis] = row.by_area;
        assert!(
            deviates(&estimate, row.irradiance, deviation, kurtosis),
            "{} {estimate:?}",
            row.name
        );
        // That of the other way is another.
        let [other, _] = row.by_solid_angle;
        let is_other = deviates(&estimate, row.irradiance, other, kurtosis);
        assert!(!is_other, "{}", row.name);

        let estimate = independent(100_000, by_solid_angle(&row));
        let [deviation, kurtosis] = row.by_solid_angle;
        assert!(
            deviates(&estimate, row.irradiance, deviation, kurtosis),
            "{} {estimate:?}",
            row.name
        );
    }
}

/// The patch samples as κ says, bit for bit, and knows the density of each of its samples.
#[test]
fn the_patch_decides_by_distance() {
    for row in rows() {
        let patch = row.patch();
        let view = patch.seen_from(row.from);
        let decided = as_decided(&row);
        let by_hand: &dyn Fn([f64; 2]) -> f64 =
            if row.is_near { &by_solid_angle(&row) } else { &by_area(&row) };
        for k in 0..1000 {
            let u = [(f64::from(k) + 0.5) / 1000.0, (f64::from(7 * k % 1000) + 0.5) / 1000.0];
            assert_eq!(decided(u), by_hand(u), "{}", row.name);
            let sample = view.sample(u).unwrap();
            let normal = row.edges[0].cross(row.edges[1]).normalize();
            let density = view.density(sample.position, normal);
            assert!((density / sample.density - 1.0).abs() < 1e-14, "{}", row.name);
        }
    }
}

/// The solid angle of part of a horizontal rectangle, by the formula of four corners, which is exact enough where
/// none is far.
fn part([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], z: f64) -> f64 {
    let corner = |x: f64, y: f64| (x * y / (z * (x * x + y * y + z * z).sqrt())).atan();
    corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0)
}

/// χ² of 10⁶ samples by solid angle in 20 × 10 cells of the rectangle, 199 degrees of freedom, with a false alarm in
/// 10⁸: the cells' masses are their solid angles times the density. By area the same test fails.
#[test]
fn samples_by_solid_angle_are_as_dense_as_they_say() {
    for row in rows().iter().filter(|row| ["R1", "R6", "R7", "R9"].contains(&row.name)) {
        let (rectangle, patch) = (row.rectangle(), row.patch());
        let seen = rectangle.seen_from(row.from).unwrap();
        let [y_edge, x_edge] = row.edges.map(DVec3::length);
        let relative = row.corner - row.from;
        let (mut masses, mut total) = (Vec::new(), 0.0);
        for i in 0..20 {
            for j in 0..10 {
                let x = [i, i + 1].map(|i| relative.x + x_edge * f64::from(i) / 20.0);
                let y = [j, j + 1].map(|j| relative.y + y_edge * f64::from(j) / 10.0);
                masses.push(part(x, y, relative.z) * seen.density());
                total += masses[masses.len() - 1];
            }
        }
        assert!((total - 1.0).abs() < 1e-12, "{}: {total}", row.name);
        let cell = |point: DVec3| {
            let (x, y) = ((point.x - row.corner.x) / x_edge, (point.y - row.corner.y) / y_edge);
            let inside = (0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y);
            inside.then(|| 10 * ((20.0 * x) as usize).min(19) + ((10.0 * y) as usize).min(9))
        };
        let limit = chi_squared_limit(masses.len());
        let found = chi_squared(300_000, &masses, |u| cell(seen.sample(u)));
        assert!(found < limit, "{}: {found}", row.name);
        let naive = chi_squared(300_000, &masses, |u| cell(patch.point(u).0));
        assert!(naive > 2.0 * limit, "{}: {naive}", row.name);
    }
}

/// Lambert's formula for a polygon of radiance 1 above the horizon of a receiver at the origin.
fn lambert(outline: &[DVec3], n: DVec3) -> f64 {
    let next = outline.iter().cycle().skip(1);
    let edge = |(a, b): (&DVec3, &DVec3)| a.angle_between(*b) * a.cross(*b).normalize().dot(n);
    (0.5 * outline.iter().zip(next).map(edge).sum::<f64>()).abs()
}

/// Faces that are no rectangles, by area: a skewed parallelogram and a pentagon of three triangles.
#[test]
fn other_faces_have_their_irradiance_too() {
    let n = DVec3::new(0.36, 0.48, 0.8);
    let at = |places: &[(f64, f64)]| -> Vec<DVec3> {
        places.iter().map(|&(x, y)| DVec3::new(x, y, 1.5)).collect()
    };
    for outline in [
        at(&[(0.0, 0.0), (0.3, 1.0), (1.7, 1.2), (1.4, 0.2)]),
        at(&[(0.0, 0.0), (0.5, 3.0), (2.0, 4.0), (4.0, 1.0), (3.0, 0.0)]),
    ] {
        let fan = (1..outline.len() - 1).map(|k| [outline[0], outline[k], outline[k + 1]]);
        let patch = Patch::new(fan).unwrap();
        let seen = patch.seen_from(DVec3::ZERO);
        let estimate = replicated(1024, |u| {
            let sample = seen.sample(u).unwrap();
            sample.position.normalize().dot(n).max(0.0) / sample.density
        });
        let irradiance = lambert(&outline, n);
        assert!(agrees(&estimate, irradiance), "{irradiance}: {estimate:?}");
    }
    let [first, ..] = &rows()[..] else { panic!() };
    let outline = [0.0, 1.0, 2.0, 3.0].map(|k: f64| {
        let (sin, cos) = (std::f64::consts::FRAC_PI_2 * (k + 0.5)).sin_cos();
        DVec3::new(cos, sin, 2.0_f64.sqrt()) * 0.5_f64.sqrt()
    });
    assert!((lambert(&outline, DVec3::Z) / first.irradiance - 1.0).abs() < 1e-14);
}

/// The error of R1's irradiance falls from 16 to 4096 samples as N^−1.4 where the lamp is seen whole, as N^−0.75 where
/// an edge crosses it, and with independent numbers as N^−0.5; 256 scramblings make the exponent known to 0.011.
#[test]
fn errors_fall_as_fast_as_they_should() {
    let row = rows().remove(0);
    let whole = by_area(&row);
    let visible = |[u, v]: [f64; 2]| u < 0.37 + 0.4 * v;
    let cut = |u| if visible(u) { whole(u) } else { 0.0 };
    let part = {
        // Of the part that is seen, by the midpoint rule along the cut.
        let n = 2000;
        let term = |k: usize| {
            let (i, j) = ((k / n) as f64 + 0.5, (k % n) as f64 + 0.5);
            let v = j / n as f64;
            let width = 0.37 + 0.4 * v;
            width * whole([width * i / n as f64, v])
        };
        (0..n * n).map(term).sum::<f64>() / (n * n) as f64
    };
    let slope = |rmse: &dyn Fn(u32) -> f64| (rmse(4096) / rmse(16)).log2() / 8.0;
    let owen = |f: &dyn Fn([f64; 2]) -> f64, truth: f64| {
        slope(&|samples| rmse(truth, |seed| scrambled_mean(seed, samples, f)))
    };
    let random = slope(&|samples| {
        rmse(row.irradiance, |seed| {
            let mut random = Uniform::new(u64::from(seed), samples, 0);
            let values = (0..samples).map(|_| whole([random.number(), random.number()]));
            values.collect::<Estimate>().mean()
        })
    });
    let found = [owen(&whole, row.irradiance), owen(&cut, part), random];
    for (found, exponent) in found.into_iter().zip([-1.4, -0.75, -0.5]) {
        assert!((found - exponent).abs() < 0.1, "{found} for {exponent}");
    }
}

/// The root mean square of 256 errors.
fn rmse(truth: f64, mean: impl Fn(u32) -> f64) -> f64 {
    let squares = (0..256).map(|seed| (mean(seed) - truth).powi(2));
    squares.collect::<Estimate>().mean().sqrt()
}
