//! E1.5 One lamp's part of the local model. Slide « Modèle d'éclairage, modèle local ».

use chapter_1::exercises::prelude::*;

/// What a surface sends to the eye of one lamp's light.
pub fn local_light(lit: &Lit) -> Rgb {
    let Lit { intensity, visible, distance, reflectance, n, to_light, to_eye } = *lit;
    let cos_light = n.dot(to_light);
    if !visible || cos_light <= 0.0 {
        return Rgb::ZERO;
    }
    let mirror = 2.0 * cos_light * n - to_light;
    let highlight = mirror.dot(to_eye).max(0.0).powf(reflectance.shininess);
    let bracket = reflectance.diffuse * cos_light + reflectance.specular * highlight;
    intensity / (distance * distance) * bracket
}
