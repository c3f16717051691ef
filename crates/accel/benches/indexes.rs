//! Every index on the same rays: build, closest hit and occlusion, on one thread.
//!
//! `LANCER_MODELS=folder cargo bench -p lancer-accel` adds the folder's `.obj` files to the generated
//! scenes; `cargo bench -p lancer-accel -- bunny` picks by name.
#![allow(missing_docs)]

use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use lancer_accel::{Bvh, ObvhsBvh2, ObvhsCwbvh, Split};
use lancer_core::Rgb;
use lancer_core::generate::icosphere;
use lancer_core::geometry::{Interval, Ray, leave_surface};
use lancer_core::image::ImageSize;
use lancer_core::intersector::Intersector;
use lancer_core::sampling::Uniform;
use lancer_core::scene::{Camera, Material, MaterialId, Mesh, PointLight, Scene, load};

/// Builds an index of a scene.
pub type Build = for<'s> fn(&'s Scene) -> Box<dyn Intersector + 's>;

/// What is compared; the first one says how many rays hit.
pub const INDEXES: [(&str, Build); 4] = [
    ("obvhs-bvh2", |scene| Box::new(ObvhsBvh2::build(scene))),
    ("bvh", |scene| Box::new(Bvh::build(scene))),
    ("bvh, median", |scene| Box::new(Bvh::with_split(scene, Split::Median))),
    ("obvhs-cwbvh", |scene| Box::new(ObvhsCwbvh::build(scene))),
];

/// The picture whose rays are traced.
const SIZE: ImageSize = ImageSize::new(256, 256);

/// Rays of one kind, each with the interval in which it looks.
pub type Rays = Vec<(Ray, Interval)>;

/// The three kinds: neighbouring rays of a picture, rays from what they hit to a light, and one
/// bounce from there, cosine distributed.
pub fn rays(scene: &Scene, index: &dyn Intersector) -> [(&'static str, Rays); 3] {
    let camera = Camera::framing(scene.bounding_sphere().expect("a scene with something in it"));
    let light = PointLight::beside(&camera).position;
    let primary = camera.primary_rays(SIZE);
    let (mut coherent, mut shadow, mut diffuse) = (Rays::new(), Rays::new(), Rays::new());
    for y in 0..SIZE.height {
        for x in 0..SIZE.width {
            let ray = primary.through(f64::from(x) + 0.5, f64::from(y) + 0.5);
            coherent.push((ray, Interval::POSITIVE));
            let Some(hit) = index.closest_hit(&ray, Interval::POSITIVE) else { continue };
            let point = scene.surface_at(&ray, &hit);
            let facing = -point.geometric_normal.dot(ray.direction).signum();
            let normal = facing * point.geometric_normal;
            let leave = |d| leave_surface(point.position, point.error, normal, d);
            let origin = leave(light - point.position);
            if normal.dot(light - origin) > 0.0 {
                shadow.push((Ray::new(origin, light - origin), Interval::up_to(1.0)));
            }
            let direction = normal + Uniform::new(1, x, y).direction();
            diffuse.push((Ray::new(leave(direction), direction), Interval::POSITIVE));
        }
    }
    [("coherent", coherent), ("shadow", shadow), ("diffuse", diffuse)]
}

/// How many rays find a closest hit.
pub fn hits(index: &dyn Intersector, rays: &Rays) -> usize {
    rays.iter().filter(|(ray, range)| index.closest_hit(ray, *range).is_some()).count()
}

/// How many rays find any hit.
pub fn occluded(index: &dyn Intersector, rays: &Rays) -> usize {
    rays.iter().filter(|(ray, range)| index.occluded(ray, *range)).count()
}

/// Generated scenes, and the models in the folder that `LANCER_MODELS` names.
pub fn scenes() -> Vec<(String, Scene)> {
    let mut scenes = vec![
        ("icosphere-6".to_string(), scene_of(icosphere(6))),
        ("soup-100k".to_string(), scene_of(soup(100_000))),
    ];
    if let Some(folder) = std::env::var_os("LANCER_MODELS") {
        let entries = std::fs::read_dir(&folder).expect("LANCER_MODELS names a folder");
        let mut files: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
        files.retain(|file| file.extension().is_some_and(|extension| extension == "obj"));
        files.sort();
        for file in files {
            let name = file.file_stem().map(Path::new).map(|name| name.display().to_string());
            let loaded = load::load(&file).expect("a model that can be read");
            scenes.push((name.expect("a file has a name"), loaded.scene));
        }
    }
    scenes
}

fn scene_of(mesh: Mesh) -> Scene {
    Scene {
        camera: Camera { eye: DVec3::Z, look_at: DVec3::ZERO, up: DVec3::Y, fov: 40.0 },
        mesh,
        spheres: Vec::new(),
        materials: vec![Material::matte(Rgb::splat(0.5))],
        lights: Vec::new(),
        ambient: Rgb::ZERO,
        background: Rgb::ZERO,
    }
}

/// Triangles evenly spread over a cube, as large as the distance to their neighbours.
fn soup(count: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let size = f64::from(count).cbrt().recip();
    for k in 0..count {
        let mut random = Uniform::new(3, k, 0);
        let mut point = || DVec3::from_array(std::array::from_fn(|_| random.number()));
        let (corner, b, c) = (point(), point() - 0.5, point() - 0.5);
        mesh.positions.extend([corner, corner + size * b, corner + size * c]);
        mesh.push_face(MaterialId(0), &[[3 * k, 3 * k + 1, 3 * k + 2]]);
    }
    mesh
}

fn indexes(criterion: &mut Criterion) {
    for (name, scene) in scenes() {
        let triangles = scene.mesh.triangles.len() as u64;
        let mut group = criterion.benchmark_group(format!("{name}/build"));
        group.throughput(Throughput::Elements(triangles)).sample_size(10);
        for (index, build) in INDEXES {
            group.bench_function(index, |bencher| bencher.iter(|| black_box(build(&scene))));
        }
        group.finish();

        let indexes = INDEXES.map(|(name, build)| (name, build(&scene)));
        for (kind, rays) in rays(&scene, &*indexes[0].1) {
            let wanted = hits(&*indexes[0].1, &rays);
            for (index, built) in &indexes {
                assert_eq!(hits(&**built, &rays), wanted, "{name}, {kind}: {index}");
                assert_eq!(occluded(&**built, &rays), wanted, "{name}, {kind}: {index}");
            }
            for (question, ask) in [
                ("closest hit", hits as fn(&dyn Intersector, &Rays) -> usize),
                ("occlusion", occluded),
            ] {
                let mut group = criterion.benchmark_group(format!("{name}/{kind}, {question}"));
                group.throughput(Throughput::Elements(rays.len() as u64)).sample_size(10);
                for (index, built) in &indexes {
                    group.bench_function(*index, |bencher| bencher.iter(|| ask(&**built, &rays)));
                }
                group.finish();
            }
        }
    }
}

criterion_group!(benches, indexes);
criterion_main!(benches);
