//! E1.4: the ray from a surface to a lamp.

use glam::DVec3;
use lancer_core::geometry::{Ray, leave_surface};
use lancer_core::image::{Image, ImageSize};
use lancer_core::scene::MaterialId;
use lancer_core::world::SurfacePoint;
use lancer_exercise::{Card, Check, Exercise, Mismatch, Mutant, Shown, Solution, within};

use super::Subject;
use super::reference::shadow_ray;
use crate::figures::acne::Site;
use lancer_lesson::naive::epsilon_shadow_ray;

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E1.4",
        name: "shadow-ray",
        title: "The shadow ray leaves the surface",
        slide: "Modèle local : calcul des ombres portées",
        file: "e04_shadow_ray.rs",
        stub: include_str!("../../stubs/e04_shadow_ray.rs"),
        functions: &["shadow_ray"],
        minutes: 15,
        predict: "the floor is a million times its size away from the origin, and six sheets hang over it, the \
                  lowest 3 millionths of its size high: what will be wrong in the picture (red is dark though \
                  lit, yellow is lit though in a shadow) with no offset, and what with one of 10⁻⁴?",
        vary: "move the origin by a fixed 10⁻², 10⁻⁴ and 10⁻⁹ along the normal instead: is there a number \
               without red and without yellow?",
        hints: [
            "The point is only known up to a box, position ± error. Move it along the normal until the whole \
             box is on the lamp's side, and then look from the moved point to the lamp.",
            "The box reaches |N| · error along N, with the absolute value of each component of N. The origin is \
             start + side · (|N| · error) · N, where side is the sign of N · (lamp − start), and the direction \
             is lamp − origin, not normalised: t = 1 is the lamp.",
            "`let outwards = (lamp - surface.position).dot(surface.shading_normal) > 0.0;` picks `lifted` or \
             `position` as `start`. `let distance = n.abs().dot(surface.error);` \
             `let origin = start + distance.copysign(n.dot(lamp - start)) * n;` \
             `Ray::new(origin, lamp - origin)`.",
        ],
        solution: Solution {
            file: "crates/core/src/world.rs",
            item: "pub fn spawn_to",
            notice: "the move itself is `leave_surface`, which reflected and refracted rays use too; the error \
                     comes from counting rounded operations where the point is worked out",
        },
    },
    checks: &[
        Check { name: "a level floor, by hand", run: level },
        Check { name: "a slanted surface, by hand", run: slanted },
        Check { name: "a lamp behind the surface", run: lamp_behind },
        Check { name: "a smooth mesh starts lifted", run: lifted },
        Check { name: "from inside a smooth mesh it is not lifted", run: from_inside },
        Check { name: "shadows far from the origin", run: far_away },
        Check { name: "shadows in a tiny scene", run: tiny },
    ],
    mutants: &[
        Mutant {
            says: "the origin is not moved: rounding left the point on either side of the surface, and half of \
                   the shadow rays meet the surface that they leave (acne)",
            caught_by: "shadows far from the origin",
            mistake: |subject| {
                subject.shadow_ray = |surface, lamp| shadow_ray(&exact(surface), lamp);
            },
        },
        Mutant {
            says: "a fixed epsilon of 10⁻⁴: far from the origin it is less than rounding, and what is nearer than \
                   that to the surface casts no shadow",
            caught_by: "shadows in a tiny scene",
            mistake: |subject| {
                subject.shadow_ray = |surface, lamp| epsilon_shadow_ray(surface, lamp, 1e-4);
            },
        },
        Mutant {
            says: "the origin is always moved along N: for a lamp behind the surface that is the wrong side",
            caught_by: "a lamp behind the surface",
            mistake: |subject| {
                subject.shadow_ray = |surface, lamp| {
                    let (start, n) = (start(surface, lamp), surface.geometric_normal);
                    aimed(leave_surface(start, surface.error, n, n), lamp)
                };
            },
        },
        Mutant {
            says: "N · error without the absolute values: components of N below 0 make the move shorter than the \
                   box of error",
            caught_by: "a slanted surface, by hand",
            mistake: |subject| {
                subject.shadow_ray = |surface, lamp| {
                    let (start, n) = (start(surface, lamp), surface.geometric_normal);
                    let distance = n.dot(surface.error).copysign(n.dot(lamp - start));
                    aimed(start + distance * n, lamp)
                };
            },
        },
        Mutant {
            says: "the origin is moved by the whole length of error: just far enough along N is |N| · error",
            caught_by: "a level floor, by hand",
            mistake: |subject| {
                subject.shadow_ray = |surface, lamp| {
                    let (start, n) = (start(surface, lamp), surface.geometric_normal);
                    let distance = surface.error.length().copysign(n.dot(lamp - start));
                    aimed(start + distance * n, lamp)
                };
            },
        },
        Mutant {
            says: "error is added to the point: that moves it along the diagonal of the box, not along N",
            caught_by: "a level floor, by hand",
            mistake: |subject| {
                subject.shadow_ray =
                    |surface, lamp| aimed(start(surface, lamp) + surface.error, lamp);
            },
        },
        Mutant {
            says: "the direction is normalised: t = 1 is then a point at distance 1, not the lamp",
            caught_by: "a level floor, by hand",
            mistake: |subject| {
                subject.shadow_ray = |surface, lamp| {
                    let ray = shadow_ray(surface, lamp);
                    Ray::new(ray.origin, ray.direction.normalize())
                };
            },
        },
        Mutant {
            says: "the direction leads from the surface point to the lamp: it must lead there from the moved \
                   origin, or t = 1 is beside the lamp",
            caught_by: "a level floor, by hand",
            mistake: |subject| {
                subject.shadow_ray = |surface, lamp| {
                    let origin = shadow_ray(surface, lamp).origin;
                    Ray::new(origin, lamp - surface.position)
                };
            },
        },
        Mutant {
            says: "the direction leads away from the lamp: lamp − origin points at it",
            caught_by: "a level floor, by hand",
            mistake: |subject| {
                subject.shadow_ray = |surface, lamp| {
                    let ray = shadow_ray(surface, lamp);
                    Ray::new(ray.origin, -ray.direction)
                };
            },
        },
        Mutant {
            says: "`lifted` is not used: near the terminator the flat triangles of a smooth mesh shade each other",
            caught_by: "a smooth mesh starts lifted",
            mistake: |subject| {
                subject.shadow_ray = |surface, lamp| {
                    shadow_ray(&SurfacePoint { lifted: surface.position, ..*surface }, lamp)
                };
            },
        },
        Mutant {
            says: "the ray always starts at `lifted`: for a lamp on the inside the mesh bulges away from it, so \
                   start at `position` there",
            caught_by: "from inside a smooth mesh it is not lifted",
            mistake: |subject| {
                subject.shadow_ray = |surface, lamp| {
                    let n = surface.geometric_normal;
                    let toward = lamp - surface.lifted;
                    aimed(leave_surface(surface.lifted, surface.error, n, toward), lamp)
                };
            },
        },
        Mutant {
            says: "the ray starts at `position` as it comes: rounding left that point on either side of the \
                   surface (acne), and a smooth mesh starts at `lifted`",
            caught_by: "shadows far from the origin",
            mistake: |subject| {
                subject.shadow_ray = |surface, lamp| aimed(surface.position, lamp);
            },
        },
        Mutant {
            says: "the origin is moved along the shading normal: the surface itself lies across the geometric one",
            caught_by: "a smooth mesh starts lifted",
            mistake: |subject| {
                subject.shadow_ray = |surface, lamp| {
                    let geometric_normal = surface.shading_normal;
                    shadow_ray(&SurfacePoint { geometric_normal, ..*surface }, lamp)
                };
            },
        },
        Mutant {
            says: "N and error are multiplied component by component: the move must be along N, by |N| · error, \
                   which is one number",
            caught_by: "a slanted surface, by hand",
            mistake: |subject| {
                subject.shadow_ray = |surface, lamp| {
                    let (start, n) = (start(surface, lamp), surface.geometric_normal);
                    let side = 1.0_f64.copysign(n.dot(lamp - start));
                    aimed(start + side * surface.error * n, lamp)
                };
            },
        },
    ],
    draw,
    explain: None,
};

