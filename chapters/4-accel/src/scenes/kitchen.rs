//! A kitchen, in metres: cupboards along two walls, a table with chairs at odd angles, pots, plates and handles.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DAffine3, DQuat, DVec3};
use lancer_core::sampling::Uniform;
use lancer_core::scene::Mesh;

use super::refined;
use super::shapes::{
    ball, placed, post, push_cuboid, push_moulding, push_panel, push_quad, revolved, rod, sheet,
    surface, teapot, tube,
};

/// In a corner, at a man's height.
pub const EYE: DVec3 = DVec3::new(4.5, 1.6, 3.4);
/// Over the table.
pub const LOOK_AT: DVec3 = DVec3::new(1.9, 0.95, 1.0);

/// The room's width, height and depth.
const ROOM: [f64; 3] = [5.0, 2.6, 4.0];
/// A cupboard's width.
const UNIT: f64 = 0.6;
/// The worktop's height.
const TOP: f64 = 0.9;
/// Rims of a door's frame and raised panel, and of a tile.
const DOOR: [(f64, f64); 8] = [
    (0.0, 0.0),
    (0.0, 0.016),
    (0.003, 0.019),
    (0.06, 0.019),
    (0.064, 0.012),
    (0.072, 0.01),
    (0.095, 0.01),
    (0.11, 0.017),
];
const TILE: [(f64, f64); 3] = [(0.0, 0.0), (0.0, 0.004), (0.002, 0.005)];

/// A mesh of about `count` triangles, of some 14,000 at least.
pub fn kitchen(count: u32) -> Mesh {
    refined(count, furnished)
}

fn furnished(detail: f64) -> Mesh {
    let mut mesh = Mesh::default();
    room(&mut mesh);
    window(&mut mesh, detail);
    let mut add = |part: &Mesh, place, turn| mesh.append(part, placed(place, turn), 0);
    add(&base_cupboards(detail, 7), [0.02, 0.0, 0.005], 0.0);
    add(&base_cupboards(detail, 4), [0.005, 0.0, 3.05], FRAC_PI_2);
    add(&wall_cupboards(detail, 7), [0.02, 1.42, 0.03], 0.0);
    add(&wall_cupboards(detail, 4), [0.03, 1.42, 3.05], FRAC_PI_2);
    add(&stove(detail), [2.12, TOP, 0.3], 0.0);
    add(&sink(detail), [0.3, TOP, 1.85], FRAC_PI_2);
    add(&fridge(detail), [4.3, 0.0, 0.03], 0.0);
    add(&lamp(detail), [2.6, 0.0, 2.35], 0.0);
    add(&teapot_at(detail, 0.11), [1.15, TOP, 0.35], 2.2);
    for k in 0..7 {
        add(&jar(detail, 0.07 + 0.005 * f64::from(k)), [3.15 + 0.13 * f64::from(k), TOP, 0.2], 0.0);
    }
    laid_table(&mut mesh, detail);
    mesh
}

