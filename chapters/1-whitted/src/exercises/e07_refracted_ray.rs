//! E1.7: the refracted ray.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::image::{Image, ImageSize};
use lancer_exercise::{
    Card, Check, Exercise, Mismatch, Shown, Solution, Verdict, same, slips, within,
};
use lancer_lesson::scenes::parsed;

use super::reference::refracted_ray;
use super::{Subject, drawn};

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E1.7",
        name: "refracted-ray",
        title: "The refracted ray",
        slide: "Reflets spéculaires : calcul du rayon réfracté",
        stub: include_str!("../../stubs/e07_refracted_ray.rs"),
        functions: &["refracted_ray"],
        minutes: 20,
        predict: "a diver looks straight up, in a picture 110 degrees wide, at a checkered ceiling above the \
                  water: how much of the picture shows it, and what do the corners show?",
        vary: "multiply n₁ / n₂ by 1.1 in your function: does the diver's window grow or shrink, and why?",
        hints: [
            "Split D (slide: V) into a part along N and a part along the surface, of length sin θ₁. Descartes \
             scales the second; the first has what is left of length 1.",
            "eq:descartes gives T = η D + (η cos θ₁ − cos θ₂) N with η = n₁ / n₂, cos θ₁ = −N·D and \
             cos² θ₂ = 1 − η² (1 − cos² θ₁). A negative cos² is total reflection.",
            "`let cos1 = -n.dot(incident);`, then `cos2_squared`; `None` if it is below 0, else \
             `Some(eta * incident + (eta * cos1 - cos2_squared.sqrt()) * n)`.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e07_refracted_ray.rs"),
            file: "crates/core/src/optics.rs",
            item: "pub fn refract_all",
            notice: "1 − cos² θ₁ is written (1 − cos θ₁)(1 + cos θ₁): near normal incidence the difference of \
                     squares loses its digits",
        },
    },
    checks: &[
        Check { name: "equal indices: straight on", run: straight_on },
        Check { name: "along the normal", run: along_normal },
        Check { name: "from air into water, by hand", run: entering },
        Check { name: "from water into air, by hand", run: leaving },
        Check { name: "total reflection", run: total_reflection },
        Check { name: "at the critical angle", run: critical_angle },
        Check { name: "grazing", run: grazing },
        Check { name: "unit, in the plane, n₁ sin θ₁ = n₂ sin θ₂", run: descartes },
    ],
    slips: slips! {
        refracted_ray(v, n, n1, n2):
        "n₁ and n₂ are swapped: water bends the ray away from the normal, air towards it":
            "from air into water, by hand" catches refracted_ray(v, n, n2, n1);
        "total reflection is not noticed: the square root of a negative number is NaN":
            "total reflection" catches Some(along(v, n, n1 / n2, f64::sqrt));
        "a negative cos² θ₂ is taken for 0: beyond the critical angle there is no refracted ray, not even a \
         grazing one":
            "total reflection" catches
                Some(along(v, n, n1 / n2, |cos_squared| cos_squared.max(0.0).sqrt()));
        "the part along N has the wrong sign: T = η D − (η cos θ₁ − cos θ₂) N":
            "from air into water, by hand" catches
                refracted_ray(v, n, n1, n2).map(|t| 2.0 * (n1 / n2) * v - t);
        "+ cos θ₂ N in place of − cos θ₂ N: the answer leads back to the side that the ray comes from":
            "equal indices: straight on" catches
                refracted_ray(v, n, n1, n2).map(|_| along(v, n, n1 / n2, |cos2_squared| -cos2_squared.sqrt()));
        "the root is missing: cos² θ₂ stands where cos θ₂ should":
            "equal indices: straight on" catches
                refracted_ray(v, n, n1, n2).map(|_| along(v, n, n1 / n2, |cos2_squared| cos2_squared));
        "η is not squared: sin θ₂ = η sin θ₁, so cos² θ₂ = 1 − η² sin² θ₁":
            "from air into water, by hand" catches {
                let (eta, cos1) = (n1 / n2, -n.dot(v));
                let cos2_squared = 1.0 - eta * (1.0 - cos1 * cos1);
                (cos2_squared >= 0.0).then(|| eta * v + (eta * cos1 - cos2_squared.sqrt()) * n)
            };
        "cos θ₁ is taken as N·D, which is negative here: N stands against the ray":
            "equal indices: straight on" catches
                refracted_ray(v, n, n1, n2).map(|t| t + 2.0 * (n1 / n2) * n.dot(v) * n);
        "η cos θ₁ N is missing: η D still has its part along N, and − cos θ₂ N comes on top of it":
            "equal indices: straight on" catches
                refracted_ray(v, n, n1, n2).map(|t| t + n1 / n2 * n.dot(v) * n);
        "the angles are scaled, θ₂ = η θ₁: that is right for small angles only, the law is about sines":
            "from air into water, by hand" catches {
                let cos1 = -n.dot(v);
                let (sin2, cos2) = (n1 / n2 * cos1.acos()).sin_cos();
                (cos2 >= 0.0).then(|| sin2 * (v + cos1 * n).normalize_or_zero() - cos2 * n)
            };
    },
    own: |yours, reference| Subject { refracted_ray: yours.refracted_ray, ..reference },
    draw,
    explain: None,
};

