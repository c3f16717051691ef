//! What moves while the shutter is open: every index over every group finds what brute force finds.

use chapter_4::aimed::{CLASSES, aimed};
use glam::DVec3;
use lancer_accel::structures::STRUCTURES;
use lancer_core::generate::icosphere;
use lancer_core::geometry::{Interval, Ray, Sphere};
use lancer_core::image::ImageSize;
use lancer_core::intersector::{Hit, Intersector, LinearScan, Query, TestCounts};
use lancer_core::method::{BuildIndex, Order};
use lancer_core::moving::{Moment, Moving};
use lancer_core::scene::{
    Face, MaterialId, Mesh, Motion, Part, PointLight, PointSource, PrimitiveId, Scene,
    SphereObject, Triangle,
};
use lancer_core::world::SurfacePoint;

use crate::random::Random;

fn at<'m>(moving: &'m Moving<'_>, time: f64) -> Moment<'m> {
    Moment::from(moving).at(time)
}

const LINEAR: &BuildIndex = &|primitives| Box::new(LinearScan::new(primitives));

fn sphere(center: DVec3, radius: f64) -> SphereObject {
    SphereObject { shape: Sphere { center, radius }, material: MaterialId(0) }
}

/// A ball of triangles of which parts fly off, among spheres; some of what moves is there twice.
fn scene() -> Scene {
    let mut mesh = icosphere(1);
    let twice = mesh.clone();
    mesh.append(&twice, glam::DAffine3::IDENTITY, 0);
    let mut scene = Scene::of_mesh(mesh);
    assert_eq!(scene.mesh.triangles.len(), 160);
    let mut random = Random::new(3);
    for _ in 0..20 {
        scene.spheres.push(sphere(random.in_cube(1.5), random.between(0.05, 0.4)));
    }
    // 0 and 20, 1 and 21, 2 and 22 coincide as the shutter opens.
    for k in 0..3 {
        scene.spheres.push(scene.spheres[k]);
    }
    let (triangles, spheres) = (Part::Triangles, Part::Spheres);
    let motion = |displacement, parts: &[Part]| Motion { displacement, parts: parts.to_vec() };
    scene.motions = vec![
        // The first half of the ball leaves its copy, which stands still, and 0 leaves 20.
        motion(DVec3::new(0.7, -0.2, 0.4), &[triangles(0..40), spheres(0..1), spheres(5..9)]),
        // A part of the copy leaves the ball, and 21 leaves 1.
        motion(DVec3::new(-0.3, 0.9, 0.1), &[triangles(150..160), spheres(21..22)]),
        // These stay together in groups of their own: 2 with 22, some triangles with their copies.
        motion(DVec3::new(0.0, 0.5, -2.0), &[triangles(45..60), spheres(2..3)]),
        motion(DVec3::new(0.0, 0.5, -2.0), &[spheres(22..23), triangles(125..140)]),
    ];
    scene
}

/// The hit of one primitive, where it is at the time.
fn alone(
    scene: &Scene,
    primitive: PrimitiveId,
    ray: &Ray,
    time: f64,
    range: Interval,
) -> Option<Hit> {
    let index = primitive.0 as usize;
    let sphere = index.checked_sub(scene.mesh.triangles.len());
    let moves = |motion: &&Motion| {
        motion.parts.iter().any(|part| match part {
            Part::Triangles(range) => range.contains(&index),
            Part::Spheres(range) => sphere.is_some_and(|k| range.contains(&k)),
        })
    };
    let way = scene.motions.iter().find(moves).map_or(DVec3::ZERO, |motion| motion.displacement);
    let shifted = Ray::new(ray.origin - time * way, ray.direction);
    LinearScan::new(scene.subset([primitive])).closest_hit(&shifted, range)
}

/// Brute force: the nearest of all primitives, of equals that of the smallest id.
fn by_hand(scene: &Scene, ray: &Ray, time: f64) -> Option<Hit> {
    let hits = scene.primitives().filter_map(|id| alone(scene, id, ray, time, Interval::POSITIVE));
    hits.min_by(|a, b| a.t.total_cmp(&b.t).then(a.primitive.cmp(&b.primitive)))
}

