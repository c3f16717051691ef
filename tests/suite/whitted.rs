//! Chapter 1 against sums that can be written down.

use std::f64::consts::PI;

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::{Ray, Sphere};
use lancer_core::illumination::{Arriving, Reflectance, ambient, attenuation, lit, recursion};
use lancer_core::intersector::LinearScan;
use lancer_core::scene::{Emitter, Material, MaterialId, Mesh, PointLight, Scene, SphereObject};
use lancer_core::world::World;
use lancer_whitted::{Appel, AtLimit, RayCounts, RayEnd, RayTree, Settings, Whitted};

const UNLIMITED: Settings = Settings { max_depth: 5, min_weight: 0.0, at_limit: AtLimit::Black };

fn trace(scene: &Scene, settings: Settings, ray: Ray) -> (Rgb, RayCounts) {
    let oracle = LinearScan::new(scene);
    let mut counts = RayCounts::default();
    let method = Whitted::new(World { scene, index: &oracle }, settings);
    let radiance = method.trace(&ray, &mut counts);
    (radiance, counts)
}

/// A large square at height y facing `up`.
fn plate(scene: &mut Scene, y: f64, up: f64, material: u32) {
    let first = scene.mesh.positions.len() as u32;
    for (x, z) in [(-1e3, -1e3), (-1e3, 1e3), (1e3, 1e3), (1e3, -1e3)] {
        scene.mesh.positions.push(DVec3::new(x, y, z * up));
    }
    scene.mesh.push_face(
        MaterialId(material),
        &[[first, first + 1, first + 2], [first, first + 2, first + 3]],
    );
}

/// eq:local, eq:attenuation and eq:ambient, by hand.
#[test]
fn local_terms_by_hand() {
    assert_eq!(attenuation(true, 2.0), 0.25);
    assert_eq!(attenuation(false, 2.0), 0.0);
    let grey = Rgb::splat;
    assert_eq!(ambient(Rgb::new(0.5, 0.25, 1.0), grey(0.2)), Rgb::new(0.1, 0.05, 0.2));

    let n = DVec3::Y;
    let to_light = DVec3::new(0.6, 0.8, 0.0);
    let mirror = DVec3::new(-0.6, 0.8, 0.0);
    let reflectance =
        Reflectance { diffuse: Rgb::new(0.5, 0.25, 0.0), specular: grey(0.5), shininess: 10.0 };
    // A lamp of intensity 8 at distance 2.
    let arriving = |to_light: DVec3| Arriving {
        shadow_ray: Ray::new(DVec3::ZERO, 2.0 * to_light),
        intensity: |_: DVec3| grey(8.0),
    };
    let lit_by = |to_light, to_eye, visible| {
        lit(grey(0.1), &reflectance, n, to_eye, [arriving(to_light)], |_| visible) - grey(0.1)
    };
    // At full strength in the mirror direction: I g (ρ_d 0.8 + ρ_s).
    let full = lit_by(to_light, mirror, true);
    assert!((full - Rgb::new(1.8, 1.4, 1.0)).abs().max_element() < 1e-15, "{full}");
    assert_eq!(lit_by(to_light, mirror, false), Rgb::ZERO);
    // At 60 degrees off it: (1/2)^10.
    let eye =
        DVec3::new(-0.6 * 0.5 - 0.8 * 0.75_f64.sqrt(), 0.8 * 0.5 - 0.6 * 0.75_f64.sqrt(), 0.0);
    let dim = lit_by(to_light, eye, true);
    assert!((dim.z - 2.0 * 0.5 / 1024.0).abs() < 1e-15, "{dim}");
    // Opposite the mirror direction an even power must not light anything: only ρ_d is left.
    let behind = lit_by(to_light, -mirror, true);
    assert!((behind - Rgb::new(0.8, 0.4, 0.0)).abs().max_element() < 1e-15, "{behind}");
    // A light below the horizon is not even asked for.
    let never = |_: &Ray| -> bool { panic!("a shadow ray to a lamp that adds nothing") };
    assert_eq!(lit(grey(0.1), &reflectance, n, mirror, [arriving(-to_light)], never), grey(0.1));
}

