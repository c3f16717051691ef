//! Lamps that have a size, and points on them.

use std::collections::HashMap;
use std::f64::consts::PI;

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::Sphere;
use lancer_core::illumination::Arriving;
use lancer_core::moving::Moment;
use lancer_core::sampling::{LampSample, Patch, SeenSphere};
use lancer_core::scene::{self, AreaLight, FaceId, PrimitiveId, Scene, SphereLight};
use lancer_core::world::SurfacePoint;

/// What emits: a face, which shines to the side of its normal, or a sphere, which shines outwards.
#[derive(Clone, Debug)]
pub struct Lamp {
    shape: Shape,
    radiance: Rgb,
    /// How far before it shadow rays end: farther than they can err there. It is sampled as if it stood there, so that
    /// whatever is in its own plane or on its own surface, itself first of all, sees its back.
    clearance: f64,
    /// What it is made of, or the first of what; all of it moves alike.
    primitive: PrimitiveId,
}

#[derive(Clone, Debug)]
enum Shape {
    Face { patch: Patch, normal: DVec3 },
    Sphere(Sphere),
}

impl Lamp {
    /// The radiance L that it emits, in every direction of its side alike.
    pub fn radiance(&self) -> Rgb {
        self.radiance
    }

    /// Its area A, in squared scene units.
    pub fn area(&self) -> f64 {
        match &self.shape {
            Shape::Face { patch, .. } => patch.area(),
            Shape::Sphere(sphere) => 4.0 * PI * sphere.radius * sphere.radius,
        }
    }

    /// A point of it as `receiver` sees it, drawn with these two numbers: where a shadow ray ends, just before the
    /// lamp. `None` where the lamp turns its back, and in a sphere.
    #[inline]
    pub fn sample(&self, receiver: DVec3, numbers: [f64; 2]) -> Option<LampSample> {
        let (mut sample, normal) = match &self.shape {
            Shape::Face { patch, normal } => {
                let seen = patch.seen_from(receiver - self.clearance * *normal);
                (seen.sample(numbers)?, *normal)
            }
            Shape::Sphere(sphere) => {
                let sample = self.seen_sphere(*sphere, receiver)?.sample(numbers);
                (sample, (sample.position - sphere.center) / sphere.radius)
            }
        };
        sample.position += self.clearance * normal;
        Some(sample)
    }

    /// The density, per solid angle at `receiver`, with which [`Lamp::sample`] draws the direction to a point of the
    /// lamp where its unit normal is `normal`; 0 where it turns its back.
    #[inline]
    pub fn density(&self, receiver: DVec3, position: DVec3, normal: DVec3) -> f64 {
        match &self.shape {
            Shape::Face { patch, normal: side } => {
                patch.seen_from(receiver - self.clearance * *side).density(position, normal)
            }
            Shape::Sphere(sphere) => {
                self.seen_sphere(*sphere, receiver).map_or(0.0, |seen| seen.density())
            }
        }
    }

    #[inline]
    fn seen_sphere(&self, sphere: Sphere, receiver: DVec3) -> Option<SeenSphere> {
        let out = (receiver - sphere.center).try_normalize()?;
        SeenSphere::new(sphere, receiver - self.clearance * out)
    }

    /// [`Lamp::sample`] of the lamp where it is at a moment.
    #[inline]
    pub fn sample_at(
        &self,
        moment: &Moment,
        receiver: DVec3,
        numbers: [f64; 2],
    ) -> Option<LampSample> {
        let Some(shift) = moment.shift(self.primitive) else {
            return self.sample(receiver, numbers);
        };
        let LampSample { position, density } = self.sample(receiver - shift, numbers)?;
        Some(LampSample { position: position + shift, density })
    }

    /// [`Lamp::density`] of the lamp where it is at a moment.
    #[inline]
    pub fn density_at(
        &self,
        moment: &Moment,
        receiver: DVec3,
        position: DVec3,
        normal: DVec3,
    ) -> f64 {
        let shift = moment.shift(self.primitive).unwrap_or(DVec3::ZERO);
        self.density(receiver - shift, position - shift, normal)
    }

    /// What arrives at a surface from a sample of the lamp.
    ///
    /// ```text
    /// 1/π ∫ L V cos θ' / d² ( … ) dA  ≈  I vis / d² ( … ),   I = L d² / (π p)
    /// ```
    ///
    /// p is the sample's density per solid angle, times the probability `chosen` that this lamp was asked at all; the
    /// bracket is that of `eq:local`.
    #[inline]
    pub fn arriving(
        &self,
        surface: &SurfacePoint,
        sample: &LampSample,
        chosen: f64,
    ) -> Arriving<impl Fn(DVec3) -> Rgb + use<>> {
        let shadow_ray = surface.spawn_to(sample.position);
        let density = chosen * sample.density;
        let intensity = self.radiance * (shadow_ray.direction.length_squared() / (PI * density));
        Arriving { shadow_ray, intensity: move |_| intensity }
    }
}

/// The lamps of a scene.
#[derive(Clone, Debug, Default)]
pub struct Lamps {
    lamps: Vec<Lamp>,
    of_face: HashMap<FaceId, usize>,
    of_sphere: HashMap<usize, usize>,
}

impl Lamps {
    /// Collects the faces and the spheres that emit.
    pub fn new(scene: &Scene) -> Self {
        let mut all = Self::default();
        let clearance = scene.shadow_end_error();
        for AreaLight { face, radiance, normal, .. } in scene.area_lights() {
            let triangles = scene.mesh.faces[face.0 as usize].triangles();
            let primitive = PrimitiveId(triangles.start as u32);
            let Some(patch) = Patch::new(triangles.map(|index| scene.mesh.corners(index))) else {
                continue;
            };
            all.of_face.insert(face, all.lamps.len());
            let shape = Shape::Face { patch, normal };
            all.lamps.push(Lamp { shape, radiance, clearance, primitive });
        }
        for SphereLight { sphere, radiance, shape } in scene.sphere_lights() {
            let primitive = PrimitiveId((scene.mesh.triangles.len() + sphere) as u32);
            all.of_sphere.insert(sphere, all.lamps.len());
            all.lamps.push(Lamp { shape: Shape::Sphere(shape), radiance, clearance, primitive });
        }
        all
    }

    /// All of them, in the order of the mesh's faces, then of the spheres.
    pub fn as_slice(&self) -> &[Lamp] {
        &self.lamps
    }

    /// The number of the lamp that a primitive is part of.
    #[inline]
    pub fn of(&self, scene: &Scene, primitive: PrimitiveId) -> Option<usize> {
        match scene.shape(primitive) {
            scene::Shape::Triangle(index) => {
                self.of_face.get(&scene.mesh.triangles[index].face).copied()
            }
            scene::Shape::Sphere(index) => self.of_sphere.get(&index).copied(),
        }
    }
}
