//! E4.4: near child first.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray, Sphere};
use lancer_core::image::{Image, ImageSize};
use lancer_core::intersector::{Hit, Intersector, LinearScan, TestCounts};
use lancer_core::sampling::Uniform;
use lancer_core::scene::{MaterialId, Mesh, Scene, SphereObject};
use lancer_exercise::{
    Card, Check, Exercise, Mismatch, Shown, Solution, Verdict, ensure, same, slips,
};
use lancer_lesson::picture::painted;

use super::walk::Tree;
use super::{Subject, Walk};

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E4.4",
        name: "ordered-walk",
        title: "Near child first",
        slide: "Hiérarchie de volumes englobants",
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
            answer: include_str!("../../solutions/e04_ordered_walk.rs"),
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
        Check { name: "every ray of the picture", run: from_the_front },
    ],
    slips: slips! {
        visit(walk, node):
        "children are visited in the order in which they are stored, not the near one first":
            "the tests along a row" catches
                by(walk, node, as_stored, |walk, _, (_, child)| walk.enter(child).is_some());
        "the far child comes first":
            "the tests against a row" catches
                by(walk, node, far_first, |walk, _, (t, _)| t.is_some_and(|t| t <= walk.closest()));
        "the far child is visited although the near one has a hit in front of it: compare its t with the closest \
         hit after the near child's visit":
            "no more primitives than need be" catches
                by(walk, node, near_first, |_, _, (t, _)| t.is_some());
        "only the nearer child is visited: a ray that meets its box may still miss what is in it":
            "the closest hit among many" catches by(walk, node, near_only, |_, _, _| true);
        "where one child is missed the other is not visited either: a ray may meet either of the two":
            "the closest hit among many" catches by(walk, node, both_or_none, |walk, _, (t, _)| {
                t.is_some_and(|t| t <= walk.closest())
            });
        "the walk ends with the first hit, whatever comes nearer in the other child: boxes overlap":
            "the closest hit among many" catches by(walk, node, near_first, |walk, _, (t, _)| {
                t.is_some() && walk.closest().is_infinite()
            });
        "children are visited without a test of their boxes":
            "the tests along a row" catches by(walk, node, as_stored, |_, _, _| true);
        "the node's own box is tested: whoever called has done that, and asked only because the ray meets it":
            "the tests along a row" catches own_box(walk, node);
        "the far child's box is tested a second time: its t is known, and only the closest hit has changed":
            "no box twice" catches by(walk, node, near_first, |walk, place, (t, child)| {
                t.is_some() && (place == 0 || walk.enter(child).is_some())
            });
    },
    own: |yours, reference| Subject { visit: yours.visit, ..reference },
    draw,
    explain: None,
};

/// A child, and the t at which the ray enters its box, if that has been asked and the ray does.
type Child = (Option<f64>, usize);

/// A walk into the children of a row that `goes` lets in, given the place in the row.
fn by(
    walk: &mut Walk,
    node: usize,
    row: fn(&mut Walk, [usize; 2]) -> Vec<Child>,
    goes: fn(&mut Walk, usize, Child) -> bool,
) {
    let Some(children) = walk.children(node) else { return walk.test_leaf(node) };
    for (place, child) in row(walk, children).into_iter().enumerate() {
        if goes(walk, place, child) {
            by(walk, child.1, row, goes);
        }
    }
}

/// A walk that tests the box of each node it comes to.
fn own_box(walk: &mut Walk, node: usize) {
    if walk.enter(node).is_none() {
        return;
    }
    match walk.children(node) {
        None => walk.test_leaf(node),
        Some(children) => children.into_iter().for_each(|child| own_box(walk, child)),
    }
}

fn as_stored(_: &mut Walk, children: [usize; 2]) -> Vec<Child> {
    children.map(|child| (None, child)).into()
}

fn near_first(walk: &mut Walk, children: [usize; 2]) -> Vec<Child> {
    let mut row = children.map(|child| (walk.enter(child), child));
    if row[1].0 < row[0].0 {
        row.reverse();
    }
    row.into()
}

fn both_or_none(walk: &mut Walk, children: [usize; 2]) -> Vec<Child> {
    let row = near_first(walk, children);
    if row.iter().all(|(t, _)| t.is_some()) { row } else { Vec::new() }
}

fn far_first(walk: &mut Walk, children: [usize; 2]) -> Vec<Child> {
    near_first(walk, children).into_iter().rev().collect()
}

