//! E1.8: the recursion LR.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::Ray;
use lancer_core::image::{Image, ImageSize};
use lancer_core::scene::{Scene, Shape};
use lancer_exercise::{Card, Check, Exercise, Shown, Solution, Verdict, slips, within};
use lancer_lesson::scenes::parsed;
use lancer_whitted::{RayEnd, RayNode};

use super::{
    FAR_MIRROR, Lit, Stage, Subject, far_mirror, from_eye, painted, reference, title_rays,
};
use crate::scenes;

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E1.8",
        name: "lr",
        title: "The recursion LR",
        slide: "Algorithme",
        stub: include_str!("../../stubs/e08_lr.rs"),
        functions: &["lr"],
        minutes: 45,
        predict: "the chapter's title picture, by all of your functions: what is seen in the mirror ball where it \
                  faces you, and which way up is the floor in the glass ball?",
        vary: "let your function trace both rays even where k_s or k_t is 0: the picture stays the same, so what \
               changes?",
        hints: [
            "One call answers for one ray. First the two ends, Max_Prof and the background; then I_Local by a loop \
             over the lamps; then one call for each ray that the surface sends on, with depth + 1.",
            "eq:recursion: I_R = I_Local + k_s I_Refl + k_t I_Trans, product by product in each channel. The ray \
             enters if geometric_normal · direction < 0: then n₁ = 1 and n₂ is the material's; else they change \
             places.",
            "For each lamp: `let shadow = shadow_ray(&surface, lamp.position);`, distance = its direction's length, \
             L = its direction / distance, then `local_light(&Lit { intensity: lamp.intensity_towards(l), visible: \
             stage.is_lit(&shadow), distance, reflectance: stage.reflectance(&surface), n, to_light: l, to_eye: \
             -ray.direction })`. Then `match refracted_ray(…)`: `Some(t)` \
             adds `material.k_t * lr(stage, &surface.spawn(t), depth + 1)`, `None` adds k_t to the k_s of the mirror \
             ray.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e08_lr.rs"),
            file: "crates/whitted/src/trace.rs",
            item: "fn lr",
            notice: "it is called with many rays at once, which are asked together; no ray is traced for a share of \
                     0, `Branches` in crates/core/src/optics.rs chooses n₁, n₂ and what total reflection does, and no \
                     shadow ray is cast to a lamp that would add nothing",
        },
    },
    checks: &[
        Check { name: "nothing is met", run: background },
        Check { name: "Max_Prof", run: beyond },
        Check { name: "a matte floor under a lamp", run: matte },
        Check { name: "its highlight, in the mirror direction", run: shiny },
        Check { name: "the ambient light", run: ambient },
        Check { name: "a lamp behind a ball, and one beside it", run: shadow },
        Check { name: "a plate that glows on one side", run: emission },
        Check { name: "a mirror shows the plate", run: mirror },
        Check { name: "two mirrors face each other", run: facing_mirrors },
        Check { name: "a mirror far from the origin", run: far_from_origin },
        Check { name: "a mirror in a tiny scene", run: tiny },
        Check { name: "a smooth floor under a lamp", run: smooth_floor },
        Check { name: "a smooth mirror", run: smooth_mirror },
        Check { name: "through a pane", run: pane },
        Check { name: "a ball of index 1 is not there", run: no_ball },
        Check { name: "into a glass ball and out of it", run: glass_ball },
        Check { name: "total reflection", run: total_reflection },
        Check { name: "the title picture", run: title },
    ],
    slips: slips! {
        lr(stage, ray, depth):
        "the three components are added as on the slide's last line: k_s and k_t are missing":
            "a mirror shows the plate" catches slipped(LrSlip::NoShares, stage, ray, depth);
        "the ambient term ρ_d I_a is missing: shadows are black":
            "the ambient light" catches slipped(LrSlip::NoAmbient, stage, ray, depth);
        "the emission ε is missing: lamps shine, but are black themselves":
            "a plate that glows on one side" catches slipped(LrSlip::NoEmission, stage, ray, depth);
        "the emission is sent to both sides: only the outside of a surface glows":
            "a plate that glows on one side" catches slipped(LrSlip::TwoSided, stage, ray, depth);
        "a ray that meets nothing is black: « couleur de fond » is missing":
            "nothing is met" catches slipped(LrSlip::NoBackground, stage, ray, depth);
        "the recursion ends one bounce early: a ray at Max_Prof is still traced, one beyond is not":
            "Max_Prof" catches slipped(LrSlip::EarlyEnd, stage, ray, depth);
        "the depth does not grow: nothing ends the recursion between two mirrors":
            "two mirrors face each other" catches slipped(LrSlip::SameDepth, stage, ray, depth);
        "the shadow rays are not asked: every lamp is taken as visible":
            "a lamp behind a ball, and one beside it" catches
                slipped(LrSlip::NoShadows, stage, ray, depth);
        "V is the ray's own direction: the highlight needs the direction to the eye, −direction":
            "its highlight, in the mirror direction" catches
                slipped(LrSlip::TowardsSurface, stage, ray, depth);
        "every surface is entered: where the ray leaves the glass, n₁ and n₂ change places":
            "into a glass ball and out of it" catches
                slipped(LrSlip::AlwaysEntering, stage, ray, depth);
        "n₁ and n₂ are exchanged: a ray that enters goes from 1 to the material's index":
            "into a glass ball and out of it" catches
                slipped(LrSlip::SwappedIndices, stage, ray, depth);
        "at total reflection the share k_t is lost: it goes to the mirror ray":
            "total reflection" catches slipped(LrSlip::LostShare, stage, ray, depth);
        "k_s and k_t are exchanged: k_s is the share of the mirror ray, k_t of the refracted one":
            "a mirror shows the plate" catches
                slipped(LrSlip::SwappedShares, stage, ray, depth);
        "the depth grows by 2: each call is one bounce further than the one that makes it":
            "two mirrors face each other" catches slipped(LrSlip::TwoDeeper, stage, ray, depth);
        "rays start at `surface.position` as it comes: rounding left that point on either side of the surface, and half \
         of the rays meet it again; `surface.spawn(direction)` leaves it":
            "a mirror far from the origin" catches
                slipped(LrSlip::NoSpawn, stage, ray, depth);
        "rays start a fixed way ahead: what is nearer than that is not seen; `surface.spawn(direction)` leaves the \
         surface by what rounding needs":
            "a mirror in a tiny scene" catches slipped(LrSlip::Offset, stage, ray, depth);
        "the lamps see the geometric normal: a smooth mesh looks faceted; N for the lamps is \
         `shading_normal_towards`":
            "a smooth floor under a lamp" catches
                slipped(LrSlip::FlatLamps, stage, ray, depth);
        "the mirror ray is made by the normal for the lamps, which can send it through the surface; \
         `optical_normal` cannot":
            "a smooth mirror" catches slipped(LrSlip::LampsNormal, stage, ray, depth);
        "the mirror ray is made by the geometric normal: a smooth mesh mirrors in facets; take `optical_normal`":
            "a smooth mirror" catches slipped(LrSlip::FlatMirror, stage, ray, depth);
    },
    own: |yours, reference| Subject { lr: yours.lr, ..reference },
    draw,
    explain: Some(explain),
};

