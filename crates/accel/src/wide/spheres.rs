//! The spheres of a leaf, four at a time in `f64`.

use glam::DVec3;
use lancer_core::geometry::{Interval, Ray, Real, intersect_spheres};
use lancer_core::intersector::{Hit, Probe};
use lancer_core::scene::{PrimitiveId, Shape};

use super::lanes::{Lanes, difference};
use super::{Child, Wide};
use crate::pending::Lanes as Bits;

const FOUR: usize = 4;

/// Tests the primitives of a leaf that has spheres against what is closest so far. Returns where the closest hit is
/// then, or the range ends.
#[inline(always)]
pub(super) fn test<L: Lanes>(
    lanes: L,
    wide: &Wide,
    leaf: Child,
    ray: &Ray,
    range: Interval,
    closest: &mut Option<Hit>,
) -> f64 {
    lanes.apart(
        #[inline(always)]
        move |lanes| {
            let mut probe = Probe::new(wide.scene, ray, range);
            if let Some(hit) = *closest {
                probe.keep(hit);
            }
            let mut four = [PrimitiveId(0); FOUR];
            let (mut centers, mut radii) = ([DVec3::ZERO; FOUR], [0.0; FOUR]);
            let mut count = 0;
            for primitive in wide.primitives(leaf) {
                let Shape::Sphere(index) = wide.scene.shape(primitive) else {
                    probe.test(primitive);
                    continue;
                };
                let sphere = wide.scene.spheres[index].shape;
                (four[count], centers[count], radii[count]) =
                    (primitive, sphere.center, sphere.radius);
                count += 1;
                if count == FOUR {
                    test_four(lanes, ray, range, &four, centers, radii, &mut probe);
                    count = 0;
                }
            }
            if count > 0 {
                // No ray meets a sphere without a radius.
                radii[count..].fill(0.0);
                test_four(lanes, ray, range, &four, centers, radii, &mut probe);
            }
            *closest = probe.best();
            probe.range().max
        },
    )
}

#[inline(always)]
fn test_four<L: Lanes>(
    lanes: L,
    ray: &Ray,
    range: Interval,
    primitives: &[PrimitiveId; FOUR],
    centers: [DVec3; FOUR],
    radii: [f64; FOUR],
    probe: &mut Probe,
) {
    let [origin, direction] =
        [lanes.vectors([ray.origin; FOUR]).0, lanes.vectors([ray.direction; FOUR]).0];
    let f = difference(origin, lanes.vectors(centers).0);
    let [min, endless] = [lanes.four([range.min; FOUR]), lanes.four([f64::INFINITY; FOUR])];
    let met = intersect_spheres(f, lanes.four(radii), direction, [min, endless]);
    let Some((t, met)) = met else { return };
    let t = lanes.numbers(t);
    for place in Bits::<FOUR>(L::D::bits(met)) {
        let barycentric = DVec3::ZERO;
        probe.keep(Hit { t: t[place], primitive: primitives[place], barycentric });
    }
}
