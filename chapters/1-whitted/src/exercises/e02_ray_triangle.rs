//! E1.2: where a ray meets a triangle.

use glam::swizzles::Vec3Swizzles;
use glam::{DVec2, DVec3};
use lancer_core::Rgb;
use lancer_core::generate::icosphere;
use lancer_core::geometry::Ray;
use lancer_core::image::{Image, ImageSize};
use lancer_core::sampling::Uniform;
use lancer_core::scene::Camera;
use lancer_exercise::{
    Card, Check, Exercise, Mismatch, Shown, Solution, Verdict, ensure, same, slips, within,
};
use lancer_lesson::naive::{BySigns, moeller_trumbore};

use super::reference::ray_triangle;
use super::{Meeting, Subject, painted};
use crate::figures::watertight::{EDGES, Relief, VERTICES, aimed};

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E1.2",
        name: "ray-triangle",
        title: "A ray and a triangle, watertight",
        slide: "Algorithme : calcul et tri des intersections",
        stub: include_str!("../../stubs/e02_ray_triangle.rs"),
        functions: &["ray_triangle"],
        minutes: 25,
        predict: "each pixel's ray of the relief is aimed at a corner that six triangles share: with a test \
                  that is right for almost every ray, what does the relief look like?",
        vary: "write `c.x.mul_add(b.y, -(c.y * b.x))` for the first edge function, and the others alike: it is \
               rounded once instead of twice, so more accurate. Check again: why do rays slip through?",
        hints: [
            "Seen along the ray the triangle is flat, and the ray is the point (0, 0). The ray passes on the \
             same side of all three edges, or it misses; each edge has a function whose sign is the side. \
             Neighbours must work out the same products for the edge that they share.",
            "eq:ray-triangle: E_A = Cx By − Cy Bx, E_B = Ax Cy − Ay Cx, E_C = Bx Ay − By Ax. A miss if one is \
             negative and one positive; 0 is on the edge, and a hit. det = E_A + E_B + E_C, \
             t = (E_A Az + E_B Bz + E_C Cz) / det, and the weights are (E_A, E_B, E_C) / det. A ray in the \
             triangle's plane has det 0, or rounding noise: demand also that 0 is in the range of the x and in that \
             of the y of the three corners.",
            "With `u`, `v` and `w` for E_A, E_B and E_C: \
             `let miss = u.min(v).min(w) < 0.0 && u.max(v).max(w) > 0.0;` \
             `let beside = |a: f64, b: f64, c: f64| a.min(b).min(c) > 0.0 || a.max(b).max(c) < 0.0;`, for the \
             x and for the y. End with an accepting comparison, which a NaN fails: \
             `(t > 0.0 && t.is_finite()).then(|| (t, DVec3::new(u, v, w) / det))`.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e02_ray_triangle.rs"),
            file: "crates/core/src/geometry/triangle.rs",
            item: "fn sheared",
            notice: "the shear is worked out once per ray, and t must exceed a bound of its own error, which \
                     the shadow ray's exercise comes back to",
        },
    },
    checks: &[
        Check { name: "straight down, by hand", run: straight_down },
        Check { name: "in space, a direction of any length", run: in_space },
        Check { name: "either side, either order of rotation", run: other_side },
        Check { name: "beside the triangle", run: beside },
        Check { name: "just beside the triangle", run: just_beside },
        Check { name: "behind the ray", run: behind },
        Check { name: "very close to where the ray starts", run: close },
        Check { name: "exactly through an edge or a corner", run: exact_borders },
        Check { name: "a very small triangle", run: small },
        Check { name: "a ray in the triangle's plane", run: in_plane },
        Check { name: "no number, no hit", run: no_number },
        Check { name: "aimed at the corners of a closed mesh", run: corners_of_mesh },
        Check { name: "aimed at the edges of a closed mesh", run: edges_of_mesh },
    ],
    slips: slips! {
        ray_triangle(corners, ray):
        "t is a distance: it must be in units of the direction's length, which is not always 1":
            "in space, a direction of any length" catches
                ray_triangle(corners, ray).map(|(t, w)| (t * ray.direction.length(), w));
        "the weights are on the wrong corners: E_A, which is made of b and c, is the weight of a":
            "straight down, by hand" catches
                ray_triangle(corners, ray).map(|(t, w)| (t, w.yzx()));
        "the weights are not divided by det = E_A + E_B + E_C":
            "straight down, by hand" catches
                ray_triangle(corners, ray).map(|(t, w)| (t, w * det(corners, ray)));
        "only one order of rotation is met: E_A, E_B and E_C are demanded to be positive, and they may be all negative \
         as well":
            "straight down, by hand" catches
                ray_triangle(corners, ray).filter(|_| det(corners, ray) > 0.0);
        "only one order of rotation is met: E_A, E_B and E_C are demanded to be negative, and they may be all positive \
         as well":
            "either side, either order of rotation" catches
                ray_triangle(corners, ray).filter(|_| det(corners, ray) < 0.0);
        "the back of the triangle is missed: it is met from either side":
            "either side, either order of rotation" catches
                ray_triangle(corners, ray).filter(|_| normal(corners).dot(ray.direction) < 0.0);
        "the whole plane is met: the signs of E_A, E_B and E_C are not looked at":
            "beside the triangle" catches weighted(corners, ray, plane(corners, ray));
        "a hit behind the ray's origin counts: t must be positive":
            "behind the ray" catches
                ray_triangle(corners, ray)
                    .or_else(|| ray_triangle(corners, &reversed(ray)).map(|(t, w)| (-t, w)));
        "hits near the ray's origin are left out: any t > 0 counts, however small, since t is in units of the \
         direction's length and scenes may be tiny":
            "very close to where the ray starts" catches
                ray_triangle(corners, ray).filter(|(t, _)| *t > 1e-3);
        "the edge functions are compared with a tolerance: rays beside the triangle meet it then, and a small \
         triangle grows. 0 itself is the border; the sheared corners need no tolerance":
            "just beside the triangle" catches tolerant(corners, ray, 1e-9);
        "an edge function of 0 counts as a miss: a ray through an edge then misses both neighbours":
            "exactly through an edge or a corner" catches
                ray_triangle(corners, ray).filter(|(_, weights)| weights.min_element() > 0.0);
        "a small det is taken for 0: it is twice an area, so a fixed epsilon loses small triangles. Besides, this \
         is Möller and Trumbore's test, whose neighbours work out different numbers for the edge that they share":
            "a very small triangle" catches {
                let det = normal(corners).dot(ray.direction);
                weighted(corners, ray, moeller_trumbore(corners, ray).filter(|_| det.abs() > 1e-7))
            };
        "a small det is taken for 0: it is twice an area, so a fixed epsilon loses small triangles; only 0 itself \
         is no triangle":
            "a very small triangle" catches
                ray_triangle(corners, ray).filter(|_| det(corners, ray).abs() > 1e-7);
        "this is Möller and Trumbore's test: neighbours work out different numbers for the edge that they share, \
         and a ray slips between them":
            "aimed at the corners of a closed mesh" catches
                weighted(corners, ray, moeller_trumbore(corners, ray));
        "the edge functions are fused multiply-adds: of the two products one is rounded and one is not, so the \
         neighbours' functions are no longer opposite":
            "aimed at the edges of a closed mesh" catches
                ray_triangle(corners, ray)
                    .and_then(|_| weighted(corners, ray, BySigns::new(ray).fused(corners)));
        "the signs alone decide: for a ray in the triangle's plane they are rounding noise, so look at the range \
         of the corners' x and y too":
            "a ray in the triangle's plane" catches
                weighted(corners, ray, BySigns::new(ray).plain(corners));
        "a NaN gets through: each comparison with it is false, also the one that should reject it. Accept what is \
         right instead: `(t > 0.0 && t.is_finite()).then(…)`":
            "no number, no hit" catches
                ray_triangle(corners, ray)
                    .or_else(|| det(corners, ray).is_nan().then_some((f64::NAN, DVec3::NAN)));
        "the weights are at other corners: E_A, the edge function of b and c, is a's, E_B is b's and E_C c's":
            "straight down, by hand" catches
                ray_triangle(corners, ray).map(|(t, w)| (t, w.zxy()));
        "t is not divided by det = E_A + E_B + E_C":
            "straight down, by hand" catches
                ray_triangle(corners, ray)
                    .map(|(t, w)| (t * det(corners, ray), w))
                    .filter(|(t, _)| *t > 0.0);
    },
    own: |yours, reference| Subject { ray_triangle: yours.ray_triangle, ..reference },
    draw,
    explain: None,
};

