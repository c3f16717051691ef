//! E1.3: where a ray meets a sphere.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Ray, Sphere};
use lancer_core::image::{Image, ImageSize};
use lancer_core::sampling::Uniform;
use lancer_exercise::{
    Card, Check, Exercise, Mismatch, Shown, Solution, Verdict, ensure, slips, within,
};
use lancer_lesson::naive::textbook_sphere;

use super::reference::ray_sphere;
use super::{Subject, painted};
use crate::figures::quadratic::far_sphere;

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E1.3",
        name: "ray-sphere",
        title: "A ray and a sphere, near and far",
        slide: "Algorithme : calcul et tri des intersections",
        stub: include_str!("../../stubs/e03_ray_sphere.rs"),
        functions: &["ray_sphere"],
        minutes: 20,
        predict: "the balls of the upper row are 10, 10⁶ and 3·10⁷ radii away, each seen through a lens that \
                  makes it as large as the first: with the textbook's discriminant, what do they look like?",
        vary: "compute the discriminant as (F·D)² − (D·D)(F·F − r²), the textbook's, and draw again: from which \
               distance on can you see the difference?",
        hints: [
            "With F = origin − centre the points of the ray at distance r from the centre are the roots of a \
             quadratic. Far away its discriminant is the difference of two huge numbers; the distance of the \
             centre to the *line* says the same without a difference.",
            "eq:ray-sphere: t² (D·D) + 2t (F·D) + F·F − r² = 0. Discriminant (D·D) r² − |F×D|²; \
             q = −(F·D) − sign(F·D) √discriminant, where nothing cancels; the roots are (F·F − r²) / q and \
             q / (D·D). The answer is the smaller root that is greater than 0.",
            "`let q = -fd - discriminant.sqrt().copysign(fd);` where `fd` is `f.dot(d)`. \
             `let product = ff - rr;`, or 0.0 if `product.abs() <= NOISE * (ff + rr)`. \
             Then `let (a, b) = (product / q, q / d.length_squared());` and \
             `[a.min(b), a.max(b)].into_iter().find(|t| *t > 0.0)`.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e03_ray_sphere.rs"),
            file: "crates/core/src/geometry/sphere.rs",
            item: "pub fn intersect_spheres",
            notice: "a ray that starts outside and does not approach is sent away before the root is taken, \
                     and the limit of the noise is counted in rounded operations, gamma(8)",
        },
    },
    checks: &[
        Check { name: "straight ahead", run: ahead },
        Check { name: "past the sphere", run: past },
        Check { name: "a direction of length 7", run: any_length },
        Check { name: "from inside", run: inside },
        Check { name: "behind the ray", run: behind },
        Check { name: "just touching", run: tangent },
        Check { name: "far away", run: far },
        Check { name: "a huge sphere close by", run: huge },
        Check { name: "a tiny sphere close by", run: tiny },
        Check { name: "starting on the sphere", run: on_sphere },
    ],
    slips: slips! {
        ray_sphere(sphere, ray):
        "the farther root comes first: from outside that is where the ray leaves the sphere":
            "straight ahead" catches
                ray_sphere(sphere, ray).and_then(|_| roots(sphere, ray)).map(|[_, far]| far);
        "a hit behind the ray's origin counts: t must be positive":
            "behind the ray" catches roots(sphere, ray).map(|[near, _]| near);
        "only the nearer root is tried: from inside the sphere that one is behind, and the farther one is the hit":
            "from inside" catches
                ray_sphere(sphere, ray)
                    .filter(|_| roots(sphere, ray).is_some_and(|[near, _]| near > 0.0));
        "only the nearer root is tried: from inside the sphere that one is behind, and the farther one is the hit. \
         Besides, the discriminant is the textbook's, a difference of two huge numbers when the sphere is far away":
            "from inside" catches textbook_sphere(*sphere, ray).filter(|near| *near > 0.0);
        "a fixed epsilon: what is nearer than that is lost, and in a tiny scene that is everything; 0 is the \
         limit, and the noise of F·F − r² is what to cut":
            "a tiny sphere close by" catches roots(sphere, ray)?.into_iter().find(|t| *t > 1e-6);
        "D·D is left out, which is 1 for unit directions only":
            "a direction of length 7" catches {
                let [_, fd, ff, rr] = terms(sphere, ray);
                positive(around(-fd, fd * fd - ff + rr))
            };
        "t is a distance: it must be in units of the direction's length, which is not always 1":
            "a direction of length 7" catches
                ray_sphere(sphere, ray).map(|t| t * ray.direction.length());
        "b² − 4ac goes with b = 2 (F·D), and the 2 is missing":
            "straight ahead" catches {
                let [a, b, ff, rr] = terms(sphere, ray);
                positive(around(-b, b * b - 4.0 * a * (ff - rr))).map(|t| t / (2.0 * a))
            };
        "the discriminant is the textbook's, a difference of two huge numbers when the sphere is far away; and a \
         ray that starts on the sphere meets it there, by rounding":
            "far away" catches {
                let near = textbook_sphere(*sphere, ray)?;
                if near > 0.0 { Some(near) } else { positive(roots(sphere, ray)) }
            };
        "the discriminant is the textbook's, a difference of two huge numbers when the sphere is far away: take \
         (D·D) r² − |F×D|²":
            "far away" catches {
                let near = textbook_sphere(*sphere, ray)?;
                let is_hit = near > 0.0 && !is_noise(sphere, ray);
                if is_hit { Some(near) } else { ray_sphere(sphere, ray) }
            };
        "the discriminant is right, but the nearer root cancels: −(F·D) and √discriminant are added with one sign \
         and subtracted with the other; take it from the product of the roots":
            "a huge sphere close by" catches {
                let ([dd, fd, ..], hit) = (terms(sphere, ray), ray_sphere(sphere, ray)?);
                let near = (-fd - discriminant(sphere, ray).sqrt()) / dd;
                Some(if near > 0.0 { near } else { hit })
            };
        "a ray that just touches the sphere is lost: a discriminant of 0 has one root":
            "just touching" catches
                ray_sphere(sphere, ray)
                    .filter(|_| roots(sphere, ray).is_some_and(|[near, far]| near < far));
        "the rounding noise of F·F − r² is taken for a distance: a ray that starts on the sphere meets it there":
            "starting on the sphere" catches positive(roots(sphere, ray));
        "F points from the ray's origin to the centre: that turns the sign of F·D, and with it those of the roots":
            "straight ahead" catches positive(roots(sphere, ray).map(|[near, far]| [-far, -near]));
        "D was normalised on the way, and t is a distance: it must be in units of D's length. Besides, the \
         distance of the centre to the line comes from |F|² − (F·D)², which cancels far away as the textbook's \
         discriminant does":
            "a direction of length 7" catches {
                let unit = Ray::new(ray.origin, ray.direction.normalize());
                let [_, fd, ff, rr] = terms(sphere, &unit);
                positive(around(-fd, rr - (ff - fd * fd)))
            };
    },
    own: |yours, reference| Subject { ray_sphere: yours.ray_sphere, ..reference },
    draw,
    explain: None,
};