#[derive(Clone, Copy, PartialEq)]
enum LrSlip {
    NoShares,
    NoAmbient,
    NoEmission,
    TwoSided,
    NoBackground,
    EarlyEnd,
    SameDepth,
    NoShadows,
    TowardsSurface,
    AlwaysEntering,
    SwappedIndices,
    LostShare,
    SwappedShares,
    TwoDeeper,
    NoSpawn,
    Offset,
    FlatLamps,
    LampsNormal,
    FlatMirror,
}

/// LR with one slip.
fn slipped(slip: LrSlip, stage: &Stage, ray: &Ray, depth: u32) -> Rgb {
    let scene = stage.scene;
    if depth > stage.max_depth || slip == LrSlip::EarlyEnd && depth == stage.max_depth {
        return Rgb::ZERO;
    }
    let Some(surface) = stage.surface(ray) else {
        return if slip == LrSlip::NoBackground { Rgb::ZERO } else { scene.background };
    };
    let incident = ray.direction;
    let (material, reflectance) = (scene.material(surface.material), stage.reflectance(&surface));
    let is_outside = surface.geometric_normal.dot(incident) < 0.0;
    let mut radiance = Rgb::ZERO;
    if slip != LrSlip::NoAmbient {
        radiance += reflectance.diffuse * scene.ambient;
    }
    if slip != LrSlip::NoEmission && (is_outside || slip == LrSlip::TwoSided) {
        radiance += material.emission;
    }
    let shading = surface.shading_normal_towards(-incident);
    let geometric = if is_outside { surface.geometric_normal } else { -surface.geometric_normal };
    let n = if slip == LrSlip::FlatLamps { geometric } else { shading };
    let to_eye = if slip == LrSlip::TowardsSurface { incident } else { -incident };
    for lamp in &stage.lamps {
        let shadow = reference::shadow_ray(&surface, lamp.position);
        let (to_light, distance) = shadow.direction.normalize_and_length();
        let visible = slip == LrSlip::NoShadows || stage.is_lit(&shadow);
        let intensity = lamp.intensity_towards(to_light);
        let lit = Lit { intensity, visible, distance, reflectance, n, to_light, to_eye };
        radiance += reference::local_light(&lit);
    }
    let sent = |k: Rgb, direction: DVec3| {
        let depth = match slip {
            LrSlip::SameDepth => depth,
            LrSlip::TwoDeeper => depth + 2,
            _ => depth + 1,
        };
        let ray = match slip {
            LrSlip::NoSpawn => Ray::new(surface.position, direction),
            LrSlip::Offset => Ray::new(surface.position + 1e-3 * direction, direction),
            _ => surface.spawn(direction),
        };
        let share = if slip == LrSlip::NoShares { Rgb::ONE } else { k };
        share * slipped(slip, stage, &ray, depth)
    };
    let n = match slip {
        LrSlip::LampsNormal => shading,
        LrSlip::FlatMirror => geometric,
        _ => surface.optical_normal(incident),
    };
    let index = material.refractive_index;
    let is_entering =
        (is_outside || slip == LrSlip::AlwaysEntering) != (slip == LrSlip::SwappedIndices);
    let (n1, n2) = if is_entering { (1.0, index) } else { (index, 1.0) };
    let (mut k_s, mut k_t) = (material.k_s, material.k_t);
    if slip == LrSlip::SwappedShares {
        (k_s, k_t) = (k_t, k_s);
    }
    let mut is_mirror = material.k_s != Rgb::ZERO;
    if material.k_t != Rgb::ZERO {
        match reference::refracted_ray(incident, n, n1, n2) {
            Some(direction) => radiance += sent(k_t, direction),
            None if slip == LrSlip::LostShare => (),
            None => {
                k_s += k_t;
                is_mirror = true;
            }
        }
    }
    if is_mirror {
        radiance += sent(k_s, reference::reflected_ray(incident, n));
    }
    radiance
}

