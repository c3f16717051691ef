//! Files from careless, broken and hostile hands: each is drawn or refused, in one line that names the
//! file and, where a line is to blame, the line. Nothing panics.

use std::fs;
use std::path::Path;

use glam::{DVec2, DVec3};
use lancer_accel::ObvhsBvh2;
use lancer_core::geometry::Interval;
use lancer_core::image::{self, Image, ImageSize, save};
use lancer_core::intersector::Intersector;
use lancer_core::moving::{Moment, Moving};
use lancer_core::render::{Control, render_pixels};
use lancer_core::sampling::{Pattern, PixelSampling, Sample};
use lancer_core::scene::Scene;
use lancer_core::scene::load::{UNNAMED, WarningKind, load};
use lancer_core::world::World;
use lancer_whitted::{RayCounts, Settings, Whitted};
use tempfile::tempdir;

use crate::mutator::{mutate, repair_checksums};
use crate::random::Random;

const OBJ: &[u8] = b"# a box lid\nmtllib a.mtl\no lid\nv 0 0 0\nv 1 0 0.5\nv 1 1 0\nv -0.25 1 0\n\
    v 0.5 0.5 2\nvt 0 0\nvn 0 0 1\nvn 0.6 0 -.8\nusemtl red\nf 1//1 2//2 3//1\nf 1 2 3 4\n\
    g two\nusemtl glass\nf -1/1/1 -2/1/2 \\\n-3/1/1\nl 1 2\nf 1 3 2 4\nf 1 2 5 3 4\n\
    usemtl lamp\nf 1 2 5\n";
const MTL: &[u8] = b"newmtl red\nKa 1 1 1\nKd 1 0.5 0\nKs .2 .2 .2\nNs 10\nillum 2\nmap_Kd a.png\n\
    newmtl glass\nNi 1.5\nd 0.25\nTr .75\nTf 1 1 .5\nillum 7\nKe 0 0 0\n\
    newmtl lamp\nKe 5 4 3\nillum 3\nKs .5\n";
const TOML: &[u8] = b"ambient = 0.1\nbackground = [0, 0.5, 1]\n[camera]\neye = [0, 1, 5]\n\
    look_at = [0, 0, 0]\nfov = 40\nlens = 0.1\nfocus = 4\n[[light]]\nposition = [1, 2, 3]\nintensity = 9\n\
    [material.a]\nrho_d = { checker = [0.5, [1, 0, 1]], side = 2.5 }\nk_t = 0.1\nrho_s = 0.5\n\
    shininess = 20\ngloss = 50\nrefractive_index = 1.5\n[material.b]\nemission = 3\n\
    [[sphere]]\ncenter = [0, 0, 0]\nradius = 1.5\nmaterial = 'a'\nmove = [0, 1, 0]\n\
    [[sphere]]\ncenter = [2, 3, 0]\nradius = 0.5\nmaterial = 'b'\n\
    [[polygon]]\nvertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\nmaterial = 'b'\n\
    [[mesh]]\nobj = 'a.obj'\nscale = 2\nrotate = [0, 90, 0]\ntranslate = [0, 0, 1]\nmove = [0.5, 0, 0]\n";

const NAMES: [&str; 3] = ["a.obj", "a.mtl", "s.toml"];
const CONTENTS: [&[u8]; 3] = [OBJ, MTL, TOML];

/// Shown when a test fails on it.
struct Case(Vec<u8>);

impl Drop for Case {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("the file: {}", self.0.escape_ascii());
        }
    }
}

/// How many files were read and how many refused.
#[derive(Debug, Default)]
struct Tally {
    read: usize,
    refused: usize,
}

