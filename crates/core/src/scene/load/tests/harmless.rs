//! What a picture does not need refuses no model: it is drawn, with one counted warning.

use std::cell::RefCell;

use super::*;
use crate::scene::Material;

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

fn grey() -> Material {
    Material::matte(Rgb::splat(0.75))
}

fn red() -> Material {
    Material::matte(Rgb::new(0.8, 0.1, 0.1))
}

const RED: &str = "newmtl a\nKd 0.8 0.1 0.1\n";

/// The material of the first face.
fn first_material(loaded: &Loaded) -> Material {
    *loaded.scene.material(loaded.scene.mesh.faces[0].material)
}

/// A triangle in the material `m` of this library.
fn triangle_of(library: &str) -> Result<Loaded, LoadError> {
    let text = format!("mtllib a.mtl\n{CORNERS}usemtl m\nf 1 2 3\n");
    load_from(&[("a.obj", text.as_bytes()), ("a.mtl", library.as_bytes())], "a.obj")
}

#[test]
fn colours_of_vertices_are_passed_over() {
    let ignored = "vertex colours ignored: colours come from materials";
    for colors in ["1 0 0", "1 0.2 0.1 1", "1 0", "255 1,5 x", "1 1 1 1 1 1 1"] {
        let text = format!("v 0 0 0 {colors}\nv 1 0 0\nv 0 1 0 {colors}\nf 1 2 3\n");
        let loaded = obj(text).expect(colors);
        let counted = format!("a.obj:1: {ignored} (2 times, this is the first)");
        assert_eq!(warnings(&loaded), [counted], "{colors}");
        assert_eq!(loaded.scene.mesh.corners(0), [DVec3::ZERO, DVec3::X, DVec3::Y]);
    }
}

/// Face 1 has good normals, faces 2 and 3 a bad one.
#[test]
fn normals_without_a_direction_draw_flat_faces() {
    let flat = "face with a normal that does not exist, is zero or not finite is drawn flat";
    let counted = format!("a.obj:7: {flat} (2 times, this is the first)");
    let check = |bad_line: &str, bad_number: &str| {
        let text = format!(
            "{CORNERS}vn 0 0 2\n{bad_line}\nf 1//1 2//1 3//1\nf 1//1 2//1 3//{bad_number}\n\
             f 1//{bad_number} 3//1 2//1\nf 1//-2 2//-2 3//-2\n"
        );
        let loaded = obj(&text).unwrap_or_else(|error| panic!("{error} in {text}"));
        assert_eq!(warnings(&loaded), [counted.as_str()], "{text}");
        let mesh = &loaded.scene.mesh;
        let smooth = [true, false, false, true];
        for (triangle, is_smooth) in smooth.into_iter().enumerate() {
            assert_eq!(mesh.corner_normals(triangle), is_smooth.then_some([DVec3::Z; 3]), "{text}");
        }
    };
    for bad in [
        "vn 0 0 0",
        "vn nan 0 1",
        "vn 0 inf 1",
        "vn 0 0 1e400",
        "vn 1 2",
        "vn",
        "vn 1,5 0 0",
        "vn x",
    ] {
        check(bad, "2");
    }
    for number in ["0", "3", "-3", "4294967296", "6148914691236517206", "-9223372036854775808", "x"]
    {
        check("vn 0 1 0", number);
    }
    // Nobody names them.
    let loaded = obj(format!("{CORNERS}vn 0 0 0\nvn 1\nf 1 2 3\n")).expect("fine");
    assert_eq!(warnings(&loaded), [""; 0]);
    // All are bad: the mesh is flat. A normal may follow the faces that use it.
    let mesh = obj(format!("{CORNERS}vn 0 0 0\nf 1//1 2//1 3//1\n")).expect("fine").scene.mesh;
    assert!(mesh.normals.is_empty() && mesh.smooth.is_empty());
    let mesh = obj(format!("{CORNERS}f 1//1 2//1 3//1\nvn 0 0 1\n")).expect("fine").scene.mesh;
    assert_eq!(mesh.corner_normals(0), Some([DVec3::Z; 3]));
}

