//! Scenes from files: `.toml`, the course's own format, and `.obj` with its materials.
//!
//! Every refusal is one line, `file:line: what is wrong; cure`. What can be drawn although it is odd
//! is drawn, with a counted [`Warning`].
//!
//! # The format of a scene file
#![doc = concat!("```toml\n", include_str!("format.toml"), "```")]
//!
//! # Highlights of MTL files
//!
//! The slides' highlight is (R·V)ⁿ, that of MTL's `Ns` is (N·H)^Ns with H half-way between L and V. Where N lies in
//! the plane of L and V, the angle between R and V is twice the angle δ between N and H, and near the peak
//! cos^Ns δ ≈ exp(−Ns δ²/2) ≈ cos^(Ns/4) 2δ. So an MTL file's exponent becomes
//!
//! ```text
//! n = max(Ns / 4, 1)
//! ```
//!
//! Up to δ = 20° and from Ns = 4 on this misses MTL's highlight by at most 2.6 % of its peak, and by about 0.54/Ns
//! where Ns is large. Farther out it falls to 0 at 45°, where cos^Ns δ is 25 % of the peak for Ns = 4 and 0.1 % for
//! Ns = 20; and where N lies beside that plane, MTL's highlight is longer than wide at grazing angles, the slides' is
//! round. Below 1, an exponent would let the highlight end in an edge at R·V = 0, of full height for n = 0, while
//! (N·H)⁰ has none; so the widest highlight is that of n = 1, and misses `Ns 0` by 23 % at 20°. A scene file's
//! `shininess` is n itself.
//!
//! Sources: Blinn, *Models of Light Reflection for Computer Synthesized Pictures* (1977); Fisher and Woo, *R.E versus
//! N.H Specular Highlights*, Graphics Gems IV (1994).

mod check;
mod clean;
mod closed;
mod definition;
mod inside_out;
mod mtl;
mod obj;
mod report;
mod scene_toml;
mod statements;
mod tables;
#[cfg(test)]
mod tests;

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use glam::DVec3;

use report::Warnings;
pub use report::{LoadError, Warning, WarningKind};

use super::{Camera, Mesh, PointLight, Scene};
use crate::Rgb;

/// The most vertices, and the most triangles, of a scene: both are numbered in 32 bits.
pub const MAX_COUNT: usize = u32::MAX as usize;

/// The most corners of one face. Cutting one of this size takes 0.01 s if it is convex, up to 5 s for waves, stars and
/// spirals, and 20 s for a comb of 50,000 teeth, each as long as the comb is wide, on one core without optimisation for
/// speed (`dev`).
pub const MAX_CORNERS: usize = 100_000;

/// The largest coordinate, in absolute value. Products of six of them are still finite.
pub const MAX_COORDINATE: f64 = 1e50;

/// The largest radiance or intensity of a file. Pictures are `f32` and end at 3e38.
pub const MAX_RADIANCE: f64 = 1e30;

/// The name of the material of faces that name none, or one that no library defines.
pub const UNNAMED: &str = "light grey";

/// The most bytes of a scene file, and of one line of an OBJ or MTL file.
pub const MAX_BYTES: usize = 1 << 26;

/// A scene and what there is to say about its files.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The scene, ready to be drawn.
    pub scene: Scene,
    /// The name of each of the scene's materials as its file spells it; [`UNNAMED`] for faces without one.
    pub material_names: Vec<String>,
    /// What was ignored, replaced or looks wrong, one entry per file and kind.
    pub warnings: Vec<Warning>,
    /// The file has no light: the scene's only one was put beside the camera, and belongs there when
    /// the camera is moved.
    pub headlight: bool,
}

/// Reads a scene; the extension decides how.
///
/// An `.obj` is framed by [`Camera::framing`] and, unless one of its faces emits, lit by
/// [`PointLight::beside`] the camera, with a small ambient term. Faces without a material are matte
/// light grey.
///
/// # Errors
/// When a file cannot be read, its kind is unknown, its content is wrong, or nothing is to be drawn.
pub fn load(path: &Path) -> Result<Loaded, LoadError> {
    if path.is_dir() {
        return Err(LoadError::IsFolder { file: path.display().to_string() });
    }
    load_with(path, &open)
}

/// Reads a scene from the text of a `.toml`, such as one embedded by `include_str!`. `name` stands
/// for the file in messages; the meshes it names are looked for in `folder`.
///
/// ```
/// use std::path::Path;
///
/// let text = "
///     ambient = 0.1
///     material.red.rho_d = [0.8, 0.1, 0.1]
///     [[sphere]]
///     center = [0, 0, 0]
///     radius = 1
///     material = 'red'
/// ";
/// let loaded = lancer_core::scene::load::parse_scene(text, "ball.toml", Path::new(""))?;
/// assert_eq!(loaded.scene.spheres.len(), 1);
/// # Ok::<(), lancer_core::scene::load::LoadError>(())
/// ```
///
/// # Errors
/// As [`load`].
pub fn parse_scene(text: &str, name: &str, folder: &Path) -> Result<Loaded, LoadError> {
    scene_toml::parse(text, name, folder, &open)
}

/// Opens a file; in tests, an entry of a table. One that another file names must be in the given folder or below it.
type Open<'a> = &'a dyn Fn(&Path, Option<&Path>) -> io::Result<Box<dyn Read>>;

fn open(path: &Path, within: Option<&Path>) -> io::Result<Box<dyn Read>> {
    // Some systems open folders and only refuse to read them.
    if path.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    let Some(folder) = within else { return Ok(Box::new(File::open(path)?)) };
    // Links count as what they lead to, that of the folder included.
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let target = path.canonicalize()?;
    if !target.starts_with(folder.canonicalize()?) {
        let reason = "it is a link that leads out of the folder";
        return Err(io::Error::new(io::ErrorKind::PermissionDenied, reason));
    }
    Ok(Box::new(File::open(target)?))
}