/// Mutates each of three files that belong together, loads them, and traces what is accepted.
fn read_mutated_scenes(count: usize, seed: u64) -> Tally {
    let mut random = Random::new(seed);
    let mut tally = Tally::default();
    for (mutated, name) in NAMES.into_iter().enumerate() {
        let folder = tempdir().unwrap();
        for (name, bytes) in NAMES.iter().zip(CONTENTS) {
            fs::write(folder.path().join(name), bytes).unwrap();
        }
        for i in 0..count / NAMES.len() {
            let case = Case(mutate(CONTENTS[mutated], &CONTENTS, &mut random));
            fs::write(folder.path().join(name), &case.0).unwrap();
            let scene = if name == "s.toml" || i % 2 == 0 { "s.toml" } else { "a.obj" };
            match load(&folder.path().join(scene)) {
                Ok(loaded) => {
                    tally.read += 1;
                    for warning in &loaded.warnings {
                        assert_one_line(&warning.to_string(), folder.path());
                    }
                    assert_sound(&loaded.scene);
                    assert_eq!(picture(&loaded.scene).defects().not_finite, 0);
                }
                Err(error) => {
                    tally.refused += 1;
                    let message = error.to_string();
                    let names_line = assert_one_line(&message, folder.path());
                    assert!(message.contains("; "), "no cure: {message}");
                    // Of these the whole file is guilty.
                    let whole = ["nothing to draw", "cannot be framed"];
                    assert!(names_line || whole.iter().any(|w| message.contains(w)), "{message}");
                }
            }
        }
    }
    tally
}

/// `FILE:LINE: problem; cure` or `FILE: problem; cure`, with a file of this folder; whether with a line.
fn assert_one_line(message: &str, folder: &Path) -> bool {
    assert!(message.len() < 600 && !message.contains(char::is_control), "{message:?}");
    let paths = NAMES.map(|name| folder.join(name).display().to_string());
    let rest = paths.iter().find_map(|path| message.strip_prefix(path.as_str())?.strip_prefix(':'));
    let rest = rest.unwrap_or_else(|| panic!("no file: {message}"));
    rest.split(':').next().is_some_and(|line| line.parse::<usize>().is_ok_and(|line| line > 0))
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
    assert!(!mesh.triangles.is_empty() || !scene.spheres.is_empty());
    for sphere in &scene.spheres {
        assert!(sphere.shape.center.is_finite() && sphere.shape.radius.is_finite());
        assert!(sphere.shape.radius > 0.0 && (sphere.material.0 as usize) < scene.materials.len());
    }
    for material in &scene.materials {
        let colors =
            [material.rho_s, material.k_s, material.k_t, material.rho_d.at(DVec3::ONE, DVec3::Y)];
        assert!(colors.iter().all(|c| c.cmpge(DVec3::ZERO).all() && c.cmple(DVec3::ONE).all()));
        assert!(material.emission.is_finite() && material.shininess.is_finite());
        assert!(material.refractive_index.is_finite() && material.refractive_index > 0.0);
        assert!(material.gloss.is_none_or(|gloss| gloss.is_finite() && gloss > 0.0));
    }
    assert_eq!(scene.camera.check(), Ok(()));
    // Gathers what moves, which panics if it is not there.
    let moving: usize = scene.moving().map(|(_, primitives)| primitives.len()).sum();
    assert_eq!(moving + scene.still().len(), scene.primitives().len());
    assert!(scene.motions.iter().all(|motion| motion.displacement.is_finite()));
    assert!(scene.ambient.is_finite() && scene.background.is_finite());
    for light in &scene.lights {
        assert!(light.position.is_finite() && light.intensity.is_finite());
    }
}

fn picture(scene: &Scene) -> Image {
    let index = ObvhsBvh2::build(scene);
    let method = Whitted::new(World { scene, index: &index }, Settings::default());
    let size = ImageSize::new(8, 8);
    let rays = scene.camera.primary_rays(size);
    let sampling = PixelSampling { pattern: Pattern::Regular, samples: 1, seed: 0 };
    let moving = Moving::new(scene, &|primitives| Box::new(ObvhsBvh2::build(primitives)));
    let radiance = |sample: &Sample, counts: &mut RayCounts| {
        let ray = rays.through_lens(sample.film, DVec2::new(-0.6, 0.8));
        let moment = Moment::from(&moving).at(0.75);
        if let Some(hit) = moment.closest_hit(&ray, Interval::POSITIVE) {
            assert!(moment.surface_at(&ray, &hit).position.is_finite());
        }
        method.trace(&rays.through(sample.film.x, sample.film.y), counts)
    };
    render_pixels(size, sampling, Control::default(), radiance).unwrap().image
}

