//! Cook's effects against closed forms: the lens, motion, gloss, and spheres that are lamps.

use std::f64::consts::PI;

use glam::{DMat3, DVec2, DVec3};
use lancer_accel::Wide;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray, Sphere};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Intersector, LinearScan};
use lancer_core::method::{BuildIndex, Method, Order, Strategy};
use lancer_core::moving::{Moment, Moving};
use lancer_core::render::{Control, Estimator};
use lancer_core::sampling::{Estimate, Pattern, PixelSampling, Sample};
use lancer_core::scene::{
    Camera, Lens, Material, MaterialId, Mesh, Motion, Part, Pigment, PointLight, Scene,
    SphereObject, Subset,
};
use lancer_distributed::{Distributed, Eye, PathSettings, PathTracer, RayCounts, Settings};

use crate::statistics::{Z, agrees, grey, independent, replicated};

const LINEAR: &BuildIndex = &|primitives| Box::new(LinearScan::new(primitives));

/// Which method shades.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Distributed,
    Path(Strategy),
}

const WAYS: [Way; 4] = [
    Way::Distributed,
    Way::Path(Strategy::Lamp),
    Way::Path(Strategy::Lobe),
    Way::Path(Strategy::Mis),
];

/// What comes back along `ray`, by samples whose ray and first hit are known: nothing in front of it moves.
fn along<T>(scene: &Scene, way: Way, ray: Ray, run: impl Fn(&dyn Fn(&Sample) -> f64) -> T) -> T {
    let moving = Moving::new(scene, LINEAR);
    let world = Moment::from(&moving);
    let hit = world.closest_hit(&ray, Interval::POSITIVE);
    let rays = || RayCounts::default();
    match way {
        Way::Distributed => {
            let method = Distributed::new(world, Settings::default());
            run(&|sample| grey(method.shade(&ray, hit, None, sample, &mut rays())))
        }
        Way::Path(strategy) => {
            let settings = PathSettings { max_depth: Some(1), strategy, ..PathSettings::default() };
            let method = PathTracer::new(world, settings);
            run(&|sample| grey(method.shade(&ray, hit, None, sample, &mut rays())))
        }
    }
}

/// What the camera sees at a film point, by samples that are drawn over the lens and the shutter.
fn seen(scene: &Scene, size: ImageSize, film: DVec2, samples: u32) -> Estimate {
    let moving = Moving::new(scene, LINEAR);
    let method = Distributed::new(&moving, Settings::default());
    let eye = Eye::new(&moving, size, Pattern::Regular, |ray, hit, emission, sample, rays| {
        method.shade(ray, hit, emission, sample, rays)
    });
    replicated(samples, 3, |sample| {
        let mut radiance = [Rgb::ZERO];
        eye.radiance(&[Sample { film, ..*sample }], &mut radiance, &mut RayCounts::default());
        grey(radiance[0])
    })
}

fn lamp_material() -> Material {
    Material { emission: Rgb::ONE, ..Material::matte(Rgb::ZERO) }
}

fn quad(mesh: &mut Mesh, material: u32, [corner, first, second]: [DVec3; 3]) {
    let k = mesh.positions.len() as u32;
    mesh.positions.extend([corner, corner + first, corner + first + second, corner + second]);
    mesh.push_face(MaterialId(material), &[[k, k + 1, k + 2], [k, k + 2, k + 3]]);
}

/// The material 0 is white, 1 emits 1; the eye is at the origin and looks along −z, at depth 1 a picture of 100 pixels
/// is 2 high.
fn empty() -> Scene {
    Scene {
        camera: Camera {
            eye: DVec3::ZERO,
            look_at: DVec3::NEG_Z,
            up: DVec3::Y,
            fov: 90.0,
            lens: None,
        },
        materials: vec![Material::matte(Rgb::ONE), lamp_material()],
        ..Scene::of_mesh(Mesh::default())
    }
}

fn sphere(center: DVec3, radius: f64, material: u32) -> SphereObject {
    SphereObject { shape: Sphere { center, radius }, material: MaterialId(material) }
}

/// An emitting half-plane x > 0, up to its size, at this depth.
fn half_plane(depth: f64) -> Scene {
    let mut scene = empty();
    let corner = DVec3::new(0.0, -50.0, -depth);
    quad(&mut scene.mesh, 1, [corner, 100.0 * DVec3::X, 100.0 * DVec3::Y]);
    scene
}

