//! The chapter's scenes, written in `scenes/`.

use lancer_core::scene::Scene;
use lancer_lesson::scenes::{NamedScene, parsed};

const CORNELL: &str = include_str!("../scenes/cornell.toml");
const EFFECTS: &str = include_str!("../scenes/effects.toml");
const PENUMBRA: &str = include_str!("../scenes/penumbra.toml");

/// All of them.
pub const SCENES: [NamedScene; 3] = [
    NamedScene::written("cornell", CORNELL),
    NamedScene::written("effects", EFFECTS),
    NamedScene::written("penumbra", PENUMBRA),
];

/// A closed room of matte walls with a lamp under its ceiling.
pub fn cornell() -> Scene {
    parsed("cornell", CORNELL)
}

/// A lamp with a size, a rough mirror, frosted glass, a rolling ball and a lens.
pub fn effects() -> Scene {
    parsed("effects", EFFECTS)
}

/// A ball and a slab on a floor under a square lamp.
pub fn penumbra() -> Scene {
    parsed("penumbra", PENUMBRA)
}
