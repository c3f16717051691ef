//! One ray's walk through the indexes: `cargo xtask step accel`.
//!
//! The indexes themselves are asked, followed by a [`Recorder`]; it decides each test once more, by the same
//! functions, to tell how it ends.

mod draw;
pub mod record;

use glam::DVec2;
use lancer_accel::Bvh;
use lancer_core::geometry::{Bounds3, Interval, Ray};
use lancer_core::intersector::{Hit, Intersector, LinearScan, Query, TestCounts};
use lancer_core::method::Setting;
use lancer_core::scene::{PrimitiveId, Scene, Shape};
use lancer_core::world::World;
use lancer_exercise::Shown;
use lancer_figure::{Backdrop, INK, MUTED, Step, Tree, Walk, category_color, method_color};
use lancer_lesson::chapter::{WalkOrder, Walkthrough};
use lancer_lesson::picture::marked_picture;
use lancer_lesson::view::{View, printable};
use lancer_whitted::{Settings, Whitted};

use lancer_accel::structures::{STRUCTURES, Structure, structure};
use record::{Event, Kind, Recorder};

/// The most boxes and cells of an index that stay in the drawing: more cannot be told apart.
const MOST_DRAWN: u64 = 300;
/// The most primitives that are named in one line.
const MOST_NAMED: usize = 12;

/// A ray's way through the indexes, step by step.
pub const WALK: Walkthrough = Walkthrough {
    name: "accel",
    about: "is the search for what the pixel's ray meets, through one index after the other: each box and cell on \
            its way, each primitive that is tested, and a table of what all of them did",
    uses: &[Setting::Index],
    walk: |order| Ok(walk(order)),
};

/// What an index answered, and its work.
struct Answer {
    name: &'static str,
    hit: Option<Hit>,
    counts: TestCounts,
    bytes: usize,
}

/// Walks with a pixel's ray through the index of the order, or through all.
///
/// # Panics
/// If the order names an index that there is not.
pub fn walk(order: &WalkOrder<'_>) -> Walk {
    let WalkOrder { loaded, size, pixel: [x, y], .. } = *order;
    let one = order.index.map(structure);
    let structures = one.as_ref().map_or(&STRUCTURES[..], std::slice::from_ref);
    let scene = &loaded.scene;
    let film = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
    let ray = scene.camera.primary_rays(size).through(film.x, film.y);
    let expected = LinearScan::new(scene).closest_hit(&ray, Interval::POSITIVE);

    let index = Bvh::build(scene);
    let whitted = Whitted::new(World { scene, index: &index }, Settings::default());
    let view = draw::view(scene, &ray, expected);

    let mut walker = Walker { scene, ray, view, expected, steps: Vec::new() };
    walker.begin();
    let answers: Vec<Answer> = structures
        .iter()
        .zip(1..)
        .map(|(structure, call)| walker.search(structure, call))
        .collect();
    walker.compare(&answers);

    let names: Vec<String> = loaded.material_names.iter().map(|name| printable(name)).collect();
    let outlines = view.outlines(scene, &names);
    let line = draw::ray(view, scene, &ray, expected);
    let through = match structures {
        [only] => only.name.to_owned(),
        _ => format!("{} indexes", structures.len()),
    };
    let counts = scene.counts();
    Walk {
        title: format!(
            "The ray of pixel ({x}, {y}) of {} through {through}",
            printable(order.name)
        ),
        subtitle: format!(
            "{size} pixels; {} triangles, {} spheres",
            counts.triangles, counts.spheres
        ),
        backdrop: Backdrop {
            name: view.side.name().to_owned(),
            low: view.low,
            high: view.high,
            draw: Box::new(move |pen| {
                outlines(pen);
                line(pen);
            }),
        },
        legend: vec![
            ("box met, cell visited", draw::met(), false),
            ("box missed", MUTED, true),
            ("primitive met", draw::hit(), false),
            ("primitive missed", MUTED, false),
        ],
        picture: marked_picture(scene, size, order.pixel, |ray| whitted.trace(ray, &mut ())),
        calls: answers.iter().fold(Tree::new("ray", INK), |tree, answer| {
            let edge = format!("{} tested", answer.counts.primitives);
            tree.child(edge, Tree::new(answer.name, method_color(answer.name)))
        }),
        steps: walker.steps,
    }
}

/// Turns searches into steps.
struct Walker<'a> {
    scene: &'a Scene,
    ray: Ray,
    view: View,
    /// The answer of brute force.
    expected: Option<Hit>,
    steps: Vec<Step>,
}

