//! A hall in metres, along x: a nave between two storeys of arches on fluted columns, aisles with galleries above,
//! an open roof, banners, curtains and plants.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DAffine3, DVec3};
use lancer_core::sampling::Uniform;
use lancer_core::scene::Mesh;

use super::refined;
use super::shapes::{
    ball, placed, post, push_cuboid, push_moulding, push_panel, push_quad, revolved, rod, sheet,
    tube,
};

/// In the nave, near one end.
pub const EYE: DVec3 = DVec3::new(1.5, 2.2, 1.6);
/// Up to the gallery, and to the other end.
pub const LOOK_AT: DVec3 = DVec3::new(11.0, 3.45, 0.1);

const LENGTH: f64 = 32.0;
/// From the middle to the walls.
const HALF_WIDTH: f64 = 8.0;
/// From the middle to the colonnades, and half of how thick they are.
const NAVE: f64 = 4.5;
const HALF_WALL: f64 = 0.35;
/// A bay's length, and the number of them.
const BAY: f64 = 4.0;
const BAYS: u32 = 8;
/// The floor of the gallery, and the walls' height.
const GALLERY: f64 = 6.2;
const EAVES: f64 = 11.4;
const RIDGE: f64 = 15.0;

/// A storey of the colonnades.
struct Storey {
    floor: f64,
    /// Where arches begin.
    springing: f64,
    top: f64,
    /// Of the columns.
    radius: f64,
}

const STOREYS: [Storey; 2] = [
    Storey { floor: 0.0, springing: 3.9, top: 5.9, radius: 0.34 },
    Storey { floor: GALLERY, springing: 9.1, top: EAVES, radius: 0.24 },
];

/// A mesh of about `count` triangles, of some 7,000 at least.
pub fn atrium(count: u32) -> Mesh {
    refined(count, furnished)
}

fn furnished(detail: f64) -> Mesh {
    let mut mesh = Mesh::default();
    shell(&mut mesh);
    roof(&mut mesh, detail);
    let side = colonnade(detail);
    for turn in [0.0, PI] {
        mesh.append(&side, placed([0.5 * LENGTH, 0.0, 0.0], turn), 0);
    }
    hangings(&mut mesh, detail);
    mesh.append(&fountain(detail), placed([17.0, 0.0, 0.0], 0.0), 0);
    let (plant, bench) = (plant(detail), bench(detail));
    for k in 0..8 {
        let mut random = Uniform::new(9, k, 0);
        let side = if k % 2 == 0 { 1.0 } else { -1.0 };
        let x = 4.0 * f64::from(k) + 2.0 + random.number();
        mesh.append(
            &plant,
            placed([x, 0.0, side * (3.3 + 0.5 * random.number())], TAU * random.number()),
            0,
        );
        let z = -side * (2.2 + 0.8 * random.number());
        mesh.append(&bench, placed([x + 1.0, 0.0, z], random.number() - 0.5), 0);
    }
    mesh
}

