//! E4.4: near child first.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray, Sphere};
use lancer_core::image::{Image, ImageSize};
use lancer_core::intersector::{Hit, Intersector, LinearScan, TestCounts};
use lancer_core::sampling::Uniform;
use lancer_core::scene::{MaterialId, Mesh, Scene, SphereObject};
use lancer_exercise::{Card, Check, Exercise, Mismatch, Mutant, Shown, Solution, same};
use lancer_lesson::picture::painted;

use super::reference::visit;
use super::walk::Tree;
use super::{Subject, Walk};

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E4.4",
        name: "ordered-walk",
        title: "Near child first",
        slide: "Hiérarchie de volumes englobants",
        file: "e04_ordered_walk.rs",
        stub: include_str!("../../stubs/e04_ordered_walk.rs"),
        functions: &["visit"],
        minutes: 20,
        predict: "left the picture shows the balls, right how many of them each ray tests: where are the \
                  costly rays, in the middle of a ball or along its rim?",
        vary: "visit the far child first, and draw again: the left picture stays; where does the right one \
               change most?",
        hints: [
            "A ray that misses a box misses all that is in it. A hit in the near child often makes the far one \
             superfluous: ask again before you go there.",
            "Test both children's boxes, then visit the one that is entered first, then the other if it is \
             entered before the closest hit *by then*.",
            "`let Some(children) = walk.children(node) else { return walk.test_leaf(node) };` then `let mut order \
             = children.map(|child| (walk.enter(child), child));`, swapped if the second is entered first, and \
             `visit` each whose `enter` is not beyond `walk.closest()`.",
        ],
        solution: Solution {
            file: "crates/accel/src/binary_tree.rs",
            item: "fn visit",
            notice: "None is less than any Some, so children that are missed come first, and cost nothing",
        },
    },
    checks: &[
        Check { name: "the tests along a row", run: along_a_row },
        Check { name: "the tests against a row", run: against_a_row },
        Check { name: "the closest hit among many", run: closest },
        Check { name: "no more primitives than need be", run: primitives },
        Check { name: "no box twice", run: box_tests },
    ],
    mutants: &[
        Mutant {
            says: "children are visited in the order in which they are stored, not the near one first",
            caught_by: "the tests along a row",
            mistake: |subject| subject.visit = stored,
        },
        Mutant {
            says: "the far child comes first",
            caught_by: "the tests against a row",
            mistake: |subject| subject.visit = far_first,
        },
        Mutant {
            says: "the far child is visited although the near one has a hit in front of it: compare its t \
                   with the closest hit after the near child's visit",
            caught_by: "no more primitives than need be",
            mistake: |subject| subject.visit = no_pruning,
        },
        Mutant {
            says: "only the nearer child is visited: a ray that meets its box may still miss what is in it",
            caught_by: "the closest hit among many",
            mistake: |subject| subject.visit = near_only,
        },
        Mutant {
            says: "the walk ends with the first hit, whatever comes nearer in the other child: boxes overlap",
            caught_by: "the closest hit among many",
            mistake: |subject| subject.visit = first_hit,
        },
        Mutant {
            says: "children are visited without a test of their boxes",
            caught_by: "the tests along a row",
            mistake: |subject| subject.visit = everything,
        },
        Mutant {
            says: "the far child's box is tested a second time: its t is known, and only the closest hit has \
                   changed",
            caught_by: "no box twice",
            mistake: |subject| subject.visit = twice,
        },
    ],
    draw,
    explain: None,
};

fn ordered(walk: &mut Walk, children: [usize; 2]) -> [(Option<f64>, usize); 2] {
    let mut order = children.map(|child| (walk.enter(child), child));
    if order[1].0 < order[0].0 {
        order.reverse();
    }
    order
}

fn stored(walk: &mut Walk, node: usize) {
    let Some(children) = walk.children(node) else { return walk.test_leaf(node) };
    for child in children {
        if walk.enter(child).is_some() {
            stored(walk, child);
        }
    }
}

fn far_first(walk: &mut Walk, node: usize) {
    let Some(children) = walk.children(node) else { return walk.test_leaf(node) };
    for (enter, child) in ordered(walk, children).into_iter().rev() {
        if enter.is_some_and(|enter| enter <= walk.closest()) {
            far_first(walk, child);
        }
    }
}

fn no_pruning(walk: &mut Walk, node: usize) {
    let Some(children) = walk.children(node) else { return walk.test_leaf(node) };
    for (enter, child) in ordered(walk, children) {
        if enter.is_some() {
            no_pruning(walk, child);
        }
    }
}

fn near_only(walk: &mut Walk, node: usize) {
    let Some(children) = walk.children(node) else { return walk.test_leaf(node) };
    if let Some((_, child)) = ordered(walk, children).into_iter().find(|(enter, _)| enter.is_some())
    {
        near_only(walk, child);
    }
}

fn first_hit(walk: &mut Walk, node: usize) {
    let Some(children) = walk.children(node) else { return walk.test_leaf(node) };
    for (enter, child) in ordered(walk, children) {
        if enter.is_some() && walk.closest().is_infinite() {
            first_hit(walk, child);
        }
    }
}

fn everything(walk: &mut Walk, node: usize) {
    let Some(children) = walk.children(node) else { return walk.test_leaf(node) };
    children.into_iter().for_each(|child| everything(walk, child));
}

