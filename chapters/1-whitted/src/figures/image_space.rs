//! 1.14: light is computed for pixels: the next frame computes it all again.

use std::ops::AddAssign;

use glam::DVec3;
use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::image::ImageSize;
use lancer_core::render::Rendering;
use lancer_core::sampling::PixelSampling;
use lancer_core::scene::{Camera, FaceId, Material, Scene};
use lancer_core::world::World;
use lancer_figure::{
    Axis, BarChart, Chart, Effort, Finished, Montage, Plate, Row, Series, Table, Tile,
    category_color, method_color, number,
};
use lancer_whitted::{Appel, RayCounts, Settings};

use super::{picture, shown, whitted_picture};
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
    /// Points that the second frame's primary rays meet.
    points: u64,
    /// Those on a face that the first frame saw in the pixel they fall into, and not hidden from its eye.
    seen: u64,
    /// Those of them whose ambient term, diffuse light and shadows are the same from both eyes.
    same: u64,
    /// Shadow rays from the points, and those from the `same` ones.
    shadows: [u64; 2],
    /// Over the `same` points: the square of what the first frame's pixel is off, all channels.
    stored_error: f64,
}

impl AddAssign for Known {
    fn add_assign(&mut self, other: Self) {
        self.points += other.points;
        self.seen += other.seen;
        self.same += other.same;
        self.shadows[0] += other.shadows[0];
        self.shadows[1] += other.shadows[1];
        self.stored_error += other.stored_error;
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

/// Looks from a second camera for what the scene's own has seen already. The picture is the known light in
/// grey, and the newly seen points in vermilion.
fn known(scene: &Scene, second: Camera, size: ImageSize) -> Rendering<Known> {
    let (matte, second) = (matte(scene), Scene { camera: second, ..scene.clone() });
    let index = ObvhsBvh2::build(&second);
    let (world, flat) =
        (World { scene: &second, index: &index }, World { scene: &matte, index: &index });
    let (whole, diffuse) = (Appel::new(world), Appel::new(flat));
    let first = scene.camera.primary_rays(size);
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    picture(&second, size, PixelSampling::CENTER, |ray, known: &mut Known| {
        let mut rays = RayCounts::default();
        whole.trace(ray, &mut rays);
        let Some((face, point)) = visible(world, ray) else { return Rgb::ZERO };
        known.points += 1;
        known.shadows[0] += rays.shadow;
        let stored = first.film_point(point).filter(|film| {
            film.cmpge(glam::DVec2::ZERO).all() && film.x < width && film.y < height
        });
        let again = Ray::new(scene.camera.eye, (point - scene.camera.eye).normalize());
        let sees = |ray: &Ray| visible(world, ray).is_some_and(|(other, _)| other == face);
        let stored = stored.map(|film| first.through(film.x.floor() + 0.5, film.y.floor() + 0.5));
        let Some(stored) = stored.filter(|stored| sees(stored) && sees(&again)) else {
            return VERMILION;
        };
        known.seen += 1;
        let light = diffuse.trace(ray, &mut ());
        if (diffuse.trace(&again, &mut ()) - light).abs().max_element() < SAME {
            known.same += 1;
            known.shadows[1] += rays.shadow;
            known.stored_error += (diffuse.trace(&stored, &mut ()) - light).length_squared();
        }
        Rgb::splat(light.element_sum() / 3.0)
    })
}

/// Radiances that differ by less are the same but for rounding.
const SAME: f64 = 1e-9;
/// The linear radiance of the marks: category 3 of the palette.
const VERMILION: Rgb = Rgb::new(0.665, 0.112, 0.0);

pub fn make(effort: Effort) -> Finished {
    let scene = scenes::room();
    let size = effort.pick(ImageSize::new(64, 48), ImageSize::new(320, 240));
    let pixel = 2.0 * (0.5 * scene.camera.fov.to_radians()).tan() / f64::from(size.height);
    let frame = |camera: Camera, size: ImageSize| {
        whitted_picture(&Scene { camera, ..scene.clone() }, Settings::default(), size)
    };
    let first = frame(scene.camera, size);

    let mut data = Table::new([
        "motion",
        "pixels",
        "points",
        "seen",
        "same_light",
        "shadow_rays",
        "shadow_rays_same",
        "rays",
        "primary_rays",
        "mirror_rays",
    ]);
    let mut shares = Chart::new(
        Axis::log("camera step (pixels)"),
        Axis::linear("points of the next frame (%)").between(0.0, 100.0),
    )
    .title("Known from the frame before")
    .height(420.0);
    let steps: &[f64] = effort.pick(&STEPS[..5], &STEPS);
    let mut at_one = None;
    let mut marks = Vec::new();
    // The share of the visible points that took no ray of their own.
    let mut untraced = Vec::new();
    let mut falls = true;
    for (k, (name, motion)) in MOTIONS.iter().enumerate() {
        let mut series = Series::new(*name, category_color([2, 1][k]));
        let mut before = 1.0;
        for &pixels in steps {
            let camera = motion(&scene.camera, pixels, pixel);
            let (second, seen) = (frame(camera, size), known(&scene, camera, size));
            let Known { points, seen: met, same, shadows, .. } = seen.counts;
            let share = same as f64 / points as f64;
            falls &= share <= before;
            before = share;
            series = series.point(pixels, 100.0 * share);
            data.push([
                (*name).into(),
                pixels.into(),
                points.into(),
                met.into(),
                same.into(),
                shadows[0].into(),
                shadows[1].into(),
                second.counts.total().into(),
                second.counts.primary.into(),
                second.counts.mirror.into(),
            ]);
            if k == 0 && (pixels == 1.0 || pixels == 8.0) {
                marks.push((pixels, share, seen.image.clone()));
            }
            if k == 0 {
                let traced = second.counts.primary as f64 / points as f64;
                untraced.push((pixels, 100.0 * (1.0 - traced)));
            }
            if k == 0 && pixels == 1.0 {
                at_one = Some((second, seen.counts));
            }
        }
        shares = shares.series(series);
    }
    let reused = Series::new("reused by algo:lr", method_color("whitted")).points(untraced.clone());
    shares = shares.series(reused);
    let (second, Known { points, seen, same, shadows, stored_error }) =
        at_one.expect("one pixel is among the steps");
    let share = same as f64 / points as f64;
    let again = frame(scene.camera, size);

    let side = effort.pick(16, 40);
    let sizes = [1, 2, 4, 8].map(|k| ImageSize::new(side * k, side * k * 3 / 4));
    let growth =
        sizes.map(|size| (size.pixels() as f64, frame(scene.camera, size).counts.total() as f64));
    let slope = (growth[3].1 / growth[0].1).ln() / (growth[3].0 / growth[0].0).ln();
    let work = Chart::new(Axis::log("pixels"), Axis::log("rays"))
        .title("The same light, on larger pictures")
        .series(Series::new("algo:lr", method_color("whitted")).points(growth))
        .slope(1.0, "slope 1")
        .height(420.0);

    let holds = again == first
        && untraced.iter().all(|(_, share)| *share == 0.0)
        && falls
        && same as f64 >= 0.999 * seen as f64
        && share > 0.9
        && (slope - 1.0).abs() < 0.02;
    let rays = second.counts;
    let claim = format!(
        "After a step of one pixel the last frame has computed the diffuse light of {:.1} % of the points now \
         seen, with {:.1} % of their shadow rays; algo:lr keeps none of it and traces all {} rays again.",
        100.0 * share,
        100.0 * shadows[1] as f64 / shadows[0] as f64,
        rays.total()
    );

    let mut montage = Montage::new().tile(
        Tile::new("first frame", shown(&first.image))
            .subtitle(format!("{} rays traced; the second: {}", first.counts.total(), rays.total()))
            .color(method_color("whitted")),
    );
    for (pixels, share, image) in &marks {
        montage = montage.tile(
            Tile::new(format!("newly seen after {pixels} px"), shown(image))
                .subtitle(format!("grey: the {:.1} % whose light was known", 100.0 * share))
                .color(category_color(3)),
        );
    }
    let rest = rays.total() - points - shadows[0];
    let bars = BarChart::new(
        "rays of the second frame, a step of one pixel",
        ["from the eye", "their shadow rays", "mirror rays and theirs"],
    )
    .title("What could be kept")
    .series("known before", category_color(2), [same, shadows[1], 0].map(|n| n as f64))
    .series("traced", method_color("whitted"), [points, shadows[0], rest].map(|n| n as f64));
    let plate = Plate::new("1.14", "Light computed in image space", claim, holds)
        .panel(montage)
        .panel(Row::new().panel(1.0, shares).panel(1.0, work))
        .panel(Row::new().panel(1.0, bars))
        .note("Method", "« recalculée pour chaque image »: algo:lr has no memory between frames; asked twice for \
             the same frame it traces the same rays for the same bits. A point is known if the pixel it falls \
             into in the first frame shows its face, nothing hides it from the first eye, and eq:ambient and \
             the diffuse part of eq:local with vis(i) are equal from both eyes, to 10⁻⁹")
        .note("Limits", format!(
            "what could be kept is a bound. Highlights, mirrors and glass depend on the eye; a point known \
             before must still be found, by projecting it; and a pixel stores the light of its centre, not of \
             the point, which is off by {} (RMSE). Lights and objects at rest; plane faces, matte but for the \
             mirror",
            number((stored_error / (3.0 * same as f64)).sqrt())
        ))
        .note("Settings", format!(
            "scene room, {size}, 1 sample per pixel; a step moves the middle of the picture by so many pixels; \
             rays grow with the power {slope:.3} of the pixels"
        ))
        .note("Reference", "counts, and the same light computed from the other eye");
    Finished { plate, data }
}
