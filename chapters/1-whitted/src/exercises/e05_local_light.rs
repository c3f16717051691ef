//! E1.5: one lamp's part of the local model.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::illumination::{Reflectance, attenuation};
use lancer_core::image::{Image, ImageSize};
use lancer_core::optics::reflect;
use lancer_exercise::{Card, Check, Exercise, Mismatch, Mutant, Shown, Solution, within};
use lancer_lesson::scenes::parsed;

use super::reference::local_light;
use super::{Subject, drawn};

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E1.5",
        name: "local-light",
        title: "One lamp's light on a surface",
        slide: "Modèle d'éclairage, modèle local",
        file: "e05_local_light.rs",
        stub: include_str!("../../stubs/e05_local_light.rs"),
        functions: &["local_light"],
        minutes: 15,
        predict: "three balls of shininess 2, 16 and 128 stand under one white lamp, and a blue lamp is behind \
                  them: on which ball is the highlight largest, and on which sides is there blue?",
        vary: "write N·H in place of R·V, with H = (L + V)/|L + V|, halfway between them (Blinn's form): do the \
               highlights grow or shrink, and which exponent would make them alike?",
        hints: [
            "Two parts are added: a matte one, which depends on how the surface faces the lamp, and a glossy \
             one, which depends on how near the eye is to the mirror direction of the light. Neither can be \
             negative, and a surface that does not face the lamp gets nothing of it.",
            "eq:local, one term: I · vis/d² · (ρ_d (N·L) + ρ_s (R·V)ⁿ), with N·L and R·V taken as 0 where they are \
             negative, and R = 2 (N·L) N − L. If N·L ≤ 0 the whole term is 0.",
            "`let cos_light = n.dot(to_light);` and leave with `Rgb::ZERO` if the lamp is not visible or \
             `cos_light <= 0.0`. `let mirror = 2.0 * cos_light * n - to_light;` \
             `let highlight = mirror.dot(to_eye).max(0.0).powf(reflectance.shininess);` then the sum times \
             `intensity / (distance * distance)`.",
        ],
        solution: Solution {
            file: "crates/core/src/illumination.rs",
            item: "pub fn local",
            notice: "vis/d² is a function of its own, eq:attenuation, and R comes from the same `reflect` as the \
                     mirror ray",
        },
    },
    checks: &[
        Check { name: "a matte surface that faces the lamp", run: facing },
        Check { name: "a matte surface at a slant", run: slanted },
        Check { name: "a lamp in the shadow", run: hidden },
        Check { name: "a highlight beside the mirror direction", run: highlight },
        Check { name: "both parts, by hand", run: both },
        Check { name: "the eye far from the mirror direction", run: far_from_mirror },
        Check { name: "a lamp behind the surface", run: lamp_behind },
    ],
    mutants: &[
        Mutant {
            says: "1/d in place of 1/d²: light spreads over an area",
            caught_by: "a matte surface that faces the lamp",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    d * local_light(i, visible, d, reflectance, n, l, v)
                };
            },
        },
        Mutant {
            says: "1/d² is missing: a lamp far away shines as bright as one nearby",
            caught_by: "a matte surface that faces the lamp",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    d * d * local_light(i, visible, d, reflectance, n, l, v)
                };
            },
        },
        Mutant {
            says: "1/d² weakens the matte part alone: the brackets hold the highlight too",
            caught_by: "a highlight beside the mirror direction",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    let matte = Reflectance { specular: Rgb::ZERO, ..*reflectance };
                    let glossy = Reflectance { diffuse: Rgb::ZERO, ..*reflectance };
                    local_light(i, visible, d, &matte, n, l, v)
                        + d * d * local_light(i, visible, d, &glossy, n, l, v)
                };
            },
        },
        Mutant {
            says: "vis is forgotten: a lamp behind something shines nevertheless",
            caught_by: "a lamp in the shadow",
            mistake: |subject| {
                subject.local_light =
                    |i, _, d, reflectance, n, l, v| local_light(i, true, d, reflectance, n, l, v);
            },
        },
        Mutant {
            says: "N·L is not taken as 0 where it is negative: a lamp behind the surface takes light away",
            caught_by: "a lamp behind the surface",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    let highlight = if n.dot(l) > 0.0 {
                        lobe(r_dot_v(n, l, v).max(0.0), reflectance)
                    } else {
                        Rgb::ZERO
                    };
                    i * attenuation(visible, d) * (reflectance.diffuse * n.dot(l) + highlight)
                };
            },
        },
        Mutant {
            says: "a lamp behind the surface makes a highlight: where N·L is negative both parts are 0",
            caught_by: "a lamp behind the surface",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    let matte = reflectance.diffuse * n.dot(l).max(0.0);
                    let highlight = lobe(r_dot_v(n, l, v).max(0.0), reflectance);
                    i * attenuation(visible, d) * (matte + highlight)
                };
            },
        },
        Mutant {
            says: "nothing is taken as 0 where it is negative: neither N·L nor R·V",
            caught_by: "a lamp behind the surface",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    let highlight = lobe(r_dot_v(n, l, v), reflectance);
                    i * attenuation(visible, d) * (reflectance.diffuse * n.dot(l) + highlight)
                };
            },
        },
        Mutant {
            says: "R·V is not taken as 0 where it is negative: an even power of it lights the wrong side",
            caught_by: "the eye far from the mirror direction",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    if n.dot(l) <= 0.0 {
                        return Rgb::ZERO;
                    }
                    let highlight = lobe(r_dot_v(n, l, v), reflectance);
                    i * attenuation(visible, d) * (reflectance.diffuse * n.dot(l) + highlight)
                };
            },
        },
        Mutant {
            says: "the highlight is multiplied by N·L: in the slide's formula only ρ_d is",
            caught_by: "a highlight beside the mirror direction",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    let specular = reflectance.specular * n.dot(l).max(0.0);
                    local_light(i, visible, d, &Reflectance { specular, ..*reflectance }, n, l, v)
                };
            },
        },
        Mutant {
            says: "N·H in place of R·V: that is Blinn's highlight, wider than the slide's",
            caught_by: "a highlight beside the mirror direction",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    if n.dot(l) <= 0.0 {
                        return Rgb::ZERO;
                    }
                    let highlight = lobe(n.dot((l + v).normalize()), reflectance);
                    i * attenuation(visible, d) * (reflectance.diffuse * n.dot(l) + highlight)
                };
            },
        },
        Mutant {
            says: "R leads into the surface: L points at the lamp, so the light arrives along −L, and \
                   R = 2 (N·L) N − L",
            caught_by: "a highlight beside the mirror direction",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    if n.dot(l) <= 0.0 {
                        return Rgb::ZERO;
                    }
                    let highlight = lobe((-r_dot_v(n, l, v)).max(0.0), reflectance);
                    i * attenuation(visible, d) * (reflectance.diffuse * n.dot(l) + highlight)
                };
            },
        },
        Mutant {
            says: "the exponent multiplies: (R·V)ⁿ is a power",
            caught_by: "a highlight beside the mirror direction",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    let specular = reflectance.specular * reflectance.shininess;
                    let linear = Reflectance { specular, shininess: 1.0, ..*reflectance };
                    local_light(i, visible, d, &linear, n, l, v)
                };
            },
        },
        Mutant {
            says: "the power is taken of ρ_s (R·V): only R·V is raised to n",
            caught_by: "a highlight beside the mirror direction",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    let specular = reflectance.specular.powf(reflectance.shininess);
                    local_light(i, visible, d, &Reflectance { specular, ..*reflectance }, n, l, v)
                };
            },
        },
        Mutant {
            says: "L and V are exchanged: the matte part depends on the lamp's direction, not on the eye's",
            caught_by: "a matte surface at a slant",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    local_light(i, visible, d, reflectance, n, v, l)
                };
            },
        },
        Mutant {
            says: "absolute values are taken: what is negative is behind, and counts as 0",
            caught_by: "the eye far from the mirror direction",
            mistake: |subject| {
                subject.local_light = |i, visible, d, reflectance, n, l, v| {
                    let highlight = lobe(r_dot_v(n, l, v).abs(), reflectance);
                    i * attenuation(visible, d) * (reflectance.diffuse * n.dot(l).abs() + highlight)
                };
            },
        },
    ],
    draw,
    explain: None,
};

