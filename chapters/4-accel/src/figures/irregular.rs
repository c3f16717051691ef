//! 4.6: the cells of all subdivisions of space over one plan, and one ray's way through them.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use lancer_accel::{BspTree, Cell, Grid, KdBuilder, Leaf, OctreeBuilder};
use lancer_core::geometry::{Bounds3, Interval, Ray};
use lancer_core::intersector::{Hit, Intersector, LinearScan, Query, TestCounts};
use lancer_core::sampling::Uniform;
use lancer_core::scene::{MaterialId, Mesh, PrimitiveId, Scene};
use lancer_figure::{
    CAPTION, Color, Drawing, Effort, Finished, HEADING, INK, MUTED, Pen, Plate, Point, Row,
    SMALLEST, Stroke, Style, Table, Text, decimals, method_color, number,
};

/// The height of the plan: the walls stand from −WALL to WALL. It is in no structure's plane.
const PLAN: f64 = -0.6 * WALL;
const WALL: f64 = 0.02;

/// A cell's outline in the plan, and how many walls come near it.
#[derive(Clone)]
struct Region {
    outline: Vec<Point>,
    walls: usize,
}

/// A structure as it is drawn.
struct Drawn {
    name: &'static str,
    regions: Vec<Region>,
    /// The cells that the ray visits, in order.
    visited: Vec<Region>,
    /// The work of that ray.
    counts: TestCounts,
    /// The mean work of the fan, cells and tests.
    fan: [f64; 2],
    wrong: usize,
}

impl Drawn {
    /// The parts without walls.
    fn empty(&self) -> f64 {
        let empty = self.regions.iter().filter(|region| region.walls == 0).count();
        empty as f64 / self.regions.len() as f64
    }

    fn fullest(&self) -> usize {
        self.regions.iter().map(|region| region.walls).max().unwrap_or(0)
    }
}

/// Rays in the plan, and what they meet.
struct Fan {
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
}

impl Fan {
    /// From the points of a circle around the plan towards points inside.
    fn new(scene: &Scene, count: u32) -> Self {
        let ray = |k| {
            let mut random = Uniform::new(9, k, 0);
            let (sin, cos) = (TAU * random.number()).sin_cos();
            let from = DVec3::new(0.5 + cos, PLAN, 0.5 + sin);
            let to = DVec3::new(random.number(), PLAN, random.number());
            Ray::new(from, to - from)
        };
        let rays: Vec<Ray> = (0..count).map(ray).collect();
        let oracle = LinearScan::new(scene);
        let hits = rays.iter().map(|ray| watch(&oracle, ray, &mut TestCounts::default())).collect();
        Self { rays, hits }
    }
}

fn watch(index: &dyn Intersector, ray: &Ray, counts: &mut TestCounts) -> Option<Hit> {
    index.watch(Query::closest(ray, Interval::POSITIVE), counts)
}

/// Upright triangles that show as walls in the plan: a block of small ones in a corner, a few large ones.
fn walls() -> Scene {
    let mut mesh = Mesh::default();
    let mut wall = |middle: DVec2, half: DVec2| {
        let [a, b] = [middle - half, middle + half];
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([
            DVec3::new(a.x, -WALL, a.y),
            DVec3::new(b.x, -WALL, b.y),
            DVec3::new(middle.x, WALL, middle.y),
        ]);
        mesh.push_face(MaterialId(0), &[[first, first + 1, first + 2]]);
    };
    for k in 0..36 {
        let mut random = Uniform::new(6, k, 0);
        let place = DVec2::new(f64::from(k % 6), f64::from(k / 6)) + 0.5;
        let shift = DVec2::new(random.number() - 0.5, random.number() - 0.5);
        let half = 0.018 * DVec2::from_angle(TAU * random.number());
        wall(DVec2::new(0.66, 0.08) + 0.05 * (place + 0.4 * shift), half);
    }
    for (middle, half) in [
        ((0.15, 0.5), (0.0, 0.45)),
        ((0.45, 0.9), (0.4, 0.06)),
        ((0.4, 0.15), (0.15, 0.1)),
        ((0.36, 0.42), (0.1, 0.12)),
        ((0.8, 0.65), (0.15, -0.05)),
    ] {
        wall(middle.into(), half.into());
    }
    Scene::of_mesh(mesh)
}

/// The numbered ray: over empty space into the block.
fn numbered() -> Ray {
    let (from, to) = (DVec3::new(0.18, PLAN, 0.28), DVec3::new(0.95, PLAN, 0.2));
    Ray::new(from, to - from)
}

/// The part of a box in the plan, if it has one.
fn region(bounds: Bounds3, walls: usize) -> Option<Region> {
    let [low, high] = [bounds.min, bounds.max];
    let outline = vec![[low.x, low.z], [high.x, low.z], [high.x, high.z], [low.x, high.z]];
    (low.y..high.y).contains(&PLAN).then_some(Region { outline, walls })
}

fn regions<'c>(cells: impl Iterator<Item = (Bounds3, &'c [PrimitiveId])>) -> Vec<Region> {
    cells.filter_map(|(bounds, primitives)| region(bounds, primitives.len())).collect()
}