fn twice(walk: &mut Walk, node: usize) {
    let Some(children) = walk.children(node) else { return walk.test_leaf(node) };
    for (k, (enter, child)) in ordered(walk, children).into_iter().enumerate() {
        if enter.is_some() && (k == 0 || walk.enter(child).is_some()) {
            twice(walk, child);
        }
    }
}

fn balls(shapes: impl IntoIterator<Item = Sphere>) -> Scene {
    let sphere = |shape| SphereObject { shape, material: MaterialId(0) };
    Scene { spheres: shapes.into_iter().map(sphere).collect(), ..Scene::of_mesh(Mesh::default()) }
}

/// Four balls of radius 1/2 at x = 2, 4, 6 and 8.
fn row() -> Scene {
    balls([2.0, 4.0, 6.0, 8.0].map(|x| Sphere { center: DVec3::X * x, radius: 0.5 }))
}

fn walked(subject: &Subject, scene: &Scene, tree: &Tree, ray: &Ray) -> (Option<Hit>, TestCounts) {
    Walk::new(scene, tree, ray).run(subject.visit)
}

/// Straight to the first ball: the root, its children, the near one's children, and one ball.
fn in_row(subject: &Subject, origin: f64, wanted: f64) -> Result<(), Mismatch> {
    let scene = row();
    let ray = Ray::new(DVec3::X * origin, DVec3::X * (5.0 - origin).signum());
    let (hit, counts) = walked(subject, &scene, &Tree::new(&scene), &ray);
    let case = |what: &str| {
        format!("balls of radius 0.5 at x = 2, 4, 6, 8 in pairs; {}: {what}", ray.shown())
    };
    same(|| case("t"), &hit.map(|hit| hit.t), &Some(wanted))?;
    same(|| case("primitives tested"), &counts.primitives, &1)?;
    same(|| case("boxes tested"), &counts.boxes, &5)
}

fn along_a_row(subject: &Subject) -> Result<(), Mismatch> {
    in_row(subject, -1.0, 2.5)
}

fn against_a_row(subject: &Subject) -> Result<(), Mismatch> {
    in_row(subject, 12.0, 3.5)
}

/// Balls that overlap, and rays from all around.
fn heap() -> (Scene, Vec<Ray>) {
    let mut random = Uniform::new(44, 0, 0);
    let mut point = || DVec3::from_array(std::array::from_fn(|_| random.number()));
    let shapes: Vec<Sphere> =
        (0..60).map(|_| Sphere { center: 4.0 * point(), radius: 0.1 + 0.5 * point().x }).collect();
    let rays = (0..300).map(|_| {
        let origin = 14.0 * point() - 5.0;
        Ray::new(origin, 4.0 * point() - origin)
    });
    let rays = rays.collect();
    (balls(shapes), rays)
}

/// Compares what a question about a walk gets as an answer from the subject and from the reference.
fn over_the_heap(
    subject: &Subject,
    judge: impl Fn(&Ray, (Option<Hit>, TestCounts), TestCounts) -> Result<(), Mismatch>,
) -> Result<(), Mismatch> {
    let (scene, rays) = heap();
    let tree = Tree::new(&scene);
    rays.iter().try_for_each(|ray| {
        let (_, fair) = Walk::new(&scene, &tree, ray).run(visit);
        judge(ray, walked(subject, &scene, &tree, ray), fair)
    })
}

fn closest(subject: &Subject) -> Result<(), Mismatch> {
    let (scene, _) = heap();
    let oracle = LinearScan::new(&scene);
    over_the_heap(subject, |ray, (hit, _), _| {
        let wanted = oracle.closest_hit(ray, Interval::POSITIVE);
        let t = |hit: Option<Hit>| hit.map(|hit| hit.t);
        same(|| format!("60 balls; {}: t", ray.shown()), &t(hit), &t(wanted))
    })
}

fn no_more(what: &str, ray: &Ray, got: u64, fair: u64) -> Result<(), Mismatch> {
    if got <= fair {
        return Ok(());
    }
    let case = format!("60 balls; {}: {what}", ray.shown());
    Err(Mismatch::new(case, got.to_string(), format!("no more than {fair}")))
}

fn primitives(subject: &Subject) -> Result<(), Mismatch> {
    over_the_heap(subject, |ray, (_, counts), fair| {
        no_more("primitives tested", ray, counts.primitives, fair.primitives)
    })
}

fn box_tests(subject: &Subject) -> Result<(), Mismatch> {
    over_the_heap(subject, |ray, (_, counts), fair| {
        no_more("boxes tested", ray, counts.boxes, fair.boxes)
    })
}

/// Left the distance of the balls, right the number of balls tested, red from 8 on.
fn draw(subject: &Subject) -> Image {
    let (scene, _) = heap();
    let tree = Tree::new(&scene);
    painted(ImageSize::new(320, 160), |x, y| {
        let at = DVec3::new(4.0 * (x % 160.0) / 160.0, 4.0 - 4.0 * y / 160.0, -2.0);
        let (hit, counts) = walked(subject, &scene, &tree, &Ray::new(at, DVec3::Z));
        if x < 160.0 {
            let t = hit.map_or(6.0, |hit| hit.t);
            return Rgb::splat(1.0 - t / 6.5);
        }
        let part = (counts.primitives as f64 / 8.0).min(1.0);
        Rgb::new(part, 0.7 * part * (1.0 - part), 0.5 * (1.0 - part))
    })
}
