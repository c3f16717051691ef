//! 1.1: polygons that no order of painting gets right, and rays that need no order.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray, Shear, intersect_triangle};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Hit, LinearScan, Query, TestCounts, Traversal};
use lancer_core::sampling::Uniform;
use lancer_core::scene::{Camera, Material, MaterialId, Mesh, PrimaryRays, Scene};
use lancer_figure::{
    Axis, BarChart, Chart, Color, Contender, Effort, Finished, Montage, Picture, Plate, Row,
    Series, Study, Table, Tile, category_color, method_color, number,
};

/// A planar convex polygon before an eye in the origin that looks along −z.
#[derive(Clone, Copy)]
struct Polygon([DVec3; 4]);

/// The eye of [`Polygon`]: half the picture's height is a unit at depth 1.
const CAMERA: Camera =
    Camera { eye: DVec3::ZERO, look_at: DVec3::NEG_Z, up: DVec3::Y, fov: 90.0, lens: None };

/// A polygon's two triangles, by their corners.
const TRIANGLES: [[usize; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

impl Polygon {
    /// Drawn on the picture: the strip `reach` long to both sides of `center` along `angle` (in half
    /// picture heights and radians) and `half_width` wide to both sides, with the inverse depths of its
    /// two ends. They are affine between them: in perspective that is a plane.
    fn strip(center: DVec2, angle: f64, [reach, half_width]: [f64; 2], ends: [f64; 2]) -> Self {
        let along = DVec2::from_angle(angle);
        Self([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(end, side)| {
            let film = center + end * reach * along + side * half_width * along.perp();
            film.extend(-1.0) / ends[usize::from(end > 0.0)]
        }))
    }

    /// The outline on the picture, in half picture heights.
    fn outline(&self) -> [DVec2; 4] {
        self.0.map(|corner| corner.truncate() / -corner.z)
    }

    /// The half-planes that the outline is cut from: a point of the picture lies n·film + d within each.
    fn half_planes(&self) -> [(DVec2, f64); 4] {
        let outline = self.outline();
        let edge = |k: usize| outline[(k + 1) % 4] - outline[k];
        let turn = edge(0).perp_dot(edge(1)).signum();
        std::array::from_fn(|k| {
            let n = turn * edge(k).normalize().perp();
            (n, -n.dot(outline[k]))
        })
    }

    /// 1 / depth of the polygon's plane behind a point of the picture, in closed form: n·(u, v, −1) / n·c.
    fn inverse_depth(&self, film: DVec2) -> f64 {
        let [a, b, c, _] = self.0;
        let n = (b - a).cross(c - a);
        n.dot(film.extend(-1.0)) / n.dot(a)
    }

    /// The two triangles it is cut into.
    fn triangles(&self) -> [[DVec3; 3]; 2] {
        TRIANGLES.map(|corners| corners.map(|k| self.0[k]))
    }
}

/// The width of a bar and of a sheet, in half picture heights, and the angle between the sheets.
const BAR: f64 = 0.34;
const SHEET: f64 = 0.72;
const SHEETS_APART: f64 = 1.4;

/// Three strips, each over the next in a circle, and two that pass through each other.
fn cycle_and_cross() -> Vec<Polygon> {
    let bar = |k: i32| {
        let angle = f64::from(k) * TAU / 3.0 + 0.13;
        let center = DVec2::new(-1.0, -0.03) - 0.3 * DVec2::from_angle(angle).perp();
        Polygon::strip(center, angle, [0.84, BAR / 2.0], [0.5, 0.25])
    };
    let center = DVec2::new(1.02, 0.03);
    let cross = |angle| Polygon::strip(center, angle, [0.85, SHEET / 2.0], [0.5, 0.25]);
    vec![bar(0), bar(1), bar(2), cross(0.31), cross(0.31 + SHEETS_APART)]
}

/// Squares of all directions before the eye; their sides keep them as crowded at every number.
fn soup(count: u32, which: u32) -> Vec<Polygon> {
    let mut random = Uniform::new(1, count, which);
    let half = 2.5 * (10.0 / f64::from(count)).cbrt();
    let square = |_| {
        let (u, v) = (3.0 * random.number() - 1.5, 2.0 * random.number() - 1.0);
        let center = (4.0 + 4.0 * random.number()) * DVec3::new(u, v, -1.0);
        let across = random.direction();
        let up = across.cross(random.direction()).normalize();
        let corner = |x: f64, y: f64| center + half * (x * across + y * up);
        Polygon([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)])
    };
    (0..count).map(square).collect()
}

/// Which polygon each pixel shows.
type Faces = Vec<Option<usize>>;

/// The polygons, seen by the centres of the pixels.
struct View {
    polygons: Vec<Polygon>,
    scene: Scene,
    size: ImageSize,
    rays: PrimaryRays,
    truth: Faces,
    /// The least distance of a pixel's centre from an outline, in pixels: how certain the truth is.
    clearance: f64,
}

impl View {
    fn new(polygons: Vec<Polygon>, size: ImageSize) -> Self {
        let mut mesh = Mesh::default();
        for (face, polygon) in (0..).zip(&polygons) {
            mesh.positions.extend(polygon.0);
            let triangles = TRIANGLES.map(|corners| corners.map(|k| 4 * face + k as u32));
            mesh.push_face(MaterialId(0), &triangles);
        }
        let scene = Scene {
            camera: CAMERA,
            mesh,
            spheres: Vec::new(),
            motions: Vec::new(),
            materials: vec![Material::matte(Rgb::ONE)],
            lights: Vec::new(),
            ambient: Rgb::ONE,
            background: Rgb::ZERO,
        };
        let (rays, truth) = (CAMERA.primary_rays(size), Vec::new());
        let mut view = Self { polygons, scene, size, rays, truth, clearance: f64::INFINITY };
        view.decide();
        view
    }

    /// Works out the truth: of the outlines around a pixel's centre, the one whose plane is nearest there.
    fn decide(&mut self) {
        let mut nearest = vec![(0.0, None); self.size.pixels()];
        for (k, polygon) in self.polygons.iter().enumerate() {
            let half_planes = polygon.half_planes();
            for (pixel, nearest) in self.pixels().zip(&mut nearest) {
                let film = self.film(pixel);
                let within = half_planes.map(|(n, d)| n.dot(film) + d);
                let within = within.into_iter().fold(f64::INFINITY, f64::min);
                self.clearance = self.clearance.min(within.abs());
                let near = polygon.inverse_depth(film);
                if within > 0.0 && near > nearest.0 {
                    *nearest = (near, Some(k));
                }
            }
        }
        self.clearance *= f64::from(self.size.height) / 2.0;
        self.truth = nearest.into_iter().map(|(_, face)| face).collect();
    }

    fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let ImageSize { width, height, .. } = self.size;
        (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }

    /// The centre of a pixel in half picture heights, y upwards.
    fn film(&self, (x, y): (u32, u32)) -> DVec2 {
        let half = DVec2::new(f64::from(self.size.width), f64::from(self.size.height)) / 2.0;
        let film = DVec2::new(f64::from(x), f64::from(y)) + 0.5 - half;
        DVec2::new(film.x, -film.y) / half.y
    }

    fn ray(&self, x: u32, y: u32) -> Ray {
        self.rays.through(f64::from(x) + 0.5, f64::from(y) + 0.5)
    }

    /// The painter's order: falling depth, which is one number for each polygon.
    fn order(&self, depth: Depth) -> Vec<usize> {
        let depths: Vec<f64> = self.polygons.iter().map(|p| depth(p.0.map(|c| -c.z))).collect();
        let mut order: Vec<usize> = (0..depths.len()).collect();
        order.sort_by(|&a, &b| depths[b].total_cmp(&depths[a]));
        order
    }

    /// Polygon over polygon, each over the pixels of its box on the picture; and the triangles tested.
    fn painted(&self, order: &[usize]) -> (Faces, u64) {
        let (width, height) = (self.size.width, self.size.height);
        let (mut faces, mut tests) = (vec![None; self.size.pixels()], 0);
        for &k in order {
            let outline = self.polygons[k].outline().map(|film| {
                let half = f64::from(height) / 2.0;
                DVec2::new(f64::from(width) / 2.0 + half * film.x, half - half * film.y)
            });
            let low = outline.into_iter().fold(DVec2::INFINITY, DVec2::min).max(DVec2::ZERO);
            let high = outline.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
            for y in low.y as u32..(high.y.max(0.0).ceil() as u32).min(height) {
                for x in low.x as u32..(high.x.max(0.0).ceil() as u32).min(width) {
                    let ray = self.ray(x, y);
                    let shear = Shear::new(ray.direction);
                    let met = |corners: &[DVec3; 3]| {
                        tests += 1;
                        intersect_triangle(*corners, &ray, &shear).is_some()
                    };
                    if self.polygons[k].triangles().iter().any(met) {
                        faces[(y * width + x) as usize] = Some(k);
                    }
                }
            }
        }
        (faces, tests)
    }

    /// What a ray through each pixel meets first; and the triangles and boxes tested.
    fn cast(&self, walk: impl Fn(&Ray, &mut TestCounts) -> Option<Hit>) -> (Faces, u64) {
        let mut counts = TestCounts::default();
        let triangles = &self.scene.mesh.triangles;
        let face = |hit: Hit| triangles[hit.primitive.0 as usize].face.0 as usize;
        let faces =
            self.pixels().map(|(x, y)| walk(&self.ray(x, y), &mut counts).map(face)).collect();
        (faces, counts.primitives + counts.boxes)
    }

    /// The share of wrong pixels in %.
    fn wrong(&self, faces: &Faces) -> f64 {
        let wrong = faces.iter().zip(&self.truth).filter(|(face, truth)| face != truth).count();
        100.0 * wrong as f64 / self.size.pixels() as f64
    }

    fn picture(&self, faces: &Faces) -> Picture {
        Picture::from_fn(self.size.width, self.size.height, |x, y| {
            let face = faces[(y * self.size.width + x) as usize];
            face.map_or([0; 3], |k| category_color(k).rgb)
        })
    }

    /// Wrong pixels white, over a faint picture of what is right.
    fn map(&self, faces: &Faces) -> Picture {
        let truth = self.picture(&self.truth);
        Picture::from_fn(self.size.width, self.size.height, |x, y| {
            let pixel = (y * self.size.width + x) as usize;
            let faint = || truth.get(x, y).map(|channel| channel / 4);
            if faces[pixel] == self.truth[pixel] { faint() } else { [255; 3] }
        })
    }
}

/// A polygon's depth as the painter takes it, from those of its corners.
type Depth = fn([f64; 4]) -> f64;

/// What a view shows by one method, and the tests that took.
type Method = fn(&View) -> (Faces, u64);

/// The painters first.
const METHODS: [(&str, Method); 4] = [
    ("painter: centroid", |view| view.painted(&view.order(|z| z.iter().sum::<f64>() / 4.0))),
    ("painter: farthest corner", |view| {
        view.painted(&view.order(|z| z.into_iter().fold(0.0, f64::max)))
    }),
    ("rays: all polygons", |view| {
        let index = LinearScan::new(&view.scene);
        view.cast(|ray, counts| index.walk(Query::closest(ray, Interval::POSITIVE), counts))
    }),
    ("rays: tree", |view| {
        let index = ObvhsBvh2::build(&view.scene);
        view.cast(|ray, counts| index.walk(Query::closest(ray, Interval::POSITIVE), counts))
    }),
];
const PAINTERS: usize = 2;

const COLORS: [fn() -> Color; 4] = [
    || category_color(3),
    || category_color(5),
    || method_color("linear"),
    || method_color("obvhs-bvh2"),
];

/// All orders of the numbers below `count`.
fn orders(count: usize) -> Vec<Vec<usize>> {
    let mut orders = vec![Vec::new()];
    for next in 0..count {
        let longer = |order: &Vec<usize>| {
            let order = order.clone();
            (0..=next).map(move |place| {
                let mut order = order.clone();
                order.insert(place, next);
                order
            })
        };
        orders = orders.iter().flat_map(longer).collect();
    }
    orders
}

/// Soups of each number of squares.
const SOUPS: u32 = 4;

pub fn make(effort: Effort) -> Finished {
    let mut data = Table::new(["scene", "method", "polygons", "tests", "wrong_pixels_percent"]);
    let size = effort.pick(ImageSize::new(120, 60), ImageSize::new(480, 240));
    let designed = View::new(cycle_and_cross(), size);
    let drawn = METHODS.map(|(_, method)| method(&designed));
    let wrong = drawn.each_ref().map(|(faces, _)| designed.wrong(faces));
    for ((name, _), ((_, tests), wrong)) in METHODS.iter().zip(drawn.iter().zip(wrong)) {
        data.push(["cycle".into(), (*name).into(), 5_u32.into(), (*tests).into(), wrong.into()]);
    }
    let mut ranked: Vec<(f64, Faces)> = orders(designed.polygons.len())
        .iter()
        .map(|order| {
            let (faces, tests) = designed.painted(order);
            let wrong = designed.wrong(&faces);
            data.push([
                "cycle".into(),
                "an order".into(),
                5_u32.into(),
                tests.into(),
                wrong.into(),
            ]);
            (wrong, faces)
        })
        .collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (best, worst) = (&ranked[0], &ranked[ranked.len() - 1]);

    let size = effort.pick(ImageSize::new(60, 40), ImageSize::new(120, 80));
    let soups: Vec<Vec<View>> = effort
        .pick(&[10, 100][..], &[10, 100, 1000])
        .iter()
        .map(|&count| (0..SOUPS).map(|k| View::new(soup(count, k), size)).collect())
        .collect();
    let contenders = METHODS.iter().zip(COLORS).flat_map(|(&(name, method), color)| {
        soups.iter().map(move |views| Contender {
            curve: name.to_owned(),
            color: color(),
            knob: views[0].polygons.len(),
            run: Box::new(move || {
                let seen: Vec<_> = views.iter().map(method).collect();
                let wrong = views.iter().zip(&seen).map(|(view, (faces, _))| view.wrong(faces));
                let tests = seen.iter().map(|(_, tests)| tests).sum();
                (wrong.sum::<f64>() / f64::from(SOUPS), tests)
            }),
        })
    });
    let judge = |&wrong: &f64| vec![("wrong pixels (%)", wrong)];
    let study = Study::measure("tests", effort.runs(3), contenders, judge);
    let pixels = size.pixels() as f64 * f64::from(SOUPS);
    let mut growth = Chart::new(Axis::log("squares"), Axis::log("tests per pixel"))
        .title("What it costs: random squares")
        .height(360.0);
    let (mut least, mut most, mut by_rays) = (f64::INFINITY, 0.0_f64, wrong[2].max(wrong[3]));
    let mut dearer = 0.0_f64;
    for (k, ((name, _), color)) in METHODS.iter().zip(COLORS).enumerate() {
        let mut series = Series::new(*name, color());
        for views in &soups {
            let count = views[0].polygons.len();
            let trial = study.at(name, count);
            let (tests, wrong) = (trial.work, trial.outcome);
            series = series.point(count as f64, tests as f64 / pixels);
            data.push(["soup".into(), (*name).into(), count.into(), tests.into(), wrong.into()]);
            if k < PAINTERS {
                (least, most) = (least.min(wrong), most.max(wrong));
            } else {
                by_rays = by_rays.max(wrong);
            }
            if k == METHODS.len() - 1 {
                dearer = dearer.max(tests as f64 / study.at(METHODS[0].0, count).work as f64);
            }
        }
        // Both painters test the same triangles.
        growth = if k == 1 { growth } else { growth.series(series) };
    }

    let holds = by_rays == 0.0 && best.0.min(least) > 0.0;
    let claim = format!(
        "No order of painting is right: the best of all {} leaves {:.1} % of the pixels wrong, depth sorts of \
         random squares {least:.0} to {most:.0} %; a ray per pixel leaves {} %, for up to {dearer:.1} times \
         the tests through a tree.",
        ranked.len(),
        best.0,
        number(by_rays)
    );
    let tile = |title: &str, faces: &Faces| Tile::new(title, designed.picture(faces));
    let montage = Montage::new()
        .columns(2)
        .tile(tile("ray casting (Appel)", &drawn[3].0).color(method_color("appel")))
        .tile(tile(&format!("painter, the worst of all {} orders", ranked.len()), &worst.1))
        .tile(tile("painter, the best order", &best.1))
        .tile(Tile::new("white: wrong even in the best order", designed.map(&best.1)));
    let names = ["rays", "best order", "by centroid", "by farthest corner", "worst order"];
    let bars = BarChart::new("wrong pixels (%)", names).title("The five polygons above").series(
        "wrong",
        COLORS[0](),
        [wrong[3], best.0, wrong[0], wrong[1], worst.0],
    );
    // Strips cross in a parallelogram; the picture is 4 half heights wide and 2 high.
    let crossing = BAR * BAR / (TAU / 6.0).sin();
    let least_missed = 100.0 / 8.0 * (crossing + 0.5 * SHEET * SHEET / SHEETS_APART.sin());
    let clearance = soups.iter().flatten().map(|view| view.clearance);
    let plate = Plate::new("1.1", "Visible surfaces without an order", claim, holds)
        .panel(montage)
        .panel(Row::new().panel(1.0, bars).panel(1.0, growth))
        .panel(study.chart("wrong pixels (%)"))
        .note("Scene", "left: three bars, each over the next in a circle; right: two sheets that pass \
             through each other. Random squares face all directions and are smaller where they are more, so \
             that they stay as crowded; their number stands beside each point, four pictures each")
        .note("Method", "algo:appel's first step, the nearest hit of a ray through the pixel's centre, by \
             eq:ray-triangle; the painter asks the same test, for the pixels in each polygon's box on the \
             picture. Work counts triangle and box tests, not the sort and not the building of the tree")
        .note("Limits", "the painter does fewer tests than rays here, and errs. It prepares a ray \
             for each test, so its seconds could be fewer too. Newell, Newell and Sancha (1972) \
             repair its order by cutting polygons; a depth buffer (Catmull 1974) needs no order either, but \
             must project each shape: a ray only asks for an intersection")
        .note("Reference", format!(
            "closed form: of the outlines around a pixel's centre on the picture the one with the largest \
             1/depth, which is affine there; no centre is nearer to an outline than {} px. By area the best \
             order misses {least_missed:.2} %: a crossing of the bars, and half of what the sheets share",
            number(clearance.fold(designed.clearance, f64::min))
        ));
    Finished { plate, data }
}
