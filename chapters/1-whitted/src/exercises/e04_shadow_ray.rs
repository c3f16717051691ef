//! E1.4: the ray from a surface to a lamp.

use glam::DVec3;
use lancer_core::geometry::{Ray, leave_surface};
use lancer_core::image::{Image, ImageSize};
use lancer_core::scene::MaterialId;
use lancer_core::world::SurfacePoint;
use lancer_exercise::{Card, Check, Exercise, Mismatch, Shown, Solution, Verdict, slips, within};
use lancer_lesson::naive::epsilon_shadow_ray;

use super::Subject;
use super::reference::shadow_ray;
use crate::figures::acne::Site;

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E1.4",
        name: "shadow-ray",
        title: "The shadow ray leaves the surface",
        slide: "Modèle local : calcul des ombres portées",
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
            answer: include_str!("../../solutions/e04_shadow_ray.rs"),
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
    slips: slips! {
        shadow_ray(surface, lamp):
        "the origin is not moved: rounding left the point on either side of the surface, and half of the shadow \
         rays meet the surface that they leave (acne)":
            "shadows far from the origin" catches
                shadow_ray(&SurfacePoint { error: DVec3::ZERO, ..*surface }, lamp);
        "a fixed epsilon of 10⁻⁴: far from the origin it is less than rounding, and what is nearer than that to \
         the surface casts no shadow":
            "shadows in a tiny scene" catches epsilon_shadow_ray(surface, lamp, 1e-4);
        "the origin is always moved along N: for a lamp behind the surface that is the wrong side":
            "a lamp behind the surface" catches
                left(surface, start(surface, lamp), surface.geometric_normal, lamp);
        "N · error without the absolute values: components of N below 0 make the move shorter than the box of \
         error":
            "a slanted surface, by hand" catches
                moved(surface, |n, error| n.dot(error).abs() * n, lamp);
        "the origin is moved by the whole length of error: just far enough along N is |N| · error":
            "a level floor, by hand" catches moved(surface, |n, error| error.length() * n, lamp);
        "error is added to the point: that moves it along the diagonal of the box, not along N":
            "a level floor, by hand" catches aimed(start(surface, lamp) + surface.error, lamp);
        "the direction is normalised: t = 1 is then a point at distance 1, not the lamp":
            "a level floor, by hand" catches turned(surface, DVec3::normalize, lamp);
        "the direction leads from the surface point to the lamp: it must lead there from the moved origin, or \
         t = 1 is beside the lamp":
            "a level floor, by hand" catches turned(surface, |_| lamp - surface.position, lamp);
        "the direction leads away from the lamp: lamp − origin points at it":
            "a level floor, by hand" catches turned(surface, |direction| -direction, lamp);
        "`lifted` is not used: near the terminator the flat triangles of a smooth mesh shade each other":
            "a smooth mesh starts lifted" catches
                shadow_ray(&SurfacePoint { lifted: surface.position, ..*surface }, lamp);
        "the ray always starts at `lifted`: for a lamp on the inside the mesh bulges away from it, so start at \
         `position` there":
            "from inside a smooth mesh it is not lifted" catches
                left(surface, surface.lifted, lamp - surface.lifted, lamp);
        "the ray starts at `position` as it comes: rounding left that point on either side of the surface (acne), \
         and a smooth mesh starts at `lifted`":
            "shadows far from the origin" catches aimed(surface.position, lamp);
        "the origin is moved along the shading normal: the surface itself lies across the geometric one":
            "a smooth mesh starts lifted" catches {
                let geometric_normal = surface.shading_normal;
                shadow_ray(&SurfacePoint { geometric_normal, ..*surface }, lamp)
            };
        "N and error are multiplied component by component: the move must be along N, by |N| · error, which is one \
         number":
            "a slanted surface, by hand" catches moved(surface, |n, error| error * n, lamp);
    },
    own: |yours, reference| Subject { shadow_ray: yours.shadow_ray, ..reference },
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

