//! 4.10: one vector lane, eight, and more threads, on the same rays; and what 32 bits alone would answer.

use std::thread::available_parallelism;

use lancer_accel::Wide;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Hit, Intersector, LinearScan};
use lancer_core::sampling::Uniform;
use lancer_figure::{
    BarChart, Effort, Finished, Plate, Row, Table, category_color, decimals, time_in_turn,
};
use rayon::prelude::*;

use super::is_off;
use crate::aimed::{CLASSES, aimed};
use crate::naive::LibraryWalk;
use crate::rays::{Kind, Rays};
use crate::scenes::family;

const FAMILIES: [&str; 2] = ["scan", "town"];
const LIBRARY: &str = "obvhs' own f32 walk";
/// Rays that are handed over at once.
const BATCH: usize = 256;

/// One way to answer the rays of one scene.
struct Case {
    family: &'static str,
    way: String,
    threads: usize,
    /// Of the primary and of the diffuse rays.
    nanoseconds: [f64; 2],
    /// Of rays aimed at the scene's corners and edges, and elsewhere, as in plate 4.11.
    wrong: u32,
}

type Answer<'a> = Box<dyn Fn(&[Ray]) -> usize + Sync + 'a>;

pub fn make(effort: Effort) -> Finished {
    let (count, size, per_class, runs) = effort
        .pick((1_000, ImageSize::new(24, 24), 20, 1), (100_000, ImageSize::new(512, 512), 300, 5));
    let threads = available_parallelism().map_or(1, usize::from);
    let mut cases = Vec::new();
    for name in FAMILIES {
        cases.extend(cases_of(name, count, size, per_class, threads, runs));
    }
    let aimed = per_class * CLASSES.len() as u32;
    let wrong = |way: &dyn Fn(&Case) -> bool| {
        FAMILIES.map(|name| {
            cases
                .iter()
                .filter(|case| case.family == name && way(case))
                .map(|case| case.wrong)
                .max()
        })
    };
    let library = wrong(&|case| case.way == LIBRARY);
    let ours = wrong(&|case| case.way != LIBRARY);
    let percent = library.map(|wrong| 100.0 * f64::from(wrong.unwrap_or(0)) / f64::from(aimed));
    let holds = ours == [Some(0); 2] && percent.iter().all(|percent| *percent > 1.0);
    let claim = format!(
        "One lane or eight, one thread or all: none of {aimed} aimed rays per scene gets an answer that differs from \
         brute force by a bit. Where 32 bits decide, {} % (scan) and {} % (town) are wrong.",
        decimals(percent[0], 1),
        decimals(percent[1], 1),
    );

    let bars = |name: &'static str| {
        let of = || cases.iter().filter(move |case| case.family == name);
        let speed = |kind: usize| -> Vec<f64> {
            of().map(|case| (1e4 / case.nanoseconds[kind]).round() / 10.0).collect()
        };
        let labels = of().map(|case| {
            let percent = 100.0 * f64::from(case.wrong) / f64::from(aimed);
            format!("{} ({} % wrong)", case.way, decimals(percent, 1))
        });
        BarChart::new("million rays per second", labels)
            .title(name)
            .series("primary", category_color(0), speed(0))
            .series("diffuse", category_color(2), speed(1))
    };
    let mut data = Table::new([
        "family",
        "way",
        "threads",
        "primary_ns_per_ray",
        "diffuse_ns_per_ray",
        "aimed_rays",
        "wrong",
    ]);
    for case in &cases {
        data.push([
            case.family.into(),
            case.way.as_str().into(),
            case.threads.into(),
            case.nanoseconds[0].into(),
            case.nanoseconds[1].into(),
            aimed.into(),
            case.wrong.into(),
        ]);
    }
    let gains = FAMILIES.map(|name| {
        let of: Vec<_> = cases.iter().filter(|case| case.family == name).collect();
        let gain = |from: usize, to: usize| {
            [0, 1].map(|kind| decimals(of[from].nanoseconds[kind] / of[to].nanoseconds[kind], 2))
        };
        let (lanes, together, all) = (gain(1, 2), gain(2, 3), gain(3, 4));
        format!(
            "{name}: vectors {} and {}, together {} and {}, {threads} threads {} and {}",
            lanes[0], lanes[1], together[0], together[1], all[0], all[1]
        )
    });
    let plate = Plate::new("4.10", "What the processor gives", claim, holds)
        .panel(Row::new().panel(1.0, bars(FAMILIES[0])).panel(1.0, bars(FAMILIES[1])))
        .note("Times faster", format!("primary and diffuse rays, each step over the one before; {}", gains.join("; ")))
        .note("Ways", format!(
            "the scalar twin of `wide` computes lane by lane, with what every processor of the kind has; its vectors \
             are AVX2 where the processor has it{}; together: {BATCH} rays handed over at once",
            if Wide::has_vectors() { "" } else { ", and this one has not" }
        ))
        .note("Wrong", format!(
            "of {aimed} rays aimed at corners, along edges, in planes, from the surface and from afar; for 32 bits a t \
             off by a thousandth counts too, for all others one bit. Obvhs' walk is one binary tree, one ray, by its \
             own triangle test"
        ))
        .note("Settings", format!(
            "scenes of {count} triangles, pictures of {size}; medians of {runs} taken in turn. Two threads may share a \
             core: then they gain less than two cores"
        ));
    Finished { plate, data }
}

