use glam::DVec3;
use lancer_core::generate::icosphere;
use lancer_core::geometry::leave_surface;
use lancer_core::intersector::{LinearScan, TestCounts};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

use super::lanes::Lanes;
use super::packet::Packet;
use super::ray::WideRay;
use super::*;
use crate::four_boxes::FourSlabs;
use crate::hard_sets::{hard_sets, triangles};

pub(super) fn kernels() -> Vec<Kernel> {
    let mut kernels = vec![Kernel::Scalar(Scalar)];
    if Wide::has_vectors() {
        kernels.push(Kernel::best());
    }
    kernels
}

#[test]
fn hard_sets_are_built() {
    for (name, scene) in &hard_sets(100_000) {
        assert_eq!(Wide::build(scene).validate(scene), Ok(()), "{name}");
    }
}

#[test]
fn a_validation_finds_what_is_wrong() {
    let scene = Scene::of_mesh(icosphere(3));
    let broken = |harm: &dyn Fn(&mut Wide)| {
        let mut wide = Wide::build(&scene);
        assert_eq!(wide.validate(&scene), Ok(()));
        harm(&mut wide);
        wide.validate(&scene).unwrap_err()
    };
    let leaf = |wide: &Wide| {
        let node = wide.nodes.iter().position(|node| node.children[0].is_leaf()).unwrap();
        (node, wide.nodes[node].children[0])
    };
    let small = broken(&|wide| {
        let (node, _) = leaf(wide);
        wide.nodes[node].planes[0][1][0] = wide.nodes[node].planes[0][0][0];
    });
    assert!(small.contains("sticks out"), "{small}");
    let twice = broken(&|wide| {
        let (_, leaf) = leaf(wide);
        let [first, second] = [0, 1].map(|lane| Wide::record(leaf, lane) as usize);
        wide.leaves[first] = wide.leaves[second];
    });
    assert!(twice.ends_with("is twice in a leaf"), "{twice}");
    let missing = broken(&|wide| {
        let (node, _) = leaf(wide);
        wide.nodes[node].set_box(0, FrameBox::EMPTY);
    });
    assert!(missing.ends_with("is in no leaf"), "{missing}");
}

/// Nodes and leaves are well filled: n triangles take fewer than n / 4 nodes, and 70 bytes each.
#[test]
fn a_tree_is_small() {
    let scene = Scene::of_mesh(icosphere(5));
    let wide = Wide::build(&scene);
    let count = scene.mesh.triangles.len();
    assert!(wide.nodes.len() < count / 4 && wide.memory() < 70 * count, "{}", wide.memory());
}