/// Boards, tiled and plain walls, a ceiling, skirting and cornice.
fn room(mesh: &mut Mesh) {
    let [w, h, d] = ROOM;
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    push_quad(mesh, [at(0., 0., 0.), at(0., 0., d), at(w, 0., d), at(w, 0., 0.)]);
    push_quad(mesh, [at(0., h, 0.), at(w, h, 0.), at(w, h, d), at(0., h, d)]);
    let corners = [at(0., 0., 0.), at(w, 0., 0.), at(w, 0., d), at(0., 0., d)];
    let (skirting, cornice) = (
        [(0.0, 0.09), (0.01, 0.09), (0.016, 0.07), (0.016, 0.0)],
        [(0.0, -0.1), (0.01, -0.1), (0.02, -0.07), (0.06, -0.03), (0.09, -0.02), (0.09, 0.0)],
    );
    for k in 0..4 {
        let (from, to) = (corners[k], corners[(k + 1) % 4]);
        let (up, inwards) = (h * DVec3::Y, (to - from).normalize().cross(DVec3::Y));
        push_quad(mesh, [from, to, to + up, from + up]);
        push_moulding(mesh, [from, to], inwards, &skirting);
        push_moulding(mesh, [from + up, to + up], inwards, &cornice);
    }
    let mut random = Uniform::new(5, 0, 0);
    let rows = 28;
    let (width, rim) = (d / f64::from(rows), [(0.0, 0.0), (0.001, 0.004), (0.003, 0.005)]);
    for row in 0..rows {
        let mut x = 0.0;
        while x < w {
            let length = (0.6 + 2.2 * random.number()).min(w - x);
            let sides = [DVec3::Z * width, DVec3::X * length];
            push_panel(mesh, at(x, 0.0, f64::from(row) * width), sides, &rim);
            x += length;
        }
    }
    let tile = 0.13;
    for row in 0..4 {
        for column in 0..38 {
            let [a, b] = [column, row].map(|k| f64::from(k) * tile);
            let sides = [tile * DVec3::X, tile * DVec3::Y];
            if column < 32 {
                push_panel(mesh, at(0.02 + a, TOP + b, 0.0), sides, &TILE);
            }
            if column < 18 {
                let sides = [-tile * DVec3::Z, tile * DVec3::Y];
                push_panel(mesh, at(0.0, TOP + b, 3.0 - a), sides, &TILE);
            }
        }
    }
}

/// A window in the wall on the right, behind a blind, and a plant on its sill.
fn window(mesh: &mut Mesh, detail: f64) {
    let [w, ..] = ROOM;
    let sides = [DVec3::Z * 1.5, DVec3::Y * 1.3];
    let frame = [(0.0, 0.0), (0.0, 0.03), (0.01, 0.035), (0.06, 0.035), (0.07, 0.015)];
    push_panel(mesh, DVec3::new(w, 0.95, 1.0), sides, &frame);
    push_cuboid(mesh, [w - 0.25, 0.9, 0.9], [w - 0.001, 0.93, 2.6]);
    for k in 0..44 {
        let y = 1.0 + 0.028 * f64::from(k);
        let tilt = [DVec3::new(-0.012, 0.009, 0.0), DVec3::new(0.012, -0.009, 0.0)];
        let [low, high] = tilt.map(|to| DVec3::new(w - 0.06, y, 1.02) + to);
        let (long, thick) = (DVec3::Z * 1.46, DVec3::Y * 0.001);
        push_quad(mesh, [low, high, high + long, low + long]);
        push_quad(mesh, [low - thick, low + long - thick, high + long - thick, high - thick]);
    }
    for z in [1.2, 1.75, 2.3] {
        let cord = [0.97, 2.26].map(|y| DVec3::new(w - 0.073, y, z));
        mesh.append(&rod(4.0, cord, 0.001), DAffine3::IDENTITY, 0);
    }
    for (k, z) in [1.15, 1.7, 2.3].into_iter().enumerate() {
        let turn = f64::from(k as u32);
        mesh.append(&plant(detail, k as u32), placed([w - 0.14, 0.93, z], turn), 0);
    }
}

/// A pot with leaves.
fn plant(detail: f64, seed: u32) -> Mesh {
    let pot = [(0.0, 0.005), (0.09, 0.0), (0.05, 0.1), (0.1, 0.14), (0.0, 0.11), (0.0, 0.11)];
    let mut mesh = revolved(&pot, (7.0 * detail).round());
    for k in 0..26 {
        let mut random = Uniform::new(6, seed, k);
        let (around, rise) = (TAU * random.number(), 0.5 + 0.9 * random.number());
        let length = 0.1 + 0.12 * random.number();
        let leaf = sheet([2.0, (3.0 * detail).round()], |across, part| {
            // It widens, narrows, and bends over.
            let (half, bend) = (0.025 * (PI * part).sin(), rise - 1.7 * part * part);
            let side = 2.0 * across - 1.0;
            let fold = 0.3 * half * side.abs();
            DVec3::new(
                length * part * bend.cos(),
                0.11 + length * part * bend.sin() + fold,
                half * side,
            )
        });
        mesh.append(&leaf, DAffine3::from_rotation_y(around), 0);
    }
    mesh
}

