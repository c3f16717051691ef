//! E1.5: one lamp's part of the local model.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::illumination::{Reflectance, attenuation};
use lancer_core::image::{Image, ImageSize};
use lancer_core::optics::reflect;
use lancer_exercise::{Card, Check, Exercise, Shown, Solution, Verdict, slips, within};
use lancer_lesson::scenes::parsed;

use super::reference::local_light;
use super::{Lit, Subject, drawn};

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E1.5",
        name: "local-light",
        title: "One lamp's light on a surface",
        slide: "Modèle d'éclairage, modèle local",
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
            "eq:local, one term: I · vis/d² · (ρ_d (N·L) + ρ_s (R·V)ⁿ) with R = 2 (N·L) N − L. If N·L ≤ 0 the whole \
             term is 0, highlight included; if R·V < 0 the highlight alone is.",
            "`let cos_light = n.dot(to_light);` and leave with `Rgb::ZERO` if the lamp is not visible or \
             `cos_light <= 0.0`. `let mirror = 2.0 * cos_light * n - to_light;` \
             `let highlight = mirror.dot(to_eye).max(0.0).powf(reflectance.shininess);` then the sum times \
             `intensity / (distance * distance)`.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e05_local_light.rs"),
            file: "crates/core/src/illumination.rs",
            item: "pub fn local",
            notice: "it is the bracket of eq:local: `lit`, below it, multiplies it by I · vis/d² and asks for vis last, \
                     and R comes from the same `reflect` as the mirror ray",
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
    slips: slips! {
        local_light(lit):
        "1/d in place of 1/d²: light spreads over an area":
            "a matte surface that faces the lamp" catches lit.distance * local_light(lit);
        "1/d² is missing: a lamp far away shines as bright as one nearby":
            "a matte surface that faces the lamp" catches lit.distance.powi(2) * local_light(lit);
        "1/d² weakens the matte part alone: the brackets hold the highlight too":
            "a highlight beside the mirror direction" catches {
                let matte = with_reflectance(lit, |r| r.specular = Rgb::ZERO);
                let glossy = with_reflectance(lit, |r| r.diffuse = Rgb::ZERO);
                matte + lit.distance.powi(2) * glossy
            };
        "vis is forgotten: a lamp behind something shines nevertheless":
            "a lamp in the shadow" catches local_light(&Lit { visible: true, ..*lit });
        "N·L is not taken as 0 where it is negative: a lamp behind the surface takes light away":
            "a lamp behind the surface" catches
                with_cosines(lit, n_l(lit), if n_l(lit) > 0.0 { r_v(lit).max(0.0) } else { 0.0 });
        "a lamp behind the surface makes a highlight: where N·L is negative both parts are 0":
            "a lamp behind the surface" catches
                with_cosines(lit, n_l(lit).max(0.0), r_v(lit).max(0.0));
        "nothing is taken as 0 where it is negative: neither N·L nor R·V":
            "a lamp behind the surface" catches with_cosines(lit, n_l(lit), r_v(lit));
        "R·V is not taken as 0 where it is negative: an even power of it lights the wrong side":
            "the eye far from the mirror direction" catches with_highlight(lit, r_v(lit));
        "the highlight is multiplied by N·L: in the slide's formula only ρ_d is":
            "a highlight beside the mirror direction" catches
                with_reflectance(lit, |r| r.specular *= n_l(lit).max(0.0));
        "N·H in place of R·V: that is Blinn's highlight, wider than the slide's":
            "a highlight beside the mirror direction" catches
                with_highlight(lit, lit.n.dot((lit.to_light + lit.to_eye).normalize()));
        "R leads into the surface: L points at the lamp, so the light arrives along −L, and R = 2 (N·L) N − L":
            "a highlight beside the mirror direction" catches
                with_highlight(lit, (-r_v(lit)).max(0.0));
        "the exponent multiplies: (R·V)ⁿ is a power":
            "a highlight beside the mirror direction" catches with_reflectance(lit, |r| {
                (r.specular, r.shininess) = (r.specular * r.shininess, 1.0);
            });
        "the power is taken of ρ_s (R·V): only R·V is raised to n":
            "a highlight beside the mirror direction" catches
                with_reflectance(lit, |r| r.specular = r.specular.powf(r.shininess));
        "L and V are exchanged: the matte part depends on the lamp's direction, not on the eye's":
            "a matte surface at a slant" catches
                local_light(&Lit { to_light: lit.to_eye, to_eye: lit.to_light, ..*lit });
        "absolute values are taken: what is negative is behind, and counts as 0":
            "the eye far from the mirror direction" catches
                with_cosines(lit, n_l(lit).abs(), r_v(lit).abs());
    },
    own: |yours, reference| Subject { local_light: yours.local_light, ..reference },
    draw,
    explain: None,
};

/// N·L, also where it is negative.
fn n_l(lit: &Lit) -> f64 {
    lit.n.dot(lit.to_light)
}

/// R·V, also where it is negative.
fn r_v(lit: &Lit) -> f64 {
    reflect(-lit.to_light, lit.n).dot(lit.to_eye)
}

/// The term with these in place of N·L and R·V.
fn with_cosines(lit: &Lit, n_l: f64, r_v: f64) -> Rgb {
    let Reflectance { diffuse, specular, shininess } = lit.reflectance;
    let bracket = diffuse * n_l + specular * r_v.powf(shininess);
    lit.intensity * attenuation(lit.visible, lit.distance) * bracket
}

/// The right term, but for R·V.
fn with_highlight(lit: &Lit, r_v: f64) -> Rgb {
    if n_l(lit) > 0.0 { with_cosines(lit, n_l(lit), r_v) } else { Rgb::ZERO }
}

