//! E1.9: the ray tree, and its rays counted.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::Ray;
use lancer_core::image::{Image, ImageSize};
use lancer_core::scene::{PointSource, Scene};
use lancer_exercise::{
    Card, Check, Exercise, Mismatch, Shown, Solution, Verdict, ensure, slips, within,
};
use lancer_lesson::scenes::parsed;
use lancer_whitted::{RayCounts, RayEnd, RayKind, RayNode};

use super::reference::ray_tree;
use super::{
    FAR_MIRROR, Node, Stage, Subject, far_mirror, from_eye, painted, reference, title_rays,
};
use crate::scenes;

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E1.9",
        name: "ray-tree",
        title: "The ray tree",
        slide: "Arbre de rayons",
        stub: include_str!("../../stubs/e09_ray_tree.rs"),
        functions: &["ray_tree", "count_rays"],
        minutes: 30,
        predict: "the title scene in the colours of the rays that each pixel takes, mirror rays red, refracted rays \
                  green, shadow rays blue: which colour has the floor, which the mirror ball, and where is it \
                  brightest?",
        vary: "leave out the children of weight below 1/50: how many rays are left of the brightest pixels?",
        hints: [
            "It is LR again, with the same two ends and the same two calls. Each call returns its node instead of \
             a colour.",
            "A child's call: the ray that leaves the surface, depth + 1, weight · max(k), and its kind. A ray is \
             counted if it was traced; the tree's count is its root's and those of the children's trees.",
            "A closure makes a child: `let child = |direction, k: Rgb, kind| ray_tree(stage, &Call { ray: \
             surface.spawn(direction), depth: call.depth + 1, weight: call.weight * k.max_element(), kind });`. \
             Push what it returns for `RayKind::Refracted`, then for `RayKind::Mirror`.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e09_ray_tree.rs"),
            file: "crates/whitted/src/ray_tree.rs",
            item: "impl Recorder for RayTree",
            notice: "there is no second recursion: the tree is recorded while LR runs, so it cannot differ from it",
        },
    },
    checks: &[
        Check { name: "the rays of a given tree", run: given_tree },
        Check { name: "a ray that meets nothing is one node", run: miss },
        Check { name: "shadow rays go to the lamps in front", run: lamps },
        Check { name: "two mirrors make a chain", run: chain },
        Check { name: "a mirror far from the origin", run: far_from_origin },
        Check { name: "a pane sends two rays", run: pane },
        Check { name: "total reflection sends one", run: total_reflection },
        Check { name: "a stack of panes makes a full tree", run: full_tree },
        Check { name: "the title picture", run: title },
    ],
    slips: slips! {
        count_rays(node):
        "a ray beyond Max_Prof is counted: it was never traced":
            "the rays of a given tree" catches counted(node, &|node| (true, node.shadows));
        "a surface's shadow rays are counted once, however many lamps it faces":
            "the rays of a given tree" catches
                counted(node, &|node| (node.traced, node.shadows.min(1)));

        ray_tree(stage, call):
        "the weight is the last k alone: it is the product of all k on the way":
            "two mirrors make a chain" catches changed(ray_tree(stage, call), &|node| {
                node.children.iter_mut().for_each(|child| child.weight /= node.weight);
            });
        "the recursion ends one bounce early: a ray at Max_Prof is still traced, one beyond is not":
            "two mirrors make a chain" catches changed(ray_tree(stage, call), &|node| {
                if node.depth >= stage.max_depth {
                    *node = cut(node.kind, node.depth, node.weight);
                }
            });
        "the mirror ray comes before the refracted one":
            "a pane sends two rays" catches
                changed(ray_tree(stage, call), &|node| node.children.reverse());
        "a call beyond Max_Prof has no node at all: it stays in the tree as a leaf":
            "two mirrors make a chain" catches
                changed(ray_tree(stage, call), &|node| node.children.retain(|child| child.traced));
    },
    own: |yours, reference| Subject {
        ray_tree: yours.ray_tree,
        count_rays: yours.count_rays,
        ..reference
    },
    draw,
    explain: Some(explain),
};

