//! Every index on the same rays: build, closest hit and occlusion, on one thread.
//!
//! `cargo bench -p chapter-4 -- --models DIR` adds the folder's `.obj` files to the generated scenes, and
//! `cargo bench -p chapter-4 -- bunny` picks by name.
#![allow(missing_docs)]

use std::hint::black_box;
use std::path::{Path, PathBuf};

use chapter_4::rays::Rays;
use chapter_4::scenes::{BUILDINGS, FAMILIES};
use criterion::{Criterion, Throughput};
use lancer_accel::structures::STRUCTURES;
use lancer_core::image::ImageSize;
use lancer_core::scene::{Scene, load};

/// The picture whose rays are traced.
const SIZE: ImageSize = ImageSize::new(256, 256);

/// Takes `--models DIR` out of the arguments, which criterion does not know.
fn arguments() -> (Option<PathBuf>, Vec<String>) {
    let mut arguments: Vec<String> = std::env::args().collect();
    let models = arguments.iter().position(|argument| argument == "--models").map(|place| {
        assert!(place + 1 < arguments.len(), "--models needs a folder");
        PathBuf::from(arguments.drain(place..=place + 1).nth(1).expect("two were taken"))
    });
    (models, arguments)
}

/// Generated scenes, and the models of a folder.
fn scenes(models: Option<&Path>) -> Vec<(String, Scene)> {
    let families = FAMILIES.into_iter().chain(BUILDINGS);
    let mut scenes: Vec<_> =
        families.map(|family| (family.name.to_owned(), family.scene(100_000))).collect();
    let mut files: Vec<_> = models.map_or_else(Vec::new, |folder| {
        let entries = std::fs::read_dir(folder).expect("--models names a folder");
        entries.map(|entry| entry.expect("an entry").path()).collect()
    });
    files.retain(|file| file.extension().is_some_and(|extension| extension == "obj"));
    files.sort();
    scenes.extend(files.iter().map(|file| {
        let name = file.file_stem().expect("a file has a name").to_string_lossy().into_owned();
        (name, load::load(file).expect("a model that can be read").scene)
    }));
    scenes
}

fn measure(criterion: &mut Criterion, name: &str, scene: &Scene) {
    let indexes = || STRUCTURES.iter().filter(|structure| structure.name != "linear");
    let triangles = scene.mesh.triangles.len() as u64;
    let mut group = criterion.benchmark_group(format!("{name}/build"));
    group.throughput(Throughput::Elements(triangles)).sample_size(10);
    for structure in indexes() {
        group.bench_function(structure.name, |bencher| {
            bencher.iter(|| black_box(structure.build(scene).bytes));
        });
    }
    group.finish();

    let built: Vec<_> =
        indexes().map(|structure| (structure.name, structure.build(scene))).collect();
    for rays in Rays::of(scene, SIZE, &*built[0].1.index) {
        let wanted = rays.trace(&*built[0].1.index);
        let mut group = criterion.benchmark_group(format!("{name}/{}", rays.kind.name()));
        group.throughput(Throughput::Elements(rays.queries.len() as u64)).sample_size(10);
        for (index, built) in &built {
            assert_eq!(rays.trace(&*built.index), wanted, "{name}: {index}");
            group.bench_function(*index, |bencher| bencher.iter(|| rays.trace(&*built.index)));
        }
        group.finish();
    }
}

fn main() {
    let (models, arguments) = arguments();
    let filter = arguments.iter().skip(1).find(|argument| !argument.starts_with('-'));
    let mut criterion = Criterion::default();
    if let Some(filter) = filter {
        criterion = criterion.with_filter(filter);
    }
    for (name, scene) in scenes(models.as_deref()) {
        measure(&mut criterion, &name, &scene);
    }
    criterion.final_summary();
}
