//! LR step by step: what is told is what the method computes, to the last bit.

use std::path::Path;

use chapter_1::scenes;
use chapter_1::step::terms::{LocalTerms, Spawned};
use chapter_1::step::walk;
use insta::assert_snapshot;
use lancer_core::Rgb;
use lancer_core::geometry::Ray;
use lancer_core::illumination::recursion;
use lancer_core::image::ImageSize;
use lancer_core::intersector::LinearScan;
use lancer_core::scene::load::{Loaded, parse_scene};
use lancer_core::world::World;
use lancer_figure::Walk;
use lancer_lesson::chapter::WalkOrder;
use lancer_whitted::{RayEnd, RayTree, Settings, Whitted};

fn walked(name: &str, loaded: &Loaded, pixel: [u32; 2], max_depth: u32) -> Walk {
    let (size, max_depth) = (ImageSize::new(64, 48), Some(max_depth));
    walk(&WalkOrder { name, loaded, size, pixel, max_depth, index: None })
}

fn text(name: &str, pixel: [u32; 2], max_depth: u32) -> String {
    walked(name, &scenes::opened(name, None), pixel, max_depth).to_text()
}

/// algo:lr, eq:local and eq:recursion at every node of many trees; mirrors, glass, total reflection, lamps
/// behind, in shadow and in light, and an area light are among them.
#[test]
fn the_terms_add_up_to_what_the_method_computes() {
    let size = ImageSize::new(24, 24);
    let (mut glass_only, mut beyond) = (0, 0);
    let pane = parse_scene(PANE, "pane", Path::new("")).unwrap().scene;
    let scenes = [("whitted", scenes::whitted()), ("room", scenes::room()), ("pane", pane)];
    for (name, scene) in scenes {
        let (index, sources) = (LinearScan::new(&scene), scene.point_sources());
        let whitted = Whitted::new(World { scene: &scene, index: &index }, Settings::default());
        let rays = scene.camera.primary_rays(size);
        for k in 0..size.pixels() as u32 {
            let ray = rays.through(f64::from(k % 24) + 0.5, f64::from(k / 24) + 0.5);
            let mut tree = RayTree::default();
            assert_eq!(whitted.trace(&ray, &mut tree), whitted.trace(&ray, &mut ()));
            for (k, node) in tree.nodes.iter().enumerate() {
                let RayEnd::Surface { hit, local, .. } = node.end else { continue };
                let surface = scene.surface_at(&node.call.ray, &hit);
                let terms = LocalTerms::new(&scene, &sources, node, &surface);
                assert_eq!(terms.sum(), local, "{name}");
                let asked = terms.lamps.iter().filter(|lamp| lamp.shadow.is_some()).count();
                assert_eq!(asked, node.shadows.len(), "each shadow ray has its lamp");
                let spawned = Spawned::new(&scene, &tree, k, &surface);
                let answer =
                    |child: Option<usize>| child.map_or(Rgb::ZERO, |c| tree.nodes[c].radiance);
                let (mirror, refracted) = (answer(spawned.mirror), answer(spawned.refracted));
                let sum = recursion(local, spawned.k_s, mirror, spawned.k_t, refracted);
                assert_eq!(sum, node.radiance, "{name}");
                // sin θ of the ray is more than n₂ / n₁ = 2 / 3.
                let sin_squared = 1.0 - node.call.ray.direction.y.powi(2);
                let is_beyond = name == "pane" && sin_squared > 4.0 / 9.0;
                assert_eq!(spawned.total_reflection, is_beyond, "{name}");
                glass_only += u32::from(name == "pane");
                beyond += u32::from(is_beyond);
            }
        }
    }
    assert!(0 < beyond && beyond < glass_only, "both sides of the critical angle: {beyond}");
}

/// The upper side of glass, seen from inside.
const PANE: &str = "
    background = [0.25, 0.5, 0.75]
    [camera]
    eye = [0, -2, 0]
    look_at = [1.8, 0, 0]
    fov = 40
    [[light]]
    position = [1, -1, 0]
    intensity = 1
    [material.glass]
    rho_d = 0.1
    rho_s = 0.5
    shininess = 3
    k_s = 0.1
    k_t = [0.9, 0.8, 0.7]
    refractive_index = 1.5
    [[polygon]]
    vertices = [[-99, 0, 99], [99, 0, 99], [99, 0, -99], [-99, 0, -99]]
    material = 'glass'";

