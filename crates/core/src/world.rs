//! A scene with an index of it, and what a hit tells about the surface there.

use glam::DVec3;

use crate::Rgb;
use crate::geometry::{Ray, Real, Vector, gamma, leave_surface};
use crate::illumination::Reflectance;
use crate::intersector::{Hit, Intersector};
use crate::optics::reflect;
use crate::scene::{MaterialId, Scene, Shape};

/// Rounded operations between a triangle's corners and the point that its weights give.
const POSITION: u32 = 7;
/// The same from a sphere to a point of it, and back to the sign of |o − c|² − r² there.
const SPHERE: u32 = 12;
/// Rounded operations of [`leave_surface`] itself.
const LEAVING: u32 = 4;
/// The same of a shift: of the point, of the ray's origin beside it, and of that origin back to where the scene has
/// the surface.
const SHIFT: u32 = 3;

/// What a method renders: a scene and an index of its primitives.
#[derive(Clone, Copy)]
pub struct World<'a> {
    /// What there is.
    pub scene: &'a Scene,
    /// Answers what a ray meets. It borrows the same scene.
    pub index: &'a dyn Intersector,
}

/// A point of a surface, worked out once for the closest hit.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint<V = DVec3, M = MaterialId> {
    /// The point, on the surface up to `error`.
    pub position: V,
    /// Bound of the position's distance from the true surface, per coordinate.
    pub error: V,
    /// Unit normal of the shape itself, pointing outwards.
    pub geometric_normal: V,
    /// Unit normal for shading, on the same side: interpolated over smooth triangles.
    pub shading_normal: V,
    /// Where shadow rays start on the outside: `position`, lifted onto the surface that the vertex normals suggest,
    /// so that the facets of a smooth mesh do not shade each other at the terminator.
    pub lifted: V,
    /// What the surface is made of.
    pub material: M,
}

impl Scene {
    /// The surface at a hit of `ray`.
    #[inline]
    pub fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        match self.shape(hit.primitive) {
            Shape::Triangle(index) => self.triangle_surface(index, hit.barycentric, ray.direction),
            Shape::Sphere(index) => self.sphere_surface(index, ray.at(hit.t)),
        }
    }

    /// The constants of `eq:local` there.
    #[inline]
    pub fn reflectance(&self, surface: &SurfacePoint) -> Reflectance {
        let material = self.material(surface.material);
        Reflectance {
            diffuse: material.rho_d.at(surface.position, surface.geometric_normal),
            specular: material.rho_s,
            shininess: material.shininess,
        }
    }

    /// ε: the radiance that the surface itself sends in the direction `to_eye`. It shines from its outside only.
    #[inline]
    pub fn emitted(&self, surface: &SurfacePoint, to_eye: DVec3) -> Rgb {
        if surface.geometric_normal.dot(to_eye) > 0.0 {
            self.material(surface.material).emission
        } else {
            Rgb::ZERO
        }
    }

    #[inline]
    fn triangle_surface(&self, index: usize, weights: DVec3, incident: DVec3) -> SurfacePoint {
        let corners = self.mesh.corners(index);
        // From the corners rather than the ray: the error does not grow with the distance travelled.
        let [a, b, c] = [weights.x * corners[0], weights.y * corners[1], weights.z * corners[2]];
        let position = a + b + c;
        let area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        // A triangle of no area, which sews a seam, faces whoever meets it.
        let geometric_normal = area.try_normalize().unwrap_or_else(|| -incident.normalize());
        let face = self.mesh.triangles[index].face;
        let flat = SurfacePoint {
            position,
            error: gamma(POSITION + LEAVING) * (a.abs() + b.abs() + c.abs()),
            geometric_normal,
            shading_normal: geometric_normal,
            lifted: position,
            material: self.mesh.faces[face.0 as usize].material,
        };
        match self.mesh.corner_normals(index) {
            Some(normals) => smooth(flat, corners, normals, weights),
            None => flat,
        }
    }

    #[inline]
    fn sphere_surface(&self, index: usize, near: DVec3) -> SurfacePoint {
        let object = &self.spheres[index];
        let (center, radius) = (object.shape.center, object.shape.radius);
        // Back onto the sphere: the error of `near` grows with the distance travelled.
        let n = (near - center).normalize();
        let position = center + radius * n;
        SurfacePoint {
            position,
            error: gamma(SPHERE + LEAVING) * (center.abs() + DVec3::splat(radius)),
            geometric_normal: n,
            shading_normal: n,
            lifted: position,
            material: object.material,
        }
    }
}