fn start(surface: &SurfacePoint, lamp: DVec3) -> DVec3 {
    let outwards = (lamp - surface.position).dot(surface.shading_normal) > 0.0;
    if outwards { surface.lifted } else { surface.position }
}

fn aimed(origin: DVec3, lamp: DVec3) -> Ray {
    Ray::new(origin, lamp - origin)
}

/// The point as if it were known without an error.
fn exact(surface: &SurfacePoint) -> SurfacePoint {
    SurfacePoint { error: DVec3::ZERO, ..*surface }
}

/// A flat surface; the errors of these checks are as large as no real one, so that they can be seen.
fn flat(position: DVec3, error: DVec3, n: DVec3) -> SurfacePoint {
    SurfacePoint {
        position,
        error,
        geometric_normal: n,
        shading_normal: n,
        lifted: position,
        material: MaterialId(0),
    }
}

/// Whether the ray starts at `origin` and leads to the lamp from there.
fn compare(
    subject: &Subject,
    surface: &SurfacePoint,
    lamp: DVec3,
    origin: DVec3,
) -> Result<(), Mismatch> {
    let case = |what: &str| {
        let SurfacePoint { position, error, geometric_normal: n, shading_normal, lifted, .. } =
            surface;
        let side = if n.dot(lamp - *position) > 0.0 { "outside" } else { "inside" };
        let mut case = format!(
            "{what} for position {}, error {}, geometric normal {}, lamp on the {side} {}",
            position.shown(),
            error.shown(),
            n.shown(),
            lamp.shown()
        );
        if lifted != position {
            let (lifted, shading_normal) = (lifted.shown(), shading_normal.shown());
            case += &format!(", lifted {lifted}, shading normal {shading_normal}");
        }
        case
    };
    let ray = (subject.shadow_ray)(surface, lamp);
    within(1e-12, || case("the origin"), &ray.origin, &origin)?;
    within(1e-12, || case("the direction"), &ray.direction, &(lamp - origin))
}

