//! The answers that `cargo xtask exercise solution` prints, compiled as a student's files are: from outside the
//! chapter's crate, and calling each other. They pass, and each is the course's own code in other words: the two
//! answer alike, so that neither drifts from the other.

use std::path::Path;

use chapter_1::exercises::{COURSE, Lit, Node, Stage, Subject};
use chapter_1::scenes;
use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Interval, Ray, Shear, Sphere, intersect_triangle};
use lancer_core::illumination::{Reflectance, attenuation, local};
use lancer_core::image::{Image, ImageSize};
use lancer_core::metric::rmse;
use lancer_core::optics::{reflect, refract};
use lancer_core::sampling::{Pattern, PixelSampling, Uniform};
use lancer_core::scene::{Camera, MaterialId};
use lancer_core::world::{SurfacePoint, World};
use lancer_exercise::Shown;
use lancer_whitted::{AtLimit, Call, RayEnd, RayNode, RayTree, Settings, Whitted};

use solutions::e01_primary_ray::primary_ray;
use solutions::e02_ray_triangle::ray_triangle;
use solutions::e03_ray_sphere::ray_sphere;
use solutions::e08_lr::lr;
use solutions::e09_ray_tree::{count_rays, ray_tree};
use solutions::e10_samples::{pixel_mean, rms_error};
use yours::{local_light, reflected_ray, refracted_ray, shadow_ray};

#[path = "../solutions"]
mod solutions {
    pub mod e01_primary_ray;
    pub mod e02_ray_triangle;
    pub mod e03_ray_sphere;
    pub mod e04_shadow_ray;
    pub mod e05_local_light;
    pub mod e06_reflected_ray;
    pub mod e07_refracted_ray;
    pub mod e08_lr;
    pub mod e09_ray_tree;
    pub mod e10_samples;
}

mod yours {
    pub use crate::solutions::{
        e04_shadow_ray::shadow_ray, e05_local_light::local_light, e06_reflected_ray::reflected_ray,
        e07_refracted_ray::refracted_ray,
    };
}

const SOLVED: Subject = Subject {
    primary_ray,
    ray_triangle,
    ray_sphere,
    shadow_ray,
    local_light,
    reflected_ray,
    refracted_ray,
    lr,
    ray_tree,
    count_rays,
    pixel_mean,
    rms_error,
};

#[test]
fn a_student_who_copies_the_answers_passes_every_check() {
    COURSE.prove_solutions(Path::new(env!("CARGO_MANIFEST_DIR")), SOLVED);
}

const EPSILON: f64 = f64::EPSILON;

/// A point of the cube [−1, 1]³.
fn point(random: &mut Uniform) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| 2.0 * random.number() - 1.0))
}

/// A unit vector on the side of another.
fn beside(n: DVec3, random: &mut Uniform) -> DVec3 {
    let direction = random.direction();
    if n.dot(direction) < 0.0 { -direction } else { direction }
}

/// The course adds up the same vectors in another order; ten roundings of numbers below 3.
#[test]
fn a_primary_ray_is_the_courses_to_rounding() {
    let mut random = Uniform::new(71, 0, 0);
    let size = ImageSize::new(64, 48);
    for _ in 0..200 {
        let [eye, look_at, up] = [0; 3].map(|_| 9.0 * point(&mut random));
        let camera = Camera { eye, look_at, up, fov: 20.0 + 60.0 * random.number(), lens: None };
        let (x, y) = (64.0 * random.number(), 48.0 * random.number());
        let (ours, course) =
            (primary_ray(&camera, size, x, y), camera.primary_rays(size).through(x, y));
        assert!(Shown::distance(&ours, &course) < 20.0 * EPSILON, "{camera:?} {ours:?} {course:?}");
    }
}

