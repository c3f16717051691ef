//! The chapter's scenes: written ones from `scenes/`, and generated ones with a level of detail.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use lancer_core::generate::{gears, sphere_flake, tetrahedra};
use lancer_core::scene::load::{Loaded, parse_scene};
use lancer_core::scene::{Camera, MaterialId, PointLight, Scene};

/// The names of all scenes.
pub const NAMES: [&str; 6] = ["whitted", "room", "horizon", "flake", "tetrahedra", "gears"];

/// A generated scene: its name, the level it has unless another is asked for, the highest level, and
/// what fills it.
struct Generated {
    name: &'static str,
    level: u32,
    highest: u32,
    fill: fn(&mut Scene, u32),
}

const GENERATED: [Generated; 3] = [
    Generated {
        name: "flake",
        level: 3,
        highest: 7,
        fill: |scene, level| scene.spheres.extend(sphere_flake(level, MaterialId(0))),
    },
    Generated {
        name: "tetrahedra",
        level: 5,
        highest: 11,
        fill: |scene, level| scene.mesh = tetrahedra(level, MaterialId(0)),
    },
    Generated {
        name: "gears",
        level: 3,
        highest: 30,
        fill: |scene, level| scene.mesh = gears(level.max(1), MaterialId(0)),
    },
];

/// The written scenes and their texts.
const WRITTEN: [(&str, &str); 3] = [
    ("whitted", include_str!("../scenes/whitted.toml")),
    ("room", include_str!("../scenes/room.toml")),
    ("horizon", include_str!("../scenes/horizon.toml")),
];

/// Whitted's composition of 1980, in an arrangement of our own.
pub fn whitted() -> Scene {
    written(0)
}

/// A polyhedral room with a planar mirror and a rectangular lamp.
pub fn room() -> Scene {
    written(1)
}

/// A checkered floor to the horizon.
pub fn horizon() -> Scene {
    written(2)
}

fn written(index: usize) -> Scene {
    let (name, text) = WRITTEN[index];
    parsed(name, text)
}

/// A scene of the chapter's own, from its text.
pub(crate) fn parsed(name: &str, text: &str) -> Scene {
    let loaded = parse_scene(text, name, Path::new(""));
    loaded.unwrap_or_else(|error| panic!("a test loads every scene of the chapter: {error}")).scene
}

/// Opens a scene by name; `level` is for generated ones.
///
/// # Errors
/// If the name is unknown, or the level is no number in range, or the scene has none.
pub fn open(name: &str, level: Option<&str>) -> Result<Loaded> {
    if let Some(generated) = GENERATED.iter().find(|generated| generated.name == name) {
        let highest = generated.highest;
        let level = match level {
            None => generated.level,
            Some(text) => {
                text.parse().ok().filter(|level| *level <= highest).with_context(|| {
                    format!("{name}:{text}: the level is a number from 0 to {highest}")
                })?
            }
        };
        return generated.open(level);
    }
    ensure!(level.is_none(), "{name}: only generated scenes have a level; leave it out");
    let Some((_, text)) = WRITTEN.iter().find(|(known, _)| *known == name) else {
        bail!("unknown scene `{name}`; known: {}", NAMES.join(", "));
    };
    Ok(parse_scene(text, name, Path::new(""))?)
}

impl Generated {
    /// The shapes, slightly reflecting, framed and lit from beside the camera.
    fn open(&self, level: u32) -> Result<Loaded> {
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
        let mut loaded = parse_scene(material, self.name, Path::new(""))?;
        let scene = &mut loaded.scene;
        scene.spheres.clear();
        (self.fill)(scene, level);
        scene.camera = Camera::framing(scene.bounding_sphere().context("an empty scene")?);
        scene.lights.push(PointLight::beside(&scene.camera));
        loaded.headlight = true;
        Ok(loaded)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn every_scene_opens_without_a_warning() {
        for name in NAMES {
            let loaded = open(name, None).unwrap();
            assert_eq!(loaded.warnings, [], "{name}");
            assert!(loaded.scene.has_light() && loaded.scene.camera.check().is_ok());
        }
        assert_eq!(open("flake", Some("2")).unwrap().scene.counts().spheres, 91);
    }

    #[test]
    fn a_wrong_level_is_refused() {
        for (name, level) in [("flake", "9"), ("flake", "-1"), ("gears", "x"), ("room", "1")] {
            assert!(open(name, Some(level)).is_err(), "{name}:{level}");
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
        assert!(lamp.facing.is_some_and(|n| (n + DVec3::Y).length() < 1e-12));
    }
}
