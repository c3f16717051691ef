//! What the slides describe: a camera, shapes, materials, lights, the ambient term and the background.
//!
//! A [`Scene`] holds no resolution, sample count or file name; those are settings of a method.

mod camera;
mod counts;
mod framing;
mod light;
pub mod load;
mod material;
mod mesh;
mod motion;
mod primitives;

pub use camera::{Camera, Lens, PrimaryRays};
pub use counts::Counts;
pub use framing::CameraError;
pub use light::{AreaLight, Emitter, PointLight, PointSource, SphereLight};
pub use material::{Material, MaterialId, Pigment};
pub use mesh::{Face, FaceId, Mesh, Triangle};
pub use motion::{Motion, Part};
pub use primitives::{PrimitiveId, Shape, Subset};

use glam::DVec3;

use crate::Rgb;
use crate::geometry::Sphere;

/// A sphere and what it is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereObject {
    /// Its geometry.
    pub shape: Sphere,
    /// Its material.
    pub material: MaterialId,
}

/// Everything a method of the course draws.
///
/// All triangles stand in one [`Mesh`]: a scene file with several meshes appends them, so that a
/// primitive is found by one index and a scene without spheres, or without triangles, pays nothing
/// for them.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The camera.
    pub camera: Camera,
    /// Every triangle of the scene.
    pub mesh: Mesh,
    /// Every sphere of the scene.
    pub spheres: Vec<SphereObject>,
    /// What moves while the shutter is open; everything else stands still. No primitive is in two of them.
    pub motions: Vec<Motion>,
    /// The materials that faces and spheres name by [`MaterialId`].
    pub materials: Vec<Material>,
    /// Point lights. Faces and spheres whose material emits are lamps, too.
    pub lights: Vec<PointLight>,
    /// The ambient radiance I_a of `eq:ambient`.
    pub ambient: Rgb,
    /// The radiance of a ray that leaves the scene (« couleur de fond »).
    pub background: Rgb,
}

impl Scene {
    /// A grey matte mesh without light, seen from the point one unit before the origin.
    pub fn of_mesh(mesh: Mesh) -> Self {
        Self {
            camera: Camera {
                eye: DVec3::Z,
                look_at: DVec3::ZERO,
                up: DVec3::Y,
                fov: 40.0,
                lens: None,
            },
            mesh,
            spheres: Vec::new(),
            motions: Vec::new(),
            materials: vec![Material::matte(Rgb::splat(0.5))],
            lights: Vec::new(),
            ambient: Rgb::ZERO,
            background: Rgb::ZERO,
        }
    }

    /// The material of that number.
    #[inline]
    pub fn material(&self, id: MaterialId) -> &Material {
        &self.materials[id.0 as usize]
    }
}
