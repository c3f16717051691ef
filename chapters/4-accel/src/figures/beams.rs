//! 4.12: what a beam of a picture asks of an index, by the number of polygons and by its aperture.

use std::collections::HashSet;

use glam::{DVec2, DVec3};
use lancer_accel::{Bvh, Grid};
use lancer_core::geometry::{ConvexVolume, Interval, Ray};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{BeamIndex, Intersector, LinearScan, Observer, TestCounts};
use lancer_core::scene::{PrimaryRays, PrimitiveId};
use lancer_figure::{
    Axis, Chart, Color, Drawing, Effort, FAINT, Finished, HEADING, INK, LABEL, MUTED, Pen, Plate,
    Row, Series, Stroke, Style, Table, Text, category_color, decimals, method_color, number,
};
use lancer_lesson::judge::fitted_exponent;

use crate::scenes::family;

/// The picture that is cut into beams.
const SIZE: ImageSize = ImageSize::new(256, 256);
/// Sides of the beams' windows, in pixels.
const WINDOWS: [u32; 3] = [64, 16, 4];
const SCENES: [&str; 3] = ["scan", "soup", "town"];
const INDEXES: [&str; 3] = ["linear", "bvh", "grid"];

/// A beam, and what rays in it say of it.
struct Beam {
    volume: ConvexVolume,
    /// What the rays hit.
    hit: Vec<PrimitiveId>,
    /// The depth of the farthest hit, if all of them hit.
    seen: f64,
}

impl Beam {
    /// Of a window with its upper left corner at `low`.
    fn new(rays: &PrimaryRays, low: DVec2, side: f64, index: &dyn Intersector) -> Self {
        let volume = rays.beam(low, low + side);
        let Ray { origin, direction } = volume.axis();
        let hits = (0..16).map(|k| {
            let part = DVec2::new(f64::from(k % 4) + 0.5, f64::from(k / 4) + 0.5) / 4.0;
            let at = low + side * part;
            let ray = rays.through(at.x, at.y);
            let hit = index.closest_hit(&ray, Interval::POSITIVE)?;
            Some((hit.primitive, direction.dot(ray.at(hit.t) - origin)))
        });
        let hits: Vec<Option<(PrimitiveId, f64)>> = hits.collect();
        // Above the rounding of the depths, which is all that separates the bound from the hit.
        let depth = |hit: &Option<(PrimitiveId, f64)>| {
            hit.map_or(f64::INFINITY, |(_, depth)| depth * (1.0 + 1e-9))
        };
        let seen = hits.iter().map(depth).fold(0.0, f64::max);
        Self {
            volume,
            hit: hits.into_iter().flatten().map(|(primitive, _)| primitive).collect(),
            seen,
        }
    }

    fn search(
        &self,
        index: &dyn BeamIndex,
        far: f64,
        observer: &mut dyn Observer,
    ) -> Vec<PrimitiveId> {
        let mut found = Vec::new();
        index.watch_beam(&self.volume, far, observer, &mut |primitive| {
            found.push(primitive);
            far
        });
        found
    }
}

/// The beams of a size, evenly over the picture: at most so many of a row.
fn beams(rays: &PrimaryRays, window: u32, a_row: u32, index: &dyn Intersector) -> Vec<Beam> {
    let across = SIZE.width / window;
    let take = across.min(a_row);
    let corner = |k: u32| f64::from((2 * k + 1) * across / (2 * take) * window);
    let corners = (0..take * take).map(|k| DVec2::new(corner(k % take), corner(k / take)));
    corners.map(|low| Beam::new(rays, low, f64::from(window), index)).collect()
}

/// What the beams of one size asked of one index: averages of a beam.
struct Case {
    scene: &'static str,
    triangles: f64,
    window: u32,
    index: &'static str,
    bounded: bool,
    /// Polygons that may meet the beam, as the index found them.
    met: f64,
    tests: f64,
}

/// What was measured: all cases, their table, and the wrong answers in it.
struct Measured {
    cases: Vec<Case>,
    data: Table,
    /// Polygons that a ray of a beam hit and an index had not found.
    lost: usize,
    /// Beams in which the hierarchy differs from brute force.
    unlike: usize,
}

