//! Bounding volumes, to be compared: around one object, met by infinite lines.

use glam::{DMat3, DVec3};
use lancer_core::geometry::Ray;
use lancer_core::sampling::Uniform;

/// A convex body around an object.
#[derive(Clone, Debug)]
pub enum Volume {
    /// Around the middle of the object's box.
    Sphere {
        /// Its centre.
        center: DVec3,
        /// Its radius.
        radius: f64,
    },
    /// What lies between parallel planes: for each normal the smallest and the largest n·p.
    Slabs {
        /// The normals n, of any length.
        normals: Vec<DVec3>,
        /// The planes.
        planes: Vec<[f64; 2]>,
    },
}

/// The kinds that are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Whitted 1980.
    Sphere,
    /// Three slabs across the axes.
    Box,
    /// Three slabs across the object's own axes.
    OrientedBox,
    /// Seven slabs whose normals are the same for all objects (Kay and Kajiya 1986): across the axes and
    /// across the diagonals of a cube.
    SevenSlabs,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Sphere, Self::Box, Self::OrientedBox, Self::SevenSlabs];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Box => "box",
            Self::OrientedBox => "oriented box",
            Self::SevenSlabs => "seven slabs",
        }
    }

    /// What a test costs, in additions, multiplications, divisions and comparisons, minima and maxima
    /// among them. What depends on the ray alone is computed once for all volumes and not counted: for a
    /// normal that all volumes share 1 / n·d and n·o.
    pub fn operations(self) -> u32 {
        // Two differences, two products, two to order them and two to narrow the interval.
        const SLAB: u32 = 8;
        const DOT: u32 = 5;
        match self {
            // c − o, its products with d and with itself, what is left of it across the line, a comparison.
            Self::Sphere => 3 + 2 * DOT + 2 + 1,
            Self::Box => 3 * SLAB + 1,
            // Its normals are its own: n·o, n·d and the division fall to each test.
            Self::OrientedBox => 3 * (2 * DOT + 1 + SLAB) + 1,
            Self::SevenSlabs => 7 * SLAB + 1,
        }
    }

    /// The smallest volume of this kind around points, or close to it.
    pub fn around(self, points: &[DVec3]) -> Volume {
        let normals: Vec<DVec3> = match self {
            Self::Sphere => {
                let (low, high) =
                    points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
                        (low.min(*p), high.max(*p))
                    });
                let center = 0.5 * (low + high);
                let radius = points.iter().map(|p| p.distance(center)).fold(0.0, f64::max);
                return Volume::Sphere { center, radius };
            }
            Self::Box => DVec3::AXES.into(),
            Self::OrientedBox => principal_axes(points).into(),
            Self::SevenSlabs => {
                let diagonals = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
                let diagonals = diagonals.map(|(x, y)| DVec3::new(x, y, 1.0));
                DVec3::AXES.into_iter().chain(diagonals).collect()
            }
        };
        let planes = normals.iter().map(|n| {
            let along = points.iter().map(|p| n.dot(*p));
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                [low.min(x), high.max(x)]
            })
        });
        Volume::Slabs { planes: planes.collect(), normals }
    }
}

impl Volume {
    /// Whether the line of a ray, to both sides of its origin, meets the volume.
    pub fn meets(&self, line: &Ray) -> bool {
        match self {
            Self::Sphere { center, radius } => {
                let to_center = *center - line.origin;
                let along = to_center.dot(line.direction);
                let across = to_center.length_squared() - along * along;
                across <= radius * radius
            }
            Self::Slabs { normals, planes } => {
                let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
                for (n, planes) in normals.iter().zip(planes) {
                    let inverse = n.dot(line.direction).recip();
                    let [a, b] = planes.map(|plane| (plane - n.dot(line.origin)) * inverse);
                    near = near.max(a.min(b));
                    far = far.min(a.max(b));
                }
                near <= far
            }
        }
    }
}

