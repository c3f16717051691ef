//! 0.2: where a shadow ray starts: fixed distances fit some scales, the point's error bound all.

use glam::swizzles::Vec3Swizzles;
use glam::{DAffine3, DQuat, DVec2, DVec3, EulerRot};
use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Hit, Intersector};
use lancer_core::scene::{Camera, Material, MaterialId, Mesh, Scene};
use lancer_core::world::SurfacePoint;
use lancer_figure::{
    Axis, Chart, Color, Effort, Finished, Inset, Montage, Picture, Plate, Row, Series, Table, Tile,
    category_color, method_color, number,
};

use lancer_lesson::naive::{epsilon_shadow_ray, moeller_trumbore};

/// Where a shadow ray to a light starts.
type Start = fn(&SurfacePoint, DVec3) -> Ray;

/// The ways to start. The first is judged by Möller and Trumbore's test for any t > 0, the others by the index,
/// which drops hits below their own error.
const STARTS: [(&str, Start); 7] = [
    ("none (textbook hits)", |p, light| epsilon_shadow_ray(p, light, 0.0)),
    ("none", |p, light| epsilon_shadow_ray(p, light, 0.0)),
    ("ε = 10⁻⁶", |p, light| epsilon_shadow_ray(p, light, 1e-6)),
    ("ε = 10⁻⁴", |p, light| epsilon_shadow_ray(p, light, 1e-4)),
    ("ε = 10⁻²", |p, light| epsilon_shadow_ray(p, light, 1e-2)),
    ("10⁻⁶ max |p|", |p, light| {
        epsilon_shadow_ray(p, light, 1e-6 * p.position.abs().max_element())
    }),
    ("error bound", |p, light| p.spawn_to(light)),
];
const BOUNDED: usize = STARTS.len() - 1;

fn color(start: usize) -> Color {
    match start {
        0 => method_color("naive"),
        BOUNDED => category_color(2),
        1 | 2 => category_color(start - 1),
        _ => category_color(start),
    }
}

/// A level sheet over the floor: its middle, half its side and its height.
struct Sheet {
    middle: DVec2,
    half: f64,
    height: f64,
}

const fn sheet(x: f64, z: f64, height: f64) -> Sheet {
    Sheet { middle: DVec2::new(x, z), half: 0.24, height }
}

/// From left to right and from the back to the front ten times as high as the one before.
const SHEETS: [Sheet; 6] = [
    sheet(-0.64, -0.36, 3e-6),
    sheet(0.0, -0.36, 3e-5),
    sheet(0.64, -0.36, 3e-4),
    sheet(-0.64, 0.36, 3e-3),
    sheet(0.0, 0.36, 3e-2),
    sheet(0.64, 0.36, 3e-1),
];
/// Half the floor's sides.
const FLOOR: DVec2 = DVec2::new(1.1, 0.8);
/// Its cells along a side.
const CELLS: u32 = 12;
const LIGHT: DVec3 = DVec3::new(1.2, 1.6, -0.7);
const CAMERA: Camera = Camera {
    eye: DVec3::new(0.0, 2.9, 1.2),
    look_at: DVec3::new(0.0, 0.0, 0.08),
    up: DVec3::Y,
    fov: 29.5,
    lens: None,
};
/// Points nearer to the border of a shadow than this are not judged: far from the origin the scene's own
/// coordinates are rounded by up to 10⁻¹⁰ of its size.
const MARGIN: f64 = 1e-6;

/// How far `p` lies inside a rectangle seen from above; negative outside.
fn inside(middle: DVec2, half: DVec2, p: DVec3) -> f64 {
    (half - (p.xz() - middle).abs()).min_element()
}

/// How far a point of the floor lies inside the nearest shadow, measured at the height of its sheet; negative
/// in the light. By plane geometry.
fn shadow_depth(p: DVec3) -> f64 {
    let depths = SHEETS.iter().map(|sheet| {
        let crossing = p.lerp(LIGHT, sheet.height / LIGHT.y);
        inside(sheet.middle, DVec2::splat(sheet.half), crossing)
    });
    depths.fold(f64::NEG_INFINITY, f64::max)
}

/// Adds a level rectangle of `cells` by `cells` squares, cut into triangles.
fn push_level(mesh: &mut Mesh, middle: DVec2, half: DVec2, height: f64, cells: u32) {
    let first = mesh.positions.len() as u32;
    for (row, column) in (0..=cells).flat_map(|row| (0..=cells).map(move |column| (row, column))) {
        let part = DVec2::new(column.into(), row.into()) / f64::from(cells);
        let p = middle + half * (2.0 * part - 1.0);
        mesh.positions.push(DVec3::new(p.x, height, p.y));
    }
    for (row, column) in (0..cells).flat_map(|row| (0..cells).map(move |column| (row, column))) {
        let a = first + (cells + 1) * row + column;
        let [b, c, d] = [a + 1, a + cells + 1, a + cells + 2];
        mesh.push_face(MaterialId(0), &[[a, c, d], [a, d, b]]);
    }
}