/// The edge of what is out of focus: ½ + (s √(1 − s²) + asin s)/π at s blur radii from it, each r |1/f − 1/z| on the film.
#[test]
fn an_edge_is_blurred_by_the_lens() {
    let size = ImageSize::new(100, 100);
    let profile = [
        (-0.75, 0.072146806407),
        (-0.5, 0.195501109478),
        (0.0, 0.5),
        (0.5, 0.804498890522),
        (0.75, 0.927853193593),
    ];
    for (depth, blur) in [(2.0, 0.025), (3.0, 0.1 / 12.0), (8.0, 0.0125), (1e6, 0.025 - 1e-7)] {
        let mut scene = half_plane(depth);
        if depth > 100.0 {
            scene.mesh.positions.iter_mut().for_each(|p| (p.x, p.y) = (depth * p.x, depth * p.y));
        }
        scene.camera.lens = Some(Lens { radius: 0.1, focus: 4.0 });
        for (s, share) in profile {
            let film = DVec2::new(50.0 + 50.0 * blur * s, 47.3);
            let estimate = seen(&scene, size, film, 256);
            assert!(agrees(&estimate, share), "{depth}, {s}: {estimate:?}, {share}");
        }
    }
    // In focus it is sharp.
    let mut scene = half_plane(4.0);
    scene.camera.lens = Some(Lens { radius: 0.1, focus: 4.0 });
    for (aside, share) in [(-1e-9, 0.0), (1e-9, 1.0)] {
        let estimate = seen(&scene, size, DVec2::new(50.0 + aside, 47.3), 16);
        assert_eq!((estimate.mean(), estimate.variance()), (share, 0.0));
    }
    // A beginner's lens, points of which gather in the middle, is caught.
    let naive = replicated(256, 3, |sample| {
        let [u, v, ..] = sample.numbers(2);
        if u * (2.0 * PI * v).cos() < 0.5 { 1.0 } else { 0.0 }
    });
    assert!(!agrees(&naive, 0.804498890522) && (naive.mean() - 0.87627).abs() < 1e-3, "{naive:?}");
}

/// An edge that goes 4 pixels leaves a ramp over them, and one that goes half a pixel a quarter in its own; what is
/// drawn by whole methods, with the lamp's outline taken for itself.
#[test]
fn a_moving_edge_is_a_ramp() {
    let size = ImageSize::new(8, 2);
    for (pixels, shares) in [
        (4.0, [0.0, 0.0, 0.125, 0.375, 0.625, 0.875, 1.0, 1.0]),
        (0.5, [0.0, 0.0, 0.75, 1.0, 1.0, 1.0, 1.0, 1.0]),
    ] {
        let mut scene = half_plane(1.0);
        // Two pixels from the left; the picture is 2 high, so a pixel is 1 wide.
        scene.mesh.positions.iter_mut().for_each(|p| p.x -= 2.0);
        scene.motions =
            vec![Motion { displacement: pixels * DVec3::X, parts: vec![Part::Triangles(0..2)] }];
        for method in &lancer_distributed::METHODS {
            let mut estimates = [Estimate::default(); 8];
            for seed in 0..64 {
                let sampling = PixelSampling { pattern: Pattern::Owen, samples: 32, seed };
                let order = Order { sampling, ..Order::new(&scene, LINEAR, size) };
                let picture = (method.render)(&order).unwrap().image;
                for (estimate, pixel) in estimates.iter_mut().zip(picture.pixels()) {
                    estimate.add(pixel[0].into());
                }
            }
            for (k, (estimate, share)) in estimates.iter().zip(shares).enumerate() {
                let off = (estimate.mean() - share).abs();
                // A picture is stored in `f32`.
                let holds = agrees(estimate, share) || off < 1e-7;
                assert!(holds, "{}, {pixels} pixels, {k}: {estimate:?}, {share}", method.name);
            }
        }
    }
}

/// A disc of radius 1 that goes D covers a point of its path, y beside the middle, for the share 2 √(1 − y²) / D.
#[test]
fn a_moving_disc_covers_its_path() {
    for (way, y, share) in [(4.0, 0.0, 0.5), (4.0, 0.5, 0.43301270189222), (2.5, 0.8, 0.48)] {
        let mut scene = empty();
        // From so far away that its outline is that of a disc.
        scene.camera.eye = DVec3::Z * 1e6;
        scene.camera.fov = (2.0 * (1e-6_f64 * 5.0).atan()).to_degrees();
        scene.spheres.push(sphere(DVec3::NEG_X * (0.5 * way), 1.0, 1));
        let displacement = way * DVec3::X;
        scene.motions = vec![Motion { displacement, parts: vec![Part::Spheres(0..1)] }];
        let film = DVec2::new(50.0, 50.0 - 10.0 * y);
        let estimate = seen(&scene, ImageSize::new(100, 100), film, 256);
        assert!(agrees(&estimate, share), "{way} {y}: {estimate:?}, {share}");
    }
}

