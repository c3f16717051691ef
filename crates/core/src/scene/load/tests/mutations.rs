use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::*;

const OBJ: &str = "# a box lid\nmtllib a.mtl\no lid\nv 0 0 0\nv 1 0 0.5\nv 1 1 0\nv -0.25 1 0\n\
                   vt 0 0\nvn 0 0 1\nvn 0.6 0 -.8\nusemtl red\nf 1//1 2//2 3//1\nf 1 2 3 4\n\
                   g two\nusemtl glass\nf -1/1/1 -2/1/2 \\\n-3/1/1\nl 1 2\nf 1 3 2 4\n";
const MTL: &str = "newmtl red\nKa 1 1 1\nKd 1 0.5 0\nKs .2 .2 .2\nNs 10\nillum 2\nmap_Kd a.png\n\
                   newmtl glass\nNi 1.5\nd 0.25\nTr .75\nTf 1 1 .5\nillum 7\nKe 0 0 0\n";
const TOML: &str = "ambient = 0.1\nbackground = [0, 0.5, 1]\n[camera]\neye = [0, 1, 5]\n\
                    look_at = [0, 0, 0]\nfov = 40\n[[light]]\nposition = [1, 2, 3]\nintensity = 9\n\
                    [material.a]\nrho_d = { checker = [0.5, [1, 0, 1]], side = 2.5 }\nk_t = 0.1\n\
                    [[sphere]]\ncenter = [0, 0, 0]\nradius = 1.5\nmaterial = 'a'\n\
                    [[polygon]]\nvertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\nmaterial = 'a'\n\
                    [[mesh]]\nobj = 'a.obj'\nscale = 2\nrotate = [0, 90, 0]\n";

/// What a careless editor, a broken disk or a foreign exporter makes of numbers.
const NUMBERS: [&str; 16] = [
    "0",
    "-1",
    "1e400",
    "nan",
    "inf",
    "1e39",
    "4294967296",
    "-9223372036854775808",
    "1.0",
    "1,5",
    "",
    "1e-320",
    "/",
    "//",
    "..",
    "6148914691236517206",
];

/// One to four changes: a byte flipped, bytes removed or repeated, a number replaced.
fn mutate(text: &str, random: &mut Pcg32) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    let mut below = |n: usize| random.next_u32() as usize % n.max(1);
    for _ in 0..1 + below(4) {
        let start = below(bytes.len());
        let end = (start + 1 + below(12)).min(bytes.len());
        match below(4) {
            0 if start < bytes.len() => bytes[start] ^= 1 << below(8),
            1 => drop(bytes.drain(start..end)),
            2 => {
                let copy = bytes[start..end].to_vec();
                let at = below(bytes.len());
                bytes.splice(at..at, copy);
            }
            _ => {
                let is_digit = |b: &u8| b.is_ascii_digit();
                let first = bytes[start..].iter().position(is_digit).map_or(start, |i| start + i);
                let length = bytes[first..].iter().take_while(|b| is_digit(b)).count();
                let number = NUMBERS[below(NUMBERS.len())].bytes();
                bytes.splice(first..first + length, number);
            }
        }
    }
    bytes
}

/// No mutated file panics; a refusal is one line that names a file, and what is accepted is sound.
#[test]
fn mutated_files_are_drawn_or_refused() {
    let mut random = Pcg32::new(1999, 0);
    let (mut accepted, mut refused, mut with_line) = (0, 0, 0);
    for case in 0..6000 {
        let mut texts = [OBJ, MTL, TOML].map(|text| text.as_bytes().to_vec());
        texts[case % 3] = mutate([OBJ, MTL, TOML][case % 3], &mut random);
        let [obj, mtl, toml] = &texts;
        let files: [(&str, &[u8]); 3] = [("a.obj", obj), ("a.mtl", mtl), ("s.toml", toml)];
        let name = if case % 2 == 0 { "a.obj" } else { "s.toml" };
        match load_from(&files, name) {
            Ok(loaded) => {
                accepted += 1;
                assert_sound(&loaded.scene);
            }
            Err(error) => {
                refused += 1;
                let message = error.to_string();
                let is_named = files.iter().any(|(name, _)| message.starts_with(name));
                assert!(is_named && message.contains("; ") && !message.contains('\n'), "{message}");
                with_line += usize::from(matches!(error, LoadError::Invalid { line: Some(_), .. }));
            }
        }
    }
    // Both ways are taken often, or the test has no teeth.
    assert!(accepted > 1000 && refused > 1000, "{accepted} {refused}");
    assert!(with_line * 100 > refused * 90, "{with_line} of {refused}");
}

/// Every index is in range and every number finite.
fn assert_sound(scene: &Scene) {
    let mesh = &scene.mesh;
    let vertices = mesh.positions.len() as u32;
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-12));
    assert!(mesh.triangles.iter().all(|t| t.vertices.iter().all(|&v| v < vertices)));
    assert!(mesh.triangles.iter().all(|t| (t.face.0 as usize) < mesh.faces.len()));
    assert!(mesh.faces.iter().all(|f| (f.material.0 as usize) < scene.materials.len()));
    assert!(mesh.smooth.is_empty() || mesh.smooth.len() == mesh.triangles.len());
    let normals = mesh.normals.len() as u32;
    assert!(mesh.smooth.iter().flatten().flatten().all(|&n| n < normals));
    let camera = &scene.camera;
    let numbers = [camera.eye, camera.look_at, camera.up, scene.ambient, scene.background];
    assert!(numbers.iter().all(|v| v.is_finite()) && camera.fov > 0.0 && camera.fov < 180.0);
    for light in &scene.lights {
        assert!(light.position.is_finite() && light.intensity.is_finite());
    }
    assert!(!mesh.triangles.is_empty() || !scene.spheres.is_empty());
}