/// A point of the floor that a pixel sees, and what there is to know about it.
struct Point {
    pixel: usize,
    ray: Ray,
    hit: Hit,
    shadowed: bool,
}

/// The scene at one scale and place.
pub(crate) struct Site {
    scene: Scene,
    light: DVec3,
    points: Vec<Point>,
    /// Pixels that see the floor too near to the border of a shadow.
    excluded: usize,
}

impl Site {
    /// The scene turned so that nothing is axis-aligned, `scale` times as large and `away` times its size
    /// from the origin, and what a picture of it sees. The eye sees the floor alone, through the sheets.
    pub(crate) fn new(scale: f64, away: f64, size: ImageSize) -> Self {
        let turn = DQuat::from_euler(EulerRot::XYZ, 0.4, 0.7, -0.3);
        let shift = scale * away * DVec3::new(0.48, -0.6, 0.64);
        let to_world = DAffine3::from_scale_rotation_translation(DVec3::splat(scale), turn, shift);
        let world = |local: &Mesh| Scene {
            camera: CAMERA,
            mesh: {
                let mut mesh = Mesh::default();
                mesh.append(local, to_world, 0);
                mesh
            },
            spheres: Vec::new(),
            motions: Vec::new(),
            materials: vec![Material::matte(Rgb::splat(0.7))],
            lights: Vec::new(),
            ambient: Rgb::ZERO,
            background: Rgb::ZERO,
        };
        let mut mesh = Mesh::default();
        push_level(&mut mesh, DVec2::ZERO, FLOOR, 0.0, CELLS);
        let floor = world(&mesh);
        for sheet in SHEETS {
            push_level(&mut mesh, sheet.middle, DVec2::splat(sheet.half), sheet.height, 1);
        }
        let light = to_world.transform_point3(LIGHT);
        let mut site = Self { scene: world(&mesh), light, points: Vec::new(), excluded: 0 };
        let index = ObvhsBvh2::build(&floor);
        let rays = CAMERA.primary_rays(size);
        for pixel in 0..size.pixels() {
            let [x, y] = [pixel as u32 % size.width, pixel as u32 / size.width].map(f64::from);
            let ray = rays.through(x + 0.5, y + 0.5);
            let p = ray.at(-ray.origin.y / ray.direction.y);
            let depth = shadow_depth(p);
            let on_floor = inside(DVec2::ZERO, FLOOR, p) > MARGIN;
            if !on_floor || depth.abs() < MARGIN {
                site.excluded += usize::from(on_floor);
                continue;
            }
            let origin = to_world.transform_point3(ray.origin);
            let ray = Ray::new(origin, to_world.transform_vector3(ray.direction));
            let hit = index.closest_hit(&ray, Interval::POSITIVE).expect("the floor has no hole");
            site.points.push(Point { pixel, ray, hit, shadowed: depth > 0.0 });
        }
        site
    }

    /// The shadow rays of all points.
    pub(super) fn shadow_rays(
        &self,
        start: impl Fn(&SurfacePoint, DVec3) -> Ray,
    ) -> impl Iterator<Item = Ray> {
        // The floor's triangles have the same numbers in the whole scene.
        let surface = |point: &Point| self.scene.surface_at(&point.ray, &point.hit);
        self.points.iter().map(move |point| start(&surface(point), self.light))
    }

    /// Whether each point is taken for dark.
    pub(crate) fn dark(&self, start: impl Fn(&SurfacePoint, DVec3) -> Ray) -> Vec<bool> {
        let index = ObvhsBvh2::build(&self.scene);
        self.shadow_rays(start).map(|ray| index.occluded(&ray, Interval::up_to(1.0))).collect()
    }

    /// The same by Möller and Trumbore's test.
    fn textbook_dark(&self, start: Start) -> Vec<bool> {
        let mesh = &self.scene.mesh;
        let meets = |ray: &Ray, k| moeller_trumbore(mesh.corners(k), ray).is_some_and(|t| t < 1.0);
        let dark = |ray: Ray| (0..mesh.triangles.len()).any(|k| meets(&ray, k));
        self.shadow_rays(start).map(dark).collect()
    }

    /// How many points are dark though the light shines there, and how many bright though in a shadow.
    pub(crate) fn wrong(&self, dark: &[bool]) -> [usize; 2] {
        [false, true].map(|shadowed| {
            let points = self.points.iter().zip(dark);
            points.filter(|(point, dark)| point.shadowed == shadowed && **dark != shadowed).count()
        })
    }

    /// The floor in grey; what is wrongly dark is red, what is wrongly bright is yellow.
    pub(crate) fn colors(&self, size: ImageSize, dark: &[bool]) -> Vec<[u8; 3]> {
        let mut pixels = vec![[255; 3]; size.pixels()];
        for (point, dark) in self.points.iter().zip(dark) {
            pixels[point.pixel] = match (*dark, point.shadowed) {
                (true, true) => [58, 60, 66],
                (false, false) => [190, 190, 186],
                (true, false) => [150, 0, 20],
                (false, true) => [255, 214, 40],
            };
        }
        pixels
    }
}