/// Judges a ray from the eye in a scene, given as a text and in words. The shapes are met by the course's own
/// functions: what is wrong is in LR, or in a function that it calls.
fn compare(
    subject: &Subject,
    text: &str,
    words: &str,
    ray: Ray,
    max_depth: u32,
    wanted: Rgb,
) -> Verdict {
    compare_in(subject, &parsed("exercise", text), words, ray, max_depth, wanted)
}

fn compare_in(
    subject: &Subject,
    scene: &Scene,
    words: &str,
    ray: Ray,
    max_depth: u32,
    wanted: Rgb,
) -> Verdict {
    let got = (subject.lr)(&Stage::new(scene, max_depth, reference::SUBJECT), &ray, 0);
    within(1e-10, || format!("{words}; {}, Max_Prof {max_depth}", ray.shown()), &got, &wanted)
}

const SKY: Rgb = Rgb::new(0.2, 0.3, 0.4);
const BALL_BEHIND: &str = "
    background = [0.2, 0.3, 0.4]
    material.ball = { rho_d = 1 }
    sphere = [{ center = [0, 0, 9], radius = 1, material = 'ball' }]";

fn background(subject: &Subject) -> Verdict {
    let ray = Ray::new(DVec3::ZERO, DVec3::NEG_Z);
    compare(subject, BALL_BEHIND, "a background (0.2, 0.3, 0.4), a ball behind", ray, 5, SKY)
}

fn beyond(subject: &Subject) -> Verdict {
    let scene = parsed("exercise", BALL_BEHIND);
    let ray = Ray::new(DVec3::ZERO, DVec3::NEG_Z);
    for (depth, wanted) in [(3, Rgb::ZERO), (2, SKY)] {
        let got = (subject.lr)(&Stage::new(&scene, 2, reference::SUBJECT), &ray, depth);
        let case = || {
            format!(
                "the background (0.2, 0.3, 0.4) seen by a call of depth {depth}, and Max_Prof is 2"
            )
        };
        within(1e-10, case, &got, &wanted)?;
    }
    Ok(())
}

