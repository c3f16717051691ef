//! The slides' algorithm LR walked through for one pixel: `cargo xtask step whitted`.
//!
//! The method itself is run, followed by a [`RayTree`]; the terms of its sums are worked out again from what
//! the tree has recorded, by the same functions.

pub mod terms;
pub mod view;

use glam::{DVec2, DVec3};
use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::illumination::recursion;
use lancer_core::image::{Image, ImageSize};
use lancer_core::intersector::Hit;
use lancer_core::method::Setting;
use lancer_core::optics::indices;
use lancer_core::scene::{PointSource, Scene, Shape};
use lancer_core::world::{SurfacePoint, World};
use lancer_exercise::Shown;
use lancer_figure::{Backdrop, Color, INK, Pen, Step, Stroke, Walk, number};
use lancer_lesson::chapter::{WalkOrder, Walkthrough};
use lancer_lesson::picture::marked_picture;
use lancer_lesson::view::{View, printable};
use lancer_whitted::{RayEnd, RayKind, RayNode, RayTree, Settings, Whitted};

use terms::{LampTerm, LocalTerms, Spawned};
use view::kind;

/// LR, step by step.
pub const WALK: Walkthrough = Walkthrough {
    name: "whitted",
    about: "is the slides' algorithm LR: each call with its ray, what it meets, the terms of the local model lamp \
            by lamp, the rays that it spawns, and the sum that comes back up",
    uses: &[Setting::MaxDepth],
    walk: |order| Ok(walk(order)),
};

/// Walks through LR for one pixel.
pub fn walk(order: &WalkOrder<'_>) -> Walk {
    let WalkOrder { loaded, size, pixel: [x, y], .. } = *order;
    let scene = &loaded.scene;
    let index = ObvhsBvh2::build(scene);
    let settings = Settings::to_depth(order.max_depth);
    let whitted = Whitted::new(World { scene, index: &index }, settings);
    let film = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
    let ray = scene.camera.primary_rays(size).through(film.x, film.y);
    let mut tree = RayTree::default();
    whitted.trace(&ray, &mut tree);

    let names: Vec<String> = loaded.material_names.iter().map(|name| printable(name)).collect();
    let view = view::of_rays(scene, &tree);
    let sources = scene.point_sources();
    let mut walker = Walker {
        scene,
        names: &names,
        sources: &sources,
        settings,
        tree: &tree,
        view,
        steps: Vec::new(),
    };
    walker.call(0);
    let steps = walker.steps;

    let shadows: usize = tree.nodes.iter().map(|node| node.shadows.len()).sum();
    let kinds = [RayKind::Primary, RayKind::Mirror, RayKind::Refracted].map(kind);
    let label = |k: usize| {
        let node = &tree.nodes[k];
        [(k + 1).to_string(), format!("{} {}", kind(node.call.kind).0, number(node.call.weight))]
    };
    Walk {
        title: format!("LR for pixel ({x}, {y}) of {}", printable(order.name)),
        subtitle: format!(
            "{size} pixels, depth at most {}, weight at least {}; calls {}, traced {}, shadow rays {shadows}",
            settings.max_depth,
            settings.min_weight.shown(),
            tree.nodes.len(),
            tree.traced()
        ),
        backdrop: Backdrop {
            name: view.side.name().to_owned(),
            low: view.low,
            high: view.high,
            draw: Box::new(view.outlines(scene, &names)),
        },
        legend: kinds
            .map(|(name, color)| (name, color, false))
            .into_iter()
            .chain([true, false].map(view::shadow).map(|(name, color)| (name, color, true)))
            .collect(),
        picture: marked_picture(scene, size, order.pixel, |ray| whitted.trace(ray, &mut ())),
        calls: view::calls(&tree, 0, &label),
        steps,
    }
}

/// The colour of a radiance on a display.
fn displayed(radiance: Rgb) -> Color {
    let pixel = radiance.to_array().map(|channel| channel as f32);
    let [red, green, blue] = Image::from_pixels(ImageSize::new(1, 1), vec![pixel]).to_srgb8(0.0)[0];
    Color::rgb(red, green, blue)
}

