//! 0 leaks in rays aimed at shared edges and vertices of closed meshes. Random rays find nothing, not
//! even with a leaking test, so every ray is aimed.

use glam::DVec3;
use lancer_accel::ObvhsBvh2;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::intersector::{Intersector, LinearScan};
use lancer_core::scene::{Mesh, Scene};
use lancer_lesson::naive::{BySigns, moeller_trumbore};

use crate::meshes::{OFFSETS, Target, aimed_ray, closed_meshes, moved};
use crate::random::Random;

/// Rays that leave a closed mesh from the inside without meeting it.
fn leaks(rays_per_mesh: usize) -> Vec<(String, usize)> {
    let mut counts = Vec::new();
    for (name, mesh) in closed_meshes() {
        for offset in OFFSETS {
            let scene = Scene::of_mesh(moved(&mesh, offset));
            let index = ObvhsBvh2::build(&scene);
            for target in [Target::Vertex, Target::Edge] {
                let mut random = Random::new(1);
                let leaks = (0..rays_per_mesh)
                    .filter(|_| {
                        let ray = aimed_ray(&scene.mesh, offset, target, &mut random);
                        index.closest_hit(&ray, Interval::POSITIVE).is_none()
                    })
                    .count();
                counts.push((format!("{name} at {offset}, {target:?}"), leaks));
            }
        }
    }
    counts
}

fn assert_no_leaks(rays_per_mesh: usize) {
    for (what, leaks) in leaks(rays_per_mesh) {
        assert_eq!(leaks, 0, "{what}: {leaks} of {rays_per_mesh} aimed rays leak");
    }
}

/// 24 classes of 42 000 rays: a million.
#[test]
fn no_leak_in_a_million_aimed_rays() {
    assert_no_leaks(42_000);
}

#[test]
#[ignore = "soak: 10^8 rays; cargo test --release -p lancer-tests -- --ignored"]
fn no_leak_in_a_hundred_million_aimed_rays() {
    assert_no_leaks(4_200_000);
}

#[test]
fn the_oracle_itself_does_not_leak() {
    for (name, mesh) in closed_meshes() {
        let scene = Scene::of_mesh(mesh);
        let oracle = LinearScan::new(&scene);
        let mut random = Random::new(2);
        for target in [Target::Vertex, Target::Edge] {
            for _ in 0..2_000 {
                let ray = aimed_ray(&scene.mesh, DVec3::ZERO, target, &mut random);
                assert!(
                    oracle.closest_hit(&ray, Interval::POSITIVE).is_some(),
                    "{name} {target:?}"
                );
            }
        }
    }
}

/// Scaling the whole world by a power of ten changes nothing.
#[test]
fn no_leak_at_any_scale() {
    let (_, mesh) = closed_meshes().swap_remove(0);
    for exponent in (-100..=100).step_by(20) {
        let scale = 10.0_f64.powi(exponent);
        let mut scaled = mesh.clone();
        for p in &mut scaled.positions {
            *p *= scale;
        }
        let scene = Scene::of_mesh(scaled);
        let index = ObvhsBvh2::build(&scene);
        let mut random = Random::new(3);
        for _ in 0..2_000 {
            let ray = aimed_ray(&mesh, DVec3::ZERO, Target::Vertex, &mut random);
            let ray = Ray::new(ray.origin * scale, ray.direction * scale);
            assert!(index.closest_hit(&ray, Interval::POSITIVE).is_some(), "scale 1e{exponent}");
        }
    }
}

/// Counts the rays for which a triangle test finds nothing in a closed mesh.
fn leaks_of(
    test: impl Fn([DVec3; 3], &Ray) -> Option<f64>,
    mesh: &Mesh,
    target: Target,
    rays: usize,
) -> usize {
    let mut random = Random::new(1);
    (0..rays)
        .filter(|_| {
            let ray = aimed_ray(mesh, DVec3::ZERO, target, &mut random);
            !(0..mesh.triangles.len()).any(|index| test(mesh.corners(index), &ray).is_some())
        })
        .count()
}

#[test]
fn the_naive_tests_leak_where_ours_does_not() {
    let meshes = closed_meshes();
    let (icosphere, cube) = (&meshes[0].1, &meshes[3].1);
    let naive = leaks_of(moeller_trumbore, icosphere, Target::Vertex, 5_000);
    assert!(naive > 100, "Möller-Trumbore leaks {naive} of 5 000 at vertices");
    let fused_edges = |corners, ray: &Ray| BySigns::new(ray).fused(corners);
    let fused = leaks_of(fused_edges, cube, Target::Edge, 50_000);
    assert!(fused > 1000, "one fused multiply-add leaks {fused} of 50 000 at edges");
}