impl Measured {
    fn new(sizes: &[u32], a_row: u32) -> Self {
        let columns = ["beams", "met", "tests", "boxes", "cells", "hits_lost", "unlike_linear"];
        let keys = ["scene", "triangles", "window", "index", "bound"];
        let data = Table::new(keys.into_iter().chain(columns));
        let mut measured = Self { cases: Vec::new(), data, lost: 0, unlike: 0 };
        for scene_name in SCENES {
            for &size in sizes {
                let scene = family(scene_name).scene(size);
                let triangles = scene.mesh.triangles.len();
                let (linear, bvh, grid) =
                    (LinearScan::new(&scene), Bvh::build(&scene), Grid::build(&scene));
                let indexes: [&dyn BeamIndex; 3] = [&linear, &bvh, &grid];
                let rays = scene.camera.primary_rays(SIZE);
                for window in WINDOWS {
                    let beams = beams(&rays, window, a_row, &bvh);
                    let mut wanted: Vec<Vec<PrimitiveId>> = Vec::new();
                    for bounded in [false, true] {
                        // Brute force tests as many with a bound: what it finds is where its list begins.
                        let asked = INDEXES.into_iter().zip(indexes).skip(usize::from(bounded));
                        for (index_name, index) in asked {
                            let mut counts = TestCounts::default();
                            let search = |beam: &Beam| {
                                let far = if bounded { beam.seen } else { f64::INFINITY };
                                beam.search(index, far, &mut counts)
                            };
                            let found: Vec<Vec<PrimitiveId>> = beams.iter().map(search).collect();
                            let hits_lost: usize =
                                beams.iter().zip(&found).map(|(b, f)| b.lost(f)).sum();
                            if index_name == "linear" {
                                wanted.clone_from(&found);
                            }
                            let unlike_linear = found
                                .iter()
                                .zip(&wanted)
                                .filter(|(found, all)| match bounded {
                                    true => !all.starts_with(found),
                                    false => found != all,
                                })
                                .count();
                            measured.lost += hits_lost;
                            measured.unlike += if index_name == "bvh" { unlike_linear } else { 0 };
                            let per_beam = |count: u64| count as f64 / beams.len() as f64;
                            let met = per_beam(found.iter().map(Vec::len).sum::<usize>() as u64);
                            let tests = per_beam(counts.primitives);
                            measured.data.push([
                                scene_name.into(),
                                triangles.into(),
                                window.into(),
                                index_name.into(),
                                if bounded { "seen" } else { "none" }.into(),
                                beams.len().into(),
                                met.into(),
                                tests.into(),
                                per_beam(counts.boxes).into(),
                                per_beam(counts.cells).into(),
                                hits_lost.into(),
                                unlike_linear.into(),
                            ]);
                            let triangles = triangles as f64;
                            measured.cases.push(Case {
                                scene: scene_name,
                                triangles,
                                window,
                                index: index_name,
                                bounded,
                                met,
                                tests,
                            });
                        }
                    }
                }
            }
        }
        measured
    }

    fn of(&self, scene: &str, window: u32, index: &str, bounded: bool) -> Vec<&Case> {
        let same = |case: &&Case| {
            (case.scene, case.window, case.index, case.bounded) == (scene, window, index, bounded)
        };
        self.cases.iter().filter(same).collect()
    }

    /// The case of the largest scene.
    fn last(&self, scene: &str, window: u32, index: &str, bounded: bool) -> &Case {
        self.of(scene, window, index, bounded).last().expect("a largest scene")
    }

    /// Tests for each polygon that meets the beam, in the largest scene of a kind.
    fn price(&self, scene: &str, window: u32, index: &str) -> f64 {
        let met = self.last(scene, window, "linear", false).met;
        self.last(scene, window, index, false).tests / met
    }

    /// The highest price of an index.
    fn highest_price(&self, index: &str) -> f64 {
        let prices = SCENES.iter().flat_map(|scene| WINDOWS.map(|w| self.price(scene, w, index)));
        prices.fold(0.0, f64::max)
    }

    /// The exponent of what a beam meets, in the last decade of polygons: the least of all scenes.
    fn slowest_growth(&self, window: u32) -> f64 {
        let growth = |scene: &str| {
            let met = self.of(scene, window, "linear", false);
            let decade = met[met.len() - 2..].iter().map(|case| (case.triangles, case.met));
            fitted_exponent(&decade.collect::<Vec<_>>())
        };
        SCENES.map(growth).into_iter().fold(f64::INFINITY, f64::min)
    }

