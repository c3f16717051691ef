//! 4.11: every index against brute force, and what indexes lose as they are often written.

use glam::{DAffine3, DQuat, DVec3};
use lancer_accel::Grid;
use lancer_accel::structures::{STRUCTURES, structure};
use lancer_core::generate::{cube, icosphere};
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Hit, Intersector, LinearScan, Query};
use lancer_core::sampling::Uniform;
use lancer_core::scene::{Mesh, Scene};
use lancer_figure::{
    BarChart, Effort, Finished, Plate, Row, Table, Value, category_color, method_color,
    time_in_turn,
};

use super::is_off;
use crate::aimed::{CLASSES, aimed};
use crate::naive::{BareTree, LibraryWalk, first_hit_wins};
use crate::rays::{Kind, Rays};
use crate::scenes::family;

const NAIVE: [&str; 3] = ["boxes without a pad", "first hit in a cell wins", "obvhs' own f32 walk"];

/// Answers of one contender to the rays of one class.
struct Case {
    contender: &'static str,
    naive: Option<usize>,
    class: &'static str,
    rays: u32,
    wrong: u32,
}

/// A wrong answer of a contender that decides in `f64`: not the oracle's, bit for bit.
fn differs(answer: Option<Hit>, truth: Option<Hit>) -> bool {
    answer.map(|hit| (hit.t.to_bits(), hit.primitive))
        != truth.map(|hit| (hit.t.to_bits(), hit.primitive))
}

pub fn make(effort: Effort) -> Finished {
    let per_class = effort.pick(60, 1_500);
    let mut cases: Vec<Case> = Vec::new();
    for (scene, center) in scenes() {
        for (k, class) in CLASSES.into_iter().enumerate() {
            let rays: Vec<Ray> = (0..per_class)
                .map(|ray| {
                    let mut random = Uniform::new(7, ray, k as u32);
                    aimed(class, &scene.mesh, center, &mut || random.number())
                })
                .collect();
            count(&scene, class, &rays, &mut cases);
        }
    }
    let ours: u32 = cases.iter().filter(|case| case.naive.is_none()).map(|case| case.wrong).sum();
    let asked: u32 = cases.iter().filter(|case| case.naive.is_none()).map(|case| case.rays).sum();
    let wrong_of = |naive: usize, class: Option<&str>| {
        let of = cases.iter().filter(|case| {
            case.naive == Some(naive) && class.is_none_or(|class| case.class == class)
        });
        let (wrong, rays) =
            of.fold((0, 0), |(wrong, rays), case| (wrong + case.wrong, rays + case.rays));
        100.0 * f64::from(wrong) / f64::from(rays)
    };
    let lost = [0, 1, 2].map(|naive| wrong_of(naive, None));
    let holds = ours == 0 && lost.iter().all(|percent| *percent > 0.5);
    let claim = format!(
        "On aimed rays the {} indexes of the course give {ours} wrong answers of {asked}; of the same rays \
         boxes without a pad get {:.1} % wrong, a grid that ends at its first hit {:.1} %, and obvhs' own walk \
         in 32 bits {:.1} %.",
        STRUCTURES.len() - 1,
        lost[0],
        lost[1],
        lost[2],
    );

    let mut bars = BarChart::new("wrong answers (%)", CLASSES)
        .title("What they get wrong, by where the rays are aimed");
    for (naive, name) in NAIVE.into_iter().enumerate() {
        let values = CLASSES.map(|class| (10.0 * wrong_of(naive, Some(class))).round() / 10.0);
        bars = bars.series(name, color(naive), values);
    }
    let (speed, sentence) = speed(effort);
    let mut data = Table::new(["contender", "class", "rays", "wrong"]);
    for case in &cases {
        let row: [Value; 4] =
            [case.contender.into(), case.class.into(), case.rays.into(), case.wrong.into()];
        data.push(row);
    }
    let plate = Plate::new("4.11", "The same answer from all", claim, holds)
        .panel(Row::new().panel(1.2, bars).panel(0.8, speed))
        .note("Speed and error", sentence)
        .note("Wrong", "for what decides in 64 bits: another primitive or another t than brute force, by one bit. For 32 bits: nothing \
             where there is something, or the reverse, or a t off by a thousandth")
        .note("Rays", format!(
            "{per_class} per class and scene, written once and given to all: an icosphere of {} triangles at the origin and around \
             (148376, 1234, −223423), where 32 bits are coarse, and 27 touching cubes, whose inner faces are double",
            icosphere(3).triangles.len()
        ))
        .note("Obvhs", "its tree is as good as ours and is one of the eight; what is counted here is its own \
             traversal and triangle test, made for speed and not for closed surfaces: from the surface it meets the \
             surface again, unless its user skips a little of each ray")
        .note("Reference", "brute force over all primitives by the same watertight test (plate 0.3)");
    Finished { plate, data }
}