/// The proof in the documentation, tried: what `f64` meets the filter keeps; what is certain `f64` meets;
/// and the parameter lies between the ends of its interval. Triangles of all sizes and shapes in the frame
/// [−1, 1]³, rays aimed at corners, edges, the inside and just beside, from near and far.
#[test]
fn the_bounds_hold() {
    let mut random = Pcg64::new(11, 3);
    let mut number = move || f64::from(random.next_u32()) / f64::from(1 << 31) - 1.0;
    let (mut met, mut certain, mut kept) = (0, 0, 0);
    const RAYS: u32 = 60_000;
    for k in 0..RAYS {
        let mut vector = || DVec3::new(number(), number(), number());
        let size = 2.0_f64.powi(-(k as i32 % 16));
        let a = 0.9 * vector();
        let (e, mut f) = (0.05 * size * vector(), 0.05 * size * vector());
        if k % 3 == 0 {
            // A sliver.
            f = e * 0.5 + f * 1e-4;
        }
        let target = match k % 5 {
            0 => a,
            1 => a + e * 0.3,
            2 => a + e * 0.3 + f * 0.3,
            3 => a + (e + f) * (0.5 + 1e-7 * vector().x),
            _ => a + vector() * size * 0.05,
        };
        let origin = match k / 16 % 8 {
            // Nearly edge-on, so that the sign of the determinant is in doubt.
            6 | 7 => {
                let along = (e * vector().x + f * vector().y).normalize_or_zero();
                let normal = e.cross(f).normalize_or_zero();
                target + along * 3.0 * vector().x + normal * 1e-7 * vector().x
            }
            0 => target + vector() * size,
            1 => 3.0 * vector(),
            2 => 2e3 * vector(),
            4 => 12.0 * vector(),
            5 => 15.9 * vector().normalize(),
            _ => a + e * 0.2 + f * 0.2,
        };
        let toward = if k % 7 == 0 { target - origin + 1e-9 * vector() } else { target - origin };
        let corner = |p: f64| [DVec3::splat(p); 3];
        let scene = triangles([[a, a + e, a + f], corner(-1.0), corner(1.0)]);
        let ray = Ray::new(origin, toward);
        let mut probe = Probe::new(&scene, &ray, Interval::POSITIVE);
        let answer = probe.test(PrimitiveId(0)).then(|| probe.best().unwrap().t);
        met += u32::from(answer.is_some());
        for kernel in kernels() {
            let wide = Wide::tree((&scene).into(), kernel);
            let filtered = match kernel {
                #[cfg(target_arch = "x86_64")]
                Kernel::Avx2(lanes) => filter_first(lanes, &wide, &ray),
                Kernel::Scalar(lanes) => filter_first(lanes, &wide, &ray),
            };
            assert!(answer.is_none() || filtered.is_some(), "lost {k}: {ray:?} {a} {e} {f}");
            let Some((slabs, is_certain, lowest, highest)) = filtered else { continue };
            kept += 1;
            certain += u32::from(is_certain);
            if let Some(t) = answer.map(|t| slabs.parameter(t)) {
                assert!(lowest <= t, "{k}: {lowest} {t} {highest}");
                // The parameter was rounded up.
                let least = t * (1.0 - 2.0 * f32::EPSILON);
                assert!(!is_certain || least <= highest, "{k}: {lowest} {t} {highest}");
            }
            assert!(!is_certain || answer.is_some(), "not certain at all {k}: {ray:?} {a} {e} {f}");
        }
    }
    assert!(met > RAYS / 8 && certain > RAYS / 64 && kept > certain, "{met} {certain} {kept}");
}

/// What the filter says of primitive 0, if it keeps it. The frame is the world.
fn filter_first<L: Lanes>(lanes: L, wide: &Wide, ray: &Ray) -> Option<(FourSlabs, bool, f32, f32)> {
    let wide_ray = WideRay::new(lanes, wide, ray);
    let leaves = wide.nodes.iter().flat_map(|node| {
        node.children.iter().zip(0..).map(move |(child, lane)| (node, *child, lane))
    });
    let mut leaves = leaves
        .filter(|(node, child, lane)| child.is_leaf() && node.bounds(*lane) != FrameBox::EMPTY);
    let (leaf, lane) = leaves.find_map(|(_, leaf, _)| {
        let lane = wide.primitives(leaf).position(|id| id == PrimitiveId(0))?;
        Some((leaf, lane))
    })?;
    let words = wide.words(leaf);
    let filtered = wide_ray.filter(lanes, words, leaf.count(), f32::INFINITY);
    if filtered.kept >> lane & 1 == 0 {
        return None;
    }
    let (certain, lowest, highest) = filtered.certain(lanes, wide_ray.least(Interval::POSITIVE));
    let (lowest, highest) = (lanes.store(lowest)[lane], lanes.store(highest)[lane]);
    Some((wide_ray.slabs, certain >> lane & 1 != 0, lowest, highest))
}

/// The walk goes down to what the ray meets, and to little else.
#[test]
fn a_ray_in_the_open_asks_little() {
    let scene = Scene::of_mesh(icosphere(4));
    for kernel in kernels() {
        let wide = Wide::tree((&scene).into(), kernel);
        let mut counts = TestCounts::default();
        let ray = Ray::new(DVec3::new(0.1, 0.2, 3.0), DVec3::NEG_Z);
        assert!(wide.watch(Query::closest(&ray, Interval::POSITIVE), &mut counts).is_some());
        // Four levels of eight boxes, a leaf or two.
        assert!(counts.boxes <= 8 * 8 && counts.primitives <= 24, "{counts:?}");
    }
}