fn reversed(ray: &Ray) -> Ray {
    Ray::new(ray.origin, -ray.direction)
}

/// Twice the triangle's area long.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// E_A + E_B + E_C: twice the area of the sheared triangle, negative where its corners turn counter-clockwise.
fn det(corners: [DVec3; 3], ray: &Ray) -> f64 {
    let d = ray.direction;
    -normal(corners).dot(d) / d[d.abs().max_position()]
}

/// Where a ray meets the plane of a triangle.
fn plane(corners: [DVec3; 3], ray: &Ray) -> Option<f64> {
    let n = normal(corners);
    let t = n.dot(corners[0] - ray.origin) / n.dot(ray.direction);
    (t > 0.0 && t.is_finite()).then_some(t)
}

/// t, if any, with the weights of the corners there, from areas.
fn weighted(corners: [DVec3; 3], ray: &Ray, t: Option<f64>) -> Option<Meeting> {
    let ([a, b, c], n, p) = (corners, normal(corners), ray.at(t?));
    let share = |from: DVec3, to: DVec3| (to - from).cross(p - from).dot(n) / n.length_squared();
    Some((t?, DVec3::new(share(b, c), share(c, a), share(a, b))))
}

/// The right answer, and where the signs of E_A, E_B and E_C are wrong by less than a tolerance, where the ray meets the
/// plane.
fn tolerant(corners: [DVec3; 3], ray: &Ray, tolerance: f64) -> Option<Meeting> {
    let nearly = || {
        let meeting = weighted(corners, ray, plane(corners, ray))?;
        let least = meeting.1.min_element() * det(corners, ray).abs();
        (least >= -tolerance).then_some(meeting)
    };
    ray_triangle(corners, ray).or_else(nearly)
}