fn color(naive: usize) -> lancer_figure::Color {
    [category_color(3), method_color("grid"), method_color("obvhs-bvh2")][naive]
}

fn scenes() -> [(Scene, DVec3); 3] {
    let moved = |mesh: &Mesh, by: DVec3| {
        let mut result = Mesh::default();
        result.append(mesh, DAffine3::from_translation(by), 0);
        result
    };
    let far = DVec3::new(148376.0, 1234.0, -223423.0);
    let mut cubes = Mesh::default();
    for k in 0..27 {
        let place = DVec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9));
        let transform = DAffine3::from_scale_rotation_translation(
            DVec3::splat(0.25),
            DQuat::IDENTITY,
            0.5 * (place - 1.0),
        );
        cubes.append(&cube(), transform, 0);
    }
    [
        (Scene::of_mesh(icosphere(3)), DVec3::ZERO),
        (Scene::of_mesh(moved(&icosphere(3), far)), far),
        (Scene::of_mesh(cubes), DVec3::ZERO),
    ]
}

fn count(scene: &Scene, class: &'static str, rays: &[Ray], cases: &mut Vec<Case>) {
    let oracle = LinearScan::new(scene);
    let truths: Vec<Option<Hit>> =
        rays.iter().map(|ray| oracle.closest_hit(ray, Interval::POSITIVE)).collect();
    let mut add = |contender, naive, is_wrong: &dyn Fn(&Ray, Option<Hit>) -> bool| {
        let wrong = rays.iter().zip(&truths).filter(|(ray, truth)| is_wrong(ray, **truth)).count();
        let (rays, wrong) = (rays.len() as u32, wrong as u32);
        cases.push(Case { contender, naive, class, rays, wrong });
    };
    for structure in STRUCTURES.into_iter().filter(|structure| structure.name != "linear") {
        let built = structure.build(scene);
        add(structure.name, None, &|ray, truth| {
            differs(built.index.closest_hit(ray, Interval::POSITIVE), truth)
                || built.index.occluded(ray, Interval::POSITIVE) != truth.is_some()
        });
    }
    let (bare, grid, library) =
        (BareTree::build(scene), Grid::build(scene), LibraryWalk::build(scene));
    add(NAIVE[0], Some(0), &|ray, truth| differs(bare.closest_hit(ray), truth));
    add(NAIVE[1], Some(1), &|ray, truth| differs(first_hit_wins(scene, &grid, ray), truth));
    add(NAIVE[2], Some(2), &|ray, truth| is_off(library.closest_hit(ray), truth));
}

/// Seconds of the library's own walk beside ours on ordinary rays, with what its speed costs.
fn speed(effort: Effort) -> (BarChart, String) {
    let (count, size, runs) =
        effort.pick((1_000, ImageSize::new(16, 16), 1), (100_000, ImageSize::new(192, 192), 5));
    let scene = family("scan").scene(count);
    let library = LibraryWalk::build(&scene);
    let names = ["obvhs-bvh2", "bvh", "wide"];
    let built = names.map(|name| structure(name).build(&scene));
    let rays = Rays::of(&scene, size, &*built[0].index);
    let asked: usize = rays.iter().map(|rays| rays.queries.len()).sum();
    let off: usize = rays
        .iter()
        .filter(|rays| rays.kind == Kind::Primary)
        .flat_map(|rays| &rays.queries)
        .filter(|query| {
            let truth = built[0].index.closest_hit(&query.ray, query.range);
            is_off(library.closest_hit(&query.ray), truth)
        })
        .count();
    let all = || rays.iter().flat_map(|rays| &rays.queries);
    let mut contenders: Vec<Box<dyn Fn() -> usize + '_>> =
        vec![Box::new(|| all().filter(|query| library.closest_hit(&query.ray).is_some()).count())];
    for built in &built {
        contenders.push(Box::new(|| {
            let hit = |query: &&Query<Ray>| {
                built.index.closest_hit(&query.ray, Interval::POSITIVE).is_some()
            };
            all().filter(hit).count()
        }));
    }
    let timed = time_in_turn(runs, contenders);
    let labels = [NAIVE[2], names[0], names[1], names[2]];
    let nanoseconds: Vec<f64> =
        timed.iter().map(|(seconds, _)| (1e9 * seconds.mid / asked as f64).round()).collect();
    let sentence = format!(
        "closest hits of primary, shadow and diffuse rays of a scan of {} triangles, one thread, medians of {runs}. Of \
         the {} primary rays the walk in 32 bits gets {off} wrong, the others none",
        scene.mesh.triangles.len(),
        rays.iter().find(|rays| rays.kind == Kind::Primary).map_or(0, |rays| rays.queries.len()),
    );
    let chart = BarChart::new("nanoseconds per ray", labels).title("What the answers cost").series(
        "closest hit",
        category_color(0),
        nanoseconds,
    );
    (chart, sentence)
}
