//! 4.9: how much neighbouring rays have in common, and what it gains to answer them together.

use std::collections::HashSet;

use lancer_accel::Wide;
use lancer_core::geometry::{Bounds3, Interval, Ray};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Hit, Intersector, Observer, Query, Wanted};
use lancer_figure::{
    Axis, Chart, Effort, Finished, Plate, Row, Series, Table, Value, category_color, decimals,
    time_in_turn,
};

use crate::rays::{Kind, Rays};
use crate::scenes::family;

const FAMILIES: [&str; 2] = ["scan", "town"];
/// Rays that are looked at together.
const GROUPS: [usize; 5] = [1, 4, 16, 64, 256];
/// Rays that are handed over at once, as the render loop does.
const BATCH: usize = 256;
const ALONE: &str = "one by one";
const TOGETHER: &str = "together";

/// The boxes of one kind of rays, in groups of one size.
struct Case {
    family: &'static str,
    kind: Kind,
    group: usize,
    /// Boxes that at least one ray of a group asks, for each ray.
    boxes: f64,
}

/// Nanoseconds a ray, of one kind in one scene.
struct Timed {
    family: &'static str,
    kind: Kind,
    triangles: usize,
    alone: f64,
    together: f64,
}

pub fn make(effort: Effort) -> Finished {
    let counts: &[u32] = effort.pick(&[100, 10_000], &[100, 1_000, 10_000, 100_000]);
    let (size, runs) = effort.pick((ImageSize::new(64, 64), 1), (ImageSize::new(512, 512), 5));
    let (mut cases, mut timed) = (Vec::new(), Vec::new());
    let (mut asked, mut same) = (0, true);
    for name in FAMILIES {
        for (k, &count) in counts.iter().enumerate() {
            let scene = family(name).scene(count);
            let triangles = scene.mesh.triangles.len();
            let index = Wide::build(&scene);
            for rays in Rays::of(&scene, size, &index) {
                if k + 1 == counts.len() {
                    cases.extend(GROUPS.map(|group| Case {
                        family: name,
                        kind: rays.kind,
                        group,
                        boxes: boxes_per_ray(&index, &rays, group),
                    }));
                }
                if rays.kind.wanted() == Wanted::Closest {
                    asked += rays.queries.len();
                    same &= answers_agree(&index, &rays);
                    let [alone, together] = nanoseconds(&index, &rays, runs);
                    timed.push(Timed { family: name, kind: rays.kind, triangles, alone, together });
                }
            }
        }
    }
    let boxes = |family: &str, kind: Kind, group: usize| {
        let is_it =
            |case: &&Case| case.family == family && case.kind == kind && case.group == group;
        cases.iter().find(is_it).expect("all cases").boxes
    };
    // Of 64 rays that ask alike each box would be asked by 64.
    let shared = |kind| FAMILIES.map(|name| boxes(name, kind, 1) / boxes(name, kind, 64));
    let [primary, shadow, diffuse] = Kind::ALL.map(shared);
    let holds = same && (0..2).all(|k| primary[k] > 1.5 * diffuse[k] && shadow[k] > diffuse[k]);
    let claim = format!(
        "A box that one of 64 neighbouring primary rays asks is asked by {} (scan) and {} (town) of them, of shadow \
         rays by {} and {}, of diffuse rays by {} and {} only; and together they get the same answers.",
        decimals(primary[0], 1),
        decimals(primary[1], 1),
        decimals(shadow[0], 1),
        decimals(shadow[1], 1),
        decimals(diffuse[0], 1),
        decimals(diffuse[1], 1),
    );

    let shares = |name: &str| {
        let mut chart =
            Chart::new(Axis::log("rays looked at together"), Axis::log("boxes per ray"))
                .title(format!("{name}: boxes they share"));
        for (k, kind) in Kind::ALL.into_iter().enumerate() {
            let points = GROUPS.map(|group| (group as f64, boxes(name, kind, group)));
            chart = chart.series(Series::new(kind.name(), category_color(k)).points(points));
        }
        chart.slope(-1.0, "all shared")
    };
    let times = |name: &'static str| {
        let mut chart = Chart::new(Axis::log("triangles, n"), Axis::log("nanoseconds per ray"))
            .title(format!("{name}: time (one thread)"));
        for (k, kind) in
            Kind::ALL.into_iter().enumerate().filter(|(_, kind)| kind.wanted() == Wanted::Closest)
        {
            for (label, value) in [
                (ALONE, (|case| case.alone) as fn(&Timed) -> f64),
                (TOGETHER, |case| case.together),
            ] {
                let of = timed.iter().filter(|case| case.family == name && case.kind == kind);
                let points = of.map(|case| (case.triangles as f64, value(case)));
                let series = Series::new(format!("{}, {label}", kind.name()), category_color(k));
                let series = series.points(points);
                chart = chart.series(if label == ALONE { series.dashed() } else { series });
            }
        }
        chart
    };
    let mut data = Table::new([
        "family",
        "kind",
        "group",
        "boxes_per_ray",
        "triangles",
        "alone_ns",
        "together_ns",
    ]);
    for Case { family, kind, group, boxes } in &cases {
        let empty = || Value::from("");
        let [family, kind] = [(*family).into(), kind.name().into()];
        data.push([family, kind, (*group).into(), (*boxes).into(), empty(), empty(), empty()]);
    }
    for Timed { family, kind, triangles, alone, together } in &timed {
        let [family, kind] = [(*family).into(), kind.name().into()];
        let times = [(*triangles).into(), (*alone).into(), (*together).into()];
        let [triangles, alone, together] = times;
        data.push([family, kind, "".into(), "".into(), triangles, alone, together]);
    }
    let gains = timed.iter().filter(|case| case.kind == Kind::Primary).map(|case| {
        let gain = decimals(case.alone / case.together, 2);
        format!("{} of {} triangles {gain}", case.family, case.triangles)
    });
    let plate = Plate::new("4.9", "What neighbouring rays have in common", claim, holds)
        .panel(Row::new().panel(1.0, shares(FAMILIES[0])).panel(1.0, shares(FAMILIES[1])))
        .panel(Row::new().panel(1.0, times(FAMILIES[0])).panel(1.0, times(FAMILIES[1])))
        .note("Times faster", format!("primary rays together: {}", gains.collect::<Vec<_>>().join(", ")))
        .note("Together", format!(
            "{BATCH} rays are handed to `wide` at once. Those of one origin that go about the same way are walked 64 \
             at a time, unless the triangles are small against them; all others one by one"
        ))
        .note("Boxes", format!(
            "asked by at least one ray of a group, divided by the rays of the group, at {} triangles; rays in the \
             order of rendering",
            timed.last().map_or(0, |case| case.triangles)
        ))
        .note("Equal answers", format!(
            "all {asked} rays get the same t, bit for bit, and the same triangle both ways, or the claim fails"
        ))
        .note("Settings", format!("pictures of {size}; medians of {runs} taken in turn"));
    Finished { plate, data }
}