fn case([a, b, c]: [DVec3; 3], ray: &Ray) -> String {
    format!("a {}, b {}, c {}; ray: {}", a.shown(), b.shown(), c.shown(), ray.shown())
}

fn meets(
    subject: &Subject,
    what: &str,
    corners: [DVec3; 3],
    ray: &Ray,
    wanted: Meeting,
) -> Verdict {
    let got = (subject.ray_triangle)(corners, ray);
    within(1e-13, || format!("{what}{}", case(corners, ray)), &got, &Some(wanted))
}

fn misses(subject: &Subject, what: &str, corners: [DVec3; 3], ray: &Ray) -> Verdict {
    let got = (subject.ray_triangle)(corners, ray);
    same(|| format!("{what}: {}", case(corners, ray)), &got, &None)
}

/// In the plane z = 0.
const FLAT: [DVec3; 3] = [DVec3::ZERO, DVec3::new(8.0, 0.0, 0.0), DVec3::new(0.0, 8.0, 0.0)];
/// (1, 2, 0) = 5/8 a + 1/8 b + 2/8 c.
const WEIGHTS: DVec3 = DVec3::new(0.625, 0.125, 0.25);
/// A third, a half and a sixth of these corners are (2, 2.5, 2) together: [`INSIDE`].
const SLANTED: [DVec3; 3] =
    [DVec3::new(3.0, 6.0, -6.0), DVec3::new(1.0, -1.0, 8.0), DVec3::new(3.0, 6.0, 0.0)];
const INSIDE: DVec3 = DVec3::new(2.0, 2.5, 2.0);
const SHARES: DVec3 = DVec3::new(1.0 / 3.0, 1.0 / 2.0, 1.0 / 6.0);

/// A ray along −z through (x, y) of [`FLAT`], which it meets at t = 3.
fn down(x: f64, y: f64) -> Ray {
    Ray::new(DVec3::new(x, y, 3.0), DVec3::NEG_Z)
}

fn straight_down(subject: &Subject) -> Verdict {
    meets(subject, "aimed at the inside: ", FLAT, &down(1.0, 2.0), (3.0, WEIGHTS))
}

/// The longest axis of the direction is x, y and z in turn, and points both ways.
fn in_space(subject: &Subject) -> Verdict {
    let directions = [DVec3::new(-3.0, 1.0, 2.0), DVec3::new(4.0, -1.0, 2.0)];
    let turns: [fn(DVec3) -> DVec3; 3] = [|v| v, |v| v.yzx(), |v| v.zxy()];
    for direction in directions {
        for turn in turns {
            let ray = Ray::new(turn(INSIDE - 2.0 * direction), turn(direction));
            meets(subject, "aimed at the inside: ", SLANTED.map(turn), &ray, (2.0, SHARES))?;
        }
    }
    Ok(())
}