#[test]
fn recursion_by_hand() {
    let got = recursion(
        Rgb::splat(1.0),
        Rgb::new(0.5, 0.25, 0.0),
        Rgb::splat(2.0),
        Rgb::splat(0.1),
        Rgb::splat(10.0),
    );
    assert_eq!(got, Rgb::new(3.0, 2.5, 2.0));
}

/// algo:appel on a floor under a light: I / d² ρ_d cos, and 0 in the shadow of a sphere that reaches
/// from h = 4 over a sphere of radius 1 at h = 2 to 2.3094 on the floor.
#[test]
fn appel_lights_and_shades_a_floor() {
    let mut scene = Scene::of_mesh(Mesh::default());
    plate(&mut scene, 0.0, 1.0, 0);
    scene.lights.push(PointLight { position: DVec3::Y * 4.0, intensity: Rgb::splat(32.0) });
    let shape = Sphere { center: DVec3::Y * 2.0, radius: 1.0 };
    scene.spheres.push(SphereObject { shape, material: MaterialId(0) });
    scene.ambient = Rgb::splat(0.25);
    let oracle = LinearScan::new(&scene);
    let appel = Appel::new(World { scene: &scene, index: &oracle });
    let floor = |x: f64| {
        let eye = DVec3::new(x, 0.5, 0.0);
        appel.trace(&Ray::new(eye, DVec3::NEG_Y), &mut ()).x
    };
    let ambient = 0.5 * 0.25;
    // At x = 3 the light is at distance 5, under cos = 4/5.
    assert!((floor(3.0) - (ambient + 32.0 / 25.0 * 0.5 * 0.8)).abs() < 1e-14);
    let edge = 2.30940107675850;
    assert_eq!(floor(edge - 1e-9), ambient);
    assert!(floor(edge + 1e-9) > 2.0 * ambient);
    // No light reaches a surface from behind: the ray from below sees the floor's dark side.
    let below = appel.trace(&Ray::new(DVec3::new(3.0, -1.0, 0.0), DVec3::Y), &mut ());
    assert_eq!(below.x, ambient);
}

/// The interior of a diffuse sphere of ρ = ½ lit from its centre: I / r² ρ_d everywhere.
#[test]
fn direct_light_in_a_sphere() {
    let mut scene = Scene::of_mesh(Mesh::default());
    let shape = Sphere { center: DVec3::splat(2.0), radius: 1.0 };
    scene.spheres.push(SphereObject { shape, material: MaterialId(0) });
    scene.lights.push(PointLight { position: shape.center, intensity: Rgb::ONE });
    for direction in [DVec3::X, DVec3::new(2.0, 3.0, -6.0) / 7.0] {
        let (radiance, _) = trace(&scene, UNLIMITED, Ray::new(DVec3::splat(2.1), direction));
        assert!((radiance - 0.5).abs().max_element() < 1e-14, "{radiance}");
    }
}

/// eq:recursion and algo:lr between two parallel mirrors that emit 1: the sum of k_s^m, and what is
/// left of it beyond Max_Prof follows the choice of the colour there.
#[test]
fn parallel_mirrors_sum_a_geometric_series() {
    let mut scene = Scene::of_mesh(Mesh::default());
    plate(&mut scene, 0.0, 1.0, 0);
    plate(&mut scene, 1.0, -1.0, 0);
    scene.materials[0] =
        Material { k_s: Rgb::splat(0.5), emission: Rgb::ONE, ..Material::matte(Rgb::ZERO) };
    scene.ambient = Rgb::splat(2.0);
    scene.background = Rgb::splat(3.0);
    let ray = Ray::new(DVec3::new(0.0, 0.5, 0.0), DVec3::new(0.6, 0.8, 0.0));
    for max_depth in [0, 1, 2, 5, 12] {
        let series = 2.0 - 0.5_f64.powi(max_depth);
        let rest = 0.5_f64.powi(max_depth + 1);
        for (at_limit, color) in
            [(AtLimit::Black, 0.0), (AtLimit::Ambient, 2.0), (AtLimit::Background, 3.0)]
        {
            let settings = Settings { max_depth: max_depth as u32, min_weight: 0.0, at_limit };
            let (radiance, counts) = trace(&scene, settings, ray);
            assert!(
                (radiance.x - (series + rest * color)).abs() < 1e-14,
                "{max_depth} {at_limit:?}"
            );
            assert_eq!((counts.primary, counts.mirror), (1, max_depth as u64));
        }
    }
    // A minimum weight of 1/8 lets through the weights 1, 1/2, 1/4 and 1/8.
    let settings = Settings { max_depth: 100, min_weight: 0.125, at_limit: AtLimit::Black };
    let (radiance, counts) = trace(&scene, settings, ray);
    assert_eq!((radiance.x, counts.total()), (1.875, 4));
}

