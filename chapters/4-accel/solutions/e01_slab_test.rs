//! E4.1 A ray and a box. Slide « Hiérarchie de volumes englobants ».

use chapter_4::exercises::prelude::*;

/// What (plane − o) · (1 / d) may be too small by: multiply the t of each far plane by it.
const FAR: f64 = 1.0 + 4.0 * f64::EPSILON;

/// The t at which a ray enters a box, if it meets the box in `range`.
pub fn slab_test(bounds: &Bounds3, ray: &Ray, range: Interval) -> Option<f64> {
    let (mut near, mut far) = (range.min, range.max);
    for k in 0..3 {
        let (origin, inverse) = (ray.origin[k], 1.0 / ray.direction[k]);
        let (first, last) = if ray.direction[k].is_sign_negative() {
            (bounds.max[k], bounds.min[k])
        } else {
            (bounds.min[k], bounds.max[k])
        };
        let enter = (first - origin) * inverse;
        let leave = (last - origin) * inverse * FAR;
        // In a face one of them is 0 · ∞: a comparison with NaN is false, and the range stays.
        if enter > near {
            near = enter;
        }
        if leave < far {
            far = leave;
        }
    }
    (near <= far).then_some(near)
}