/// `eq:descartes` with any idea of a square root.
fn along(v: DVec3, n: DVec3, eta: f64, root: fn(f64) -> f64) -> DVec3 {
    let cos1 = -n.dot(v);
    eta * v + (eta * cos1 - root(1.0 - eta * eta * (1.0 - cos1 * cos1))) * n
}

/// A unit normal, and a unit vector along its surface: (2, 3, 6) · (3, −6, 2) = 0, and both have length 7.
const N: DVec3 = DVec3::new(2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0);
const ALONG: DVec3 = DVec3::new(3.0 / 7.0, -6.0 / 7.0, 2.0 / 7.0);

/// Its sine and its cosine.
type Angle = (f64, f64);

/// The unit direction that leaves the normal's side at an angle to −N.
fn down((sin, cos): Angle) -> DVec3 {
    sin * ALONG - cos * N
}

fn cos_of(sin: f64) -> f64 {
    (1.0 - sin * sin).sqrt()
}

fn case(v: DVec3, n: DVec3, n1: f64, n2: f64) -> String {
    let sin = v.cross(n).length();
    format!(
        "n₁ = {}, n₂ = {}, sin θ₁ = {}: incident {} (towards the surface), N {} (on its side)",
        n1.shown(),
        n2.shown(),
        sin.shown(),
        v.shown(),
        n.shown()
    )
}

fn compare(subject: &Subject, angle: Angle, n1: f64, n2: f64, wanted: Option<Angle>) -> Verdict {
    let v = down(angle);
    let got = (subject.refracted_ray)(v, N, n1, n2);
    let note = if wanted.is_none() { "; None is total reflection" } else { "" };
    within(1e-10, || case(v, N, n1, n2) + note, &got, &wanted.map(down))
}

fn straight_on(subject: &Subject) -> Verdict {
    compare(subject, (0.6, 0.8), 1.0, 1.0, Some((0.6, 0.8)))?;
    compare(subject, (0.96, 0.28), 1.7, 1.7, Some((0.96, 0.28)))
}

fn along_normal(subject: &Subject) -> Verdict {
    compare(subject, (0.0, 1.0), 1.0, 1.5, Some((0.0, 1.0)))?;
    compare(subject, (0.0, 1.0), 1.5, 1.0, Some((0.0, 1.0)))
}

/// Water has n = 4/3, so the sine 4/5 becomes 3/5.
fn entering(subject: &Subject) -> Verdict {
    compare(subject, (0.8, 0.6), 1.0, 4.0 / 3.0, Some((0.6, 0.8)))
}

fn leaving(subject: &Subject) -> Verdict {
    compare(subject, (0.6, 0.8), 4.0 / 3.0, 1.0, Some((0.8, 0.6)))
}

/// Out of water the sine 4/5 would become 16/15.
fn total_reflection(subject: &Subject) -> Verdict {
    compare(subject, (0.8, 0.6), 4.0 / 3.0, 1.0, None)?;
    compare(subject, (0.96, 0.28), 1.5, 1.0, None)
}