/// Counts by a rule: whether a node counts as a ray, and its shadow rays.
fn counted(node: &Node, rule: &impl Fn(&Node) -> (bool, u32)) -> RayCounts {
    let (is_ray, shadows) = rule(node);
    let mut counts = RayCounts { shadow: shadows.into(), ..RayCounts::default() };
    *counts.count_mut(node.kind) += u64::from(is_ray);
    for child in &node.children {
        counts += counted(child, rule);
    }
    counts
}

/// A tree with something changed at each node, the children first.
fn changed(mut node: Node, change: &impl Fn(&mut Node)) -> Node {
    let children = std::mem::take(&mut node.children);
    node.children = children.into_iter().map(|child| changed(child, change)).collect();
    change(&mut node);
    node
}

fn traced(kind: RayKind, depth: u32, weight: f64, children: Vec<Node>) -> Node {
    Node { kind, depth, weight, traced: true, shadows: 0, children }
}

fn cut(kind: RayKind, depth: u32, weight: f64) -> Node {
    Node { traced: false, ..traced(kind, depth, weight, Vec::new()) }
}

fn counts_shown(counts: &RayCounts) -> String {
    let RayCounts { primary, mirror, refracted, shadow } = counts;
    format!("primary {primary}, mirror {mirror}, refracted {refracted}, shadow {shadow}")
}

fn compare_counts(subject: &Subject, case: String, tree: &Node, wanted: &RayCounts) -> Verdict {
    let got = (subject.count_rays)(tree);
    ensure(got == *wanted, || Mismatch::new(case, counts_shown(&got), counts_shown(wanted)))
}

/// The tree of a ray in a scene, given as a text and in words.
fn compare(
    subject: &Subject,
    text: &str,
    words: &str,
    ray: Ray,
    max_depth: u32,
    wanted: &Node,
) -> Verdict {
    let scene = parsed("exercise", text);
    let stage = Stage::new(&scene, max_depth, reference::SUBJECT);
    let got = (subject.ray_tree)(&stage, &from_eye(ray));
    within(1e-14, || format!("{words}; {}, Max_Prof {max_depth}", ray.shown()), &got, wanted)
}

fn given_tree(subject: &Subject) -> Verdict {
    use RayKind::{Mirror, Primary, Refracted};
    let lit = |node, shadows| Node { shadows, ..node };
    let leaf = |kind, depth| traced(kind, depth, 0.5, Vec::new());
    let inner = traced(Refracted, 1, 0.5, vec![lit(leaf(Refracted, 2), 3), cut(Mirror, 2, 0.25)]);
    let tree = lit(traced(Primary, 0, 1.0, vec![inner, lit(leaf(Mirror, 1), 1)]), 2);
    let wanted = RayCounts { primary: 1, mirror: 1, refracted: 2, shadow: 6 };
    compare_counts(subject, format!("count_rays of the tree\n{}", tree.shown()), &tree, &wanted)
}

fn miss(subject: &Subject) -> Verdict {
    let text = "
        material.ball = { rho_d = 1, k_s = 1 }
        light = [{ position = [0, 4, 0], intensity = 1 }]
        sphere = [{ center = [0, 0, 9], radius = 1, material = 'ball' }]";
    let ray = Ray::new(DVec3::ZERO, DVec3::NEG_Z);
    let wanted = traced(RayKind::Primary, 0, 1.0, Vec::new());
    compare(subject, text, "a ball behind, a lamp", ray, 5, &wanted)
}

fn lamps(subject: &Subject) -> Verdict {
    let text = "
        material.floor = { rho_d = 1 }
        light = [
            { position = [0, 2, 0], intensity = 1 }, { position = [5, 1, 0], intensity = 1 },
            { position = [0, -3, 1], intensity = 1 }]
        polygon = [{ vertices = [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]], material = 'floor' }]";
    let words = "a floor y = 0, two lamps above it and one below";
    for (eye, shadows) in [(DVec3::new(3.0, 4.0, 0.0), 2), (DVec3::new(3.0, -4.0, 0.0), 1)] {
        let wanted = Node { shadows, ..traced(RayKind::Primary, 0, 1.0, Vec::new()) };
        compare(subject, text, words, Ray::new(eye, -eye / 5.0), 5, &wanted)?;
    }
    Ok(())
}