#[test]
fn what_a_corner_says_of_textures_is_passed_over() {
    for face in ["1/9 2/x 3/", "1/0/1 2/1.5/1 3/-9/1", "1//1/7 2//1/7 3//1"] {
        let loaded = obj(format!("{CORNERS}vt 0\nvt\nvn 0 0 1 5\nf {face}\n")).expect(face);
        assert_eq!(warnings(&loaded), [""; 0], "{face}");
    }
}

/// Other writings of a triangle, and statements that change nothing.
#[test]
fn statements_for_others_are_passed_over() {
    for line in ["o", "g", "s", "s off", "s 1", "vp 0.5", "mg 0", "#", "\u{a0}", "\t"] {
        assert_eq!(warnings(&obj(format!("{CORNERS}{line}\nf 1 2 3\n")).expect(line)), [""; 0]);
    }
    for line in ["l 1 9", "p 9", "curv 0 1 9", "surf"] {
        let loaded = obj(format!("{CORNERS}{line}\nf 1 2 3\n")).expect(line);
        let kind = &loaded.warnings[0].kind;
        assert_eq!((loaded.warnings.len(), kind), (1, &WarningKind::NotAFace), "{line}");
    }
}

#[test]
fn names_that_are_missing_or_end_in_a_comment() {
    let nameless = |line: usize, keyword: &str| {
        format!("a.obj:{line}: `{keyword}` without a name; what it should name becomes light grey")
    };
    let comment =
        |line: usize| format!("a.obj:{line}: the name is taken to end before its ` #`, a comment");
    let check = |library: &str, head: &str, usemtl: &str, expected: &[String], material| {
        let text = format!("{head}\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{usemtl}\nf 1 2 3\n");
        let files =
            [("a.obj", text.as_bytes()), ("a.mtl", library.as_bytes()), ("# b.mtl", b"newmtl b\n")];
        let loaded = load_from(&files, "a.obj").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(warnings(&loaded), expected, "{head} {usemtl}");
        assert_eq!(first_material(&loaded), material, "{head} {usemtl}");
    };
    let plain = "mtllib a.mtl";
    check(RED, plain, "usemtl", &[nameless(5, "usemtl")], grey());
    check(RED, plain, "usemtl \t# none", &[nameless(5, "usemtl")], grey());
    check(RED, "mtllib\nmtllib a.mtl", "usemtl a", &[nameless(1, "mtllib")], red());
    check(RED, "mtllib # none\nmtllib a.mtl", "usemtl a", &[nameless(1, "mtllib")], red());
    check(RED, plain, "usemtl a # the red one", &[comment(5)], red());
    check(RED, plain, "usemtl a\t#", &[comment(5)], red());
    check(RED, "mtllib a.mtl # by hand", "usemtl a", &[comment(1)], red());
    let commented = RED.replace(" a\n", " a # red\n");
    check(&commented, plain, "usemtl a", &[comment(5)], red());
    check(&commented, plain, "usemtl a # red", &[], red());
    // Names may hold the sign.
    check(&RED.replace(" a\n", " #1 a#b\n"), plain, "usemtl #1 a#b", &[], red());
    check(&RED.replace(" a\n", " Material #25\n"), plain, "usemtl Material #25", &[], red());
    let undefined = "a.obj:5: material not defined in any library; its faces become light grey";
    let library = RED.replace(" a\n", " Material #25\n");
    check(&library, plain, "usemtl Material #27", &[undefined.to_owned()], grey());
    check(RED, "mtllib # b.mtl\nmtllib a.mtl", "usemtl a", &[], red());
}