/// θ between a direction and the normal, in degrees, from 0 to 90.
fn degrees(direction: DVec3, n: DVec3) -> String {
    format!("{:.1}°", direction.dot(n).abs().min(1.0).acos().to_degrees())
}

/// Turns a recorded tree into steps.
struct Walker<'a> {
    scene: &'a Scene,
    names: &'a [String],
    sources: &'a [PointSource],
    settings: Settings,
    tree: &'a RayTree,
    view: View,
    steps: Vec<Step>,
}

impl Walker<'_> {
    /// A step of the `k`-th call.
    fn step(&self, k: usize, happens: impl AsRef<str>) -> Step {
        let headline = format!("call {} {}", k + 1, happens.as_ref());
        Step::new(k, self.tree.nodes[k].call.depth as usize, headline)
    }

    /// All steps of the `k`-th call.
    fn call(&mut self, k: usize) {
        let node = &self.tree.nodes[k];
        match node.end {
            RayEnd::Cut => self.steps.push(self.cut(k, node)),
            RayEnd::Background => self.steps.push(self.background(k, node)),
            RayEnd::Surface { hit, position, local } => {
                let surface = self.scene.surface_at(&node.call.ray, &hit);
                let terms = LocalTerms::new(self.scene, self.sources, node, &surface);
                debug_assert_eq!(terms.sum(), local, "the terms are those of the method");
                let (view, origin, color) =
                    (self.view, node.call.ray.origin, kind(node.call.kind).1);
                let direction = node.call.ray.direction;
                let begins = self.begin(k, node).points_out(move |pen| {
                    pen.dot(view.side.flat(origin), 5.0, color);
                    view.direction(pen, origin, direction, "", Stroke::new(color, 4.0));
                });
                self.steps.push(begins);
                self.steps.push(self.hit(k, node, &hit, &surface, &terms));
                for (i, lamp) in terms.lamps.iter().enumerate() {
                    self.steps.push(self.lamp(k, i, lamp, &terms, position));
                }
                self.steps.push(self.local(k, &terms, local));
                self.recur(k, node, &surface, local);
            }
        }
    }

    /// The call with its arguments.
    fn begin(&self, k: usize, node: &RayNode) -> Step {
        let call = &node.call;
        let (from, sense) = match call.kind {
            RayKind::Primary => ("the eye", "from the eye through the pixel"),
            RayKind::Mirror => ("just off the surface", "away from the surface"),
            RayKind::Refracted => ("just behind the surface", "away from the surface"),
        };
        let (kind, depth, weight) = (kind(call.kind).0, call.depth, call.weight.shown());
        self.step(k, format!("begins: {kind} ray, depth {depth}, weight {weight}"))
            .line(format!("origin    {}, {from}", call.ray.origin.shown()))
            .line(format!("direction {}, unit, {sense}", call.ray.direction.shown()))
            .opens()
    }

    fn cut(&self, k: usize, node: &RayNode) -> Step {
        let Settings { max_depth, min_weight, .. } = self.settings;
        let why = if node.call.depth > max_depth {
            format!("its depth {} is more than {max_depth}", node.call.depth)
        } else {
            format!("its weight {} is less than {}", node.call.weight.shown(), min_weight.shown())
        };
        self.begin(k, node)
            .line(format!("cut: {why}; it returns {}", node.radiance.shown()))
            .returns(displayed(node.radiance))
    }

    fn background(&self, k: usize, node: &RayNode) -> Step {
        let (view, ray, color) = (self.view, node.call.ray, kind(node.call.kind).1);
        let far = view.beyond(ray.origin, ray.direction);
        self.begin(k, node)
            .line(format!("meets nothing; it returns the background {}", node.radiance.shown()))
            .draws(move |pen| view.ray(pen, ray.origin, far, color, k + 1))
            .returns(displayed(node.radiance))
    }

    fn hit(
        &self,
        k: usize,
        node: &RayNode,
        hit: &Hit,
        surface: &SurfacePoint,
        terms: &LocalTerms,
    ) -> Step {
        let ray = node.call.ray;
        let mesh = &self.scene.mesh;
        let shape = match self.scene.shape(hit.primitive) {
            Shape::Sphere(index) => format!("sphere {index}"),
            Shape::Triangle(index) => {
                format!("triangle {index} of face {}", mesh.triangles[index].face.0)
            }
        };
        let n = surface.shading_normal_towards(-ray.direction);
        let outside = surface.geometric_normal.dot(ray.direction) < 0.0;
        let side = if outside { "outside" } else { "inside" };
        let diffuse = terms.reflectance.diffuse;
        let (view, from, to) = (self.view, ray.origin, surface.position);
        let color = kind(node.call.kind).1;
        self.step(
            k,
            format!("meets {} at t = {}", self.names[surface.material.0 as usize], hit.t.shown()),
        )
        .line(format!("{shape}, from its {side}"))
        .line(format!("point     {}", to.shown()))
        // A sum with 0 is no −0.
        .line(format!("N         {}, unit, on the ray's side", (n + DVec3::ZERO).shown()))
        .line(format!("emission  {}", terms.emission.shown()))
        .line(format!(
            "ambient   ρ_d I_a = {} {} = {}",
            diffuse.shown(),
            self.scene.ambient.shown(),
            terms.ambient.shown()
        ))
        .draws(move |pen| view.ray(pen, from, to, color, k + 1))
        .points_out(move |pen| normal(view, pen, to, n))
    }

    fn lamp(&self, k: usize, i: usize, lamp: &LampTerm, terms: &LocalTerms, from: DVec3) -> Step {
        let LampTerm { position, intensity, distance, cos_light, cos_mirror, .. } = *lamp;
        let step = |happens: &str| {
            let count = self.sources.len();
            let (number, at) = (i + 1, position.shown());
            self.step(k, format!("asks lamp {number} of {count} at {at}: {happens}"))
        };
        let cosines = format!("N·L = {}, R·V = {}", cos_light.shown(), cos_mirror.shown());
        let Some(shadow) = lamp.shadow else {
            let why =
                if cos_light <= 0.0 { "it is behind the surface" } else { "it would add nothing" };
            return step("no shadow ray").line(format!("{cosines}: {why}"));
        };
        let vis = i32::from(shadow.visible);
        let reflectance = &terms.reflectance;
        let (view, visible) = (self.view, shadow.visible);
        let shown = if visible { "a shadow ray reaches it" } else { "it is in shadow" };
        step(&format!("vis = {vis}, {shown}"))
            .line(format!("I = {}, d = {}, {cosines}", intensity.shown(), distance.shown()))
            .line(format!(
                "ρ_d (N·L)   = {} {} = {}",
                reflectance.diffuse.shown(),
                cos_light.shown(),
                lamp.diffuse.shown()
            ))
            .line(format!(
                "ρ_s (R·V)^n = {} {}^{} = {}",
                reflectance.specular.shown(),
                cos_mirror.max(0.0).shown(),
                reflectance.shininess.shown(),
                lamp.specular.shown()
            ))
            .line(format!("I vis / d² (ρ_d (N·L) + ρ_s (R·V)^n) = {}", lamp.value().shown()))
            .draws(move |pen| view.dashed(pen, from, position, view::shadow(visible).1))
    }

    fn local(&self, k: usize, terms: &LocalTerms, local: Rgb) -> Step {
        let lamps = terms.lamps.iter().enumerate().filter(|(_, lamp)| lamp.shadow.is_some());
        let step = self
            .step(k, format!("has I_Local = {}", local.shown()))
            .line(format!("  ambient  {}", terms.ambient.shown()))
            .line(format!("+ emission {}", terms.emission.shown()));
        let step = if terms.lamps.is_empty() { step.line("  the scene has no lamp") } else { step };
        lamps.fold(step, |step, (i, lamp)| {
            step.line(format!("+ lamp {:<3} {}", i + 1, lamp.value().shown()))
        })
    }

    /// The calls that a surface spawns, and the sum of their answers.
    fn recur(&mut self, k: usize, node: &RayNode, surface: &SurfacePoint, local: Rgb) {
        let spawned = Spawned::new(self.scene, self.tree, k, surface);
        for child in [spawned.refracted, spawned.mirror].into_iter().flatten() {
            self.steps.push(self.spawn(k, child, surface, &spawned));
            self.call(child);
        }
        let answer =
            |child: Option<usize>| child.map_or(Rgb::ZERO, |child| self.tree.nodes[child].radiance);
        let (reflected, refracted) = (answer(spawned.mirror), answer(spawned.refracted));
        let sum = recursion(local, spawned.k_s, reflected, spawned.k_t, refracted);
        debug_assert_eq!(sum, node.radiance, "the sum is that of the method");
        let (view, from, to) = (self.view, surface.position, node.call.ray.origin);
        let color = kind(node.call.kind).1;
        let term = |name: &str, share: Rgb, answer: Rgb, child: Option<usize>| {
            let of = |child| {
                format!("+ {name} = {} {}, call {}", share.shown(), answer.shown(), child + 1)
            };
            child.map(of)
        };
        let spawned_terms = [
            term("k_s I_Refl ", spawned.k_s, reflected, spawned.mirror),
            term("k_t I_Trans", spawned.k_t, refracted, spawned.refracted),
        ];
        let step = self
            .step(k, "returns I_R = I_Local + k_s I_Refl + k_t I_Trans")
            .line(format!("  I_Local     = {}", local.shown()));
        let step = spawned_terms
            .into_iter()
            .flatten()
            .fold(step, Step::line)
            .line(format!("  I_R         = {}", sum.shown()))
            .points_out(move |pen| view.arrow(pen, from, to, Stroke::new(color, 4.0)))
            .returns(displayed(sum));
        self.steps.push(step);
    }

    fn spawn(&self, k: usize, child: usize, surface: &SurfacePoint, spawned: &Spawned) -> Step {
        let (parent, call) = (&self.tree.nodes[k].call, &self.tree.nodes[child].call);
        let incident = parent.ray.direction;
        let n = surface.optical_normal(incident);
        let [n1, n2] =
            indices(surface, self.scene.material(surface.material).refractive_index, incident);
        let theta = degrees(incident, n);
        let (share, lines) = if call.kind == RayKind::Refracted {
            let law = format!(
                "n1 sin θ1 = n2 sin θ2: n1 = {}, θ1 = {theta}, n2 = {}, θ2 = {}",
                n1.shown(),
                n2.shown(),
                degrees(call.ray.direction, n)
            );
            (format!("k_t = {}", spawned.k_t.shown()), vec![law])
        } else {
            let mut lines = vec![format!("R = D − 2 (N·D) N, θ = {theta} on both sides of N")];
            if spawned.total_reflection {
                let limit = degrees(DVec3::X, DVec3::X * (1.0 - (n2 / n1).powi(2)).max(0.0).sqrt());
                lines.push(format!(
                    "total reflection: n1 = {}, n2 = {}, θ1 = {theta} is more than {limit}; k_t goes to the mirror",
                    n1.shown(),
                    n2.shown()
                ));
            }
            (format!("k_s = {}", spawned.k_s.shown()), lines)
        };
        let (view, from, color) = (self.view, surface.position, kind(call.kind).1);
        let direction = call.ray.direction;
        let letter = if call.kind == RayKind::Refracted { "T" } else { "R" };
        let step =
            self.step(k, format!("spawns call {}: {} ray, {share}", child + 1, kind(call.kind).0));
        let step = lines.into_iter().fold(step, Step::line);
        step.line(format!(
            "weight {} × {} = {}",
            parent.weight.shown(),
            (call.weight / parent.weight).shown(),
            call.weight.shown()
        ))
        .points_out(move |pen| {
            normal(view, pen, from, n);
            view.direction(pen, from, direction, letter, Stroke::new(color, 4.0));
        })
    }
}

/// N at a point of a surface.
fn normal(view: View, pen: &mut Pen<'_>, at: DVec3, n: DVec3) {
    // Longer than R and T, so that their letters keep apart.
    view.direction(pen, at, 1.7 * n, "N", Stroke::new(INK, 1.6));
}