/// eq:shutter, by brute force.
#[test]
fn every_index_finds_what_moves() {
    let scene = scene();
    let indexes: Vec<_> = STRUCTURES
        .iter()
        .map(|structure| (structure.name, Moving::new(&scene, &|set| structure.build(set).index)))
        .collect();
    let (mut hits, mut of_groups, mut ties) = (0, 0, 0);
    for class in CLASSES {
        let mut random = Random::new(5);
        for k in 0..300 {
            let mut ray = aimed(class, &scene.mesh, DVec3::ZERO, &mut || random.unit());
            let time = if k % 4 == 0 { 0.0 } else { random.unit() };
            if k % 3 == 0 {
                // Aimed at what is there at this time.
                ray.origin += time * scene.motions[k % 4].displacement;
            } else if k % 3 == 1 {
                let target = scene.spheres[k % scene.spheres.len()].shape.center;
                ray.direction = target + 0.2 * random.in_cube(1.0) - ray.origin;
            }
            let wanted = by_hand(&scene, &ray, time);
            for (name, moving) in &indexes {
                let moment = at(moving, time);
                let met = |range| moment.closest_hit(&ray, range);
                assert_eq!(met(Interval::POSITIVE), wanted, "{name}, {class} at {time}: {ray:?}");
                let mut counts = TestCounts::default();
                let query = Query::closest(&ray, Interval::POSITIVE);
                assert_eq!(moment.watch(query, &mut counts), wanted, "{name}");
                let Some(hit) = wanted else { continue };
                for max in [hit.t, hit.t.next_up()] {
                    let range = Interval::up_to(max);
                    assert_eq!(met(range).is_some(), max > hit.t, "{name} to {max}: {ray:?}");
                    assert_eq!(moment.occluded(&ray, range), max > hit.t, "{name}: {ray:?}");
                    let any = moment.watch(Query::any(&ray, range), &mut counts);
                    assert_eq!(any.is_some(), max > hit.t, "{name}: {ray:?}");
                }
            }
            let Some(hit) = wanted else { continue };
            hits += 1;
            let moving = scene.moving().any(|(_, ids)| ids.place(hit.primitive).is_some());
            of_groups += usize::from(moving);
            let after = Interval { min: hit.t.next_down(), max: hit.t.next_up() };
            let met =
                scene.primitives().filter(|&id| alone(&scene, id, &ray, time, after).is_some());
            ties += usize::from(met.count() > 1);
        }
    }
    println!("{hits} hits, {of_groups} of what moves, {ties} ties");
    assert!(hits > 1500 && of_groups > 500 && ties > 300, "{hits}, {of_groups}, {ties}");
}

/// Rays of many times at once, in packets.
#[test]
fn many_rays_get_the_answers_of_one() {
    let scene = scene();
    let mut random = Random::new(7);
    let rays: Vec<Ray> =
        (0..500).map(|_| Ray::new(DVec3::Z * 5.0, 0.2 * random.in_cube(1.0) - DVec3::Z)).collect();
    let times: Vec<f64> = rays.iter().map(|_| random.unit()).collect();
    for structure in STRUCTURES {
        let moving = Moving::new(&scene, &|set| structure.build(set).index);
        let mut hits = vec![None; rays.len()];
        Moment::from(&moving).closest_hits_at(&rays, &times, Interval::POSITIVE, &mut hits);
        for ((ray, &time), hit) in rays.iter().zip(&times).zip(&hits) {
            assert_eq!(*hit, at(&moving, time).closest_hit(ray, Interval::POSITIVE));
        }
        assert!(hits.iter().flatten().count() > 300);
        at(&moving, 0.25).closest_hits(&rays, Interval::POSITIVE, &mut hits);
        for (ray, hit) in rays.iter().zip(&hits) {
            assert_eq!(*hit, at(&moving, 0.25).closest_hit(ray, Interval::POSITIVE));
        }
    }
}

