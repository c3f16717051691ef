use glam::dvec3;

use super::*;
use crate::geometry::Sphere;
use crate::scene::{FaceId, Lens, Material, MaterialId, Part, Pigment, PrimitiveId};

/// Every key of the format.
const EVERYTHING: &str = include_str!("../format.toml");

fn scene(text: impl AsRef<str>) -> Result<Loaded, LoadError> {
    let a = b"v 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl red\nf 1 2 3\nmtllib a.mtl\n";
    let files: [(&str, &[u8]); 4] = [
        ("scenes/s.toml", text.as_ref().as_bytes()),
        ("scenes/parts/a.obj", a),
        ("scenes/parts/a.mtl", b"newmtl red\nKd 1 0 0\n"),
        ("scenes/parts/bad.obj", b"v 0 0 0\nf 1 1 2\n"),
    ];
    load_from(&files, "scenes/s.toml")
}

#[test]
fn every_key_reaches_the_scene() {
    let loaded = scene(EVERYTHING).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(warnings(&loaded), [""; 0]);
    let counts =
        crate::scene::Counts { vertices: 13, faces: 4, triangles: 5, zero_area: 0, spheres: 2 };
    assert_eq!(loaded.scene.counts(), counts);
    let scene = loaded.scene;
    let camera = Camera {
        eye: dvec3(0.0, 1.0, 5.0),
        look_at: DVec3::Y,
        up: dvec3(0.0, 2.0, 0.0),
        fov: 45.0,
        lens: Some(Lens { radius: 0.05, focus: 4.5 }),
    };
    assert_eq!(scene.camera, camera);
    assert_eq!((scene.ambient, scene.background), (Rgb::splat(0.1), Rgb::new(0.2, 0.3, 0.4)));
    let lights = [
        PointLight { position: dvec3(1.0, 4.0, 2.0), intensity: Rgb::new(10.0, 9.0, 8.5) },
        PointLight { position: dvec3(-1.0, 4.0, 2.0), intensity: Rgb::splat(3.0) },
    ];
    assert_eq!(scene.lights, lights);

    let black = Material::matte(Rgb::ZERO);
    let materials = [
        Material {
            rho_d: Pigment::Checker {
                even: Rgb::splat(0.9),
                odd: Rgb::new(0.1, 0.2, 0.3),
                side: 0.5,
            },
            ..black
        },
        Material {
            rho_d: Pigment::Solid(Rgb::splat(0.05)),
            rho_s: Rgb::splat(0.5),
            shininess: 80.0,
            k_s: Rgb::splat(0.1),
            k_t: Rgb::new(0.8, 0.7, 0.6),
            gloss: Some(300.0),
            refractive_index: 1.5,
            emission: Rgb::ZERO,
        },
        Material { emission: Rgb::new(5.0, 5.0, 4.0), ..black },
        Material::matte(Rgb::new(1.0, 0.0, 0.0)),
    ];
    assert_eq!(scene.materials, materials);
    assert_eq!(scene.mesh.faces.iter().map(|f| f.material.0).collect::<Vec<_>>(), [0, 2, 0, 3]);
    assert_eq!(scene.spheres[0].shape.center, DVec3::Y);
    assert_eq!((scene.spheres[0].shape.radius, scene.spheres[0].material), (1.0, MaterialId(1)));
    let lamps = scene.sphere_lights();
    let lamp = Sphere { center: dvec3(2.0, 3.0, 0.0), radius: 0.5 };
    assert_eq!((lamps.len(), lamps[0].sphere, lamps[0].shape), (1, 1, lamp));
    // The triangles 0 to 2 are those of the polygons.
    let [mesh, ball] = &scene.motions[..] else { panic!("two motions: {:?}", scene.motions) };
    assert_eq!(
        (mesh.displacement, ball.displacement),
        (dvec3(0.0, 0.75, 0.0), dvec3(0.25, 0.0, 0.125))
    );
    assert_eq!(
        (&mesh.parts[..], &ball.parts[..]),
        (&[Part::Triangles(3..4)][..], &[Part::Spheres(0..1)][..])
    );
    assert_eq!(scene.mesh.triangles.iter().filter(|t| t.face == FaceId(0)).count(), 2);
    assert!((area(&scene.mesh) - (16.0 + 0.5 + 1.5 + 0.75_f64.sqrt())).abs() < 1e-12);

    // x doubled; a quarter turn about x, then one about z; then one up z.
    let moved = [dvec3(0.0, 2.0, 1.0), dvec3(0.0, 0.0, 2.0), dvec3(1.0, 0.0, 1.0)];
    for (corner, expected) in scene.mesh.corners(3).into_iter().zip(moved) {
        assert!((corner - expected).length() < 1e-15, "{corner} for {expected}");
    }
    // The point reflection would turn the face inside out; its corners swap.
    assert_eq!(scene.mesh.corners(4), [-DVec3::X, -DVec3::Z, -DVec3::Y]);
}

