//! 0.5: what the robust kernels cost, beside what their textbook twins get wrong.

use std::hint::black_box;

use glam::DVec3;
use lancer_core::generate::icosphere;
use lancer_core::geometry::{Interval, Ray, Slabs, Sphere};
use lancer_core::image::ImageSize;
use lancer_core::sampling::Uniform;
use lancer_core::world::SurfacePoint;
use lancer_figure::{
    Axis, BarChart, Chart, Contender, Effort, Finished, Plate, Row, Series, Spread, Study, Trial,
    category_color, number,
};
use lancer_lesson::hard_boxes::{Class, HardBox};
use lancer_lesson::naive::{epsilon_shadow_ray, min_max_box, textbook_sphere};

use super::acne::Site;
use super::quadratic::far_sphere;
use super::watertight::{EDGES, VERTICES, aimed, leaking, triangles};

/// Each kernel: what it tests, then its textbook forms and last the robust one.
const KERNELS: [(&str, &[&str]); 4] = [
    ("triangle", &["Möller-Trumbore", "fused edges", "watertight"]),
    ("sphere", &["b² − 4ac", "stable"]),
    ("box", &["min/max", "slabs"]),
    ("leaving", &["ε = 10⁻⁴", "error bound"]),
];
const WRONG: &str = "wrong per million";
/// An answer for a sphere is wrong if it is off by this part of the radius.
const OFF: f64 = 1e-6;
/// Boxes tested by each prepared ray: its own, and others.
const BOXES: usize = 16;

/// The picture whose points leave the surface.
const SITE: ImageSize = ImageSize::new(36, 24);

/// How many of some answers are wrong.
#[derive(Clone, Copy)]
struct Wrong {
    answers: usize,
    of: usize,
}

/// One run of a kernel: what was wrong, and the number of tests.
type Run<'a> = Box<dyn Fn() -> (Wrong, u64) + 'a>;

pub fn make(effort: Effort) -> Finished {
    let mesh = icosphere(3);
    let count = effort.pick(400, 3_000);
    let rays = [aimed(&mesh, EDGES, count), aimed(&mesh, VERTICES, count)].concat();
    let triangles = triangles(&mesh);
    let meshes = |test: usize| {
        let (answers, tests) = leaking(test, &triangles, &rays);
        (Wrong { answers, of: rays.len() }, tests)
    };
    let (spheres, boxes) = (far_spheres(), hard_boxes());
    let sites: Vec<Site> = [0.0, 1e6]
        .into_iter()
        .flat_map(|away| (-3..=6).map(move |k| Site::new(10.0_f64.powi(k), away, SITE)))
        .collect();
    // Passes over inputs that stay in the caches, so that a run takes some 50 ms.
    let passes = effort.pick(1, 10);
    let runs: [Run; 9] = [
        Box::new(|| meshes(0)),
        Box::new(|| meshes(1)),
        Box::new(|| meshes(2)),
        Box::new(|| entered_spheres(&spheres, 100 * passes, textbook_sphere)),
        Box::new(|| {
            let enter = |sphere: Sphere, ray: &Ray| sphere.intersect(ray, Interval::POSITIVE);
            entered_spheres(&spheres, 100 * passes, enter)
        }),
        Box::new(|| {
            entered_boxes(&boxes, 20 * passes, |ray| {
                let inverse = DVec3::ONE / ray.direction;
                move |hard| min_max_box(&hard.bounds, ray.origin, inverse)
            })
        }),
        Box::new(|| {
            entered_boxes(&boxes, 20 * passes, |ray| {
                let slabs = Slabs::new(ray);
                move |hard| slabs.enter(hard.bounds.min, hard.bounds.max, Interval::POSITIVE)
            })
        }),
        leaving(&sites, 10 * passes, |point, light| epsilon_shadow_ray(point, light, 1e-4)),
        leaving(&sites, 10 * passes, SurfacePoint::spawn_to),
    ];
    let names = KERNELS.iter().enumerate();
    let names =
        names.flat_map(|(k, (kernel, forms))| forms.iter().map(move |form| (k, kernel, form)));
    let contenders = names.zip(runs).map(|((k, kernel, form), run)| Contender {
        curve: (*kernel).to_owned(),
        color: category_color(k),
        knob: *form,
        run,
    });
    let study = Study::measure("tests", effort.runs(15), contenders, |wrong: &Wrong| {
        vec![(WRONG, 1e6 * wrong.answers as f64 / wrong.of as f64)]
    });
    let wrong = |kernel: &str, form: &'static str| study.at(kernel, form).error(WRONG);
    let nanoseconds = |kernel: &str, form: &'static str| {
        let Trial { seconds, work, .. } = study.at(kernel, form);
        let each = |seconds: f64| 1e9 * seconds / *work as f64;
        Spread { low: each(seconds.low), mid: each(seconds.mid), high: each(seconds.high) }
    };

    let mut chart = Chart::new(
        Axis::log("time of one test (ns)"),
        Axis::log("wrong answers per million aimed rays"),
    )
    .title("From textbook to robust")
    .height(620.0);
    let (mut holds, mut costs, mut rates) = (true, Vec::new(), Vec::new());
    let (mut names, mut bars) = (Vec::new(), Vec::new());
    for (k, (kernel, forms)) in KERNELS.into_iter().enumerate() {
        let median = |form: &'static str| nanoseconds(kernel, form).mid;
        let (twin, robust, naive) = (forms[0], forms[forms.len() - 1], &forms[..forms.len() - 1]);
        holds &= wrong(kernel, robust) == 0.0 && naive.iter().all(|form| wrong(kernel, form) > 0.0);
        costs.push(format!("{kernel} ×{:.2}", median(robust) / median(twin)));
        rates.push(format!("{kernel} {:.0}", wrong(kernel, twin)));
        let mut series = Series::new(kernel, category_color(k));
        for &form in forms {
            series = series.point(nanoseconds(kernel, form), wrong(kernel, form));
            names.push(if wrong(kernel, form) == 0.0 {
                format!("{form} ✓")
            } else {
                form.to_owned()
            });
            bars.push((k, median(form)));
        }
        chart = chart.series(series);
    }
    let mut times =
        BarChart::new("time of one test (ns)", names).title("By name; ✓ is never wrong").stacked();
    for (k, (kernel, _)) in KERNELS.into_iter().enumerate() {
        let of_kernel = |&(bar, time): &(usize, f64)| if bar == k { time } else { 0.0 };
        let values: Vec<f64> = bars.iter().map(of_kernel).collect();
        times = times.series(kernel, category_color(k), values);
    }
    let claim = format!(
        "The robust kernels answer no aimed ray wrongly; their textbook twins, of a million: {}.",
        rates.join(", ")
    );
    let plate = Plate::new("0.5", "The cost of safety", claim, holds)
        .panel(Row::new().panel(1.2, chart).panel(1.0, times))
        .note("Cost", format!("robust over textbook, medians of interleaved runs: {}", costs.join(", ")))
        .note("Method", format!(
            "triangle: {} rays at edges and vertices of a closed mesh until one is met; sphere: {}, 10⁵ to 10⁷ \
             radii away; box: {} rays of thirteen hard classes, each testing {BOXES}; leaving: the surface point \
             and its shadow ray, at the twenty sites of plate 0.2. A ray is prepared once, all forms answer with \
             t. The stable sphere also sees to the far root and to rays that start on it, the slabs to a range of t",
            rays.len(),
            spheres.len(),
            boxes.len() - BOXES + 1,
        ))
        .note("Limits", "errors are those of hard cases, not of a picture; times are those of this machine, one \
             kernel in a loop, nothing else in its caches; the verdict does not look at them")
        .note("Reference", format!(
            "no ray leaves a closed mesh; closed forms of plates 0.1, 0.2 and 0.4; a sphere's t is wrong from {} \
             radii on",
            number(OFF)
        ));
    Finished { plate, data: study.table() }
}