/// A lamp of I = 8 two units above a matte and shiny floor, the eye in the same direction at 3 units.
const BELOW_A_LAMP: &str = "
    ambient = 0.25
    [camera]
    eye = [0, 3, 0]
    look_at = [0, 0, 0]
    up = [0, 0, -1]
    fov = 10
    [[light]]
    position = [0, 2, 0]
    intensity = 8
    [material.'<script>alert(1)</script>']
    rho_d = [0.5, 0.25, 0]
    rho_s = 0.125
    shininess = 7
    [[polygon]]
    vertices = [[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]]
    material = '<script>alert(1)</script>'";

#[test]
fn terms_by_hand() {
    let scene = parse_scene(BELOW_A_LAMP, "floor", Path::new("")).unwrap().scene;
    let index = LinearScan::new(&scene);
    let whitted = Whitted::new(World { scene: &scene, index: &index }, Settings::default());
    let mut tree = RayTree::default();
    let ray = Ray::new(glam::DVec3::new(0.0, 3.0, 0.0), -glam::DVec3::Y);
    whitted.trace(&ray, &mut tree);
    let node = &tree.nodes[0];
    let RayEnd::Surface { hit, .. } = node.end else { panic!("the floor is met") };
    let surface = scene.surface_at(&ray, &hit);
    let terms = LocalTerms::new(&scene, &scene.point_sources(), node, &surface);
    assert_eq!(terms.ambient, Rgb::new(0.125, 0.0625, 0.0), "ρ_d I_a");
    let lamp = &terms.lamps[0];
    let near = |a: Rgb, b: Rgb| assert!((a - b).abs().max_element() < 1e-12, "{a} {b}");
    near(Rgb::new(lamp.distance, lamp.cos_light, lamp.cos_mirror), Rgb::new(2.0, 1.0, 1.0));
    near(lamp.diffuse, Rgb::new(0.5, 0.25, 0.0));
    near(lamp.specular, Rgb::splat(0.125));
    // 8 / 2² = 2 times the two parts.
    near(lamp.value(), Rgb::new(1.25, 0.75, 0.25));
}

#[test]
fn a_pixel_of_glass() {
    assert_snapshot!(text("whitted", [30, 15], 2));
}

#[test]
fn a_pixel_of_the_floor_in_half_shadow() {
    assert_snapshot!(text("whitted", [40, 38], 5));
}

#[test]
fn a_pixel_of_the_mirror_in_the_room() {
    assert_snapshot!(text("room", [28, 22], 1));
}

#[test]
fn a_pixel_that_meets_nothing_takes_one_step() {
    let scene = scenes::opened("whitted", None);
    let walk = walked("whitted", &scene, [0, 0], 5);
    assert_eq!(walk.steps.len(), 1);
    let text = walk.to_text();
    assert!(
        text.ends_with("meets nothing; it returns the background (0.28, 0.45, 0.72)\n"),
        "{text}"
    );
    assert!(walk.to_html().contains("max=\"1\""));
}

#[test]
fn every_number_is_one_and_names_are_harmless() {
    let hostile = parse_scene(BELOW_A_LAMP, "floor", Path::new("")).unwrap();
    let mut dark = hostile.clone();
    dark.scene.lights.clear();
    let flake = scenes::opened("flake", Some("1"));
    let whitted = scenes::opened("whitted", None);
    let mut last = String::new();
    for (name, loaded) in [
        ("floor", &hostile),
        ("dark", &dark),
        ("flake", &flake),
        ("whitted", &whitted),
        ("\u{1b}[31m", &dark),
    ] {
        for pixel in [[0, 0], [32, 24], [20, 30], [63, 47]] {
            let walk = walked(name, loaded, pixel, 5);
            let (text, html) = (walk.to_text(), walk.to_html());
            assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
            assert!(!text.contains('\u{1b}') && !html.contains('\u{1b}'));
            assert!(!html.contains("NaN") && !html.contains("http"), "{name} {pixel:?}");
            assert_eq!(html.matches("<script").count(), 1, "only the page's own");
            last = text;
        }
    }
    assert!(last.contains("the scene has no lamp"), "{last}");
}
