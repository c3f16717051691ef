use super::*;
use crate::scene::{Material, Pigment};

fn with_library(library: impl AsRef<[u8]>) -> Result<Loaded, LoadError> {
    let text = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    load_from(&[("a.obj", text.as_bytes()), ("a.mtl", library.as_ref())], "a.obj")
}

fn material(statements: &str) -> Material {
    let loaded = with_library(format!("newmtl m\n{statements}\n")).expect("a good material");
    // The specification lets these kinds mirror and let pass light beside all that they scatter.
    let amplifies = |w: &Warning| matches!(w.kind, WarningKind::Amplifies { .. });
    let kinds = ["illum 4", "illum 6", "illum 7"];
    let expected = usize::from(kinds.iter().any(|kind| statements.contains(kind)));
    assert_eq!(loaded.warnings.len(), expected, "{:?}", loaded.warnings);
    assert!(loaded.warnings.iter().all(amplifies));
    loaded.scene.materials[0]
}

#[test]
fn materials_follow_the_specification() {
    let kd = Rgb::new(0.5, 0.25, 0.0);
    let matte = Material::matte(kd);
    let solid = Pigment::Solid;
    let surface = "Ka 1 1 1\nKd .5 .25 0\nKs .4\nNs 50\nNi 1.5\n";
    let shiny = Material { rho_s: Rgb::splat(0.4), shininess: 50.0, ..matte };
    let mirror = Material { k_s: Rgb::splat(0.4), ..shiny };
    let cases = [
        ("", shiny),
        ("illum 0", Material { rho_s: Rgb::ZERO, ..shiny }),
        ("illum 1", Material { rho_s: Rgb::ZERO, ..shiny }),
        ("illum 2", shiny),
        ("illum 3", mirror),
        ("illum 5", mirror),
        ("illum 8", shiny),
        ("illum 10", shiny),
        // Dissolved by three quarters: what is left of the surface, and light straight through.
        (
            "d .25",
            Material {
                rho_d: solid(0.25 * kd),
                rho_s: Rgb::splat(0.1),
                k_t: Rgb::splat(0.75),
                ..shiny
            },
        ),
        (
            "Tr .75\nillum 3\nTf 1 .5 0",
            Material {
                rho_d: solid(0.25 * kd),
                rho_s: Rgb::splat(0.1),
                k_s: Rgb::splat(0.1),
                k_t: Rgb::new(0.75, 0.375, 0.0),
                ..shiny
            },
        ),
        ("Tr 1\nd 1", shiny),
        ("illum 4\nd .25", Material { rho_d: solid(0.25 * kd), k_t: Rgb::splat(0.75), ..mirror }),
        ("illum 9\nd .25", Material { rho_d: solid(0.25 * kd), k_t: Rgb::splat(0.75), ..shiny }),
        (
            "illum 6\nTf 1 .5 0",
            Material { k_t: Rgb::new(0.6, 0.3, 0.0), refractive_index: 1.5, ..mirror },
        ),
        ("illum 7", Material { k_t: Rgb::splat(0.6), refractive_index: 1.5, ..mirror }),
        ("Ke 3 2 1", Material { emission: Rgb::new(3.0, 2.0, 1.0), ..shiny }),
    ];
    for (statements, expected) in cases {
        let found = material(&(surface.to_owned() + statements));
        let difference = (found.rho_s - expected.rho_s).abs()
            + (found.k_s - expected.k_s).abs()
            + (found.k_t - expected.k_t).abs();
        assert!(difference.max_element() < 1e-15, "{statements}: {found:?}");
        let rounded =
            Material { rho_s: expected.rho_s, k_s: expected.k_s, k_t: expected.k_t, ..found };
        assert_eq!(rounded, expected, "{statements}");
    }
    assert_eq!(material(""), Material::matte(Rgb::splat(0.75)));
    assert_eq!(material("Kd 0.5 # grey"), Material::matte(Rgb::splat(0.5)));
}