/// A bow, the handle of a door, upright.
fn handle(detail: f64) -> Mesh {
    let bow = [(0.0, 0.0), (0.035, 0.0), (0.035, 0.13), (0.0, 0.13)];
    tube(&bow, [0.006, 0.006], (5.0 * detail).round())
}

/// A front with its handle: a door, opened on the left, or a drawer.
fn push_front(mesh: &mut Mesh, corner: DVec3, [width, height]: [f64; 2], handle: &Mesh) {
    push_panel(mesh, corner, [DVec3::X * width, DVec3::Y * height], &DOOR);
    let front = DVec3::Z * 0.017;
    let is_door = height > 0.4;
    // A drawer's lies across its middle.
    let (place, roll) = if is_door {
        (DVec3::new(width - 0.035, 0.6 * height, 0.0), 0.0)
    } else {
        (DVec3::new(0.5 * width + 0.065, 0.5 * height, 0.0), FRAC_PI_2)
    };
    let turn = DQuat::from_rotation_z(roll) * DQuat::from_rotation_y(-FRAC_PI_2);
    let place = corner + place + front;
    mesh.append(handle, DAffine3::from_rotation_translation(turn, place), 0);
}

/// Cupboards under a worktop, along +x from the origin, with their fronts towards +z.
fn base_cupboards(detail: f64, units: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let handle = handle(detail);
    let length = f64::from(units) * UNIT;
    push_cuboid(&mut mesh, [0.0, 0.0, 0.0], [length, 0.1, 0.5]);
    for unit in 0..units {
        let x = f64::from(unit) * UNIT;
        push_cuboid(&mut mesh, [x + 0.001, 0.1, 0.0], [x + UNIT - 0.001, 0.86, 0.56]);
        let at = |y: f64| DVec3::new(x + 0.003, y, 0.5601);
        let width = UNIT - 0.006;
        if unit % 3 == 1 {
            for (y, height) in [(0.105, 0.28), (0.39, 0.28), (0.675, 0.18)] {
                push_front(&mut mesh, at(y), [width, height], &handle);
            }
        } else {
            push_front(&mut mesh, at(0.105), [width, 0.75], &handle);
        }
    }
    // The worktop's edge is round.
    let cuts = (6.0 * detail).round().max(2.0) as u32;
    let edge = (0..=cuts).map(|k| {
        let around = PI * (f64::from(k) / f64::from(cuts) - 0.5);
        (0.6 + 0.02 * around.cos(), 0.88 + 0.02 * around.sin())
    });
    let profile: Vec<_> = [(0.0, 0.86)].into_iter().chain(edge).chain([(0.0, 0.9)]).collect();
    push_moulding(&mut mesh, [DVec3::ZERO, length * DVec3::X], DVec3::Z, &profile);
    for x in [0.0, length] {
        push_quad(
            &mut mesh,
            [(0.0, 0.86), (0.6, 0.86), (0.6, 0.9), (0.0, 0.9)].map(|(z, y)| DVec3::new(x, y, z)),
        );
    }
    mesh
}

/// Cupboards and open shelves on a wall, along +x, with a cornice.
fn wall_cupboards(detail: f64, units: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let handle = handle(detail);
    let [height, depth] = [0.75, 0.32];
    for unit in 0..units {
        let x = f64::from(unit) * UNIT;
        if unit == 3 && units > 4 {
            push_hood(&mut mesh, x);
        } else if unit % 3 == 1 {
            open_shelves(&mut mesh, detail, x, [height, depth], unit);
        } else {
            push_cuboid(&mut mesh, [x + 0.001, 0.0, 0.0], [x + UNIT - 0.001, height, depth]);
            let corner = DVec3::new(x + 0.003, 0.003, depth + 1e-4);
            push_front(&mut mesh, corner, [UNIT - 0.006, height - 0.006], &handle);
        }
    }
    let cornice = [
        (0.32, 0.0),
        (0.35, 0.0),
        (0.355, 0.02),
        (0.37, 0.03),
        (0.39, 0.05),
        (0.39, 0.06),
        (0.0, 0.06),
    ];
    let ends = [0.0, f64::from(units) * UNIT].map(|x| DVec3::new(x, height, 0.0));
    push_moulding(&mut mesh, ends, DVec3::Z, &cornice);
    mesh
}