    fn claim(&self, largest: &str) -> (String, bool) {
        let [linear, bvh, grid] = INDEXES.map(|index| self.highest_price(index));
        let wide = self.slowest_growth(WINDOWS[0]);
        let right = self.lost + self.unlike == 0;
        let holds = right && bvh < 3.0 && grid < 20.0 && linear > 200.0 && wide > 0.8;
        let claim = format!(
            "For each polygon that a beam meets, among {largest}, the hierarchy tests at most {bvh:.1}, the grid \
             {grid:.1}, brute force {linear:.0}; but a beam of 64² pixels meets n^{wide:.2} polygons or more, which \
             no index spares."
        );
        (claim, holds)
    }

    /// Tests of a beam by the number of polygons.
    fn growths(&self) -> Row {
        WINDOWS.into_iter().fold(Row::new(), |row, window| {
            let polygons = Axis::log("polygons per beam").between(1.0, 1e5);
            let mut chart = Chart::new(Axis::log("polygons, n"), polygons)
                .title(format!("scan: beams of {window}² pixels"))
                .height(430.0);
            for index in INDEXES {
                let points = self.of("scan", window, index, false);
                let points = points.into_iter().map(|case| (case.triangles, case.tests));
                chart = chart.series(Series::new(index, method_color(index)).points(points));
            }
            let met = self.of("scan", window, "linear", false);
            let met = met.into_iter().map(|case| (case.triangles, case.met));
            row.panel(1.0, chart.series(Series::new("met", INK).curve().dashed().points(met)))
        })
    }

    /// Tests for each polygon met, by the size of the beam.
    fn prices(&self, largest: &str) -> Row {
        SCENES.into_iter().fold(Row::new(), |row, scene| {
            let side = Axis::log("window's side (pixels)").between(2.0, 128.0);
            let chart = Chart::new(side, Axis::log("tests per polygon met").between(0.5, 3e3))
                .title(format!("{scene} of {largest}"))
                .height(400.0);
            let chart = INDEXES.into_iter().fold(chart, |chart, index| {
                let price = |window| (f64::from(window), self.price(scene, window, index));
                let series = Series::new(index, method_color(index));
                chart.series(series.points(WINDOWS.map(price)))
            });
            row.panel(1.0, chart)
        })
    }

    /// What a bound spares the smallest beams.
    fn bounded(&self, scene: &str, index: &str) -> String {
        let tests = [false, true].map(|bounded| self.last(scene, 4, index, bounded).tests);
        format!("{} instead of {}", decimals(tests[1], 0), decimals(tests[0], 0))
    }
}

pub fn make(effort: Effort) -> Finished {
    let sizes: &[u32] = effort.pick(&[1_000, 10_000], &[100, 1_000, 10_000, 100_000]);
    let a_row = effort.pick(4, 8);
    let measured = Measured::new(sizes, a_row);
    let largest = number(f64::from(*sizes.last().expect("some sizes")));
    let (claim, holds) = measured.claim(&largest);
    let bounded = |scene: &str, index: &str| measured.bounded(scene, index);
    let plate = Plate::new("4.12", "Beams and the index", claim, holds)
        .panel(plan())
        .panel(measured.growths())
        .panel(measured.prices(&largest))
        .note(
            "Plan",
            "a town of 2000 polygons from above, and a beam of 32² pixels that comes down onto it: the houses between \
             the eye and those in the beam are under it. The ground's two polygons, in the beam, are not drawn",
        )
        .note("Same answer", format!(
            "the hierarchy visits the polygons of brute force in the same order in all beams but {}; 16 rays \
             in each beam hit {} polygons that an index had not found. Met: as far as brute force can tell by \
             the corners of each polygon",
            measured.unlike, measured.lost
        ))
        .note("Far bound", format!(
            "told the depth of what those rays see, a beam of 4² pixels of the scan costs the hierarchy {} \
             tests, the grid {}; one of the soup, which one can see through, costs the hierarchy {}",
            bounded("scan", "bvh"), bounded("scan", "grid"), bounded("soup", "bvh")
        ))
        .note("Growth", format!(
            "exponents of what a beam meets are of the last decade, the least of three scenes; with 4² pixels \
             n^{:.2}",
            measured.slowest_growth(WINDOWS[WINDOWS.len() - 1])
        ))
        .note("Settings", format!(
            "a picture of {SIZE}, beams evenly over it, {} of a size at most; the rest of the work, boxes and \
             cells, is in the data",
            a_row * a_row
        ));
    Finished { plate, data: measured.data }
}

