//! Rays aimed where indexes go wrong: random ones find nothing.

use glam::DVec3;
use lancer_core::geometry::Ray;
use lancer_core::scene::Mesh;

/// The ways of aiming, each known to break some index.
pub const CLASSES: [&str; 9] = [
    "at a vertex",
    "at an edge",
    "along an axis through a vertex",
    "vertex to vertex",
    "in an axis plane through a vertex",
    "from the surface",
    "from outside",
    "from far away",
    "random",
];

/// A ray of a class at a mesh of about the size of 1 around `center`; `random` is uniform in [0, 1).
pub fn aimed(class: &str, mesh: &Mesh, center: DVec3, random: &mut dyn FnMut() -> f64) -> Ray {
    let vertex = pick(&mesh.positions, random);
    let inside = center + in_cube(0.4, random);
    match class {
        "at a vertex" => Ray::new(inside, vertex - inside),
        "at an edge" => {
            let [a, b, _] = corners(mesh, random);
            Ray::new(inside, a + random() * (b - a) - inside)
        }
        "along an axis through a vertex" => {
            let axis = pick(&[0, 1, 2], random);
            let mut direction = DVec3::ZERO;
            for k in 0..3 {
                let sign = if random() < 0.5 { -1.0 } else { 1.0 };
                direction[k] = if k == axis { sign } else { sign * 0.0 };
            }
            let mut origin = vertex;
            origin[axis] -= 8.0 * direction[axis];
            Ray::new(origin, direction)
        }
        "vertex to vertex" => Ray::new(vertex, pick(&mesh.positions, random) - vertex),
        "in an axis plane through a vertex" => {
            let mut direction = direction(random);
            direction[pick(&[0, 1, 2], random)] = 0.0;
            Ray::new(vertex - 4.0 * direction, direction)
        }
        "from the surface" => Ray::new(on_surface(mesh, random), direction(random)),
        "from outside" => {
            let origin = center + (2.0 + 20.0 * random()) * direction(random);
            Ray::new(origin, on_surface(mesh, random) - origin)
        }
        "from far away" => {
            let away = 10.0_f64.powf(2.0 + 10.0 * random());
            let origin = center + away * direction(random);
            Ray::new(origin, vertex - origin)
        }
        _ => Ray::new(center + in_cube(1.5, random), direction(random)),
    }
}

fn pick<T: Copy>(from: &[T], random: &mut dyn FnMut() -> f64) -> T {
    from[(random() * from.len() as f64) as usize]
}

fn corners(mesh: &Mesh, random: &mut dyn FnMut() -> f64) -> [DVec3; 3] {
    mesh.corners((random() * mesh.triangles.len() as f64) as usize)
}

fn on_surface(mesh: &Mesh, random: &mut dyn FnMut() -> f64) -> DVec3 {
    let [a, b, c] = corners(mesh, random);
    let (u, v) = (random().sqrt(), random());
    (1.0 - u) * a + u * ((1.0 - v) * b + v * c)
}

fn in_cube(half: f64, random: &mut dyn FnMut() -> f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| half * (2.0 * random() - 1.0)))
}

fn direction(random: &mut dyn FnMut() -> f64) -> DVec3 {
    loop {
        let v = in_cube(1.0, random);
        if (1e-3..=1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}
