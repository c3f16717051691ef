//! What scenes are put together from.

use std::f64::consts::{PI, TAU};

use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3};
use lancer_core::scene::{MaterialId, Mesh};

/// Two triangles.
pub fn push_quad(mesh: &mut Mesh, corners: [DVec3; 4]) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    let [a, b, c, d] = [first, first + 1, first + 2, first + 3];
    mesh.push_face(MaterialId(0), &[[a, b, c], [a, c, d]]);
}

/// A box along the axes.
pub fn push_cuboid(mesh: &mut Mesh, low: [f64; 3], high: [f64; 3]) {
    let corner = |x: usize, y: usize, z: usize| {
        DVec3::new([low, high][x][0], [low, high][y][1], [low, high][z][2])
    };
    for side in 0..2 {
        let mut face = [(0, 0), (0, 1), (1, 1), (1, 0)];
        if side == 1 {
            face.reverse();
        }
        push_quad(mesh, face.map(|(a, b)| corner(side, a, b)));
        push_quad(mesh, face.map(|(a, b)| corner(b, side, a)));
        push_quad(mesh, face.map(|(a, b)| corner(a, b, side)));
    }
}

/// A framed panel, such as a cupboard's door or a tile: a rectangle from `corner` along `across` and `up`, whose rim
/// follows a profile of (way inwards, height above it).
pub fn push_panel(
    mesh: &mut Mesh,
    corner: DVec3,
    [across, up]: [DVec3; 2],
    profile: &[(f64, f64)],
) {
    let out = across.cross(up).normalize();
    let (right, top) = (across.normalize(), up.normalize());
    let rim = |&(inwards, height): &(f64, f64)| {
        let at = |a: f64, b: f64| {
            let inset = right * (inwards * (1.0 - 2.0 * a)) + top * (inwards * (1.0 - 2.0 * b));
            corner + a * across + b * up + inset + height * out
        };
        [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]
    };
    for pair in profile.windows(2) {
        let (outer, inner) = (rim(&pair[0]), rim(&pair[1]));
        for k in 0..4 {
            let next = (k + 1) % 4;
            push_quad(mesh, [outer[k], outer[next], inner[next], inner[k]]);
        }
    }
    push_quad(mesh, rim(profile.last().expect("a profile")));
}

/// A moulding: a profile of (way out, height) drawn along a straight line.
pub fn push_moulding(mesh: &mut Mesh, [from, to]: [DVec3; 2], out: DVec3, profile: &[(f64, f64)]) {
    for pair in profile.windows(2) {
        let [low, high] = [pair[0], pair[1]].map(|(away, height)| away * out + height * DVec3::Y);
        push_quad(mesh, [from + low, to + low, to + high, from + high]);
    }
}

/// A part at a place, turned around the vertical axis.
pub fn placed(place: [f64; 3], turn: f64) -> DAffine3 {
    DAffine3::from_rotation_translation(DQuat::from_rotation_y(turn), place.into())
}

/// A surface over [0, 1]², cut into `across` by `down` quadrilaterals and those into triangles; it closes
/// at the ends of its first coordinate.
pub fn surface(cuts: [f64; 2], point: impl Fn(f64, f64) -> DVec3) -> Mesh {
    patch(cuts, 3, 0, point)
}

/// The same with open ends, such as a cloth.
pub fn sheet(cuts: [f64; 2], point: impl Fn(f64, f64) -> DVec3) -> Mesh {
    patch(cuts, 1, 1, point)
}

/// A surface of `across + open` columns of points, `across` at least so many.
fn patch(
    [across, down]: [f64; 2],
    fewest: u32,
    open: u32,
    point: impl Fn(f64, f64) -> DVec3,
) -> Mesh {
    let (across, down) = ((across as u32).max(fewest), down.max(1.0) as u32);
    let columns = across + open;
    let mut mesh = Mesh::default();
    for row in 0..=down {
        for column in 0..columns {
            let (turn, part) =
                (f64::from(column) / f64::from(across), f64::from(row) / f64::from(down));
            mesh.positions.push(point(turn, part));
        }
    }
    for row in 0..down {
        for column in 0..across {
            let [here, next] = [column, (column + 1) % columns].map(|k| row * columns + k);
            let [below, beside] = [here + columns, next + columns];
            mesh.push_face(MaterialId(0), &[[here, next, beside], [here, beside, below]]);
        }
    }
    mesh
}