/// A hood over the stove: a pyramid under a shaft.
fn push_hood(mesh: &mut Mesh, x: f64) {
    let ring = |inset: f64, depth: f64, y: f64| {
        let (left, right) = (x + inset, x + UNIT - inset);
        [(left, 0.0), (right, 0.0), (right, depth), (left, depth)].map(|(x, z)| DVec3::new(x, y, z))
    };
    let rings =
        [ring(0.0, 0.5, 0.2), ring(0.0, 0.5, 0.26), ring(0.18, 0.25, 0.5), ring(0.18, 0.25, 1.15)];
    for pair in rings.windows(2) {
        for k in 0..4 {
            let next = (k + 1) % 4;
            push_quad(mesh, [pair[0][k], pair[1][k], pair[1][next], pair[0][next]]);
        }
    }
    push_quad(mesh, rings[0]);
}

/// Two boards with plates, bowls and cups, between walls.
fn open_shelves(mesh: &mut Mesh, detail: f64, x: f64, [height, depth]: [f64; 2], seed: u32) {
    for y in [0.0, 0.36, height - 0.018] {
        push_cuboid(mesh, [x + 0.018, y, 0.0], [x + UNIT - 0.018, y + 0.018, depth]);
    }
    for side in [0.0, UNIT - 0.018] {
        push_cuboid(mesh, [x + side, 0.0, 0.0], [x + side + 0.018, height, depth]);
    }
    let mut random = Uniform::new(7, seed, 0);
    let (plate, bowl, cup) = (plate(detail), bowl(detail), cup(detail));
    for k in 0..6 {
        let y = 0.018 + 0.011 * f64::from(k);
        mesh.append(&plate, placed([x + 0.17, y, 0.16], TAU * random.number()), 0);
    }
    for k in 0..3 {
        let y = 0.02 + 0.04 * f64::from(k);
        mesh.append(&bowl, placed([x + 0.42, y, 0.16], TAU * random.number()), 0);
    }
    for k in 0..8 {
        let (a, b) = (f64::from(k % 4), f64::from(k / 4));
        let place = [x + 0.1 + 0.13 * a, 0.378, 0.09 + 0.13 * b];
        mesh.append(&cup, placed(place, TAU * random.number()), 0);
    }
}

fn plate(detail: f64) -> Mesh {
    let profile = [
        (0.0, 0.0),
        (0.1, 0.0),
        (0.1, 0.004),
        (0.16, 0.02),
        (0.1, 0.01),
        (0.09, 0.003),
        (0.0, 0.003),
    ];
    revolved(&profile, (6.0 * detail).round())
}

fn bowl(detail: f64) -> Mesh {
    let profile = [
        (0.0, 0.0),
        (0.12, 0.0),
        (0.1, 0.08),
        (0.11, 0.09),
        (0.1, 0.08),
        (0.1, 0.006),
        (0.0, 0.006),
    ];
    revolved(&profile, (6.0 * detail).round())
}

fn cup(detail: f64) -> Mesh {
    let profile = [
        (0.0, 0.0),
        (0.05, 0.0),
        (0.03, 0.07),
        (0.042, 0.09),
        (0.035, 0.1),
        (0.03, 0.004),
        (0.0, 0.004),
    ];
    let mut mesh = revolved(&profile, (5.0 * detail).round());
    let ear = [(0.025, 0.055), (0.065, 0.06), (0.06, 0.02), (0.028, 0.02)];
    mesh.append(&tube(&ear, [0.004, 0.004], (4.0 * detail).round()), DAffine3::IDENTITY, 0);
    mesh
}