fn chain(subject: &Subject) -> Verdict {
    let text = "
        material.mirror = { k_s = [0.125, 0.5, 0.25] }
        polygon = [
            { vertices = [[1, -1, -1], [1, -1, 1], [1, 1, 1], [1, 1, -1]], material = 'mirror' },
            { vertices = [[-1, -1, 1], [-1, -1, -1], [-1, 1, -1], [-1, 1, 1]], material = 'mirror' }]";
    let words = "mirrors x = −1 and x = 1, k_s = (0.125, 0.5, 0.25)";
    for max_depth in [0, 1, 3] {
        let mirror = |node, depth: u32| {
            traced(RayKind::Mirror, depth, 0.5_f64.powi(depth as i32), vec![node])
        };
        let end = cut(RayKind::Mirror, max_depth + 1, 0.5_f64.powi(max_depth as i32 + 1));
        let below = (1..=max_depth).rev().fold(end, mirror);
        let wanted = traced(RayKind::Primary, 0, 1.0, vec![below]);
        compare(subject, text, words, Ray::new(DVec3::ZERO, DVec3::X), max_depth, &wanted)?;
    }
    Ok(())
}

/// A ray that does not leave the mirror by the error of its point meets it once more.
fn far_from_origin(subject: &Subject) -> Verdict {
    let (text, rays) = far_mirror();
    let mirror = traced(RayKind::Mirror, 1, 0.5, Vec::new());
    let wanted = traced(RayKind::Primary, 0, 1.0, vec![mirror]);
    rays.into_iter().try_for_each(|ray| compare(subject, &text, FAR_MIRROR, ray, 5, &wanted))
}

/// Panes z = 0, −1, −2, … on both sides of the first.
fn panes(reach: i32) -> String {
    let pane = |z: i32| {
        format!(
            "{{ vertices = [[-99, -99, {z}], [99, -99, {z}], [99, 99, {z}], [-99, 99, {z}]], \
             material = 'pane' }}"
        )
    };
    let panes: Vec<String> = (-reach..=reach).map(pane).collect();
    format!(
        "material.pane = {{ k_s = [0.25, 0.125, 0.125], k_t = [0.25, 0.5, 0.25] }}\npolygon = [{}]",
        panes.join(", ")
    )
}

fn pane(subject: &Subject) -> Verdict {
    let words =
        "a pane z = 0, refractive index 1, k_t = (0.25, 0.5, 0.25), k_s = (0.25, 0.125, 0.125)";
    let ray = Ray::new(DVec3::new(0.0, 0.0, 0.5), DVec3::new(0.6, 0.0, -0.8));
    let children = vec![
        traced(RayKind::Refracted, 1, 0.5, Vec::new()),
        traced(RayKind::Mirror, 1, 0.25, Vec::new()),
    ];
    let wanted = traced(RayKind::Primary, 0, 1.0, children);
    compare(subject, &panes(0), words, ray, 5, &wanted)
}

/// From within glass at 45 degrees, where the sine 0.707 is above 2/3.
fn total_reflection(subject: &Subject) -> Verdict {
    let text = "
        material.glass = { k_s = [0.25, 0, 0], k_t = [0.5, 0.625, 0.5], refractive_index = 1.5 }
        polygon = [{ vertices = [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]], material = 'glass' }]";
    let words = "glass below y = 0, refractive index 1.5, k_s = (0.25, 0, 0), k_t = (0.5, 0.625, 0.5), met from \
                 inside at 45 degrees";
    let ray = Ray::new(DVec3::new(-2.0, -2.0, 0.0), DVec3::new(1.0, 1.0, 0.0).normalize());
    let mirror = traced(RayKind::Mirror, 1, 0.75, Vec::new());
    compare(subject, text, words, ray, 5, &traced(RayKind::Primary, 0, 1.0, vec![mirror]))
}