fn at(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Floor, outer walls with blind windows, gables, and steps at the far end.
fn shell(mesh: &mut Mesh) {
    let (l, w) = (LENGTH, HALF_WIDTH);
    push_quad(mesh, [at(0., 0., -w), at(0., 0., w), at(l, 0., w), at(l, 0., -w)]);
    let rim = [(0.0, 0.0), (0.002, 0.008), (0.01, 0.01)];
    // Slabs as long as the hall in the nave, across the aisles beside it.
    for k in 0..9 {
        let z = f64::from(k) - NAVE;
        push_panel(mesh, at(0.0, 0.0, z), [DVec3::Z, l * DVec3::X], &rim);
    }
    for k in 0..32 {
        for z in [-w, NAVE] {
            let sides = [(w - NAVE) * DVec3::Z, DVec3::X];
            push_panel(mesh, at(f64::from(k), 0.0, z), sides, &rim);
        }
    }
    let window = [(0.0, 0.0), (0.0, 0.1), (0.06, 0.14), (0.2, 0.14), (0.26, 0.06), (0.3, -0.12)];
    let cornice = [(0.0, -0.5), (0.1, -0.5), (0.15, -0.3), (0.35, -0.15), (0.4, 0.0), (0.0, 0.0)];
    for side in [1.0, -1.0] {
        let z = side * w;
        let (from, to) = (at(0.0, 0.0, z), at(l, 0.0, z));
        push_quad(mesh, [from, to, to + EAVES * DVec3::Y, from + EAVES * DVec3::Y]);
        for bay in 0..BAYS {
            let (x, along) = (BAY * (f64::from(bay) + 0.5), -side * 1.6 * DVec3::X);
            for (y, height) in [(1.2, 3.2), (GALLERY + 1.1, 2.6)] {
                let corner = at(x + 0.8 * side, y, z - 0.13 * side);
                push_panel(mesh, corner, [along, height * DVec3::Y], &window);
            }
        }
        for y in [GALLERY - 0.4, EAVES] {
            let ends = [from, to].map(|end| end + y * DVec3::Y);
            push_moulding(mesh, ends, -side * DVec3::Z, &cornice);
        }
    }
    for x in [0.0, l] {
        let (low, high) = (at(x, 0.0, -w), at(x, 0.0, w));
        push_quad(mesh, [low, high, high + EAVES * DVec3::Y, low + EAVES * DVec3::Y]);
        // They stick out above the roof, whose boards overlap.
        let gable =
            [at(x, EAVES - 0.1, -w - 0.3), at(x, EAVES - 0.1, w + 0.3), at(x, RIDGE + 0.2, 0.0)];
        push_quad(mesh, [gable[0], gable[1], gable[2], gable[2].lerp(gable[0], 0.5)]);
    }
    for step in 0..12 {
        let (k, depth) = (f64::from(step), 0.32);
        push_cuboid(mesh, [l - 4.0 + depth * k, 0.011, -3.0], [l, 0.17 * (k + 1.0), 3.0]);
    }
    let door = [(0.0, 0.0), (0.0, 0.1), (0.05, 0.15), (0.3, 0.15), (0.35, 0.1), (0.36, 0.02)];
    push_panel(mesh, at(l - 0.02, 2.05, -1.6), [3.2 * DVec3::Z, 3.6 * DVec3::Y], &door);
}

/// Purlins as long as the hall under boards, on rafters, and ties across it.
fn roof(mesh: &mut Mesh, detail: f64) {
    let slope = at(0.0, RIDGE - EAVES, -HALF_WIDTH);
    for side in [1.0, -1.0] {
        let up = at(0.0, slope.y, side * slope.z);
        let eave = at(0.0, EAVES, side * HALF_WIDTH);
        let boards = 24;
        for board in 0..boards {
            let [low, high] =
                [board, board + 1].map(|k| eave + up * (f64::from(k) / f64::from(boards)));
            let (long, lap) = (LENGTH * DVec3::X, 0.03 * DVec3::Y);
            push_quad(mesh, [low, low + long, high + long + lap, high + lap]);
            push_quad(mesh, [high, high + long, high + long + lap, high + lap]);
        }
        for purlin in 0..6 {
            let place = eave + up * (f64::from(purlin) + 0.5) / 6.0 - 0.12 * DVec3::Y;
            let (low, high) = (place - at(0.0, 0.1, 0.07), place + at(LENGTH, 0.1, 0.07));
            push_cuboid(mesh, low.to_array(), high.to_array());
        }
        for rafter in 0..=2 * BAYS {
            let x = (0.5 * BAY * f64::from(rafter)).clamp(0.15, LENGTH - 0.15);
            let (foot, head) = (eave + at(x, -0.35, 0.0), eave + up + at(x, -0.35, 0.0));
            mesh.append(&rod(4.0, [foot, head], 0.14), DAffine3::IDENTITY, 0);
        }
    }
    for bay in 1..BAYS {
        let x = BAY * f64::from(bay);
        push_cuboid(mesh, [x - 0.13, EAVES - 0.3, -HALF_WIDTH], [x + 0.13, EAVES, HALF_WIDTH]);
        push_cuboid(mesh, [x - 0.1, EAVES, -0.1], [x + 0.1, RIDGE - 0.3, 0.1]);
        for side in [1.0, -1.0] {
            let strut = [at(x, EAVES, 0.1 * side), at(x, 13.0, 4.0 * side)];
            mesh.append(&rod(4.0, strut, 0.1), DAffine3::IDENTITY, 0);
        }
        if bay % 2 == 1 {
            let chain = [at(x + 2.0, RIDGE - 0.5, 0.0), at(x + 2.0, 6.0, 0.0)];
            mesh.append(&rod(4.0, chain, 0.012), DAffine3::IDENTITY, 0);
            let bowl = [(0.0, 0.0), (0.6, 0.0), (0.5, 0.5), (0.45, 0.5), (0.05, 0.2), (0.0, 0.6)];
            mesh.append(
                &revolved(&bowl, (7.0 * detail).round()),
                placed(chain[1].to_array(), 0.0),
                0,
            );
        }
    }
}

/// One side of the nave at z = [`NAVE`], its middle at x = 0, with gallery and balustrade.
fn colonnade(detail: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let left = -0.5 * LENGTH;
    for storey in &STOREYS {
        let (column, arch) = (column(detail, storey), arch(detail, storey));
        for bay in 0..=BAYS {
            // Half of the columns at both ends stands in the wall.
            let x = left + BAY * f64::from(bay);
            mesh.append(&column, placed([x, storey.floor, NAVE], 0.0), 0);
            if bay < BAYS {
                mesh.append(&arch, placed([x + 0.5 * BAY, 0.0, NAVE], 0.0), 0);
            }
        }
    }
    let frieze = [
        (0.0, -0.35),
        (0.04, -0.35),
        (0.04, -0.2),
        (0.08, -0.18),
        (0.14, -0.1),
        (0.2, -0.05),
        (0.22, 0.0),
        (0.22, 0.05),
        (0.0, 0.08),
    ];
    for y in [5.75, EAVES] {
        for side in [-1.0, 1.0] {
            let z = NAVE + side * HALF_WALL;
            push_moulding(&mut mesh, [left, -left].map(|x| at(x, y, z)), side * DVec3::Z, &frieze);
        }
    }
    push_cuboid(&mut mesh, [left, 5.9, NAVE - 0.5], [-left, GALLERY, HALF_WIDTH]);
    let coffer = [(0.0, 0.0), (0.1, 0.0), (0.12, 0.03), (0.2, 0.03), (0.22, 0.12), (0.4, 0.12)];
    for bay in 0..BAYS {
        for half in [0.0, 0.5] {
            let corner = at(left + BAY * (f64::from(bay) + half) + 0.05, 5.895, 5.1);
            let sides = [DVec3::X * (0.5 * BAY - 0.1), DVec3::Z * 2.8];
            push_panel(&mut mesh, corner, sides, &coffer);
        }
    }
    balustrade(&mut mesh, detail, left);
    mesh
}

fn balustrade(mesh: &mut Mesh, detail: f64, left: f64) {
    let baluster = post([8.0 * detail, 8.0 * detail].map(f64::round), 0.74, |_, part| {
        let belly = (-(6.0 * (part - 0.3)).powi(2)).exp();
        0.028 + 0.05 * belly + 0.02 * (30.0 * part).cos().abs() * (part - 0.5).abs()
    });
    let z = NAVE - 0.3;
    for (low, high) in [(0.0, 0.12), (0.86, 0.98)] {
        push_cuboid(mesh, [left, GALLERY + low, z - 0.1], [-left, GALLERY + high, z + 0.1]);
    }
    for bay in 0..BAYS {
        for k in 0..7 {
            let x = left + BAY * f64::from(bay) + 0.65 + 0.45 * f64::from(k);
            mesh.append(&baluster, placed([x, GALLERY + 0.12, z], 0.0), 0);
        }
    }
}

/// A column on its plinth, with twenty flutes, up to the springing of the arches.
fn column(detail: f64, storey: &Storey) -> Mesh {
    let Storey { floor, springing, radius, .. } = *storey;
    let (height, r) = (springing - floor, radius);
    let mut mesh = Mesh::default();
    push_cuboid(&mut mesh, [-1.45 * r, 0.0, -1.45 * r], [1.45 * r, 0.5 * r, 1.45 * r]);
    let around = (20.0 * detail).round();
    let base = [
        (1.3 * r, 0.0),
        (1.6 * r, 0.2 * r),
        (1.0 * r, 0.4 * r),
        (1.5 * r, 0.5 * r),
        (0.97 * r, 0.6 * r),
    ];
    mesh.append(&revolved(&base, (0.4 * around).round()), placed([0.0, 0.5 * r, 0.0], 0.0), 0);
    let length = height - 2.1 * r;
    let shaft = post([2.0 * around, (5.0 * detail).round()], length, |around, part| {
        let flute = (10.0 * around).sin().abs();
        r * (1.0 - 0.12 * part * part) * (0.9 + 0.08 * flute)
    });
    mesh.append(&shaft, placed([0.0, 1.1 * r, 0.0], 0.0), 0);
    let bell = [(0.8 * r, 0.0), (0.95 * r, 0.5 * r), (0.9 * r, 0.5 * r), (1.5 * r, 0.8 * r)];
    mesh.append(&revolved(&bell, (0.4 * around).round()), placed([0.0, height - r, 0.0], 0.0), 0);
    push_cuboid(&mut mesh, [-1.4 * r, height - 0.25 * r, -1.4 * r], [1.4 * r, height, 1.4 * r]);
    mesh
}

/// The wall of one bay above its arch, around x = 0 and z = 0, and the moulding that follows the arch.
fn arch(detail: f64, storey: &Storey) -> Mesh {
    let Storey { springing, top, radius, .. } = *storey;
    let (half, cuts) = (0.5 * BAY, (14.0 * detail).round().max(2.0));
    let open = half - radius;
    let rise = open.min(top - 0.35 - springing);
    let turned = |part: f64, scale: f64| {
        let (sin, cos) = (PI * part).sin_cos();
        (-scale * open * cos, springing + scale * rise * sin)
    };
    let mut mesh = Mesh::default();
    for side in [-1.0, 1.0] {
        let z = side * HALF_WALL;
        let wall = sheet([cuts, 1.0], |across, down| {
            let (x, y) = turned(across, 1.0);
            // From the arch straight up: to the top of the wall as wide as the bay.
            let up = (x * half / open, top);
            at(x + (up.0 - x) * down, y + (up.1 - y) * down, z)
        });
        mesh.append(&wall, DAffine3::IDENTITY, 0);
        for end in [-1.0, 1.0] {
            let (inner, outer) = (end * open, end * half);
            push_quad(
                &mut mesh,
                [
                    at(inner, springing, z),
                    at(outer, springing, z),
                    at(outer, top, z),
                    at(inner, springing, z).lerp(at(outer, top, z), 0.5),
                ],
            );
        }
        let profile =
            [(1.0, 0.0), (1.0, 0.05), (1.06, 0.07), (1.08, 0.04), (1.14, 0.04), (1.16, 0.0)];
        let moulding = sheet([cuts, 5.0], |across, down| {
            let (scale, out) = profile[(5.0 * down).round() as usize];
            let (x, y) = turned(across, scale);
            at(x, y, z + side * out)
        });
        mesh.append(&moulding, DAffine3::IDENTITY, 0);
    }
    let soffit = sheet([cuts, 1.0], |across, down| {
        let (x, y) = turned(across, 1.0);
        at(x, y, (2.0 * down - 1.0) * HALF_WALL)
    });
    mesh.append(&soffit, DAffine3::IDENTITY, 0);
    mesh
}

/// Banners from the gallery's rail, and curtains drawn aside under some arches.
fn hangings(mesh: &mut Mesh, detail: f64) {
    for bay in 0..BAYS {
        let side = if bay % 2 == 0 { 1.0 } else { -1.0 };
        let x = BAY * (f64::from(bay) + 0.5);
        let phase = 1.7 * f64::from(bay);
        let z = side * (NAVE - 0.62);
        let banner = sheet([16.0 * detail, 30.0 * detail].map(f64::round), |across, down| {
            let swing = 0.09 * down * (5.0 * across + 7.0 * down + phase).sin();
            let fold = 0.03 * (19.0 * across + phase).sin() * (0.3 + down);
            at(
                x + 1.7 * (across - 0.5),
                GALLERY + 0.7 - 3.4 * down,
                z - side * (swing + fold + 0.1),
            )
        });
        mesh.append(&banner, DAffine3::IDENTITY, 0);
        let bead = ball((3.0 * detail).round(), DVec3::ZERO, 0.012);
        for k in 0..8 {
            let along = 1.9 * (f64::from(k) / 7.0 - 0.5);
            let place = [x + along, GALLERY + 0.665, z - 0.1 * side];
            mesh.append(&bead, placed(place, 0.0), 0);
        }
        let bar = [-1.0, 1.0].map(|end| at(x + end, GALLERY + 0.71, z - 0.1 * side));
        mesh.append(&rod((6.0 * detail).round(), bar, 0.03), DAffine3::IDENTITY, 0);
        if bay % 2 == 0 {
            continue;
        }
        for half in [-1.0, 1.0] {
            let curtain = sheet([26.0 * detail, 18.0 * detail].map(f64::round), |across, down| {
                // Gathered at two thirds of its height.
                let width = 1.5 - 0.95 * (PI * (down / 0.66).min(1.0) * 0.5).sin()
                    + 0.5 * (down - 0.66).max(0.0);
                let fold = 0.05 * (across * 15.0 * TAU * 0.5 + phase).sin();
                at(x + half * (1.6 - width * across), 3.9 - 3.85 * down, side * NAVE + fold)
            });
            mesh.append(&curtain, DAffine3::IDENTITY, 0);
        }
        let bar = [-1.7, 1.7].map(|end| at(x + end, 3.93, side * NAVE));
        mesh.append(&rod((6.0 * detail).round(), bar, 0.04), DAffine3::IDENTITY, 0);
    }
}

/// A pool, and two bowls above it on a stem.
fn fountain(detail: f64) -> Mesh {
    let pool = [(2.2, 0.0), (2.9, 0.2), (2.3, 0.8), (2.0, 0.8), (2.1, 0.2), (0.0, 0.15)];
    let mut mesh = revolved(&pool, (10.0 * detail).round());
    for (radius, foot) in [(1.3, 0.9), (0.7, 1.9)] {
        let bowl = [(0.15, 0.0), (1.0, 0.0), (1.0, 0.35), (0.95, 0.35), (0.9, 0.1), (0.1, 0.1)];
        let bowl = bowl.map(|(x, y)| (radius * x, foot + radius * y));
        mesh.append(&revolved(&bowl, (9.0 * detail).round()), DAffine3::IDENTITY, 0);
    }
    let stem = post([16.0 * detail, 20.0 * detail].map(f64::round), 2.6, |around, part| {
        0.22 - 0.12 * part + 0.03 * (8.0 * around).cos() + 0.03 * (20.0 * part).sin()
    });
    mesh.append(&stem, DAffine3::IDENTITY, 0);
    mesh
}

/// A small palm in a pot.
fn plant(detail: f64) -> Mesh {
    let pot = [(0.0, 0.01), (0.5, 0.0), (0.3, 0.3), (0.5, 0.6), (0.35, 0.6), (0.0, 0.45)];
    let mut mesh = revolved(&pot, (8.0 * detail).round());
    let stem = post([8.0 * detail, 3.0].map(f64::round), 1.3, |_, part| 0.06 - 0.03 * part);
    mesh.append(&stem, placed([0.0, 0.45, 0.0], 0.0), 0);
    for k in 0..70 {
        let mut random = Uniform::new(10, k, 0);
        let (around, rise) = (TAU * random.number(), 0.2 + 1.2 * random.number());
        let (length, foot) = (0.5 + 0.6 * random.number(), 1.2 + 0.55 * random.number());
        let leaf = sheet([2.0, (4.0 * detail).round()], |across, part| {
            let (half, bend) = (0.07 * (PI * part).sin(), rise - 1.6 * part * part);
            let side = 2.0 * across - 1.0;
            let y = foot + length * part * bend.sin() + 0.4 * half * side.abs();
            at(length * part * bend.cos(), y, half * side)
        });
        mesh.append(&leaf, DAffine3::from_rotation_y(around), 0);
    }
    mesh
}

fn bench(detail: f64) -> Mesh {
    let mut mesh = Mesh::default();
    for slat in 0..5 {
        let z = 0.1 * f64::from(slat) - 0.25;
        push_cuboid(&mut mesh, [-0.9, 0.42, z], [0.9, 0.45, z + 0.085]);
    }
    for x in [-0.75, 0.75] {
        for turn in [0.0, PI] {
            let curve = tube(
                &[(0.0, 0.43), (0.25, 0.4), (0.1, 0.2), (0.25, 0.02)],
                [0.025, 0.02],
                (5.0 * detail).round(),
            );
            mesh.append(&curve, placed([x, 0.0, 0.0], turn + FRAC_PI_2), 0);
        }
    }
    mesh
}