const FLOOR: &str = "
    material.floor = { rho_d = [0.5, 0.25, 1] }
    polygon = [{ vertices = [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]], material = 'floor' }]";
const DIFFUSE: Rgb = Rgb::new(0.5, 0.25, 1.0);

/// From (3, 4, 0) down to the origin.
fn to_origin() -> Ray {
    Ray::new(DVec3::new(3.0, 4.0, 0.0), DVec3::new(-0.6, -0.8, 0.0))
}

fn matte(subject: &Subject) -> Verdict {
    // 8 / 2² straight from above; 50 / 5² with the cosine 4/5.
    for (lamp, words, light) in [
        ("{ position = [0, 2, 0], intensity = 8 }", "a lamp of 8 at (0, 2, 0)", 2.0),
        ("{ position = [-3, 4, 0], intensity = 50 }", "a lamp of 50 at (−3, 4, 0)", 1.6),
    ] {
        let text = format!("light = [{lamp}]\n{FLOOR}");
        let words = format!("a floor y = 0, ρ_d = (0.5, 0.25, 1), {words}");
        compare(subject, &text, &words, to_origin(), 5, light * DIFFUSE)?;
    }
    Ok(())
}

/// The lamp stands where the eye's ray is mirrored to, so R·V = 1 and the highlight is ρ_s.
fn shiny(subject: &Subject) -> Verdict {
    let text = "
        light = [{ position = [-3, 4, 0], intensity = 50 }]
        material.floor = { rho_d = [0.5, 0.25, 1], rho_s = 0.25, shininess = 20 }
        polygon = [{ vertices = [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]], material = 'floor' }]";
    let words = "a floor y = 0, ρ_d = (0.5, 0.25, 1), ρ_s = 0.25, n = 20, a lamp of 50 at (−3, 4, 0) in the mirror \
                 direction";
    compare(subject, text, words, to_origin(), 5, 2.0 * (0.8 * DIFFUSE + 0.25))
}

fn ambient(subject: &Subject) -> Verdict {
    let text = format!("ambient = [0.1, 0.2, 0.4]\n{FLOOR}");
    let words = "a floor y = 0, ρ_d = (0.5, 0.25, 1), I_a = (0.1, 0.2, 0.4), no lamp";
    compare(subject, &text, words, to_origin(), 5, DIFFUSE * Rgb::new(0.1, 0.2, 0.4))
}

fn shadow(subject: &Subject) -> Verdict {
    let text = format!(
        "light = [
            {{ position = [0, 2, 0], intensity = 8 }}, {{ position = [-3, 4, 0], intensity = 50 }}]
        sphere = [{{ center = [0, 1, 0], radius = 0.25, material = 'floor' }}]
        {FLOOR}"
    );
    let words = "a floor y = 0, ρ_d = (0.5, 0.25, 1), lamps of 8 at (0, 2, 0) and of 50 at (−3, 4, 0), a ball of \
                 radius 0.25 at (0, 1, 0)";
    compare(subject, &text, words, to_origin(), 5, 1.6 * DIFFUSE)
}

const PLATE: &str = "
    material.plate = { emission = [2, 4, 0.5] }
    material.mirror = { k_s = [0.5, 0.25, 1] }";
const GLOW: Rgb = Rgb::new(2.0, 4.0, 0.5);
/// The plate x = 3, 3 < y < 5, |z| < 1, whose outside faces −x.
const PLATE_AT_3: &str =
    "{ vertices = [[3, 3, -1], [3, 3, 1], [3, 5, 1], [3, 5, -1]], material = 'plate' }";

fn emission(subject: &Subject) -> Verdict {
    let text = format!("polygon = [{PLATE_AT_3}]\n{PLATE}");
    for (from, direction, wanted, side) in
        [(0.0, DVec3::X, GLOW, "outside"), (6.0, DVec3::NEG_X, Rgb::ZERO, "inside")]
    {
        let words = format!("a plate at x = 3, ε = (2, 4, 0.5), seen from its {side}");
        let ray = Ray::new(DVec3::new(from, 4.0, 0.0), direction);
        compare(subject, &text, &words, ray, 5, wanted)?;
    }
    Ok(())
}

