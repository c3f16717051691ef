//! E1.7 The refracted ray. Slide « Reflets spéculaires : calcul du rayon réfracté ».

use chapter_1::exercises::prelude::*;

/// The direction T in which a ray goes on behind a surface, or `None` if it is totally reflected.
pub fn refracted_ray(incident: DVec3, n: DVec3, n1: f64, n2: f64) -> Option<DVec3> {
    let eta = n1 / n2;
    let cos1 = -n.dot(incident);
    let cos2_squared = 1.0 - eta * eta * (1.0 - cos1 * cos1);
    (cos2_squared >= 0.0).then(|| eta * incident + (eta * cos1 - cos2_squared.sqrt()) * n)
}