/// The right term of another surface.
fn with_reflectance(lit: &Lit, change: impl Fn(&mut Reflectance)) -> Rgb {
    let mut changed = *lit;
    change(&mut changed.reflectance);
    local_light(&changed)
}

/// A lamp of intensity (4, 8, 12) two units above a floor of ρ_d = (0.5, 0.25, 1), seen from above.
const FLOOR: Lit = Lit {
    intensity: Rgb::new(4.0, 8.0, 12.0),
    visible: true,
    distance: 2.0,
    reflectance: Reflectance { diffuse: RHO, specular: Rgb::ZERO, shininess: 2.0 },
    n: DVec3::Y,
    to_light: DVec3::Y,
    to_eye: DVec3::Y,
};
const RHO: Rgb = Rgb::new(0.5, 0.25, 1.0);
/// A lamp of intensity 100 at distance 5, so that I/d² is 4; ρ_s = (0.5, 0.25, 1), n = 2.
const GLOSSY: Lit = Lit {
    intensity: Rgb::splat(100.0),
    distance: 5.0,
    reflectance: Reflectance { diffuse: Rgb::ZERO, specular: RHO, shininess: 2.0 },
    ..FLOOR
};

fn compare(subject: &Subject, lit: &Lit, wanted: Rgb) -> Verdict {
    let case = || {
        let Lit { intensity, visible, distance, reflectance, n, to_light, to_eye } = lit;
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
    within(1e-12, case, &(subject.local_light)(lit), &wanted)
}

fn facing(subject: &Subject) -> Verdict {
    compare(subject, &FLOOR, Rgb::new(0.5, 0.5, 3.0))
}

/// N·L = 0.8.
fn slanted(subject: &Subject) -> Verdict {
    let lit = Lit { to_light: DVec3::new(0.6, 0.8, 0.0), ..FLOOR };
    compare(subject, &lit, Rgb::new(0.4, 0.4, 2.4))
}

fn hidden(subject: &Subject) -> Verdict {
    compare(subject, &Lit { visible: false, ..FLOOR }, Rgb::ZERO)
}

/// R = (−0.6, 0.8, 0), so R·V = 0.64, and its square times I/d² is 1.6384.
fn highlight(subject: &Subject) -> Verdict {
    let (to_light, to_eye) = (DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.0, 0.8, 0.6));
    compare(subject, &Lit { to_light, to_eye, ..GLOSSY }, 1.6384 * RHO)
}

/// N = (2, 3, 6)/7, L = (−2, 3, 6)/7, V = (6, 2, 3)/7: N·L = 41/49, R = (262, 99, 198)/343,
/// R·V = 2364/2401.
fn both(subject: &Subject) -> Verdict {
    let (diffuse, specular) = (Rgb::new(0.7, 0.3, 0.1), Rgb::new(0.2, 0.4, 0.6));
    let lit = Lit {
        reflectance: Reflectance { diffuse, specular, shininess: 3.0 },
        n: DVec3::new(2.0, 3.0, 6.0) / 7.0,
        to_light: DVec3::new(-2.0, 3.0, 6.0) / 7.0,
        to_eye: DVec3::new(6.0, 2.0, 3.0) / 7.0,
        ..FLOOR
    };
    let cube = 2364.0 * 2364.0 * 2364.0 / (2401.0 * 2401.0 * 2401.0);
    let wanted = Rgb::new(1.0, 2.0, 3.0) * (diffuse * (41.0 / 49.0) + specular * cube);
    compare(subject, &lit, wanted)
}

/// R = (−0.8, 0.6, 0), so R·V = −0.28: only ρ_d (N·L) = 0.6 (0.5, 0.25, 1) is left.
fn far_from_mirror(subject: &Subject) -> Verdict {
    let slant = DVec3::new(0.8, 0.6, 0.0);
    let reflectance = Reflectance { diffuse: RHO, ..GLOSSY.reflectance };
    let lit = Lit { reflectance, to_light: slant, to_eye: slant, ..GLOSSY };
    compare(subject, &lit, Rgb::new(1.2, 0.6, 2.4))
}

/// N·L = −0.8 and R = (−0.6, −0.8, 0), so R·V = 0.352 though the lamp is below the surface.
fn lamp_behind(subject: &Subject) -> Verdict {
    let (to_light, to_eye) = (DVec3::new(0.6, -0.8, 0.0), DVec3::new(-0.96, 0.28, 0.0));
    compare(subject, &Lit { to_light, to_eye, ..FLOOR }, Rgb::ZERO)?;
    compare(subject, &Lit { to_light, to_eye, ..GLOSSY }, Rgb::ZERO)
}

/// Balls of growing shininess in the light of a white lamp, from the upper left, and of a blue one behind
/// them on the right. No shadow is cast: the function is shown alone.
fn draw(subject: &Subject) -> Image {
    let scene = parsed("balls", BALLS);
    drawn(&scene, ImageSize::new(336, 128), |ray, surface| {
        let Some(surface) = surface else { return Rgb::splat(0.02) };
        let n = surface.shading_normal_towards(-ray.direction);
        let reflectance = scene.reflectance(&surface);
        let lamps = scene.lights.iter().map(|lamp| {
            let (intensity, visible, to_eye) = (lamp.intensity, true, -ray.direction);
            let toward = lamp.position - surface.position;
            let (distance, to_light) = (toward.length(), toward.normalize());
            let lit = Lit { intensity, visible, distance, reflectance, n, to_light, to_eye };
            (subject.local_light)(&lit)
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