/// One surface to go through, unlike a ball's two, where two wrong signs make a right one.
fn pane(subject: &Subject) -> Verdict {
    let text = format!(
        "material.pane = {{ k_t = [0.5, 0.25, 1] }}
        polygon = [{PLATE_AT_3},
            {{ vertices = [[1, 3, -1], [1, 3, 1], [1, 5, 1], [1, 5, -1]], material = 'pane' }}]
        {PLATE}"
    );
    let words = "a pane x = 1, refractive index 1, k_t = (0.5, 0.25, 1), before a plate x = 3, ε = (2, 4, 0.5)";
    let ray = Ray::new(DVec3::new(0.0, 4.0, 0.0), DVec3::X);
    compare(subject, &text, words, ray, 5, Rgb::new(1.0, 1.0, 0.5))
}

fn mirror(subject: &Subject) -> Verdict {
    let text = format!(
        "polygon = [{PLATE_AT_3},
            {{ vertices = [[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]], material = 'mirror' }}]
        {PLATE}"
    );
    let words =
        "a mirror y = 0, k_s = (0.5, 0.25, 1), shows a plate around (3, 4, 0), ε = (2, 4, 0.5)";
    let ray = Ray::new(DVec3::new(-3.0, 4.0, 0.0), DVec3::new(0.6, -0.8, 0.0));
    compare(subject, &text, words, ray, 5, GLOW * Rgb::new(0.5, 0.25, 1.0))
}

/// Each of the Max_Prof + 1 surfaces adds ρ_d I_a = ½, the next one half as much: 1 − ½^(Max_Prof + 1).
fn facing_mirrors(subject: &Subject) -> Verdict {
    let text = "
        ambient = 1
        material.mirror = { rho_d = 0.5, k_s = 0.5 }
        polygon = [
            { vertices = [[1, -1, -1], [1, -1, 1], [1, 1, 1], [1, 1, -1]], material = 'mirror' },
            { vertices = [[-1, -1, 1], [-1, -1, -1], [-1, 1, -1], [-1, 1, 1]], material = 'mirror' }]";
    let words = "mirrors x = −1 and x = 1, k_s = 0.5, ρ_d = 0.5, I_a = 1";
    for max_depth in 0..5 {
        let wanted = Rgb::splat(1.0 - 0.5_f64.powi(max_depth + 1));
        let ray = Ray::new(DVec3::ZERO, DVec3::X);
        compare(subject, text, words, ray, max_depth as u32, wanted)?;
    }
    Ok(())
}

/// A ray that does not leave the mirror by the error of its point meets it once more.
fn far_from_origin(subject: &Subject) -> Verdict {
    let (text, rays) = far_mirror();
    let wanted = Rgb::new(0.1, 0.075, 0.05);
    rays.into_iter().try_for_each(|ray| compare(subject, &text, FAR_MIRROR, ray, 5, wanted))
}

/// [`mirror`] a millionth as large.
fn tiny(subject: &Subject) -> Verdict {
    let text = format!(
        "polygon = [
            {{ vertices = [[3e-6, 3e-6, -1e-6], [3e-6, 3e-6, 1e-6], [3e-6, 5e-6, 1e-6], [3e-6, 5e-6, -1e-6]],
                material = 'plate' }},
            {{ vertices = [[-1e-6, 0, 1e-6], [1e-6, 0, 1e-6], [1e-6, 0, -1e-6], [-1e-6, 0, -1e-6]],
                material = 'mirror' }}]
        {PLATE}"
    );
    let words = "a mirror y = 0, k_s = (0.5, 0.25, 1), shows a plate around (3e-6, 4e-6, 0), ε = (2, 4, 0.5)";
    let ray = Ray::new(DVec3::new(-3e-6, 4e-6, 0.0), DVec3::new(0.6, -0.8, 0.0));
    compare(subject, &text, words, ray, 5, GLOW * Rgb::new(0.5, 0.25, 1.0))
}

/// What a text begins its polygons with.
const SMOOTH: &str = "vertices = [[-4, 0, 0], [4, 0, 3], [4, 0, -3]]";
const SMOOTH_WORDS: &str = "a smooth triangle (−4, 0, 0), (4, 0, 3), (4, 0, −3), whose vertex normals (0.96, 0.28, 0), y \
                            and y make N = (0.6, 0.8, 0) at the origin";

