use glam::dvec3;

use super::*;
use crate::scene::FaceId;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// One triangle (0,0,0) (1,0,0) (0,1,0), whatever the writing.
#[test]
fn every_way_to_write_a_triangle() {
    let ways: [&[u8]; 15] = [
        TRIANGLE.as_bytes(),
        b"\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3",
        b"v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r",
        b"v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n",
        b"\tv\t0 0  0 \n  v 1 0 0\n\nv 0 1 0\nf 1\t2 3 ",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\\\n 3\n",
        b"# caf\xE9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ncall x\n",
        b"f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n",
        b"v 0 0 0 # origin\nv 1 0 0\nv 0 1 0\nf 1 2 3 # the only one\n",
        b"v 0 0 0 2\nv 2 0 0 2\nv 0 .5e1 0 5.\nf 1 2 3\n",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\no first\ng a\ns 1\nf 1 2 3\ng b\n",
        b"v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nf 2 3 4\n",
        b"# C:\\models\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    ];
    for text in ways {
        let loaded = obj(text).unwrap_or_else(|error| panic!("{error}"));
        let mesh = &loaded.scene.mesh;
        let corners = [dvec3(0.0, 0.0, 0.0), dvec3(1.0, 0.0, 0.0), dvec3(0.0, 1.0, 0.0)];
        assert_eq!(mesh.corners(0), corners, "{}", text.escape_ascii());
        let counts =
            crate::scene::Counts { vertices: 3, faces: 1, triangles: 1, zero_area: 0, spheres: 0 };
        assert_eq!(loaded.scene.counts(), counts);
        assert_eq!(warnings(&loaded), [""; 0]);
        assert!(mesh.normals.is_empty() && mesh.smooth.is_empty());
    }
}

#[test]
fn positions_are_read_as_f64() {
    let loaded = obj("v 16777217 0.1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("fine");
    assert_eq!(loaded.scene.mesh.corners(0)[0], dvec3(16_777_217.0, 0.1, 0.0));
    // Beyond the largest `f32`.
    let loaded = obj("v 1e39 0 0\nv 0 1e39 0\nv 0 0 1e39\nf 1 2 3\n").expect("fine");
    assert_eq!(loaded.scene.mesh.corners(0)[0], dvec3(1e39, 0.0, 0.0));
}

#[test]
fn vertices_that_are_not_numbers_are_refused_with_their_line() {
    for bad in ["nan", "inf", "-inf", "1e400", "1e51"] {
        assert_refused(
            obj(format!("{TRIANGLE}v 0 {bad} 0\nf 1 2 4\n")),
            "a.obj:5: a coordinate is not finite, or beyond ±1e50; correct the number",
        );
    }
    for bad in ["v 1,5 2 3", "v 1 2", "v", "v a b c", "v 1 2 3 x", "v 1 2 x"] {
        assert_refused(
            obj(format!("{TRIANGLE}{bad}\n")),
            &format!("a.obj:5: `{bad}` cannot be read; write three numbers, with a decimal point"),
        );
    }
    assert_refused(
        obj(format!("{TRIANGLE}v 1 2 3 0\n")),
        "a.obj:5: `v 1 2 3 0` has the weight 0; remove the fourth number",
    );
}

#[test]
fn indices_out_of_range_are_refused_with_their_line() {
    let cure = "count from 1, or back from -1 for the latest";
    for bad in ["0", "4", "-4", "4294967296", "-9223372036854775808"] {
        assert_refused(
            obj(format!("{TRIANGLE}f 1 2 3\nf 1 2 {bad}\nf 1 2 3\n")),
            &format!("a.obj:6: the face names number {bad} of 3 vertices; {cure}"),
        );
    }
    let cure =
        "write vertex, vertex/texture, vertex//normal or vertex/texture/normal, as whole numbers";
    let thirty = "123456789012345678901234567890";
    for bad in ["1.0", thirty, "/1", "//1", "x", "x/1/1"] {
        assert_refused(
            obj(format!("{TRIANGLE}f 1 2 {bad}\n")),
            &format!("a.obj:5: `{bad}` is not a corner of a face; {cure}"),
        );
    }
}

#[test]
fn faces_with_too_few_corners_are_left_out() {
    let loaded = obj(format!("{TRIANGLE}f\nf 1\nf 1 9\nf 1 2 3\nf 3 x")).expect("fine");
    assert_eq!(loaded.scene.counts().faces, 2);
    assert_eq!(
        warnings(&loaded),
        ["a.obj:5: face with fewer than 3 corners left out (4 times, this is the first)"]
    );
}

#[test]
fn triangles_of_no_area_are_kept_and_counted() {
    let loaded = obj(format!("{TRIANGLE}v 2 0 0\nf 1 2 2\nf 1 2 4\nf 1 1 1\n")).expect("fine");
    assert_eq!((loaded.scene.counts().triangles, loaded.scene.counts().zero_area), (4, 3));
    assert_eq!(
        warnings(&loaded),
        ["a.obj:6: triangle of zero area (kept) (3 times, this is the first)"]
    );
}

#[test]
fn polygons_stay_one_face_and_keep_their_area() {
    for (text, expected) in [
        ("v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\nf 1 2 3 4\n", 1.0),
        ("v 4 0 0\nv 1 1 0\nv 0 4 0\nv 0 0 0\nf 1 2 3 4\n", 4.0),
        ("v 0 0 0\nv 0 2 0\nv 0 2 1\nv 0 1 1\nv 0 1 2\nv 0 0 2\nf 1 2 3 4 5 6\n", 3.0),
    ] {
        let loaded = obj(text).expect("fine");
        let mesh = &loaded.scene.mesh;
        assert!((area(mesh) - expected).abs() < 1e-12);
        assert_eq!(mesh.faces.len(), 1);
        assert!(mesh.triangles.iter().all(|t| t.face == FaceId(0)));
    }
}

#[test]
fn odd_polygons_are_reported() {
    let quad = |z| format!("v 0 0 0\nv 1 0 0\nv 1 1 {z}\nv 0 1 0\n");
    assert_eq!(
        warnings(&obj(quad(0) + "f 1 2 3 4\nf 1 3 2 4\n").expect("fine")),
        ["a.obj:6: polygon crosses itself; split it to get the right area"]
    );
    assert_eq!(
        warnings(&obj(quad(1) + "f 1 2 3\nf 1 2\nf 1 2 3 4\nf 1 2 3 4\n").expect("fine"))[1],
        "a.obj:7: polygon is not planar; split it into triangles (2 times, this is the first)"
    );
}

#[test]
fn what_is_not_drawn_is_counted() {
    let text = format!("{TRIANGLE}l 1 2 3\np 1\nV 1 2 3\n\0\nsurf 0 1 0 1 1 2 3\n");
    assert_eq!(
        warnings(&obj(text).expect("fine")),
        [
            "a.obj:5: lines, points, curves and surfaces ignored: only faces are drawn \
             (3 times, this is the first)",
            "a.obj:7: unknown statement ignored (2 times, this is the first)",
        ]
    );
}

#[test]
fn nothing_to_draw_is_refused() {
    let junk = vec![b'x'; 20 << 20];
    let bytes: Vec<u8> = (0..20_u32 << 20).map(|i| 128 | (i % 127) as u8).collect();
    for nothing in [&b""[..], b"\0", b"v 0 0 0\nf 1 1\n", b"# a comment", &junk, &bytes] {
        assert_refused(
            obj(nothing),
            "a.obj: nothing to draw: no face with 3 corners; \
             check that this is an OBJ file with `v` and `f` lines",
        );
    }
    assert_refused(
        obj("v 1 2 3\nf 1 1 1\n"),
        "a.obj: nothing to draw: all vertices are at one point; check the vertices",
    );
    assert_refused(
        obj(b"\xFF\xFEv\0 \x001\0"),
        "a.obj:1: the text is UTF-16; save the file as UTF-8",
    );
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::create_dir(folder.path().join("folder.obj")).expect("a folder");
    for name in ["missing.obj", "missing.toml"] {
        let path = folder.path().join(name);
        let error = load(&path).expect_err("refused");
        assert!(matches!(error, LoadError::Unreadable { .. }), "{error}");
        let message = error.to_string();
        assert!(message.starts_with(&format!("{}: ", path.display())), "{message}");
        assert!(message.ends_with("; check the path and its permissions"), "{message}");
    }
    // A folder in the place of a library is one that cannot be opened; of a mesh, the scene's mistake.
    let text = format!("mtllib folder.obj\n{TRIANGLE}");
    std::fs::write(folder.path().join("a.obj"), text).expect("a file");
    let loaded = load(&folder.path().join("a.obj")).expect("fine");
    assert_eq!(
        (loaded.warnings[0].line, &loaded.warnings[0].kind),
        (Some(1), &WarningKind::MissingLibrary)
    );
    let scene = folder.path().join("s.toml");
    std::fs::write(&scene, "[[mesh]]\nobj = 'folder.obj'\n").expect("a file");
    let message = load(&scene).expect_err("refused").to_string();
    assert!(message.starts_with(&format!("{}:2: ", scene.display())), "{message}");
    assert!(message.ends_with("; mesh files are looked for from the scene's folder"), "{message}");
    let path = folder.path().join("folder.obj");
    let expected = format!("{}: it is a folder; name a .obj or .toml file in it", path.display());
    assert_refused(load(&path), &expected);
    for name in ["a.stl", "a", ""] {
        assert_refused(
            load(Path::new(name)),
            &format!("{name}: unknown kind of scene; the known ones are .obj and .toml"),
        );
    }
}

/// Devices that never hold a scene: the one ends at once, the other never, in one line.
#[cfg(unix)]
#[test]
fn devices_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (device, name, problem) in [
        ("/dev/null", "a.obj", ": nothing to draw: no face with 3 corners; "),
        ("/dev/null", "a.toml", ": nothing to draw; "),
        ("/dev/zero", "b.obj", ":1: 67174400 or more bytes in a line, the maximum is 67108864; "),
        ("/dev/zero", "b.toml", ": 67108865 or more bytes, the maximum is 67108864; "),
    ] {
        let path = folder.path().join(name);
        std::os::unix::fs::symlink(device, &path).expect("a link");
        let message = load(&path).expect_err("refused").to_string();
        let expected = format!("{}{problem}", path.display());
        assert!(message.starts_with(&expected), "{message} for {expected}");
    }
}

/// What a file says reaches the terminal as text, on one line.
#[test]
fn messages_hold_no_control_characters() {
    assert_refused(
        obj("v 0 0 \u{1b}[2J\u{7}\n"),
        "a.obj:1: `v 0 0 \u{fffd}[2J\u{fffd}` cannot be read; write three numbers, with a decimal point",
    );
    let name = "a\u{1b}[2J.obj";
    assert_refused(
        load_from(&[(name, b"f 1 2 3\n")], name),
        "a\u{fffd}[2J.obj:1: the face names number 3 of 0 vertices; \
         count from 1, or back from -1 for the latest",
    );
}

/// Nothing is read beyond a size that squared lengths can tell.
#[test]
fn models_of_extreme_size_are_refused() {
    for size in ["1e-120", "1e-150", "1e50"] {
        let text = format!("v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nf 1 2 3\n");
        let message = obj(text).expect_err("refused").to_string();
        assert!(message.starts_with("a.obj: a scene of radius "), "{message}");
        assert!(message.ends_with(" cannot be framed; scale it to a size between 1e-100 and 1e49"));
    }
    for size in ["1e-90", "1e48"] {
        let text = format!("v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nf 1 2 3\n");
        assert_eq!(obj(text).expect("fine").scene.camera.check(), Ok(()));
    }
}

#[test]
fn normals_make_faces_smooth() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 2\nvn 3 0 0\nvn 0 1 0\n\
                f 1 2 3\nf 1/5/1 2/5/2 3/5/1 4/5/-1\nf 1//1 2//2 3\n";
    let loaded = obj(text).expect("fine");
    let mesh = &loaded.scene.mesh;
    let (up, tilted) = (dvec3(0.0, 0.0, 1.0), dvec3(1.0, 0.0, 0.0));
    assert_eq!(mesh.corner_normals(0), None);
    assert_eq!(mesh.corner_normals(1), Some([up, tilted, up]));
    assert_eq!(mesh.corner_normals(2), Some([up, up, dvec3(0.0, 1.0, 0.0)]));
    assert_eq!(mesh.corner_normals(3), None);
    assert_eq!(
        warnings(&loaded),
        ["a.obj:10: face with normals at some corners only is drawn flat"]
    );
    // Of any length: 3-4-5.
    for length in ["", "e-160", "e-310", "e300"] {
        let text = format!("{TRIANGLE}vn 3{length} 0 -4{length}\nf 1//1 2//1 3//1\n");
        let n = obj(text).expect("fine").scene.mesh.normals[0];
        assert!((n - dvec3(0.6, 0.0, -0.8)).length() < 1e-12, "{n}");
    }
}

