//! E1.8 The recursion LR. Slide « Algorithme ».

use chapter_1::exercises::prelude::*;

// Your own functions of the exercises before.
use crate::yours::{local_light, reflected_ray, refracted_ray, shadow_ray};

/// The radiance that comes back along a ray: « Couleur LR(origine, direction, profondeur) ».
pub fn lr(stage: &Stage, ray: &Ray, depth: u32) -> Rgb {
    if depth > stage.max_depth {
        return Rgb::ZERO;
    }
    let Some(surface) = stage.surface(ray) else { return stage.scene.background };
    let (incident, to_eye) = (ray.direction, -ray.direction);
    let (material, reflectance) =
        (stage.scene.material(surface.material), stage.reflectance(&surface));
    let is_entering = surface.geometric_normal.dot(incident) < 0.0;

    let mut radiance = reflectance.diffuse * stage.scene.ambient;
    if is_entering {
        radiance += material.emission;
    }
    let n = surface.shading_normal_towards(to_eye);
    for lamp in &stage.lamps {
        let shadow = shadow_ray(&surface, lamp.position);
        let (to_light, distance) = shadow.direction.normalize_and_length();
        let (intensity, visible) = (lamp.intensity_towards(to_light), stage.is_lit(&shadow));
        let lit = Lit { intensity, visible, distance, reflectance, n, to_light, to_eye };
        radiance += local_light(&lit);
    }

    let sent = |direction| lr(stage, &surface.spawn(direction), depth + 1);
    let (n, index) = (surface.optical_normal(incident), material.refractive_index);
    let (n1, n2) = if is_entering { (1.0, index) } else { (index, 1.0) };
    let mut k_s = material.k_s;
    if material.k_t != Rgb::ZERO {
        match refracted_ray(incident, n, n1, n2) {
            Some(t) => radiance += material.k_t * sent(t),
            None => k_s += material.k_t,
        }
    }
    if k_s != Rgb::ZERO {
        radiance += k_s * sent(reflected_ray(incident, n));
    }
    radiance
}