/// A cell's box and walls.
fn parts<'c>(cell: Cell<'c>) -> (Bounds3, &'c [PrimitiveId]) {
    (cell.bounds, cell.primitives)
}

/// The same of a leaf.
fn leaf<'t>(leaf: Leaf<'t>) -> (Bounds3, &'t [PrimitiveId]) {
    (leaf.bounds, leaf.primitives)
}

/// The cells of a binary space partition in the plan: convex, so that the farthest of their points in many
/// directions outline them.
fn outlines(tree: &BspTree, bounds: Bounds3, steps: u32) -> BTreeMap<usize, Region> {
    const DIRECTIONS: u32 = 180;
    let mut points = BTreeMap::<usize, (Vec<DVec2>, usize)>::new();
    let extent = bounds.max - bounds.min;
    for (row, column) in (0..=steps).flat_map(|row| (0..=steps).map(move |column| (row, column))) {
        let part = DVec2::new(f64::from(column), f64::from(row)) / f64::from(steps);
        let point = DVec2::new(bounds.min.x, bounds.min.z) + part * DVec2::new(extent.x, extent.z);
        let (number, primitives) = tree.leaf_at(DVec3::new(point.x, PLAN, point.y));
        points.entry(number).or_insert((Vec::new(), primitives.len())).0.push(point);
    }
    let outline = |points: &[DVec2]| {
        let farthest = |k: u32| {
            let direction = DVec2::from_angle(TAU * (f64::from(k) + 0.3) / f64::from(DIRECTIONS));
            let by_distance =
                |a: &&DVec2, b: &&DVec2| a.dot(direction).total_cmp(&b.dot(direction));
            points.iter().max_by(by_distance).expect("a cell found by a point").to_array()
        };
        let mut outline: Vec<Point> = (0..DIRECTIONS).map(farthest).collect();
        outline.dedup();
        outline
    };
    points
        .into_iter()
        .map(|(number, (points, walls))| (number, Region { outline: outline(&points), walls }))
        .collect()
}

fn drawn(
    name: &'static str,
    index: &dyn Intersector,
    fan: &Fan,
    [regions, visited]: [Vec<Region>; 2],
) -> Drawn {
    let (mut counts, mut of_fan) = (TestCounts::default(), TestCounts::default());
    watch(index, &numbered(), &mut counts);
    let answers = fan.rays.iter().map(|ray| watch(index, ray, &mut of_fan));
    let wrong = answers.zip(&fan.hits).filter(|(hit, expected)| hit != *expected).count();
    let mean = |count: u64| count as f64 / fan.rays.len() as f64;
    let fan = [mean(of_fan.cells), mean(of_fan.primitives)];
    Drawn { name, regions, visited, counts, fan, wrong }
}