/// The edge functions and the corners are the same numbers; the course multiplies by 1 over their sum, rounded once more.
#[test]
fn a_triangle_is_met_where_the_course_meets_it() {
    let mut random = Uniform::new(72, 0, 0);
    let mut met = 0;
    for _ in 0..4000 {
        let corners = [0; 3].map(|_| point(&mut random));
        let origin = 3.0 * random.direction();
        let ray = Ray::new(origin, point(&mut random) - origin);
        let (ours, course) = (
            ray_triangle(corners, &ray),
            intersect_triangle(corners, &ray, &Shear::new(ray.direction)),
        );
        assert_eq!(ours.is_some(), course.is_some(), "{corners:?} {ray:?}");
        if let Some(((t, weights), course)) = ours.zip(course) {
            assert!((t - course.t).abs() <= 2.0 * EPSILON * t, "{t} {course:?}");
            let error = (weights - course.barycentric).abs();
            assert!(error.cmple(2.0 * EPSILON * weights).all(), "{weights} {course:?}");
            met += 1;
        }
    }
    assert!(met > 50, "{met}");
}

#[test]
fn a_sphere_is_met_where_the_course_meets_it_to_the_bit() {
    let mut random = Uniform::new(73, 0, 0);
    let mut met = 0;
    for _ in 0..4000 {
        let sphere = Sphere { center: point(&mut random), radius: 0.1 + random.number() };
        let origin = 2.0 * point(&mut random);
        let ray = Ray::new(origin, point(&mut random) - origin);
        let hit = ray_sphere(&sphere, &ray);
        assert_eq!(hit, sphere.intersect(&ray, Interval::POSITIVE));
        met += u32::from(hit.is_some());
    }
    assert!((400..3600).contains(&met), "{met}");
}

#[test]
fn shadow_rays_are_the_courses_to_the_bit() {
    let mut random = Uniform::new(74, 0, 0);
    for _ in 0..1000 {
        let geometric_normal = random.direction();
        let surface = SurfacePoint {
            position: point(&mut random),
            error: 0.1 * point(&mut random).abs(),
            geometric_normal,
            shading_normal: beside(geometric_normal, &mut random),
            lifted: point(&mut random),
            material: MaterialId(0),
        };
        let lamp = 3.0 * point(&mut random);
        assert_eq!(shadow_ray(&surface, lamp), surface.spawn_to(lamp));
    }
}

/// The course multiplies by 1/d², rounded once more.
#[test]
fn the_light_of_a_lamp_is_the_courses_to_rounding() {
    let mut random = Uniform::new(75, 0, 0);
    let mut lit = 0;
    for k in 0..2000 {
        let n = random.direction();
        let reflectance = Reflectance {
            diffuse: point(&mut random).abs(),
            specular: point(&mut random).abs(),
            shininess: 1.0 + 30.0 * random.number(),
        };
        let (to_light, to_eye) = (random.direction(), beside(n, &mut random));
        let (visible, distance) = (k % 8 != 0, 0.1 + 3.0 * random.number());
        let intensity = 9.0 * point(&mut random).abs();
        let ours =
            local_light(&Lit { intensity, visible, distance, reflectance, n, to_light, to_eye });
        let course =
            intensity * attenuation(visible, distance) * local(&reflectance, n, to_light, to_eye);
        assert!((ours - course).abs().cmple(4.0 * EPSILON * ours).all(), "{ours} {course}");
        lit += u32::from(ours != Rgb::ZERO);
    }
    assert!((500..1500).contains(&lit), "{lit}");
}

#[test]
fn mirror_rays_are_the_courses_to_the_bit() {
    let mut random = Uniform::new(76, 0, 0);
    for _ in 0..1000 {
        let (v, n) = (random.direction(), random.direction());
        assert_eq!(reflected_ray(v, n), reflect(v, n));
    }
}

/// The course has sin² θ₁ as a product. The two differ by some ε, cos² θ₂ by η² ≤ 2.25 as many, and cos θ₂ by
/// that over 2 cos θ₂.
#[test]
fn refracted_rays_are_the_courses_to_rounding() {
    let mut random = Uniform::new(77, 0, 0);
    let mut passed = 0;
    for k in 0..2000 {
        let n = random.direction();
        let v = -beside(n, &mut random);
        let (n1, n2) = if k % 2 == 0 { (1.0, 1.5) } else { (1.5, 1.0) };
        let (ours, course) = (refracted_ray(v, n, n1, n2), refract(v, n, n1, n2));
        assert_eq!(ours.is_some(), course.is_some(), "{v} {n}");
        if let Some((ours, course)) = ours.zip(course) {
            let bound = 8.0 * EPSILON / -n.dot(course);
            assert!(Shown::distance(&ours, &course) < bound, "{v} {n} {ours} {course}");
            passed += 1;
        }
    }
    assert!((1000..1800).contains(&passed), "{passed}");
}