#[test]
fn embedded_scenes_need_no_file() {
    let text = "ambient = 1\nmaterial.m.rho_d = 1\n\
                [[sphere]]\ncenter = [1, 2, 3]\nradius = 2\nmaterial = 'm'\n";
    let loaded = parse_scene(text, "embedded", Path::new("")).expect("fine");
    // Without a [camera] the scene is framed.
    let bounds = Sphere { center: dvec3(1.0, 2.0, 3.0), radius: 2.0 };
    assert_eq!(loaded.scene.bounding_sphere(), Some(bounds));
    assert_eq!(loaded.scene.camera, Camera::framing(bounds));
    assert_eq!(scene("\u{feff}".to_owned() + text).expect("fine").scene, loaded.scene);
}

/// Replaces one line of the good scene and expects the refusal at that line.
#[track_caller]
fn assert_line_refused(good: &str, bad: &str, problem_and_cure: &str) {
    let line = 1 + EVERYTHING.lines().position(|line| line == good).expect("a line of the scene");
    let text = EVERYTHING.replacen(&format!("\n{good}\n"), &format!("\n{bad}\n"), 1);
    assert_refused(scene(text), &format!("scenes/s.toml:{line}: {problem_and_cure}"));
}

#[test]
fn bad_values_are_refused_with_their_line() {
    let share = "it must be between 0 and 1";
    let lens = "its radius must be between 0 and 1e50";
    let focus = "the distance must be between 1e-50 and 1e50";
    let gloss = "it must be finite and positive; leave it out for a smooth surface";
    let finite = "coordinates must be finite and below 1e50";
    let positive = "it must be finite and positive";
    let radiance = "it must be between 0 and 1e30";
    let index = "it must be between 0.001 and 1000";
    let syntax = "correct the value or the syntax";
    let number = "write a number such as -1.5";
    let floor = "vertices = [[-2, 0, -2], [-2, 0, 2], [2, 0, 2], [2, 0, -2]]";
    for (good, bad, problem, cure) in [
        ("eye = [0, 1, 5]", "eye = [0, nan, 5]", "eye is [0.0, NaN, 5.0]", finite),
        (
            "look_at = [0, 1, 0]",
            "look_at = [0, 1, 5]",
            "look_at is the same point as eye",
            "move one of the two",
        ),
        (
            "up = [0, 2, 0]",
            "up = [0, 0, 1]",
            "up is zero or along the line of sight",
            "look another way or choose another `up`",
        ),
        (
            "up = [0, 2, 0]",
            "up = [0, 0, 0]",
            "up is zero or along the line of sight",
            "look another way or choose another `up`",
        ),
        ("fov = 45", "fov = 180", "fov is out of range", "it must be between 0 and 180 degrees"),
        ("fov = 45", "fov = 0", "fov is out of range", "it must be between 0 and 180 degrees"),
        ("fov = 45", "fov = nan", "fov is out of range", "it must be between 0 and 180 degrees"),
        ("position = [1, 4, 2]", "position = [1, inf, 2]", "position is [1.0, inf, 2.0]", finite),
        ("intensity = 3", "intensity = -3", "intensity is -3.0", radiance),
        ("intensity = 3", "intensity = 'red'", "expected a number or an array of three", syntax),
        (
            "intensity = 3",
            "intensity = ",
            "string values must be quoted, expected literal string",
            syntax,
        ),
        ("intensity = 3", "position = [1, 2, 3]", "duplicate key", syntax),
        (
            "eye = [0, 1, 5]",
            "eye = [0, 1]",
            "invalid length 2, expected an array of length 3",
            syntax,
        ),
        (
            "shininess = 80",
            "shininess = inf",
            "shininess is inf",
            "it must be finite and not negative",
        ),
        ("k_s = 0.1", "k_s = 1.1", "k_s is 1.1", share),
        ("rho_d = 0.05", "rho_d = [0, 0, -1]", "rho_d is -1.0", share),
        ("refractive_index = 1.5", "refractive_index = 0", "refractive_index is 0.0", index),
        ("emission = [5, 5, 4]", "emission = [5, 5, inf]", "emission is inf", radiance),
        ("radius = 1", "radius = 0", "radius is 0.0", positive),
        ("radius = 1", "radius = -1", "radius is -1.0", positive),
        ("radius = 1", "radius = true", "invalid type: boolean `true`, expected f64", number),
        ("radius = 1", "radius = [1]", "invalid type: sequence, expected f64", number),
        ("radius = 1", "radius = '1'", "invalid type: string \"1\", expected f64", number),
        (
            "material = 'glass'",
            "material = 1",
            "invalid type: integer `1`, expected a string",
            syntax,
        ),
        ("radius = 1", "radius = 1e60", "center + radius is [1e60, 1e60, 1e60]", finite),
        (
            "scale = -1",
            "scale = [1, 0, 1]",
            "scale is [1.0, 0.0, 1.0]",
            "it must be finite and not zero",
        ),
        (
            "translate = [0, 0, 1]",
            "translate = [nan, 0, 1]",
            "translate is [NaN, 0.0, 1.0]",
            finite,
        ),
        (
            floor,
            "vertices = [[0, 0, 0], [1, 0, 0]]",
            "a polygon with 2 corners",
            "give it at least 3",
        ),
        (
            floor,
            "vertices = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]",
            "the polygon has no area",
            "give it 3 corners that are not on one line",
        ),
        (
            floor,
            "vertices = [[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]]",
            "the polygon crosses itself",
            "order the vertices along its border",
        ),
        (
            floor,
            "vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 1], [0, 1, 0]]",
            "the polygon is not planar",
            "split it into triangles",
        ),
        ("lens = 0.05", "lens = -0.05", "lens is out of range", lens),
        ("lens = 0.05", "lens = nan", "lens is out of range", lens),
        ("lens = 0.05", "lens = 1e51", "lens is out of range", lens),
        ("focus = 4.5", "focus = 0", "focus is out of range", focus),
        ("focus = 4.5", "focus = -4.5", "focus is out of range", focus),
        ("focus = 4.5", "focus = nan", "focus is out of range", focus),
        ("gloss = 300", "gloss = 0", "gloss is 0.0", gloss),
        ("gloss = 300", "gloss = -1", "gloss is -1.0", gloss),
        ("gloss = 300", "gloss = inf", "gloss is inf", gloss),
        ("move = [0, 0.75, 0]", "move = [0, nan, 0]", "move is [0.0, NaN, 0.0]", finite),
        ("move = [0, 0.75, 0]", "move = [0, 1e51, 0]", "move is [0.0, 1e51, 0.0]", finite),
        (
            "move = [0, 0.75, 0]",
            "move = 1",
            "invalid type: integer `1`, expected an array of length 3",
            syntax,
        ),
        (
            "material = 'floor'",
            "move = [1, 0, 0]\nmaterial = 'floor'",
            "unknown field `move`, expected `vertices` or `material`",
            "the known ones are material, vertices",
        ),
        (
            "material = 'glass'",
            "material = 'glas'",
            "unknown material `glas`",
            "the known ones are glass, lamp, floor",
        ),
        (
            "scale = -1",
            "scales = -1",
            "unknown field `scales`",
            "the known ones are scale, rotate, move, obj, material, translate",
        ),
        (
            "[material.lamp]",
            "[materials.lamp]",
            "unknown field `materials`",
            "the known ones are material, camera, ambient, sphere, mesh, background, light, polygon",
        ),
    ] {
        assert_line_refused(good, bad, &format!("{problem}; {cure}"));
    }
}