/// |N| · error is the error's y.
fn level(subject: &Subject) -> Result<(), Mismatch> {
    let surface = flat(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.25, 0.5, 0.125), DVec3::Y);
    compare(subject, &surface, DVec3::new(5.0, 8.5, -1.0), DVec3::new(1.0, 2.5, 3.0))
}

/// N = (2, −3, 6)/7: |N| · error is (2 · 0.7 + 3 · 1.4 + 6 · 0.35)/7 = 1.1.
const SLANTED: DVec3 = DVec3::new(2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0);
const ERROR: DVec3 = DVec3::new(0.7, 1.4, 0.35);
const REACH: f64 = 1.1;
const POINT: DVec3 = DVec3::new(-2.0, 1.0, 4.0);

fn slanted(subject: &Subject) -> Result<(), Mismatch> {
    let surface = flat(POINT, ERROR, SLANTED);
    compare(subject, &surface, DVec3::new(3.0, 2.0, 9.0), POINT + REACH * SLANTED)
}

fn lamp_behind(subject: &Subject) -> Result<(), Mismatch> {
    let surface = flat(POINT, ERROR, SLANTED);
    compare(subject, &surface, DVec3::new(-3.0, 2.0, -5.0), POINT - REACH * SLANTED)
}

/// A facet that the smooth surface bulges out from, by about 0.2.
fn smooth() -> SurfacePoint {
    SurfacePoint {
        shading_normal: DVec3::new(3.0, -2.0, 6.0) / 7.0,
        lifted: POINT + DVec3::new(0.08, -0.06, 0.17),
        ..flat(POINT, ERROR, SLANTED)
    }
}

fn lifted(subject: &Subject) -> Result<(), Mismatch> {
    let surface = smooth();
    let lamps = [DVec3::new(3.0, 2.0, 9.0), DVec3::new(7.0, 5.0, 5.0)];
    let origin = surface.lifted + REACH * SLANTED;
    lamps.into_iter().try_for_each(|lamp| compare(subject, &surface, lamp, origin))
}

fn from_inside(subject: &Subject) -> Result<(), Mismatch> {
    let lamps = [DVec3::new(-3.0, 2.0, -5.0), DVec3::new(-2.5, 0.5, 3.0)];
    let origin = POINT - REACH * SLANTED;
    lamps.into_iter().try_for_each(|lamp| compare(subject, &smooth(), lamp, origin))
}

/// How many of its sizes the scene of plate 0.2 stands away from the origin here.
const AWAY: f64 = 1e6;

fn far_away(subject: &Subject) -> Result<(), Mismatch> {
    shadows(
        subject,
        1e3,
        "a floor of 2000 × 1600 under six sheets, a million times its size from the origin",
    )
}

fn tiny(subject: &Subject) -> Result<(), Mismatch> {
    shadows(
        subject,
        1e-3,
        "a floor of 0.0022 × 0.0016 under six sheets, a million times its size from the origin",
    )
}

/// Whether all points of the floor are dark and lit as plane geometry has it.
fn shadows(subject: &Subject, scale: f64, case: &str) -> Result<(), Mismatch> {
    let site = Site::new(scale, AWAY, ImageSize::new(48, 32));
    let got = match site.wrong(&site.dark(subject.shadow_ray)) {
        [0, 0] => return Ok(()),
        [_, 0] => "points are dark though the lamp shines there (acne)",
        [0, _] => "points are lit though a sheet stands before the lamp (leaks)",
        _ => {
            "points are dark though the lamp shines there (acne), and others lit though a sheet stands before it (leaks)"
        }
    };
    Err(Mismatch::new(case, got, "the sheets' shadows, and nothing else"))
}

/// The floor of plate 0.2 a million sizes from the origin: red is dark though lit, yellow is lit though dark.
fn draw(subject: &Subject) -> Image {
    let size = ImageSize::new(240, 160);
    let site = Site::new(1.0, AWAY, size);
    let colors = site.colors(size, &site.dark(subject.shadow_ray));
    let linear = |color: [u8; 3]| color.map(|channel| (f32::from(channel) / 255.0).powf(2.2));
    Image::from_pixels(size, colors.into_iter().map(linear).collect())
}