/// D·D, F·D, F·F and r².
fn terms(sphere: &Sphere, ray: &Ray) -> [f64; 4] {
    let (f, d) = (ray.origin - sphere.center, ray.direction);
    [d.length_squared(), f.dot(d), f.length_squared(), sphere.radius * sphere.radius]
}

/// (D·D) r² − |F×D|².
fn discriminant(sphere: &Sphere, ray: &Ray) -> f64 {
    let [dd, _, _, rr] = terms(sphere, ray);
    dd * rr - (ray.origin - sphere.center).cross(ray.direction).length_squared()
}

/// The roots, the smaller first, to all digits but with the noise of F·F − r².
fn roots(sphere: &Sphere, ray: &Ray) -> Option<[f64; 2]> {
    let ([dd, fd, ff, rr], discriminant) = (terms(sphere, ray), discriminant(sphere, ray));
    let root = (discriminant >= 0.0).then(|| discriminant.sqrt())?;
    let q = -fd - root.copysign(fd);
    let (a, b) = ((ff - rr) / q, q / dd);
    Some([a.min(b), a.max(b)])
}

/// The roots as textbooks have them: ±√discriminant around the middle.
fn around(middle: f64, discriminant: f64) -> Option<[f64; 2]> {
    let root = (discriminant >= 0.0).then(|| discriminant.sqrt())?;
    Some([middle - root, middle + root])
}

fn positive(roots: Option<[f64; 2]>) -> Option<f64> {
    roots?.into_iter().find(|t| *t > 0.0)
}

/// Whether the ray starts on the sphere, up to rounding.
fn is_noise(sphere: &Sphere, ray: &Ray) -> bool {
    let [_, _, ff, rr] = terms(sphere, ray);
    (ff - rr).abs() <= 4.0 * f64::EPSILON * (ff + rr)
}

type Scene = (Sphere, Ray);

fn case(what: &str, Sphere { center, radius }: &Sphere, ray: &Ray) -> String {
    let (center, radius) = (center.shown(), radius.shown());
    format!("{what}: sphere around {center} of radius {radius}; ray: {}", ray.shown())
}