/// A call of LR and those that it makes, in the order in which they begin.
fn listed(node: &Node) -> Vec<&Node> {
    [node].into_iter().chain(node.children.iter().flat_map(listed)).collect()
}

/// The calls that the course's own LR makes on a stage.
fn recorded(stage: &Stage, ray: &Ray) -> Vec<RayNode> {
    let settings =
        Settings { max_depth: stage.max_depth, min_weight: 0.0, at_limit: AtLimit::Black };
    let mut tree = RayTree::default();
    Whitted::new(World { scene: stage.scene, index: stage }, settings).trace(ray, &mut tree);
    tree.nodes
}

/// Glass makes more of the rounding of a direction, and the lamps are added up in another order.
#[test]
fn lr_and_its_tree_are_the_courses() {
    let scene = scenes::whitted();
    let size = ImageSize::new(24, 18);
    let (max_depth, mut mirrors) = (4, 0);
    for pixel in 0..24 * 18 {
        let (x, y) = (f64::from(pixel % 24) + 0.5, f64::from(pixel / 24) + 0.5);
        let call = Call::primary(&scene.camera.primary_rays(size).through(x, y));
        let stage = || Stage::new(&scene, max_depth, SOLVED);
        let course = recorded(&stage(), &call.ray);
        let radiance = lr(&stage(), &call.ray, 0);
        assert!(Shown::distance(&radiance, &course[0].radiance) < 1e-11, "{x} {y}");

        let tree = ray_tree(&stage(), &call);
        let nodes = listed(&tree);
        assert_eq!(nodes.len(), course.len(), "{x} {y}");
        for (node, course) in nodes.into_iter().zip(&course) {
            let traced = !matches!(course.end, RayEnd::Cut);
            let ours = (node.kind, node.depth, node.weight, node.traced);
            assert_eq!(ours, (course.call.kind, course.call.depth, course.call.weight, traced));
            // The course casts none to a lamp that would add nothing.
            assert!(node.shadows as usize >= course.shadows.len());
        }
        let counts = count_rays(&tree);
        let traced = course.iter().filter(|node| !matches!(node.end, RayEnd::Cut));
        assert_eq!(counts.total() - counts.shadow, traced.count() as u64);
        mirrors += counts.mirror;
    }
    assert!(mirrors > 20, "{mirrors}");
}

#[test]
fn a_pixels_mean_is_the_courses_to_the_bit() {
    let radiance = |x: f64, y: f64| Rgb::new(x.sin(), y.cos(), x * y);
    for (x, y, n) in [(3, 5, 1), (0, 9, 2), (7, 2, 5)] {
        let sampling = PixelSampling { pattern: Pattern::Regular, samples: n * n, seed: 0 };
        let course = sampling.of_pixel(x, y).map(|s| radiance(s.film.x, s.film.y)).sum::<Rgb>();
        assert_eq!(pixel_mean(&radiance, x, y, n), course / f64::from(n * n));
    }
}

/// The squares are added up in another order.
#[test]
fn the_error_of_a_picture_is_the_courses_to_rounding() {
    let mut random = Uniform::new(80, 0, 0);
    let size = ImageSize::new(16, 12);
    let pictures = [0; 2].map(|_| -> Vec<[f32; 3]> {
        (0..16 * 12).map(|_| point(&mut random).abs().as_vec3().to_array()).collect()
    });
    let pixels = pictures.each_ref().map(|picture| -> Vec<Rgb> {
        picture.iter().map(|pixel| DVec3::from(pixel.map(f64::from))).collect()
    });
    let [a, b] = pictures.map(|picture| Image::from_pixels(size, picture));
    let course = rmse(&a, &b).unwrap();
    let ours = rms_error(&pixels[0], &pixels[1]);
    assert!((ours / course - 1.0).abs() < 200.0 * EPSILON, "{ours} {course}");
}