/// The directions in which the points are spread most and least, and the one across both: eigenvectors of
/// their covariance, by Jacobi's rotations.
fn principal_axes(points: &[DVec3]) -> [DVec3; 3] {
    let mean = points.iter().sum::<DVec3>() / points.len() as f64;
    let mut matrix = DMat3::ZERO;
    for p in points {
        let d = *p - mean;
        matrix += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    let mut axes = DMat3::IDENTITY;
    for (i, j) in [(0, 1), (0, 2), (1, 2)].into_iter().cycle().take(30) {
        let angle = 0.5 * (2.0 * matrix.col(i)[j]).atan2(matrix.col(i)[i] - matrix.col(j)[j]);
        let mut turn = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        (turn[i][i], turn[j][j]) = (angle.cos(), angle.cos());
        (turn[i][j], turn[j][i]) = (angle.sin(), -angle.sin());
        let turn = DMat3::from_cols_array_2d(&turn);
        matrix = turn.transpose() * matrix * turn;
        axes *= turn;
    }
    [axes.x_axis, axes.y_axis, axes.z_axis]
}

/// Lines without any preference of place or direction that meet a sphere: the lines of which the surface
/// area heuristic speaks. Of those that meet a convex body, the part that meets another inside it is the ratio of
/// their surfaces.
pub fn random_lines(center: DVec3, radius: f64, count: u32) -> impl Iterator<Item = Ray> {
    (0..count).map(move |k| {
        let mut random = Uniform::new(6, k, 0);
        let direction = random.direction();
        let (across, up) = direction.any_orthonormal_pair();
        let (turn, out) = (std::f64::consts::TAU * random.number(), random.number().sqrt());
        let aside = radius * out * (turn.cos() * across + turn.sin() * up);
        Ray::new(center + aside - 2.0 * radius * direction, direction)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners() -> Vec<DVec3> {
        let signs = [-1.0, 1.0];
        let points = signs.map(|x| signs.map(|y| signs.map(|z| DVec3::new(x, y, z))));
        points.into_iter().flatten().flatten().collect()
    }

    /// Surfaces in closed form: of the lines that meet a cube's sphere of 3 4π, the cube of 24 is met by
    /// 24 / 12π = 0.6366. A false alarm in a million: 4.9 σ of 10⁵ lines.
    #[test]
    fn a_line_meets_a_body_with_the_probability_of_its_surface() {
        let cube = Kind::Box.around(&corners());
        let count = 100_000;
        let met =
            random_lines(DVec3::ZERO, 3.0_f64.sqrt(), count).filter(|l| cube.meets(l)).count();
        let (part, wanted) = (met as f64 / f64::from(count), 24.0 / (12.0 * std::f64::consts::PI));
        let sigma = (wanted * (1.0 - wanted) / f64::from(count)).sqrt();
        assert!((part - wanted).abs() < 4.9 * sigma, "{part} {wanted}");
    }

    /// All kinds contain the object: no line through a point of it is missed. And the oriented box finds the axes of a
    /// turned block: its sides are the block's.
    #[test]
    fn volumes_contain_their_object() {
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
        let block: Vec<DVec3> =
            corners().iter().map(|p| turn * (*p * DVec3::new(5.0, 2.0, 1.0))).collect();
        for kind in Kind::ALL {
            let volume = kind.around(&block);
            for (k, line) in random_lines(DVec3::ZERO, 1.0, 1000).enumerate() {
                let through = 0.9 * block[k % 8].lerp(block[k / 8 % 8], 0.3);
                assert!(volume.meets(&Ray::new(through, line.direction)), "{kind:?}");
            }
        }
        let Volume::Slabs { planes, .. } = Kind::OrientedBox.around(&block) else { panic!() };
        let mut sides: Vec<f64> = planes.iter().map(|[low, high]| high - low).collect();
        sides.sort_by(f64::total_cmp);
        assert!(sides.iter().zip([2.0, 4.0, 10.0]).all(|(a, b)| (a - b).abs() < 1e-9), "{sides:?}");
    }
}
