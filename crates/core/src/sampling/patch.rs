use glam::DVec3;

use super::solid_angle::{Rectangle, SphericalRectangle};
use super::surfaces::{area_light_density, parallelogram, triangle};
use crate::geometry::gamma;

/// Rounded operations between four corners of a parallelogram and p₀ + p₂ − p₁ − p₃, moved by a transform or not.
const OPPOSITE: u32 = 16;

/// A face from which points are picked, such as a lamp's.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    shape: Shape,
    area: f64,
}

#[derive(Clone, Debug, PartialEq)]
enum Shape {
    Rectangle(Rectangle),
    Parallelogram {
        corner: DVec3,
        edges: [DVec3; 2],
        normal: DVec3,
    },
    /// Triangles with area.
    Triangles(Vec<Part>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    corners: [DVec3; 3],
    normal: DVec3,
    /// The area of this part and all before it, as a share of the whole.
    up_to: f64,
}

/// A point of a lamp, picked with regard to where it is seen from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LampSample {
    /// The point.
    pub position: DVec3,
    /// The density of the direction towards it, per solid angle; greater than 0.
    pub density: f64,
}

impl Patch {
    /// The face that is made of these triangles, counter-clockwise seen from the side it shows; `None` if it has no
    /// area.
    ///
    /// Two triangles that make a parallelogram are one: cut at its diagonal, either half would get half of the strata.
    pub fn new(triangles: impl IntoIterator<Item = [DVec3; 3]>) -> Option<Self> {
        let mut parts: Vec<Part> = Vec::new();
        let mut area = 0.0;
        for corners in triangles {
            let [a, b, c] = corners;
            let twice = (b - a).cross(c - a);
            // A part without area is never picked.
            if let Some(normal) = twice.try_normalize() {
                area += 0.5 * twice.length();
                parts.push(Part { corners, normal, up_to: area });
            }
        }
        let shape = match parts[..] {
            [] => return None,
            [first, second] => joined(first.corners, second.corners),
            _ => None,
        };
        for part in &mut parts {
            part.up_to /= area;
        }
        Some(Self { shape: shape.unwrap_or(Shape::Triangles(parts)), area })
    }

    /// The area A, in squared scene units.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// A point of it, of density 1/A everywhere, and the unit normal there.
    #[inline]
    pub fn point(&self, u: [f64; 2]) -> (DVec3, DVec3) {
        match &self.shape {
            Shape::Rectangle(rectangle) => (rectangle.point(u), rectangle.normal()),
            Shape::Parallelogram { corner, edges, normal } => {
                (parallelogram(*corner, *edges, u), *normal)
            }
            Shape::Triangles(parts) => {
                let (part, u) = pick(parts, u);
                (triangle(part.corners, u), part.normal)
            }
        }
    }

    /// The patch as it is seen from a point. Here it is decided how that point samples it: a rectangle by solid angle
    /// where that pays (see `by_solid_angle` of [`Rectangle`]), all else by area.
    #[inline]
    pub fn seen_from(&self, from: DVec3) -> SeenPatch<'_> {
        let by_solid_angle = match &self.shape {
            Shape::Rectangle(rectangle) => rectangle.by_solid_angle(from),
            Shape::Parallelogram { .. } | Shape::Triangles(_) => None,
        };
        SeenPatch { patch: self, from, by_solid_angle }
    }
}

/// A [`Patch`] as it is seen from a point: what its samples and their densities have in common.
#[derive(Clone, Copy, Debug)]
pub struct SeenPatch<'a> {
    patch: &'a Patch,
    from: DVec3,
    by_solid_angle: Option<SphericalRectangle<'a>>,
}

impl SeenPatch<'_> {
    /// A point of the side that the patch shows; `None` if it turns its back there.
    #[inline]
    pub fn sample(&self, u: [f64; 2]) -> Option<LampSample> {
        if let Some(seen) = &self.by_solid_angle {
            return Some(LampSample { position: seen.sample(u), density: seen.density() });
        }
        let (position, normal) = self.patch.point(u);
        let density = self.density(position, normal);
        (density > 0.0).then_some(LampSample { position, density })
    }

    /// The density, per solid angle, with which [`SeenPatch::sample`] picks the direction towards a point of the
    /// patch, of unit normal `normal`; 0 if it turns its back there.
    #[inline]
    pub fn density(&self, position: DVec3, normal: DVec3) -> f64 {
        if let Some(seen) = &self.by_solid_angle {
            return seen.density();
        }
        let back = self.from - position;
        let distance_squared = back.length_squared();
        let cos_light = normal.dot(back) / distance_squared.sqrt();
        area_light_density(distance_squared, cos_light, self.patch.area)
    }
}