/// The file of the library's name beside the model is read, and nothing outside its folder is even asked for.
#[test]
fn libraries_elsewhere_are_looked_for_beside_the_model() {
    let elsewhere = "models/a.obj:1: material library is not in this file's folder under that path; \
                     the one of its name beside this file is read";
    let missing =
        "models/a.obj:1: material library cannot be opened; its materials become light grey";
    let undefined =
        "models/a.obj:5: material not defined in any library; its faces become light grey";
    let load = |names: &str| {
        let text = format!("mtllib {names}\n{CORNERS}usemtl a\nf 1 2 3\n");
        let asked = RefCell::new(Vec::new());
        let open = |path: &Path, _: Option<&Path>| -> io::Result<Box<dyn Read>> {
            asked.borrow_mut().push(path.to_owned());
            let inside = match path.to_str() {
                Some("models/a.obj") => text.as_str(),
                Some("models/m.mtl" | "models/my lib.mtl") => RED,
                // Secrets: the file of that name is there, and so are those of other folders.
                _ if !path.starts_with("models") || path.to_string_lossy().contains("..") => RED,
                _ => return Err(io::ErrorKind::NotFound.into()),
            };
            Ok(Box::new(Cursor::new(inside.as_bytes().to_vec())))
        };
        let loaded = load_with(Path::new("models/a.obj"), &open).expect(names);
        for path in asked.borrow().iter() {
            let is_plain = |part| matches!(part, std::path::Component::Normal(_));
            let shown = path.display().to_string();
            assert!(path.starts_with("models") && path.components().all(is_plain), "{shown}");
            assert!(!shown.contains(['\\', ':']), "{shown}");
        }
        loaded
    };
    let paths = [
        "../m.mtl",
        "/elsewhere/m.mtl",
        "lib/../../m.mtl",
        "..\\m.mtl",
        "C:\\Users\\me\\m.mtl",
        "C:/m.mtl",
        "c:m.mtl",
        "\\m.mtl",
        "\\\\server\\share\\m.mtl",
        "gone/m.mtl",
        "C:\\John Doe\\my lib.mtl",
    ];
    for path in paths {
        let loaded = load(path);
        assert_eq!(warnings(&loaded), [elsewhere], "{path}");
        assert_eq!(first_material(&loaded), red(), "{path}");
    }
    let loaded = load("../x/gone.mtl C:\\m.mtl");
    assert_eq!(warnings(&loaded), [missing, elsewhere]);
    assert_eq!(first_material(&loaded), red());
    for path in
        ["../gone.mtl", "..", "../..", "/", "C:", "/etc/passwd", "x\\..", "../m.mtl/..", "x/."]
    {
        let loaded = load(path);
        assert_eq!(warnings(&loaded), [missing, undefined], "{path}");
        assert_eq!(first_material(&loaded), grey(), "{path}");
    }
}

/// Gives its bytes, then an error, as a drive that fails does.
struct Failing<'a>(&'a [u8]);

impl Read for Failing<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.0.read(buffer)? {
            0 => Err(io::Error::other("the drive fails")),
            count => Ok(count),
        }
    }
}

/// What stands before the place where a library cannot be read counts; the rest is as good as missing.
#[test]
fn libraries_that_cannot_be_read() {
    let model = format!("mtllib a.mtl\n{CORNERS}usemtl a\nf 1 2 3\nusemtl b\nf 1 3 2\n");
    let text = RED.to_owned() + "newmtl b\nKd 0.5\n";
    let unreadable = |place: &str, reason: &str| {
        format!(
            "{place}: material library cannot be read to its end: {reason}; what is missing becomes light grey"
        )
    };
    let undefined = "material not defined in any library; its faces become light grey";
    let utf16 = |unit: fn(u16) -> [u8; 2]| -> Vec<u8> {
        std::iter::once(0xFEFF).chain(text.encode_utf16()).flat_map(unit).collect()
    };
    for bytes in [utf16(u16::to_le_bytes), utf16(u16::to_be_bytes)] {
        let files: [(&str, &[u8]); 2] = [("a.obj", model.as_bytes()), ("a.mtl", &bytes)];
        let loaded = load_from(&files, "a.obj").expect("drawn");
        let all_undefined = format!("a.obj:5: {undefined} (2 times, this is the first)");
        let expected = [unreadable("a.mtl:1", "the text is UTF-16"), all_undefined];
        assert_eq!(warnings(&loaded), expected);
        assert_eq!(loaded.scene.materials, [grey()]);
    }
    let open = |path: &Path, _: Option<&Path>| -> io::Result<Box<dyn Read>> {
        match path.to_str() {
            Some("a.obj") => Ok(Box::new(Cursor::new(model.clone().into_bytes()))),
            _ => Ok(Box::new(Failing(RED.as_bytes()))),
        }
    };
    let loaded = load_with(Path::new("a.obj"), &open).expect("drawn");
    let expected = [unreadable("a.mtl", "the drive fails"), format!("a.obj:7: {undefined}")];
    assert_eq!(warnings(&loaded), expected);
    assert_eq!(loaded.scene.materials, [red(), grey()]);
    // A line without an end.
    let long = RED.to_owned() + &"x".repeat(MAX_BYTES + (1 << 17));
    let files: [(&str, &[u8]); 2] = [("a.obj", model.as_bytes()), ("a.mtl", long.as_bytes())];
    let loaded = load_from(&files, "a.obj").expect("drawn");
    assert_eq!(loaded.scene.materials, [red(), grey()]);
    let limit = unreadable("a.mtl:3", "67108865 or more bytes in a line, the maximum is 67108864");
    let digits = |text: &str| text.replace(|c: char| c.is_ascii_digit(), "#");
    assert_eq!(digits(&warnings(&loaded)[0]), digits(&limit));
}