/// The nearer of those that the ray meets.
fn near_only(walk: &mut Walk, children: [usize; 2]) -> Vec<Child> {
    near_first(walk, children).into_iter().find(|(t, _)| t.is_some()).into_iter().collect()
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
fn in_row(subject: &Subject, origin: f64, wanted: f64) -> Verdict {
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

fn along_a_row(subject: &Subject) -> Verdict {
    in_row(subject, -1.0, 2.5)
}

fn against_a_row(subject: &Subject) -> Verdict {
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

/// What the walk tests at the least, by a stack in place of the recursion: the nearest child that the ray meets is on
/// top, of equal ones that which is stored first.
fn by_stack(walk: &mut Walk, root: usize) {
    let mut open = vec![(0.0, root)];
    while let Some((enter, node)) = open.pop() {
        if enter > walk.closest() {
            continue;
        }
        let Some([first, second]) = walk.children(node) else {
            walk.test_leaf(node);
            continue;
        };
        let mut met: Vec<(f64, usize)> = [second, first]
            .into_iter()
            .filter_map(|child| Some((walk.enter(child)?, child)))
            .collect();
        met.sort_by(|a, b| b.0.total_cmp(&a.0));
        open.extend(met);
    }
}

/// Compares what a question about a walk gets as an answer from the subject and what is tested at the least.
fn over_the_heap(
    subject: &Subject,
    judge: impl Fn(&Ray, (Option<Hit>, TestCounts), TestCounts) -> Verdict,
) -> Verdict {
    let (scene, rays) = heap();
    let tree = Tree::new(&scene);
    // From inside two boxes both are entered at once, and either may be visited first.
    let from_outside = |ray: &&Ray| (ray.origin - 2.0).abs().max_element() > 3.0;
    rays.iter().filter(from_outside).try_for_each(|ray| {
        let (_, fair) = Walk::new(&scene, &tree, ray).run(by_stack);
        judge(ray, walked(subject, &scene, &tree, ray), fair)
    })
}

fn closest(subject: &Subject) -> Verdict {
    let (scene, rays) = heap();
    let (tree, oracle) = (Tree::new(&scene), LinearScan::new(&scene));
    rays.iter().try_for_each(|ray| {
        let (hit, _) = walked(subject, &scene, &tree, ray);
        let wanted = oracle.closest_hit(ray, Interval::POSITIVE);
        same(|| format!("60 balls; {}: t", ray.shown()), &t_of(hit), &t_of(wanted))
    })
}

fn t_of(hit: Option<Hit>) -> Option<f64> {
    hit.map(|hit| hit.t)
}

fn no_more(what: &str, ray: &Ray, got: u64, fair: u64) -> Verdict {
    ensure(got <= fair, || {
        let case = format!("60 balls; {}: {what}", ray.shown());
        Mismatch::new(case, got.to_string(), format!("no more than {fair}"))
    })
}

fn primitives(subject: &Subject) -> Verdict {
    over_the_heap(subject, |ray, (_, counts), fair| {
        no_more("primitives tested", ray, counts.primitives, fair.primitives)
    })
}

fn box_tests(subject: &Subject) -> Verdict {
    over_the_heap(subject, |ray, (_, counts), fair| {
        no_more("boxes tested", ray, counts.boxes, fair.boxes)
    })
}

/// The side of the picture's left half, and of its right one.
const SIDE: u32 = 160;

/// The ray of a pixel of the picture's left half.
fn ahead(x: f64, y: f64) -> Ray {
    let side = f64::from(SIDE);
    Ray::new(DVec3::new(4.0 * x / side, 4.0 - 4.0 * y / side, -2.0), DVec3::Z)
}

fn from_the_front(subject: &Subject) -> Verdict {
    let (scene, _) = heap();
    let (tree, oracle) = (Tree::new(&scene), LinearScan::new(&scene));
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        let ray = ahead(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let (hit, counts) = walked(subject, &scene, &tree, &ray);
        let (_, fair) = Walk::new(&scene, &tree, &ray).run(by_stack);
        let case = |what: &str| format!("60 balls, pixel {x} of row {y}; {}: {what}", ray.shown());
        let wanted = oracle.closest_hit(&ray, Interval::POSITIVE);
        same(|| case("t"), &t_of(hit), &t_of(wanted))?;
        same(|| case("primitives tested"), &counts.primitives, &fair.primitives)?;
    }
    Ok(())
}

/// Left the distance of the balls, right the number of balls tested, red from 8 on.
fn draw(subject: &Subject) -> Image {
    let (scene, _) = heap();
    let tree = Tree::new(&scene);
    let half = f64::from(SIDE);
    painted(ImageSize::new(2 * SIDE, SIDE), |x, y| {
        let (hit, counts) = walked(subject, &scene, &tree, &ahead(x % half, y));
        if x < half {
            let t = hit.map_or(6.0, |hit| hit.t);
            return Rgb::splat(1.0 - t / 6.5);
        }
        let part = (counts.primitives as f64 / 8.0).min(1.0);
        Rgb::new(part, 0.7 * part * (1.0 - part), 0.5 * (1.0 - part))
    })
}