/// Out of glass the last sine that passes is 2/3.
fn critical_angle(subject: &Subject) -> Verdict {
    for (factor, passes) in [(1.0 - 1e-6, true), (1.0 + 1e-6, false)] {
        let sin1 = factor * 2.0 / 3.0;
        // cos² θ₂ = 1 − factor², as a product.
        let cos2 = f64::sqrt((1.0 - factor) * (1.0 + factor));
        compare(subject, (sin1, cos_of(sin1)), 1.5, 1.0, passes.then_some((factor, cos2)))?;
    }
    Ok(())
}

/// A ray along the surface is bent to the critical angle: sin θ₂ = 1 / 1.5.
fn grazing(subject: &Subject) -> Verdict {
    let cos1 = 1e-6;
    let sin2 = cos_of(cos1) * 2.0 / 3.0;
    compare(subject, (cos_of(cos1), cos1), 1.0, 1.5, Some((sin2, cos_of(sin2))))
}

/// The law and what it leaves open, for normals and directions in all octants.
fn descartes(subject: &Subject) -> Verdict {
    let normals = [DVec3::new(1.0, 2.0, -2.0) / 3.0, DVec3::new(-4.0, -1.0, 8.0) / 9.0, -N];
    let indices = [(1.0, 1.5), (1.5, 1.0), (1.33, 2.4), (2.4, 1.33)];
    for n in normals {
        let (a, b) = n.any_orthonormal_pair();
        for (n1, n2) in indices {
            // No eleventh is a critical angle.
            for step in 1..11 {
                let (sin1, turn) = (f64::from(step) / 11.0, f64::from(step));
                if n1 * sin1 > n2 {
                    continue;
                }
                let v = sin1 * (turn.cos() * a + turn.sin() * b) - cos_of(sin1) * n;
                judge(v, n, n1, n2, (subject.refracted_ray)(v, n, n1, n2))?;
            }
        }
    }
    Ok(())
}

fn judge(v: DVec3, n: DVec3, n1: f64, n2: f64, t: Option<DVec3>) -> Verdict {
    let case = |what: &str| format!("{what}: {}", case(v, n, n1, n2));
    let Some(t) = t else {
        return Err(Mismatch::new(case("whether a ray passes"), "None", "a direction"));
    };
    within(1e-10, || case("the length of T"), &t.length(), &1.0)?;
    within(1e-10, || case("T·(N×D)"), &t.dot(n.cross(v)), &0.0)?;
    same(|| case("whether N·T < 0, behind the surface"), &(n.dot(t) < 0.0), &true)?;
    let sines = |v: DVec3, index: f64| index * n.cross(v);
    within(1e-10, || case("n₂ N×T beside n₁ N×D"), &sines(t, n2), &sines(v, n1))
}

/// What a diver sees who looks up: a checkered ceiling above the water, and beyond the critical angle the dark
/// water mirrored.
fn draw(subject: &Subject) -> Image {
    let scene = parsed("diver", DIVER);
    drawn(&scene, ImageSize::new(240, 240), |ray, surface| {
        let Some(surface) = surface else { return Rgb::ZERO };
        let n = surface.optical_normal(ray.direction);
        match (subject.refracted_ray)(ray.direction, n, 4.0 / 3.0, 1.0) {
            None => Rgb::new(0.01, 0.06, 0.09),
            Some(t) if t.y > 0.0 => {
                let way = CEILING / t.y;
                let p = ((surface.position + way * t) / SQUARE).floor();
                let is_even = (p.x + p.z).rem_euclid(2.0) == 0.0;
                let ceiling =
                    if is_even { Rgb::new(0.9, 0.75, 0.3) } else { Rgb::new(0.5, 0.12, 0.1) };
                // Haze before the squares get smaller than the pixels.
                Rgb::new(0.45, 0.62, 0.85).lerp(ceiling, (-way / (8.0 * CEILING)).exp())
            }
            // No answer leads back into the water.
            Some(_) => Rgb::new(0.8, 0.0, 0.8),
        }
    })
}

const CEILING: f64 = 3.0;
const SQUARE: f64 = 2.0;

const DIVER: &str = "
    camera = { eye = [0, -1, 0], look_at = [0, 0, 0], up = [0, 0, -1], fov = 110 }
    material.water = { k_t = 1, refractive_index = 1.3333333333333333 }
    polygon = [{ vertices = [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]], material = 'water' }]";
