use lancer_core::method::{Effect, Method, SAMPLES, Setting, Work, WorkKind};
use lancer_core::render::AlongRays;
use lancer_core::world::World;

use crate::{Appel, RayCounts, Settings, Whitted};

/// The chapter's methods.
pub static METHODS: [Method; 2] = [
    Method {
        name: "appel",
        about: "visibility and shadows",
        uses: &[Setting::Sampling, Setting::Adaptive],
        ignores: &[
            Effect::Mirrors,
            Effect::Glass,
            Effect::AreaLights,
            Effect::Gloss,
            Effect::Lens,
            Effect::Motion,
        ],
        by_products: &[SAMPLES],
        render: |order| {
            let index = (order.index)(order.scene.into());
            let world = World { scene: order.scene, index: &*index };
            let appel = Appel::new(world);
            order.sample(AlongRays::new(
                world,
                order.size,
                |rays, _, radiance, counts: &mut RayCounts| appel.trace_all(rays, radiance, counts),
            ))
        },
    },
    Method {
        name: "whitted",
        about: "mirrors and glass as well",
        uses: &[Setting::Sampling, Setting::Adaptive, Setting::MaxDepth],
        ignores: &[Effect::AreaLights, Effect::Gloss, Effect::Lens, Effect::Motion],
        by_products: &[SAMPLES],
        render: |order| {
            let index = (order.index)(order.scene.into());
            let world = World { scene: order.scene, index: &*index };
            let whitted = Whitted::new(world, Settings::to_depth(order.max_depth));
            order.sample(AlongRays::new(
                world,
                order.size,
                |rays, _, radiance, counts: &mut RayCounts| {
                    whitted.trace_all(rays, radiance, counts);
                },
            ))
        },
    },
];

impl From<RayCounts> for Work {
    fn from(rays: RayCounts) -> Self {
        let RayCounts { primary, mirror, refracted, shadow } = rays;
        let counts = [
            ("primary", primary),
            ("mirror", mirror),
            ("refracted", refracted),
            ("shadow", shadow),
        ];
        Self { counts: counts.map(|(name, count)| (WorkKind::Rays, name, count)).to_vec() }
    }
}