/// What rays from one point meet, together: aimed at the corners, edges and inside of one triangle and its
/// like, from outside, from a corner, along an axis and from within.
#[test]
fn a_packet_answers_as_brute_force() {
    let mut random = Pcg64::new(5, 9);
    let mut number = move || f64::from(random.next_u32()) / f64::from(u32::MAX);
    let (mut together, mut hits) = (0, 0);
    for offset in [DVec3::ZERO, DVec3::new(148_376.0, 1234.0, -223_423.0)] {
        let mut mesh = icosphere(3);
        // Every face of an inner sphere twice: ties decide.
        for _ in 0..2 {
            mesh.append(&icosphere(2), glam::DAffine3::from_scale(DVec3::splat(0.5)), 0);
        }
        for position in &mut mesh.positions {
            *position += offset;
        }
        let scene = Scene::of_mesh(mesh);
        let oracle = LinearScan::new(&scene);
        let trees: Vec<_> = kernels()
            .into_iter()
            .map(|kernel| (kernel, Wide::tree((&scene).into(), kernel)))
            .collect();
        for k in 0..300 {
            let mut vector = || DVec3::new(number(), number(), number()) * 2.0 - 1.0;
            let place = vector();
            let triangle = (place.x.abs() * scene.mesh.triangles.len() as f64) as usize;
            let corners = scene.mesh.corners(triangle);
            let origin = match k % 5 {
                0 => corners[0] + 8.0 * DVec3::AXES[k % 3],
                1 => corners[1] + 0.3 * place,
                2 => scene.mesh.corners((triangle + 7) % scene.mesh.triangles.len())[2],
                3 => offset + 0.2 * place,
                _ => offset + 3.5 * place.normalize(),
            };
            // Some beside the triangle: others are met there.
            let spread = [1.0, 1.0, 3.0][k % 3];
            let rays: Vec<Ray> = (0..64 - k % 7)
                .map(|ray| {
                    let (u, v) = (number(), number());
                    let weights = match ray % 4 {
                        0 => [DVec3::X, DVec3::Y, DVec3::Z][ray / 4 % 3],
                        1 => DVec3::new(u, 1.0 - u, 0.0),
                        _ => DVec3::new(u * v, u * (1.0 - v), 1.0 - u) * spread,
                    };
                    let weights = weights / weights.element_sum();
                    let [a, b, c] = corners;
                    let target = a * weights.x + b * weights.y + c * weights.z;
                    Ray::new(origin, (target - origin) * (0.5 + v))
                })
                .collect();
            for range in [Interval::POSITIVE, Interval::up_to(1.0), Interval { min: 0.7, max: 1.5 }]
            {
                let wanted: Vec<_> =
                    rays.iter().map(|ray| oracle.closest_hit(ray, range)).collect();
                for (kernel, wide) in &trees {
                    let mut got = vec![None; rays.len()];
                    wide.closest_hits(&rays, range, &mut got);
                    assert_eq!(difference(&got, &wanted), None, "{k} {kernel:?} {range:?}");
                    let answered = match *kernel {
                        #[cfg(target_arch = "x86_64")]
                        Kernel::Avx2(lanes) => packet(lanes, wide, &rays, range),
                        Kernel::Scalar(lanes) => packet(lanes, wide, &rays, range),
                    };
                    let Some(answered) = answered else { continue };
                    together += 1;
                    hits += wanted.iter().flatten().count();
                    assert_eq!(difference(&answered, &wanted), None, "{k} {kernel:?}, together");
                }
            }
        }
    }
    assert!(together > 1000 && hits > 40 * 1000, "{together} {hits}");
}