/// Russian roulette between the mirrors of the geometric series, whose rays have the weights 1, 1/2, 1/4 …:
/// below a minimum weight of 1/2 each bounce survives with probability ½ and its answer counts ½ again.
/// With K the bounces after the first, P(K = k) = ½^(k+1), the answer is 1 + ½ (1 + K): its mean is 2, the
/// series to infinity, and its variance Var(K) / 4 = 2 / 4. A false alarm in a million.
#[test]
fn roulette_is_right_on_average() {
    let mut scene = Scene::of_mesh(Mesh::default());
    plate(&mut scene, 0.0, 1.0, 0);
    plate(&mut scene, 1.0, -1.0, 0);
    scene.materials[0] =
        Material { k_s: Rgb::splat(0.5), emission: Rgb::ONE, ..Material::matte(Rgb::ZERO) };
    scene.background = Rgb::splat(3.0);
    let roulette = |max_depth, min_weight, seed| Settings {
        max_depth,
        min_weight,
        at_limit: AtLimit::Roulette { seed },
    };
    let count = 20_000;
    // The second comes back bit for bit at each bounce.
    let directions = [DVec3::new(0.6, 0.8, 0.0), DVec3::Y];
    for ray in directions.map(|direction| Ray::new(DVec3::new(0.0, 0.5, 0.0), direction)) {
        let mut mean = 0.0;
        for seed in 0..count {
            let (radiance, counts) = trace(&scene, roulette(1000, 0.5, seed), ray);
            assert_eq!(radiance.x, 1.0 + 0.5 * counts.mirror as f64);
            mean += radiance.x / count as f64;
        }
        assert!((mean - 2.0).abs() < 5.0 * (0.5 / count as f64).sqrt(), "{mean}");
    }
    let ray = Ray::new(DVec3::new(0.0, 0.5, 0.0), DVec3::new(0.6, 0.8, 0.0));
    // No ray is light enough to play, or all are too deep: then it is black's picture.
    for (max_depth, min_weight) in [(3, 0.125), (0, 1.0)] {
        let black = Settings { max_depth, min_weight, at_limit: AtLimit::Black };
        assert_eq!(
            trace(&scene, roulette(max_depth, min_weight, 7), ray),
            trace(&scene, black, ray)
        );
    }
}

/// fig:ray-tree: glass that reflects as well splits every ray in two; five bounces make 63 rays.
#[test]
fn a_full_binary_tree_of_depth_five_has_63_rays() {
    let mut scene = Scene::of_mesh(Mesh::default());
    for y in -40..40 {
        plate(&mut scene, f64::from(y), 1.0, 0);
    }
    scene.materials[0] = Material {
        k_s: Rgb::splat(0.5),
        k_t: Rgb::splat(0.5),
        refractive_index: 1.0,
        ..Material::matte(Rgb::ZERO)
    };
    let ray = Ray::new(DVec3::new(0.0, 0.5, 0.0), DVec3::new(0.6, -0.8, 0.0));
    let (_, counts) = trace(&scene, UNLIMITED, ray);
    assert_eq!(counts.total(), 63);
    let oracle = LinearScan::new(&scene);
    let mut tree = RayTree::default();
    Whitted::new(World { scene: &scene, index: &oracle }, UNLIMITED).trace(&ray, &mut tree);
    assert_eq!(tree.traced(), 63);
    assert_eq!(tree.nodes.len(), 127, "and 64 that the depth limit cuts");
    for node in &tree.nodes {
        let parent = node.parent.map(|parent| tree.nodes[parent].call);
        assert_eq!(node.call.depth, parent.map_or(0, |call| call.depth + 1));
        assert_eq!(node.call.weight, 0.5_f64.powi(node.call.depth as i32));
        assert_eq!(matches!(node.end, RayEnd::Cut), node.call.depth == 6);
    }
}

