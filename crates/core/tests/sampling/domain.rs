//! What comes of the four corners of [0, 1)², and of lamps from where they are hardly seen.

use glam::DVec3;
use lancer_core::geometry::Sphere;
use lancer_core::sampling::{Patch, SeenSphere};

use super::rows::rows;

const LAST: f64 = 1.0 - 0.5 * f64::EPSILON;
const NUMBERS: [f64; 5] = [0.0, 0.5 * f64::EPSILON, 0.5, 1.0 - f64::EPSILON, LAST];

fn corners() -> impl Iterator<Item = [f64; 2]> {
    NUMBERS.into_iter().flat_map(|u| NUMBERS.map(|v| [u, v]))
}

fn patch(corner: DVec3, edges: [DVec3; 2]) -> Patch {
    let [left, right] = edges.map(|edge| corner + edge);
    Patch::new([[corner, left, right], [left + edges[1], right, left]]).unwrap()
}

#[test]
fn corners_of_the_square_fall_on_rectangles() {
    for row in rows() {
        let (patch, rectangle) = (row.patch(), row.rectangle());
        let seen = rectangle.seen_from(row.from).unwrap();
        for u in corners() {
            let sample = patch.seen_from(row.from).sample(u).unwrap();
            assert!(sample.density.is_finite() && sample.density > 0.0, "{} {u:?}", row.name);
            for point in [sample.position, seen.sample(u)] {
                for edge in row.edges {
                    let share = (point - row.corner).dot(edge) / edge.length_squared();
                    assert!((-1e-15..=1.0 + 1e-15).contains(&share), "{} {u:?}: {share}", row.name);
                }
            }
        }
    }
}

#[test]
fn corners_of_the_square_fall_on_spheres() {
    let sphere = Sphere { center: DVec3::new(1.0, 2.0, 3.0), radius: 0.5 };
    for off in [0.5 + 1e-15, 0.50001, 1.0, 1e3, 1e9] {
        let seen =
            SeenSphere::new(sphere, sphere.center + DVec3::new(0.6, 0.0, -0.8) * off).unwrap();
        for u in corners() {
            let sample = seen.sample(u);
            assert!(sample.density.is_finite() && sample.density > 0.0, "{off} {u:?}");
            let radius = (sample.position - sphere.center).length();
            assert!((radius - 0.5).abs() < 2e-15, "{off} {u:?}: {radius}");
        }
    }
}

/// Lamps from 10⁻⁶ to 10⁶ large, from in front of their middle, their edge, a corner and beside them, at ever lesser
/// heights: finite points on the lamp, and densities; on the plane and behind it none.
#[test]
fn lamps_of_every_size_are_sampled_from_everywhere() {
    for size in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        let lamp = patch(DVec3::new(-0.5, -0.5, 0.0) * size, [size * DVec3::Y, size * DVec3::X]);
        for (x, y) in [(0.0, 0.0), (0.5, 0.0), (0.5, 0.5), (0.3, -0.5), (1.5, 0.2), (-40.0, 3.0)] {
            for height in [1e3, 1.0, 1e-3, 1e-6, 1e-9, 1e-12, 1e-16, 1e-100, 1e-300] {
                let from = DVec3::new(x, y, -height) * size;
                for u in corners() {
                    let Some(sample) = lamp.seen_from(from).sample(u) else {
                        // The very point, or so flat that no number can say how much.
                        assert!(height <= 1e-100, "{size} {x} {y} {height} {u:?}");
                        continue;
                    };
                    let place = sample.position / size;
                    let inside = place.abs().max_element() <= 0.5 + 1e-15 && place.z == 0.0;
                    assert!(inside, "{size} {x} {y} {height} {u:?}: {place}");
                    assert!(sample.density > 0.0, "{size} {x} {y} {height} {u:?}");
                    assert!(
                        sample.density.is_finite() || height <= 1e-100,
                        "{size} {x} {y} {height}"
                    );
                }
            }
            for height in [0.0, 1e-300, 1e-9, 1.0] {
                let seen = lamp.seen_from(DVec3::new(x, y, height) * size);
                assert!(corners().all(|u| seen.sample(u).is_none()), "{size} {x} {y} {height}");
                assert_eq!(seen.density(DVec3::ZERO, DVec3::NEG_Z), 0.0);
            }
        }
        let nowhere = lamp.seen_from(DVec3::NAN);
        assert!(corners().all(|u| nowhere.sample(u).is_none()));
    }
}
