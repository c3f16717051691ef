//! E1.4 The shadow ray. Slide « Modèle local : calcul des ombres portées ».

use chapter_1::exercises::prelude::*;

/// The ray from a point of a surface to a lamp, which it reaches at t = 1.
pub fn shadow_ray(surface: &SurfacePoint, lamp: DVec3) -> Ray {
    let is_outside = surface.shading_normal.dot(lamp - surface.position) > 0.0;
    let start = if is_outside { surface.lifted } else { surface.position };
    let n = surface.geometric_normal;
    // How far the box of error reaches along N.
    let distance = n.abs().dot(surface.error);
    let origin = start + distance.copysign(n.dot(lamp - start)) * n;
    Ray::new(origin, lamp - origin)
}