/// Wherever the format has a number, what is not one or not finite is refused at its line.
#[test]
fn every_number_must_be_finite() {
    let mut tried = 0;
    for (i, line) in EVERYTHING.lines().enumerate() {
        if line.starts_with('#') || !line.contains(" = ") {
            continue;
        }
        for (at, _) in line.match_indices(|c: char| c.is_ascii_digit()) {
            if line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '.') {
                continue;
            }
            let length = line[at..].find(|c: char| !c.is_ascii_digit() && c != '.');
            let rest = &line[length.map_or(line.len(), |length| at + length)..];
            for bad in ["nan", "inf", "1e400", "''", "true", "[[]]"] {
                // A minus before the number is kept: -nan and -inf are numbers of TOML.
                let changed = format!("{}{bad}{rest}", &line[..at]);
                let text =
                    EVERYTHING.replacen(&format!("\n{line}\n"), &format!("\n{changed}\n"), 1);
                let message = scene(&text).expect_err(&changed).to_string();
                let place = format!("scenes/s.toml:{}: ", i + 1);
                assert!(message.starts_with(&place), "{changed}: {message}");
                tried += 1;
            }
        }
    }
    assert!(tried > 300, "{tried}");
}

#[test]
fn text_that_is_not_utf_8_is_refused_with_its_line() {
    let text = b"ambient = 1\n# caf\xE9\n";
    assert_refused(
        load_from(&[("s.toml", text)], "s.toml"),
        "s.toml:2: the text is not UTF-8; save the file as UTF-8",
    );
}