/// Spheres from 10⁵ to 10⁷ radii away, each with its ray and the exact t.
fn far_spheres() -> Vec<(Sphere, Ray, f64)> {
    let mut random = Uniform::new(5, 0, 0);
    let mut next = |turn: usize| {
        let distance = 10.0_f64.powf(5.0 + 2.0 * random.number());
        far_sphere((5.0 * distance).round(), turn % 48)
    };
    (0..2_000).map(&mut next).collect()
}

fn entered_spheres(
    spheres: &[(Sphere, Ray, f64)],
    passes: usize,
    enter: impl Fn(Sphere, &Ray) -> Option<f64>,
) -> (Wrong, u64) {
    let mut wrong = 0;
    for (sphere, ray, exact) in (0..passes).flat_map(|_| black_box(spheres)) {
        let t = enter(*sphere, ray);
        wrong += usize::from(!t.is_some_and(|t| (t - exact).abs() < OFF * sphere.radius));
    }
    let of = passes * spheres.len();
    (Wrong { answers: wrong, of }, of as u64)
}

/// Boxes of all hard classes in turn, with their rays.
fn hard_boxes() -> Vec<(HardBox, Ray)> {
    let mut random = Uniform::new(5, 1, 0);
    let classes = Class::ALL.into_iter().cycle().take(2_000);
    let boxes = classes.map(|(class, _)| HardBox::new(class, &mut random));
    boxes.map(|hard| (hard, hard.ray())).collect()
}

/// Rays, each prepared and then tested with its own box, which it touches, and with those after it.
fn entered_boxes<'a, T: Fn(&HardBox) -> Option<f64>>(
    boxes: &'a [(HardBox, Ray)],
    passes: usize,
    prepare: impl Fn(&'a Ray) -> T,
) -> (Wrong, u64) {
    let (mut wrong, mut nearest) = (0, 0.0);
    for window in (0..passes).flat_map(|_| black_box(boxes).windows(BOXES)) {
        let test = prepare(&window[0].1);
        let entered = test(&window[0].0);
        wrong += usize::from(entered.is_none());
        let others = window[1..].iter().filter_map(|(hard, _)| test(hard));
        nearest += others.fold(entered.unwrap_or(0.0), |a, b| if b < a { b } else { a });
    }
    black_box(nearest);
    let of = passes * (boxes.len() - BOXES + 1);
    (Wrong { answers: wrong, of }, (of * BOXES) as u64)
}

/// Surface points and the shadow rays that leave them; what those meet is judged beforehand.
fn leaving<'a>(
    sites: &'a [Site],
    passes: usize,
    start: impl Fn(&SurfacePoint, DVec3) -> Ray + Copy + 'a,
) -> Run<'a> {
    let mut wrong = Wrong { answers: 0, of: 0 };
    for site in sites {
        let dark = site.dark(start);
        wrong.answers += site.wrong(&dark).iter().sum::<usize>();
        wrong.of += dark.len();
    }
    Box::new(move || {
        for site in (0..passes).flat_map(|_| black_box(sites)) {
            site.shadow_rays(start).for_each(|ray| {
                black_box(ray);
            });
        }
        (wrong, (passes * wrong.of) as u64)
    })
}