/// A link counts as what it leads to.
#[cfg(unix)]
#[test]
fn links_do_not_lead_out_of_the_folder() {
    use std::fs;
    use std::os::unix::fs::symlink;

    let outer = tempfile::tempdir().expect("a folder");
    let [inner, lib] = ["inner", "inner/lib"].map(|name| outer.path().join(name));
    fs::create_dir_all(&lib).expect("folders");
    fs::write(outer.path().join("secret.mtl"), RED).expect("a file");
    fs::write(outer.path().join("secret.obj"), format!("{CORNERS}f 1 2 3\n")).expect("a file");
    fs::write(lib.join("own.mtl"), RED).expect("a file");
    symlink("../secret.mtl", inner.join("out.mtl")).expect("a link");
    symlink("../secret.obj", inner.join("out.obj")).expect("a link");
    symlink("..", inner.join("up")).expect("a link");
    symlink("lib/own.mtl", inner.join("in.mtl")).expect("a link");
    symlink("inner", outer.path().join("by_link")).expect("a link");
    for folder in ["inner", "by_link"].map(|name| outer.path().join(name)) {
        let model = folder.join("a.obj");
        let load = |library: &str| {
            let text = format!("mtllib {library}\n{CORNERS}usemtl a\nf 1 2 3\n");
            fs::write(&model, text).expect("a file");
            load(&model).expect(library)
        };
        for library in ["out.mtl", "up/secret.mtl"] {
            let loaded = load(library);
            assert_eq!(loaded.warnings[0].kind, WarningKind::MissingLibrary, "{library}");
            assert_eq!(first_material(&loaded), grey(), "{library}");
        }
        for library in ["in.mtl", "lib/own.mtl", "up/inner/lib/own.mtl"] {
            let loaded = load(library);
            assert_eq!((warnings(&loaded), first_material(&loaded)), (vec![], red()), "{library}");
        }
        // The meshes of a scene file, too.
        let scene = folder.join("s.toml");
        let load = |mesh: &str| {
            fs::write(&scene, format!("ambient = 1\n[[mesh]]\nobj = '{mesh}'\n")).expect("a file");
            super::load(&scene)
        };
        load("a.obj").expect("fine");
        let expected = "obj `out.obj`: it is a link that leads out of the folder; \
                        mesh files are looked for from the scene's folder";
        assert_refused(load("out.obj"), &format!("{}:3: {expected}", scene.display()));
    }
}

#[test]
fn of_one_name_the_first_material_counts() {
    let text = format!("mtllib a.mtl\nmtllib b.mtl\n{CORNERS}usemtl a\nf 1 2 3\n");
    let second = b"newmtl b\nKd 0.1 0.8 0.1\nnewmtl a\nKd 0.1 0.1 0.8\nKs 9\nnewmtl b\n";
    let files: [(&str, &[u8]); 3] =
        [("a.obj", text.as_bytes()), ("a.mtl", RED.as_bytes()), ("b.mtl", second)];
    let loaded = load_from(&files, "a.obj").expect("fine");
    assert_eq!(
        warnings(&loaded),
        ["b.mtl:3: a material of this name is defined already; the first one counts \
          (2 times, this is the first)"]
    );
    assert_eq!(first_material(&loaded), red());
    assert_eq!(loaded.material_names, ["a", "b"]);
    let green = Material::matte(Rgb::new(0.1, 0.8, 0.1));
    assert_eq!(loaded.scene.materials, [red(), green]);
}

