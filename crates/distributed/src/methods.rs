use lancer_core::method::{Effect, Method, Order, SAMPLES, Setting};
use lancer_core::moving::{Moment, Moving};

use crate::distributed::{Distributed, Settings};
use crate::outlines::Eye;
use crate::path::{PathSettings, PathTracer};

/// The chapter's methods.
pub static METHODS: [Method; 2] = [
    Method {
        name: "distributed",
        about: "soft shadows, gloss, depth of field and motion blur as well",
        uses: &[Setting::Sampling, Setting::Numbers, Setting::MaxDepth, Setting::Branching],
        ignores: &[],
        by_products: &[SAMPLES],
        render: |order| {
            let moving = Moving::new(order.scene, order.index);
            let world = Moment::from(&moving);
            let Settings { max_depth, min_weight, branching } = Settings::default();
            let settings = Settings {
                max_depth: order.max_depth.unwrap_or(max_depth),
                branching: order.branching.unwrap_or(branching),
                min_weight,
            };
            let method = Distributed::new(world, settings);
            let order = without_pilot(order);
            order.sample(Eye::new(
                world,
                order.size,
                order.sampling.pattern,
                |ray, hit, emission, sample, rays| method.shade(ray, hit, emission, sample, rays),
            ))
        },
    },
    Method {
        name: "path",
        about: "all light between surfaces, without the ambient constant",
        uses: &[Setting::Sampling, Setting::Numbers, Setting::MaxDepth, Setting::Strategy],
        ignores: &[Effect::Ambient],
        by_products: &[SAMPLES],
        render: |order| {
            let moving = Moving::new(order.scene, order.index);
            let world = Moment::from(&moving);
            let default = PathSettings::default();
            let settings = PathSettings {
                max_depth: order.max_depth,
                strategy: order.strategy.unwrap_or(default.strategy),
                ..default
            };
            let method = PathTracer::new(world, settings);
            let order = without_pilot(order);
            order.sample(Eye::new(
                world,
                order.size,
                order.sampling.pattern,
                |ray, hit, emission, sample, rays| method.shade(ray, hit, emission, sample, rays),
            ))
        },
    },
];

/// All pixels get all samples: one that decides whether its pixel is worth more, and is the picture where it is not,
/// darkens what is seldom bright.
fn without_pilot<'o>(order: &Order<'o>) -> Order<'o> {
    Order { adaptive: None, ..*order }
}