/// Interpolates the normal, and lifts the origin of shadow rays (Hanika, *Hacking the Shadow
/// Terminator*, Ray Tracing Gems II ch. 4).
fn smooth(
    flat: SurfacePoint,
    corners: [DVec3; 3],
    normals: [DVec3; 3],
    weights: DVec3,
) -> SurfacePoint {
    let weights = weights.to_array();
    let mut normal = DVec3::ZERO;
    let mut lifted = flat.position;
    for ((corner, n), weight) in corners.into_iter().zip(normals).zip(weights) {
        // Authors' normals may point inwards; the lift and the shading must not.
        let n = if n.dot(flat.geometric_normal) < 0.0 { -n } else { n };
        normal += weight * n;
        lifted -= weight * (flat.position - corner).dot(n).min(0.0) * n;
    }
    SurfacePoint {
        shading_normal: normal.try_normalize().unwrap_or(flat.geometric_normal),
        lifted,
        ..flat
    }
}

impl SurfacePoint {
    /// The same point of the surface where all of it is moved `by` so much.
    #[inline]
    #[must_use]
    pub fn shifted(self, by: DVec3) -> Self {
        Self {
            position: self.position + by,
            lifted: self.lifted + by,
            error: self.error + gamma(SHIFT) * (self.position.abs() + by.abs()),
            ..self
        }
    }
}

impl<V: Vector, M> SurfacePoint<V, M> {
    /// The unit shading normal on the side of the surface that `to_eye` points to.
    #[inline(always)]
    pub fn shading_normal_towards(&self, to_eye: V) -> V {
        let cos = self.geometric_normal.dot(to_eye);
        V::select(cos.below(cos.all(0.0)), -self.shading_normal, self.shading_normal)
    }

    /// The ray that leaves the surface in `direction`, to either side.
    #[inline(always)]
    pub fn spawn(&self, direction: V) -> Ray<V> {
        let origin = leave_surface(self.position, self.error, self.geometric_normal, direction);
        Ray::new(origin, direction)
    }

    /// The ray from the surface to `target`, which it reaches at t = 1.
    #[inline(always)]
    pub fn spawn_to(&self, target: V) -> Ray<V> {
        let start = self.lit_from(target - self.position);
        let origin = leave_surface(start, self.error, self.geometric_normal, target - start);
        Ray::new(origin, target - origin)
    }

    /// The ray that leaves the surface in `direction` and looks for the same light as a shadow ray would: it starts
    /// where that does.
    #[inline(always)]
    pub fn spawn_for_light(&self, direction: V) -> Ray<V> {
        let start = self.lit_from(direction);
        Ray::new(leave_surface(start, self.error, self.geometric_normal, direction), direction)
    }

    /// Where light from `direction` is looked for, up to the move that leaves the surface.
    #[inline(always)]
    pub fn lit_from(&self, direction: V) -> V {
        // Seen from inside a smooth surface is hollow: its facets stand before it, not behind. Near the
        // terminator the shading normal tells the side, since the facet has turned away already.
        let cos = direction.dot(self.shading_normal);
        V::select(cos.all(0.0).below(cos), self.lifted, self.position)
    }

    /// The unit normal that mirrors and refracts a ray arriving along `incident`, on the side it comes
    /// from: the shading normal, unless its mirror ray would pass through the surface.
    #[inline(always)]
    pub fn optical_normal(&self, incident: V) -> V {
        let cos = self.geometric_normal.dot(incident);
        let zero = cos.all(0.0);
        let is_behind = zero.below(cos);
        let geometric = V::select(is_behind, -self.geometric_normal, self.geometric_normal);
        let shading = V::select(is_behind, -self.shading_normal, self.shading_normal);
        let turns_back = shading.dot(incident).below(zero)
            & zero.below(reflect(incident, shading).dot(geometric));
        V::select(turns_back, shading, geometric)
    }
}