/// Inside glass beyond the critical angle nothing passes, and the mirror ray gets k_s + k_t.
#[test]
fn total_reflection_gives_its_share_to_the_mirror() {
    let mut scene = Scene::of_mesh(Mesh::default());
    plate(&mut scene, 0.0, 1.0, 0);
    plate(&mut scene, -1.0, 1.0, 1);
    scene.materials = vec![
        Material {
            k_s: Rgb::splat(0.25),
            k_t: Rgb::splat(0.5),
            refractive_index: 1.5,
            ..Material::matte(Rgb::ZERO)
        },
        Material { emission: Rgb::ONE, ..Material::matte(Rgb::ZERO) },
    ];
    scene.background = Rgb::splat(10.0);
    let inside = DVec3::new(0.0, -0.5, 0.0);
    let steep = Ray::new(inside, DVec3::new(0.6, 0.8, 0.0));
    let flat = Ray::new(inside, DVec3::new(0.8, 0.6, 0.0));
    // sin θ = 0.6 < 2/3 < 0.8: one side passes to the background, the other sees the floor only.
    let (passes, _) = trace(&scene, UNLIMITED, steep);
    assert!((passes.x - (0.25 * 1.0 + 0.5 * 10.0)).abs() < 1e-14, "{passes}");
    let (turned, counts) = trace(&scene, UNLIMITED, flat);
    assert!((turned.x - 0.75).abs() < 1e-14, "{turned}");
    assert_eq!((counts.mirror, counts.refracted), (1, 0));
}

/// A ball of index 1 and k_t = 1 is not there.
#[test]
fn glass_of_index_one_is_invisible() {
    let mut scene = Scene::of_mesh(Mesh::default());
    scene.background = Rgb::new(0.1, 0.2, 0.3);
    scene.materials[0] = Material { k_t: Rgb::ONE, ..Material::matte(Rgb::ZERO) };
    let shape = Sphere { center: DVec3::Z * 4.0, radius: 1.0 };
    scene.spheres.push(SphereObject { shape, material: MaterialId(0) });
    let ray = Ray::new(DVec3::ZERO, DVec3::new(0.1, 0.1, 1.0).normalize());
    let (radiance, counts) = trace(&scene, UNLIMITED, ray);
    assert_eq!(radiance, scene.background);
    assert_eq!(counts.refracted, 2);
}