/// Each of these lines stands after `Kd 0.8 0.1 0.1`.
#[test]
fn odd_statements_of_materials() {
    let foreign = "spectral and xyz colours are ignored: write red, green and blue";
    let unneeded = "wrong value ignored: no picture of this model depends on it";
    let extra = "more numbers than the statement has; the first ones count";
    let illum = "`illum` is not a whole number from 0 to 10, and counts as not given";
    let shiny = Material { rho_s: Rgb::splat(0.125), ..red() };
    for (line, warning, expected) in [
        ("Ni 0", unneeded, red()),
        ("Ni", unneeded, red()),
        ("Ni x\nillum 2", unneeded, red()),
        ("Ns inf", unneeded, red()),
        ("Tf 1.5", unneeded, red()),
        ("Ks 2\nillum 1", unneeded, red()),
        ("Ks spectral file.rfl 1.0", foreign, red()),
        ("Kd xyz 0.3 0.3 0.3", foreign, red()),
        ("Ke xyz 1", foreign, red()),
        ("Tf spectral f.rfl", foreign, red()),
        ("Ks 0.125 0.125 0.125 1", extra, shiny),
        ("Ns 10 20", extra, Material { shininess: 2.5, ..red() }),
        ("Ns -1.96078431", "a negative `Ns` counts as 0", red()),
        ("illum 99", illum, red()),
        ("illum 2.5", illum, red()),
        ("illum", illum, red()),
        ("newmtl\nKd 7", "`newmtl` without a name; what it should name becomes light grey", red()),
        ("newmtl other\nKd 7", "", red()),
    ] {
        let loaded = triangle_of(&format!("newmtl m\nKd 0.8 0.1 0.1\n{line}\n")).expect(line);
        let warning = match warning {
            // Of a material that no face uses.
            "" => format!("a.mtl:4: {unneeded}"),
            _ => format!("a.mtl:3: {warning}"),
        };
        assert_eq!(warnings(&loaded), [warning], "{line}");
        assert_eq!(first_material(&loaded), expected, "{line}");
    }
    // A colour that is given in no other way is the default one.
    for line in ["Kd spectral file.rfl 1.0", "Kd xyz 0.3 0.3 0.3"] {
        let loaded = triangle_of(&format!("newmtl m\n{line}\n")).expect(line);
        assert_eq!(warnings(&loaded), [format!("a.mtl:2: {foreign}")]);
        assert_eq!(first_material(&loaded), grey());
    }
    let loaded = triangle_of("newmtl m\nKd 0.8 0.1 0.1\nd -halo 0.75\n").expect("fine");
    assert_eq!(warnings(&loaded), ["a.mtl:3: `d -halo` is read as `d`, the same from all sides"]);
    let plain = triangle_of("newmtl m\nKd 0.8 0.1 0.1\nd 0.75\n").expect("fine");
    assert_eq!(first_material(&loaded), first_material(&plain));
    let loaded = triangle_of("Kd 1\nNs x\nnewmtl m\nKd 0.8 0.1 0.1\n").expect("fine");
    let ignored =
        "a.mtl:1: statement before the first `newmtl` ignored (2 times, this is the first)";
    assert_eq!((first_material(&loaded), warnings(&loaded)), (red(), vec![ignored.to_owned()]));
}

