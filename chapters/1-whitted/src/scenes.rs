//! The chapter's scenes: written ones from `scenes/`, and generated ones with a level of detail.

use std::path::Path;

use anyhow::{Context, Result};
use lancer_core::generate::{gears, sphere_flake, tetrahedra};
use lancer_core::scene::load::{Loaded, parse_scene};
use lancer_core::scene::{Camera, MaterialId, PointLight, Scene};
use lancer_lesson::scenes::{NamedScene, Source};

/// All of them.
pub const SCENES: [NamedScene; 6] = [
    NamedScene::written("whitted", include_str!("../scenes/whitted.toml")),
    NamedScene::written("room", include_str!("../scenes/room.toml")),
    NamedScene::written("horizon", include_str!("../scenes/horizon.toml")),
    generated("flake"),
    generated("tetrahedra"),
    generated("gears"),
];

const fn generated(name: &'static str) -> NamedScene {
    let variants = "a level of detail, such as flake:4";
    NamedScene { name, source: Source::Generated { variants, make: detailed } }
}

/// What a generated scene is: its name, the level it has unless another is asked for, the highest level, and
/// what fills it.
struct Shapes {
    name: &'static str,
    level: u32,
    highest: u32,
    fill: fn(&mut Scene, u32),
}

const SHAPES: [Shapes; 3] = [
    Shapes {
        name: "flake",
        level: 3,
        highest: 7,
        fill: |scene, level| scene.spheres.extend(sphere_flake(level, MaterialId(0))),
    },
    Shapes {
        name: "tetrahedra",
        level: 5,
        highest: 11,
        fill: |scene, level| scene.mesh = tetrahedra(level, MaterialId(0)),
    },
    Shapes {
        name: "gears",
        level: 3,
        highest: 30,
        fill: |scene, level| scene.mesh = gears(level.max(1), MaterialId(0)),
    },
];

/// Whitted's composition of 1980, in an arrangement of our own.
pub fn whitted() -> Scene {
    opened("whitted", None).scene
}

/// A polyhedral room with a planar mirror and a rectangular lamp.
pub fn room() -> Scene {
    opened("room", None).scene
}

/// A checkered floor to the horizon.
pub fn horizon() -> Scene {
    opened("horizon", None).scene
}

/// One of the scenes, by its name and level.
///
/// # Panics
/// If there is none.
pub fn opened(name: &str, level: Option<&str>) -> Loaded {
    let scene = SCENES.iter().find(|scene| scene.name == name);
    let loaded = scene.unwrap_or_else(|| panic!("no scene is called {name:?}")).open(level);
    loaded.unwrap_or_else(|error| panic!("{error}"))
}

/// A generated scene of that name, with a level of detail: the shapes, slightly reflecting, framed and lit from
/// beside the camera.
fn detailed(name: &str, level: Option<&str>) -> Result<Loaded> {
    let shapes = SHAPES.iter().find(|shapes| shapes.name == name).context("no generated scene")?;
    let highest = shapes.highest;
    let parsed = level.map_or(Some(shapes.level), |text| text.parse().ok());
    let level = parsed.filter(|level| *level <= highest).with_context(|| {
        format!("{name}:{}: the level is a number from 0 to {highest}", level.unwrap_or_default())
    })?;
    let material = "
            ambient = 0.06
            background = [0.2, 0.25, 0.3]
            [material.shape]
            rho_d = [0.75, 0.62, 0.42]
            rho_s = 0.3
            shininess = 30
            k_s = 0.2
            [[sphere]]
            center = [0, 0, 0]
            radius = 1
            material = 'shape'";
    let mut loaded = parse_scene(material, name, Path::new(""))?;
    let scene = &mut loaded.scene;
    scene.spheres.clear();
    (shapes.fill)(scene, level);
    scene.camera = Camera::framing(scene.bounding_sphere().context("an empty scene")?);
    scene.lights.push(PointLight::beside(&scene.camera));
    loaded.headlight = true;
    Ok(loaded)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use lancer_core::scene::Emitter;

    use super::*;

    fn open(name: &str, level: &str) -> Result<Loaded> {
        SCENES.iter().find(|scene| scene.name == name).unwrap().open(Some(level))
    }

    #[test]
    fn every_scene_opens_without_a_warning() {
        for scene in SCENES {
            let loaded = scene.open(None).unwrap();
            assert_eq!(loaded.warnings, [], "{}", scene.name);
            assert!(loaded.scene.has_light() && loaded.scene.camera.check().is_ok());
        }
        assert_eq!(open("flake", "2").unwrap().scene.counts().spheres, 91);
    }

    #[test]
    fn a_wrong_level_is_refused() {
        for (name, level) in [("flake", "9"), ("flake", "-1"), ("gears", "x"), ("room", "1")] {
            assert!(open(name, level).is_err(), "{name}:{level}");
        }
    }

    #[test]
    fn the_room_is_made_of_polygons_lit_by_its_lamp() {
        let room = room();
        assert!(room.spheres.is_empty() && room.lights.is_empty());
        let lamp = &room.point_sources()[0];
        assert!((lamp.position - DVec3::new(0.0, 2.98, 2.5)).length() < 1e-12);
        // 0.8 by 0.8 metres that face down.
        assert!((lamp.intensity.x * std::f64::consts::PI - 94.0 * 0.64).abs() < 1e-12);
        let Emitter::Face { normal } = lamp.emitter else { panic!("a face") };
        assert!((normal + DVec3::Y).length() < 1e-12);
    }
}