/// How many of its sizes the scene stands away from the origin, and what that is called.
const AWAY: [(f64, &str); 2] = [(0.0, "around the origin"), (1e6, "10⁶ sizes from the origin")];
const EXPONENTS: std::ops::RangeInclusive<i32> = -3..=6;
/// The pictures: sizes away, exponent of the scale, start.
const SHOWN: [(f64, i32, &str); 3] =
    [(1e6, 0, "none"), (1e6, 0, "ε = 10⁻²"), (1e6, 0, "error bound")];

pub fn make(effort: Effort) -> Finished {
    let size = effort.pick(ImageSize::new(96, 64), ImageSize::new(240, 160));
    let mut data = Table::new([
        "sizes_away",
        "scale",
        "offset",
        "points",
        "excluded",
        "wrongly_dark",
        "wrongly_bright",
    ]);
    let mut charts = Row::new();
    // Of each start the largest share of wrong points at any site, in per cent, and the sites without one.
    let (mut worst, mut right) = ([0.0_f64; STARTS.len()], [0; STARTS.len()]);
    let (mut points, mut excluded) = (0, 0);
    let inset = effort.pick(Inset::new(26, 38, 24, 16), Inset::new(66, 94, 60, 40));
    let mut pictures = Montage::new().columns(3).inset(inset);
    for (away, place) in AWAY {
        let mut series: Vec<Series> =
            (0..STARTS.len()).map(|k| Series::new(STARTS[k].0, color(k))).collect();
        for exponent in EXPONENTS {
            let scale = 10.0_f64.powi(exponent);
            let site = Site::new(scale, away, size);
            points += site.points.len();
            excluded += site.excluded;
            for (k, &(name, start)) in STARTS.iter().enumerate() {
                let dark = if k == 0 { site.textbook_dark(start) } else { site.dark(start) };
                let wrong = site.wrong(&dark);
                let share = wrong.map(|n| 100.0 * n as f64 / site.points.len() as f64);
                let both = share[0] + share[1];
                worst[k] = worst[k].max(both);
                right[k] += usize::from(both == 0.0);
                series[k] = series[k].clone().point(scale, both);
                let counts = [site.points.len(), site.excluded, wrong[0], wrong[1]];
                let names = [away.into(), scale.into(), name.into()];
                data.push(names.into_iter().chain(counts.map(Into::into)));
                if SHOWN.contains(&(away, exponent, name)) {
                    let title = format!("{name}: {both:.0} % wrong");
                    let picture = Picture::new(size.width, size.height, site.colors(size, &dark));
                    let tile = Tile::new(title, picture).color(color(k));
                    pictures = pictures.tile(tile);
                }
            }
        }
        let chart = Chart::new(
            Axis::log("scale of the scene"),
            Axis::linear("wrong shadow pixels (%)").include(0.0),
        );
        charts = charts.panel(1.0, series.into_iter().fold(chart.title(place), Chart::series));
    }
    let sites = AWAY.len() * EXPONENTS.count();
    let least = worst[..BOUNDED].iter().copied().fold(f64::INFINITY, f64::min);
    let holds = worst[BOUNDED] == 0.0 && least > 0.0;
    let claim = format!(
        "From scale 10⁻³ to 10⁶, at the origin and 10⁶ sizes away, the error bound has {} % wrong shadow \
         pixels; each other offset is wrong somewhere, in at least {least:.0} % of the pixels.",
        number(worst[BOUNDED]),
    );
    let counts: Vec<String> =
        STARTS.iter().zip(right).map(|((name, _), right)| format!("{name} {right}")).collect();
    let plate = Plate::new("0.2", "No epsilon fits every scale", claim, holds)
        .panel(pictures)
        .panel(charts)
        .note("Pictures", "scale 1, 10⁶ sizes from the origin: six level sheets over a tessellated floor, 3·10⁻⁶ (left, \
             back) to 0.3 (right, front) of its size high; the eye looks through them, light does not. Red: dark \
             though lit (acne); yellow: lit though in a shadow (leak)")
        .note("Method", "all start at the same point, whose corners' weights give it, and move it along the \
             normal; the index drops hits nearer than their own error bound, except for « textbook hits », \
             Möller and Trumbore's with t > 0")
        .note("Limits", format!(
            "sites of {sites} without a wrong pixel: {}. In 64 bits and near the origin a small ε is safe from \
             acne; the sheets, down to 3·10⁻⁶ of the scene, decide which ε leaks",
            counts.join(", ")
        ))
        .note("Reference", format!(
            "plane geometry; of {} pixels {excluded} are nearer than 10⁻⁶ to a shadow's border and not judged",
            points + excluded
        ));
    Finished { plate, data }
}