/// Libraries by which nothing at all would be seen mean the opposite.
#[test]
fn libraries_of_invisible_materials_are_opaque() {
    let opposite = "a.mtl:1: every material of this library would be invisible; `Tr` and `d` are read the \
                    other way round, as some exporters write them";
    let red_with = |rest: &str| format!("newmtl m\nKd 0.8 0.1 0.1\n{rest}\n");
    for rest in ["Tr 1.000000\nillum 2\nNs 0", "d 0", "d 0.0\nTr 1", "Tr 1\nillum 4\nNi 1.5"] {
        let loaded = triangle_of(&red_with(rest)).expect(rest);
        assert_eq!(warnings(&loaded), [opposite], "{rest}");
        assert_eq!(first_material(&loaded), red(), "{rest}");
    }
    let two = red_with("Tr 1") + "newmtl n\nd 0\n";
    let loaded = triangle_of(&two).expect("fine");
    assert_eq!(warnings(&loaded), [opposite]);
    assert_eq!(loaded.scene.materials, [red(), grey()]);

    // One that is seen shows that the others are meant so.
    let invisible = "a.obj: material `m` is invisible: light passes as if it were not there; \
                     check `d` and `Tr`, or `k_t`";
    for rest in ["Tr 1\nnewmtl n", "d 0\nnewmtl n\nTr 0.5"] {
        let loaded = triangle_of(&red_with(rest)).expect(rest);
        assert_eq!(warnings(&loaded), [invisible], "{rest}");
        assert_eq!(first_material(&loaded).k_t, Rgb::ONE);
    }
    // Unused, a filter, a mirror in glass, a lamp: nothing vanishes.
    for library in [
        "newmtl m\nKd 0.5\nnewmtl n\nd 0\n",
        "newmtl m\nd 0\nTf 1 0 0\n",
        "newmtl m\nd 0\nKs 0.1\nillum 4\n",
        "newmtl m\nd 0\nKe 1\n",
    ] {
        let loaded = triangle_of(library).expect(library);
        let amplifies = |w: &Warning| matches!(w.kind, WarningKind::Amplifies { .. });
        assert!(loaded.warnings.iter().all(amplifies), "{library}: {:?}", loaded.warnings);
    }
    // A library of its own each.
    let text = format!("mtllib a.mtl b.mtl\n{CORNERS}usemtl m\nf 1 2 3\nusemtl n\nf 1 3 2\n");
    let files: [(&str, &[u8]); 3] = [
        ("a.obj", text.as_bytes()),
        ("a.mtl", b"newmtl m\nTr 1\n"),
        ("b.mtl", b"newmtl n\nTr 0\n"),
    ];
    let loaded = load_from(&files, "a.obj").expect("fine");
    assert_eq!(
        (warnings(&loaded), loaded.scene.materials),
        (vec![opposite.to_owned()], vec![grey(); 2])
    );
    // In a scene file it can only be meant.
    let sphere = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'm'\n";
    let scene = format!("ambient = 1\nmaterial.m.k_t = 1\nmaterial.n.k_t = 1\n{sphere}{sphere}");
    let loaded = parse_scene(&scene, "s.toml", Path::new("")).expect("fine");
    assert_eq!(warnings(&loaded), [invisible.replace("a.obj", "s.toml")]);
}

/// A scene file's material stands in for those of a library, which need not even be there.
#[test]
fn replaced_materials_are_not_read() {
    let scene = "ambient = 1\nmaterial.m.rho_d = 0.5\n[[mesh]]\nobj = 'a.obj'\nmaterial = 'm'\n";
    let model = format!("mtllib a.mtl b.mtl\n{CORNERS}usemtl a\nf 1 2 3\nusemtl b\nf 1 3 2\n");
    let files: [(&str, &[u8]); 3] =
        [("s.toml", scene.as_bytes()), ("a.obj", model.as_bytes()), ("a.mtl", b"newmtl a\nKd x\n")];
    let loaded = load_from(&files, "s.toml").expect("fine");
    assert_eq!(warnings(&loaded), [""; 0]);
    assert_eq!(loaded.material_names, ["m"]);
    let ids: Vec<u32> = loaded.scene.mesh.faces.iter().map(|face| face.material.0).collect();
    assert_eq!(ids, [0, 0]);
    assert_refused(
        load_from(&files, "a.obj"),
        "a.mtl:2: Kd: `x` is not a number; write a number, with a decimal point",
    );
}
