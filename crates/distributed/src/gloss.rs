use glam::DVec3;
use lancer_core::sampling::phong_lobe;
use lancer_core::scene::Material;
use lancer_core::world::SurfacePoint;

/// A direction around the mirror or the refracted direction of a surface: « brillance », « translucidité ».
///
/// ```text
/// k ∫ q(ω) I(ω) dω,   q(ω) = (m + 1) / 2π · cosᵐ ∠(ω, axis)
/// ```
///
/// `axis` is R or T, unit and away from the surface; m is the [gloss](Material::gloss), of density q. `numbers` are asked
/// for if there is one. `None` is a direction that does not leave to the axis' side: what is sent there is lost, up to
/// half of it where the axis grazes the surface. To share it out among the others would need another density for each axis,
/// and a mirror in grazing light would end in an edge.
#[inline]
pub fn spread(
    surface: &SurfacePoint,
    material: &Material,
    axis: DVec3,
    numbers: impl FnOnce() -> [f64; 2],
) -> Option<DVec3> {
    let Some(exponent) = material.gloss else { return Some(axis) };
    let direction = phong_lobe(axis, exponent, numbers());
    let side = surface.geometric_normal;
    (side.dot(direction) * side.dot(axis) > 0.0).then_some(direction)
}