/// A lens and its focus belong together; the one that is there is named.
#[test]
fn a_lens_has_a_focus() {
    let camera = |keys: &str| {
        scene(format!("[camera]\neye = [0, 0, 1]\nlook_at = [0, 0, 0]\nfov = 40\n{keys}\n{BALL}"))
    };
    assert_refused(
        camera("lens = 0.1"),
        "scenes/s.toml:5: a lens without focus; \
         add `focus`, the distance of what is sharp along the view axis",
    );
    assert_refused(
        camera("focus = 2"),
        "scenes/s.toml:5: a focus without lens; \
         add `lens`, its radius; without one everything is sharp",
    );
    let lens = |keys: &str| camera(keys).expect("fine").scene.camera.lens;
    assert_eq!(lens(""), None);
    assert_eq!(lens("focus = 2\nlens = 0"), Some(Lens { radius: 0.0, focus: 2.0 }));
}

/// What moves stays where coordinates are.
#[test]
fn moves_end_in_space() {
    let far = BALL.replace("center = [0, 0, 0]", "center = [9e49, 0, 0]\nmove = [9e49, 0, 0]");
    assert_refused(
        scene(far),
        "scenes/s.toml:8: the place after the move is [1.8e50, -1.0, -1.0]; \
         coordinates must be finite and below 1e50",
    );
}

const BALL: &str = "[[light]]\nposition = [0, 9, 0]\nintensity = 9\n[material.m]\nrho_d = 1\n\
                    [[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'm'\n";

/// What goes the same way moves together; what goes nowhere stands still.
#[test]
fn moves_are_gathered() {
    let ball = |way: &str| {
        let ball = BALL.split_once("[[sphere]]").expect("a sphere").1;
        format!("[[sphere]]{ball}{way}\n")
    };
    let text = format!(
        "{BALL}{}{}{}{}",
        ball("move = [1, 0, 0]"),
        ball("move = [0, 0, 0]"),
        ball("move = [0, 1, 0]"),
        ball("move = [1, 0, 0]"),
    );
    let scene = scene(&text).expect("fine").scene;
    let seen: Vec<_> = scene.moving().map(|(way, ids)| (way, ids.iter().collect())).collect();
    let ids = |numbers: &[u32]| numbers.iter().map(|&id| PrimitiveId(id)).collect::<Vec<_>>();
    assert_eq!(seen, [(DVec3::X, ids(&[1, 4])), (DVec3::Y, ids(&[3]))]);
    assert_eq!(scene.still().iter().collect::<Vec<_>>(), ids(&[0, 2]));
}

