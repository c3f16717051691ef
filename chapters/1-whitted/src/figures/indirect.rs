//! 1.9: a mirror lights the floor, and Whitted's method does not see it: lamps are aimed at directly.

use std::fmt;

use glam::{DVec2, DVec3};
use lancer_accel::ObvhsBvh2;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray};
use lancer_core::illumination::{Reflectance, attenuation, local};
use lancer_core::image::{Image, ImageSize};
use lancer_core::metric::rmse;
use lancer_core::optics::reflect;
use lancer_core::sampling::{Pattern, PixelSampling, Uniform};
use lancer_core::scene::{MaterialId, PrimaryRays, Scene};
use lancer_core::world::{SurfacePoint, World};
use lancer_figure::{
    Contender, Effort, Finished, HeatScale, Montage, Plate, Study, Tile, Trial, category_color,
    method_color, number,
};
use lancer_lesson::judge::{error_tile, errors_of, pixelwise};
use lancer_lesson::picture::{picture, shown};
use lancer_lesson::scenes::parsed;
use lancer_whitted::{RayCounts, Settings};

use super::trace_picture;

/// The mirror's lower corner, width and height, in the plane z = −1; it faces +z.
const CORNER: DVec3 = DVec3::new(-1.0, 0.05, -1.0);
const MIRROR: DVec2 = DVec2::new(2.0, 1.4);

const SCENE: &str = "
    background = [0.05, 0.06, 0.08]
    ambient = 0.05
    camera = { eye = [2.7, 2.3, 4.4], look_at = [0.1, 0.3, 0.2], fov = 42 }
    material.mirror = { k_s = 0.9 }
    material.floor = { rho_d = [0.62, 0.6, 0.56] }
    material.frame = { rho_d = 0.08 }
    material.ball = { rho_d = [0.75, 0.3, 0.1] }
    light = [{ position = [-0.9, 2.3, 0.9], intensity = 5 }]
    sphere = [{ center = [0.4, 0.32, 0.6], radius = 0.32, material = 'ball' }]
    [[polygon]]
    vertices = [[-1, 0.05, -1], [1, 0.05, -1], [1, 1.45, -1], [-1, 1.45, -1]]
    material = 'mirror'
    [[polygon]]
    vertices = [[-1.08, 0, -1.02], [1.08, 0, -1.02], [1.08, 1.53, -1.02], [-1.08, 1.53, -1.02]]
    material = 'frame'
    [[polygon]]
    vertices = [[-9, 0, 9], [9, 0, 9], [9, 0, -9], [-9, 0, -9]]
    material = 'floor'";

/// The scene with what its only mirror does to its only lamp.
struct Stage<'a> {
    world: World<'a>,
    mirror: MaterialId,
    lamp: DVec3,
    intensity: Rgb,
}

impl<'a> Stage<'a> {
    fn new(world: World<'a>) -> Self {
        let lamp = world.scene.lights[0];
        let faces = &world.scene.mesh.faces;
        Self { world, mirror: faces[0].material, lamp: lamp.position, intensity: lamp.intensity }
    }

    fn k_s(&self) -> Rgb {
        self.world.scene.material(self.mirror).k_s
    }

    fn surface(&self, ray: &Ray, rays: &mut u64) -> Option<SurfacePoint> {
        *rays += 1;
        let hit = self.world.index.closest_hit(ray, Interval::POSITIVE)?;
        Some(self.world.scene.surface_at(ray, &hit))
    }

    fn reaches(&self, surface: &SurfacePoint, target: DVec3, rays: &mut u64) -> bool {
        *rays += 1;
        !self.world.index.occluded(&surface.spawn_to(target), Interval::up_to(1.0))
    }

    /// Where the mirror ray towards the image of `point` meets the mirror, if nothing is in its way and
    /// the mirror sends it on to `point`.
    fn by_way_of_mirror(&self, surface: &SurfacePoint, point: DVec3, rays: &mut u64) -> bool {
        let mirrored = self.surface(&surface.spawn(image_of(point) - surface.position), rays);
        mirrored.is_some_and(|q| q.material == self.mirror && self.reaches(&q, point, rays))
    }

    fn diffuse(&self, surface: &SurfacePoint) -> Rgb {
        self.world.scene.reflectance(surface).diffuse
    }

