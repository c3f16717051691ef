//! 1.14: light is computed for pixels: the next frame computes it all again.

use std::ops::AddAssign;

use glam::{DVec2, DVec3};
use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::ImageSize;
use lancer_core::render::Rendering;
use lancer_core::sampling::PixelSampling;
use lancer_core::scene::{Camera, FaceId, Material, Scene};
use lancer_core::world::World;
use lancer_figure::{
    Axis, BarChart, Chart, Effort, Finished, Montage, Plate, Row, Series, Table, Tile, Value,
    category_color, method_color, number,
};
use lancer_lesson::judge::fitted_exponent;
use lancer_lesson::picture::{picture, shown};
use lancer_whitted::{Appel, RayCounts, Settings};

use super::whitted_picture;
use crate::scenes;

/// A way to move the camera by so many pixels.
type Motion = fn(&Camera, f64, f64) -> Camera;

/// The motions: the picture's middle moves by `pixels` of the width `pixel`, on the plane at distance 1.
const MOTIONS: [(&str, Motion); 2] = [
    ("to the side", |camera, pixels, pixel| {
        let ahead = camera.look_at - camera.eye;
        let step = pixels * pixel * ahead.length() * ahead.cross(camera.up).normalize();
        Camera { eye: camera.eye + step, look_at: camera.look_at + step, ..*camera }
    }),
    ("turned", |camera, pixels, pixel| {
        let ahead = camera.look_at - camera.eye;
        let aside = pixels * pixel * ahead.length() * ahead.cross(camera.up).normalize();
        Camera { look_at: camera.look_at + aside, ..*camera }
    }),
];

/// How far the camera moves, in pixels.
const STEPS: [f64; 7] = [0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];

/// What the first frame knew of the second one's visible points.
#[derive(Clone, Copy, Debug, Default)]
struct Known {
    /// Points of matte surfaces that the second frame's primary rays meet.
    points: u64,
    /// Those on a face that the first frame saw in the pixel they fall into, and not hidden from its eye.
    seen: u64,
    /// Those of them whose light that pixel holds, up to [`CLOSE`].
    held: u64,
    /// Shadow rays from the points, and those from the held ones.
    shadows: [u64; 2],
}

impl AddAssign for Known {
    fn add_assign(&mut self, other: Self) {
        self.points += other.points;
        self.seen += other.seen;
        self.held += other.held;
        self.shadows[0] += other.shadows[0];
        self.shadows[1] += other.shadows[1];
    }
}

/// The scene without highlights, mirrors and glass: the light that does not depend on the eye.
fn matte(scene: &Scene) -> Scene {
    let matte = |material: &Material| Material {
        rho_s: Rgb::ZERO,
        k_s: Rgb::ZERO,
        k_t: Rgb::ZERO,
        ..*material
    };
    Scene { materials: scene.materials.iter().map(matte).collect(), ..scene.clone() }
}

/// The first visible face, and the point of it.
fn visible(world: World, ray: &Ray) -> Option<(FaceId, DVec3)> {
    let hit = world.index.closest_hit(ray, Interval::POSITIVE)?;
    let triangle = world.scene.mesh.triangles[hit.primitive.0 as usize];
    Some((triangle.face, world.scene.surface_at(ray, &hit).position))
}

/// Looks from a second camera for what the scene's own has seen already. The picture is the held light in
/// grey, and in vermilion the points that are newly seen or in another light; mirrors are black.
fn known(scene: &Scene, second: Camera, size: ImageSize) -> Rendering<Known> {
    let (matte, second) = (matte(scene), Scene { camera: second, ..scene.clone() });
    let index = ObvhsBvh2::build(&second);
    let (world, flat) =
        (World { scene: &second, index: &index }, World { scene: &matte, index: &index });
    let (whole, diffuse) = (Appel::new(world), Appel::new(flat));
    let first = scene.camera.primary_rays(size);
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let vermilion = Rgb::from(category_color(3).linear());
    picture(&second, size, PixelSampling::CENTER, |ray, known: &mut Known| {
        let Some((face, point)) = visible(world, ray) else { return Rgb::ZERO };
        if scene.material(scene.mesh.faces[face.0 as usize].material).k_s != Rgb::ZERO {
            return Rgb::ZERO;
        }
        let mut rays = RayCounts::default();
        whole.trace(ray, &mut rays);
        known.points += 1;
        known.shadows[0] += rays.shadow;
        let film = first
            .film_point(point)
            .filter(|film| film.cmpge(DVec2::ZERO).all() && film.x < width && film.y < height);
        let sees = |ray: &Ray| visible(world, ray).is_some_and(|(other, _)| other == face);
        let to_point = Ray::new(scene.camera.eye, (point - scene.camera.eye).normalize());
        let pixel = film.map(|film| first.through(film.x.floor() + 0.5, film.y.floor() + 0.5));
        let Some(pixel) = pixel.filter(|pixel| sees(pixel) && sees(&to_point)) else {
            return vermilion;
        };
        known.seen += 1;
        let light = diffuse.trace(ray, &mut ());
        let stored = diffuse.trace(&pixel, &mut ());
        if (stored - light).abs().max_element() > CLOSE * light.max_element() {
            return vermilion;
        }
        known.held += 1;
        known.shadows[1] += rays.shadow;
        Rgb::splat(light.element_sum() / 3.0)
    })
}