/// The right ray, but for its direction.
fn turned(surface: &SurfacePoint, turn: impl Fn(DVec3) -> DVec3, lamp: DVec3) -> Ray {
    let ray = shadow_ray(surface, lamp);
    Ray::new(ray.origin, turn(ray.direction))
}

/// The right ray, but for how far its start is moved to the lamp's side, given N and the error.
fn moved(surface: &SurfacePoint, by: impl Fn(DVec3, DVec3) -> DVec3, lamp: DVec3) -> Ray {
    let (start, n) = (start(surface, lamp), surface.geometric_normal);
    let side = 1.0_f64.copysign(n.dot(lamp - start));
    aimed(start + side * by(n, surface.error), lamp)
}

/// The ray from a start that is moved to the side of `toward`.
fn left(surface: &SurfacePoint, start: DVec3, toward: DVec3, lamp: DVec3) -> Ray {
    aimed(leave_surface(start, surface.error, surface.geometric_normal, toward), lamp)
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
fn compare(subject: &Subject, surface: &SurfacePoint, lamp: DVec3, origin: DVec3) -> Verdict {
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
fn level(subject: &Subject) -> Verdict {
    let surface = flat(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.25, 0.5, 0.125), DVec3::Y);
    compare(subject, &surface, DVec3::new(5.0, 8.5, -1.0), DVec3::new(1.0, 2.5, 3.0))
}

/// N = (2, −3, 6)/7: |N| · error is (2 · 0.7 + 3 · 1.4 + 6 · 0.35)/7 = 1.1.
const SLANTED: DVec3 = DVec3::new(2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0);
const ERROR: DVec3 = DVec3::new(0.7, 1.4, 0.35);
const REACH: f64 = 1.1;
const POINT: DVec3 = DVec3::new(-2.0, 1.0, 4.0);

fn slanted(subject: &Subject) -> Verdict {
    let surface = flat(POINT, ERROR, SLANTED);
    compare(subject, &surface, DVec3::new(3.0, 2.0, 9.0), POINT + REACH * SLANTED)
}

fn lamp_behind(subject: &Subject) -> Verdict {
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

fn lifted(subject: &Subject) -> Verdict {
    let surface = smooth();
    let lamps = [DVec3::new(3.0, 2.0, 9.0), DVec3::new(7.0, 5.0, 5.0)];
    let origin = surface.lifted + REACH * SLANTED;
    lamps.into_iter().try_for_each(|lamp| compare(subject, &surface, lamp, origin))
}

fn from_inside(subject: &Subject) -> Verdict {
    let lamps = [DVec3::new(-3.0, 2.0, -5.0), DVec3::new(-2.5, 0.5, 3.0)];
    let origin = POINT - REACH * SLANTED;
    lamps.into_iter().try_for_each(|lamp| compare(subject, &smooth(), lamp, origin))
}

/// How many of its sizes the scene of plate 0.2 stands away from the origin here.
const AWAY: f64 = 1e6;

fn far_away(subject: &Subject) -> Verdict {
    shadows(subject, 1e3, "2000 × 1600")
}

fn tiny(subject: &Subject) -> Verdict {
    shadows(subject, 1e-3, "0.0022 × 0.0016")
}

/// Whether all points of the floor are dark and lit as plane geometry has it.
fn shadows(subject: &Subject, scale: f64, size: &str) -> Verdict {
    let site = Site::new(scale, AWAY, ImageSize::new(48, 32));
    let got = match site.wrong(&site.dark(subject.shadow_ray)) {
        [0, 0] => return Ok(()),
        [_, 0] => "points are dark though the lamp shines there (acne)",
        [0, _] => "points are lit though a sheet stands before the lamp (leaks)",
        _ => {
            "points are dark though the lamp shines there (acne), and others lit though a sheet stands before it (leaks)"
        }
    };
    let case =
        format!("a floor of {size} under six sheets, a million times its size from the origin");
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