pub fn make(effort: Effort) -> Finished {
    let scene = walls();
    let bounds = scene.bounds();
    let mut fan = Fan::new(&scene, effort.pick(200, 5_000));
    let ray = numbered();
    let hit = watch(&LinearScan::new(&scene), &ray, &mut TestCounts::default());
    fan.rays.push(ray);
    fan.hits.push(hit);
    let hit = hit.expect("the numbered ray meets a wall");
    let range = Interval::up_to(hit.t);

    let grid = Grid::build(&scene);
    let rows = grid.resolution().z;
    let along = |row: u32| {
        let part = (f64::from(row) + 0.5) / f64::from(rows);
        let z = bounds.min.z + part * (bounds.max.z - bounds.min.z);
        Ray::new(DVec3::new(bounds.min.x - 1.0, PLAN, z), DVec3::X)
    };
    let rows: Vec<Ray> = (0..rows).map(along).collect();
    let cells = rows.iter().flat_map(|ray| grid.cells(ray, Interval::POSITIVE)).map(parts);
    let grid_regions = [regions(cells), regions(grid.cells(&ray, range).map(parts))];
    let octree = OctreeBuilder { leaf_size: 2, ..OctreeBuilder::default() }.build(&scene);
    let octree_regions =
        [regions(octree.leaves().map(leaf)), regions(octree.cells(&ray, range).map(parts))];
    let kd = KdBuilder { test_cost: 2.0, ..KdBuilder::default() }.build(&scene);
    let kd_regions = [regions(kd.leaves().map(leaf)), regions(kd.cells(&ray, range).map(parts))];
    let bsp = BspTree::build(&scene);
    let cells = outlines(&bsp, bounds, effort.pick(150, 500));
    let visited = bsp.visited_leaves(&ray, Interval::POSITIVE).into_iter();
    let visited = visited.map(|number| cells[&number].clone()).collect();
    let bsp_regions = [cells.into_values().collect(), visited];
    let all = [
        drawn("grid", &grid, &fan, grid_regions),
        drawn("octree", &octree, &fan, octree_regions),
        drawn("kd", &kd, &fan, kd_regions),
        drawn("bsp", &bsp, &fan, bsp_regions),
    ];

    let [regular, irregular @ ..] = &all;
    let fullest = irregular.iter().map(Drawn::fullest).max().unwrap_or(0);
    let holds = all.iter().all(|drawn| drawn.wrong == 0)
        && regular.fullest() as f64 >= 1.5 * fullest as f64;
    let claim = format!(
        "Irregular subdivisions put their planes where the walls crowd: none of their cells holds more than {fullest} \
         walls, while the grid, as fine here as elsewhere, has one with {}.",
        regular.fullest(),
    );
    let fan_tests = all.iter().map(|drawn| {
        let [cells, tests] = drawn.fan.map(|count| decimals(count, 1));
        format!("{} {cells} + {tests}", drawn.name)
    });
    let fan_tests = fan_tests.collect::<Vec<_>>().join(", ");

    let mut data = Table::new([
        "index",
        "cells",
        "empty",
        "fullest",
        "leaves_visited",
        "cells_visited",
        "tests",
        "fan_cells",
        "fan_tests",
        "wrong",
    ]);
    for drawn in &all {
        data.push([
            drawn.name.into(),
            drawn.regions.len().into(),
            drawn.empty().into(),
            drawn.fullest().into(),
            drawn.visited.len().into(),
            drawn.counts.cells.into(),
            drawn.counts.primitives.into(),
            drawn.fan[0].into(),
            drawn.fan[1].into(),
            drawn.wrong.into(),
        ]);
    }
    let segments: Vec<[Point; 2]> = (0..scene.mesh.triangles.len())
        .map(|triangle| section(scene.mesh.corners(triangle)))
        .collect();
    let way = [ray.origin, ray.at(hit.t)].map(|point| [point.x, point.z]);
    let [a, b, c, d] = all.map(|drawn| plan(drawn, bounds, segments.clone(), way));
    let plate = Plate::new("4.6", "Regular and irregular cells", claim, holds)
        .panel(Row::new().panel(1.0, a).panel(1.0, b))
        .panel(Row::new().panel(1.0, c).panel(1.0, d))
        .note("Drawn", "a plan of upright walls (black) and the cells that it cuts; one ray's cells in order, darker \
             those with walls, until its hit. A tree's ray visits inner nodes as well, which are no cells here")
        .note("Cost", format!(
            "cells visited, inner ones too, and walls tested by {} rays on average: {fan_tests}",
            fan.rays.len(),
        ))
        .note("Settings", format!(
            "{} walls. For the drawing the octree is cut down to 2 walls where that spares tests, \
             and to the kd-tree a test costs two steps; grid and BSP as by default",
            segments.len(),
        ))
        .note("Reference", "brute force: every structure has its answer to each of the rays, bit for bit");
    Finished { plate, data }
}

/// Where an upright triangle, two corners below and one above, passes through the plan.
fn section([a, b, c]: [DVec3; 3]) -> [Point; 2] {
    [a, b].map(|low| {
        let point = low.lerp(c, (PLAN - low.y) / (c.y - low.y));
        [point.x, point.z]
    })
}

/// One structure's cells, walls and ray.
fn plan(drawn: Drawn, bounds: Bounds3, walls: Vec<[Point; 2]>, way: [Point; 2]) -> Drawing {
    let [left, right] = [bounds.min.x, bounds.max.x];
    let [low, high] = [bounds.min.z - 0.045, bounds.max.z + 0.045];
    Drawing::new([left, low], [right, high], 690.0, move |pen: &mut Pen<'_>| {
        let color = method_color(drawn.name);
        for Region { outline, walls } in &drawn.visited {
            let part = if *walls > 0 { 0.45 } else { 0.8 };
            pen.polygon(outline, Style::fill(color.mix(Color::WHITE, part)));
        }
        for region in &drawn.regions {
            pen.polygon(&region.outline, Style::outline(color.for_text(), 1.2));
        }
        for wall in &walls {
            pen.line(wall, Stroke::new(INK, 3.0));
        }
        let [from, to] = way;
        pen.line(&way, Stroke::new(MUTED, 2.0));
        pen.dot(from, 5.0, MUTED);
        pen.dot(to, 5.0, INK);
        for (k, region) in drawn.visited.iter().enumerate() {
            let sum =
                region.outline.iter().fold(DVec2::ZERO, |sum, &point| sum + DVec2::from(point));
            let middle = (sum / region.outline.len() as f64).to_array();
            let order = Text::new((k + 1).to_string(), SMALLEST).bold().color(INK);
            pen.label(middle, [0.0, 0.0], order);
        }
        let title = format!(
            "{}: {} cells, {} % of them empty",
            drawn.name,
            drawn.regions.len(),
            number((100.0 * drawn.empty()).round())
        );
        let [x, y] = pen.at([left, high - 0.025]);
        pen.canvas().text([x, y], Text::new(title, HEADING).bold().color(color.for_text()));
        let work = format!(
            "the ray visits {} cells and tests {} walls",
            drawn.visited.len(),
            drawn.counts.primitives
        );
        let [x, y] = pen.at([left, low + 0.005]);
        pen.canvas().text([x, y], Text::new(work, CAPTION).color(MUTED));
    })
}