fn jar(detail: f64, height: f64) -> Mesh {
    let mut mesh = post([12.0 * detail, 6.0 * detail].map(f64::round), height, |_, part| {
        0.05 * (1.0 - (2.0 * part - 1.0).powi(8)).max(0.0).powf(0.3)
    });
    let knob = ball((4.0 * detail).round(), DVec3::new(0.0, height + 0.01, 0.0), 0.015);
    mesh.append(&knob, DAffine3::IDENTITY, 0);
    mesh
}

fn teapot_at(detail: f64, size: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let pot = teapot((900.0 * detail * detail) as u32);
    mesh.append(&pot, DAffine3::from_scale(DVec3::splat(size)), 0);
    mesh
}

/// A saucepan with its lid and two ears.
fn saucepan(detail: f64) -> Mesh {
    let mut mesh =
        post(
            [16.0 * detail, 3.0].map(f64::round),
            0.13,
            |_, part| {
                if part == 0.0 { 0.0 } else { 0.11 }
            },
        );
    let lid = [(0.115, 0.13), (0.11, 0.155), (0.03, 0.165), (0.0, 0.165)];
    mesh.append(&revolved(&lid, (6.0 * detail).round()), DAffine3::IDENTITY, 0);
    let knob = ball((4.0 * detail).round(), DVec3::new(0.0, 0.175, 0.0), 0.016);
    mesh.append(&knob, DAffine3::IDENTITY, 0);
    let ear = tube(
        &[(0.0, -0.04), (0.05, -0.05), (0.05, 0.05), (0.0, 0.04)],
        [0.005, 0.005],
        (4.0 * detail).round(),
    );
    for turn in [0.0, PI] {
        // Ears lie level.
        let level = DAffine3::from_rotation_y(turn)
            * DAffine3::from_translation(DVec3::new(0.105, 0.1, 0.0))
            * DAffine3::from_rotation_x(FRAC_PI_2);
        mesh.append(&ear, level, 0);
    }
    mesh
}

/// A hob with four rings under grates, and pots on two of them.
fn stove(detail: f64) -> Mesh {
    let mut mesh = Mesh::default();
    push_cuboid(&mut mesh, [-0.28, 0.0, -0.24], [0.28, 0.012, 0.24]);
    let sides = (4.0 * detail).round().max(4.0);
    let ring = revolved(
        &[(0.075, 0.012), (0.08, 0.04), (0.05, 0.03), (0.0, 0.03)],
        (4.0 * detail).round(),
    );
    for (k, (x, z)) in
        [(-0.14, -0.11), (0.14, -0.11), (-0.14, 0.11), (0.14, 0.11)].into_iter().enumerate()
    {
        mesh.append(&ring, placed([x, 0.0, z], 0.0), 0);
        for spoke in 0..6 {
            let (sin, cos) = (f64::from(spoke) * TAU / 6.0).sin_cos();
            let at = |radius: f64| DVec3::new(x + radius * cos, 0.05, z + radius * sin);
            mesh.append(&rod(sides, [at(0.03), at(0.1)], 0.004), DAffine3::IDENTITY, 0);
            let foot = DVec3::new(0.0, -0.04, 0.0);
            mesh.append(&rod(sides, [at(0.1), at(0.1) + foot], 0.004), DAffine3::IDENTITY, 0);
        }
        if k % 3 == 0 {
            mesh.append(&saucepan(detail), placed([x, 0.054, z], 0.7 + k as f64), 0);
        }
    }
    mesh
}

/// A basin on the worktop, with its tap.
fn sink(detail: f64) -> Mesh {
    let basin = [
        (0.0, 0.01),
        (0.3, 0.0),
        (0.17, 0.14),
        (0.23, 0.13),
        (0.17, 0.13),
        (0.2, 0.02),
        (0.0, 0.015),
    ];
    let mut mesh = revolved(&basin, (12.0 * detail).round());
    let tap = tube(
        &[(-0.24, 0.0), (-0.24, 0.4), (-0.05, 0.42), (-0.06, 0.24)],
        [0.014, 0.01],
        (8.0 * detail).round(),
    );
    mesh.append(&tap, DAffine3::from_rotation_y(-FRAC_PI_2), 0);
    for side in [-1.0, 1.0] {
        let from = DVec3::new(0.07 * side, 0.03, -0.24);
        let tap = [from, from + DVec3::new(0.05 * side, 0.02, 0.02)];
        mesh.append(&rod((6.0 * detail).round(), tap, 0.01), DAffine3::IDENTITY, 0);
    }
    mesh
}

