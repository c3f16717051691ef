use std::f64::consts::PI;

use glam::DVec3;

use super::{FaceId, Material, Scene, SphereObject};
use crate::Rgb;
use crate::geometry::{Ray, Real, Sphere, Vector, gamma};
use crate::illumination::Arriving;
use crate::world::SurfacePoint;

/// Rounded operations behind the end of a shadow ray, with room for its test against the face there.
const SHADOW_END: u32 = 256;

/// A light without size that shines equally in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Where it stands.
    pub position: DVec3,
    /// I_i of `eq:local`: the radiance of a white surface (ρ_d = 1) that faces the light at distance 1.
    ///
    /// That is the power per solid angle over π: a matte surface spreads what it receives over all
    /// directions, so that ρ_d is the share of the light that it sends back.
    pub intensity: Rgb,
}

/// A light as methods without area lights see it: a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointSource {
    /// Where it stands.
    pub position: DVec3,
    /// I_i of [`PointLight::intensity`], in the brightest direction.
    pub intensity: Rgb,
    /// What shines.
    pub emitter: Emitter,
}

/// What a [`PointSource`] stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Emitter {
    /// A [`PointLight`], which shines everywhere alike.
    Point,
    /// A face; it shines to one side, with the cosine to its normal.
    Face {
        /// Its unit normal, the brightest direction.
        normal: DVec3,
    },
    /// A sphere around the source; it shines everywhere alike, but not on what is inside.
    Sphere {
        /// Its radius, or more by the rounding of a shadow ray's end.
        radius: f64,
    },
}

impl From<&PointLight> for PointSource {
    fn from(&PointLight { position, intensity }: &PointLight) -> Self {
        Self { position, intensity, emitter: Emitter::Point }
    }
}

impl PointSource {
    /// The intensity in the direction `-to_light`, where `to_light` is unit and points at the source.
    #[inline(always)]
    pub fn intensity_towards<V: Vector>(&self, to_light: V) -> V {
        let intensity = to_light.all(self.intensity);
        match self.emitter {
            Emitter::Point | Emitter::Sphere { .. } => intensity,
            Emitter::Face { normal } => {
                let cos = -to_light.all(normal).dot(to_light);
                intensity * cos.larger(cos.all(0.0))
            }
        }
    }

    /// What arrives from it at a surface.
    #[inline(always)]
    pub fn arriving<V: Vector, M>(
        &self,
        surface: &SurfacePoint<V, M>,
    ) -> Arriving<impl Fn(V) -> V + use<'_, V, M>, V> {
        let center = surface.position.all(self.position);
        let (shadow_ray, share) = match self.emitter {
            Emitter::Sphere { radius } => entered(surface, center, radius),
            Emitter::Point | Emitter::Face { .. } => {
                (surface.spawn_to(center), surface.position.dot(center).all(1.0))
            }
        };
        Arriving::new(
            shadow_ray,
            #[inline(always)]
            move |to_light| self.intensity_towards(to_light) * share,
        )
    }
}

/// The shadow ray to where it enters the sphere, and the share of the intensity with which a source there shines
/// as much: that of the squares of the distances. From inside a ray leaves the sphere, along which nothing arrives.
#[inline(always)]
fn entered<V: Vector, M>(
    surface: &SurfacePoint<V, M>,
    center: V,
    radius: f64,
) -> (Ray<V>, V::Scalar) {
    let out = surface.position - center;
    let distance = out.dot(out).sqrt();
    let radius = distance.all(radius);
    let is_inside = distance.at_most(radius);
    let beyond = surface.position + surface.geometric_normal * (radius + radius);
    let target = V::select(is_inside, beyond, center + out * (radius / distance));
    let shadow_ray = surface.spawn_to(target);
    let (direction, to_center) = (shadow_ray.direction, center - shadow_ray.origin);
    let share = direction.dot(direction) / to_center.dot(to_center);
    (shadow_ray, V::Scalar::select(is_inside, share.all(0.0), share))
}

/// A face that emits: a plane lamp, which shines to the side of its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaLight {
    /// The face; its triangles are those of [`Mesh::faces`](super::Mesh::faces).
    pub face: FaceId,
    /// The radiance L that it emits, in every direction of its side alike.
    pub radiance: Rgb,
    /// Its area A, in squared scene units.
    pub area: f64,
    /// Its centre of gravity.
    pub centroid: DVec3,
    /// Its unit normal, to the side it shines to.
    pub normal: DVec3,
}

