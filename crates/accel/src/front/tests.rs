use std::collections::BTreeSet;

use glam::{DVec2, DVec3};
use lancer_core::generate::{icosphere, sphere_flake};
use lancer_core::geometry::{Bounds3, ConvexVolume, Interval, Ray, Sphere};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{BeamIndex, Intersector, LinearScan, TestCounts};
use lancer_core::scene::{Camera, MaterialId, PrimitiveId, Scene, Shape, SphereObject, Subset};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

use crate::hard_sets::{hard_sets, triangles};
use crate::{Bvh, Grid, Wide};

/// Every index that beams can ask.
struct Indexes<'s> {
    linear: LinearScan<'s>,
    bvh: Bvh<'s>,
    /// Of whole primitives, and of what may be split.
    whole: Wide<'s>,
    wide: Wide<'s>,
    grid: Grid<'s>,
}

impl<'s> Indexes<'s> {
    fn build(primitives: impl Into<Subset<'s>>) -> Self {
        let all = primitives.into();
        Self {
            linear: LinearScan::new(all.clone()),
            bvh: Bvh::build(all.clone()),
            whole: Wide::fast(all.clone()),
            wide: Wide::build(all.clone()),
            grid: Grid::build(all),
        }
    }
}

fn found(index: &dyn BeamIndex, volume: &ConvexVolume, far: f64) -> Vec<PrimitiveId> {
    let mut found = Vec::new();
    index.visit_beam(volume, far, &mut |primitive| {
        found.push(primitive);
        f64::INFINITY
    });
    found
}

fn set(found: &[PrimitiveId]) -> BTreeSet<PrimitiveId> {
    let set: BTreeSet<_> = found.iter().copied().collect();
    assert_eq!(set.len(), found.len(), "a primitive came twice");
    set
}

/// The depths at which a primitive begins and ends.
fn extent(scene: &Scene, volume: &ConvexVolume, primitive: PrimitiveId) -> [f64; 2] {
    let Ray { origin, direction } = volume.axis();
    let Bounds3 { min, max } = scene.primitive_bounds(primitive);
    let corners = match scene.shape(primitive) {
        Shape::Triangle(index) => scene.mesh.corners(index).to_vec(),
        Shape::Sphere(_) => (0..8)
            .map(|k| DVec3::from_array([0, 1, 2].map(|axis| [min, max][k >> axis & 1][axis])))
            .collect(),
    };
    let depths = corners.iter().map(|&corner| direction.dot(corner - origin));
    [depths.clone().fold(f64::INFINITY, f64::min), depths.fold(f64::NEG_INFINITY, f64::max)]
}

/// Asks all, and checks all that they promise of each other. Returns what brute force finds, and
/// what both the grid and the index of split primitives do.
fn agree(
    scene: &Scene,
    Indexes { linear, bvh, whole, wide, grid }: &Indexes,
    volume: &ConvexVolume,
    far: f64,
) -> [BTreeSet<PrimitiveId>; 2] {
    let all = found(linear, volume, far);
    assert_eq!(found(bvh, volume, far), all, "{volume:?}");
    assert_eq!(found(whole, volume, far), all, "{volume:?}");
    let size = (scene.bounds().max - scene.bounds().min).max_element();
    let [by_parts, by_cells] = [found(wide, volume, far), found(grid, volume, far)];
    // By how much they grow their boxes and cells, and what is in the cells.
    for (ours, slack) in [(&by_parts, 4e-7 * size), (&by_cells, 1e-8 * size)] {
        // Brute force knows all of a primitive, not only the surface's parts and cells.
        assert!(set(ours).is_subset(&set(&all)));
        let mut begun = f64::NEG_INFINITY;
        for &primitive in ours {
            let [begin, end] = extent(scene, volume, primitive);
            assert!(begun <= end + slack, "{begun} {end}");
            begun = begun.max(begin);
        }
    }
    [set(&all), &set(&by_parts) & &set(&by_cells)]
}

type V = [i64; 3];