/// Light that differs by less than this part would not be noticed.
const CLOSE: f64 = 0.02;

pub fn make(effort: Effort) -> Finished {
    let scene = scenes::room();
    let size = effort.pick(ImageSize::new(64, 48), ImageSize::new(320, 240));
    let pixel = 2.0 * (0.5 * scene.camera.fov.to_radians()).tan() / f64::from(size.height);
    let frame = |camera: Camera, size: ImageSize| {
        whitted_picture(&Scene { camera, ..scene.clone() }, Settings::default(), size)
    };
    let first = frame(scene.camera, size);

    let columns =
        ["motion", "pixels", "points", "seen", "held", "shadow_rays", "shadow_rays_held", "rays"];
    let mut data = Table::new(columns);
    let mut shares = Chart::new(
        Axis::log("camera step (pixels)"),
        Axis::linear("points of the next frame (%)").between(0.0, 100.0),
    )
    .title("Light that the frame before holds")
    .height(420.0);
    let steps: &[f64] = effort.pick(&STEPS[..5], &STEPS);
    let mut at_one = None;
    let mut marks = Vec::new();
    let mut falls = true;
    for (k, (name, motion)) in MOTIONS.iter().enumerate() {
        let mut series = Series::new(*name, category_color([2, 1][k]));
        let mut before = 1.0;
        for &pixels in steps {
            let camera = motion(&scene.camera, pixels, pixel);
            let (second, looked) = (frame(camera, size), known(&scene, camera, size));
            let Known { points, seen, held, shadows } = looked.counts;
            let share = held as f64 / points as f64;
            falls &= share <= before;
            before = share;
            series = series.point(pixels, 100.0 * share);
            let counts = [points, seen, held, shadows[0], shadows[1], second.counts.total()];
            let names = [Value::from(*name), pixels.into()];
            data.push(names.into_iter().chain(counts.map(Value::from)));
            if k == 0 && (pixels == 1.0 || pixels == 8.0) {
                marks.push((pixels, share, looked.image.clone()));
            }
            if k == 0 && pixels == 1.0 {
                at_one = Some((second, looked.counts));
            }
        }
        shares = shares.series(series);
    }
    let (second, Known { points, held, shadows, .. }) =
        at_one.expect("one pixel is among the steps");
    let share = held as f64 / points as f64;

    let side = effort.pick(16, 40);
    let sizes = [1, 2, 4, 8].map(|k| ImageSize::new(side * k, side * k * 3 / 4));
    let growth =
        sizes.map(|size| (size.pixels() as f64, frame(scene.camera, size).counts.total() as f64));
    let slope = fitted_exponent(&growth);
    let work = Chart::new(Axis::log("pixels"), Axis::log("rays"))
        .title("The same light, on larger pictures")
        .series(Series::new("algo:lr", method_color("whitted")).points(growth))
        .slope(1.0, "slope 1")
        .height(420.0);

    let rays = second.counts;
    let again = rays.total() as f64 / first.counts.total() as f64;
    let holds = falls && share > 0.5 && again > 0.9 && (slope - 1.0).abs() < 0.02;
    let claim = format!(
        "After a step of one pixel the last frame holds the light of {:.1} % of the matte points now seen, to {} %; \
         algo:lr traces {} rays all the same, after the {} of the last frame.",
        100.0 * share,
        number(100.0 * CLOSE),
        rays.total(),
        first.counts.total(),
    );

    let mut montage = Montage::new().tile(
        Tile::new("first frame", shown(&first.image))
            .subtitle(format!("{} rays", first.counts.total()))
            .color(method_color("whitted")),
    );
    for (pixels, share, image) in &marks {
        montage = montage.tile(
            Tile::new(format!("new after {pixels} px"), shown(image))
                .subtitle(format!(
                    "grey: the {:.1} % whose light was held; black: the mirror",
                    100.0 * share
                ))
                .color(category_color(3)),
        );
    }
    let rest = rays.total() - points - shadows[0];
    let bars = BarChart::new(
        "rays of the second frame, a step of one pixel",
        ["to matte points", "their shadow rays", "of the mirror"],
    )
    .title("What could be kept")
    .series("held before", category_color(2), [held, shadows[1], 0].map(|n| n as f64))
    .series("traced", method_color("whitted"), [points, shadows[0], rest].map(|n| n as f64));
    let plate = Plate::new("1.14", "Light computed in image space", claim, holds)
        .panel(montage)
        .panel(Row::new().panel(1.0, shares).panel(1.0, work))
        .panel(Row::new().panel(1.0, bars))
        .note("Method", "« recalculée pour chaque image »: algo:lr keeps nothing between frames. A point is held if \
             the pixel it falls into in the last frame shows its face, nothing hides it from the last eye, and \
             eq:ambient with the diffuse part of eq:local and vis(i) at that pixel's centre is close to its own")
        .note("Limits", "what could be kept is a bound. Highlights, mirrors and glass depend on the eye; a point \
             known before must still be found, by projecting it. Lights and objects are at rest, faces plane")
        .note("Settings", format!(
            "scene room, {size}, 1 sample per pixel; a step moves the middle of the picture by so many pixels; \
             rays grow with the power {slope:.3} of the pixels"
        ))
        .note("Reference", "counts, and each point's own light");
    Finished { plate, data }
}
