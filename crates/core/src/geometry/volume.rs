use glam::DVec3;
use smallvec::SmallVec;

use super::{Bounds3, Ray, gamma};

/// The points p with n·(p − a) ≤ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// n, which points out of it. It need not be a unit vector.
    pub normal: DVec3,
    /// a, a point of its plane.
    pub point: DVec3,
}

/// The volume of a beam: an intersection of half-spaces, with an axis along which depth is measured.
///
/// Its tests are one-sided: what meets the volume or touches it is never refused, whatever rounds; what
/// lies beside it may be let in. A larger box is never refused where a smaller one inside it is let in,
/// nor is its depth larger, so a hierarchy of boxes finds exactly what a test of each primitive finds.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvexVolume {
    axis: Ray,
    /// Those of a pyramid over a quadrilateral, and what it is cut by, need no allocation.
    half_spaces: SmallVec<[HalfSpace; 16]>,
}

/// The error up to which rounding may decide the sign of a product of unit vectors.
const DOUBT: f64 = 32.0 * f64::EPSILON;

impl ConvexVolume {
    /// An intersection of half-spaces; it is all of space if there are none. The axis' direction is made a unit
    /// vector.
    ///
    /// Boxes that pass an edge of the volume may be let in, though no single half-space shows it.
    pub fn of_half_spaces(axis: Ray, half_spaces: impl IntoIterator<Item = HalfSpace>) -> Self {
        let direction = axis.direction.normalize_or_zero();
        let half_spaces = half_spaces.into_iter().collect();
        Self { axis: Ray { direction, ..axis }, half_spaces }
    }

    /// The pyramid of all rays from the axis' origin, its apex, between these directions, which are given in
    /// order, either way round, in any length. It has no end. It may be flat or a single line; without a
    /// direction it is the apex. The directions must lie well within a half-space: otherwise the volume is
    /// larger than the pyramid.
    ///
    /// Directions, not points: far from the origin a point seen from the apex has lost its last digits, and
    /// a ray in the pyramid's border would lie outside.
    ///
    /// It gets its faces and all half-spaces that the separating axis theorem asks for: two convex
    /// bodies are disjoint if and only if there is a gap along a normal of a face of one, or along the
    /// product of an edge of each. The edges of boxes are known beforehand, so a box beside the pyramid is
    /// refused unless the gap is down to rounding.
    pub fn pyramid(axis: Ray, directions: &[DVec3]) -> Self {
        let mut volume = Self::of_half_spaces(axis, []);
        // A direction of no length is in every half-space.
        let directions = directions.iter().filter(|&&edge| edge != DVec3::ZERO);
        let edges: SmallVec<[DVec3; 4]> = directions.map(|&edge| unit(edge)).collect();
        let inwards = edges.iter().sum::<DVec3>().normalize_or_zero();
        // How much tilt moves an edge inwards by 1.
        let per_inside: SmallVec<[f64; 4]> =
            edges.iter().map(|&edge| inwards.dot(edge).recip()).collect();
        if !per_inside.iter().all(|tilt| (0.0..1e6).contains(tilt)) {
            return volume;
        }
        let mut consider = |normal: DVec3| {
            let squared = normal.length_squared();
            if squared == 0.0 {
                return;
            }
            let (mut least, mut most) = (0.0_f64, 0.0_f64);
            for edge in &edges {
                let beyond = normal.dot(*edge);
                least = if beyond < least { beyond } else { least };
                most = if beyond > most { beyond } else { most };
            }
            // The sides are told without a root.
            let doubt = DOUBT * DOUBT * squared;
            if most * most <= doubt {
                volume.support(normal, &edges, &per_inside, inwards);
            }
            if least * least <= doubt {
                volume.support(-normal, &edges, &per_inside, inwards);
            }
        };
        for (k, &edge) in edges.iter().enumerate() {
            // Not edge × next, whose rounding leaves the plane of a narrow face.
            consider(edge.cross(edges[(k + 1) % edges.len()] - edge));
        }
        DVec3::AXES.into_iter().for_each(&mut consider);
        for axis in 0..3 {
            // Seen along the axis, only the outermost edges can have all others on one side.
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut seen = edges.iter().copied().filter(|edge| edge[u] != 0.0 || edge[v] != 0.0);
            let Some(mut first) = seen.next() else { continue };
            let mut last = first;
            for edge in seen {
                if first[u] * edge[v] < first[v] * edge[u] {
                    first = edge;
                } else if last[u] * edge[v] > last[v] * edge[u] {
                    last = edge;
                }
            }
            consider(first.cross(DVec3::AXES[axis]));
            consider(last.cross(DVec3::AXES[axis]));
        }
        volume
    }