/// As the shutter opens, and where displacements are 0, all is as in the scene without motions, to the bit.
#[test]
fn what_has_not_moved_is_where_it_was() {
    let scene = scene();
    let mut still = scene.clone();
    still.motions.iter_mut().for_each(|motion| motion.displacement = DVec3::ZERO);
    let (moving, unmoved) = (Moving::new(&scene, LINEAR), Moving::new(&still, LINEAR));
    assert!(at(&moving, 0.0).moves() && !at(&unmoved, 0.0).moves());
    let plain = LinearScan::new(&scene);
    let mut random = Random::new(9);
    for _ in 0..5_000 {
        let origin = 4.0 * random.direction();
        let ray = Ray::new(origin, random.in_cube(1.0) - origin);
        let wanted = plain.closest_hit(&ray, Interval::POSITIVE);
        assert_eq!(at(&moving, 0.0).closest_hit(&ray, Interval::POSITIVE), wanted);
        assert_eq!(at(&unmoved, random.unit()).closest_hit(&ray, Interval::POSITIVE), wanted);
        let Some(hit) = wanted else { continue };
        let [found, wanted] =
            [at(&unmoved, 0.5).surface_at(&ray, &hit), scene.surface_at(&ray, &hit)];
        assert_eq!((found.position, found.error), (wanted.position, wanted.error));
    }
}

/// The geometry itself moved: the same within rounding, and surfaces move with what they are of.
#[test]
fn a_shifted_ray_sees_moved_geometry() {
    let scene = scene();
    let moving = Moving::new(&scene, LINEAR);
    let mut random = Random::new(11);
    let (mut hits, mut others) = (0, 0);
    for _ in 0..40 {
        let time = random.unit();
        let mut moved = scene.clone();
        // Each triangle gets corners of its own.
        moved.mesh.positions.clear();
        for index in 0..scene.mesh.triangles.len() {
            let corners = scene.mesh.corners(index);
            moved.mesh.triangles[index].vertices = [0, 1, 2].map(|k| (3 * index + k) as u32);
            moved.mesh.positions.extend(corners);
        }
        for motion in &scene.motions {
            let shift = time * motion.displacement;
            for part in motion.parts.iter().cloned() {
                match part {
                    Part::Triangles(range) => moved.mesh.positions[3 * range.start..3 * range.end]
                        .iter_mut()
                        .for_each(|p| *p += shift),
                    Part::Spheres(range) => {
                        moved.spheres[range].iter_mut().for_each(|s| s.shape.center += shift);
                    }
                }
            }
        }
        let (index, moment) = (LinearScan::new(&moved), at(&moving, time));
        for _ in 0..200 {
            let origin = 5.0 * random.direction();
            let ray = Ray::new(origin, random.in_cube(1.5) - origin);
            let [shifted, wanted] = [&moment as &dyn Intersector, &index]
                .map(|index| index.closest_hit(&ray, Interval::POSITIVE));
            let (Some(hit), Some(wanted)) = (shifted, wanted) else {
                assert_eq!(shifted, wanted);
                continue;
            };
            assert!((hit.t - wanted.t).abs() < 1e-12, "{hit:?} {wanted:?}");
            hits += 1;
            others += usize::from(hit.primitive != wanted.primitive);
            let surface = moment.surface_at(&ray, &hit);
            let wanted = moved.surface_at(&ray, &wanted);
            // The corners that have moved are rounded, too.
            let off = (surface.position - wanted.position).abs().max_element();
            assert!(off < 1e-13, "{off} {surface:?}");
            assert!((surface.lifted - surface.position).length() < 1e-15);
        }
    }
    // Those that coincide are told apart by rounding.
    println!("{hits} hits, {others} of a copy");
    assert!(hits > 4_000 && others < hits / 4, "{hits} {others}");
}