impl Beam {
    /// How many of its rays' hits are not among the found.
    fn lost(&self, found: &[PrimitiveId]) -> usize {
        let found: HashSet<_> = found.iter().collect();
        self.hit.iter().filter(|primitive| !found.contains(primitive)).count()
    }
}

/// The polygons that are tested.
#[derive(Default)]
struct Tested(HashSet<PrimitiveId>);

impl Observer for Tested {
    fn primitive_test(&mut self, primitive: PrimitiveId) {
        self.0.insert(primitive);
    }
}

/// A town from above, and one beam: what of it two indexes look at.
fn plan() -> Row {
    let scene = family("town").scene(2000);
    let rays = scene.camera.primary_rays(SIZE);
    let (low, side) = (DVec2::new(112.0, 104.0), 32.0);
    let (bvh, grid) = (Bvh::build(&scene), Grid::build(&scene));
    let beam = Beam::new(&rays, low, side, &bvh);
    // Plans have the z axis downwards.
    let seen_from_above = |p: DVec3| [p.x, -p.z];
    let ground = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| {
        let ray = rays.through(low.x + x, low.y + y);
        seen_from_above(ray.at(-ray.origin.y / ray.direction.y))
    });
    let eye = seen_from_above(scene.camera.eye);
    let panel = |name: &'static str, index: &dyn BeamIndex| {
        let mut tested = Tested::default();
        let met: HashSet<_> = beam.search(index, f64::INFINITY, &mut tested).into_iter().collect();
        // The ground's two triangles are not drawn.
        let shapes: Vec<([[f64; 2]; 3], Option<Color>)> = scene
            .primitives()
            .skip(2)
            .map(|primitive| {
                let corners = scene.mesh.corners(primitive.0 as usize).map(seen_from_above);
                let color = match (met.contains(&primitive), tested.0.contains(&primitive)) {
                    (true, _) => Some(category_color(0)),
                    (false, true) => Some(category_color(1)),
                    (false, false) => None,
                };
                (corners, color)
            })
            .collect();
        let title = format!("{name}: {} tested, {} in the beam", tested.0.len(), met.len());
        Drawing::new([-0.02, -1.4], [1.02, 0.14], 700.0, move |pen: &mut Pen<'_>| {
            // What is coloured lies over what is not.
            for colored in [false, true] {
                for (corners, color) in shapes.iter().filter(|(_, c)| c.is_some() == colored) {
                    let fill = color.unwrap_or(FAINT);
                    let edge = if colored { fill } else { MUTED.with_alpha(110) };
                    pen.polygon(
                        corners,
                        Style::fill(fill).outlined(edge, if colored { 1.5 } else { 0.5 }),
                    );
                }
            }
            let edge = Stroke::new(INK, 2.0);
            for corner in ground {
                pen.line(&[eye, corner], edge);
            }
            pen.line(&[ground[0], ground[1], ground[2], ground[3], ground[0]], edge);
            pen.dot(eye, 6.0, INK);
            pen.label(eye, [34.0, 0.0], Text::new("eye", LABEL));
            pen.label([0.5, 0.1], [0.0, 0.0], Text::new(title.clone(), HEADING).bold());
            let legend = [
                ("in the beam", category_color(0)),
                ("tested, outside it", category_color(1)),
                ("never looked at", MUTED),
            ];
            for (k, (text, color)) in legend.into_iter().enumerate() {
                let text = Text::new(text, LABEL).color(color.for_text()).bold();
                pen.label([0.8, -1.16 - 0.06 * k as f64], [0.0, 0.0], text);
            }
        })
    };
    Row::new().panel(1.0, panel("bvh", &bvh)).panel(1.0, panel("grid", &grid))
}
