//! E1.1: the ray through a film point.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::{Image, ImageSize};
use lancer_core::intersector::{Intersector, LinearScan};
use lancer_core::scene::Camera;
use lancer_exercise::{Card, Check, Exercise, Shown, Solution, Verdict, slips, within};
use lancer_lesson::scenes::parsed;

use super::reference::primary_ray;
use super::{Subject, painted};

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E1.1",
        name: "primary-ray",
        title: "The ray through a film point",
        slide: "Principe géométrique : ligne œil-pixel",
        stub: include_str!("../../stubs/e01_primary_ray.rs"),
        functions: &["primary_ray"],
        minutes: 20,
        predict: "the eye stands above a checkered floor with a red ball on the left and a green one on the \
                  right, and the picture is wider than high: at which height is the horizon, and what \
                  would the balls be if pixels were not square?",
        vary: "halve the opening angle in your function (`0.5 * camera.fov`): what happens to the balls, and \
               does the horizon move?",
        hints: [
            "Build a frame at the eye, of three unit axes at right angles: w forward, u to the right and v up. The \
             film is a window at distance 1 ahead; how high is it if its opening angle is known?",
            "w = (look_at − eye)/|…|, u = w × up/|…|, v = u × w. From its middle to its edge the film measures \
             tan(fov/2), so a pixel's side is p = 2 tan(fov/2) / height, and the direction is \
             w + p (x − width/2) u − p (y − height/2) v, made unit.",
            "w, u and v are `let forward = (camera.look_at - camera.eye).normalize();`, \
             `let right = forward.cross(camera.up).normalize();` and `let up = right.cross(forward);`, p is \
             `let pixel = 2.0 * (0.5 * camera.fov.to_radians()).tan() / f64::from(size.height);`. Then add up \
             the three parts, `.normalize()`, and `Ray::new(camera.eye, …)`.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e01_primary_ray.rs"),
            file: "crates/core/src/scene/camera.rs",
            item: "impl PrimaryRays",
            notice: "the corner, the step to the right and the step down are worked out once per picture, so \
                     that a ray costs two multiplications and an addition of vectors, and a root",
        },
    },
    checks: &[
        Check { name: "the middle of the picture", run: middle },
        Check { name: "the middle of the upper edge", run: upper_edge },
        Check { name: "the middle of the right edge", run: right_edge },
        Check { name: "another opening angle", run: opening_angle },
        Check { name: "a turned camera, by hand", run: turned },
        Check { name: "odd numbers of pixels", run: odd },
    ],
    slips: slips! {
        primary_ray(camera, size, x, y):
        "the picture is upside down: y counts downwards from the upper edge":
            "the middle of the upper edge" catches primary_ray(camera, size, x, height(size) - y);
        "left and right are exchanged: to the right is forward × up, in this order":
            "the middle of the right edge" catches primary_ray(camera, size, width(size) - x, y);
        "the picture is turned by half: both signs are wrong":
            "the middle of the right edge" catches
                primary_ray(camera, size, width(size) - x, height(size) - y);
        "the opening angle is taken as horizontal: it is the vertical one, so a pixel's side is 2 tan(fov/2) over \
         the height":
            "the middle of the upper edge" catches
                zoomed(camera, tan_half(camera) * height(size) / width(size), size, x, y);
        "the whole opening angle is taken: the film's half height is the tangent of half of it":
            "the middle of the upper edge" catches
                zoomed(camera, camera.fov.to_radians().tan(), size, x, y);
        "the film's height is 2 tan(fov/2), not tan(fov): the tangent of a whole angle is not twice that of half of it":
            "the middle of the upper edge" catches
                zoomed(camera, 0.5 * camera.fov.to_radians().tan(), size, x, y);
        "the opening angle is in degrees, and the tangent wants radians: `to_radians()`":
            "the middle of the upper edge" catches
                zoomed(camera, (0.5 * camera.fov).tan(), size, x, y);
        "the tangent is taken of the whole opening angle, and in degrees: it wants half of it, in radians":
            "the middle of the upper edge" catches zoomed(camera, camera.fov.tan(), size, x, y);
        "the film is twice too small: from the middle to the edge it is tan(fov/2), from edge to edge twice that":
            "the middle of the upper edge" catches
                zoomed(camera, 0.5 * tan_half(camera), size, x, y);
        "pixels are not square: the film is as wide as high whatever the picture's shape; its width is \
         width/height times its height":
            "the middle of the right edge" catches
                squeezed(camera, height(size) / width(size), size, x, y);
        "the direction is not unit: normalise the sum":
            "the middle of the upper edge" catches {
                let ray = primary_ray(camera, size, x, y);
                Ray::new(ray.origin, ray.direction / forward(camera).dot(ray.direction))
            };
        "half a pixel is added: x and y are the film point itself, not a pixel's column and row":
            "the middle of the picture" catches primary_ray(camera, size, x + 0.5, y + 0.5);
        "camera.up is used as it comes: it need not be perpendicular to the view axis, so the film's own up is \
         right × forward":
            "a turned camera, by hand" catches {
                let (forward, up) = (forward(camera), camera.up.normalize());
                through(camera, [forward, forward.cross(up).normalize(), up], size, x, y)
            };
        "camera.up is used as it comes: it is neither unit nor perpendicular to the view axis, so the film's own up \
         is right × forward":
            "a turned camera, by hand" catches {
                let forward = forward(camera);
                through(camera, [forward, right(camera), camera.up], size, x, y)
            };
        "forward × up is not made unit: camera.up need not be perpendicular to the view axis":
            "a turned camera, by hand" catches {
                let forward = forward(camera);
                through(camera, level(forward, forward.cross(camera.up)), size, x, y)
            };
        "look_at − eye is not made unit: right is, so the picture narrows with the distance of the point looked at":
            "another opening angle" catches
                through(camera, level(camera.look_at - camera.eye, right(camera)), size, x, y);
        "the film is not at distance 1 but at that of look_at, though its size is not":
            "another opening angle" catches
                zoomed(camera, tan_half(camera) / camera.look_at.distance(camera.eye), size, x, y);
        "pixels are not square: the film is height/width as wide as high, where it should be width/height":
            "the middle of the right edge" catches
                squeezed(camera, (height(size) / width(size)).powi(2), size, x, y);
        "half the size is a whole number: `size.width / 2` drops the half of an odd one, so divide after \
         `f64::from`":
            "odd numbers of pixels" catches {
                let dropped = |pixels: u32| 0.5 * f64::from(pixels % 2);
                primary_ray(camera, size, x + dropped(size.width), y + dropped(size.height))
            };
        "the picture's shape is a whole number: width / height of whole numbers drops what is left over, so convert \
         both by `f64::from` before dividing":
            "a turned camera, by hand" catches {
                let shape = f64::from(size.width / size.height);
                squeezed(camera, shape * height(size) / width(size), size, x, y)
            };
        "the ray starts in look_at: it starts in the eye":
            "the middle of the picture" catches
                Ray::new(camera.look_at, primary_ray(camera, size, x, y).direction);
        "the ray looks backwards: from the eye to the film is look_at − eye, not eye − look_at":
            "the middle of the picture" catches {
                let look_at = 2.0 * camera.eye - camera.look_at;
                primary_ray(&Camera { look_at, ..*camera }, size, x, y)
            };
    },
    own: |yours, reference| Subject { primary_ray: yours.primary_ray, ..reference },
    draw,
    explain: None,
};

