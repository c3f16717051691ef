//! E1.8 The recursion LR. Slide « Algorithme ».

use chapter_1::exercises::prelude::*;

// Your own functions of the exercises before.
use crate::yours::{local_light, reflected_ray, refracted_ray, shadow_ray};

/// The radiance that comes back along a ray: « Couleur LR(origine, direction, profondeur) ».
///
/// ```text
/// profondeur > Max_Prof    black
/// nothing is met           the background
/// a surface is met         I_Local + k_s I_Refl + k_t I_Trans
///
/// I_Local = ε + ρ_d I_a + Σ over the lamps: local_light
/// ```
///
/// ε is sent by the outside of a surface alone. At total reflection the share k_t goes to the mirror ray.
///
/// `Stage` is in chapters/1-whitted/src/exercises/stage.rs, what it gives out in crates/core/src/world.rs and
/// crates/core/src/scene/material.rs. An `Rgb` is a `DVec3`, black is `Rgb::ZERO`.
///
/// - `ray`: its direction is unit; `depth`: the bounces before it, 0 for a ray from the eye.
/// - `stage.max_depth`, `stage.scene.background` and `stage.scene.ambient`: Max_Prof, « couleur de
///   fond » and I_a.
/// - `stage.surface(ray)`: what the ray meets first, `Some(surface)`, or `None`:
///   `let Some(surface) = stage.surface(ray) else { return … };`.
/// - `stage.scene.material(surface.material)`: `emission`, `k_s`, `k_t`, `refractive_index` (of the
///   inside; the outside is 1). `stage.reflectance(&surface)`: ρ_d, ρ_s and n there.
/// - `surface.geometric_normal`: unit, out of the shape: it tells whether the ray enters or leaves.
/// - `surface.shading_normal_towards(-ray.direction)`: N for the lamps.
///   `surface.optical_normal(ray.direction)`: N for the mirror ray and the refracted one.
/// - `surface.spawn(direction)`: the ray that leaves the surface, moved off it by its rounding; one that starts
///   at `surface.position` may meet the surface again.
/// - `stage.lamps`: each `lamp` has a `position` and an `intensity_towards(to_light)`, L being unit.
///   `stage.is_lit(&shadow_ray)`: vis(i). The fields of `Lit` are named in the stub of `local_light`.
pub fn lr(stage: &Stage, ray: &Ray, depth: u32) -> Rgb {
    todo!("E1.8: follow the ray")
}
