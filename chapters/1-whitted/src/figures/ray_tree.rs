//! 1.6: one pixel's rays in the scene, beside the tree of the calls that traced them.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec2;
use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::geometry::Ray;
use lancer_core::illumination::recursion;
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Hit, Intersector, Observer, Query, Traversal, Wanted};
use lancer_core::scene::Scene;
use lancer_core::scene::load::Loaded;
use lancer_core::world::World;
use lancer_figure::{
    Drawing, Effort, FAINT, Finished, LABEL, Montage, Pen, Plate, Row, Style, Table, Text, Tile,
    category_color, number,
};
use lancer_lesson::picture::shown;
use lancer_lesson::view::{Side, View};
use lancer_whitted::{AtLimit, RayEnd, RayNode, RayTree, Settings, Whitted};

use super::whitted_picture;
use crate::scenes;
use crate::step::terms::Spawned;
use crate::step::view::{calls, kind};

const SIZE: ImageSize = ImageSize::new(256, 256);
/// A pixel whose ray passes through glass to plastic, the mirror and the floor.
const PIXEL: (u32, u32) = (123, 78);
const SETTINGS: Settings = Settings { max_depth: 4, min_weight: 0.01, at_limit: AtLimit::Black };

pub fn make(_: Effort) -> Finished {
    let loaded = scenes::opened("whitted", None);
    let scene = &loaded.scene;
    let tree_of_boxes = ObvhsBvh2::build(scene);
    let index = Counting {
        index: &tree_of_boxes,
        closest: AtomicUsize::new(0),
        occluded: AtomicUsize::new(0),
    };
    let whitted = Whitted::new(World { scene, index: &index }, SETTINGS);
    let film = DVec2::new(f64::from(PIXEL.0) + 0.5, f64::from(PIXEL.1) + 0.5);
    let ray = scene.camera.primary_rays(SIZE).through(film.x, film.y);
    let mut tree = RayTree::default();
    let radiance = whitted.trace(&ray, &mut tree);
    let traced = index.closest.load(Ordering::Relaxed);
    let difference = (summed_up(scene, &tree, 0) - radiance).abs().max_element();
    let shadows: usize = tree.nodes.iter().map(|node| node.shadows.len()).sum();
    let asked = index.occluded.load(Ordering::Relaxed);
    let holds = tree.traced() == traced && shadows == asked && difference <= 1e-14;
    let difference_text = if difference == 0.0 {
        "to the last bit".to_owned()
    } else {
        format!("to {}", number(difference))
    };
    let claim = format!(
        "The tree has a node for each of the {traced} rays that the index was asked for, and summing it up by \
         I_Local + k_s I_Refl + k_t I_Trans gives the pixel again, {difference_text}."
    );

    let mut data = Table::new([
        "node",
        "parent",
        "kind",
        "depth",
        "weight",
        "end",
        "shadow_rays",
        "radiance_r",
        "radiance_g",
        "radiance_b",
    ]);
    for (k, node) in tree.nodes.iter().enumerate() {
        data.push([
            k.into(),
            node.parent.map_or_else(|| "".into(), Into::into),
            kind(node.call.kind).0.into(),
            node.call.depth.into(),
            node.call.weight.into(),
            end(&loaded, node).into(),
            node.shadows.len().into(),
            node.radiance.x.into(),
            node.radiance.y.into(),
            node.radiance.z.into(),
        ]);
    }

    let picture = whitted_picture(scene, Settings::default(), SIZE).image;
    let plate = Plate::new("1.6", "The ray tree of one pixel", claim, holds)
        .panel(
            Row::new()
                .panel(1.0, Montage::new().tile(Tile::new("The pixel", shown(&picture).marked(PIXEL.0, PIXEL.1))))
                .panel(1.55, from_above(&loaded, &tree)),
        )
        .panel(calls(&tree, 0, &|k| label(&loaded, &tree, k)))
        .note("Drawing", "the scene from above; the numbers are those of the tree's nodes. Edges: what the \
             ray is and its share k; nodes: what it meets")
        .note("Settings", format!(
            "scene whitted, pixel ({}, {}) of {SIZE}, depth {}, rays that count less than {} are cut; \
             {} shadow rays are not drawn",
            PIXEL.0, PIXEL.1, SETTINGS.max_depth, SETTINGS.min_weight, shadows
        ))
        .note("Method", "algo:lr followed by a recorder (fig:ray-tree); eq:recursion");
    Finished { plate, data }
}