/// R·V, also where it is negative.
fn r_dot_v(n: DVec3, to_light: DVec3, to_eye: DVec3) -> f64 {
    reflect(-to_light, n).dot(to_eye)
}

fn lobe(cosine: f64, reflectance: &Reflectance) -> Rgb {
    reflectance.specular * cosine.powf(reflectance.shininess)
}

/// A lamp's light on a surface, and from where it is seen.
struct Lit {
    intensity: Rgb,
    visible: bool,
    distance: f64,
    reflectance: Reflectance,
    n: DVec3,
    to_light: DVec3,
    to_eye: DVec3,
}

impl Lit {
    /// A lamp of intensity (4, 8, 12) two units above a floor of ρ_d = (0.5, 0.25, 1), seen from above.
    const FLOOR: Self = Self {
        intensity: Rgb::new(4.0, 8.0, 12.0),
        visible: true,
        distance: 2.0,
        reflectance: Reflectance {
            diffuse: Rgb::new(0.5, 0.25, 1.0),
            specular: Rgb::ZERO,
            shininess: 2.0,
        },
        n: DVec3::Y,
        to_light: DVec3::Y,
        to_eye: DVec3::Y,
    };
    /// A lamp of intensity 100 at distance 5, so that I/d² is 4; ρ_s = (0.5, 0.25, 1), n = 2.
    const GLOSSY: Self = Self {
        intensity: Rgb::splat(100.0),
        distance: 5.0,
        reflectance: Reflectance {
            diffuse: Rgb::ZERO,
            specular: Rgb::new(0.5, 0.25, 1.0),
            shininess: 2.0,
        },
        ..Self::FLOOR
    };