fn sub(a: V, b: V) -> V {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn dot(a: V, b: V) -> i64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn real(v: V) -> DVec3 {
    DVec3::from_array(v.map(|x| x as f64))
}

/// Whether a triangle and a pyramid have a point in common, in integers. A direction that separates
/// them, if there is one, can be turned until it is a product of such as are asked here: also where both
/// are flat or less.
fn exactly_meet(apex: V, corners: &[V], triangle: &[V; 3]) -> bool {
    let edges: Vec<V> = corners.iter().map(|&corner| sub(corner, apex)).collect();
    let mut ways = edges.clone();
    ways.extend(
        (0..3).flat_map(|k| [sub(triangle[(k + 1) % 3], triangle[k]), sub(triangle[k], apex)]),
    );
    let products = |others: &[V]| -> Vec<V> {
        ways.iter()
            .flat_map(|&a| others.iter().map(move |&b| cross(a, b)))
            .filter(|&n| n != [0; 3])
            .collect()
    };
    let normals = products(&ways);
    let separates = |&n: &V| {
        let sides = [n, n.map(|x| -x)];
        sides.into_iter().any(|n| {
            edges.iter().all(|&edge| dot(n, edge) <= 0)
                && triangle.iter().all(|&corner| dot(n, sub(corner, apex)) > 0)
        })
    };
    !(ways.iter().any(separates)
        || normals.iter().any(separates)
        || products(&normals).iter().any(separates))
}

/// Triangles and pyramids with all corners on a coarse lattice, at the origin and far from it: most pairs
/// that meet only touch, at a corner, along an edge or in a face.
#[test]
fn what_touches_a_beam_is_found() {
    let mut random = Pcg64::new(11, 1);
    let [mut met, mut by_center, mut by_corner] = [0; 3];
    for round in 0..40 {
        let place = [0, 1 << 20][round % 2];
        let mut below = |n: u64| (random.next_u64() % n) as i64;
        let mut point = |reach: u64| [0, 1, 2].map(|_| below(2 * reach + 1) - reach as i64);
        let mut near = |p: V, reach: u64| {
            let away = point(reach);
            [0, 1, 2].map(|k| p[k] + away[k])
        };
        let corners: Vec<[V; 3]> = (0..60)
            .map(|k| {
                let a = near([place; 3], 6);
                // Every tenth is a line or a point.
                let b = if k % 20 == 0 { a } else { near(a, 2) };
                let c = if k % 10 == 0 { b } else { near(a, 2) };
                [a, b, c]
            })
            .collect();
        let scene = triangles(corners.iter().map(|corners| corners.map(real)));
        let indexes = Indexes::build(&scene);
        for beam in 0..40 {
            let apex = near([place; 3], 8);
            let base = near([place; 3], 6);
            let [a, b] = [near([0; 3], 2), near([0; 3], 2)];
            let at = |u: i64, v: i64| [0, 1, 2].map(|k| base[k] + u * a[k] + v * b[k]);
            let window = match beam % 5 {
                0 => vec![at(0, 0)],
                1 => vec![at(0, 0), at(1, 0), at(2, 0)],
                2 => vec![at(0, 0), at(1, 0), at(0, 1)],
                _ => vec![at(0, 0), at(1, 0), at(1, 1), at(0, 1)],
            };
            let edges: Vec<DVec3> = window.iter().map(|&corner| real(sub(corner, apex))).collect();
            let volume = ConvexVolume::pyramid(Ray::new(real(apex), edges[0]), &edges);
            let [all, ours] = agree(&scene, &indexes, &volume, f64::INFINITY);
            let inside = |p: DVec3| volume.may_meet(&Bounds3 { min: p, max: p });
            for (k, triangle) in corners.iter().enumerate() {
                if !exactly_meet(apex, &window, triangle) {
                    continue;
                }
                let id = PrimitiveId(k as u32);
                assert!(all.contains(&id), "missed: {apex:?} {window:?} {triangle:?}");
                assert!(
                    ours.contains(&id),
                    "missed by parts or cells: {apex:?} {window:?} {triangle:?}"
                );
                // What is tempting instead of a separating plane.
                met += 1;
                by_corner += usize::from(!triangle.iter().any(|&corner| inside(real(corner))));
                by_center += usize::from(!inside(scene.primitive_bounds(id).center()));
            }
        }
    }
    assert!(
        met > 3_000 && by_corner > met / 10 && by_center > met / 10,
        "{met} {by_corner} {by_center}"
    );
}

/// Beams at a scene's primitives, from inside, outside and far away: wide, narrow, flat, a line. Each with
/// some rays in it.
fn beams(scene: &Scene, count: u32) -> Vec<(ConvexVolume, Vec<Ray>)> {
    let bounds = scene.bounds();
    let size = (bounds.max - bounds.min).max_element();
    let mut random = Pcg64::new(5, 1);
    let mut number = move || f64::from(random.next_u32()) / f64::from(u32::MAX);
    (0..if bounds.is_empty() { 0 } else { count })
        .map(|k| {
            let mut vector = || DVec3::new(number(), number(), number()) - 0.5;
            let away = [0.4, 3.0, 1e4][k as usize % 3];
            let apex = bounds.center() + size * away * vector();
            let at = (k as usize * 7919) % scene.primitives().len();
            let target = scene.primitive_bounds(PrimitiveId(at as u32)).center();
            let wide = (target - apex).length() * [1.0, 0.1, 1e-3, 1e-6][k as usize / 3 % 4];
            let (u, v) = (wide * vector(), wide * vector());
            let window = match k % 7 {
                0 => vec![target],
                1 => vec![target - u, target + u],
                _ => vec![target - u - v, target + u - v, target + u + v, target - u + v],
            };
            let edges: Vec<DVec3> = window.iter().map(|&corner| corner - apex).collect();
            let volume = ConvexVolume::pyramid(Ray::new(apex, target - apex), &edges);
            // Rays of a flat beam would leave it by their rounding.
            let rays = (0..if window.len() == 4 { 16 } else { 0 }).map(|_| {
                let middle = edges.iter().map(|&edge| (number(), edge));
                let (weight, sum) = middle.fold((0.0, DVec3::ZERO), |(w, sum), (part, edge)| {
                    (w + part, sum + part * edge)
                });
                Ray::new(apex, sum / weight)
            });
            (volume, rays.collect())
        })
        .collect()
}

/// What a ray in the beam hits is in the beam: the truth is another algorithm's.
fn rays_are_in_beams(name: &str, primitives: &Subset, count: u32) -> usize {
    let (scene, indexes) = (primitives.scene(), Indexes::build(primitives.clone()));
    let size = (scene.bounds().max - scene.bounds().min).max_element();
    let mut hits = 0;
    for (volume, rays) in beams(scene, count) {
        let [all, ours] = agree(scene, &indexes, &volume, f64::INFINITY);
        for ray in rays {
            let Some(hit) = indexes.bvh.closest_hit(&ray, Interval::POSITIVE) else { continue };
            hits += 1;
            assert!(all.contains(&hit.primitive), "{name}: {ray:?} {hit:?} {volume:?}");
            assert!(
                ours.contains(&hit.primitive),
                "{name}, parts or cells: {ray:?} {hit:?} {volume:?}"
            );
            // Up to its depth as well.
            let depth = volume.axis().direction.dot(ray.at(hit.t) - volume.axis().origin);
            let [all, ours] = agree(scene, &indexes, &volume, depth + 1e-9 * (size + depth));
            assert!(
                all.contains(&hit.primitive) && ours.contains(&hit.primitive),
                "{name}: {depth}"
            );
        }
    }
    hits
}

#[test]
fn hard_sets_are_searched() {
    let sets = hard_sets(1000);
    let hits: usize =
        sets.iter().map(|(name, scene)| rays_are_in_beams(name, &scene.into(), 42)).sum();
    assert!(hits > 500, "{hits}");
    let (_, empty) = &sets[0];
    let everywhere = ConvexVolume::of_half_spaces(Ray::new(DVec3::ZERO, DVec3::X), []);
    agree(empty, &Indexes::build(empty), &everywhere, f64::INFINITY);
    assert_eq!(found(&LinearScan::new(empty), &everywhere, f64::INFINITY), []);
}

#[test]
fn spheres_are_found() {
    let mut scene = Scene::of_mesh(icosphere(1));
    for k in 0..200 {
        let turn = f64::from(k) * 2.4;
        let center = DVec3::new(turn.cos(), turn.sin(), f64::from(k) / 100.0) * f64::from(k % 7);
        let shape = Sphere { center, radius: f64::from(k % 5) * 0.1 };
        scene.spheres.push(SphereObject { shape, material: MaterialId(0) });
    }
    let hits = rays_are_in_beams("spheres", &(&scene).into(), 300);
    assert!(hits > 500, "{hits}");
}

/// Rays in the border of a pixel, and triangles that touch it from outside, with a corner where the ray
/// passes: the eye at the origin and far away, the scene along with it. A pyramid through the points eye +
/// direction has lost the last digits of its directions, and misses what the ray hits.
#[test]
fn a_beam_finds_what_the_rays_in_its_border_hit() {
    const SIZE: u32 = 128;
    for (far, by_points_misses) in [(0.0, 0..1), (1e4, 100..2000), (1e8, 100..2000)] {
        let eye = far * DVec3::new(1.0, -2.0, 3.0);
        let toward = DVec3::new(-0.3, 0.2, 0.9);
        let camera = Camera { eye, look_at: eye + toward, up: DVec3::Y, fov: 40.0, lens: None };
        let rays = camera.primary_rays(ImageSize::new(SIZE, SIZE));
        let mut random = Pcg64::new(19, 1);
        let mut number = move || f64::from(random.next_u32()) / f64::from(u32::MAX);
        let mut corners = Vec::new();
        let mut pixels = Vec::new();
        for k in 0..SIZE / 2 * (SIZE / 4) {
            // Every other pixel of every fourth row.
            let [x, y] = [2 * (k % (SIZE / 2)), 4 * (k / (SIZE / 2)) + 2].map(f64::from);
            let along = x + 0.1 + 0.8 * number();
            let [distance, slope] = [3.0 + number(), 0.1 * number()];
            let at = |x, y, distance| rays.through(x, y).at(distance);
            corners.push([
                at(along, y, distance),
                at(along + 0.3, y - 0.8, distance - slope),
                at(along - 0.4, y - 0.7, distance + slope),
            ]);
            pixels.push((DVec2::new(x, y), rays.through(along, y)));
        }
        let scene = triangles(corners);
        let indexes = Indexes::build(&scene);
        let [mut hits, mut missed] = [0; 2];
        for (low, ray) in pixels {
            let Some(hit) = indexes.linear.closest_hit(&ray, Interval::POSITIVE) else { continue };
            hits += 1;
            let beam = rays.beam(low, low + 1.0);
            for found in agree(&scene, &indexes, &beam, f64::INFINITY) {
                assert!(found.contains(&hit.primitive), "{far}: {ray:?} {hit:?}");
            }
            let window = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
            let by_points = window.map(|(x, y)| {
                let direction = rays.through(low.x + x, low.y + y).direction;
                (eye + direction) - eye
            });
            let by_points = ConvexVolume::pyramid(beam.axis(), &by_points);
            missed += usize::from(scene.depth_in(&by_points, hit.primitive).is_none());
        }
        assert!(hits > 300 && by_points_misses.contains(&missed), "{far}: {missed} of {hits}");
    }
}

/// Over a subset a beam finds what of all it finds is in the subset.
#[test]
fn a_subset_is_searched() {
    let mut scene = Scene::of_mesh(icosphere(2));
    scene.spheres = sphere_flake(2, MaterialId(0));
    let (whole, nothing) = (LinearScan::new(&scene), Indexes::build(scene.subset([])));
    let [mut hits, mut left_out] = [0; 2];
    for step in [1, 3, 50, usize::MAX] {
        let some = scene.subset(scene.primitives().skip(1).step_by(step));
        hits += rays_are_in_beams("some", &some, 60);
        let indexes = Indexes::build(some.clone());
        for (volume, _) in beams(&scene, 60) {
            let mut wanted = found(&whole, &volume, f64::INFINITY);
            let of_all = wanted.len();
            wanted.retain(|&primitive| some.place(primitive).is_some());
            left_out += of_all - wanted.len();
            let [all, _] = agree(&scene, &indexes, &volume, f64::INFINITY);
            assert_eq!(all, set(&wanted));
            assert!(agree(&scene, &nothing, &volume, f64::INFINITY).iter().all(BTreeSet::is_empty));
        }
    }
    assert!(hits > 500 && left_out > 5_000, "{hits} {left_out}");
}

/// A visitor that has seen enough ends the search: both halves of a sphere, or its front only.
#[test]
fn a_bound_saves_work() {
    let scene = Scene::of_mesh(icosphere(5));
    let eye = DVec3::new(4.0, 3.0, 2.0);
    let edges = DVec3::AXES.map(|axis| 0.1 * (axis - DVec3::ONE / 3.0) - eye);
    let volume = ConvexVolume::pyramid(Ray::new(eye, -eye), &edges);
    let middle = eye.length();
    let search = |index: &dyn BeamIndex, bounded: bool| {
        let (mut counts, mut seen) = (TestCounts::default(), Vec::new());
        index.watch_beam(&volume, f64::INFINITY, &mut counts, &mut |primitive| {
            seen.push(primitive);
            if bounded { middle } else { f64::NAN }
        });
        (counts, seen)
    };
    let linear = LinearScan::new(&scene);
    let wanted = search(&linear, true);
    assert_eq!(wanted.0.primitives, scene.primitives().len() as u64);
    assert_eq!(found(&linear, &volume, middle), wanted.1);
    let (bvh, wide, grid) = (Bvh::build(&scene), Wide::build(&scene), Grid::build(&scene));
    for index in [&bvh as &dyn BeamIndex, &wide, &grid] {
        let [(all, both), (less, front)] = [false, true].map(|bounded| search(index, bounded));
        assert_eq!(set(&front), set(&wanted.1));
        assert!(both.len() > 3 * front.len() / 2 && !front.is_empty());
        let work = |counts: TestCounts| counts.boxes + counts.cells + counts.primitives;
        assert!(3 * work(less) < 2 * work(all), "{less:?} {all:?}");
        assert!(less.primitives < 5 * front.len() as u64, "{less:?} {}", front.len());
        // One is enough: what is already found behind it is not visited.
        let mut visits = 0;
        index.visit_beam(&volume, f64::INFINITY, &mut |_| {
            visits += 1;
            f64::NEG_INFINITY
        });
        assert_eq!(visits, 1);
    }
}