fn load_with(path: &Path, open: Open<'_>) -> Result<Loaded, LoadError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let file = || path.display().to_string();
    match extension.as_str() {
        "obj" => load_obj(path, open),
        "toml" => {
            let unreadable = |reason| LoadError::Unreadable { file: file(), reason };
            let mut bytes = Vec::new();
            open(path, None)
                .and_then(|source| source.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes))
                .map_err(unreadable)?;
            check::within_limit(
                bytes.len(),
                "or more bytes",
                MAX_BYTES,
                "move large meshes to OBJ files",
            )
            .map_err(|(problem, cure)| LoadError::at(&file(), None, problem, cure))?;
            let text = String::from_utf8(bytes).map_err(|error| {
                let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
                let line = 1 + good.iter().filter(|&&byte| byte == b'\n').count();
                LoadError::at(&file(), line, "the text is not UTF-8", "save the file as UTF-8")
            })?;
            let folder = path.parent().unwrap_or(Path::new(""));
            scene_toml::parse(text.trim_start_matches('\u{feff}'), &file(), folder, open)
        }
        _ => Err(LoadError::UnknownKind { file: file() }),
    }
}

fn load_obj(path: &Path, open: Open<'_>) -> Result<Loaded, LoadError> {
    let mut warnings = Warnings::default();
    let (mesh, materials) = obj::read_obj(path, obj::Materials::Own, open, &mut warnings)?;
    let mut scene = empty_scene();
    scene.mesh = mesh;
    let (names, materials) = materials.into_iter().unzip();
    scene.materials = materials;
    scene.ambient = Rgb::splat(0.05);
    scene.background = Rgb::new(0.2, 0.25, 0.3);
    frame(&mut scene, &path.display().to_string())?;
    let headlight = !scene.has_lamp();
    if headlight {
        scene.lights.push(PointLight::beside(&scene.camera));
    }
    let file = path.display().to_string();
    Ok(Loaded { headlight, ..finish(&file, scene, names, warnings) })
}

/// A scene to be filled; its camera has no meaning yet.
fn empty_scene() -> Scene {
    Scene {
        camera: Camera { eye: DVec3::Z, look_at: DVec3::ZERO, up: DVec3::Y, fov: 40.0, lens: None },
        mesh: Mesh::default(),
        spheres: Vec::new(),
        motions: Vec::new(),
        materials: Vec::new(),
        lights: Vec::new(),
        ambient: Rgb::ZERO,
        background: Rgb::ZERO,
    }
}

/// Points the camera at the whole scene.
fn frame(scene: &mut Scene, file: &str) -> Result<(), LoadError> {
    let bounds = scene.bounding_sphere().filter(|bounds| bounds.radius > 0.0).ok_or_else(|| {
        let problem = "nothing to draw: all vertices are at one point";
        LoadError::at(file, None, problem, "check the vertices")
    })?;
    scene.camera = Camera::framing(bounds);
    scene.camera.check().map_err(|_| {
        let problem = format!("a scene of radius {:e} cannot be framed", bounds.radius);
        LoadError::at(file, None, problem, "scale it to a size between 1e-100 and 1e49")
    })
}

/// The share of its light that a material may send back before it is warned of. Authors who share out all of it, to
/// a mirror of 0.1 and glass of 0.9, often add a small highlight.
const LARGEST_ALBEDO: f64 = 1.01;

fn finish(file: &str, scene: Scene, material_names: Vec<String>, mut warnings: Warnings) -> Loaded {
    let albedos = scene.materials.iter().map(crate::scene::Material::largest_albedo);
    let mut amplifying = material_names.iter().zip(albedos).filter(|(_, a)| *a > LARGEST_ALBEDO);
    if let Some((material, albedo)) = amplifying.next() {
        let (material, sum) = (material.clone(), format!("{albedo:.2}"));
        let kind = WarningKind::Amplifies { material, sum };
        warnings.add_many(file, None, kind, 1 + amplifying.count());
    }
    let mut is_used = vec![false; scene.materials.len()];
    let of_faces = scene.mesh.faces.iter().map(|face| face.material);
    let of_spheres = scene.spheres.iter().map(|sphere| sphere.material);
    of_faces.chain(of_spheres).for_each(|id| is_used[id.0 as usize] = true);
    let is_invisible = |&i: &usize| is_used[i] && scene.materials[i].is_invisible();
    let mut invisible = (0..is_used.len()).filter(is_invisible);
    if let Some(first) = invisible.next() {
        let kind = WarningKind::Invisible { material: material_names[first].clone() };
        warnings.add_many(file, None, kind, 1 + invisible.count());
    }
    for (id, flaws) in closed::flaws(&scene) {
        let material = || material_names[id.0 as usize].clone();
        let (open, mixed) = (flaws.open, flaws.mixed);
        if open > 0 {
            warnings.add(
                file,
                None,
                WarningKind::OpenSurface { material: material(), edges: open },
            );
        }
        if mixed > 0 {
            let kind = WarningKind::MixedWinding { material: material(), edges: mixed };
            warnings.add(file, None, kind);
        }
        if flaws.inside_out > 0 {
            let edges = flaws.inside_out_edges;
            let kind = WarningKind::InsideOut { material: material(), edges };
            warnings.add_many(file, None, kind, flaws.inside_out);
        }
    }
    Loaded { scene, material_names, warnings: warnings.into_vec(), headlight: false }
}

const DEFAULT_GREY: Rgb = Rgb::splat(0.75);