    fn is(&self, subject: &Subject, wanted: Rgb) -> Result<(), Mismatch> {
        let Self { intensity, visible, distance, reflectance, n, to_light, to_eye } = self;
        let got = (subject.local_light)(
            *intensity,
            *visible,
            *distance,
            reflectance,
            *n,
            *to_light,
            *to_eye,
        );
        let case = || {
            format!(
                "I {}, {}, d {}, ρ_d {}, ρ_s {}, exponent {}, N {}, L (to the lamp) {}, V (to the eye) {}",
                intensity.shown(),
                if *visible { "visible" } else { "not visible" },
                distance.shown(),
                reflectance.diffuse.shown(),
                reflectance.specular.shown(),
                reflectance.shininess.shown(),
                n.shown(),
                to_light.shown(),
                to_eye.shown()
            )
        };
        within(1e-12, case, &got, &wanted)
    }
}

fn facing(subject: &Subject) -> Result<(), Mismatch> {
    Lit::FLOOR.is(subject, Rgb::new(0.5, 0.5, 3.0))
}

/// N·L = 0.8.
fn slanted(subject: &Subject) -> Result<(), Mismatch> {
    let to_light = DVec3::new(0.6, 0.8, 0.0);
    Lit { to_light, ..Lit::FLOOR }.is(subject, Rgb::new(0.4, 0.4, 2.4))
}

fn hidden(subject: &Subject) -> Result<(), Mismatch> {
    Lit { visible: false, ..Lit::FLOOR }.is(subject, Rgb::ZERO)
}

/// R = (−0.6, 0.8, 0), so R·V = 0.64, and its square times I/d² is 1.6384.
fn highlight(subject: &Subject) -> Result<(), Mismatch> {
    let (to_light, to_eye) = (DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.0, 0.8, 0.6));
    Lit { to_light, to_eye, ..Lit::GLOSSY }.is(subject, 1.6384 * Rgb::new(0.5, 0.25, 1.0))
}