/// Rays that have nothing in common, aimed at corners, edges and the inside of triangles, from the surface and from
/// anywhere: alone and together they meet what they meet by brute force, also where each triangle is in two leaves.
#[test]
fn many_rays_answer_as_brute_force() {
    let mut random = Pcg64::new(8, 4);
    let mut number = move || f64::from(random.next_u32()) / f64::from(u32::MAX);
    let mut mesh = icosphere(3);
    mesh.append(&icosphere(2), glam::DAffine3::from_scale(DVec3::splat(0.5)), 0);
    let once = mesh.triangles.len() as u32;
    let copy = mesh.clone();
    mesh.append(&copy, glam::DAffine3::IDENTITY, 0);
    let scene = Scene::of_mesh(mesh);
    let rays: Vec<Ray> = (0..4000)
        .map(|k| {
            let mut corners = || scene.mesh.corners((number() * f64::from(once)) as usize);
            let ([a, b, c], [d, e, f]) = (corners(), corners());
            let target = [a, (a + b) / 2.0, a * 0.3 + b * 0.3 + c * 0.4][k % 3];
            let start = d * 0.2 + e * 0.5 + f * 0.3;
            let normal = (e - d).cross(f - d).normalize();
            let error = start.abs() * 1e-15;
            let origin = match k / 3 % 3 {
                0 => leave_surface(start, error, normal, target - start),
                1 => d,
                _ => 2.0 * start,
            };
            Ray::new(origin, target - origin)
        })
        .collect();
    let oracle = LinearScan::new(&scene);
    for kernel in kernels() {
        let wide = Wide::with_kernel((&scene).into(), kernel);
        let mut doubled = Wide::with_kernel((&scene).into(), kernel);
        for child in doubled.nodes.clone().iter().flat_map(|node| node.children) {
            for lane in (0..child.count()).filter(|_| child.is_leaf()) {
                let record = Wide::record(child, lane) as usize;
                let id = integer_of(doubled.leaves[record]);
                doubled.leaves[record] = leaf::word_of(id % once);
            }
        }
        for range in [Interval::POSITIVE, Interval::up_to(1.0), Interval::up_to(0.999)] {
            let wanted: Vec<_> = rays.iter().map(|ray| oracle.closest_hit(ray, range)).collect();
            assert!(wanted.iter().flatten().count() > 1000);
            for wide in [&wide, &doubled] {
                let alone: Vec<_> = rays.iter().map(|ray| wide.closest_hit(ray, range)).collect();
                assert_eq!(difference(&alone, &wanted), None, "{kernel:?} {range:?}");
                let mut together = vec![None; rays.len()];
                wide.closest_hits(&rays, range, &mut together);
                assert_eq!(difference(&together, &wanted), None, "{kernel:?} {range:?}");
                let mut occluded = vec![false; rays.len()];
                wide.occluded_all(&rays, range, &mut occluded);
                for ((ray, occluded), wanted) in rays.iter().zip(occluded).zip(&wanted) {
                    assert_eq!(occluded, wanted.is_some(), "{kernel:?} {ray:?} {range:?}");
                    assert_eq!(wide.occluded(ray, range), occluded, "{kernel:?} {ray:?}");
                }
            }
        }
    }
}

/// The first answer that is wrong, and the right one.
fn difference(got: &[Option<Hit>], wanted: &[Option<Hit>]) -> Option<(Option<Hit>, Option<Hit>)> {
    assert_eq!(got.len(), wanted.len());
    got.iter().copied().zip(wanted.iter().copied()).find(|(got, wanted)| got != wanted)
}

/// The answers of a packet, even if it does not pay.
fn packet<L: Lanes>(
    lanes: L,
    wide: &Wide,
    rays: &[Ray],
    range: Interval,
) -> Option<Vec<Option<Hit>>> {
    let mut packet = Packet::new(lanes, wide, range);
    let mut hits = vec![None; rays.len()];
    (packet.aim(rays) && packet.walk()).then(|| packet.answer(&mut hits))?;
    Some(hits)
}