/// A ball that passes between a point light and the floor: its shadow is on the point below for half of the time. Taken
/// where the ball is as the shutter opens, it never is.
#[test]
fn shadows_move_with_what_casts_them() {
    let mut scene = empty();
    quad(&mut scene.mesh, 0, [DVec3::new(-9.0, 0.0, -9.0), 18.0 * DVec3::Z, 18.0 * DVec3::X]);
    scene.spheres.push(sphere(DVec3::new(-2.0, 2.0, 0.0), 1.0, 0));
    scene.lights.push(PointLight { position: DVec3::Y * 1e6, intensity: Rgb::splat(1e12) });
    let displacement = DVec3::X * 4.0;
    scene.motions = vec![Motion { displacement, parts: vec![Part::Spheres(0..1)] }];
    let ray = Ray::new(DVec3::Y * 0.5, DVec3::NEG_Y);
    for way in WAYS {
        let mut matte = scene.clone();
        // The ball itself sends nothing back.
        matte.materials.push(Material::matte(Rgb::ZERO));
        matte.spheres[0].material = MaterialId(2);
        let estimate = along(&matte, way, ray, |f| replicated(256, 5, f));
        assert!(agrees(&estimate, 0.5), "{way:?}: {estimate:?}");
    }
}

/// The irradiance at the origin, whose normal is z, of a level polygon of radiance 1 (Lambert).
fn lambert(corners: &[DVec3]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let edge = |(a, b): (&DVec3, &DVec3)| {
        let across = a.cross(*b);
        across.length().atan2(a.dot(*b)) * across.normalize().z
    };
    0.5 * corners.iter().zip(next).map(edge).sum::<f64>().abs()
}

/// A square lamp goes aside, from R1 to R6 of the tables: what arrives is the mean over its way.
#[test]
fn moving_lamps_shine_from_their_way() {
    let square = |x: f64| {
        [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(a, b)| DVec3::new(x + a, b, 1.0))
    };
    assert!((lambert(&square(0.0)) - 0.752274688454107).abs() < 1e-14);
    assert!((lambert(&square(1.5)) - 0.104637075190907).abs() < 1e-14);
    // Simpson's rule.
    let weight = |k: u32| if k == 0 || k == 200 { 1.0 } else { 2.0 + 2.0 * f64::from(k % 2) };
    let terms = (0..=200).map(|k| weight(k) * lambert(&square(1.5 * f64::from(k) / 200.0)));
    let truth = terms.sum::<f64>() / 600.0;

    let mut scene = empty();
    quad(&mut scene.mesh, 0, [DVec3::new(-5e-5, -5e-5, 0.0), 1e-4 * DVec3::X, 1e-4 * DVec3::Y]);
    // Facing down.
    quad(&mut scene.mesh, 1, [DVec3::new(-0.5, -0.5, 1.0), DVec3::Y, DVec3::X]);
    let displacement = 1.5 * DVec3::X;
    scene.motions = vec![Motion { displacement, parts: vec![Part::Triangles(2..4)] }];
    let ray = Ray::new(DVec3::Z * 1e-3, DVec3::NEG_Z);
    for way in WAYS {
        let estimate = along(&scene, way, ray, |f| replicated(256, 5, f));
        let (mean, error) = (PI * estimate.mean(), PI * estimate.standard_error());
        assert!((mean - truth).abs() < 6.6 * error, "{way:?}: {mean} ± {error}, {truth}");
        assert!(error < 0.01 * truth || way == Way::Path(Strategy::Lobe), "{way:?} {error}");
    }
    // A sphere that does the same is the mean of its closed form, π r² z / d³.
    let mut scene = empty();
    quad(&mut scene.mesh, 0, [DVec3::new(-5e-5, -5e-5, 0.0), 1e-4 * DVec3::X, 1e-4 * DVec3::Y]);
    scene.spheres.push(sphere(DVec3::Z * 2.0, 1.0, 1));
    scene.motions = vec![Motion { displacement, parts: vec![Part::Spheres(0..1)] }];
    let at = |x: f64| PI * 2.0 / (4.0 + x * x).powf(1.5);
    let terms = (0..=200).map(|k| weight(k) * at(1.5 * f64::from(k) / 200.0));
    let truth = terms.sum::<f64>() / 600.0;
    for way in WAYS {
        let estimate = along(&scene, way, ray, |f| replicated(256, 5, f));
        let (mean, error) = (PI * estimate.mean(), PI * estimate.standard_error());
        assert!((mean - truth).abs() < 6.6 * error, "sphere, {way:?}: {mean} ± {error}, {truth}");
    }
}