/// An area light counts as a point of the same power with the same cosine: from far away both agree,
/// a white surface there has the radiance L A cos cos' / (π d²), and nothing shines backwards.
#[test]
fn an_area_light_is_a_point_at_its_centroid() {
    let mut scene = Scene::of_mesh(Mesh::default());
    plate(&mut scene, 0.0, 1.0, 0);
    scene.materials = vec![
        Material::matte(Rgb::ONE),
        Material { emission: Rgb::splat(100.0), ..Material::matte(Rgb::ZERO) },
    ];
    // A rectangle of area 0.5 at height 10 that faces down, as one face of two triangles.
    let first = scene.mesh.positions.len() as u32;
    for (x, z) in [(-0.5, -0.25), (0.5, -0.25), (0.5, 0.25), (-0.5, 0.25)] {
        scene.mesh.positions.push(DVec3::new(x, 10.0, z));
    }
    scene
        .mesh
        .push_face(MaterialId(1), &[[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    let sources = scene.point_sources();
    assert_eq!(sources.len(), 1);
    // Off the face by 256 roundings of the largest coordinate, 1000.
    assert!((sources[0].position - DVec3::Y * 10.0).length() < 1e-10);

    let look = |x: f64| trace(&scene, UNLIMITED, Ray::new(DVec3::new(x, 0.5, 0.0), DVec3::NEG_Y));
    let (below, counts) = look(0.0);
    assert!((below.x - 100.0 * 0.5 / (100.0 * PI)).abs() < 1e-11, "{below}");
    assert_eq!(counts.shadow, 1);
    let (aside, _) = look(10.0);
    assert!((aside.x - 50.0 * 0.5 / (200.0 * PI)).abs() < 1e-11, "{aside}");
    // Above the light its own face stands in the way of nothing: it does not shine there at all.
    plate(&mut scene, 20.0, -1.0, 0);
    let ceiling = trace(&scene, UNLIMITED, Ray::new(DVec3::new(0.0, 19.0, 0.0), DVec3::Y));
    assert_eq!(ceiling.0, Rgb::ZERO);
}

/// A light in the plane of the receiver does not shine on it: the irradiance is exactly 0.
#[test]
fn a_light_in_the_receivers_plane_gives_nothing() {
    let mut scene = Scene::of_mesh(Mesh::default());
    plate(&mut scene, 0.0, 1.0, 0);
    scene.lights.push(PointLight { position: DVec3::X * 5.0, intensity: Rgb::splat(1e6) });
    let ray = Ray::new(DVec3::new(0.1, 1.0, 0.2), DVec3::NEG_Y);
    assert_eq!(trace(&scene, UNLIMITED, ray).0, Rgb::ZERO);
}

/// A lamp does not stand in its own light, wherever it is and however it is turned: nothing else is in
/// the scene, so every point of the floor that it faces is lit.
#[test]
fn lamps_do_not_shade_themselves() {
    let turns = [DVec3::NEG_Y, DVec3::new(0.3, -0.9, 0.1), DVec3::new(-0.2, -0.7, 0.6)];
    for center in [0.0, 1e-3, 3.0, 1e4] {
        for n in turns.map(DVec3::normalize) {
            let mut scene = Scene::of_mesh(Mesh::default());
            plate(&mut scene, center - 3.0, 1.0, 0);
            let lamp = Material { emission: Rgb::ONE, ..Material::matte(Rgb::ZERO) };
            scene.materials.push(lamp);
            let (x, z) = n.any_orthonormal_pair();
            let first = scene.mesh.positions.len() as u32;
            let corners = [x + z, z - x, -x - z, x - z];
            scene.mesh.positions.extend(corners.map(|p| DVec3::Y * center + 0.5 * p));
            scene.mesh.push_face(
                MaterialId(1),
                &[[first, first + 1, first + 2], [first, first + 2, first + 3]],
            );
            let lamp = scene.point_sources()[0];
            let Emitter::Face { normal: facing } = lamp.emitter else { panic!("a face") };
            let turned_to = if facing.dot(n) > 0.0 { 1.0 } else { -1.0 };
            let mut random = crate::random::Random::new(71);
            for _ in 0..2_000 {
                let foot =
                    DVec3::new(random.between(-40.0, 40.0), 0.0, random.between(-40.0, 40.0));
                let eye = foot + DVec3::Y * (center - 2.9);
                let floor = eye - 0.1 * DVec3::Y;
                let (radiance, _) = trace(&scene, UNLIMITED, Ray::new(eye, DVec3::NEG_Y));
                let faces = turned_to * n.dot((floor - lamp.position).normalize()) > 1e-9;
                assert_eq!(radiance.x > 0.0, faces, "lamp at {center} facing {n}, floor {floor}");
            }
        }
    }
}

/// A smooth mesh of a unit sphere as a material of ρ_d = 1.
fn smooth_sphere(level: u32) -> Scene {
    let mut mesh = lancer_core::generate::icosphere(level);
    mesh.normals = mesh.positions.clone();
    mesh.smooth = mesh.triangles.iter().map(|t| Some(t.vertices)).collect();
    let mut scene = Scene::of_mesh(mesh);
    scene.materials[0] = Material::matte(Rgb::ONE);
    scene
}

/// The terminator of a tessellated sphere: where the smooth sphere is lit, no facet shades it.
#[test]
fn facets_do_not_shade_a_smooth_sphere() {
    for level in 1..4 {
        let mut scene = smooth_sphere(level);
        let to_light = DVec3::new(0.36, 0.48, 0.8);
        scene.lights.push(PointLight { position: 1e6 * to_light, intensity: Rgb::splat(1e12) });
        let mut flat = scene.clone();
        (flat.mesh.normals, flat.mesh.smooth) = (Vec::new(), Vec::new());
        let mut random = crate::random::Random::new(73);
        let (mut dark, mut dark_flat) = (0, 0);
        for _ in 0..20_000 {
            let out = random.direction();
            let ray = Ray::new(3.0 * out, -out);
            let oracle = LinearScan::new(&scene);
            let hit = lancer_core::intersector::Intersector::closest_hit(
                &oracle,
                &ray,
                lancer_core::geometry::Interval::POSITIVE,
            );
            let surface = scene.surface_at(&ray, &hit.unwrap());
            // A thousandth inside the lit half.
            if surface.shading_normal.dot(to_light) > 1e-3 {
                dark += usize::from(trace(&scene, UNLIMITED, ray).0 == Rgb::ZERO);
                dark_flat += usize::from(trace(&flat, UNLIMITED, ray).0 == Rgb::ZERO);
            }
        }
        assert_eq!(dark, 0, "level {level}: points wrongly black");
        assert!(dark_flat > 20, "level {level}: facets shade only {dark_flat} points");
    }
}

/// From inside, a smooth mesh is lit by a light inside like any other surface.
#[test]
fn a_smooth_sphere_is_lit_from_inside() {
    let mut scene = smooth_sphere(3);
    scene.lights.push(PointLight { position: DVec3::ZERO, intensity: Rgb::ONE });
    let mut random = crate::random::Random::new(79);
    for _ in 0..2_000 {
        let ray = Ray::new(random.in_cube(0.3), random.direction());
        let (radiance, _) = trace(&scene, UNLIMITED, ray);
        assert!((radiance.x - 1.0).abs() < 0.05, "{radiance}");
    }
}

/// A lamp's back is dark, as the light that it gives says.
#[test]
fn lamps_shine_on_one_side() {
    let mut scene = Scene::of_mesh(Mesh::default());
    plate(&mut scene, 0.0, 1.0, 0);
    scene.materials[0] = Material { emission: Rgb::ONE, ..Material::matte(Rgb::ZERO) };
    let look = |y: f64| trace(&scene, UNLIMITED, Ray::new(DVec3::Y * y, -DVec3::Y * y.signum())).0;
    assert_eq!((look(1.0), look(-1.0)), (Rgb::ONE, Rgb::ZERO));
}

/// The sphere of radius `radius` and radiance 1 around `center`, over a white floor at y = 0.
fn under_a_sphere(center: DVec3, radius: f64) -> Scene {
    let mut scene = Scene::of_mesh(Mesh::default());
    plate(&mut scene, 0.0, 1.0, 0);
    let lamp = Material { emission: Rgb::ONE, ..Material::matte(Rgb::ZERO) };
    scene.materials = vec![Material::matte(Rgb::ONE), lamp];
    scene.spheres.push(SphereObject { shape: Sphere { center, radius }, material: MaterialId(1) });
    scene
}

/// The irradiance E = π r² cos / d² of a sphere that is above the horizon, over π; tables have 1.3962634015955 at d = 1.5,
/// 0.34906585039887 at 3 and 3.1415926535898e-16 at 1e8. The floor is 1000 wide.
#[test]
fn a_sphere_is_a_point_at_its_centre() {
    let look = |scene: &Scene, x: f64| {
        trace(scene, UNLIMITED, Ray::new(DVec3::new(x, 0.25, 0.0), DVec3::NEG_Y))
    };
    for (distance, irradiance) in [(1.5, 1.3962634015955), (3.0, 0.34906585039887)] {
        let scene = under_a_sphere(DVec3::Y * distance, 1.0);
        let (below, counts) = look(&scene, 0.0);
        assert!((below.x * PI - irradiance).abs() < 1e-12, "{below}");
        assert_eq!(counts.shadow, 1);
        // 45 degrees aside: twice the square of the distance, and the cosine √½.
        let (aside, _) = look(&scene, distance);
        assert!((aside.x * PI - irradiance * 0.5_f64.powf(1.5)).abs() < 1e-12, "{aside}");
    }
    // As small and as large as can be.
    for (radius, distance) in [(1e-6, 3.0), (1e-6, 1.1e-6), (100.0, 101.0), (1e8, 1.5e8)] {
        let scene = under_a_sphere(DVec3::Y * distance, radius);
        let eye = DVec3::Y * (0.5 * (distance - radius));
        let (below, _) = trace(&scene, UNLIMITED, Ray::new(eye, DVec3::NEG_Y));
        let wanted = (radius / distance).powi(2);
        assert!((below.x / wanted - 1.0).abs() < 1e-6, "{radius} {distance}: {below}");
    }
}

/// What is in a sphere neither shades the floor nor is lit; what is before it does.
#[test]
fn shadow_rays_end_where_they_enter_a_sphere() {
    let ball = |y: f64| SphereObject {
        shape: Sphere { center: DVec3::Y * y, radius: 0.125 },
        material: MaterialId(0),
    };
    for (y, is_lit) in [(3.0, true), (2.13, true), (1.87, false), (1.0, false), (4.2, true)] {
        let mut scene = under_a_sphere(DVec3::Y * 3.0, 1.0);
        scene.spheres.push(ball(y));
        let (floor, _) =
            trace(&scene, UNLIMITED, Ray::new(DVec3::new(0.0, 0.25, 0.0), DVec3::NEG_Y));
        assert_eq!(floor.x > 0.0, is_lit, "a ball at {y}: {floor}");
        // From every side, and from inside the lamp.
        for direction in [DVec3::NEG_Y, DVec3::Y, DVec3::new(0.8, 0.6, 0.0)] {
            let start = DVec3::Y * y - 0.25 * direction;
            let (found, _) = trace(&scene, UNLIMITED, Ray::new(start, direction));
            let inside = (y - 3.0_f64).abs() + 0.25 <= 1.0;
            assert!(found.is_finite() && (!inside || found == Rgb::ZERO), "{y}: {found}");
        }
    }
    // At its very centre, where there is no direction to the source.
    let mut scene = under_a_sphere(DVec3::Y * 3.0, 1.0);
    let first = scene.mesh.positions.len() as u32;
    scene.mesh.positions.extend([DVec3::new(-0.5, 3.0, -0.5), DVec3::new(0.5, 3.0, -0.5)]);
    scene.mesh.positions.push(DVec3::new(0.0, 3.0, 0.5));
    scene.mesh.push_face(MaterialId(0), &[[first, first + 2, first + 1]]);
    for direction in [DVec3::NEG_Y, DVec3::Y] {
        let (found, _) =
            trace(&scene, UNLIMITED, Ray::new(DVec3::Y * 3.0 - 0.5 * direction, direction));
        assert_eq!(found, Rgb::ZERO);
    }
    // The eye in it sees nothing of its light.
    let inside = under_a_sphere(DVec3::Y * 3.0, 1.0);
    assert_eq!(trace(&inside, UNLIMITED, Ray::new(DVec3::Y * 3.0, DVec3::X)).0, Rgb::ZERO);
    // Lying on the floor it lights all of it, down to the point where they touch.
    let touching = under_a_sphere(DVec3::Y, 1.0);
    for x in [0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.1] {
        let ray =
            Ray::new(DVec3::new(x + 1.0, 1e-4, 0.0), DVec3::new(-1.0, -1e-4, 0.0).normalize());
        let found = trace(&touching, UNLIMITED, ray).0;
        let lit = Rgb::splat((1.0 + x * x).powf(-1.5));
        assert!((found - lit).abs().max_element() < 1e-3 || found == Rgb::ZERO, "{x}: {found}");
        assert!(found != Rgb::ZERO || x < 1e-6, "{x}");
    }
}