/// The film's half height at distance 1.
fn tan_half(camera: &Camera) -> f64 {
    (0.5 * camera.fov.to_radians()).tan()
}

fn width(size: ImageSize) -> f64 {
    size.width.into()
}

fn height(size: ImageSize) -> f64 {
    size.height.into()
}

fn forward(camera: &Camera) -> DVec3 {
    (camera.look_at - camera.eye).normalize()
}

fn right(camera: &Camera) -> DVec3 {
    forward(camera).cross(camera.up).normalize()
}

/// The ray through a film of another half height at distance 1.
fn zoomed(camera: &Camera, half_height: f64, size: ImageSize, x: f64, y: f64) -> Ray {
    let (forward, right, zoom) = (forward(camera), right(camera), half_height / tan_half(camera));
    through(camera, [forward, zoom * right, zoom * right.cross(forward)], size, x, y)
}

/// The ray through a film whose pixels are not square.
fn squeezed(camera: &Camera, share: f64, size: ImageSize, x: f64, y: f64) -> Ray {
    let middle = 0.5 * width(size);
    primary_ray(camera, size, middle + (x - middle) * share, y)
}

/// The frame in which up is perpendicular to forward and right.
fn level(forward: DVec3, right: DVec3) -> [DVec3; 3] {
    [forward, right, right.cross(forward)]
}

/// The ray through a film with another frame: forward, right and up.
fn through(camera: &Camera, frame: [DVec3; 3], size: ImageSize, x: f64, y: f64) -> Ray {
    let [forward, right, up] = frame;
    let pixel = 2.0 * tan_half(camera) / height(size);
    let aside = (x - 0.5 * width(size)) * right - (y - 0.5 * height(size)) * up;
    Ray::new(camera.eye, (forward + pixel * aside).normalize())
}

/// 2 atan(3/4) in degrees: the film at distance 1 is 1.5 high. At 90 degrees tan(fov), a beginner's slip, would be
/// as good as infinite, and what is printed of it rounding noise.
const FOV: f64 = 73.739_795_291_688_04;

/// Along −z with y up.
const PLAIN: Camera =
    Camera { eye: DVec3::ZERO, look_at: DVec3::NEG_Z, up: DVec3::Y, fov: FOV, lens: None };
/// Two rows of four pixels.
const WIDE: (u32, u32) = (4, 2);