fn cases_of(
    name: &'static str,
    count: u32,
    size: ImageSize,
    per_class: u32,
    threads: usize,
    runs: usize,
) -> Vec<Case> {
    let scene = family(name).scene(count);
    let (library, scalar, wide) =
        (LibraryWalk::build(&scene), Wide::scalar(&scene), Wide::build(&scene));
    let rays = Rays::of(&scene, size, &wide).map(|rays| {
        (rays.kind, rays.queries.into_iter().map(|query| query.ray).collect::<Vec<Ray>>())
    });
    let ask = |kind: Kind| &rays.iter().find(|(k, _)| *k == kind).expect("all kinds").1;
    let asked = [ask(Kind::Primary), ask(Kind::Diffuse)];

    let alone = |index: &Wide, rays: &[Ray]| {
        rays.iter().filter_map(|ray| index.closest_hit(ray, Interval::POSITIVE)).count()
    };
    let together = |rays: &[Ray]| {
        let mut hits = [None; BATCH];
        let hits = &mut hits[..rays.len()];
        wide.closest_hits(rays, Interval::POSITIVE, hits);
        hits.iter().flatten().count()
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let ways: [(String, usize, Answer); 5] = [
        (
            LIBRARY.to_owned(),
            1,
            Box::new(|rays| rays.iter().filter_map(|ray| library.closest_hit(ray)).count()),
        ),
        ("wide, scalar twin".to_owned(), 1, Box::new(|rays| alone(&scalar, rays))),
        ("wide, vectors".to_owned(), 1, Box::new(|rays| alone(&wide, rays))),
        ("wide, together".to_owned(), 1, Box::new(|rays| rays.chunks(BATCH).map(together).sum())),
        (
            format!("wide, together, {threads} threads"),
            threads,
            Box::new(|rays| pool.install(|| rays.par_chunks(BATCH).map(together).sum())),
        ),
    ];
    let seconds = asked.map(|rays| time_in_turn(runs, ways.iter().map(|(_, _, way)| || way(rays))));

    let oracle = LinearScan::new(&scene);
    let center = scene.bounds().center();
    let mut aims = Vec::new();
    for (k, class) in CLASSES.into_iter().enumerate() {
        aims.extend((0..per_class).map(|ray| {
            let mut random = Uniform::new(13, ray, k as u32);
            aimed(class, &scene.mesh, center, &mut || random.number())
        }));
    }
    let truths: Vec<Option<Hit>> =
        aims.par_iter().map(|ray| oracle.closest_hit(ray, Interval::POSITIVE)).collect();
    let mut answers = vec![None; aims.len()];
    wide.closest_hits(&aims, Interval::POSITIVE, &mut answers);
    let of = |index: &Wide| -> usize {
        let answer = |ray| index.closest_hit(ray, Interval::POSITIVE);
        aims.iter().zip(&truths).filter(|(ray, truth)| answer(ray) != **truth).count()
    };
    let off =
        aims.iter().zip(&truths).filter(|(ray, truth)| is_off(library.closest_hit(ray), **truth));
    let differ = answers.iter().zip(&truths).filter(|(answer, truth)| answer != truth).count();
    let wrong = [off.count(), of(&scalar), of(&wide), differ, differ];

    let hits = |way: usize| [seconds[0][way].1, seconds[1][way].1];
    ways.iter()
        .enumerate()
        .map(|(k, (way, threads, _))| {
            assert!(k == 0 || hits(k) == hits(1), "{name}: {way} differs");
            let nanoseconds =
                [0, 1].map(|kind: usize| 1e9 * seconds[kind][k].0.mid / asked[kind].len() as f64);
            let wrong = wrong[k] as u32;
            Case { family: name, way: way.clone(), threads: *threads, nanoseconds, wrong }
        })
        .collect()
}