/// A scene whose first triangle is [`SMOOTH`]. The origin is in the middle between its first corner and the others, so
/// N there is half of (0.96, 0.28, 0) and half of y; it is above no corner's tangent plane, so nothing is lifted.
fn smooth(text: &str) -> Scene {
    let mut scene = parsed("exercise", text);
    let mesh = &mut scene.mesh;
    let normal = |p: &DVec3| if p.x < 0.0 { DVec3::new(0.96, 0.28, 0.0) } else { DVec3::Y };
    mesh.normals = mesh.positions.iter().map(normal).collect();
    mesh.smooth = vec![None; mesh.triangles.len()];
    mesh.smooth[0] = Some(mesh.triangles[0].vertices);
    scene
}

/// 8 / 2² from straight above, with the cosine 4/5.
fn smooth_floor(subject: &Subject) -> Verdict {
    let text = format!(
        "light = [{{ position = [0, 2, 0], intensity = 8 }}]
        material.floor = {{ rho_d = [0.5, 0.25, 1] }}
        polygon = [{{ {SMOOTH}, material = 'floor' }}]"
    );
    let words = format!("{SMOOTH_WORDS}, ρ_d = (0.5, 0.25, 1), under a lamp of 8 at (0, 2, 0)");
    compare_in(subject, &smooth(&text), &words, to_origin(), 5, 1.6 * DIFFUSE)
}

/// Straight down R is (0.96, 0.28, 0) by N. At a slant it would be (0.936, −0.352, 0), below the surface: there the
/// geometric normal makes it (0.6, 0.8, 0).
fn smooth_mirror(subject: &Subject) -> Verdict {
    let text = format!(
        "polygon = [{{ {SMOOTH}, material = 'mirror' }},
            {{ vertices = [[3, 0.5, -1], [3, 0.5, 1], [3, 5, 1], [3, 5, -1]], material = 'plate' }}]
        {PLATE}"
    );
    let words = format!(
        "{SMOOTH_WORDS}, k_s = (0.5, 0.25, 1), before a plate x = 3, 0.5 < y < 5, ε = (2, 4, 0.5)"
    );
    let scene = smooth(&text);
    for ray in [
        Ray::new(DVec3::new(0.0, 4.0, 0.0), DVec3::NEG_Y),
        Ray::new(DVec3::new(-3.0, 4.0, 0.0), DVec3::new(0.6, -0.8, 0.0)),
    ] {
        compare_in(subject, &scene, &words, ray, 5, GLOW * Rgb::new(0.5, 0.25, 1.0))?;
    }
    Ok(())
}

fn no_ball(subject: &Subject) -> Verdict {
    let text = "
        background = [0.2, 0.3, 0.4]
        material.air = { k_t = 1, refractive_index = 1 }
        sphere = [{ center = [0, 0, 0], radius = 1, material = 'air' }]";
    let words =
        "a ball of radius 1, k_t = 1, refractive index 1, before a background (0.2, 0.3, 0.4)";
    let ray = Ray::new(DVec3::new(0.6, 0.0, 3.0), DVec3::NEG_Z);
    compare(subject, text, words, ray, 5, SKY)
}

/// A ray along −z meets a glass ball of radius 1 at x = 3/5, so sin θ₁ = 3/5 and sin θ₂ = 2/5. It passes along
/// the chord, which is 2 cos θ₂ long, and leaves bent by 2 (θ₁ − θ₂) towards the axis, from the point at the angle
/// θ₁ + π − 2 θ₂ around the ball's centre.
fn glass_ball(subject: &Subject) -> Verdict {
    let (theta1, theta2) = (0.6_f64.asin(), 0.4_f64.asin());
    let (out_x, out_z) = (theta1 + std::f64::consts::PI - 2.0 * theta2).sin_cos();
    let x = out_x - (out_z + 3.0) * (2.0 * (theta1 - theta2)).tan();
    let (left, right) = (x - 0.05, x + 0.05);
    let text = format!(
        "{PLATE}
        material.glass = {{ k_t = [0.5, 1, 1], refractive_index = 1.5 }}
        sphere = [{{ center = [0, 0, 0], radius = 1, material = 'glass' }}]
        polygon = [{{
            vertices = [[{left}, -1, -3], [{right}, -1, -3], [{right}, 1, -3], [{left}, 1, -3]],
            material = 'plate' }}]"
    );
    let words = format!(
        "a glass ball of radius 1, refractive index 1.5, k_t = (0.5, 1, 1), before a plate {} < x < {}, z = −3, \
         ε = (2, 4, 0.5)",
        left.shown(),
        right.shown()
    );
    let ray = Ray::new(DVec3::new(0.6, 0.0, 3.0), DVec3::NEG_Z);
    compare(subject, &text, &words, ray, 5, GLOW * Rgb::new(0.25, 1.0, 1.0))
}