/// Between panes without end every ray meets one, so Max_Prof 5 leaves 2⁶ − 1 traced calls and 2⁶ leaves.
fn full_tree(subject: &Subject) -> Verdict {
    let scene = parsed("panes", &panes(6));
    let ray = Ray::new(DVec3::new(0.0, 0.0, 0.5), DVec3::new(0.6, 0.0, -0.8));
    let tree = (subject.ray_tree)(&Stage::new(&scene, 5, reference::SUBJECT), &from_eye(ray));
    let (mut nodes, mut leaves, mut open) = (0_u32, 0_u32, vec![&tree]);
    while let Some(node) = open.pop() {
        nodes += u32::from(node.traced);
        leaves += u32::from(!node.traced);
        open.extend(&node.children);
    }
    let case = || {
        format!(
            "calls that are traced and calls that are cut; panes z = −6 to 6, {}, Max_Prof 5",
            ray.shown()
        )
    };
    within(0.0, case, &(nodes, leaves), &(63, 64))?;
    let wanted = RayCounts { primary: 1, mirror: 31, refracted: 31, shadow: 0 };
    let case = "count_rays of this tree, half of whose calls are mirror rays";
    compare_counts(subject, case.to_owned(), &tree, &wanted)
}

const MAX_DEPTH: u32 = 5;

/// The tree below a call that the course's own LR has made. It casts no shadow ray to a lamp that would add nothing,
/// so the lamps in front are counted here.
fn recorded(stage: &Stage, calls: &[RayNode], index: usize) -> Node {
    let RayNode { call, end, .. } = &calls[index];
    let mut node = Node::untraced(call);
    node.traced = !matches!(end, RayEnd::Cut);
    if let RayEnd::Surface { hit, position, .. } = end {
        let surface = stage.scene.surface_at(&call.ray, hit);
        let n = surface.shading_normal_towards(-call.ray.direction);
        let is_in_front = |lamp: &&PointSource| n.dot(lamp.position - position) > 0.0;
        node.shadows = stage.lamps.iter().filter(is_in_front).count() as u32;
    }
    let made = (index + 1..calls.len()).filter(|&child| calls[child].parent == Some(index));
    node.children = made.map(|child| recorded(stage, calls, child)).collect();
    node
}

fn title(subject: &Subject) -> Verdict {
    let (scene, rays) = title_rays(MAX_DEPTH);
    for (case, ray) in rays {
        let (stage, call) = (|| Stage::new(&scene, MAX_DEPTH, reference::SUBJECT), from_eye(ray));
        let stage_of_course = stage();
        let calls = stage_of_course.recorded(&call).nodes;
        let wanted = recorded(&stage_of_course, &calls, 0);
        within(1e-14, || case, &(subject.ray_tree)(&stage(), &call), &wanted)?;
    }
    Ok(())
}

const SIZE: ImageSize = ImageSize::new(240, 180);
/// As many rays of a kind are its channel's full brightness: surfaces face two lamps.
const BRIGHTEST: Rgb = Rgb::new(8.0, 8.0, 32.0);

fn tree_at(subject: &Subject, scene: &Scene, x: f64, y: f64) -> Node {
    let ray = (subject.primary_ray)(&scene.camera, SIZE, x, y);
    (subject.ray_tree)(&Stage::new(scene, MAX_DEPTH, *subject), &from_eye(ray))
}

/// The rays of each pixel of the title scene: red, green and blue are mirror, refracted and shadow rays.
fn draw(subject: &Subject) -> Image {
    let scene = scenes::whitted();
    painted(SIZE, |x, y| {
        let counts = (subject.count_rays)(&tree_at(subject, &scene, x, y));
        let RayCounts { mirror, refracted, shadow, .. } = counts;
        Rgb::from([mirror, refracted, shadow].map(|count| count as f64)) / BRIGHTEST
    })
}

/// The tree at a pixel, and its counts.
fn explain(subject: &Subject, [x, y]: [u32; 2]) -> String {
    let tree = tree_at(subject, &scenes::whitted(), f64::from(x) + 0.5, f64::from(y) + 0.5);
    format!("{}\n{}", tree.shown(), counts_shown(&(subject.count_rays)(&tree)))
}