/// The parallelogram that two triangles make, if they do.
fn joined(first: [DVec3; 3], second: [DVec3; 3]) -> Option<Shape> {
    (0..3).find_map(|k| {
        let [corner, left, right] = [first[k], first[(k + 1) % 3], first[(k + 2) % 3]];
        let opposite = (0..3).find_map(|m| {
            let diagonal = [second[(m + 1) % 3], second[(m + 2) % 3]];
            (diagonal == [right, left]).then_some(second[m])
        })?;
        let reach = first.into_iter().chain(second).map(|p| p.abs().max_element());
        let error = 4.0 * gamma(OPPOSITE) * reach.fold(0.0, f64::max);
        let gap = (corner - left) + (opposite - right);
        let edges = [left - corner, right - corner];
        let normal = edges[0].cross(edges[1]).try_normalize()?;
        let closes = gap.abs().max_element() <= error;
        let rectangle = Rectangle::new(corner, edges).map(Shape::Rectangle);
        closes.then_some(rectangle.unwrap_or(Shape::Parallelogram { corner, edges, normal }))
    })
}

/// The part that the first number falls on, by area, and the numbers for a point of it: what is left of the first is
/// stretched over [0, 1) again, so that strata stay strata.
#[inline]
fn pick(parts: &[Part], [u, v]: [f64; 2]) -> (&Part, [f64; 2]) {
    let index = parts.partition_point(|part| part.up_to <= u).min(parts.len() - 1);
    let before = if index == 0 { 0.0 } else { parts[index - 1].up_to };
    let rest = (u - before) / (parts[index].up_to - before);
    (&parts[index], [rest.min(BELOW_ONE), v])
}

