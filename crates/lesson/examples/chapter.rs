//! A whole chapter, as small as can be: a method, a scene, a figure and an exercise. Copy it into
//! `chapters/N-name/src/`, one file each, with a `Cargo.toml` like the other chapters', and add it to
//! `Cargo.toml`, `xtask/Cargo.toml` and `CHAPTERS` in `xtask/src/chapters.rs`.
//!
//! `cargo run -p lancer-lesson --example chapter` makes the figure and proves the exercise.

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::image::{Image, ImageSize};
use lancer_core::intersector::LinearScan;
use lancer_core::method::{Effect, Method, Order, Setting, Work, WorkKind};
use lancer_core::render::PrimaryHits;
use lancer_core::world::World;
use lancer_exercise::{Card, Check, Course, Exercise, Shown, Solution, Verdict, slips, within};
use lancer_figure::{Effort, Figure, Finished, Montage, Plate, Table, Tile, category_color};
use lancer_lesson::picture::{painted, shown};
use lancer_lesson::scenes::{NamedScene, parsed};
use lancer_lesson::{Chapter, judge};

static CHAPTER: Chapter = Chapter {
    number: "9",
    folder: "9-facing",
    title: "Éclairage frontal",
    figures: &[Figure { id: "9.1", name: "facing", make }],
    course: &COURSE,
    scenes: &[NamedScene::written("ball", BALL)],
    methods: &[FACING],
    walks: &[],
};

// A scene, usually a file in `scenes/`.

const BALL: &str = "
    camera = { eye = [0, 0, 4], look_at = [0, 0, 0], fov = 40 }
    ambient = 1
    material.chalk = { rho_d = 1 }
    sphere = [{ center = [0, 0, 0], radius = 1, material = 'chalk' }]";

// A method, usually in a crate of its own, such as `crates/whitted`.

/// What faces the eye is bright.
///
/// - *Follows* primary rays.
/// - *Wins* where no light is known.
/// - *Loses* all that light does.
/// - *Sources*: none, this is an example.
const FACING: Method = Method {
    name: "facing",
    about: "as if lit from the eye",
    uses: &[Setting::Sampling, Setting::Adaptive],
    ignores: &[Effect::Mirrors, Effect::Glass, Effect::AreaLights],
    by_products: &[],
    render: |order| {
        let index = (order.index)(order.scene.into());
        let world = World { scene: order.scene, index: &*index };
        order.sample(PrimaryHits::new(world, order.size, |ray, hit, _, counts: &mut Rays| {
            counts.0 += 1;
            let Some(hit) = hit else { return order.scene.background };
            let surface = order.scene.surface_at(ray, &hit);
            Rgb::splat(facing(surface.shading_normal, -ray.direction))
        }))
    },
};

/// |N·V|, with both unit vectors on any side.
fn facing(n: DVec3, to_eye: DVec3) -> f64 {
    n.dot(to_eye).abs()
}

#[derive(Default)]
struct Rays(u64);

impl std::ops::AddAssign for Rays {
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

impl From<Rays> for Work {
    fn from(rays: Rays) -> Self {
        Self { counts: vec![(WorkKind::Rays, "primary", rays.0)] }
    }
}

// A figure, a file in `src/figures/`.

fn make(effort: Effort) -> Finished {
    let scene = parsed("ball", BALL);
    let size = effort.pick(ImageSize::new(32, 32), ImageSize::new(320, 320));
    let order = Order::new(&scene, &|primitives| Box::new(LinearScan::new(primitives)), size);
    let outcome = (FACING.render)(&order).expect("nobody cancels a figure");
    let mean = judge::mean(&outcome.image);
    let rays = outcome.work.total(WorkKind::Rays);
    let claim = format!("A ray per pixel shows a ball of mean radiance {mean:.3}.");
    let plate = Plate::new("9.1", "Facing the eye", claim, rays == size.pixels() as u64)
        .panel(
            Montage::new()
                .tile(Tile::new("facing", shown(&outcome.image)).color(category_color(0))),
        )
        .note("Settings", format!("{size}, 1 sample per pixel"));
    let mut data = Table::new(["rays", "mean"]);
    data.push([rays.into(), mean.into()]);
    Finished { plate, data }
}

// An exercise, a file in `src/exercises/`, with its stub in `stubs/` and its answer in `solutions/`.

#[derive(Clone, Copy)]
struct Subject {
    facing: fn(DVec3, DVec3) -> f64,
}

static COURSE: Course<Subject> =
    Course { package: "chapter-9", exercises: &[EXERCISE], reference: Subject { facing } };

const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E9.1",
        name: "facing",
        title: "How much a surface faces the eye",
        slide: "none",
        stub: "pub fn facing(n: DVec3, to_eye: DVec3) -> f64 {\n    todo!(\"E9.1\")\n}\n",
        functions: &["facing"],
        minutes: 5,
        predict: "where is the ball brightest?",
        vary: "square the answer: what happens to the rim?",
        hints: ["a cosine", "|N·V|", "`n.dot(to_eye)`, without its sign"],
        solution: Solution {
            answer: "pub fn facing(n: DVec3, to_eye: DVec3) -> f64 {\n    n.dot(to_eye).abs()\n}\n",
            file: "crates/lesson/examples/chapter.rs",
            item: "fn facing",
            notice: "either side",
        },
    },
    checks: &[Check { name: "at a slant from behind", run: slanted }],
    slips: slips! {
        facing(n, to_eye):
        "the sign is kept: a surface seen from behind is dark":
            "at a slant from behind" catches n.dot(to_eye);
        "the sine is taken: it is 0 where the surface faces the eye":
            "at a slant from behind" catches n.cross(to_eye).length();
        "the cosine is squared":
            "at a slant from behind" catches n.dot(to_eye).powi(2);
    },
    own: |yours, _| Subject { facing: yours.facing },
    draw,
    explain: None,
};

/// N = −y and V = (0.6, 0.8, 0): 0.8.
fn slanted(subject: &Subject) -> Verdict {
    let (n, to_eye) = (DVec3::NEG_Y, DVec3::new(0.6, 0.8, 0.0));
    let case = || format!("N {}, V (to the eye) {}", n.shown(), to_eye.shown());
    within(1e-12, case, &(subject.facing)(n, to_eye), &0.8)
}

fn draw(subject: &Subject) -> Image {
    let n = |x: f64, y: f64| DVec3::new(x / 32.0 - 1.0, y / 32.0 - 1.0, 0.5).normalize();
    painted(ImageSize::new(64, 64), |x, y| Rgb::splat((subject.facing)(n(x, y), DVec3::Z)))
}

fn main() {
    for figure in CHAPTER.figures {
        let finished = Figure::proved(CHAPTER.figures, figure.id);
        println!("{} {}: {}", figure.id, figure.name, finished.plate.claim());
    }
    for verified in CHAPTER.course.verify() {
        assert!(verified.holds(), "{verified:?}");
        println!("{} {}: proved", verified.id, verified.name);
    }
}

#[test]
fn the_chapter_proves_itself() {
    main();
}