/// Counts what an index is asked for, whatever the recorder says.
struct Counting<'a> {
    index: &'a dyn Intersector,
    closest: AtomicUsize,
    occluded: AtomicUsize,
}

impl Traversal for Counting<'_> {
    fn walk<O: Observer>(&self, query: Query<&Ray>, observer: &mut O) -> Option<Hit> {
        let count = match query.wanted {
            Wanted::Closest => &self.closest,
            Wanted::Any => &self.occluded,
        };
        count.fetch_add(1, Ordering::Relaxed);
        self.index.watch(query, observer)
    }
}

/// The radiance of a node from its own local term and its children, by eq:recursion.
fn summed_up(scene: &Scene, tree: &RayTree, k: usize) -> Rgb {
    let node = &tree.nodes[k];
    let RayEnd::Surface { hit, local, .. } = node.end else { return node.radiance };
    let spawned = Spawned::new(scene, tree, k, &scene.surface_at(&node.call.ray, &hit));
    let below =
        |child: Option<usize>| child.map_or(Rgb::ZERO, |child| summed_up(scene, tree, child));
    recursion(local, spawned.k_s, below(spawned.mirror), spawned.k_t, below(spawned.refracted))
}

/// What a ray came to.
fn end(loaded: &Loaded, node: &RayNode) -> String {
    match node.end {
        RayEnd::Background => "background".to_owned(),
        RayEnd::Cut => "cut".to_owned(),
        RayEnd::Surface { hit, .. } => {
            let surface = loaded.scene.surface_at(&node.call.ray, &hit);
            loaded.material_names[surface.material.0 as usize].clone()
        }
    }
}

/// What a node meets, and the share of its parent's weight that it has.
fn label(loaded: &Loaded, tree: &RayTree, k: usize) -> [String; 2] {
    let node = &tree.nodes[k];
    let share = node.parent.map_or(1.0, |parent| node.call.weight / tree.nodes[parent].call.weight);
    let name = format!("{} {}", k + 1, end(loaded, node));
    [name, format!("{} {}", kind(node.call.kind).0, number(share))]
}

/// The rays seen from above, x to the right and away from the eye upwards.
fn from_above(loaded: &Loaded, tree: &RayTree) -> Drawing {
    let view = View { side: Side::Above, low: [-3.6, -3.2], high: [3.6, 3.4] };
    let spheres: Vec<_> = loaded
        .scene
        .spheres
        .iter()
        .map(|sphere| (sphere.shape, loaded.material_names[sphere.material.0 as usize].clone()))
        .collect();
    let rays: Vec<_> = tree
        .nodes
        .iter()
        .enumerate()
        .filter(|(_, node)| !matches!(node.end, RayEnd::Cut))
        .map(|(k, node)| {
            let from = node.call.ray.origin;
            let to = match node.end {
                RayEnd::Surface { position, .. } => position,
                _ => from + 1.6 * node.call.ray.direction,
            };
            (from, to, kind(node.call.kind).1, k + 1)
        })
        .collect();
    let draw = move |pen: &mut Pen<'_>| {
        for z in -4..4 {
            for x in -4..4 {
                if (x + z) % 2 == 0 {
                    let (x, z) = (f64::from(x), f64::from(z));
                    let cell = [[x, z], [x + 1.0, z], [x + 1.0, z + 1.0], [x, z + 1.0]];
                    pen.polygon(
                        &cell.map(|p| [p[0].clamp(-3.6, 3.6), p[1].clamp(-3.2, 3.4)]),
                        Style::fill(FAINT.with_alpha(90)),
                    );
                }
            }
        }
        for ((sphere, name), color) in spheres.iter().zip([4, 5, 0].map(category_color)) {
            view.sphere(pen, sphere, name, color);
        }
        pen.label([-2.7, 3.1], [0.0, 0.0], Text::new("seen from above", LABEL).bold());
        for &(from, to, color, number) in &rays {
            view.ray(pen, from, to, color, number);
        }
    };
    Drawing::new(view.low, view.high, 560.0, draw)
}