/// A checker goes with what it is on.
#[test]
fn a_checker_moves_with_its_surface() {
    let mut scene = empty();
    let checker = Pigment::Checker { even: Rgb::ONE, odd: Rgb::ZERO, side: 1.0 };
    scene.materials[0].rho_d = checker;
    scene.ambient = Rgb::ONE;
    quad(&mut scene.mesh, 0, [DVec3::new(-9.5, -9.5, -2.0), 19.0 * DVec3::X, 19.0 * DVec3::Y]);
    // Seen a quarter of a square right of an edge: black from when the edge is there until the next one is.
    for (way, share) in [(1.0, 0.25), (2.0, 0.5), (0.5, 0.5), (0.0, 1.0)] {
        let displacement = way * DVec3::X;
        scene.motions = vec![Motion { displacement, parts: vec![Part::Triangles(0..2)] }];
        let film = DVec2::new(50.0 + 0.25 * 25.0, 50.0 - 0.25 * 25.0);
        let estimate = seen(&scene, ImageSize::new(100, 100), film, 256);
        assert!(agrees(&estimate, share), "{way}: {estimate:?}, {share}");
    }
}

/// A lamp that takes the cone δ around the mirror axis, or around the refracted direction, is seen in gloss m as
/// 1 − cosᵐ⁺¹ δ.
#[test]
fn gloss_sees_a_cone() {
    let table = [
        (10.0, 0.05, 0.0136615552166),
        (10.0, 0.2, 0.198670057567),
        (100.0, 0.05, 0.118651924114),
        (100.0, 0.2, 0.869138017293),
        (1000.0, 0.05, 0.714002354868),
    ];
    let incident = DVec3::new(0.6, -0.8, 0.0);
    for (gloss, cone, share) in table {
        for (reflects, axis) in [(true, DVec3::new(0.6, 0.8, 0.0)), (false, incident)] {
            let mut scene = empty();
            let side = 1e-3;
            let corner = DVec3::new(-0.5 * side, 0.0, -0.5 * side);
            quad(&mut scene.mesh, 0, [corner, side * DVec3::Z, side * DVec3::X]);
            scene.spheres.push(sphere(2.0 * axis, 2.0 * f64::sin(cone), 1));
            let shares = if reflects { (Rgb::ONE, Rgb::ZERO) } else { (Rgb::ZERO, Rgb::ONE) };
            scene.materials[0] = Material {
                k_s: shares.0,
                k_t: shares.1,
                gloss: Some(gloss),
                ..Material::matte(Rgb::ZERO)
            };
            let ray = Ray::new(-0.01 * incident, incident);
            for way in [Way::Distributed, Way::Path(Strategy::Mis)] {
                let estimate = along(&scene, way, ray, |f| replicated(256, 5, f));
                let holds = agrees(&estimate, share);
                assert!(holds, "m {gloss}, δ {cone}, {way:?}: {estimate:?}, {share}");
            }
            // A beginner's lobe, of cos α = u^(1/m), has another share wherever that is to be seen.
            let naive = replicated(256, 5, |sample| {
                let [u, ..] = sample.numbers(0);
                f64::from(u8::from(u.powf(1.0 / gloss) > cone.cos()))
            });
            if (1.0 - f64::cos(cone).powf(gloss) - share).abs() > 0.01 {
                assert!(!agrees(&naive, share), "m {gloss}, δ {cone}");
            }
        }
    }
}