/// The largest number below 1.
const BELOW_ONE: f64 = 1.0 - 0.5 * f64::EPSILON;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Uniform;

    /// A square at height 1 that shines down, its triangles as they may come: cut along either diagonal, beginning
    /// with any corner.
    fn squares() -> Vec<[[DVec3; 3]; 2]> {
        let corner = |k: usize| {
            let (x, y) = [(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)][k % 4];
            DVec3::new(x, y, 1.0)
        };
        let turned = |[a, b, c]: [DVec3; 3], k| [[a, b, c], [b, c, a], [c, a, b]][k];
        (0..36)
            .map(|k| {
                let (start, first, second) = (k % 4, k / 4 % 3, k / 12);
                let [a, b, c, d] = [0, 1, 2, 3].map(|k| corner(start + k));
                [turned([a, b, c], first), turned([a, c, d], second)]
            })
            .collect()
    }

    #[test]
    fn two_triangles_of_a_parallelogram_are_one() {
        for triangles in squares() {
            let patch = Patch::new(triangles).unwrap();
            assert_eq!(patch.area(), 1.0);
            let Shape::Rectangle(rectangle) = patch.shape else { panic!("{triangles:?}") };
            assert_eq!(rectangle.normal(), DVec3::NEG_Z);
        }
        let [first, mut second] = squares()[0];
        second[2] += 1e-12 * DVec3::X;
        assert!(matches!(Patch::new([first, second]).unwrap().shape, Shape::Triangles(_)));
        // A skewed one has no solid angle to sample by.
        let skewed = |p: DVec3| p + 0.1 * p.y * DVec3::X;
        let skewed = squares()[0].map(|corners| corners.map(skewed));
        assert!(matches!(Patch::new(skewed).unwrap().shape, Shape::Parallelogram { .. }));
        // Two that only share an edge, folded along it, and two that lie one on the other.
        second[2] = DVec3::new(0.5, -0.5, 3.0);
        assert!(matches!(Patch::new([first, second]).unwrap().shape, Shape::Triangles(_)));
        assert!(matches!(Patch::new([first, first]).unwrap().shape, Shape::Triangles(_)));
    }

    #[test]
    fn what_has_no_area_is_no_patch() {
        assert_eq!(Patch::new([]), None);
        assert_eq!(Patch::new([[DVec3::X; 3], [DVec3::X, DVec3::ZERO, DVec3::NEG_X]]), None);
        let [first, second] = squares()[0];
        let with_flat = Patch::new([[DVec3::X; 3], first, second]).unwrap();
        assert_eq!(with_flat.area(), 1.0);
    }

    /// A face whose halves are not in one plane, as quads of files may be: from where one half turns its back only the
    /// other has samples, and densities, each by its own normal.
    #[test]
    fn a_folded_face_shows_its_parts_on_their_own() {
        let [a, b, c, d] =
            [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, 0.5, 2.0)];
        let (flat, steep) = ([a, b, c], [a, c, d]);
        let patch = Patch::new([flat, steep]).unwrap();
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize();
        let middle = |[a, b, c]: [DVec3; 3]| (a + b + c) / 3.0;
        let from = DVec3::new(-1.0, 1.0, 0.5);
        assert!(normal(flat).dot(from) > 0.0 && normal(steep).dot(from) < 0.0);
        let seen = patch.seen_from(from);
        assert_eq!(seen.density(middle(steep), normal(steep)), 0.0);
        let back = from - middle(flat);
        let by_hand = back.length().powi(3) / (patch.area() * back.z);
        assert!((seen.density(middle(flat), normal(flat)) / by_hand - 1.0).abs() < 1e-14);
        let share = 0.5 / patch.area();
        for k in 0..100 {
            let u = (f64::from(k) + 0.5) / 100.0;
            assert_eq!(seen.sample([u, 0.4]).is_some(), u < share, "{u}");
        }
    }

    /// A fan of triangles of different sizes: the points of a grid fall on each in proportion to its area, also where
    /// the first number is 0 or the last below 1.
    #[test]
    fn faces_are_picked_by_area() {
        let outline = [(0.0, 0.0), (3.0, 0.0), (4.0, 1.0), (2.0, 4.0), (0.5, 3.0)]
            .map(|(x, y)| DVec3::new(x, y, 2.0));
        let fan = (1..4).map(|k| [outline[0], outline[k], outline[k + 1]]);
        // By hand: 3/2, 7, 2.
        let areas = [1.5, 7.0, 2.0];
        let patch = Patch::new(fan).unwrap();
        assert_eq!(patch.area(), 10.5);
        let Shape::Triangles(parts) = &patch.shape else { panic!() };
        let count = 21_000;
        let mut hits = [0; 3];
        for k in 0..count {
            let u = (f64::from(k) + 0.5) / f64::from(count);
            let (part, [rest, _]) = pick(parts, [u, 0.0]);
            hits[parts.iter().position(|p| p == part).unwrap()] += 1;
            assert!((0.0..1.0).contains(&rest));
        }
        assert_eq!(hits.map(|hits| 10.5 * f64::from(hits) / f64::from(count)), areas);
        for u in [[0.0, 0.0], [BELOW_ONE, 0.0], [0.0, BELOW_ONE], [BELOW_ONE; 2]] {
            let (point, normal) = patch.point(u);
            assert!(point.is_finite() && normal == DVec3::Z && point.z == 2.0, "{u:?}: {point}");
        }
    }

    /// `eq:area-light`: the mean of 1 / density is the solid angle of the square, and that of cos θ / density the
    /// irradiance; z for a false alarm in a million. The back and the plane itself have no samples.
    #[test]
    fn samples_by_area_make_the_irradiance() {
        let patch = Patch::new(squares()[0]).unwrap();
        let seen = patch.seen_from(DVec3::ZERO);
        let mut random = Uniform::new(1, 0, 0);
        let count = 100_000;
        let (mut omega, mut irradiance) = (0.0, 0.0);
        for _ in 0..count {
            let sample = seen.sample([random.number(), random.number()]).unwrap();
            omega += 1.0 / sample.density / f64::from(count);
            irradiance += sample.position.normalize().z / sample.density / f64::from(count);
        }
        // Standard deviations of one sample by the moments of the closed form.
        let z = 4.892 / f64::from(count).sqrt();
        assert!((omega / 0.805431683161323 - 1.0).abs() < z * 0.174225, "{omega}");
        assert!((irradiance / 0.752274688454107 - 1.0).abs() < z * 0.174225, "{irradiance}");
        for from in [DVec3::new(0.1, 0.2, 1.0), DVec3::new(0.1, 0.2, 3.0)] {
            assert_eq!(patch.seen_from(from).sample([0.3, 0.4]), None, "{from}");
        }
    }
}