impl Walker<'_> {
    fn begin(&mut self) {
        let Ray { origin, direction } = self.ray;
        let step = Step::new(0, 0, "the ray begins")
            .line(format!("origin    {}, the eye", origin.shown()))
            .line(format!("direction {}, unit, through the pixel's centre", direction.shown()))
            .line(format!("scene     {}", extent(self.scene.bounds())));
        self.steps.push(step.opens());
    }

    /// The steps through one index, as the `call`-th call.
    fn search(&mut self, structure: &Structure, call: usize) -> Answer {
        let (scene, ray, name) = (self.scene, self.ray, structure.name);
        let built = structure.build(scene);
        let step = |happens: &str| Step::new(call, 1, format!("{name} {happens}"));
        let begins = step(&format!("begins, {} bytes beside the scene", built.bytes));
        self.steps.push(begins.opens().clears());
        let mut recorder = Recorder::new(scene, &ray, Interval::POSITIVE);
        let hit = built.index.watch(Query::closest(&ray, Interval::POSITIVE), &mut recorder);
        let Recorder { events, counts, .. } = recorder;
        for Event { kind, best } in &events {
            let step = self.event(kind, *best, &step);
            self.steps.push(step.line(format!("closest so far  {}", self.named_hit(*best))));
        }
        let same = if hit == self.expected { category_color(2) } else { category_color(3) };
        let ends = step(&format!("ends: {}", self.reason(hit, counts)))
            .line(format!("answer  {}", self.named_hit(hit)))
            .line(format!(
                "work    boxes {}, cells {}, primitives {}",
                counts.boxes, counts.cells, counts.primitives
            ));
        self.steps.push(ends.returns(same));
        Answer { name, hit, counts, bytes: built.bytes }
    }

    fn event(&self, kind: &Kind, best: Option<Hit>, step: &dyn Fn(&str) -> Step) -> Step {
        let (view, scene) = (self.view, self.scene);
        let visit = |step: Step, bounds, number| {
            let step = step.line(extent(bounds));
            let step = step.points_out(draw::pointed_out(view, bounds, number));
            if number > MOST_DRAWN { step } else { step.draws(draw::visited(view, bounds)) }
        };
        match *kind {
            Kind::BoxMet { number, bounds, inside } => {
                let met = format!("meets box {number}, {}", piece(inside));
                visit(step(&met), bounds, number)
            }
            Kind::BoxesMissed { first, ref boxes, behind, empty } => {
                let which = match boxes.len() {
                    1 => format!("misses box {first}"),
                    count => format!("misses boxes {first} to {}", first + count as u64 - 1),
                };
                let beside = boxes.len() - behind - empty;
                let reasons = [
                    (beside, "beside the ray"),
                    (behind, "behind the closest hit"),
                    (empty, "without anything in it"),
                ];
                let reasons = reasons.iter().filter(|(count, _)| *count > 0);
                let reasons: Vec<String> =
                    reasons.map(|(count, reason)| format!("{count} {reason}")).collect();
                step(&which).line(reasons.join(", ")).points_out(draw::missed(view, boxes))
            }
            Kind::Cell { number, bounds, inside } => {
                let inside = inside.map_or("which the ray just touches".to_owned(), piece);
                visit(step(&format!("visits cell {number}, {inside}")), bounds, number)
            }
            Kind::PrimitiveMet { primitive, t, wins } => {
                let place = match best {
                    _ if wins => "the closest so far",
                    Some(best) if best.primitive == primitive => "as before",
                    _ => "not before the closest",
                };
                let tested = self.named(primitive);
                step(&format!("tests {tested}: met at t = {}, {place}", t.shown()))
                    .draws(draw::primitives(view, scene, &[primitive], draw::hit()))
            }
            Kind::PrimitivesMissed(ref missed) => {
                let step = match missed[..] {
                    [only] => step(&format!("tests {}: missed", self.named(only))),
                    _ => step(&format!("tests {}: all missed", self.counted(missed)))
                        .line(format!("primitives {}", listed(missed))),
                };
                step.points_out(draw::primitives(view, scene, missed, MUTED))
            }
        }
    }

    /// Why a search ends.
    fn reason(&self, hit: Option<Hit>, counts: TestCounts) -> String {
        if self.scene.primitives().len() == 0 {
            return "there is nothing in the scene".to_owned();
        }
        let left = match counts {
            TestCounts { boxes: 0, cells: 0, primitives: 0 } => {
                return "the ray misses the box around the scene".to_owned();
            }
            TestCounts { boxes: 0, cells: 0, .. } => return "every primitive is tested".to_owned(),
            TestCounts { cells: 0, .. } => "box",
            _ => "cell",
        };
        match hit {
            Some(hit) => format!("no {left} is left that begins before t = {}", hit.t.shown()),
            None => format!("no {left} is left on the ray's way"),
        }
    }

    /// The table of what all did.
    fn compare(&mut self, answers: &[Answer]) {
        let linear = Answer {
            name: "linear",
            hit: self.expected,
            counts: TestCounts {
                primitives: self.scene.primitives().len() as u64,
                ..TestCounts::default()
            },
            bytes: 0,
        };
        let differ: Vec<&str> = answers
            .iter()
            .filter(|answer| answer.hit != self.expected)
            .map(|answer| answer.name)
            .collect();
        let headline = match (differ.is_empty(), self.expected) {
            (true, Some(_)) => {
                "the ray ends: the same hit from all, the same t to the last bit".into()
            }
            (true, None) => "the ray ends: it meets nothing, as all agree".into(),
            (false, _) => format!("the ray ends: NOT the hit of linear from {}", differ.join(", ")),
        };
        let row = |cells: [String; 6]| {
            let [name, boxes, cells, primitives, bytes, hit] = cells;
            format!("{name:<12}{boxes:>8}{cells:>8}{primitives:>12}{bytes:>12}   {hit}")
        };
        let titles = ["index", "boxes", "cells", "primitives", "bytes", "hit"].map(str::to_owned);
        let oracle = answers.iter().all(|answer| answer.name != "linear").then_some(&linear);
        let rows = oracle.into_iter().chain(answers).map(|answer| {
            let Answer { name, hit, counts, bytes } = answer;
            row([
                (*name).to_owned(),
                counts.boxes.to_string(),
                counts.cells.to_string(),
                counts.primitives.to_string(),
                bytes.to_string(),
                // With all digits of t.
                hit.map_or("nothing".to_owned(), |hit| {
                    format!("{} at t = {}", self.named(hit.primitive), hit.t)
                }),
            ])
        });
        let step = Step::new(0, 0, headline).row(row(titles));
        let met = self.expected.map(|hit| hit.primitive);
        let drawn = draw::primitives(self.view, self.scene, met.as_slice(), draw::hit());
        self.steps.push(rows.fold(step, Step::row).clears().draws(drawn));
    }

    /// What a primitive is called.
    fn named(&self, primitive: PrimitiveId) -> String {
        match self.scene.shape(primitive) {
            Shape::Triangle(index) => format!("triangle {index}"),
            Shape::Sphere(index) => format!("sphere {index}"),
        }
    }

    /// How many there are of what.
    fn counted(&self, primitives: &[PrimitiveId]) -> String {
        let is_sphere = |&&p: &&PrimitiveId| matches!(self.scene.shape(p), Shape::Sphere(_));
        let spheres = primitives.iter().filter(is_sphere).count();
        let what = match spheres {
            0 => "triangles",
            all if all == primitives.len() => "spheres",
            _ => "primitives",
        };
        format!("{} {what}", primitives.len())
    }

    fn named_hit(&self, hit: Option<Hit>) -> String {
        hit.map_or("nothing".to_owned(), |hit| {
            format!("{} at t = {}", self.named(hit.primitive), hit.t.shown())
        })
    }
}

/// From where to where a box is.
fn extent(bounds: Bounds3) -> String {
    let Bounds3 { min, max } = bounds;
    if bounds.is_empty() {
        return "empty".to_owned();
    }
    format!("from {} to {}", min.shown(), max.shown())
}

/// A piece of the ray.
fn piece(Interval { min, max }: Interval) -> String {
    format!("from t = {} to {}", min.shown(), max.shown())
}

/// The numbers of primitives, runs of them as their ends; of many only the first.
fn listed(primitives: &[PrimitiveId]) -> String {
    let mut runs: Vec<[u32; 2]> = Vec::new();
    for &PrimitiveId(number) in primitives {
        match runs.last_mut() {
            Some([_, last]) if *last + 1 == number => *last = number,
            _ => runs.push([number; 2]),
        }
    }
    let run = |&[first, last]: &[u32; 2]| match last - first {
        0 => first.to_string(),
        _ => format!("{first} to {last}"),
    };
    let mut list: Vec<String> = runs.iter().take(MOST_NAMED).map(run).collect();
    if runs.len() > MOST_NAMED {
        list.push("…".to_owned());
    }
    list.join(", ")
}