#[test]
fn missing_keys_are_named() {
    let text = "[camera]\neye = [0, 0, 1]\n[[sphere]]\ncenter = [0, 0, 0]\n";
    assert_refused(scene(text), "scenes/s.toml:1: missing field `look_at`; add it");
    assert_refused(
        scene("ambient = 1\n[light]\nposition = [0, 0, 0]\nintensity = 1\n"),
        "scenes/s.toml:2: invalid type: map, expected a sequence; \
         there may be several: write its name in double brackets, such as [[light]]",
    );
}

#[test]
fn meshes_are_refused_where_they_are_named() {
    let good = "obj = 'parts/a.obj'";
    let cure = "mesh files are looked for from the scene's folder";
    let missing = "obj `parts/b.obj`: entity not found";
    assert_line_refused(good, "obj = 'parts/b.obj'", &format!("{missing}; {cure}"));
    for outside in OUTSIDE {
        let problem = format!("obj {}", is_outside(outside));
        assert_line_refused(good, &format!("obj = '{outside}'"), &problem);
    }
    // Written on Windows.
    let loaded = scene(EVERYTHING.replace("parts/a.obj", "parts\\a.obj")).expect("fine");
    assert_eq!(loaded.scene.counts().faces, 4);
    assert_refused(
        scene(EVERYTHING.replace("parts/a.obj", "parts/bad.obj")),
        "scenes/parts/bad.obj:2: the face names number 2 of 1 vertices; \
         count from 1, or back from -1 for the latest",
    );
}

#[test]
fn empty_and_dark_scenes() {
    assert_refused(
        scene("ambient = 1"),
        "scenes/s.toml: nothing to draw; add a [[sphere]], [[mesh]] or [[polygon]]",
    );
    let dark = "[[polygon]]\nmaterial = 'm'\nvertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\n\
                [material.m]\nrho_d = 0.5\n";
    let no_light = "scenes/s.toml: no light: the picture will be black; \
                    add a [[light]], a material with emission or an ambient";
    assert_eq!(warnings(&scene(dark).expect("fine")), [no_light]);
    for light in ["emission = 1", "[[light]]\nposition = [0, 0, 1]\nintensity = 1"] {
        assert_eq!(warnings(&scene(format!("{dark}{light}")).expect("fine")), [""; 0]);
    }
    let nameless = dark.replace("[material.m]\nrho_d = 0.5\n", "");
    assert_refused(
        scene(nameless),
        "scenes/s.toml:2: unknown material `m`; no such name is defined",
    );
}

/// Sums by hand: 0.5 + 2 · 0.6/(3 + 1) + 0.2 + 0.1 = 1.1 in red alone, and 1.0099 or a mirror of 1 is silent.
#[test]
fn a_material_that_amplifies_is_warned_of_once() {
    let warnings = |materials: &str| {
        let text = format!(
            "ambient = 1\n{materials}\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'a'\n"
        );
        let loaded = parse_scene(&text, "test", Path::new("")).unwrap();
        loaded.warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    let loud =
        "[material.a]\nrho_d = [0.5, 0.2, 0.2]\nrho_s = 0.6\nshininess = 3\nk_s = 0.2\nk_t = 0.1\n";
    let expected = "test: material `a` sends back 1.10 times the light that it receives, by ρ_d + 2 ρ_s/(n + 1) + k_s \
                    + k_t; keep the sum at 1 or below";
    assert_eq!(warnings(loud), expected);
    let two =
        format!("{loud}[material.b]\nrho_d = {{ checker = [0.1, 0.9], side = 1 }}\nk_s = 0.2\n");
    assert_eq!(warnings(&two), format!("{expected} (2 times, this is the first)"));
    for silent in
        ["rho_d = 0.5099\nk_t = 0.5", "k_s = 1", "rho_d = 1", "k_s = 0.1\nk_t = 0.9\nrho_d = 0"]
    {
        assert_eq!(warnings(&format!("[material.a]\n{silent}\n")), "", "{silent}");
    }
}
