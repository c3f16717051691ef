use super::*;
use crate::scene::{Material, Pigment};

fn with_library(library: impl AsRef<[u8]>) -> Result<Loaded, LoadError> {
    let text = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    load_from(&[("a.obj", text.as_bytes()), ("a.mtl", library.as_ref())], "a.obj")
}

fn material(statements: &str) -> Material {
    let loaded = with_library(format!("newmtl m\n{statements}\n")).expect("a good material");
    // The specification lets these kinds mirror and let pass light beside all that they scatter; and a triangle that
    // refracts is open.
    let is = |kinds: &[&str]| usize::from(kinds.iter().any(|kind| statements.contains(kind)));
    let count = |holds: fn(&WarningKind) -> bool| {
        loaded.warnings.iter().filter(|warning| holds(&warning.kind)).count()
    };
    let amplifies = count(|kind| matches!(kind, WarningKind::Amplifies { .. }));
    let open = count(|kind| matches!(kind, WarningKind::OpenSurface { edges: 3, .. }));
    let expected = (is(&["illum 4", "illum 6", "illum 7"]), is(&["illum 6", "illum 7"]));
    assert_eq!((amplifies, open), expected, "{:?}", loaded.warnings);
    assert_eq!(amplifies + open, loaded.warnings.len(), "{:?}", loaded.warnings);
    loaded.scene.materials[0]
}

#[test]
fn materials_follow_the_specification() {
    let kd = Rgb::new(0.5, 0.25, 0.0);
    let matte = Material::matte(kd);
    let solid = Pigment::Solid;
    let surface = "Ka 1 1 1\nKd .5 .25 0\nKs .4\nNs 50\nNi 1.5\n";
    let shiny = Material { rho_s: Rgb::splat(0.4), shininess: 12.5, ..matte };
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
    let number = "write a number, with a decimal point";
    let three = "give it one number or three";
    for (bad, problem, cure) in [
        ("Kd", "Kd has 0 numbers", three),
        ("Kd .5 .5", "Kd has 2 numbers", three),
        ("Kd -1 0 0", "Kd is -1.0", share),
        ("Kd nan 0 0", "Kd is NaN", share),
        ("Ks 0 0 1.5", "Ks is 1.5", share),
        ("d 0.5\nTf 2", "Tf is 2.0", share),
        ("Kd 0,5 0,5 0,5", "Kd: `0,5` is not a number", number),
        ("Kd .5 .5 1e39", "Kd is 1e39", share),
        ("Ke -1 0 0", "Ke is -1.0", radiance),
        ("Ke inf", "Ke is inf", radiance),
        ("Ke 0 2e30 0", "Ke is 2e30", radiance),
        ("Ks 1\nNs inf", "Ns is inf", not_negative),
        ("Ks 1\nNs -inf", "Ns is -inf", not_negative),
        ("Ks 1\nNs", "Ns has 0 numbers", "give it one number"),
        ("illum 7\nNi 0", "Ni is 0.0", index),
        ("illum 6\nNi 1e400", "Ni is inf", index),
        ("illum 7\nNi 1001", "Ni is 1001.0", index),
        ("d 2", "d is 2.0", share),
        ("Tr -1", "Tr is -1.0", share),
    ] {
        let line = 3 + bad.matches('\n').count();
        let message = format!("a.mtl:{line}: {problem}; {cure}");
        assert_refused(with_library(format!("newmtl m\n\n{bad}\n")), &message);
    }
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
