//! Refracting surfaces that are open, of mixed winding or inside out are warned of, with their edges.

use std::fmt::Write;

use super::super::closed::Flaws;
use super::super::{closed, inside_out};
use super::*;

/// Triangles of a box, counter-clockwise seen from outside.
const BOX: [[usize; 3]; 12] = [
    [0, 2, 1],
    [1, 2, 3],
    [4, 5, 6],
    [5, 7, 6],
    [0, 1, 4],
    [1, 5, 4],
    [2, 6, 3],
    [3, 6, 7],
    [0, 4, 2],
    [2, 4, 6],
    [1, 3, 5],
    [3, 7, 5],
];

/// The corner positions of each triangle of a box between these corners.
fn cuboid(min: f64, max: f64) -> Vec<[DVec3; 3]> {
    let corner = |i: usize| {
        let of = |bit| if i & bit != 0 { max } else { min };
        DVec3::new(of(1), of(2), of(4))
    };
    BOX.iter().map(|triangle| triangle.map(corner)).collect()
}

fn turned(triangles: &[[DVec3; 3]]) -> Vec<[DVec3; 3]> {
    triangles.iter().map(|[a, b, c]| [*a, *c, *b]).collect()
}

/// Each triangle with vertices of its own, as exporters split them.
fn text(triangles: &[[DVec3; 3]]) -> String {
    let mut text = String::new();
    for corner in triangles.iter().flatten() {
        writeln!(text, "v {} {} {}", corner.x, corner.y, corner.z).unwrap();
    }
    for first in (1..).step_by(3).take(triangles.len()) {
        writeln!(text, "f {first} {} {}", first + 1, first + 2).unwrap();
    }
    text
}

const GLASS: &str = "newmtl glass\nillum 7\nNi 1.5\nKd 0\nTf 0.9\n";

fn found_in(library: &str, parts: &[(&str, Vec<[DVec3; 3]>)]) -> Vec<String> {
    let mut model = "mtllib a.mtl\n".to_owned();
    let all: Vec<[DVec3; 3]> = parts.iter().flat_map(|(_, triangles)| triangles.clone()).collect();
    let lines = text(&all);
    let (vertices, faces): (Vec<&str>, Vec<&str>) = lines.lines().partition(|l| l.starts_with('v'));
    let mut faces = faces.into_iter();
    model += &vertices.join("\n");
    for (material, triangles) in parts {
        write!(model, "\nusemtl {material}\n").unwrap();
        let of_part: Vec<&str> = faces.by_ref().take(triangles.len()).collect();
        model += &of_part.join("\n");
    }
    let files: [(&str, &[u8]); 2] = [("a.obj", model.as_bytes()), ("a.mtl", library.as_bytes())];
    warnings(&load_from(&files, "a.obj").expect("fine"))
}

fn found(triangles: Vec<[DVec3; 3]>) -> Vec<String> {
    found_in(GLASS, &[("glass", triangles)])
}

fn open(material: &str, edges: usize) -> String {
    format!(
        "a.obj: the refracting surface `{material}` is open, at {edges} of its edges: what enters may never leave; \
         close it, or give it the refractive index 1"
    )
}

fn mixed(edges: usize) -> String {
    format!(
        "a.obj: the refracting surface `glass` exchanges inside and outside, at {edges} of its edges; \
         turn its faces counter-clockwise seen from outside"
    )
}

fn inside_out(edges: usize) -> String {
    format!(
        "a.obj: the refracting surface `glass` is inside out, at all of its {edges} edges; \
         turn its faces counter-clockwise seen from outside"
    )
}

#[test]
fn closed_surfaces_pass() {
    let cube = cuboid(-1.0, 1.0);
    let none: [String; 0] = [];
    assert_eq!(found(cube.clone()), none);
    // −0 is 0: the seam of a box at the origin.
    let mut at_origin = cuboid(0.0, 1.0);
    at_origin[0] =
        at_origin[0].map(|corner| DVec3::select(corner.cmpeq(DVec3::ZERO), -corner, corner));
    assert_eq!(found(at_origin), none);
    // Two that touch face to face, or side by side.
    let beside =
        |by: DVec3| cube.iter().map(|triangle| triangle.map(|p| p + by)).collect::<Vec<_>>();
    assert_eq!(found([cube.clone(), beside(2.0 * DVec3::X)].concat()), none);
    assert_eq!(found([cube.clone(), beside(DVec3::new(2.0, 2.0, 0.0))].concat()), none);
    // A triangle of no area sews an edge that is halved on one side.
    let mut halved = cube.clone();
    let [a, b, c] = halved.remove(0);
    let middle = (a + b) / 2.0;
    halved.extend([[a, middle, c], [middle, b, c], [a, b, middle]]);
    let zero_area = "a.obj:58: triangle of zero area (kept)";
    assert_eq!(found(halved.clone()), [zero_area]);
    halved.pop();
    assert_eq!(found(halved), [open("glass", 3)]);
    // Two materials that close each other.
    let tinted = GLASS.to_owned() + &GLASS.replace("glass", "tinted");
    let (front, back) = cube.split_at(5);
    assert_eq!(found_in(&tinted, &[("glass", front.to_vec()), ("tinted", back.to_vec())]), none);
}

