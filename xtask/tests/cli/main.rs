//! The command line as a hostile user meets it: every refusal is one `error:` line that names the
//! file or flag and the cure, ends with a failure, and leaves all files as they were.

mod compare;
mod step;

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use insta::assert_snapshot;
use lancer_core::image::{Image, ImageSize, load};
use tempfile::{TempDir, tempdir};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const CORNER: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

fn command(folder: &TempDir, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
    command.current_dir(folder).args(arguments);
    command
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A folder with these files, and a picture to lose.
fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("old.png"), "old").unwrap();
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

/// All names in a folder, with their lengths.
fn contents(folder: &Path) -> Vec<(String, u64)> {
    let entries = folder.read_dir().unwrap().map(|entry| entry.unwrap());
    let name_and_length = |entry: fs::DirEntry| {
        (entry.file_name().into_string().unwrap(), entry.metadata().unwrap().len())
    };
    let mut found: Vec<_> = entries.map(name_and_length).collect();
    found.sort();
    found
}

/// Runs what must succeed.
fn accepted(folder: &TempDir, arguments: &[&str]) -> Output {
    let output = command(folder, arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    output
}

/// Runs what must be refused and returns the error.
fn refusal(folder: &TempDir, arguments: &[&str]) -> String {
    let before = contents(folder.path());
    let output = command(folder, arguments).output().unwrap();
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert!(matches!(output.status.code(), Some(1 | 2)), "{arguments:?}: {}\n{err}", output.status);
    assert!(!err.contains("panicked"), "{arguments:?}: {err}");
    assert!(!out.contains("picture"), "{arguments:?} looks like a success: {out}");
    assert_eq!(contents(folder.path()), before, "{arguments:?} left files");
    assert_eq!(fs::read(folder.path().join("old.png")).unwrap(), b"old", "{arguments:?}");
    // clap wraps nothing but puts lists of what is missing on lines of their own.
    let mut errors = err.split("\n\n").filter(|part| part.starts_with("error: "));
    let error = errors.next().unwrap_or_else(|| panic!("{arguments:?}: {err}"));
    assert_eq!(err.matches("error:").count(), 1, "{arguments:?}: {err}");
    error.trim_end().to_owned()
}

/// The refusals of many command lines, a line for each.
fn refusals<'a>(folder: &TempDir, lines: impl IntoIterator<Item = Vec<&'a str>>) -> String {
    lines.into_iter().map(|arguments| refusal(folder, &arguments) + "\n").collect()
}