/// N = (2, 3, 6)/7, L = (−2, 3, 6)/7, V = (6, 2, 3)/7: N·L = 41/49, R = (262, 99, 198)/343,
/// R·V = 2364/2401.
fn both(subject: &Subject) -> Result<(), Mismatch> {
    let (diffuse, specular) = (Rgb::new(0.7, 0.3, 0.1), Rgb::new(0.2, 0.4, 0.6));
    let lit = Lit {
        reflectance: Reflectance { diffuse, specular, shininess: 3.0 },
        n: DVec3::new(2.0, 3.0, 6.0) / 7.0,
        to_light: DVec3::new(-2.0, 3.0, 6.0) / 7.0,
        to_eye: DVec3::new(6.0, 2.0, 3.0) / 7.0,
        ..Lit::FLOOR
    };
    let cube = 2364.0 * 2364.0 * 2364.0 / (2401.0 * 2401.0 * 2401.0);
    lit.is(subject, Rgb::new(1.0, 2.0, 3.0) * (diffuse * (41.0 / 49.0) + specular * cube))
}

/// R = (−0.8, 0.6, 0), so R·V = −0.28: only ρ_d (N·L) = 0.6 (0.5, 0.25, 1) is left.
fn far_from_mirror(subject: &Subject) -> Result<(), Mismatch> {
    let slant = DVec3::new(0.8, 0.6, 0.0);
    let reflectance = Reflectance { diffuse: Rgb::new(0.5, 0.25, 1.0), ..Lit::GLOSSY.reflectance };
    let lit = Lit { reflectance, to_light: slant, to_eye: slant, ..Lit::GLOSSY };
    lit.is(subject, Rgb::new(1.2, 0.6, 2.4))
}

/// N·L = −0.8 and R = (−0.6, −0.8, 0), so R·V = 0.352 though the lamp is below the surface.
fn lamp_behind(subject: &Subject) -> Result<(), Mismatch> {
    let (to_light, to_eye) = (DVec3::new(0.6, -0.8, 0.0), DVec3::new(-0.96, 0.28, 0.0));
    Lit { to_light, to_eye, ..Lit::FLOOR }.is(subject, Rgb::ZERO)?;
    Lit { to_light, to_eye, ..Lit::GLOSSY }.is(subject, Rgb::ZERO)
}

/// Balls of growing shininess in the light of a white lamp, from the upper left, and of a blue one behind
/// them on the right. No shadow is cast: the function is shown alone.
fn draw(subject: &Subject) -> Image {
    let scene = parsed("balls", BALLS);
    drawn(&scene, ImageSize::new(336, 128), |ray, surface| {
        let Some(surface) = surface else { return Rgb::splat(0.02) };
        let material = scene.material(surface.material);
        let n = surface.shading_normal_towards(-ray.direction);
        let reflectance = Reflectance {
            diffuse: material.rho_d.at(surface.position, surface.geometric_normal),
            specular: material.rho_s,
            shininess: material.shininess,
        };
        let lamps = scene.lights.iter().map(|lamp| {
            let toward = lamp.position - surface.position;
            let (d, l) = (toward.length(), toward.normalize());
            (subject.local_light)(lamp.intensity, true, d, &reflectance, n, l, -ray.direction)
        });
        lamps.sum()
    })
}

const BALLS: &str = "
    camera = { eye = [0, 0, 12], look_at = [0, 0, 0], fov = 12 }
    material.dull = { rho_d = [0.6, 0.25, 0.08], rho_s = 0.5, shininess = 2 }
    material.satin = { rho_d = [0.6, 0.25, 0.08], rho_s = 0.5, shininess = 16 }
    material.gloss = { rho_d = [0.6, 0.25, 0.08], rho_s = 0.5, shininess = 128 }
    light = [
        { position = [-3, 4, 4], intensity = 30 },
        { position = [6, -2, -3], intensity = [4, 10, 60] },
    ]
    sphere = [
        { center = [-2.2, 0, 0], radius = 1, material = 'dull' },
        { center = [0, 0, 0], radius = 1, material = 'satin' },
        { center = [2.2, 0, 0], radius = 1, material = 'gloss' },
    ]";