#[test]
fn bad_values_are_refused_with_their_line() {
    let share = "it must be between 0 and 1";
    let not_negative = "it must be finite and not negative";
    let radiance = "it must be between 0 and 1e30";
    let index = "it must be between 0.001 and 1000";
    let illum = "it must be a whole number from 0 to 10";
    let number = "write a number, with a decimal point";
    let three = "give it one number or three";
    for (bad, problem, cure) in [
        ("Kd", "Kd has 0 numbers", three),
        ("Kd .5 .5", "Kd has 2 numbers", three),
        ("Ks 1 1 1 1", "Ks has 4 numbers", three),
        ("Kd -1 0 0", "Kd is -1.0", share),
        ("Kd nan 0 0", "Kd is NaN", share),
        ("Ks 0 0 1.5", "Ks is 1.5", share),
        ("Tf 2", "Tf is 2.0", share),
        ("Kd 0,5 0,5 0,5", "Kd: `0,5` is not a number", number),
        ("Kd spectral a.rfl 1", "Kd: `spectral` is not a number", number),
        ("Kd .5 .5 1e39", "Kd is 1e39", share),
        ("Ke -1 0 0", "Ke is -1.0", radiance),
        ("Ke inf", "Ke is inf", radiance),
        ("Ke 0 2e30 0", "Ke is 2e30", radiance),
        ("Ns inf", "Ns is inf", not_negative),
        ("Ns -1", "Ns is -1.0", not_negative),
        ("Ns", "Ns has 0 numbers", "give it one number"),
        ("Ni 0", "Ni is 0.0", index),
        ("Ni 1e400", "Ni is inf", index),
        ("Ni 1001", "Ni is 1001.0", index),
        ("d 2", "d is 2.0", share),
        ("d -halo .5", "d: `-halo` is not a number", number),
        ("Tr -1", "Tr is -1.0", share),
        ("illum 2.5", "illum is 2.5", illum),
        ("illum 11", "illum is 11.0", illum),
        ("newmtl", "newmtl without a name", "name the material"),
        ("newmtl m", "material `m` is already defined at a.mtl:1", "rename one of the two"),
    ] {
        let message = format!("a.mtl:3: {problem}; {cure}");
        assert_refused(with_library(format!("newmtl m\n\n{bad}\n")), &message);
    }
    assert_refused(
        with_library("Kd 1 1 1\n"),
        "a.mtl:1: `Kd` before the first newmtl; start the material with `newmtl NAME`",
    );
}

#[test]
fn textures_and_foreign_statements_are_counted() {
    let text = "newmtl m\nmap_Kd -s 1 1 1 tex.png\nPr .5\nnewmtl b\nmap_Kd x.png\nkd 1 1 1\n";
    assert_eq!(
        warnings(&with_library(text).expect("fine")),
        [
            "a.mtl:2: `map_Kd` is ignored: the course has no such effect \
             (2 times, this is the first)",
            "a.mtl:3: `Pr` is ignored: the course has no such effect",
            "a.mtl:6: unknown statement ignored",
        ]
    );
}