fn compare(subject: &Subject, what: &str, (sphere, ray): Scene, wanted: Option<f64>) -> Verdict {
    let got = (subject.ray_sphere)(&sphere, &ray);
    within(1e-12, || case(what, &sphere, &ray), &got, &wanted)
}

/// A ray from the origin along D = (2, 3, 6), of length 7, and a sphere of radius 35 whose centre is
/// k D + 3 (6, 2, −3): 21 beside the ray. The half chord is √(35² − 21²) = 28 = 4 |D|, so the ray enters at
/// t = k − 4 and leaves at k + 4.
fn aside(k: f64) -> Scene {
    let direction = DVec3::new(2.0, 3.0, 6.0);
    let center = k * direction + DVec3::new(18.0, 6.0, -9.0);
    (Sphere { center, radius: 35.0 }, Ray::new(DVec3::ZERO, direction))
}

fn ahead(subject: &Subject) -> Verdict {
    let sphere = Sphere { center: DVec3::new(1.0, 2.0, -5.0), radius: 2.0 };
    let ray = Ray::new(DVec3::new(1.0, 2.0, 0.0), DVec3::NEG_Z);
    compare(subject, "straight at the centre", (sphere, ray), Some(3.0))
}

fn past(subject: &Subject) -> Verdict {
    let (sphere, ray) = aside(10.0);
    let sphere = Sphere { radius: 20.0, ..sphere };
    compare(subject, "the centre is 21 beside the ray", (sphere, ray), None)
}

fn any_length(subject: &Subject) -> Verdict {
    compare(subject, "the direction has length 7", aside(10.0), Some(6.0))
}

fn inside(subject: &Subject) -> Verdict {
    compare(subject, "from inside, towards the far wall", aside(1.0), Some(5.0))?;
    compare(subject, "from inside, towards the near wall", aside(-1.0), Some(3.0))?;
    let (sphere, ray) = aside(0.0);
    compare(subject, "from inside, F·D = 0", (sphere, ray), Some(4.0))?;
    let ray = Ray::new(sphere.center, ray.direction);
    compare(subject, "from the centre, F = 0", (sphere, ray), Some(5.0))
}

fn behind(subject: &Subject) -> Verdict {
    compare(subject, "the ray leads away from the sphere", aside(-10.0), None)
}

fn tangent(subject: &Subject) -> Verdict {
    let sphere = Sphere { center: DVec3::new(0.0, 3.0, -5.0), radius: 3.0 };
    let ray = Ray::new(DVec3::ZERO, DVec3::NEG_Z);
    compare(subject, "just touching", (sphere, ray), Some(5.0))
}

/// Whether t is right to all its digits but the last few, in all of some cases. Which of them fail depends on the
/// order of rounding; that some do does not.
fn precise(
    subject: &Subject,
    what: &str,
    mut cases: impl Iterator<Item = (Sphere, Ray, f64)>,
) -> Verdict {
    let is_right = |(sphere, ray, exact): (Sphere, Ray, f64)| {
        let t = (subject.ray_sphere)(&sphere, &ray);
        t.is_some_and(|t| (t / exact - 1.0).abs() < 1e-13)
    };
    ensure(cases.all(is_right), || {
        let got = "for some of them t is off by more than a part in 10¹³, or the sphere is lost";
        Mismatch::new(what, got, "all digits of t, but for the last rounding")
    })
}

fn far(subject: &Subject) -> Verdict {
    let cases = (0..48).map(|turn| far_sphere(1e8, turn));
    precise(subject, "spheres of radius 3.5, 2·10⁷ radii away, in 48 directions", cases)
}

/// P = 2²⁰ (2, 3, 6) is a point of a sphere of radius 7·2²⁰ around 0, and a ray along D = (1, −2, −3)/7 that starts
/// at P − 7 k D meets it there at t = 7 k. F·F − r² is a difference of integers, without rounding.
fn huge(subject: &Subject) -> Verdict {
    let size = f64::from(1 << 20);
    let sphere = Sphere { center: DVec3::ZERO, radius: 7.0 * size };
    let cases = (1..=48).map(|k| {
        let (k, along) = (f64::from(k), DVec3::new(1.0, -2.0, -3.0));
        let origin = size * DVec3::new(2.0, 3.0, 6.0) - k * along;
        (sphere, Ray::new(origin, along / 7.0), 7.0 * k)
    });
    precise(subject, "rays that start 3 to 150 above a sphere of radius 7340032", cases)
}