    /// Adds the half-space through the apex at a normal n, up to rounding, that holds all edges of a pyramid,
    /// unless it is there already.
    ///
    /// The rounded normal may cut an edge off. It is tilted inwards, n − β·inwards, until n·edge ≤ 0 holds
    /// for all of them, the rounding of the edges themselves included: so the exact pyramid is inside.
    fn support(&mut self, normal: DVec3, edges: &[DVec3], per_inside: &[f64], inwards: DVec3) {
        let normal = normal.normalize();
        let tilts = edges
            .iter()
            .zip(per_inside)
            .map(|(edge, per_inside)| (normal.dot(*edge) + DOUBT) * per_inside);
        let normal = normal - tilts.fold(0.0, f64::max) * inwards;
        let close = |a: f64, b: f64| (a - b).abs() <= 4.0 * f64::EPSILON;
        let is_same = |HalfSpace { normal: n, .. }: &HalfSpace| {
            close(n.x, normal.x) && close(n.y, normal.y) && close(n.z, normal.z)
        };
        if !self.half_spaces.iter().any(is_same) {
            self.half_spaces.push(HalfSpace { normal, point: self.axis.origin });
        }
    }

    /// What of the volume lies in a half-space: in front of a receiver, or behind a mirror.
    #[must_use]
    pub fn cut(mut self, half_space: HalfSpace) -> Self {
        self.half_spaces.push(half_space);
        self
    }

    /// Where depth is measured from, and the unit direction along which.
    pub fn axis(&self) -> Ray {
        self.axis
    }

    /// The half-spaces that hold it.
    pub fn half_spaces(&self) -> &[HalfSpace] {
        &self.half_spaces
    }

    /// Whether a box may have a point in common with the volume. An empty box has none.
    pub fn may_meet(&self, bounds: &Bounds3) -> bool {
        let empty = bounds.min.cmpgt(bounds.max).any();
        let outside = |half: &HalfSpace| least_in_box(half.normal, half.point, bounds) > 0.0;
        !empty && !self.half_spaces.iter().any(outside)
    }

    /// Whether the convex polygon, or any convex body, with these corners may have a point in common with
    /// the volume.
    pub fn may_meet_corners(&self, corners: &[DVec3]) -> bool {
        let outside = |half: &HalfSpace| {
            corners.iter().all(|&corner| least(half.normal, half.point, corner) > 0.0)
        };
        !self.half_spaces.iter().any(outside)
    }

    /// The depth of a box's nearest point along the axis, or less by its rounding.
    pub fn depth(&self, bounds: &Bounds3) -> f64 {
        known(least_in_box(self.axis.direction, self.axis.origin, bounds))
    }

    /// The depth of the nearest of these points along the axis, or less by its rounding.
    pub fn depth_of_corners(&self, corners: &[DVec3]) -> f64 {
        let Ray { origin, direction } = self.axis;
        let depth = |&corner: &DVec3| known(least(direction, origin, corner));
        corners.iter().map(depth).fold(f64::INFINITY, f64::min)
    }
}

/// What cannot be told may be anywhere.
fn known(depth: f64) -> f64 {
    if depth.is_nan() { f64::NEG_INFINITY } else { depth }
}

/// The unit vector of v, without overflow or underflow on the way; of nothing nothing.
fn unit(v: DVec3) -> DVec3 {
    if v == DVec3::ZERO { v } else { (v / v.abs().max_element()).normalize() }
}