fn other_side(subject: &Subject) -> Verdict {
    let up = Ray::new(DVec3::new(1.0, 2.0, -3.0), DVec3::Z);
    meets(subject, "from below: ", FLAT, &up, (3.0, WEIGHTS))?;
    let [a, b, c] = FLAT;
    let what = "the corners in the other order of rotation: ";
    meets(subject, what, [a, c, b], &down(1.0, 2.0), (3.0, WEIGHTS.xzy()))
}

fn beside(subject: &Subject) -> Verdict {
    // Beyond each edge, and beyond each corner.
    let points = [(4.0, -1.0), (-1.0, 4.0), (5.0, 4.0), (-1.0, -1.0), (10.0, -1.0), (-1.0, 10.0)];
    // In the range of the corners' x and y is what lies beyond the longest edge, which is each one's in turn.
    let [a, b, c] = FLAT;
    for corners in [FLAT, [b, c, a], [c, a, b], [a, c, b], [c, b, a], [b, a, c]] {
        for (x, y) in points {
            misses(subject, "beside", corners, &down(x, y))?;
        }
    }
    Ok(())
}

/// By 2⁻⁴⁰ beyond the longest edge, which is in the range of the corners' x and y: E_A is 2⁻³⁶, and exact in its sign.
fn just_beside(subject: &Subject) -> Verdict {
    let [a, b, c] = FLAT;
    let aside = 4.0 + 0.5_f64.powi(40);
    for corners in [FLAT, [b, c, a], [c, a, b], [a, c, b]] {
        misses(subject, "beyond an edge by 10⁻¹²", corners, &down(aside, aside))?;
    }
    // A tenth of its width beside a triangle that is small itself.
    let ray = Ray::new(DVec3::new(5e-12, 5e-12, 3.0), DVec3::NEG_Z);
    misses(subject, "8e-12 wide", FLAT.map(|corner| 1e-12 * corner), &ray)
}

fn close(subject: &Subject) -> Verdict {
    let height = 0.5_f64.powi(40);
    let ray = Ray::new(DVec3::new(1.0, 2.0, height), DVec3::NEG_Z);
    meets(subject, "10⁻¹² above it: ", FLAT, &ray, (height, WEIGHTS))?;
    let ray = Ray::new(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.0, 0.0, -3.0 / height));
    meets(subject, "a very long direction: ", FLAT, &ray, (height, WEIGHTS))
}

fn behind(subject: &Subject) -> Verdict {
    misses(subject, "the ray leads away", FLAT, &reversed(&down(1.0, 2.0)))?;
    let start = Ray::new(DVec3::new(1.0, 2.0, 0.0), DVec3::NEG_Z);
    misses(subject, "the ray starts on it (t = 0)", FLAT, &start)
}

fn exact_borders(subject: &Subject) -> Verdict {
    let points = [
        ((4.0, 0.0), DVec3::new(0.5, 0.5, 0.0)),
        ((0.0, 2.0), DVec3::new(0.75, 0.0, 0.25)),
        ((6.0, 2.0), DVec3::new(0.0, 0.75, 0.25)),
        ((0.0, 0.0), DVec3::X),
        ((8.0, 0.0), DVec3::Y),
        ((0.0, 8.0), DVec3::Z),
    ];
    let [a, b, c] = FLAT;
    points.into_iter().try_for_each(|((x, y), weights)| {
        meets(subject, "on its border: ", FLAT, &down(x, y), (3.0, weights))?;
        let what = "on its border, the corners in the other order of rotation: ";
        meets(subject, what, [a, c, b], &down(x, y), (3.0, weights.xzy()))
    })
}

/// [`FLAT`] 10⁻¹² times as large: twice its area is 6.4·10⁻²³.
fn small(subject: &Subject) -> Verdict {
    let ray = Ray::new(DVec3::new(1e-12, 2e-12, 3.0), DVec3::NEG_Z);
    meets(subject, "8e-12 wide: ", FLAT.map(|corner| 1e-12 * corner), &ray, (3.0, WEIGHTS))
}