/// Rays that leave what has moved, by up to a million times its size, do not meet it where they start; without the
/// rounding of the shift in the error, they do.
#[test]
fn nothing_that_moves_meets_itself() {
    let mut scene = Scene::of_mesh(icosphere(0));
    scene.spheres.push(sphere(DVec3::new(5.0, 0.3, 0.2), 1.0));
    let mut random = Random::new(13);
    let (mut ours, mut naive, mut left) = (0, 0, 0);
    for _ in 0..400 {
        let way = 10.0_f64.powf(random.between(-3.0, 6.0)) * random.direction();
        scene.motions = vec![Motion {
            displacement: way,
            parts: vec![Part::Triangles(0..scene.mesh.triangles.len()), Part::Spheres(0..1)],
        }];
        let moving = Moving::new(&scene, LINEAR);
        let time = random.unit();
        let moment = at(&moving, time);
        let target = time * way + if random.unit() < 0.5 { DVec3::ZERO } else { DVec3::X * 5.0 };
        let origin = target + 20.0 * random.direction();
        let ray = Ray::new(origin, target + 0.4 * random.direction() - origin);
        let Some(hit) = moment.closest_hit(&ray, Interval::POSITIVE) else { continue };
        let surface = moment.surface_at(&ray, &hit);
        let error = scene.surface_at(&ray.shifted(-time * way), &hit).error;
        let beside = SurfacePoint { error, ..surface };
        for _ in 0..100 {
            // Outwards: from a convex shape nothing is met, unless it is the other one.
            let n = surface.geometric_normal;
            let mut direction = random.direction();
            direction *= direction.dot(n).signum();
            let meets = |point: &SurfacePoint| {
                let met = moment.closest_hit(&point.spawn(direction), Interval::POSITIVE);
                usize::from(met.is_some_and(|met| met.t < 1.0 && met.primitive == hit.primitive))
            };
            left += 1;
            ours += meets(&surface);
            naive += meets(&beside);
        }
    }
    println!("{left} left: {ours}, naive {naive}");
    assert!(left > 20_000 && ours == 0 && naive > left / 100, "{left} {ours} {naive}");
}

/// By hand: a sphere of radius 1 comes from −4 and goes to 4 through the eye, which is in it a quarter of the time.
#[test]
fn what_flies_through_the_eye_is_seen_from_inside() {
    let mut scene = Scene::of_mesh(Mesh::default());
    scene.spheres.push(sphere(DVec3::NEG_X * 4.0, 1.0));
    let displacement = DVec3::X * 8.0;
    scene.motions = vec![Motion { displacement, parts: vec![Part::Spheres(0..1)] }];
    for structure in STRUCTURES {
        let moving = Moving::new(&scene, &|set| structure.build(set).index);
        let sees = |moment: Moment, direction| {
            moment.closest_hit(&Ray::new(DVec3::ZERO, direction), Interval::POSITIVE).is_some()
        };
        let times = (0..1000).map(|k| (f64::from(k) + 0.5) / 1000.0);
        let inside = times.filter(|&time| {
            let seen = [DVec3::Y, DVec3::NEG_Y, DVec3::Z].map(|way| sees(at(&moving, time), way));
            assert!(seen == [seen[0]; 3], "{} at {time}", structure.name);
            seen[0]
        });
        assert_eq!(inside.count(), 250, "{}", structure.name);
    }
}

/// Methods that ignore motion draw the shutter's opening, to the bit.
#[test]
fn a_method_without_motion_draws_the_opening() {
    let mut scene = scene();
    scene.lights.push(PointLight::beside(&scene.camera));
    scene.camera.eye = DVec3::Z * 5.0;
    let still = Scene { motions: Vec::new(), ..scene.clone() };
    for method in &lancer_whitted::METHODS {
        let [opening, wanted] = [&scene, &still].map(|scene| {
            (method.render)(&Order::new(scene, LINEAR, ImageSize::new(32, 32))).unwrap()
        });
        assert!(opening == wanted, "{}", method.name);
    }
}

/// A scene without lens, gloss or motion pays nothing in memory, where there is much of anything.
#[test]
fn what_there_is_much_of_has_not_grown() {
    assert_eq!((size_of::<Ray>(), size_of::<Hit>()), (48, 40));
    assert_eq!((size_of::<SphereObject>(), size_of::<Triangle>(), size_of::<Face>()), (40, 16, 12));
    assert_eq!((size_of::<SurfacePoint>(), size_of::<PointSource>()), (128, 80));
    let scene = Scene::of_mesh(icosphere(3));
    assert_eq!((scene.still().memory(), scene.motions.capacity()), (0, 0));
}