#[test]
fn groups_and_materials_share_vertices() {
    let text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n\
                g one\nusemtl red\nf 1 2 3\ng two\nusemtl green\nf 2 4 3\nusemtl red\nf 1 2 4\n";
    let library = b"newmtl green\nKd 0 1 0\nnewmtl red\nKd 1 0 0\n";
    let loaded =
        load_from(&[("a.obj", text.as_bytes()), ("a.mtl", library)], "a.obj").expect("fine");
    let mesh = &loaded.scene.mesh;
    assert_eq!(mesh.positions.len(), 4);
    assert_eq!(mesh.faces.iter().map(|f| f.material.0).collect::<Vec<_>>(), [1, 0, 1]);
    assert_eq!(loaded.scene.materials.len(), 2);
}

#[test]
fn a_model_is_framed_and_lit_by_its_size() {
    for size in [0.15, 1.0, 6.0] {
        let text = format!("v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nv 0 0 {size}\nf 1 2 3\nf 1 2 4\n");
        let scene = obj(text).expect("fine").scene;
        // A cube of this side is centred at half of it, its corners √3/2 sides away.
        assert!((scene.camera.look_at - 0.5 * size).abs().max_element() < 1e-14);
        let distance = scene.camera.eye.distance(scene.camera.look_at);
        let expected = 0.75_f64.sqrt() * size / 20_f64.to_radians().sin();
        assert!((distance - expected).abs() < 1e-12 * size);
        let [light] = scene.lights[..] else { panic!("one light") };
        let reference = 3.0_f64.sqrt() / 2.0 / 20_f64.to_radians().sin();
        let per_square = light.intensity.x / (size * size) / (reference * reference);
        // The light is 0.2 camera distances aside of the line of sight: 0.6 (1² + 0.2²).
        assert!((per_square - 0.624).abs() < 1e-12, "{per_square}");
        assert!(scene.ambient.x > 0.0);
    }
    let text = "mtllib a.mtl\nusemtl lamp\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let files: [(&str, &[u8]); 2] =
        [("a.obj", text.as_bytes()), ("a.mtl", b"newmtl lamp\nKe 5 5 5\n")];
    assert!(load_from(&files, "a.obj").expect("fine").scene.lights.is_empty());
}