fn fridge(detail: f64) -> Mesh {
    let mut mesh = Mesh::default();
    push_cuboid(&mut mesh, [0.0, 0.03, 0.0], [0.62, 1.85, 0.6]);
    let rim = [(0.0, 0.0), (0.0, 0.03), (0.004, 0.038), (0.015, 0.042)];
    for (y, height) in [(0.04, 0.6), (0.66, 1.18)] {
        let sides = [DVec3::X * 0.616, DVec3::Y * height];
        push_panel(&mut mesh, DVec3::new(0.002, y, 0.602), sides, &rim);
        let bar = [0.1, 0.5].map(|part| DVec3::new(0.06, y + height * part, 0.69));
        mesh.append(&rod((6.0 * detail).round(), bar, 0.008), DAffine3::IDENTITY, 0);
    }
    mesh
}

/// A shade on a cable.
fn lamp(detail: f64) -> Mesh {
    let shade = [(0.02, 1.75), (0.05, 1.74), (0.1, 1.6), (0.28, 1.5), (0.23, 1.51), (0.0, 1.7)];
    let mut mesh = revolved(&shade, (10.0 * detail).round());
    let cable = [1.74, ROOM[1]].map(|y| DVec3::Y * y);
    mesh.append(&rod((5.0 * detail).round(), cable, 0.003), DAffine3::IDENTITY, 0);
    mesh.append(&ball((6.0 * detail).round(), DVec3::Y * 1.6, 0.035), DAffine3::IDENTITY, 0);
    mesh
}

/// A turned leg as high as `height`.
fn leg(detail: f64, height: f64, radius: f64) -> Mesh {
    post([8.0 * detail, 14.0 * detail].map(f64::round), height, |_, part| {
        radius * (0.75 + 0.25 * part + 0.2 * (24.0 * part).sin() * (PI * part).sin())
    })
}

/// A chair that looks along +x.
fn chair(detail: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let leg = leg(detail, 0.44, 0.02);
    for (x, z) in [(-0.17, -0.17), (0.17, -0.17), (0.17, 0.17), (-0.17, 0.17)] {
        mesh.append(&leg, placed([x, 0.0, z], 0.0), 0);
    }
    // The seat is hollow.
    let seat = |y: f64| {
        sheet([6.0 * detail, 6.0 * detail].map(f64::round), move |u, v| {
            let (x, z) = (2.0 * u - 1.0, 2.0 * v - 1.0);
            DVec3::new(0.21 * x, y - 0.008 * (1.0 - x * x) * (1.0 - z * z), 0.21 * z)
        })
    };
    mesh.append(&seat(0.45), DAffine3::IDENTITY, 0);
    push_cuboid(&mut mesh, [-0.21, 0.42, -0.21], [0.21, 0.4415, 0.21]);
    let sides = (5.0 * detail).round();
    for (a, b) in [
        ((-0.17, -0.17), (0.17, -0.17)),
        ((-0.17, 0.17), (0.17, 0.17)),
        ((0.0, -0.17), (0.0, 0.17)),
    ] {
        let bar = [a, b].map(|(x, z)| DVec3::new(x, 0.18, z));
        mesh.append(&rod(sides, bar, 0.01), DAffine3::IDENTITY, 0);
    }
    for k in 0..7 {
        let z = 0.06 * (f64::from(k) - 3.0);
        let spindle = [DVec3::new(-0.19, 0.44, 0.9 * z), DVec3::new(-0.27, 0.9, z)];
        let radius = if k % 6 == 0 { 0.013 } else { 0.007 };
        mesh.append(&rod(sides, spindle, radius), DAffine3::IDENTITY, 0);
    }
    let rail = surface([6.0, (10.0 * detail).round()], |turn, part| {
        let (sin, cos) = (turn * TAU).sin_cos();
        let (z, thick) = (0.44 * (part - 0.5), (1.0 - (2.0 * part - 1.0).powi(8)).sqrt());
        let (out, up) = (0.012 * thick * cos, 0.035 * thick * sin);
        DVec3::new(-0.25 - 0.4 * z * z + out, 0.91 + up, z)
    });
    mesh.append(&rail, DAffine3::IDENTITY, 0);
    mesh
}

