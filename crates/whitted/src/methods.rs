use lancer_core::method::{Effect, Method, Order, SAMPLES, Setting, Work, WorkKind};
use lancer_core::render::PrimaryHits;
use lancer_core::world::World;

use crate::{Appel, RayCounts, Settings, Whitted};

/// The chapter's methods.
pub static METHODS: [Method; 2] = [
    Method {
        name: "appel",
        about: "visibility and shadows",
        uses: &[Setting::Sampling, Setting::Adaptive],
        ignores: &[Effect::Mirrors, Effect::Glass, Effect::AreaLights],
        by_products: &[SAMPLES],
        render: |order| {
            let index = (order.index)(order.scene.into());
            let world = World { scene: order.scene, index: &*index };
            let appel = Appel::new(world);
            order.sample(PrimaryHits::new(
                world,
                order.size,
                |ray, hit, _, counts: &mut RayCounts| appel.shade(ray, hit, counts),
            ))
        },
    },
    Method {
        name: "whitted",
        about: "mirrors and glass as well",
        uses: &[Setting::Sampling, Setting::Adaptive, Setting::MaxDepth],
        ignores: &[Effect::AreaLights],
        by_products: &[SAMPLES],
        render: |order| {
            let index = (order.index)(order.scene.into());
            let world = World { scene: order.scene, index: &*index };
            let whitted = Whitted::new(world, Settings::of(order));
            order.sample(PrimaryHits::new(
                world,
                order.size,
                |ray, hit, _, counts: &mut RayCounts| whitted.shade(ray, hit, counts),
            ))
        },
    },
];

impl Settings {
    /// The default but for what the order says.
    fn of(order: &Order<'_>) -> Self {
        let settings = Self::default();
        Self { max_depth: order.max_depth.unwrap_or(settings.max_depth), ..settings }
    }
}

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