/// A teapot as high as 1: a pot and a lid of revolution, a spout and a handle.
pub fn teapot(count: u32) -> Mesh {
    // The pot has two parts of five, lid, spout and handle one each.
    let rows = |part: f64| (f64::from(count) * part / 4.0).sqrt().round().max(2.0);
    let pot = [(0.45, 0.0), (0.62, 0.12), (0.7, 0.35), (0.6, 0.6), (0.42, 0.78)];
    let lid = [(0.44, 0.77), (0.25, 0.86), (0.06, 0.89), (0.1, 0.95), (0.0, 1.0)];
    let mut mesh = revolved(&pot, rows(0.4));
    let mut add = |part: Mesh| mesh.append(&part, DAffine3::IDENTITY, 0);
    add(revolved(&lid, rows(0.2)));
    add(tube(&[(0.6, 0.25), (0.85, 0.3), (0.9, 0.55), (1.05, 0.75)], [0.14, 0.05], rows(0.2)));
    add(tube(&[(-0.6, 0.65), (-1.05, 0.7), (-1.0, 0.3), (-0.65, 0.2)], [0.05, 0.05], rows(0.2)));
    mesh
}

/// A profile of (radius, height), turned around the vertical axis.
pub fn revolved(profile: &[(f64, f64)], rows: f64) -> Mesh {
    surface([2.0 * rows, rows], |turn, part| {
        let around = turn * TAU;
        let DVec2 { x: radius, y: height } = along(profile, part);
        DVec3::new(radius * around.cos(), height, radius * around.sin())
    })
}

/// A turned post as high as `height`, of a radius for each (angle, height as a part of the whole).
pub fn post(cuts: [f64; 2], height: f64, radius: impl Fn(f64, f64) -> f64) -> Mesh {
    surface(cuts, |turn, part| {
        let around = turn * TAU;
        let radius = radius(around, part);
        DVec3::new(radius * around.cos(), part * height, radius * around.sin())
    })
}

/// A sphere.
pub fn ball(rows: f64, center: DVec3, radius: f64) -> Mesh {
    surface([2.0 * rows, rows], |turn, part| {
        let ((s, c), (sin, cos)) = ((turn * TAU).sin_cos(), (part * PI).sin_cos());
        center + radius * DVec3::new(c * sin, cos, s * sin)
    })
}

/// A round bar.
pub fn rod(sides: f64, [from, to]: [DVec3; 2], radius: f64) -> Mesh {
    let (u, v) = (to - from).normalize().any_orthonormal_pair();
    surface([sides, 1.0], |turn, part| {
        let (sin, cos) = (turn * TAU).sin_cos();
        from.lerp(to, part) + radius * (cos * u + sin * v)
    })
}

/// A tube around a way in the plane z = 0, with its radii at both ends.
pub fn tube(way: &[(f64, f64)], radii: [f64; 2], rows: f64) -> Mesh {
    surface([rows, 2.0 * rows], |turn, part| {
        let around = turn * TAU;
        let ahead = (along(way, part + 1e-3) - along(way, part - 1e-3)).normalize();
        let frame = DMat3::from_cols(ahead.extend(0.0), ahead.perp().extend(0.0), DVec3::Z);
        let radius = radii[0] + (radii[1] - radii[0]) * part;
        along(way, part).extend(0.0)
            + frame * DVec3::new(0.0, radius * around.cos(), radius * around.sin())
    })
}

/// The point of a Bézier curve, `part` of the way along.
fn along(points: &[(f64, f64)], part: f64) -> DVec2 {
    let mut points: Vec<DVec2> = points.iter().map(|&point| DVec2::from(point)).collect();
    while points.len() > 1 {
        points = points.windows(2).map(|pair| pair[0].lerp(pair[1], part)).collect();
    }
    points[0]
}