/// The whole of [`aside`] 2⁻⁵⁰ times as large, but for the direction.
fn tiny(subject: &Subject) -> Verdict {
    let (sphere, ray) = aside(10.0);
    let size = 0.5_f64.powi(50);
    let sphere = Sphere { center: size * sphere.center, radius: size * sphere.radius };
    let got = (subject.ray_sphere)(&sphere, &ray).map(|t| t / size);
    within(1e-12, || case("t · 2⁵⁰", &sphere, &ray), &got, &Some(6.0))
}

/// Points of a sphere as they are rounded, and a direction for each: outwards, and back across the sphere.
fn on_sphere(subject: &Subject) -> Verdict {
    let mut random = Uniform::new(3, 0, 0);
    // The noise grows as the sphere does, whose size is a power of 2, so that nothing else changes.
    for size in [1.0, 4096.0, 1.0 / 4096.0].into_iter().cycle().take(1500) {
        let sphere = Sphere { center: size * DVec3::new(0.3, -1.7, 2.9), radius: size * 0.7 };
        let (n, direction) = (random.direction(), random.direction());
        let ray = Ray::new(sphere.center + sphere.radius * n, direction);
        let cosine = n.dot(direction);
        // Nearer to the tangent the far end of the chord is rounding noise itself.
        if cosine.abs() < 1e-3 {
            continue;
        }
        let wanted = (cosine < 0.0).then_some(-1.4 * cosine);
        let got = (subject.ray_sphere)(&sphere, &ray).map(|t| t / size);
        if got.distance(&wanted) > 1e-11 {
            let (got, wanted) = match wanted {
                None => ("some meet the sphere, where they start or behind it", "None for each"),
                Some(_) => {
                    ("some do not meet it on its other side", "the other end of the chord for each")
                }
            };
            let to = if cosine < 0.0 { "into it" } else { "away from it" };
            let case = format!("rays that start on a sphere, up to rounding, and lead {to}");
            return Err(Mismatch::new(case, got, wanted));
        }
    }
    Ok(())
}

/// A side of a tile in pixels.
const TILE: u32 = 96;
const TO_LIGHT: DVec3 = DVec3::new(-0.48, 0.6, 0.64);

/// Above, balls at three distances, magnified. Below: the eye inside a ball, before which nothing stands; a
/// ball behind the eye; and a ball that is lit where a ray from its surface to the lamp does not meet it.
fn draw(subject: &Subject) -> Image {
    let hit = |center: DVec3, ray: &Ray| (subject.ray_sphere)(&Sphere { center, radius: 1.0 }, ray);
    painted(ImageSize::new(3 * TILE, 2 * TILE), |x, y| {
        let (column, row) = (x as u32 / TILE, y as u32 / TILE);
        let place = |film: f64| (film / f64::from(TILE)).fract() * 2.5 - 1.25;
        let (x, y) = (place(x), -place(y));
        let empty = Rgb::splat(if (column + row) % 2 == 0 { 0.03 } else { 0.06 });
        let shaded = |center: DVec3, ray: &Ray| {
            hit(center, ray).map_or(empty, |t| {
                let n = ray.at(t) - center;
                Rgb::new(0.85, 0.5, 0.2) * (0.08 + 0.92 * n.dot(TO_LIGHT).max(0.0))
            })
        };
        match (row, column) {
            (0, _) => {
                let distance = [10.0, 1e6, 3e7][column as usize];
                // Ahead, to the right and up: no direction is an axis.
                let center = distance * DVec3::new(-2.0, -3.0, -6.0) / 7.0;
                let (right, up) =
                    (DVec3::new(6.0, 2.0, -3.0) / 7.0, DVec3::new(-3.0, 6.0, -2.0) / 7.0);
                shaded(center, &Ray::new(DVec3::ZERO, center + x * right + y * up))
            }
            (_, 0) => {
                let ray = Ray::new(DVec3::new(0.2, -0.3, 0.4), DVec3::new(x, y, -0.7));
                let wall = hit(DVec3::ZERO, &ray).map_or(DVec3::NEG_ONE, |t| ray.at(t));
                0.5 + 0.5 * wall
            }
            (_, 1) => {
                shaded(DVec3::new(0.0, 0.0, 3.0), &Ray::new(DVec3::ZERO, DVec3::new(x, y, -2.5)))
            }
            _ => {
                let beside = x * x + y * y;
                if beside >= 1.0 {
                    return empty;
                }
                // The point is rounded, off the sphere or into it.
                let center = DVec3::new(0.3, -0.7, 0.9);
                let n = DVec3::new(x, y, (1.0 - beside).sqrt());
                let is_lit = hit(center, &Ray::new(center + n, TO_LIGHT)).is_none();
                Rgb::new(0.85, 0.8, 0.7) * if is_lit { 0.9 } else { 0.1 }
            }
        }
    })
}