/// The table and what stands on and around it.
fn laid_table(mesh: &mut Mesh, detail: f64) {
    let to_room = placed([2.6, 0.0, 2.35], 0.3);
    let mut table = Mesh::default();
    let leg = leg(detail, 0.7, 0.04);
    for (x, z) in [(-0.7, -0.35), (0.7, -0.35), (0.7, 0.35), (-0.7, 0.35)] {
        table.append(&leg, placed([x, 0.0, z], 0.0), 0);
    }
    push_cuboid(&mut table, [-0.72, 0.62, -0.37], [0.72, 0.7, 0.37]);
    for board in 0..6 {
        let z = 0.16 * f64::from(board) - 0.48;
        push_cuboid(&mut table, [-0.85, 0.701, z + 0.001], [0.85, 0.73, z + 0.159]);
    }
    let mut random = Uniform::new(8, 0, 0);
    let mut odd = |most: f64| most * (2.0 * random.number() - 1.0);
    let (chair, plate, cup) = (chair(detail), plate(detail), cup(detail));
    let seats = [
        (-0.45, 0.62, 1),
        (0.45, 0.62, 1),
        (-0.45, -0.62, -1),
        (0.45, -0.62, -1),
        (1.15, 0.0, 2),
        (-1.15, 0.0, 0),
    ];
    for (x, z, side) in seats {
        let inwards = FRAC_PI_2 * f64::from(side);
        table.append(&chair, placed([x + odd(0.08), 0.0, z + odd(0.08)], inwards + odd(0.5)), 0);
        let (px, pz) = (0.62 * x, if z == 0.0 { 0.0 } else { 0.29_f64.copysign(z) });
        table.append(&plate, placed([px, 0.73, pz], odd(PI)), 0);
        table.append(&cup, placed([px + 0.16, 0.73, pz * 0.7 + odd(0.03)], odd(PI)), 0);
        for (k, length) in [(-1.0, 0.21), (1.0, 0.19), (1.2, 0.17)] {
            let from = DVec3::new(px + 0.13 * k, 0.735, pz - 0.09);
            let along = DVec3::new(odd(0.03), 0.0, length);
            table.append(
                &rod((4.0 * detail).round(), [from, from + along], 0.003),
                DAffine3::IDENTITY,
                0,
            );
        }
    }
    table.append(
        &bowl(1.5 * detail),
        placed([0.0, 0.73, 0.0], 0.0) * DAffine3::from_scale(DVec3::splat(1.6)),
        0,
    );
    for k in 0..9 {
        let (sin, cos) = (f64::from(k) * TAU * 0.382).sin_cos();
        let radius = 0.09 * (f64::from(k) / 9.0).sqrt();
        let center = DVec3::new(radius * cos, 0.83 - 0.3 * radius, radius * sin);
        table.append(&ball((6.0 * detail).round(), center, 0.036), DAffine3::IDENTITY, 0);
    }
    // A saucer of peas.
    table.append(
        &plate,
        placed([0.3, 0.73, 0.05], 0.0) * DAffine3::from_scale(DVec3::splat(0.6)),
        0,
    );
    let pea = ball((3.0 * detail).round(), DVec3::ZERO, 0.0025);
    for k in 0..50 {
        let radius = 0.045 * (f64::from(k) / 50.0).sqrt();
        let (sin, cos) = (f64::from(k) * TAU * 0.382).sin_cos();
        table.append(&pea, placed([0.3 + radius * cos, 0.736, 0.05 + radius * sin], 0.0), 0);
    }
    mesh.append(&table, to_room, 0);
}