/// Boxes in the order of asking.
#[derive(Default)]
struct Boxes(Vec<[u64; 6]>);

impl Observer for Boxes {
    fn region(&mut self, bounds: &dyn Fn() -> Bounds3) {
        let Bounds3 { min, max } = bounds();
        self.0.push([min.x, min.y, min.z, max.x, max.y, max.z].map(f64::to_bits));
    }
}

/// How many different boxes a group of rays asks, divided by the group.
fn boxes_per_ray(index: &Wide, rays: &Rays, group: usize) -> f64 {
    let asked = |queries: &[Query<Ray>]| {
        let mut boxes = Boxes::default();
        for query in queries {
            index.watch(query.as_ref(), &mut boxes);
        }
        boxes.0.into_iter().collect::<HashSet<_>>().len()
    };
    let total: usize = rays.queries.chunks(group).map(asked).sum();
    total as f64 / rays.queries.len() as f64
}

fn rays_of(rays: &Rays) -> Vec<Ray> {
    rays.queries.iter().map(|query| query.ray).collect()
}

/// Gives the closest hits of all rays, batch by batch, to `each`.
fn together(index: &Wide, rays: &[Ray], mut each: impl FnMut(&[Option<Hit>])) {
    let mut hits = [None; BATCH];
    for batch in rays.chunks(BATCH) {
        let hits = &mut hits[..batch.len()];
        index.closest_hits(batch, Interval::POSITIVE, hits);
        each(hits);
    }
}

fn answers_agree(index: &Wide, rays: &Rays) -> bool {
    let rays = rays_of(rays);
    let alone = rays.iter().map(|ray| index.closest_hit(ray, Interval::POSITIVE));
    let mut all = Vec::new();
    together(index, &rays, |hits| all.extend_from_slice(hits));
    alone.eq(all)
}

/// Per ray, alone and together.
fn nanoseconds(index: &Wide, rays: &Rays, runs: usize) -> [f64; 2] {
    let rays = rays_of(rays);
    let time = |is_alone: &bool| {
        if *is_alone {
            let hits = rays.iter().map(|ray| index.closest_hit(ray, Interval::POSITIVE));
            return hits.flatten().count();
        }
        let mut count = 0;
        together(index, &rays, |hits| count += hits.iter().flatten().count());
        count
    };
    let timed = time_in_turn(runs, [true, false].iter().map(|is_alone| || time(is_alone)));
    [0, 1].map(|k: usize| 1e9 * timed[k].0.mid / rays.len() as f64)
}
