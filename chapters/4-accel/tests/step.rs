//! A ray's walk through the indexes: what is told is what they do.

use chapter_4::scenes::{SCENES, family};
use chapter_4::step::record::{Event, Kind, Recorder};
use chapter_4::step::walk;
use glam::{DAffine3, DVec3};
use insta::assert_snapshot;
use lancer_accel::structures::STRUCTURES;
use lancer_core::geometry::{Bounds3, Interval};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Intersector, LinearScan, Query, TestCounts};
use lancer_core::scene::load::Loaded;
use lancer_core::scene::{Mesh, Scene};
use lancer_figure::Walk;
use lancer_lesson::chapter::WalkOrder;

fn walked(name: &str, loaded: &Loaded, pixel: [u32; 2], index: Option<&str>) -> Walk {
    let size = ImageSize::new(32, 32);
    walk(&WalkOrder { name, loaded, size, pixel, max_depth: None, index })
}

fn text(name: &str, pixel: [u32; 2], index: Option<&str>) -> String {
    walked(name, &opened(name, "100"), pixel, index).to_text()
}

fn opened(name: &str, count: &str) -> Loaded {
    SCENES.iter().find(|scene| scene.name == name).unwrap().open(Some(count)).unwrap()
}

#[test]
fn a_ray_through_the_bvh() {
    assert_snapshot!(text("town", [16, 22], Some("bvh")));
}

#[test]
fn a_ray_through_the_grid() {
    assert_snapshot!(text("town", [16, 22], Some("grid")));
}

#[test]
fn the_table_of_all() {
    let text = text("soup", [17, 12], None);
    let table = text.find("the ray ends").unwrap();
    assert_snapshot!(text[table..]);
}

/// Sums over the events, as an observer that counts has them.
fn counted(events: &[Event]) -> TestCounts {
    let mut counts = TestCounts::default();
    for event in events {
        match &event.kind {
            Kind::BoxMet { .. } => counts.boxes += 1,
            Kind::BoxesMissed { boxes, behind, empty, .. } => {
                assert!(behind + empty <= boxes.len());
                counts.boxes += boxes.len() as u64;
            }
            Kind::Cell { .. } => counts.cells += 1,
            Kind::PrimitiveMet { .. } => counts.primitives += 1,
            Kind::PrimitivesMissed(missed) => counts.primitives += missed.len() as u64,
        }
    }
    counts
}

/// Every test is told, with the hits that the index finds. The ray meets every cell that it
/// visits, and one of the boxes or cells that it meets holds the hit.
#[test]
fn records_are_complete_and_in_the_right_place() {
    for (name, count) in [("soup", 300), ("town", 500), ("stadium", 1000)] {
        let scene = family(name).scene(count);
        let oracle = LinearScan::new(&scene);
        let bounds = scene.bounds();
        let near = 1e-6 * (bounds.max - bounds.min).max_element();
        let within = |part: Bounds3, whole: Bounds3| {
            let whole = whole.grown(near);
            part.min.cmpge(whole.min).all() && part.max.cmple(whole.max).all()
        };
        let rays = scene.camera.primary_rays(ImageSize::new(8, 8));
        let mut hits = 0;
        for structure in STRUCTURES {
            let built = structure.build(&scene);
            for k in 0..64 {
                let ray = rays.through(f64::from(k % 8) + 0.5, f64::from(k / 8) + 0.5);
                let mut recorder = Recorder::new(&scene, &ray, Interval::POSITIVE);
                let answer =
                    built.index.watch(Query::closest(&ray, Interval::POSITIVE), &mut recorder);
                let Recorder { events, counts, .. } = recorder;
                assert_eq!(answer, oracle.closest_hit(&ray, Interval::POSITIVE));
                assert_eq!(events.last().and_then(|event| event.best), answer);
                assert_eq!(counted(&events), counts);
                let mut watched = TestCounts::default();
                built.index.watch(Query::closest(&ray, Interval::POSITIVE), &mut watched);
                assert_eq!(counts, watched);

                let on_the_way = |event: &Event| match event.kind {
                    Kind::BoxMet { bounds, .. } => Some(bounds),
                    Kind::Cell { bounds, inside, .. } => {
                        assert!(inside.is_some(), "{name} {}", structure.name);
                        Some(bounds)
                    }
                    _ => None,
                };
                let met: Vec<Bounds3> = events.iter().filter_map(on_the_way).collect();
                if let Some(hit) = answer.filter(|_| structure.name != "linear") {
                    let point = Bounds3::of_points([ray.at(hit.t)]);
                    let holds = |&part: &Bounds3| within(point, part);
                    assert!(met.iter().any(holds), "{name} {}", structure.name);
                    hits += 1;
                }
            }
        }
        assert!(hits > 50, "{name}: {hits}");
    }
}

#[test]
fn what_is_missed_or_empty_is_said() {
    let loaded = opened("scan", "300");
    let corner = walked("scan", &loaded, [0, 0], None).to_text();
    assert!(corner.contains("linear ends: every primitive is tested"), "{corner}");
    assert!(corner.contains("grid ends: the ray misses the box around the scene"), "{corner}");
    assert!(corner.contains("bvh ends: no box is left on the ray's way"), "{corner}");
    assert!(corner.contains("the ray ends: it meets nothing, as all agree"), "{corner}");
    let mut empty = loaded;
    let camera = empty.scene.camera;
    empty.scene = Scene { camera, ..Scene::of_mesh(Mesh::default()) };
    let walk = walked("empty", &empty, [1, 2], None);
    let text = walk.to_text();
    assert_eq!(text.matches("ends: there is nothing in the scene").count(), STRUCTURES.len());
    assert!(!walk.to_html().contains("NaN"));
}

#[test]
fn every_number_is_one_at_any_scale() {
    for scale in [1e-30, 1.0, 1e30] {
        let mut loaded = opened("soup", "200");
        let mut mesh = Mesh::default();
        mesh.append(&loaded.scene.mesh, DAffine3::from_scale(DVec3::splat(scale)), 0);
        loaded.scene.mesh = mesh;
        loaded.scene.camera.eye *= scale;
        loaded.scene.camera.look_at *= scale;
        let walk = walked("\u{1b}[31m<script>", &loaded, [14, 16], None);
        let (text, html) = (walk.to_text(), walk.to_html());
        assert!(!text.contains("NaN") && !text.contains("inf"), "{scale}: {text}");
        assert!(!text.contains("NOT"), "{text}");
        assert!(!text.contains('\u{1b}') && !html.contains('\u{1b}'));
        assert!(!html.contains("NaN") && !html.contains("http"));
        assert_eq!(html.matches("<script").count(), 1, "only the page's own");
    }
}
