//! E1.6 The mirror ray. Slide « Reflets spéculaires : calcul du rayon réfléchi ».

use chapter_1::exercises::prelude::*;

/// The direction in which a mirror sends on what arrives along `incident`.
pub fn reflected_ray(incident: DVec3, n: DVec3) -> DVec3 {
    incident - 2.0 * n.dot(incident) * n
}