    /// What the eye sees along a ray of the light that comes by way of the mirror: eq:local for the
    /// lamp's mirror image, wherever the mirror shows it.
    fn mirrored_light(&self, ray: &Ray, rays: &mut u64) -> Rgb {
        let Some(surface) = self.surface(ray, rays) else { return Rgb::ZERO };
        let n = surface.shading_normal_towards(-ray.direction);
        if surface.material == self.mirror {
            let seen = surface.spawn(reflect(ray.direction, n));
            return self.k_s() * self.mirrored_light(&seen, rays);
        }
        if !self.by_way_of_mirror(&surface, self.lamp, rays) {
            return Rgb::ZERO;
        }
        let to_image = image_of(self.lamp) - surface.position;
        let g = attenuation(true, to_image.length());
        let diffuse = self.diffuse(&surface);
        let matte = Reflectance { diffuse, specular: Rgb::ZERO, shininess: 1.0 };
        let reflected = local(&matte, n, to_image.normalize(), -ray.direction);
        self.k_s() * self.intensity * g * reflected
    }
}

/// The mirror image of a point.
fn image_of(point: DVec3) -> DVec3 {
    DVec3 { z: 2.0 * CORNER.z - point.z, ..point }
}

/// The light that leaves the lamp towards the mirror, followed forwards to the film.
struct Forward {
    /// Radiances, row by row.
    film: Vec<Rgb>,
    /// All rays cast.
    rays: u64,
    /// The solid angle of the mirror seen from the lamp, as the light rays found it.
    solid_angle: f64,
}

/// The film of one picture, and the eye before it.
struct Pinhole {
    rays: PrimaryRays,
    size: ImageSize,
    eye: DVec3,
}

impl Pinhole {
    /// The pixel on which a point is seen.
    fn pixel(&self, point: DVec3) -> Option<usize> {
        let at = self.rays.film_point(point)?.floor();
        let [width, height] = [self.size.width, self.size.height].map(f64::from);
        let inside = at.x >= 0.0 && at.x < width && at.y >= 0.0 && at.y < height;
        inside.then_some((at.y * width + at.x) as usize)
    }

    /// What light of unit power on a white surface of normal `n` at `point` adds to its pixel: the
    /// radiance of the surface that the pixel covers.
    fn splat(&self, point: DVec3, n: DVec3) -> f64 {
        let to_eye = self.eye - point;
        let direction = to_eye.normalize();
        n.dot(direction) / (to_eye.length_squared() * self.rays.solid_angle(-direction))
    }
}

/// Sends `count` light rays from the lamp to random points of the mirror, and connects the surfaces that
/// they meet then with the eye: directly, and by way of the mirror.
fn forward(stage: &Stage, pinhole: &Pinhole, count: u32) -> Forward {
    let mut radiances = vec![Rgb::ZERO; pinhole.size.pixels()];
    let (mut traced, mut solid_angle) = (0, 0.0);
    let mut random = Uniform::new(9, 0, 0);
    for _ in 0..count {
        let across = DVec2::new(random.number(), random.number()) * MIRROR;
        let to_mirror = CORNER + across.extend(0.0) - stage.lamp;
        let direction = to_mirror.normalize();
        let area = MIRROR.x * MIRROR.y / f64::from(count);
        let cone = area * direction.z.abs() / to_mirror.length_squared();
        let light = stage.surface(&Ray::new(stage.lamp, direction), &mut traced);
        let Some(mirror) = light.filter(|q| q.material == stage.mirror) else { continue };
        solid_angle += cone;
        let onwards = reflect(direction, DVec3::Z);
        let Some(surface) = stage.surface(&mirror.spawn(onwards), &mut traced) else { continue };
        let carried = stage.diffuse(&surface) * stage.k_s() * stage.intensity * cone;
        let n = surface.shading_normal_towards(-onwards);
        // The mirror shows the surface's image, whose normal is mirrored as well.
        let image = (image_of(surface.position), DVec3 { z: -n.z, ..n });
        for (by_mirror, (point, n)) in [(false, (surface.position, n)), (true, image)] {
            let Some(pixel) = pinhole.pixel(point).filter(|_| n.dot(pinhole.eye - point) > 0.0)
            else {
                continue;
            };
            let (visible, share) = if by_mirror {
                (stage.by_way_of_mirror(&surface, pinhole.eye, &mut traced), stage.k_s())
            } else {
                (stage.reaches(&surface, pinhole.eye, &mut traced), Rgb::ONE)
            };
            if visible {
                radiances[pixel] += carried * share * pinhole.splat(point, n);
            }
        }
    }
    Forward { film: radiances, rays: traced, solid_angle }
}