#[test]
fn libraries_missing_or_shared() {
    let geometry = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let with = |head: &str| {
        let text = format!("{head}\n{geometry}usemtl m\nf 1 2 3\n");
        let files: [(&str, &[u8]); 6] = [
            ("models/a.obj", text.as_bytes()),
            ("models/again.mtl", b"# red\nnewmtl m\n"),
            ("models/m.mtl", b"newmtl m\nKd 1 0 0\n"),
            ("models/lib/other.mtl", b"newmtl other\n"),
            ("models/with space.mtl", b"newmtl m\n"),
            ("models/empty.mtl", b""),
        ];
        load_from(&files, "models/a.obj")
    };
    let red = Material::matte(Rgb::new(1.0, 0.0, 0.0));
    for head in [
        "mtllib m.mtl",
        "mtllib m.mtl lib/other.mtl",
        "mtllib lib\\other.mtl\nmtllib m.mtl",
        "mtllib m.mtl\nmtllib m.mtl",
    ] {
        let loaded = with(head).expect("fine");
        assert_eq!(warnings(&loaded), [""; 0]);
        let id = loaded.scene.mesh.faces[0].material;
        assert_eq!(loaded.scene.materials[id.0 as usize], red, "{head}");
    }
    assert_eq!(warnings(&with("mtllib with space.mtl").expect("fine")), [""; 0]);

    let missing =
        "models/a.obj:1: material library cannot be opened; its materials become light grey";
    let undefined = "material not defined in any library; its faces become light grey";
    assert_eq!(warnings(&with("mtllib gone.mtl m.mtl").expect("fine")), [missing]);
    let loaded = with("mtllib gone.mtl").expect("fine");
    assert_eq!(warnings(&loaded), [missing, &format!("models/a.obj:5: {undefined}")]);
    assert_eq!(loaded.scene.materials, [Material::matte(Rgb::splat(0.75))]);
    let undefined = format!("models/a.obj:5: {undefined}");
    assert_eq!(warnings(&with("mtllib empty.mtl").expect("fine")), [undefined.as_str()]);
    // A library that is the model itself: its statements are not those of a library.
    let itself = warnings(&with("mtllib a.obj").expect("fine"));
    assert_eq!(itself[0], "models/a.obj:1: unknown statement ignored (6 times, this is the first)");
    assert_eq!(itself[1], undefined);

    // One name, two meanings.
    assert_refused(
        with("mtllib m.mtl again.mtl"),
        "models/again.mtl:2: material `m` is already defined at models/m.mtl:1; rename one of the two",
    );
    for outside in OUTSIDE {
        assert_refused(
            with(&format!("mtllib {outside}")),
            &format!("models/a.obj:1: mtllib {}", is_outside(outside)),
        );
    }
    // Of several names each is looked at.
    assert_refused(
        with("mtllib m.mtl ../m.mtl"),
        &format!("models/a.obj:1: mtllib {}", is_outside("../m.mtl")),
    );
    for keyword in ["mtllib", "usemtl"] {
        assert_refused(
            with(keyword),
            &format!("models/a.obj:1: `{keyword}` without a name; name one or remove the line"),
        );
    }
}

#[test]
fn latin_1_names_match() {
    let text = b"mtllib a.mtl\nusemtl caf\xE9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let files: [(&str, &[u8]); 2] = [("a.obj", text), ("a.mtl", b"newmtl caf\xE9\nKd 1 0 0\n")];
    let loaded = load_from(&files, "a.obj").expect("fine");
    assert_eq!(loaded.scene.materials, [Material::matte(Rgb::new(1.0, 0.0, 0.0))]);
}

#[test]
fn materials_keep_their_names() {
    let model = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl <b> & c\nf 1 2 3\n";
    let scene = "material.z.rho_d = 1\nmaterial.a.rho_d = 0.5\n[[mesh]]\nobj = 'a.obj'\n\
                 [[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'z'\n";
    let files: [(&str, &[u8]); 3] = [
        ("s.toml", scene.as_bytes()),
        ("a.obj", model.as_bytes()),
        ("a.mtl", b"newmtl zinc\nKd 0.1\nnewmtl <b> & c\nKd 0.2\n"),
    ];
    let all = |loaded: &Loaded| -> Vec<(String, Material)> {
        loaded.material_names.iter().cloned().zip(loaded.scene.materials.iter().copied()).collect()
    };
    let named = |name: &str, grey: f64| (name.to_owned(), Material::matte(Rgb::splat(grey)));
    let of_model = [named("zinc", 0.1), named("<b> & c", 0.2), named(UNNAMED, 0.75)];
    let loaded = load_from(&files, "a.obj").expect("fine");
    assert_eq!(all(&loaded), of_model);
    let loaded = load_from(&files, "s.toml").expect("fine");
    assert_eq!(all(&loaded), [&[named("a", 0.5), named("z", 1.0)][..], &of_model].concat());
}