/// A lower bound of n·(p − a).
///
/// It is one for a whole box if p is its corner where n·p is least. Each term is
/// lowered by more than it and the sum round by. Every step is a monotone function of p as it is rounded.
#[inline]
fn least(n: DVec3, a: DVec3, p: DVec3) -> f64 {
    const LESS: f64 = 1.0 - gamma(16);
    const MORE: f64 = 1.0 + gamma(16);
    let lowered = |k: usize| {
        // 0 · ∞ = NaN would hide what the other axes show.
        let term = if n[k] == 0.0 { 0.0 } else { n[k] * (p[k] - a[k]) };
        if term > 0.0 { term * LESS } else { term * MORE }
    };
    // A product may round to nothing.
    lowered(0) + lowered(1) + lowered(2) - f64::MIN_POSITIVE
}

#[inline]
fn least_in_box(n: DVec3, a: DVec3, bounds: &Bounds3) -> f64 {
    least(n, a, DVec3::select(n.cmpgt(DVec3::ZERO), bounds.min, bounds.max))
}

#[cfg(test)]
mod tests {
    use rand_pcg::Pcg64;
    use rand_pcg::rand_core::Rng;

    use super::*;

    /// Integer vectors, in which everything is exact.
    type V = [i128; 3];

    fn sub(a: V, b: V) -> V {
        [0, 1, 2].map(|k| a[k] - b[k])
    }

