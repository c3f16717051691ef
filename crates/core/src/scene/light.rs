use std::f64::consts::PI;

use glam::DVec3;

use super::{FaceId, Material, Scene};
use crate::Rgb;
use crate::geometry::{Real, Vector, gamma};
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
    /// For an emitting face its unit normal, the brightest direction; `None` shines everywhere alike.
    pub facing: Option<DVec3>,
}

impl PointSource {
    /// The intensity in the direction `-to_light`, where `to_light` is unit and points at the source.
    #[inline(always)]
    pub fn intensity_towards<V: Vector>(&self, to_light: V) -> V {
        let intensity = to_light.all(self.intensity);
        match self.facing {
            None => intensity,
            Some(n) => {
                let cos = -to_light.all(n).dot(to_light);
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
        let shadow_ray = surface.spawn_to(surface.position.all(self.position));
        Arriving::new(
            shadow_ray,
            #[inline(always)]
            |to_light| self.intensity_towards(to_light),
        )
    }
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

    /// All lights as points: the point lights, then each area light.
    ///
    /// A face of area A and radiance L becomes a source of intensity L·A·cos θ / π at its centroid (the
    /// same power with the same cosine, so that only its size, the penumbra, is lost): π, because a
    /// white surface that sees the radiance L all around sends back L. It stands
    /// off the face, on the side it shines to, by more than a shadow ray from anywhere in the scene can
    /// err at its end.
    pub fn point_sources(&self) -> Vec<PointSource> {
        let points = self.lights.iter().map(|light| PointSource {
            position: light.position,
            intensity: light.intensity,
            facing: None,
        });
        let lamps = self.area_lights();
        // The largest coordinate bounds the rounding of a ray's end and of the face there.
        let reach = if lamps.is_empty() { 0.0 } else { self.bounds().reach() };
        let of_lamp = |lamp: &AreaLight| PointSource {
            position: lamp.centroid + gamma(SHADOW_END) * reach * lamp.normal,
            intensity: lamp.radiance * (lamp.area / PI),
            facing: Some(lamp.normal),
        };
        points.chain(lamps.iter().map(of_lamp)).collect()
    }

    /// Whether anything shines: a point light, a face that emits, or the ambient term.
    pub fn has_light(&self) -> bool {
        !self.lights.is_empty() || self.ambient != Rgb::ZERO || self.has_area_light()
    }

    /// Whether a face of the mesh emits.
    pub fn has_area_light(&self) -> bool {
        self.mesh.faces.iter().any(|face| self.material(face.material).emits())
    }
}
