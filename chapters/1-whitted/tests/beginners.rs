//! Wrong answers as beginners write them, in words of their own: each is told what is wrong with it. That a slip is
//! caught is proved with the slip itself; here it is recognised in code that does not come from it.

use chapter_1::exercises::prelude::{Camera, DVec3, ImageSize, Lit, Meeting, Ray, Rgb};
use chapter_1::exercises::reference::SUBJECT;
use chapter_1::exercises::{COURSE, Subject};
use lancer_exercise::{Failure, Report};

const RIGHT: Subject = SUBJECT;

/// What a student reads: the words of the slip, or else the first counter-example.
fn told(name: &str, subject: Subject) -> String {
    let exercise = COURSE.exercises.iter().find(|exercise| exercise.card.name == name).unwrap();
    let report = Report::of(exercise, subject, RIGHT);
    report.slip.map_or_else(
        || match report.first_failure() {
            Some((_, Failure::Wrong(mismatch))) => mismatch.to_string(),
            other => format!("{other:?}"),
        },
        str::to_owned,
    )
}

/// A primary ray by coordinates from −1 to 1; what is passed in may be wrong.
fn seen(
    camera: &Camera,
    size: ImageSize,
    [x, y]: [f64; 2],
    half_height: fn(f64) -> f64,
    shape: fn(u32, u32) -> f64,
    film_up: fn(&Camera, DVec3) -> DVec3,
) -> Ray {
    let forward = (camera.look_at - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = film_up(camera, right.cross(forward));
    let half = half_height(camera.fov);
    let u = (2.0 * x / f64::from(size.width) - 1.0) * shape(size.width, size.height) * half;
    let v = (1.0 - 2.0 * y / f64::from(size.height)) * half;
    Ray::new(camera.eye, (forward + u * right + v * up).normalize())
}

fn tangent(fov: f64) -> f64 {
    (fov.to_radians() / 2.0).tan()
}

fn ratio(width: u32, height: u32) -> f64 {
    f64::from(width) / f64::from(height)
}

fn level(_: &Camera, up: DVec3) -> DVec3 {
    up
}

#[test]
fn primary_rays() {
    let cases: [(fn(&Camera, ImageSize, f64, f64) -> Ray, &str); 7] = [
        (|c, s, x, y| seen(c, s, [x, y], tangent, ratio, level), "None"),
        (
            |c, s, x, y| seen(c, s, [x, y], |fov| fov.to_radians().tan(), ratio, level),
            "the whole opening angle is taken",
        ),
        (
            |c, s, x, y| seen(c, s, [x, y], |fov| fov.to_radians().tan() / 2.0, ratio, level),
            "the film's height is 2 tan(fov/2), not tan(fov)",
        ),
        (
            |c, s, x, y| seen(c, s, [x, y], f64::tan, ratio, level),
            "the tangent is taken of the whole opening angle, and in degrees",
        ),
        (
            |c, s, x, y| seen(c, s, [x, y], tangent, ratio, |camera, _| camera.up),
            "camera.up is used as it comes: it is neither unit",
        ),
        (
            |c, s, x, y| seen(c, s, [x, y], tangent, |w, h| f64::from(w / h), level),
            "the picture's shape is a whole number",
        ),
        (
            |c, s, x, y| {
                let single = |fov: f64| f64::from((fov.to_radians() as f32 / 2.0).tan());
                seen(c, s, [x, y], single, ratio, level)
            },
            "is there an `f32` on the way?",
        ),
    ];
    for (primary_ray, words) in cases {
        let told = told("primary-ray", Subject { primary_ray, ..RIGHT });
        assert!(told.contains(words), "{words}: {told}");
    }
}

/// The right test, but for a tolerance around the edges and the smallest t.
fn met(corners: [DVec3; 3], ray: &Ray, tolerance: f64, nearest: f64) -> Option<Meeting> {
    let d = ray.direction;
    let z = d.abs().max_position();
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let [a, b, c] = corners.map(|corner| {
        let v = corner - ray.origin;
        DVec3::new(v[x] - d[x] / d[z] * v[z], v[y] - d[y] / d[z] * v[z], v[z] / d[z])
    });
    let (u, v, w) = (c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x);
    let is_behind = [u, v, w].iter().any(|e| *e < -tolerance);
    let is_ahead = [u, v, w].iter().any(|e| *e > tolerance);
    let low = a.min(b).min(c);
    let high = a.max(b).max(c);
    if is_behind && is_ahead || low.x > 0.0 || low.y > 0.0 || high.x < 0.0 || high.y < 0.0 {
        return None;
    }
    let det = u + v + w;
    let t = (u * a.z + v * b.z + w * c.z) / det;
    (t > nearest && t < f64::INFINITY).then(|| (t, DVec3::new(u, v, w) / det))
}

#[test]
fn triangles() {
    let cases: [(fn([DVec3; 3], &Ray) -> Option<Meeting>, &str); 3] = [
        (|corners, ray| met(corners, ray, 0.0, 0.0), "None"),
        (|corners, ray| met(corners, ray, 1e-9, 0.0), "compared with a tolerance"),
        (|corners, ray| met(corners, ray, 0.0, 1e-3), "hits near the ray's origin are left out"),
    ];
    for (ray_triangle, words) in cases {
        let told = told("ray-triangle", Subject { ray_triangle, ..RIGHT });
        assert!(told.contains(words), "{words}: {told}");
    }
}

/// N·L and R·V are each taken as 0 where they are negative: behind the surface the highlight stays.
#[test]
fn the_local_model() {
    let apart = |lit: &Lit| -> Rgb {
        let mirror = 2.0 * lit.n.dot(lit.to_light) * lit.n - lit.to_light;
        let matte = lit.reflectance.diffuse * lit.n.dot(lit.to_light).max(0.0);
        let cos = lit.to_eye.dot(mirror).max(0.0);
        let glossy = lit.reflectance.specular * cos.powf(lit.reflectance.shininess);
        let arriving = f64::from(lit.visible) * lit.intensity / lit.distance.powi(2);
        arriving * (matte + glossy)
    };
    let told = told("local-light", Subject { local_light: apart, ..RIGHT });
    assert!(told.contains("a lamp behind the surface makes a highlight"), "{told}");
}

#[test]
fn refracted_rays() {
    let cases: [(fn(DVec3, DVec3, f64, f64) -> Option<DVec3>, &str); 3] = [
        (
            |v, n, n1, n2| {
                let (eta, c1) = (n1 / n2, v.dot(-n));
                let c2 = (1.0 - eta.powi(2) * (1.0 - c1.powi(2))).sqrt();
                if c2.is_nan() { None } else { Some(v * eta + n * (eta * c1 + c2)) }
            },
            "+ cos θ₂ N in place of − cos θ₂ N",
        ),
        (
            |v, n, n1, n2| {
                let (eta, c1) = (n1 / n2, v.dot(-n));
                let k = 1.0 - eta * (1.0 - c1.powi(2));
                if k < 0.0 { None } else { Some(v * eta + n * (eta * c1 - k.sqrt())) }
            },
            "η is not squared",
        ),
        (
            |v, n, n1, n2| {
                let (eta, c1) = (n1 / n2, v.dot(-n));
                let k = 1.0 - eta.powi(2) * (1.0 - c1.powi(2));
                if k < 0.0 { None } else { Some(v * eta + n * (eta * c1 - k)) }
            },
            "the root is missing",
        ),
    ];
    for (refracted_ray, words) in cases {
        let told = told("refracted-ray", Subject { refracted_ray, ..RIGHT });
        assert!(told.contains(words), "{words}: {told}");
    }
}

#[test]
fn samples() {
    let subject = Subject {
        pixel_mean: |radiance, x, y, n| {
            let mut sum = Rgb::ZERO;
            for cell in 0..n * n {
                let (i, j) = (cell % n, cell / n);
                let (u, v) = (f64::from(i / n), f64::from(j / n));
                let half = 0.5 / f64::from(n);
                sum += radiance(f64::from(x) + u + half, f64::from(y) + v + half);
            }
            sum / f64::from(n * n)
        },
        ..RIGHT
    };
    let told = told("samples", subject);
    assert!(told.contains("all samples are in one place"), "{told}");
}