/// From within glass at 45 degrees, where the sine 0.707 is above 2/3: k_s + k_t = 3/4 goes to the plate.
fn total_reflection(subject: &Subject) -> Verdict {
    let text = format!(
        "{PLATE}
        background = 1
        material.glass = {{ k_s = 0.25, k_t = 0.5, refractive_index = 1.5 }}
        polygon = [
            {{ vertices = [[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]], material = 'glass' }},
            {{ vertices = [[3, -5, -1], [3, -5, 1], [3, -1, 1], [3, -1, -1]], material = 'plate' }}]"
    );
    let words = "glass below y = 0, refractive index 1.5, k_s = 0.25, k_t = 0.5, met from inside at 45 degrees; in \
                 it a plate around (3, −3, 0), ε = (2, 4, 0.5)";
    let ray = Ray::new(DVec3::new(-2.0, -2.0, 0.0), DVec3::new(1.0, 1.0, 0.0).normalize());
    compare(subject, &text, words, ray, 5, 0.75 * GLOW)
}

const MAX_DEPTH: u32 = 5;

/// The course's own LR on the same stage, but for rounding.
fn title(subject: &Subject) -> Verdict {
    let (scene, rays) = title_rays(MAX_DEPTH);
    for (case, ray) in rays {
        let stage = || Stage::new(&scene, MAX_DEPTH, reference::SUBJECT);
        let got = (subject.lr)(&stage(), &ray, 0);
        let wanted = stage().recorded(&from_eye(ray)).nodes[0].radiance;
        within(1e-10, || case, &got, &wanted)?;
    }
    Ok(())
}

const SIZE: ImageSize = ImageSize::new(320, 240);

/// The chapter's title picture, by all of the subject's functions.
fn draw(subject: &Subject) -> Image {
    let scene = scenes::whitted();
    painted(SIZE, |x, y| {
        let ray = (subject.primary_ray)(&scene.camera, SIZE, x, y);
        (subject.lr)(&Stage::new(&scene, MAX_DEPTH, *subject), &ray, 0)
    })
}

/// The calls of the right recursion at a pixel, each answered by the subject: the innermost wrong answer is
/// where to look.
fn explain(subject: &Subject, [x, y]: [u32; 2]) -> String {
    let scene = scenes::whitted();
    let stage = |subject| Stage::new(&scene, MAX_DEPTH, subject);
    let ray = scene.camera.primary_rays(SIZE).through(f64::from(x) + 0.5, f64::from(y) + 0.5);
    let tree = stage(reference::SUBJECT).recorded(&from_eye(ray));
    let lines = tree.nodes.iter().map(|node| {
        let got = (subject.lr)(&stage(*subject), &node.call.ray, node.call.depth);
        let mark = if Shown::distance(&got, &node.radiance) > 1e-9 { "  ← differs" } else { "" };
        let indent = "  ".repeat(node.call.depth as usize);
        format!("{indent}{}; returns {}{mark}", described(&scene, node), got.shown())
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn described(scene: &Scene, node: &RayNode) -> String {
    let call = &node.call;
    let met = match node.end {
        RayEnd::Background => "meets nothing".to_owned(),
        RayEnd::Cut => "is beyond Max_Prof".to_owned(),
        RayEnd::Surface { hit, position, .. } => {
            let shape = match scene.shape(hit.primitive) {
                Shape::Triangle(index) => format!("triangle {index}"),
                Shape::Sphere(index) => format!("sphere {index}"),
            };
            format!("meets {shape} at {}", position.shown())
        }
    };
    format!("{:?}, depth {}: {}, {met}", call.kind, call.depth, call.ray.shown())
}