const WHITTED: &str = "Whitted";
const FORWARD: &str = "Whitted + light rays";
const SAMPLES: [u32; 3] = [1, 4, 16];
/// Of the contenders' samples.
const SEED: u64 = 5;

/// What a contender made.
struct Traced {
    image: Image,
    /// The samples per pixel of Whitted's part.
    samples: u32,
    solid_angle: f64,
}

/// What a picture is made with: samples of a pixel alone, or rays from the lamp as well.
#[derive(Clone, Copy, PartialEq)]
enum Knob {
    PerPixel(u32),
    FromLamp(u32),
}

impl fmt::Display for Knob {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PerPixel(samples) => write!(f, "{samples} per pixel"),
            Self::FromLamp(rays) => write!(f, "{rays} from the lamp"),
        }
    }
}

pub fn make(effort: Effort) -> Finished {
    let scene = parsed("indirect", SCENE);
    let index = ObvhsBvh2::build(&scene);
    let stage = Stage::new(World { scene: &scene, index: &index });
    let size = effort.pick(ImageSize::new(72, 54), ImageSize::new(400, 300));
    let pinhole = Pinhole { rays: scene.camera.primary_rays(size), size, eye: scene.camera.eye };
    let whitted = |scene: &Scene, samples, seed| {
        let sampling = PixelSampling { pattern: Pattern::Owen, samples, seed };
        let rendering = trace_picture::<RayCounts>(scene, Settings::default(), size, sampling);
        (rendering.image, rendering.counts.total())
    };
    // Its samples are not those of the contenders, so that no error is shared.
    let most = effort.pick(16, 32);
    let light_and_all = |seed| {
        let sampling = PixelSampling { pattern: Pattern::Owen, samples: most, seed };
        let radiance = |ray: &Ray, rays: &mut u64| stage.mirrored_light(ray, rays);
        let light = picture(&scene, size, sampling, radiance).image;
        let all = pixelwise(&whitted(&scene, most, seed).0, &light, |a, b| a + b);
        (light, all)
    };
    let (missing, reference) = light_and_all(101);
    let residual = rmse(&reference, &light_and_all(102).1).expect("pictures of one size");

    let run = |samples, light_rays| {
        let (image, rays) = whitted(&scene, samples, SEED);
        if light_rays == 0 {
            return (Traced { image, samples, solid_angle: f64::NAN }, rays);
        }
        let light = forward(&stage, &pinhole, light_rays);
        let radiances = light.film.iter().map(|radiance| radiance.as_vec3().to_array());
        let image = pixelwise(&image, &Image::from_pixels(size, radiances.collect()), |a, b| a + b);
        (Traced { image, samples, solid_angle: light.solid_angle }, rays + light.rays)
    };
    let settings =
        SAMPLES.map(|samples| (WHITTED, method_color("whitted"), samples, 0)).into_iter();
    let light_rays = effort.pick([1 << 8, 1 << 12, 1 << 16], [1 << 14, 1 << 17, 1 << 20]);
    let settings =
        settings.chain(light_rays.map(|count| (FORWARD, category_color(3), SAMPLES[1], count)));
    let contenders = settings.map(|(label, color, samples, light_rays)| Contender {
        curve: label.to_owned(),
        color,
        knob: match light_rays {
            0 => Knob::PerPixel(samples),
            _ => Knob::FromLamp(light_rays),
        },
        run: Box::new(move || run(samples, light_rays)),
    });

    // What the mirror adds to a picture beside itself, as a share of what it should add.
    let beside = beside_the_mirror(&pinhole);
    let mut blind = scene.clone();
    blind.materials[stage.mirror.0 as usize].k_s = Rgb::ZERO;
    let total =
        |image: &Image| beside.iter().map(|&[x, y]| image.get(x, y).element_sum()).sum::<f64>();
    let share = |outcome: &Traced| {
        let without = whitted(&blind, outcome.samples, SEED).0;
        total(&pixelwise(&outcome.image, &without, |a, b| a - b)) / total(&missing)
    };
    let study = Study::measure("rays", effort.runs(3), contenders, |outcome: &Traced| {
        let errors = errors_of(&reference, &outcome.image);
        let more = [("mirrored_light", share(outcome)), ("solid_angle", outcome.solid_angle)];
        errors.into_iter().chain(more).collect()
    });

    let by_whitted = SAMPLES.map(|samples| study.at(WHITTED, Knob::PerPixel(samples)));
    let forward = light_rays.map(|count| study.at(FORWARD, Knob::FromLamp(count)));
    let (whitted, many) = (by_whitted[2], forward[2]);
    let shares = by_whitted.map(|trial| trial.error("mirrored_light"));
    let found = many.error("mirrored_light");
    let holds = shares == [0.0; 3] && (found - 1.0).abs() < 0.05;
    let claim = format!(
        "Of the light that the mirror sends to the floor and to the ball, Whitted's picture has {} %, with \
         1 sample per pixel or with 16; rays followed from the lamp bring {:.1} % of it.",
        number(100.0 * shares[2]),
        100.0 * found,
    );

    let tile = |trial: &Trial<Knob, Traced>| {
        let error = number(trial.error("RMSE"));
        Tile::new(&trial.curve, shown(&trial.outcome.image))
            .subtitle(format!("{}, RMSE {error}", trial.knob))
            .color(trial.color)
    };
    let pictures = Montage::new().tile(tile(whitted)).tile(tile(many)).tile(
        Tile::new("reference", shown(&reference))
            .color(method_color("reference"))
            .subtitle("closed form"),
    );
    let scale = HeatScale::log("|error|", 1e-3, 1.0);
    let errors = |title: String, trial: &Trial<Knob, Traced>| {
        error_tile(title, &scale, &reference, &trial.outcome.image)
    };
    let maps = Montage::new()
        .tile(errors("error: Whitted".to_owned(), whitted))
        .tile(errors(format!("error: {} light rays", light_rays[1]), forward[1]))
        .tile(errors(format!("error: {} light rays", light_rays[2]), many))
        .color_bar(&scale);
    let plate = Plate::new("1.9", "A mirror that lights nothing", claim, holds)
        .panel(pictures)
        .panel(maps)
        .panel(study.chart("RMSE").slope(-0.5, "slope −1/2, random").reference_error(residual))
        .note("« Pas d'éclairage indirect »", "the lamps are aimed at directly: a surface asks for the lamp, \
             never for the lamp's image in a mirror, and more samples ask the same question again")
        .note("Equal error", study.at_equal_error("RMSE", 0.02, size.pixels() as f64, "rays per pixel"))
        .note("Method", format!(
            "algo:lr; light rays start at the lamp towards random points of the mirror, and where they end \
             a ray is cast to the eye, directly and by way of the mirror, on one thread; {} samples per pixel for \
             the rest, on all", SAMPLES[1]
        ))
        .note("Reference", format!(
            "closed form: a plane mirror's light is eq:local for the lamp's image behind it, times k_s, where the \
             mirror shows it; {most} samples per pixel, whose own RMSE is {}", number(residual)
        ));
    Finished { plate, data: study.table() }
}

/// The pixels on which the mirror is not seen.
fn beside_the_mirror(pinhole: &Pinhole) -> Vec<[u32; 2]> {
    let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|corner| {
        let seen = pinhole.rays.film_point(CORNER + (corner * MIRROR).extend(0.0));
        seen.expect("the mirror is before the camera")
    });
    let low = corners.into_iter().fold(DVec2::INFINITY, DVec2::min);
    let high = corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
    let pixels =
        (0..pinhole.size.height).flat_map(|y| (0..pinhole.size.width).map(move |x| [x, y]));
    let is_beside = |[x, y]: [u32; 2]| {
        let corner = DVec2::new(f64::from(x), f64::from(y));
        (corner + 1.0).cmplt(low).any() || corner.cmpgt(high).any()
    };
    pixels.filter(|&pixel| is_beside(pixel)).collect()
}
