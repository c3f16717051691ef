//! The tables and keys of a scene file, as serde reads them; `format.toml` explains each.

use std::collections::BTreeMap;

use glam::DVec3;
use serde::Deserialize;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    pub camera: Option<CameraTable>,
    pub ambient: Option<Spanned<Triple>>,
    pub background: Option<Spanned<Triple>>,
    #[serde(default)]
    pub light: Vec<LightTable>,
    #[serde(default)]
    pub material: BTreeMap<String, MaterialTable>,
    #[serde(default)]
    pub sphere: Vec<SphereTable>,
    #[serde(default)]
    pub mesh: Vec<MeshTable>,
    #[serde(default)]
    pub polygon: Vec<PolygonTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraTable {
    pub eye: Spanned<[f64; 3]>,
    pub look_at: Spanned<[f64; 3]>,
    pub up: Option<Spanned<[f64; 3]>>,
    pub fov: Spanned<f64>,
    pub lens: Option<Spanned<f64>>,
    pub focus: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightTable {
    pub position: Spanned<[f64; 3]>,
    pub intensity: Spanned<Triple>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialTable {
    pub rho_d: Option<Spanned<PigmentValue>>,
    pub rho_s: Option<Spanned<Triple>>,
    pub shininess: Option<Spanned<f64>>,
    pub k_s: Option<Spanned<Triple>>,
    pub k_t: Option<Spanned<Triple>>,
    pub gloss: Option<Spanned<f64>>,
    pub refractive_index: Option<Spanned<f64>>,
    pub emission: Option<Spanned<Triple>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SphereTable {
    pub center: Spanned<[f64; 3]>,
    pub radius: Spanned<f64>,
    pub material: Spanned<String>,
    #[serde(rename = "move")]
    pub displacement: Option<Spanned<[f64; 3]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshTable {
    pub obj: Spanned<String>,
    pub material: Option<Spanned<String>>,
    pub scale: Option<Spanned<Triple>>,
    pub rotate: Option<Spanned<[f64; 3]>>,
    pub translate: Option<Spanned<[f64; 3]>>,
    #[serde(rename = "move")]
    pub displacement: Option<Spanned<[f64; 3]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PolygonTable {
    pub vertices: Spanned<Vec<[f64; 3]>>,
    pub material: Spanned<String>,
}

/// Three numbers, or one that stands for three.
#[derive(Clone, Copy, Deserialize)]
#[serde(untagged, expecting = "expected a number or an array of three")]
pub(super) enum Triple {
    Same(f64),
    Each([f64; 3]),
}

impl Triple {
    pub fn vector(self) -> DVec3 {
        match self {
            Self::Same(value) => DVec3::splat(value),
            Self::Each(values) => values.into(),
        }
    }
}

#[derive(Deserialize)]
#[serde(
    untagged,
    deny_unknown_fields,
    expecting = "expected a number, an array of three, or { checker = [color, color], side = length }"
)]
pub(super) enum PigmentValue {
    Solid(Triple),
    Checker { checker: [Triple; 2], side: f64 },
}