    fn dot(a: V, b: V) -> i128 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    fn cross(a: V, b: V) -> V {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    fn real(v: V, scale: f64) -> DVec3 {
        DVec3::from_array(v.map(|x| x as f64)) * scale
    }

    /// Whether a box and a pyramid have a point in common, by the separating axis theorem in integers.
    fn exactly_meet(apex: V, corners: &[V], low: V, high: V) -> bool {
        let units = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
        let edges: Vec<V> = corners.iter().map(|&corner| sub(corner, apex)).collect();
        let mut normals = units.to_vec();
        for &a in &edges {
            normals.extend(units.map(|unit| cross(a, unit)));
            normals.extend(edges.iter().map(|&b| cross(a, b)));
        }
        let separates = |&n: &V| {
            [n, n.map(|x| -x)].into_iter().any(|n| {
                let near: V = [0, 1, 2].map(|k| if n[k] > 0 { low[k] } else { high[k] });
                edges.iter().all(|&edge| dot(n, edge) <= 0) && dot(n, sub(near, apex)) > 0
            })
        };
        !normals.iter().any(separates)
    }

    struct Case {
        apex: V,
        corners: Vec<V>,
        low: V,
        high: V,
    }

    /// Pyramids and boxes on a coarse lattice, where they often touch: at `place`, some flat, a line or a
    /// point.
    fn cases(count: usize, place: i128) -> impl Iterator<Item = Case> {
        let mut random = Pcg64::new(7, 1);
        std::iter::repeat_with(move || {
            let mut below = |n: u64| i128::from(random.next_u64() % n);
            let mut point = |reach: u64| [0, 1, 2].map(|_| below(2 * reach + 1) - reach as i128);
            let shift = |p: V| p.map(|x| x + place);
            let (apex, base, [a, b]) = (point(6), point(6), [point(3), point(3)]);
            let (low, mut size) = (point(8), point(4).map(i128::abs));
            let at = |u: i128, v: i128| shift([0, 1, 2].map(|k| base[k] + u * a[k] + v * b[k]));
            let corners = match below(8) {
                0 => vec![at(0, 0), at(1, 0), at(2, 0)],
                1 => vec![at(0, 0)],
                2 => vec![shift(apex), at(1, 0), at(0, 1)],
                3 => vec![at(0, 0), at(1, 0), at(0, 1)],
                _ => vec![at(0, 0), at(1, 0), at(1, 1), at(0, 1)],
            };
            if below(3) == 0 {
                size[below(3) as usize] = 0;
            }
            let low = shift(low);
            let high = [0, 1, 2].map(|k| low[k] + size[k]);
            Case { apex: shift(apex), corners, low, high }
        })
        .take(count)
    }

    /// In integers: at the origin, far from it, huge and tiny.
    #[test]
    fn boxes_that_touch_are_met_and_others_refused() {
        for (place, scale) in
            [(0, 1.0), (1 << 20, 1.0), (0, 1e30), (0, 1e-160), (0, 2.0_f64.powi(-40))]
        {
            let [mut met, mut let_in, mut by_corner, mut by_center] = [0; 4];
            for Case { apex, corners, low, high } in cases(40_000, place) {
                let origin = real(apex, scale);
                let edges: Vec<DVec3> =
                    corners.iter().map(|&corner| real(sub(corner, apex), scale)).collect();
                let volume = ConvexVolume::pyramid(Ray::new(origin, edges[0]), &edges);
                let bounds = Bounds3 { min: real(low, scale), max: real(high, scale) };
                let (exact, ours) =
                    (exactly_meet(apex, &corners, low, high), volume.may_meet(&bounds));
                assert!(ours || !exact, "missed: {apex:?} {corners:?} {low:?} {high:?}");
                met += usize::from(exact);
                let_in += usize::from(ours && !exact);
                // What is tempting instead: whether a corner, or the middle, is inside.
                let inside = |p: DVec3| volume.may_meet(&Bounds3 { min: p, max: p });
                let corner = |k: usize| {
                    let axis = |bit: usize| if k >> bit & 1 == 0 { bounds.min } else { bounds.max };
                    inside(DVec3::new(axis(0).x, axis(1).y, axis(2).z))
                };
                by_corner += usize::from(exact && !(0..8).any(corner));
                by_center += usize::from(exact && !inside(bounds.center()));
            }
            assert!(
                met > 2_000 && by_corner > 100 && by_center > 100,
                "{met} {by_corner} {by_center}"
            );
            // Where the corners lie all around the apex the volume is larger than the pyramid.
            assert!(let_in < 200, "{place} {scale}: {let_in} let in");
        }
    }

    /// Beams as narrow as 10⁻¹² still refuse a box beside them by a tenth of their width.
    #[test]
    fn narrow_beams_are_narrow() {
        let forward = DVec3::new(0.6, 0.48, 0.64);
        let (across, up) = (DVec3::new(-0.8, 0.36, 0.48), DVec3::new(0.0, 0.8, -0.6));
        for exponent in 0..=12 {
            let half = 10.0_f64.powi(-exponent);
            let around = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let corners = around.map(|(x, y)| forward + half * (x * across + y * up));
            let volume = ConvexVolume::pyramid(Ray::new(DVec3::ZERO, forward), &corners);
            let meets = |x: f64| {
                let point = 5.0 * (forward + half * x * across);
                volume.may_meet(&Bounds3 { min: point, max: point })
            };
            assert!(meets(0.0) && meets(0.9) && meets(-0.9), "{half}");
            let beside = if exponent == 12 { 1.1 } else { 1.001 };
            assert!(!meets(beside) && !meets(-beside), "{half}");
        }
    }

    #[test]
    fn a_larger_box_is_met_and_begins_no_later() {
        let mut random = Pcg64::new(9, 1);
        let mut number = || (random.next_u32() as f64 / 4e9 - 0.5) * 3.0;
        for _ in 0..20_000 {
            let mut point = || DVec3::new(number(), number(), number());
            let (origin, corners) = (point(), [point(), point(), point()]);
            let edges = corners.map(|corner| corner - origin);
            let volume = ConvexVolume::pyramid(Ray::new(origin, edges[0]), &edges);
            let small = Bounds3::of_points([point(), point()]);
            let large = small.union(Bounds3::of_points([point()]));
            let around = Bounds3::of_points(corners);
            assert!(volume.may_meet(&large) || !volume.may_meet(&small));
            assert!(volume.depth(&large) <= volume.depth(&small));
            assert!(volume.may_meet_corners(&corners) && volume.may_meet(&around));
            assert!(volume.depth(&around) <= volume.depth_of_corners(&corners));
        }
    }

    /// Points exactly in the plane of a half-space, n·(n × u) = 0 in integers too long for the products.
    #[test]
    fn a_point_in_the_plane_touches() {
        let mut random = Pcg64::new(13, 1);
        let mut naive = 0;
        for _ in 0..20_000 {
            let mut integer = || i128::from(random.next_u32() >> 7) - (1 << 24);
            let mut vector = || [integer(), integer(), integer()];
            let (n, u) = (vector(), vector());
            let (normal, point) = (real(n, 1.0), real(cross(n, u), 1.0));
            let half_space = HalfSpace { normal, point: DVec3::ZERO };
            let volume = ConvexVolume::of_half_spaces(Ray::new(DVec3::ZERO, normal), [half_space]);
            assert!(volume.may_meet(&Bounds3 { min: point, max: point }));
            naive += usize::from(normal.dot(point) > 0.0);
        }
        assert!(naive > 1_000, "{naive}");
    }

    #[test]
    fn depth_by_hand() {
        let axis = Ray::new(DVec3::X, DVec3::new(0.0, 0.0, -5.0));
        let volume = ConvexVolume::of_half_spaces(axis, []);
        let bounds = Bounds3 { min: DVec3::new(-1.0, 0.0, -7.0), max: DVec3::new(4.0, 1.0, -3.0) };
        let depth = volume.depth(&bounds);
        assert!(depth <= 3.0 && depth > 3.0 - 1e-13, "{depth}");
        assert_eq!(volume.axis().direction, DVec3::NEG_Z);
        assert_eq!(volume.depth(&Bounds3::EMPTY), f64::INFINITY);
    }

    #[test]
    fn a_cut_ends_the_volume() {
        let corners =
            [DVec3::new(1.0, 1.0, 1.0), DVec3::new(-1.0, 1.0, 1.0), DVec3::new(0.0, -1.0, 1.0)];
        let pyramid = ConvexVolume::pyramid(Ray::new(DVec3::ZERO, DVec3::Z), &corners);
        let cut = pyramid.clone().cut(HalfSpace { normal: DVec3::Z, point: DVec3::Z });
        let at = |z: f64| Bounds3 { min: DVec3::Z * z, max: DVec3::new(0.1, 0.1, z + 1.0) };
        assert!(pyramid.may_meet(&at(1.0)) && pyramid.may_meet(&at(1.5)));
        assert!(cut.may_meet(&at(1.0)) && !cut.may_meet(&at(1.5)));
    }

    #[test]
    fn volumes_of_nothing_and_of_nonsense() {
        let unit = Bounds3 { min: DVec3::NEG_ONE, max: DVec3::ONE };
        let axis = Ray::new(DVec3::ZERO, DVec3::ZERO);
        let everywhere = ConvexVolume::of_half_spaces(axis, []);
        assert!(everywhere.may_meet(&unit) && !everywhere.may_meet(&Bounds3::EMPTY));
        let apex = ConvexVolume::pyramid(axis, &[]);
        assert!(
            apex.may_meet(&unit) && !apex.may_meet(&Bounds3 { min: DVec3::ONE, max: DVec3::ONE })
        );
        let contradiction =
            [DVec3::X, DVec3::NEG_X].map(|normal| HalfSpace { normal, point: -2.0 * normal });
        assert!(!ConvexVolume::of_half_spaces(axis, contradiction).may_meet(&unit));
        for bad in [f64::NAN, f64::INFINITY, 1e308] {
            let directions = [DVec3::X, DVec3::splat(bad), DVec3::Y];
            let axis = Ray::new(DVec3::splat(-bad), DVec3::X);
            let volume = ConvexVolume::pyramid(axis, &directions);
            assert!(volume.may_meet(&unit));
            assert!(!volume.depth(&unit).is_nan());
            let bounds = Bounds3 { min: DVec3::NEG_ONE, max: DVec3::splat(bad) };
            assert!(everywhere.may_meet(&bounds) && !everywhere.depth(&bounds).is_nan());
        }
    }
}