/// Mutates a picture in both formats and loads it; every second PNG gets its checksums right again,
/// or hardly anything behind them would be reached.
fn read_mutated_pictures(count: usize, seed: u64) -> Tally {
    let mut random = Random::new(seed);
    let mut tally = Tally::default();
    let folder = tempdir().unwrap();
    let paths = ["a.png", "a.exr"].map(|name| folder.path().join(name));
    let size = ImageSize::new(7, 5);
    let pixels = (0..size.pixels()).map(|i| [i as f32 / 9.0, 0.5, (i * i) as f32]).collect();
    let good = Image::from_pixels(size, pixels);
    let contents = paths.each_ref().map(|path| {
        save(path, &good, 0.0).unwrap();
        fs::read(path).unwrap()
    });
    let donors = contents.each_ref().map(Vec::as_slice);
    for i in 0..count {
        let path = &paths[i % 2];
        let mut case = Case(mutate(&contents[i % 2], &donors, &mut random));
        if i % 4 == 0 {
            repair_checksums(&mut case.0);
        }
        fs::write(path, &case.0).unwrap();
        match image::load(path) {
            Ok(image) => {
                tally.read += 1;
                assert_eq!(image.pixels().len(), image.size().pixels());
            }
            Err(error) => {
                tally.refused += 1;
                let message = error.to_string();
                assert!(message.contains(&path.display().to_string()), "{message}");
                assert!(message.len() < 600 && !message.contains(char::is_control), "{message:?}");
            }
        }
    }
    tally
}

/// Both ways are taken often, or the test has no teeth.
#[track_caller]
fn assert_both_ways(tally: &Tally) {
    println!("{tally:?}");
    let least = (tally.read + tally.refused) / 8;
    assert!(tally.read > least && tally.refused > least, "{tally:?}");
}

#[test]
fn mutated_scenes_are_drawn_or_refused() {
    assert_both_ways(&read_mutated_scenes(3000, 1999));
}

/// A library in the folder above, which is there, by every path that leads to it.
#[test]
fn no_library_outside_the_folder_is_read() {
    let outer = tempdir().unwrap();
    let inner = outer.path().join("inner");
    fs::create_dir(&inner).unwrap();
    let secret = outer.path().join("secret.mtl");
    fs::write(&secret, "newmtl m\nKd 1 0 0\n").unwrap();
    let absolute = secret.display().to_string();
    let paths =
        ["../secret.mtl", "..\\secret.mtl", "x/../../secret.mtl", "./../secret.mtl", &absolute];
    for path in paths {
        let text = format!("mtllib {path}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
        fs::write(inner.join("a.obj"), text).unwrap();
        let loaded = load(&inner.join("a.obj")).unwrap();
        assert_eq!(loaded.material_names, [UNNAMED], "{path}");
        assert_eq!(loaded.warnings[0].kind, WarningKind::MissingLibrary, "{path}");
    }
    fs::copy(secret, inner.join("secret.mtl")).unwrap();
    assert_eq!(load(&inner.join("a.obj")).unwrap().material_names, ["m"]);
}

#[test]
fn mutated_pictures_are_read_or_refused() {
    assert_both_ways(&read_mutated_pictures(1000, 1999));
}

#[test]
#[ignore = "soak: 10^5 files; cargo test --release -p lancer-tests -- --ignored"]
fn many_mutated_scenes_are_drawn_or_refused() {
    assert_both_ways(&read_mutated_scenes(100_000, 68));
}

#[test]
#[ignore = "soak: 10^5 files; cargo test --release -p lancer-tests -- --ignored"]
fn many_mutated_pictures_are_read_or_refused() {
    assert_both_ways(&read_mutated_pictures(100_000, 68));
}