/// A sphere that emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereLight {
    /// Its index in [`Scene::spheres`].
    pub sphere: usize,
    /// The radiance L that it emits, from every point of its outside in every direction alike.
    pub radiance: Rgb,
    /// Where it is.
    pub shape: Sphere,
}

impl Scene {
    /// The faces that emit, in the mesh's order; one without area emits nothing.
    pub fn area_lights(&self) -> Vec<AreaLight> {
        if !self.materials.iter().any(Material::emits) {
            return Vec::new();
        }
        let faces = (0..).map(FaceId).zip(&self.mesh.faces);
        let emitting = faces.filter(|(_, face)| self.material(face.material).emits());
        let lamp = |(id, face): (FaceId, &super::Face)| {
            let (mut area_vector, mut moment, mut area) = (DVec3::ZERO, DVec3::ZERO, 0.0);
            for index in face.triangles() {
                let [a, b, c] = self.mesh.corners(index);
                let twice = (b - a).cross(c - a);
                area_vector += 0.5 * twice;
                area += 0.5 * twice.length();
                moment += 0.5 * twice.length() * (a + b + c) / 3.0;
            }
            let normal = area_vector.try_normalize()?;
            let radiance = self.material(face.material).emission;
            Some(AreaLight { face: id, radiance, area, centroid: moment / area, normal })
        };
        emitting.filter_map(lamp).collect()
    }

    /// The spheres that emit, in the scene's order.
    pub fn sphere_lights(&self) -> Vec<SphereLight> {
        let lamp = |(sphere, object): (usize, &SphereObject)| {
            let material = self.material(object.material);
            let (radiance, shape) = (material.emission, object.shape);
            material.emits().then_some(SphereLight { sphere, radiance, shape })
        };
        self.spheres.iter().enumerate().filter_map(lamp).collect()
    }

    /// All lights as points: the point lights, then each area light, then each sphere that emits.
    ///
    /// A face of area A and radiance L becomes a source of intensity L·A·cos θ / π at its centroid (the
    /// same power with the same cosine, so that only its size, the penumbra, is lost): π, because a
    /// white surface that sees the radiance L all around sends back L. It stands
    /// off the face, on the side it shines to, by more than a shadow ray from anywhere in the scene can
    /// err at its end.
    ///
    /// A sphere of radius r becomes a source of intensity L r² at its centre, which shines as much on a surface that
    /// sees all of it. A shadow ray ends where it enters the sphere, as much before it.
    pub fn point_sources(&self) -> Vec<PointSource> {
        let points = self.lights.iter().map(PointSource::from);
        let (faces, spheres) = (self.area_lights(), self.sphere_lights());
        let is_any = !(faces.is_empty() && spheres.is_empty());
        let clearance = if is_any { self.shadow_end_error() } else { 0.0 };
        let of_face = |lamp: &AreaLight| PointSource {
            position: lamp.centroid + clearance * lamp.normal,
            intensity: lamp.radiance * (lamp.area / PI),
            emitter: Emitter::Face { normal: lamp.normal },
        };
        let of_sphere = |lamp: &SphereLight| PointSource {
            position: lamp.shape.center,
            intensity: lamp.radiance * (lamp.shape.radius * lamp.shape.radius),
            emitter: Emitter::Sphere { radius: lamp.shape.radius + clearance },
        };
        points.chain(faces.iter().map(of_face)).chain(spheres.iter().map(of_sphere)).collect()
    }

    /// How far a shadow ray from anywhere in the scene can err at its end, in scene units: one to a lamp ends before
    /// it by that much.
    pub fn shadow_end_error(&self) -> f64 {
        // The largest coordinate bounds the rounding of a ray's end and of the lamp there.
        let ways = self.motions.iter().map(|motion| motion.displacement.abs().max_element());
        gamma(SHADOW_END) * (self.bounds().reach() + ways.fold(0.0, f64::max))
    }

    /// Whether anything shines: a point light, a lamp, or the ambient term.
    pub fn has_light(&self) -> bool {
        !self.lights.is_empty() || self.ambient != Rgb::ZERO || self.has_lamp()
    }

    /// Whether a face or a sphere emits.
    pub fn has_lamp(&self) -> bool {
        let of_faces = self.mesh.faces.iter().map(|face| face.material);
        let of_spheres = self.spheres.iter().map(|sphere| sphere.material);
        of_faces.chain(of_spheres).any(|id| self.material(id).emits())
    }
}