/// What is spread below the horizon is lost: of a bright sky, the share of the lobe above it is seen.
#[test]
fn gloss_loses_what_goes_below_the_horizon() {
    let table = [
        (1.0, 60.0, 0.75),
        (1.0, 80.0, 0.58682408883),
        (10.0, 60.0, 0.95906788442),
        (10.0, 80.0, 0.71476209601),
        (100.0, 80.0, 0.96030028237),
    ];
    let mut scene = empty();
    scene.background = Rgb::ONE;
    quad(&mut scene.mesh, 0, [DVec3::new(-9.0, 0.0, -9.0), 18.0 * DVec3::Z, 18.0 * DVec3::X]);
    for (gloss, degrees, share) in table {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let incident = DVec3::new(sin, -cos, 0.0);
        for reflects in [true, false] {
            let shares = if reflects { (Rgb::ONE, Rgb::ZERO) } else { (Rgb::ZERO, Rgb::ONE) };
            scene.materials[0] = Material {
                k_s: shares.0,
                k_t: shares.1,
                gloss: Some(gloss),
                ..Material::matte(Rgb::ZERO)
            };
            for way in [Way::Distributed, Way::Path(Strategy::Mis)] {
                let ray = Ray::new(-incident, incident);
                let estimate = along(&scene, way, ray, |f| replicated(256, 5, f));
                let holds = agrees(&estimate, share);
                assert!(holds, "m {gloss}, {degrees}°, {way:?}: {estimate:?}, {share}");
            }
        }
    }
}

/// Spheres as lamps: the irradiance at d radii, of a receiver tilted so far, and the exact spread of one sample where a
/// table has it.
#[test]
fn spheres_light_as_their_closed_form() {
    let table = [
        (1.5, 0.0, 1.3962634015955, Some(0.084234269)),
        (2.0, 0.0, PI / 4.0, Some(0.041451884)),
        (3.0, 0.0, 0.34906585039887, Some(0.016995605)),
        (10.0, 0.0, 0.031415926535898, Some(0.00145064)),
        (3.0, 30.0, 0.302299894039036, None),
        (2.0, 80.0, 0.171831975127396, None),
        (2.0, 90.0, 0.0905860737060795, None),
        (2.0, 100.0, 0.0354490153104747, None),
    ];
    for (distance, tilt, irradiance, spread) in table {
        for scale in [1.0, 1e-6, 1e6] {
            let mut scene = empty();
            let n = DMat3::from_rotation_y(f64::to_radians(tilt)) * DVec3::Z;
            let (x, y) = n.any_orthonormal_pair();
            let side = 1e-4 * scale;
            quad(&mut scene.mesh, 0, [-0.5 * side * (x + y), side * x, side * y]);
            scene.spheres.push(sphere(DVec3::Z * distance * scale, scale, 1));
            let ray = Ray::new(1e-3 * scale * n, -n);
            for way in WAYS {
                if way == Way::Path(Strategy::Lobe) && (distance > 3.0 || tilt > 85.0) {
                    // Too rarely met.
                    continue;
                }
                let estimate = along(&scene, way, ray, |f| replicated(256, 5, f));
                let truth = irradiance / PI;
                let holds = agrees(&estimate, truth);
                assert!(holds, "{distance}, {tilt}°, {scale}, {way:?}: {estimate:?}, {truth}");
            }
            let Some(spread) = spread else { continue };
            let estimate = along(&scene, Way::Distributed, ray, |f| independent(40_000, 5, f));
            let ratio = estimate.variance().sqrt() / (spread * irradiance / PI);
            // The kurtosis of these is below 3.
            let bound = 0.5 * Z * (2.0 / 40_000.0_f64).sqrt();
            assert!((ratio - 1.0).abs() < bound + 1e-3, "{distance}, {scale}: {ratio}");
        }
    }
    // A sphere does not light itself, wherever rounding puts the receiver.
    let mut scene = empty();
    scene.materials[1].rho_d = Pigment::Solid(Rgb::ONE);
    for k in 0..20 {
        let center = DVec3::new(0.1 * f64::from(k), 0.3, -0.7);
        scene.spheres = vec![sphere(center, 0.37, 1)];
        for way in WAYS {
            let ray = Ray::new(DVec3::Z * 5.0, (center - DVec3::Z * 5.0 + 0.1).normalize());
            let estimate = along(&scene, way, ray, |f| replicated(16, 5, f));
            assert_eq!((estimate.mean(), estimate.variance()), (1.0, 0.0), "{k} {way:?}");
        }
    }
    // From inside nothing shines, on no receiver.
    let mut scene = empty();
    quad(&mut scene.mesh, 0, [DVec3::new(-0.5, -0.5, 0.0), DVec3::X, DVec3::Y]);
    scene.spheres.push(sphere(DVec3::new(0.1, 0.2, 0.3), 2.0, 1));
    for way in WAYS {
        let ray = Ray::new(DVec3::Z * 0.5, DVec3::NEG_Z);
        let estimate = along(&scene, way, ray, |f| replicated(16, 5, f));
        assert_eq!((estimate.mean(), estimate.variance()), (0.0, 0.0), "{way:?}");
    }
}