#[test]
fn wrong_options_are_refused_with_a_cure() {
    let refused = |options: &[[&'static str; 2]]| {
        let line = |&[option, value]: &[&'static str; 2]| {
            let mut line = vec!["render", "whitted", "--out=old.png", option, value];
            line.extend((option != "--size").then_some("--size=8x8"));
            line
        };
        refusals(&folder(&[]), options.iter().map(line))
    };
    let sizes = ["0x0", "99999999x99999999", "abc", "-8x8"].map(|size| ["--size", size]);
    assert_snapshot!(refused(&sizes), @r"
    error: invalid value '0x0' for '--size <WxH>': a picture of 0x0 has no pixel: both numbers must be at least 1
    error: invalid value '99999999x99999999' for '--size <WxH>': a picture of 99999999x99999999 is too large: at most 268435456 pixels (16384x16384)
    error: invalid value 'abc' for '--size <WxH>': `abc` is no picture size: write WIDTHxHEIGHT in pixels, such as 512x384
    error: invalid value '-8x8' for '--size <WxH>': `-8x8` is no picture size: write WIDTHxHEIGHT in pixels, such as 512x384
    ");
    assert_snapshot!(refused(&[
        ["--spp", "0"],
        ["--spp", "-1"],
        ["--spp", "1e3"],
        ["--adaptive", "2"],
        ["--adaptive", "nan"],
        ["--depth", "-1"],
        ["--threads", "-1"],
        ["--threads", "70000"],
        ["--seed", "-1"],
        ["--seed", "x"],
    ]), @r"
    error: invalid value '0' for '--spp <SPP>': write a whole number from 1 to 1048576
    error: invalid value '-1' for '--spp <SPP>': write a whole number from 1 to 1048576
    error: invalid value '1e3' for '--spp <SPP>': write a whole number from 1 to 1048576
    error: invalid value '2' for '--adaptive <CONTRAST>': write a number from 0 to 1
    error: invalid value 'nan' for '--adaptive <CONTRAST>': write a number from 0 to 1
    error: invalid value '-1' for '--depth <DEPTH>': write a whole number from 0 to 1000
    error: invalid value '-1' for '--threads <THREADS>': write a whole number from 0 to 1024
    error: invalid value '70000' for '--threads <THREADS>': write a whole number from 0 to 1024
    error: invalid value '-1' for '--seed <SEED>': write a whole number from 0 to 18446744073709551615
    error: invalid value 'x' for '--seed <SEED>': write a whole number from 0 to 18446744073709551615
    ");
    assert_snapshot!(refused(&[
        ["--eye", "nan,0,0"],
        ["--eye", "1,2"],
        ["--eye", "1;2;3"],
        ["--eye", "1e999,0,0"],
        ["--eye", "0,1.1,0"],
        ["--look-at", "0,2.2,7"],
        ["--look-at", "0,9,7"],
        ["--up", "0,0"],
        ["--up", "0,0,0"],
        ["--up", "0,1.1,7"],
        ["--fov", "0"],
        ["--fov", "180"],
        ["--fov", "-40"],
        ["--fov", "nan"],
    ]), @r"
    error: invalid value 'nan,0,0' for '--eye <X,Y,Z>': `nan` is not a number; write one such as -1.5
    error: invalid value '1,2' for '--eye <X,Y,Z>': 3 numbers separated by commas are wanted, 2 are given
    error: invalid value '1;2;3' for '--eye <X,Y,Z>': `1;2;3` is not a number; write one such as -1.5
    error: invalid value '1e999,0,0' for '--eye <X,Y,Z>': `1e999` is not a number; write one such as -1.5
    error: --eye, --look-at, --up, --fov: look_at is the same point as eye; move one of the two
    error: --eye, --look-at, --up, --fov: look_at is the same point as eye; move one of the two
    error: --eye, --look-at, --up, --fov: up is zero or along the line of sight; look another way or choose another `up`
    error: invalid value '0,0' for '--up <X,Y,Z>': 3 numbers separated by commas are wanted, 2 are given
    error: --eye, --look-at, --up, --fov: up is zero or along the line of sight; look another way or choose another `up`
    error: --eye, --look-at, --up, --fov: up is zero or along the line of sight; look another way or choose another `up`
    error: --eye, --look-at, --up, --fov: fov is out of range; it must be between 0 and 180 degrees
    error: --eye, --look-at, --up, --fov: fov is out of range; it must be between 0 and 180 degrees
    error: --eye, --look-at, --up, --fov: fov is out of range; it must be between 0 and 180 degrees
    error: invalid value 'nan' for '--fov <DEG>': `nan` is not a number; write one such as -1.5
    ");
    assert_snapshot!(refused(&[
        ["--light", "1,2,3"],
        ["--light", "1,2,3,-4"],
        ["--light", "1,2,3,1e308"],
        ["--light", "1,2e60,3,4"],
        ["--light", "1,2,3,nan"],
        ["--light", "1,,3,4"],
        ["--exposure", "inf"],
        ["--exposure", "bright"],
        ["--method", "witted"],
        ["--index", "linaer"],
        ["--branches", "none"],
        ["--estimator", "mix"],
        ["--also", "samples"],
        ["--also", "smples=new.exr"],
        ["--also", "samples=new.jpg"],
        ["--also", "samples=old.png"],
    ]), @r"
    error: invalid value '1,2,3' for '--light <X,Y,Z,INTENSITY>': 4 numbers separated by commas are wanted, 3 are given
    error: --light: intensity is -4.0; it must be between 0 and 1e30
    error: --light: intensity is 1e308; it must be between 0 and 1e30
    error: --light: position is [1.0, 2e60, 3.0]; coordinates must be finite and below 1e50
    error: invalid value '1,2,3,nan' for '--light <X,Y,Z,INTENSITY>': `nan` is not a number; write one such as -1.5
    error: invalid value '1,,3,4' for '--light <X,Y,Z,INTENSITY>': `` is not a number; write one such as -1.5
    error: invalid value 'inf' for '--exposure <EV>': `inf` is not a number; write one such as -1.5
    error: invalid value 'bright' for '--exposure <EV>': `bright` is not a number; write one such as -1.5
    error: unknown method `witted`; known: whitted, appel, path, distributed
    error: unknown index `linaer`; known: linear, wide, octree, bvh, grid, kd, bsp, obvhs-bvh2, obvhs-cwbvh
    error: invalid value 'none' for '--branches <BRANCHES>': write both or one
    error: invalid value 'mix' for '--estimator <STRATEGY>': write lamp, lobe or mis
    error: invalid value 'samples' for '--also <NAME=FILE>': write NAME=FILE, such as samples=samples.exr
    error: unknown by-product of whitted `smples`; known: samples
    error: --also: what kind of picture is `new.jpg`? Its name must end in .png (sRGB) or .exr (linear)
    error: --also: old.png is written twice
    ");
}

/// One line for each flag without effect, and one for all that the method leaves out of the scene.
#[test]
fn what_has_no_effect_is_warned_of() {
    let folder = folder(&[]);
    let warnings = |line: &[&str]| text(&accepted(&folder, line).stderr);
    let render = |scene, options: &[&'static str]| {
        warnings(&[&["render", scene, "--size=8x8", "--out=new.png"], options].concat())
    };
    assert_snapshot!(render("room", &["--method=appel", "--depth=3"]), @r"
    warning: --depth changes nothing: appel does not use it
    warning: appel leaves out what the scene has: mirrors (k_s), the size of lamps (they count as points)
    ");
    assert_snapshot!(render("whitted", &["--method=appel"]), @"warning: appel leaves out what the scene has: mirrors (k_s), glass (k_t)");
    assert_snapshot!(render("room", &["--depth=3"]), @"warning: whitted leaves out what the scene has: the size of lamps (they count as points)");
    assert_snapshot!(render("effects", &[]), @"warning: whitted leaves out what the scene has: the size of lamps (they count as points), gloss (mirrors and glass count as smooth), the lens (all is in focus), motion (all is where it is as the shutter opens)");
    assert_snapshot!(render("effects", &["--method=distributed"]), @"");
    assert_eq!(render("whitted", &["--depth=3", "--spp=2", "--adaptive=0.1", "--seed=4"]), "");
    assert_snapshot!(render("whitted", &["--seed=4", "--adaptive=0.1"]), @r"
    warning: --seed changes nothing: the one sample of --spp 1 is the pixel's centre
    warning: --adaptive changes nothing: the one sample of --spp 1 is the pixel's centre
    ");
    assert_snapshot!(render("whitted", &["--branches=one", "--estimator=mis"]), @r"
    warning: --branches changes nothing: whitted does not use it
    warning: --estimator changes nothing: whitted does not use it
    ");
    assert_snapshot!(render("penumbra", &["--method=path", "--seed=4", "--estimator=lamp"]), @"warning: path leaves out what the scene has: the ambient constant (the light that it stands for is followed)");
    assert_eq!(render("cornell", &["--method=path", "--seed=4", "--estimator=lamp"]), "");
    assert_snapshot!(render("cornell", &["--method=distributed", "--spp=2", "--adaptive=0.1"]), @"warning: --adaptive changes nothing: distributed does not use it");
    let walk = ["--scene=whitted", "--pixel=1,1", "--size=8x8"];
    assert_snapshot!(warnings(&[&["step", "whitted", "--index=kd"], &walk[..]].concat()), @"warning: --index changes nothing: whitted does not use it");
    assert_snapshot!(warnings(&[&["step", "accel", "--index=kd", "--depth=2"], &walk[..]].concat()), @"warning: --depth changes nothing: accel does not use it");
}

/// Where there is detail all samples are taken, elsewhere one: as an EXR in numbers, as a PNG with the most
/// white. The picture itself does not change.
#[test]
fn a_by_product_comes_beside_the_picture() {
    let folder = folder(&[]);
    let line = ["render", "whitted", "--size=40x24", "--spp=4", "--adaptive=0.1", "--out=new.exr"];
    accepted(&folder, &line);
    let alone = fs::read(folder.path().join("new.exr")).unwrap();
    let output = accepted(
        &folder,
        &[&line[..], &["--also", "samples=n.exr", "--also=samples=n.png"]].concat(),
    );
    assert!(text(&output.stdout).ends_with("picture new.exr\nsamples n.exr\nsamples n.png\n"));
    assert_eq!(fs::read(folder.path().join("new.exr")).unwrap(), alone);
    let [numbers, shown] = ["n.exr", "n.png"].map(|name| load(folder.path().join(name)).unwrap());
    let counts = |number: f32| numbers.pixels().iter().filter(|pixel| pixel[0] == number).count();
    assert_eq!(counts(1.0) + counts(4.0), 40 * 24);
    assert!(counts(1.0) > 100 && counts(4.0) > 100);
    let white = shown.pixels().iter().filter(|pixel| pixel[0] == 1.0).count();
    assert_eq!(white, counts(4.0));
}

#[test]
fn wrong_scenes_are_refused_with_a_cure() {
    let noise: Vec<u8> =
        (0..4000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    let triangle_and = |rest: &str| format!("{TRIANGLE}{rest}").into_bytes();
    let folder = folder(&[
        ("empty.obj", b""),
        ("empty.toml", b""),
        ("noise.obj", &noise),
        ("noise.toml", &noise),
        ("truncated.obj", &triangle_and("f 1 2 ")),
        ("beyond.obj", &triangle_and("f 1 2 4\n")),
        ("half.obj", &triangle_and("f 1/ 2/")),
        ("nan.obj", b"v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n"),
        ("point.obj", b"v 1 1 1\nf 1 1 1\n"),
        ("typing.toml", b"ambiant = 1\n"),
        ("syntax.toml", b"ambient = \n"),
        ("model.ply", b"ply\n"),
    ]);
    fs::create_dir(folder.path().join("folder")).unwrap();
    fs::create_dir(folder.path().join("folder.obj")).unwrap();
    let refused = |scenes: &[&str]| {
        let lines = scenes.iter().map(|scene| vec!["render", scene, "--size=8x8", "--out=old.png"]);
        refusals(&folder, lines)
    };
    assert_snapshot!(refused(&["witted", "flake:99", "flake:x", "room:2"]), @r"
    error: unknown scene `witted`; known: whitted, kitchen, flake, town, room, gears, cornell, effects, soup, scan, atrium, horizon, tetrahedra, stadium, penumbra; or name a .toml or .obj file
    error: flake:99: the level is a number from 0 to 7
    error: flake:x: the level is a number from 0 to 7
    error: room: only generated scenes have a level; leave it out
    ");
    assert_snapshot!(refused(&["folder", "folder.obj", ".", "model.ply"]), @r"
    error: folder: it is a folder; name a .obj or .toml file in it
    error: folder.obj: it is a folder; name a .obj or .toml file in it
    error: .: it is a folder; name a .obj or .toml file in it
    error: model.ply: unknown kind of scene; the known ones are .obj and .toml
    ");
    let missing = refused(&["missing.obj", "missing/scene.toml"]);
    assert!(
        missing.starts_with("error: missing.obj: ")
            && missing.contains("\nerror: missing/scene.toml: ")
    );
    assert_eq!(missing.matches("; check the path and its permissions\n").count(), 2);
    assert_snapshot!(refused(&[
        "empty.obj",
        "noise.obj",
        "truncated.obj",
        "beyond.obj",
        "half.obj",
        "nan.obj",
        "point.obj",
    ]), @r"
    error: empty.obj: nothing to draw: no face with 3 corners; check that this is an OBJ file with `v` and `f` lines
    error: noise.obj: nothing to draw: no face with 3 corners; check that this is an OBJ file with `v` and `f` lines
    error: truncated.obj: nothing to draw: no face with 3 corners; check that this is an OBJ file with `v` and `f` lines
    error: beyond.obj:4: the face names number 4 of 3 vertices; count from 1, or back from -1 for the latest
    error: half.obj: nothing to draw: no face with 3 corners; check that this is an OBJ file with `v` and `f` lines
    error: nan.obj:2: a coordinate is not finite, or beyond ±1e50; correct the number
    error: point.obj: nothing to draw: all vertices are at one point; check the vertices
    ");
    assert_snapshot!(refused(&["empty.toml", "noise.toml", "typing.toml", "syntax.toml"]), @r"
    error: empty.toml: nothing to draw; add a [[sphere]], [[mesh]] or [[polygon]]
    error: noise.toml:1: the text is not UTF-8; save the file as UTF-8
    error: typing.toml:1: unknown field `ambiant`; the known ones are ambient, camera, light, material, mesh, sphere, polygon, background
    error: syntax.toml:1: string values must be quoted, expected literal string; correct the value or the syntax
    ");
}

#[test]
fn odd_scenes_are_drawn_with_a_warning() {
    let dark = "[material.grey]\nrho_d = 0.5\n\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'grey'\n";
    let folder = folder(&[
        ("truncated.obj", format!("{CORNER}f 1 2 ").as_bytes()),
        ("no_library.obj", format!("mtllib missing.mtl\nusemtl red\n{CORNER}").as_bytes()),
        ("mark.obj", format!("\u{feff}mtllib red.mtl\nusemtl red\n{CORNER}").as_bytes()),
        ("outside.obj", format!("mtllib ../x/red.mtl\nusemtl red\n{CORNER}").as_bytes()),
        ("red.mtl", b"newmtl red\nKd 0.8 0.1 0.1\n"),
        ("dark.toml", dark.as_bytes()),
    ]);
    let mut warnings = String::new();
    for scene in ["truncated.obj", "no_library.obj", "mark.obj", "outside.obj", "dark.toml"] {
        let output = accepted(&folder, &["render", scene, "--size=9x9", "--out=new.png"]);
        warnings += &text(&output.stderr);
        let centre = load(folder.path().join("new.png")).unwrap().get(4, 4);
        assert_eq!(centre.max_element() > 0.0, scene != "dark.toml", "{scene}: {centre}");
        // `Kd` alone is a material, and the mark hides no statement.
        let is_red = ["mark.obj", "outside.obj"].contains(&scene);
        assert_eq!(centre.x > 2.0 * centre.y, is_red, "{scene}: {centre}");
    }
    assert_snapshot!(warnings, @r"
    warning: truncated.obj:9: face with fewer than 3 corners left out
    warning: no_library.obj:1: material library cannot be opened; its materials become light grey
    warning: no_library.obj:2: material not defined in any library; its faces become light grey
    warning: outside.obj:1: material library is not in this file's folder under that path; the one of its name beside this file is read
    warning: dark.toml: no light: the picture will be black; add a [[light]], a material with emission or an ambient
    ");
}

/// The brightest lamp that is accepted, a millionth of a unit away: where that is beyond the numbers of
/// a picture, pixels are the largest number.
#[test]
fn the_brightest_lamp_leaves_pixels_finite() {
    let tiny = "v 0 0 0\nv 1e-6 0 0\nv 0 1e-6 0\nv 0 0 1e-6\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    let folder = folder(&[("tiny.obj", tiny.as_bytes())]);
    let light = "--light=5e-7,5e-7,5e-7,1e30";
    accepted(&folder, &["render", "tiny.obj", "--size=9x9", "--out=new.exr", light]);
    let image = load(folder.path().join("new.exr")).unwrap();
    assert_eq!(image.not_finite().count(), 0);
    let brightest = image.pixels().iter().filter(|pixel| **pixel == [f32::MAX; 3]).count();
    assert!((1..81).contains(&brightest), "{brightest}");
}

/// Of a house whose z points up, the gable at −y is seen upright, and along y, once y does not point up.
#[test]
fn a_model_is_turned_upright() {
    // A gable in the plane y = 0: wide below, a corner on top, red; and a blue floor below it.
    let house = "mtllib house.mtl\nv -1 0 0\nv 1 0 0\nv 0 0 2\nv -1 -1 0\nv 1 -1 0\n\
                 usemtl red\nf 1 2 3\nusemtl blue\nf 4 5 2 1\n";
    let folder = folder(&[
        ("house.obj", house.as_bytes()),
        ("house.mtl", b"newmtl red\nKd 1 0 0\nKa 1 0 0\nnewmtl blue\nKd 0 0 1\nKa 0 0 1\n"),
    ]);
    let render = |options: &[&'static str]| {
        let line = ["render", "house.obj", "--size=32x32", "--out=new.exr"];
        accepted(&folder, &[&line, options].concat());
        load(folder.path().join("new.exr")).unwrap()
    };
    // The mean row of what is more of one colour than of the other.
    let mean_row = |image: &Image, red: bool| {
        let rows = (0..32 * 32).map(|i| (i % 32, i / 32)).filter(|&(x, y)| {
            let color = image.get(x, y);
            if red { color.x > 2.0 * color.z } else { color.z > 2.0 * color.x }
        });
        let rows: Vec<f64> = rows.map(|(_, y)| f64::from(y)).collect();
        assert!(rows.len() > 20, "{red}: {}", rows.len());
        rows.iter().sum::<f64>() / rows.len() as f64
    };
    let upright = render(&["--up=0,0,1"]);
    assert!(mean_row(&upright, true) < mean_row(&upright, false) - 3.0);
    let along_y = ["--eye=0,-9,0.7", "--look-at=0,0,0.7", "--fov=15"];
    let line = ["render", "house.obj", "--out=new.exr"];
    assert_snapshot!(refusal(&folder, &[&line, &along_y[..]].concat()), @"error: --eye, --look-at, --up, --fov: up is zero or along the line of sight; look another way or choose another `up`");
    let from_the_front = render(&[&along_y[..], &["--up=0,0,1"]].concat());
    let middle = from_the_front.get(16, 16);
    assert!(middle.x > 2.0 * middle.z, "the gable is in the middle: {middle}");
}

#[test]
fn wrong_targets_are_refused_before_the_work() {
    let folder = folder(&[]);
    fs::create_dir(folder.path().join("folder.png")).unwrap();
    let targets = ["missing/new.png", "old.png/new.png", "folder.png", "new.jpg", "new", ".png"];
    // The work would take hours.
    let line =
        |target| vec!["render", "whitted", "--size=4096x4096", "--spp=100000", "--out", target];
    assert_snapshot!(refusals(&folder, targets.map(line)), @r"
    error: --out: cannot write `missing/new.png`: there is no folder `missing`; create it first
    error: --out: cannot write `old.png/new.png`: there is no folder `old.png`; create it first
    error: --out: cannot write `folder.png`: it is a folder; name a file in it
    error: --out: what kind of picture is `new.jpg`? Its name must end in .png (sRGB) or .exr (linear)
    error: --out: what kind of picture is `new`? Its name must end in .png (sRGB) or .exr (linear)
    error: --out: what kind of picture is `.png`? Its name must end in .png (sRGB) or .exr (linear)
    ");
}

#[cfg(unix)]
#[test]
fn protected_targets_are_refused() {
    use std::os::unix::fs::PermissionsExt;

    let folder = folder(&[("protected.png", b"mine")]);
    fs::create_dir(folder.path().join("closed")).unwrap();
    for (name, mode) in [("protected.png", 0o444), ("closed", 0o555)] {
        let path = folder.path().join(name);
        fs::set_permissions(&path, PermissionsExt::from_mode(mode)).unwrap();
    }
    let line = |target| vec!["render", "whitted", "--size=8x8", "--out", target];
    assert_snapshot!(refusals(&folder, ["protected.png"].map(line)), @"error: --out: cannot write `protected.png`: that file is write-protected; choose another name or make it writable");
    assert_eq!(fs::read(folder.path().join("protected.png")).unwrap(), b"mine");

    if fs::write(folder.path().join("closed/probe"), "").is_ok() {
        eprintln!("not tested: this user may write into a read-only folder");
        return;
    }
    let error = refusals(&folder, ["closed/new.png"].map(line));
    assert!(error.contains("`closed/new.png`: its folder is read-only; choose another"), "{error}");
}

/// Also to a file that is not there yet; a circle leads nowhere.
#[cfg(unix)]
#[test]
fn links_are_followed() {
    use std::os::unix::fs::symlink;

    let folder = folder(&[]);
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("far")).unwrap();
    symlink("far/new.png", path("link.png")).unwrap();
    accepted(&folder, &["render", "whitted", "--size=8x8", "--out=link.png"]);
    assert!(fs::symlink_metadata(path("link.png")).unwrap().is_symlink());
    assert!(load(path("far/new.png")).is_ok());

    symlink("none/new.png", path("lost.png")).unwrap();
    symlink("circle.png", path("circle.png")).unwrap();
    let line = |target| vec!["render", "whitted", "--size=8x8", "--out", target];
    assert_snapshot!(refusals(&folder, ["lost.png", "circle.png"].map(line)), @r"
    error: --out: cannot write `lost.png`: there is no folder `none`; create it first
    error: --out: cannot write `circle.png`: its links lead in a circle; name a file
    ");
}

/// `LANCER_SMALL_DISK` names an empty folder on a disk of 64 KiB, such as one made by
/// `mount -t tmpfs -o size=64k tmpfs FOLDER`.
#[test]
#[ignore = "needs a small disk in LANCER_SMALL_DISK"]
fn a_full_disk_leaves_the_old_picture() {
    let disk = std::env::var("LANCER_SMALL_DISK").expect("LANCER_SMALL_DISK names a folder");
    let target = format!("{disk}/a.exr");
    let folder = folder(&[]);
    accepted(&folder, &["render", "whitted", "--size=8x8", "--out", &target]);
    let before = fs::read(&target).unwrap();
    let error = refusal(&folder, &["render", "whitted", "--size=256x256", "--out", &target]);
    assert!(error.contains(&target) && error.contains("the disk is full; free some"), "{error}");
    assert_eq!(fs::read(&target).unwrap(), before);
    assert_eq!(contents(Path::new(&disk)).len(), 1);
    fs::remove_file(target).unwrap();
}

#[test]
fn incomplete_and_unknown_commands_are_refused() {
    let lines = [
        vec!["rendr"],
        vec!["render", "whitted"],
        vec!["render", "--out=a.png"],
        vec!["compare", "a.png"],
        vec!["tidy", "more"],
    ];
    assert_snapshot!(refusals(&folder(&[]), lines), @r"
    error: unrecognized subcommand 'rendr'
    error: the following required arguments were not provided:
      --out <FILE>
    error: the following required arguments were not provided:
      <SCENE>
    error: the following required arguments were not provided:
      <IMAGE>
    error: unexpected argument 'more' found
    ");
    let error = refusal(&folder(&[]), &["eq", "reflected-rai"]);
    let start = "error: unknown label `reflected-rai`; known: reflected-ray, ";
    assert!(error.starts_with(start), "{error}");
}

#[test]
fn a_chapter_without_figures_is_named() {
    assert_snapshot!(refusal(&folder(&[]), &["figures", "3"]), @"error: chapter 3 has no figures; `cargo xtask figures --list` lists those that there are");
}

#[test]
fn labels_are_found_from_any_folder() {
    let all = text(&accepted(&folder(&[]), &["eq"]).stdout);
    assert!(all.contains("\neq:reflected-ray  "), "{all}");
    let one = text(&accepted(&folder(&[]), &["eq", "reflected-ray"]).stdout);
    let first = one.lines().next().unwrap();
    assert!(first.starts_with("crates/core/src/optics.rs:"), "{one}");
    assert!(first.contains("definition  pub fn reflect<V: Vector>("), "{one}");
}

#[test]
fn a_reader_may_stop_reading() {
    let folder = folder(&[]);
    for arguments in [vec!["eq"], vec!["render", "whitted", "--size=8x8", "--out=new.png"]] {
        let mut command = command(&folder, &arguments);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        assert_eq!(text(&output.stderr), "");
    }
    assert!(load(folder.path().join("new.png")).is_ok());
}

#[test]
fn scenes_and_models_are_rendered_in_both_formats() {
    let folder = folder(&[("corner.obj", CORNER.as_bytes())]);
    for (scene, name) in [
        ("whitted", "old.png"),
        ("whitted", "a.exr"),
        ("corner.obj", "b.PNG"),
        ("corner.obj", "c.exr"),
        ("gears:1", "d.png"),
    ] {
        let output = accepted(&folder, &["render", scene, "--size=24x16", "--out", name]);
        assert_eq!(text(&output.stderr), "", "{scene}");
        assert!(text(&output.stdout).ends_with(&format!("picture {name}\n")));
        let picture = load(folder.path().join(name)).unwrap();
        assert_eq!(picture.size(), ImageSize::new(24, 16));
        assert_eq!(picture.defects(), Default::default());
        let first = picture.pixels()[0];
        assert!(picture.pixels().iter().any(|pixel| *pixel != first), "{scene} is of one colour");
    }
    let names: Vec<String> = contents(folder.path()).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["a.exr", "b.PNG", "c.exr", "corner.obj", "d.png", "old.png"]);
}

#[test]
fn threads_and_indexes_do_not_change_a_byte() {
    let folder = folder(&[]);
    let bytes = |option: &str| {
        let line = ["render", "whitted", "--size=40x24", "--spp=3", "--out=new.exr", option];
        accepted(&folder, &line);
        fs::read(folder.path().join("new.exr")).unwrap()
    };
    let expected = bytes("--threads=1");
    assert_eq!(bytes("--threads=3"), expected);
    for index in ["linear", "bvh", "obvhs-bvh2", "obvhs-cwbvh", "grid", "octree", "kd", "bsp"] {
        assert_eq!(bytes(&format!("--index={index}")), expected, "{index}");
    }
    assert_ne!(bytes("--seed=1"), expected);
    assert_ne!(bytes("--method=appel"), expected);
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_no_file() {
    let folder = folder(&[]);
    let line = ["render", "whitted", "--size=4096x4096", "--spp=2048", "--out=new.png"];
    let mut command = command(&folder, &line);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut reader = BufReader::new(child.stdout.take().unwrap());
    let mut out = String::new();
    reader.read_line(&mut out).unwrap();
    assert!(out.starts_with("scene"), "{out}");
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    reader.read_to_string(&mut out).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(!out.contains("picture"), "{out}");
    assert_snapshot!(text(&output.stderr), @"error: interrupted; no file was written");
    assert_eq!(contents(folder.path()), [("old.png".to_owned(), 3)]);
}

#[test]
fn every_command_has_help() {
    let help = |arguments: &[&str]| text(&accepted(&folder(&[]), arguments).stdout);
    for command in ["figures", "render", "step", "compare", "eq", "exercise", "tidy"] {
        assert_snapshot!(format!("help_{command}"), help(&[command, "--help"]));
    }
    assert_snapshot!("help", help(&["--help"]));
}