/// Corners and rays are integer combinations of two integer vectors, so that they lie in one plane
/// exactly, and the ray runs past the triangle by the signs of two-dimensional products, which are exact.
fn in_plane(subject: &Subject) -> Verdict {
    let ray = Ray::new(DVec3::new(-1.0, 2.0, 0.0), DVec3::X);
    misses(subject, "in the plane z = 0", FLAT, &ray)?;
    let mut random = Uniform::new(7, 0, 0);
    let mut integer = |size: f64| (random.number() * (2.0 * size + 1.0)).floor() - size;
    for _ in 0..20_000 {
        let mut vector = || DVec3::new(integer(999.0), integer(999.0), integer(999.0));
        let (p, q) = (vector(), vector());
        let mut combination = || DVec2::new(integer(9.0), integer(9.0));
        let corners = [combination(), combination(), combination()];
        let (origin, direction) = (combination(), combination());
        let sides = corners.map(|corner| direction.perp_dot(corner - origin));
        let passes = sides.iter().all(|&side| side > 0.0) || sides.iter().all(|&side| side < 0.0);
        let in_space = |v: DVec2| v.x * p + v.y * q;
        let ray = Ray::new(in_space(origin), in_space(direction));
        let is_met = (subject.ray_triangle)(corners.map(in_space), &ray).is_some();
        // Which one it is depends on the order of rounding; that one is does not.
        ensure(!(passes && is_met), || {
            Mismatch::new(
                "20000 triangles and rays in their planes, which run past them",
                "some are met: E_A, E_B and E_C are rounding noise, and their signs agree by chance",
                "None for each",
            )
        })?;
    }
    Ok(())
}

fn no_number(subject: &Subject) -> Verdict {
    let ray = Ray::new(DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO);
    misses(subject, "a ray without a direction", FLAT, &ray)?;
    let [a, b, _] = FLAT;
    misses(subject, "a corner that is no number", [a, b, DVec3::NAN], &down(1.0, 2.0))?;
    misses(subject, "a triangle without an area", [a, b, b], &down(1.0, 0.0))
}

fn corners_of_mesh(subject: &Subject) -> Verdict {
    closed(subject, VERTICES, "corners of its triangles")
}

fn edges_of_mesh(subject: &Subject) -> Verdict {
    closed(subject, EDGES, "points of its triangles' edges")
}

/// Whether no ray leaves a closed mesh.
fn closed(subject: &Subject, aim: usize, at: &str) -> Verdict {
    let mesh = icosphere(2);
    let met = |ray: &Ray| {
        (0..mesh.triangles.len()).any(|k| (subject.ray_triangle)(mesh.corners(k), ray).is_some())
    };
    let triangles = mesh.triangles.len();
    // How many slip through depends on the order of rounding, and so does which.
    ensure(aimed(&mesh, aim, 4000).iter().all(met), || {
        Mismatch::new(
            format!("4000 rays from inside a closed mesh of {triangles} triangles, aimed at {at}"),
            "some meet no triangle at all: they slip between neighbours",
            "each meets at least one",
        )
    })
}

/// A ball of 80 triangles in the colours of their corners' weights, darker the farther away it is; below it
/// the relief of plate 0.3, each pixel's ray aimed at a corner. What meets no triangle stays dark.
fn draw(subject: &Subject) -> Image {
    let (width, height) = (192, 128);
    let ball = icosphere(1);
    let rays = BALL_CAMERA.primary_rays(ImageSize::new(width, height));
    let relief = Relief::new([width, height]);
    painted(ImageSize::new(width, 2 * height), |x, y| {
        if y < f64::from(height) {
            let ray = rays.through(x, y);
            let corners = (0..ball.triangles.len()).map(|k| ball.corners(k));
            let hits = corners.filter_map(|corners| (subject.ray_triangle)(corners, &ray));
            let closest = hits.min_by(|a, b| a.0.total_cmp(&b.0));
            closest.map_or(Rgb::splat(0.02), |(t, weights)| weights / (t - 2.0).powi(4))
        } else {
            let test =
                |corners: [DVec3; 3], ray: &Ray| (subject.ray_triangle)(corners, ray).is_some();
            let lit = relief.brightness(x as u32, y as u32 - height, test);
            lit.map_or(Rgb::ZERO, |brightness| brightness * Rgb::new(0.83, 0.61, 0.35))
        }
    })
}

/// The ball's nearest point is at distance 3.
const BALL_CAMERA: Camera = Camera {
    eye: DVec3::new(0.8, 1.6, 3.6),
    look_at: DVec3::ZERO,
    up: DVec3::Y,
    fov: 34.0,
    lens: None,
};
