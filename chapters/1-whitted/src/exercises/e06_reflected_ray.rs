//! E1.6: the mirror ray.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::image::{Image, ImageSize};
use lancer_exercise::{Card, Check, Exercise, Shown, Solution, Verdict, slips, within};
use lancer_lesson::scenes::parsed;

use super::{Subject, drawn};

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E1.6",
        name: "reflected-ray",
        title: "The mirror ray",
        slide: "Reflets spéculaires : calcul du rayon réfléchi",
        stub: include_str!("../../stubs/e06_reflected_ray.rs"),
        functions: &["reflected_ray"],
        minutes: 10,
        predict: "the picture colours a ball by the direction in which it mirrors the eye's ray: what is \
                  the colour in its middle, and what at its rim?",
        vary: "turn N around in your function: why does the picture stay the same?",
        hints: [
            "Split D into a part along N and a part along the surface. A mirror turns one of them around.",
            "eq:reflected-ray: R = D − 2 (N·D) N, with D (slide: V) towards the surface.",
            "`n.dot(incident)` is N·D; take twice that many `n` away from `incident`.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e06_reflected_ray.rs"),
            file: "crates/core/src/optics.rs",
            item: "pub fn reflect",
            notice: "nothing is normalised: mirroring keeps the length, up to rounding",
        },
    },
    checks: &[
        Check { name: "45 degrees onto a floor", run: floor },
        Check { name: "any plane, by hand", run: by_hand },
        Check { name: "the normal may stand on either side", run: either_side },
    ],
    slips: slips! {
        reflected_ray(v, n):
        "the factor 2 is missing: the vector is projected onto the surface, not mirrored":
            "45 degrees onto a floor" catches v - n.dot(v) * n;
        "D is taken as pointing away from the surface: the answer leads into it":
            "45 degrees onto a floor" catches 2.0 * n.dot(v) * n - v;
        "N·D is made positive: that is right for one side of the surface only":
            "the normal may stand on either side" catches v + 2.0 * n.dot(v).abs() * n;
        "the sign is wrong: twice the normal part is added where it should be taken away":
            "45 degrees onto a floor" catches v + 2.0 * n.dot(v) * n;
    },
    own: |yours, reference| Subject { reflected_ray: yours.reflected_ray, ..reference },
    draw,
    explain: None,
};

fn compare(subject: &Subject, incident: DVec3, n: DVec3, wanted: DVec3) -> Verdict {
    let case = || format!("incident {} (towards the surface), N {}", incident.shown(), n.shown());
    within(1e-14, case, &(subject.reflected_ray)(incident, n), &wanted)
}

fn floor(subject: &Subject) -> Verdict {
    let incident = DVec3::new(0.6, -0.8, 0.0);
    compare(subject, incident, DVec3::Y, DVec3::new(0.6, 0.8, 0.0))
}

/// N = (2, 3, 6)/7 and D = (−1, −5, −4)/√42: N·D = −41/(7 √42), R = D + 82/49 (2, 3, 6)/√42.
fn by_hand(subject: &Subject) -> Verdict {
    slanted(subject, 1.0)
}

fn either_side(subject: &Subject) -> Verdict {
    slanted(subject, -1.0)
}

fn slanted(subject: &Subject, side: f64) -> Verdict {
    let (n, root) = (side * DVec3::new(2.0, 3.0, 6.0) / 7.0, 42.0_f64.sqrt());
    let wanted = DVec3::new(115.0, 1.0, 296.0) / (49.0 * root);
    compare(subject, DVec3::new(-1.0, -5.0, -4.0) / root, n, wanted)
}

/// A ball in the colours of the directions that it mirrors: red, green and blue are x, y and z.
fn draw(subject: &Subject) -> Image {
    let scene = parsed("ball", BALL);
    let size = ImageSize::new(240, 240);
    drawn(&scene, size, |ray, surface| {
        let Some(surface) = surface else { return Rgb::splat(0.05) };
        let n = surface.shading_normal_towards(-ray.direction);
        0.5 + 0.5 * (subject.reflected_ray)(ray.direction, n)
    })
}

const BALL: &str = "
    camera = { eye = [0, 0, 5], look_at = [0, 0, 0], fov = 26 }
    material.ball = { rho_d = 1 }
    light = [{ position = [0, 0, 5], intensity = 1 }]
    sphere = [{ center = [0, 0, 0], radius = 1, material = 'ball' }]";