#[test]
fn holes_in_glass_are_wound_the_other_way() {
    let none: [String; 0] = [];
    let outer = cuboid(-2.0, 2.0);
    let hole = turned(&cuboid(-1.0, 1.0));
    assert_eq!(found([hole.clone(), outer.clone()].concat()), none);
    // A ball of glass in the hole, and once more a hole in that.
    let ball = cuboid(-0.5, 0.5);
    let bubble = turned(&cuboid(-0.25, 0.25));
    assert_eq!(found([outer.clone(), hole.clone(), ball.clone(), bubble].concat()), none);
    assert_eq!(found([outer.clone(), hole.clone(), turned(&ball)].concat()), [inside_out(18)]);
    // Beside, above and around it, where no glass is.
    for (min, max) in [(2.5, 3.0), (-9.0, 9.0)] {
        let other = turned(&cuboid(min, max));
        assert_eq!(found([outer.clone(), other].concat()), [inside_out(18)]);
    }
    // In a sphere.
    let scene = |radius: f64| {
        let scene = format!(
            "ambient = 1\nmaterial.glass = {{ k_t = 0.9, refractive_index = 1.5 }}\n\
             [[mesh]]\nobj = 'a.obj'\nmaterial = 'glass'\n\
             [[sphere]]\ncenter = [0, 0, 0]\nradius = {radius:?}\nmaterial = 'glass'\n"
        );
        let model = text(&turned(&cuboid(-1.0, 1.0)));
        let files: [(&str, &[u8]); 2] = [("s.toml", scene.as_bytes()), ("a.obj", model.as_bytes())];
        warnings(&load_from(&files, "s.toml").expect("fine")).len()
    };
    assert_eq!((scene(3.0), scene(0.1)), (0, 1));
}

#[test]
fn flaws_are_counted_by_edges() {
    let cube = cuboid(-1.0, 1.0);
    // Without one triangle: its three sides. Without a face: its four.
    assert_eq!(found(cube[1..].to_vec()), [open("glass", 3)]);
    assert_eq!(found(cube[2..].to_vec()), [open("glass", 4)]);
    // A pane, in both senses, and one with a back.
    assert_eq!(found(cube[..2].to_vec()), [open("glass", 4)]);
    assert_eq!(found(turned(&cube[..2])), [open("glass", 4)]);
    // One triangle turned: its three sides run as its neighbours'.
    let one = [turned(&cube[..1]), cube[1..].to_vec()].concat();
    assert_eq!(found(one), [mixed(3)]);
    let both = [turned(&cube[..1]), cube[1..11].to_vec()].concat();
    assert_eq!(found(both), [open("glass", 3), mixed(3)]);
    assert_eq!(found(turned(&cube)), [inside_out(18)]);
    let two = [turned(&cube), turned(&cuboid(3.0, 4.0))].concat();
    assert_eq!(found(two), [inside_out(36) + " (2 times, this is the first)"]);
}

/// Only refraction asks which side is which.
#[test]
fn other_materials_may_be_open() {
    let pane = cuboid(-1.0, 1.0)[..2].to_vec();
    for library in
        ["newmtl m\nKd 0.5\n", "newmtl m\nd 0.5\n", "newmtl m\nillum 3\nKd 0.2\nKs 0.2\n"]
    {
        assert_eq!(found_in(library, &[("m", pane.clone())]), [""; 0], "{library}");
    }
    let both = GLASS.to_owned() + "newmtl m\nKd 0.5\n";
    let parts = [("m", pane.clone()), ("glass", turned(&pane)), ("glass", pane.clone())];
    assert_eq!(found_in(&both, &parts), [""; 0]);
    // An opaque face does not close glass.
    let cube = cuboid(-1.0, 1.0);
    let parts = [("m", cube[..2].to_vec()), ("glass", cube[2..].to_vec())];
    assert_eq!(found_in(&both, &parts), [open("glass", 4)]);
}

/// Many drops, half of them inside out, in less time than their square would take.
#[test]
fn many_surfaces_are_checked() {
    let drop = |i: usize| {
        let at = DVec3::new((i % 50) as f64, (i / 50 % 50) as f64, (i / 2500) as f64) * 2.0;
        let cube = cuboid(-0.5, 0.5).into_iter().map(|triangle| triangle.map(|p| p + at));
        let cube: Vec<[DVec3; 3]> = cube.collect();
        if i.is_multiple_of(2) { cube } else { turned(&cube) }
    };
    let count = 20_000;
    let flaws = flaws_of_glass((0..count).flat_map(drop));
    assert_eq!((flaws.inside_out, flaws.inside_out_edges), (count / 2, 18 * count / 2));
    assert_eq!((flaws.open, flaws.mixed), (0, 0));
}