/// A scene of everything.
fn everything() -> Scene {
    let mut scene = Scene::of_mesh(lancer_core::generate::icosphere(2));
    quad(&mut scene.mesh, 1, [DVec3::new(-1.0, 3.0, -1.0), 2.0 * DVec3::X, 2.0 * DVec3::Z]);
    quad(&mut scene.mesh, 0, [DVec3::new(-9.0, -1.0, -9.0), 18.0 * DVec3::Z, 18.0 * DVec3::X]);
    let glass = Material {
        k_s: Rgb::splat(0.3),
        k_t: Rgb::splat(0.6),
        refractive_index: 1.5,
        ..Material::matte(Rgb::splat(0.1))
    };
    scene.materials = vec![Material::matte(Rgb::splat(0.5)), lamp_material(), glass];
    scene.spheres =
        vec![sphere(DVec3::new(1.5, 0.0, 0.5), 0.7, 2), sphere(DVec3::new(-1.6, 0.5, 0.5), 0.3, 1)];
    scene.lights.push(PointLight { position: DVec3::new(3.0, 4.0, 5.0), intensity: Rgb::ONE });
    scene.camera.eye = DVec3::new(0.3, 1.0, 5.0);
    (scene.ambient, scene.background) = (Rgb::splat(0.1), Rgb::splat(0.2));
    scene
}

fn blurred(way: f64, lens: f64, gloss: f64) -> Scene {
    let mut scene = everything();
    let motion = |direction: DVec3, parts| Motion { displacement: way * direction, parts };
    scene.motions = vec![
        motion(DVec3::X, vec![Part::Triangles(0..200), Part::Spheres(0..1)]),
        motion(DVec3::new(0.3, 0.2, -0.5), vec![Part::Triangles(320..322), Part::Spheres(1..2)]),
    ];
    scene.camera.lens = Some(Lens { radius: lens, focus: 4.5 });
    scene.materials[2].gloss = Some(gloss);
    scene
}

/// A kind of index.
type Build = for<'s> fn(Subset<'s>) -> Box<dyn Intersector + 's>;

const BY_HAND: Build = |primitives| Box::new(LinearScan::new(primitives));

fn drawn(method: &Method, scene: &Scene, build: Build, threads: usize) -> Vec<[f32; 3]> {
    let sampling = PixelSampling { pattern: Pattern::Owen, samples: 4, seed: 8 };
    let tile = 8 + threads as u32;
    let control = Control { tile, ..Control::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let index: &BuildIndex = &|primitives| build(primitives);
        let order = Order { sampling, control, ..Order::new(scene, index, ImageSize::new(40, 30)) };
        (method.render)(&order).unwrap().image.pixels().to_vec()
    })
}

/// A lens of radius 0, ways of length 0 and a gloss of 10³⁰⁰ are no lens, no motion and no gloss, to the bit.
#[test]
fn effects_of_no_size_change_nothing() {
    for method in &lancer_distributed::METHODS {
        let sharp = drawn(method, &everything(), BY_HAND, 2);
        assert!(drawn(method, &blurred(0.0, 0.0, 1e300), BY_HAND, 2) == sharp, "{}", method.name);
        for scene in [blurred(0.1, 0.0, 1e300), blurred(0.0, 0.1, 1e300), blurred(0.0, 0.0, 1e2)] {
            assert!(drawn(method, &scene, BY_HAND, 2) != sharp, "{}", method.name);
        }
    }
}

/// Of everything that moves and is blurred, every index and any number of threads draw the same bits.
#[test]
fn blurred_pictures_do_not_depend_on_who_answers() {
    let scene = blurred(0.4, 0.1, 50.0);
    let wide: Build = |primitives| Box::new(Wide::build(primitives));
    for method in &lancer_distributed::METHODS {
        let wanted = drawn(method, &scene, BY_HAND, 1);
        assert!(wanted.iter().flatten().all(|value| value.is_finite()));
        for threads in [1, 2, 3, 7] {
            assert!(drawn(method, &scene, wide, threads) == wanted, "{}, {threads}", method.name);
        }
    }
}