/// The eye, and the axes of the film: (2, 3, 6)/7 forward, (−6, −2, 3)/7 to the right, (−3, 6, −2)/7 up.
/// Its `up` is 7 times the latter and 7 times forward, and neither is `look_at` at distance 1.
const TURNED: Camera = Camera {
    eye: DVec3::new(1.0, -2.0, 3.0),
    look_at: DVec3::new(5.0, 4.0, 15.0),
    up: DVec3::new(-1.0, 9.0, 4.0),
    fov: FOV,
    lens: None,
};

fn compare(
    subject: &Subject,
    camera: &Camera,
    (width, height): (u32, u32),
    (x, y): (f64, f64),
    direction: DVec3,
) -> Verdict {
    let case = || {
        let Camera { eye, look_at, up, fov, lens: _ } = camera;
        format!(
            "eye {}, look_at {}, up {}, vertical fov {}°, {width} × {height} pixels, film point \
             ({x} to the right, {y} down)",
            eye.shown(),
            look_at.shown(),
            up.shown(),
            fov.shown(),
        )
    };
    let got = (subject.primary_ray)(camera, ImageSize::new(width, height), x, y);
    within(1e-14, case, &got, &Ray::new(camera.eye, direction))
}

fn middle(subject: &Subject) -> Verdict {
    compare(subject, &PLAIN, WIDE, (2.0, 1.0), DVec3::NEG_Z)?;
    compare(subject, &TURNED, WIDE, (2.0, 1.0), DVec3::new(2.0, 3.0, 6.0) / 7.0)
}

fn upper_edge(subject: &Subject) -> Verdict {
    compare(subject, &PLAIN, WIDE, (2.0, 0.0), DVec3::new(0.0, 0.6, -0.8))
}

fn right_edge(subject: &Subject) -> Verdict {
    // The film is as far from its middle to the right edge as it is high.
    let right_and_ahead = DVec3::new(3.0, 0.0, -2.0) / 13.0_f64.sqrt();
    compare(subject, &PLAIN, WIDE, (4.0, 1.0), right_and_ahead)
}

/// tan(fov/2) = 2/5: a pixel's side is 2/5 with two rows.
fn opening_angle(subject: &Subject) -> Verdict {
    let fov = 2.0 * 0.4_f64.atan().to_degrees();
    let camera = Camera { fov, look_at: DVec3::new(0.0, 0.0, -10.0), ..PLAIN };
    // The centre of a pixel: from the middle half a pixel to the left and half a one up.
    let direction = DVec3::new(-0.2, 0.2, -1.0).normalize();
    compare(subject, &camera, WIDE, (1.5, 0.5), direction)
}

/// A pixel's side is 1/4 with six rows: (7, 2) is 3/4 to the right and 1/4 up on a film eight pixels wide.
/// 4 (2, 3, 6) + 3 (−6, −2, 3) + (−3, 6, −2) = (−13, 12, 31), of length 7 √(4² + 3² + 1).
fn turned(subject: &Subject) -> Verdict {
    let direction = DVec3::new(-13.0, 12.0, 31.0) / 1274.0_f64.sqrt();
    compare(subject, &TURNED, (8, 6), (7.0, 2.0), direction)
}

/// The middle of 5 × 3 pixels is (2.5, 1.5), in the middle of one.
fn odd(subject: &Subject) -> Verdict {
    compare(subject, &PLAIN, (5, 3), (2.5, 1.5), DVec3::NEG_Z)
}

/// A floor and two balls before a sky, by the subject's rays. The sky is lighter the higher it is.
fn draw(subject: &Subject) -> Image {
    let scene = parsed("floor", FLOOR);
    let size = ImageSize::new(288, 192);
    let oracle = LinearScan::new(&scene);
    painted(size, |x, y| {
        let ray = (subject.primary_ray)(&scene.camera, size, x, y);
        let Some(hit) = oracle.closest_hit(&ray, Interval::POSITIVE) else {
            return Rgb::new(0.25, 0.4, 0.7) * (1.0 + 2.0 * ray.direction.y);
        };
        let surface = scene.surface_at(&ray, &hit);
        let n = surface.shading_normal;
        scene.reflectance(&surface).diffuse * (0.6 + 0.4 * n.dot(DVec3::new(-0.48, 0.8, 0.36)))
    })
}

const FLOOR: &str = "
    camera = { eye = [0, 2.2, 7], look_at = [0, 1, 0], fov = 40 }
    material.floor = { rho_d = { checker = [[0.75, 0.75, 0.7], [0.12, 0.12, 0.14]], side = 1 } }
    material.red = { rho_d = [0.8, 0.06, 0.04] }
    material.green = { rho_d = [0.06, 0.55, 0.08] }
    light = [{ position = [0, 9, 5], intensity = 1 }]
    polygon = [{ vertices = [[-40, 0, 9], [40, 0, 9], [40, 0, -80], [-40, 0, -80]], material = 'floor' }]
    sphere = [
        { center = [-2.2, 1, 0], radius = 1, material = 'red' },
        { center = [1.9, 0.6, 1.2], radius = 0.6, material = 'green' },
    ]";