fn flaws_of_glass(triangles: impl Iterator<Item = [DVec3; 3]>) -> Flaws {
    let mut mesh = Mesh::default();
    for triangle in triangles {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(triangle);
        mesh.push_face(crate::scene::MaterialId(0), &[[first, first + 1, first + 2]]);
    }
    let mut scene = Scene::of_mesh(mesh);
    scene.materials[0].k_t = Rgb::ONE;
    scene.materials[0].refractive_index = 1.5;
    let [(_, flaws)] = closed::flaws(&scene)[..] else { panic!("one material") };
    flaws
}

/// Parallel needles, each as long as all of them lie apart: the boxes around them all overlap. Only within the
/// budget are they judged, and four triangles by 20,000 needles are twelve times as much.
#[test]
fn parallel_needles_are_judged() {
    let count = 20_000;
    assert!(4 * count * count > 11 * inside_out::BUDGET);
    for along in [DVec3::new(1.0, -0.7, 0.4), DVec3::X, DVec3::new(1.0, 1.0, 1.0)] {
        let [u, v] = <[DVec3; 2]>::from(along.normalize().any_orthonormal_pair());
        let needle = |i: usize| {
            let tip = 0.01 * ((i % 141) as f64 * u + (i / 141) as f64 * v);
            let corner = [tip, tip + 10.0 * along, tip + 0.004 * u, tip + 0.004 * v];
            let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
            let volume = (corner[1] - tip).dot((corner[2] - tip).cross(corner[3] - tip));
            let outwards = faces.map(|face: [usize; 3]| face.map(|k| corner[k])).to_vec();
            if volume > 0.0 { turned(&outwards) } else { outwards }
        };
        let flaws = flaws_of_glass((0..count).flat_map(needle));
        let expected = Flaws { inside_out: count, inside_out_edges: 6 * count, ..Flaws::default() };
        assert_eq!(flaws, expected, "{along}");
    }
}

#[test]
fn beyond_the_budget_no_surface_is_judged() {
    let cubes = [turned(&cuboid(-1.0, 1.0)), turned(&cuboid(3.0, 4.0))].concat();
    let roots: Vec<u32> = (0..24).map(|triangle| triangle / 12 * 12).collect();
    let judged = |budget| inside_out::inside_out(&cubes, &roots, &[true; 24], &[], budget);
    assert_eq!(judged(20), []);
    let mut found = judged(1000);
    found.sort_unstable();
    assert_eq!(found, [(0, 12), (12, 12)]);
}

/// A glass with water in it, and each two of water, glass and air with one surface between them: where all three
/// meet, three triangles have an edge in common.
#[test]
fn three_spaces_may_meet() {
    let ring = |half: f64, z: f64| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| DVec3::new(half * x, half * y, z))
    };
    let square = |[a, b, c, d]: [DVec3; 4]| vec![[a, b, c], [a, c, d]];
    // Between two rings; of a cylinder, seen from outside, if the second is above the first.
    let band = |low: [DVec3; 4], high: [DVec3; 4]| -> Vec<[DVec3; 3]> {
        (0..4)
            .flat_map(|i| square([low[i], low[(i + 1) % 4], high[(i + 1) % 4], high[i]]))
            .collect()
    };
    let (floor, level, rim) = (ring(1.0, 1.0), ring(1.0, 3.0), ring(1.0, 4.0));
    let glass = [
        turned(&square(ring(2.0, 0.0))),
        band(ring(2.0, 0.0), ring(2.0, 4.0)),
        band(ring(2.0, 4.0), rim),
        band(rim, level),
    ]
    .concat();
    let water = square(level);
    let between = [turned(&square(floor)), band(floor, level)].concat();
    let [water_in_air, water_in_glass] = [("water", "1.33"), ("between", "0.887")]
        .map(|(name, index)| GLASS.replace("glass", name).replace("1.5", index));
    let library = GLASS.to_owned() + &water_in_air + &water_in_glass;
    let found = |parts: &[(&str, Vec<[DVec3; 3]>)]| found_in(&library, parts);
    let all = [("glass", glass), ("water", water), ("between", between)];
    let none: [String; 0] = [];
    assert_eq!(found(&all), none);
    // A bubble in the water.
    let at = 2.0 * DVec3::Z;
    let bubble = turned(&cuboid(-0.1, 0.1)).into_iter().map(|triangle| triangle.map(|p| p + at));
    let with_bubble = [&all[..], &[("water", bubble.collect())]].concat();
    assert_eq!(found(&with_bubble), none);
    // Half of the water's surface, and nothing below the water: borders of one material.
    let mut torn = all.clone();
    torn[1].1.pop();
    assert!(found(&torn).contains(&open("water", 1)));
    let mut torn = all.clone();
    torn[2].1.drain(..2);
    assert_eq!(found(&torn), [open("between", 4)]);
    // Three triangles of one material are no joint.
    let fin = vec![[glass_corner(), DVec3::new(2.0, -2.0, 0.0), DVec3::new(0.0, -5.0, 0.0)]];
    let finned = [&all[..], &[("glass", fin)]].concat();
    assert_eq!(found(&finned), [open("glass", 3)]);
}

/// Of the glass of [`three_spaces_may_meet`].
fn glass_corner() -> DVec3 {
    DVec3::new(-2.0, -2.0, 0.0)
}
