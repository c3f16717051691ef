//! The terms of the slides' sums at one node of a ray tree, worked out again from what the tree has recorded.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::illumination::{Reflectance, ambient, local};
use lancer_core::optics::{Branches, reflect};
use lancer_core::scene::{PointSource, Scene};
use lancer_core::world::SurfacePoint;
use lancer_whitted::{RayKind, RayNode, RayTree, ShadowRay};

/// The light that leaves a surface without the help of other surfaces: `algo:appel`, term by term.
pub struct LocalTerms {
    /// ε, as far as it goes to the eye.
    pub emission: Rgb,
    /// ρ_d, and n and ρ_s of the highlight.
    pub reflectance: Reflectance,
    /// ρ̄ I_a.
    pub ambient: Rgb,
    /// One term of `eq:local` for each lamp, in the scene's order.
    pub lamps: Vec<LampTerm>,
}

/// What one lamp adds: I · vis / d² · ( ρ_d (N·L) + ρ_s (R·V)ⁿ ).
pub struct LampTerm {
    /// Where the lamp stands.
    pub position: DVec3,
    /// I, towards the surface.
    pub intensity: Rgb,
    /// d, in scene units.
    pub distance: f64,
    /// N·L: N on the eye's side, L to the lamp.
    pub cos_light: f64,
    /// R·V: R the mirror direction of the light, V to the eye.
    pub cos_mirror: f64,
    /// ρ_d (N·L).
    pub diffuse: Rgb,
    /// ρ_s (R·V)ⁿ.
    pub specular: Rgb,
    /// The term with vis = 1.
    pub unshadowed: Rgb,
    /// vis, if a shadow ray was cast: none is cast to a lamp that would add nothing.
    pub shadow: Option<ShadowRay>,
}

impl LocalTerms {
    /// The terms at the surface that a node's ray met.
    pub fn new(
        scene: &Scene,
        sources: &[PointSource],
        node: &RayNode,
        surface: &SurfacePoint,
    ) -> Self {
        let to_eye = -node.call.ray.direction;
        let n = surface.shading_normal_towards(to_eye);
        let reflectance = scene.reflectance(surface);
        // Lamps are asked in their order, so that the shadow rays come in it too.
        let mut shadows = node.shadows.iter();
        let lamp = |source: &PointSource| {
            let mut term = LampTerm::new(source, surface, &reflectance, n, to_eye);
            if term.unshadowed != Rgb::ZERO {
                term.shadow = shadows.next().copied();
            }
            term
        };
        Self {
            emission: scene.emitted(surface, to_eye),
            reflectance,
            ambient: ambient(reflectance.diffuse, scene.ambient),
            lamps: sources.iter().map(lamp).collect(),
        }
    }

    /// The sum, in the order in which the method adds.
    pub fn sum(&self) -> Rgb {
        let emitted = self.ambient + self.emission;
        self.lamps.iter().fold(emitted, |sum, lamp| sum + lamp.value())
    }
}

impl LampTerm {
    fn new(
        source: &PointSource,
        surface: &SurfacePoint,
        reflectance: &Reflectance,
        n: DVec3,
        to_eye: DVec3,
    ) -> Self {
        let light = source.arriving(surface);
        let distance = light.shadow_ray.direction.length();
        let to_light = light.shadow_ray.direction * distance.recip();
        let intensity = (light.intensity)(to_light);
        let part = |reflectance: &Reflectance| local(reflectance, n, to_light, to_eye);
        let (matte, shiny) = (
            Reflectance { specular: Rgb::ZERO, ..*reflectance },
            Reflectance { diffuse: Rgb::ZERO, ..*reflectance },
        );
        Self {
            position: source.position,
            intensity,
            distance,
            cos_light: n.dot(to_light),
            cos_mirror: reflect(-to_light, n).dot(to_eye),
            diffuse: part(&matte),
            specular: part(&shiny),
            unshadowed: light.unshadowed(reflectance, n, to_eye),
            shadow: None,
        }
    }

    /// The term itself.
    pub fn value(&self) -> Rgb {
        match self.shadow {
            Some(ShadowRay { visible: true, .. }) => self.unshadowed,
            _ => Rgb::ZERO,
        }
    }
}

/// The calls that a node made, with the shares of `eq:recursion` that they count with.
pub struct Spawned {
    /// k_s; after total reflection k_t is in it.
    pub k_s: Rgb,
    /// The number of the call along the mirror direction.
    pub mirror: Option<usize>,
    /// k_t, unless it went to the mirror direction.
    pub k_t: Rgb,
    /// The number of the call along the refracted direction.
    pub refracted: Option<usize>,
    /// Whether the surface is transparent and lets nothing pass in this direction.
    pub total_reflection: bool,
}

impl Spawned {
    /// What the `k`-th call of `tree` spawned from `surface`.
    pub fn new(scene: &Scene, tree: &RayTree, k: usize, surface: &SurfacePoint) -> Self {
        let material = scene.material(surface.material);
        let child = |kind: RayKind| {
            (k + 1..tree.nodes.len()).find(|&child| {
                let node = &tree.nodes[child];
                node.parent == Some(k) && node.call.kind == kind
            })
        };
        let branches = Branches::new(surface, material, tree.nodes[k].call.ray.direction);
        let [k_s, k_t] = branches.shares();
        let (mirror, refracted) = (child(RayKind::Mirror), child(RayKind::Refracted));
        Self { k_s, mirror, k_t, refracted, total_reflection: branches.total_reflection }
    }
}
