use std::collections::VecDeque;

use glam::{DVec2, DVec3};

/// What a polygon was found to be while it was cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Defects {
    /// It crosses itself, so that its triangles' areas do not add up to its own.
    pub self_intersecting: bool,
    /// A corner is further from the mean plane than a thousandth of the polygon's size.
    pub non_planar: bool,
}

/// Cuts the polygon `corners` (at least 3, finite) into `corners.len() − 2` triangles of corner
/// numbers, appended to `triangles`, with the polygon's sense of rotation. The areas of the
/// triangles add up to the area of the polygon, also where it is concave, has straight corners, or
/// touches itself as the bridge to a hole does.
///
/// A fan of one corner serves where it covers the polygon, as in every convex one; otherwise ears
/// are clipped. Both look at the polygon along the axis its normal is closest to, which keeps the
/// coordinates as they were written.
pub(crate) fn triangulate(corners: &[DVec3], triangles: &mut Vec<[u32; 3]>) -> Defects {
    let count = corners.len() as u32;
    if count == 3 {
        triangles.push([0, 1, 2]);
        return Defects::default();
    }
    let normal = newell_normal(corners);
    let mut flat = flatten(corners, normal);
    let non_planar = is_non_planar(corners, normal);

    // A simple quadrilateral always has a diagonal inside.
    let apexes = if count == 4 { 2 } else { 1 };
    if let Some(apex) = (0..apexes).find(|&apex| fan_covers(&flat, apex)) {
        push_fan(count, apex, triangles);
        return Defects { self_intersecting: false, non_planar };
    }
    let first = triangles.len();
    if count > 4 {
        lay_along_x(&mut flat);
        EarClipper::new(&flat).clip(triangles);
    } else {
        push_fan(count, 0, triangles);
    }
    let whole: f64 = (1..flat.len() - 1).map(|i| cross(flat[0], flat[i], flat[i + 1])).sum();
    let parts: f64 = triangles[first..]
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| flat[i as usize]);
            cross(a, b, c).abs()
        })
        .sum();
    Defects { self_intersecting: parts - whole.abs() > 1e-9 * parts, non_planar }
}

/// The area vector of a polygon: perpendicular to its mean plane, as long as twice its area.
///
/// Newell's method: a straight or repeated corner does not disturb it.
pub(crate) fn newell_normal(corners: &[DVec3]) -> DVec3 {
    let origin = corners[0];
    corners.windows(2).map(|pair| (pair[0] - origin).cross(pair[1] - origin)).sum()
}

fn is_non_planar(corners: &[DVec3], normal: DVec3) -> bool {
    let Some(n) = normal.try_normalize() else { return false };
    let mean = corners.iter().map(|&p| p - corners[0]).sum::<DVec3>() / corners.len() as f64;
    let from_mean = || corners.iter().map(|&p| p - corners[0] - mean);
    let size = from_mean().map(DVec3::length).fold(0.0, f64::max);
    from_mean().any(|p| p.dot(n).abs() > 1e-3 * size)
}

/// The corners seen along the axis that `normal` is closest to, counter-clockwise.
fn flatten(corners: &[DVec3], normal: DVec3) -> Vec<DVec2> {
    let n = normal.abs();
    let (project, towards_eye): (fn(&DVec3) -> DVec2, f64) = if n.z >= n.x && n.z >= n.y {
        (|p| DVec2::new(p.x, p.y), normal.z)
    } else if n.x >= n.y {
        (|p| DVec2::new(p.y, p.z), normal.x)
    } else {
        (|p| DVec2::new(p.z, p.x), normal.y)
    };
    let mut flat: Vec<DVec2> = corners.iter().map(project).collect();
    if towards_eye < 0.0 {
        for p in &mut flat {
            p.x = -p.x;
        }
    }
    flat
}

/// Turns a polygon that is higher than wide by a quarter: its corners then spread well along x.
fn lay_along_x(flat: &mut [DVec2]) {
    let (min, max) =
        flat.iter().fold((flat[0], flat[0]), |(min, max), &p| (min.min(p), max.max(p)));
    if max.y - min.y > max.x - min.x {
        for p in flat {
            *p = p.perp();
        }
    }
}

/// Twice the area of the triangle a b c, positive where it turns counter-clockwise.
fn cross(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Whether the triangles from corner `apex` to every edge turn the same way, in less than one turn.
fn fan_covers(flat: &[DVec2], apex: usize) -> bool {
    let at = |i: usize| flat[(apex + i) % flat.len()];
    let (mut past_half_turn, mut area) = (false, 0.0);
    for i in 1..flat.len() - 1 {
        let part = cross(at(0), at(i), at(i + 1));
        let turned = cross(at(0), at(1), at(i + 1));
        if part < 0.0 || (past_half_turn && turned > 0.0) {
            return false;
        }
        past_half_turn |= turned < 0.0;
        area += part;
    }
    area > 0.0
}

fn push_fan(count: u32, apex: usize, triangles: &mut Vec<[u32; 3]>) {
    let at = |i: u32| (apex as u32 + i) % count;
    triangles.extend((1..count - 1).map(|i| [at(0), at(i), at(i + 1)]));
}

/// Cuts off, again and again, a convex corner whose triangle no other corner reaches into.
struct EarClipper<'a> {
    flat: &'a [DVec2],
    /// The corners still there, as a ring.
    before: Vec<usize>,
    after: Vec<usize>,
    removed: Vec<bool>,
    /// The corners that are not convex, by x: only they can reach into an ear, and most of them are
    /// to its left or right.
    reflex: Vec<usize>,
}

impl<'a> EarClipper<'a> {
    fn new(flat: &'a [DVec2]) -> Self {
        let count = flat.len();
        let mut clipper = Self {
            flat,
            before: (0..count).map(|i| (i + count - 1) % count).collect(),
            after: (0..count).map(|i| (i + 1) % count).collect(),
            removed: vec![false; count],
            reflex: Vec::new(),
        };
        let mut reflex: Vec<usize> = (0..count).filter(|&i| clipper.turn(i) <= 0.0).collect();
        reflex.sort_by(|&i, &j| flat[i].x.total_cmp(&flat[j].x));
        clipper.reflex = reflex;
        clipper
    }

    fn turn(&self, corner: usize) -> f64 {
        let [a, b, c] = self.triangle(corner).map(|i| self.flat[i]);
        cross(a, b, c)
    }

    fn triangle(&self, corner: usize) -> [usize; 3] {
        [self.before[corner], corner, self.after[corner]]
    }

    fn clip(mut self, triangles: &mut Vec<[u32; 3]>) {
        let mut left = self.flat.len();
        // A corner that rests on an ear's border spoils it in the first round; in the second, for
        // polygons that touch themselves, only one inside.
        for touching_spoils in [true, false] {
            // Cutting an ear can make ears of its two neighbours, and of no other corner.
            let mut candidates: VecDeque<usize> =
                (0..self.flat.len()).filter(|&i| !self.removed[i]).collect();
            while left > 3
                && let Some(corner) = candidates.pop_front()
            {
                if self.removed[corner] || !self.is_ear(corner, touching_spoils) {
                    continue;
                }
                let [a, _, c] = self.triangle(corner);
                self.cut(corner, triangles);
                left -= 1;
                candidates.extend([a, c]);
            }
        }
        // One triangle is left, or a polygon that crosses itself.
        let mut corner = (0..self.flat.len()).find(|&i| !self.removed[i]).unwrap_or_default();
        for _ in 2..left {
            let next = self.after[corner];
            self.cut(next, triangles);
            corner = self.before[next];
        }
    }

    fn cut(&mut self, corner: usize, triangles: &mut Vec<[u32; 3]>) {
        let [a, b, c] = self.triangle(corner);
        triangles.push([a as u32, b as u32, c as u32]);
        self.removed[b] = true;
        (self.after[a], self.before[c]) = (c, a);
    }

    fn is_ear(&self, corner: usize, touching_spoils: bool) -> bool {
        let [a, b, c] = self.triangle(corner).map(|i| self.flat[i]);
        if cross(a, b, c) < 0.0 {
            return false;
        }
        let (left, right) = (a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x));
        let start = self.reflex.partition_point(|&i| self.flat[i].x < left);
        let spoils = |i: usize| {
            let p = self.flat[i];
            let inside = [cross(a, b, p), cross(b, c, p), cross(c, a, p)];
            let reaches =
                inside.iter().all(|&side| if touching_spoils { side >= 0.0 } else { side > 0.0 });
            reaches && p != a && p != b && p != c && !self.removed[i] && self.turn(i) <= 0.0
        };
        !self.reflex[start..].iter().take_while(|&&i| self.flat[i].x <= right).any(|&i| spoils(i))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::sampling::Uniform;
    use glam::{DQuat, dvec3};

    fn area(corners: &[DVec3]) -> f64 {
        0.5 * newell_normal(corners).length()
    }

    /// Cuts a polygon and returns the sum of its triangles' areas.
    fn cut(corners: &[DVec3]) -> (f64, Defects) {
        let mut triangles = Vec::new();
        let defects = triangulate(corners, &mut triangles);
        assert_eq!(triangles.len(), corners.len() - 2);
        let areas = triangles.iter().map(|t| area(&t.map(|i| corners[i as usize])));
        (areas.sum(), defects)
    }

    fn fan_area(corners: &[DVec3]) -> f64 {
        (1..corners.len() - 1).map(|i| area(&[corners[0], corners[i], corners[i + 1]])).sum()
    }

    fn polygon(corners: &[[f64; 2]]) -> Vec<DVec3> {
        corners.iter().map(|&[x, y]| dvec3(x, y, 0.0)).collect()
    }

    /// The polygon in every position on its list of corners, turned over, and tilted in space.
    fn poses(corners: &[DVec3]) -> Vec<Vec<DVec3>> {
        let tilt = DQuat::from_euler(glam::EulerRot::XYZ, 0.7, -1.9, 2.6);
        let mut poses = Vec::new();
        for start in 0..corners.len() {
            let mut turned = corners.to_vec();
            turned.rotate_left(start);
            poses.push(turned.iter().map(|&p| tilt * p + dvec3(3.0, -1.0, 2.0)).collect());
            poses.push(turned.iter().rev().map(|p| dvec3(p.z, p.x, p.y)).collect());
            poses.push(turned.iter().map(|p| dvec3(p.y, p.z, p.x)).collect());
            poses.push(turned);
        }
        poses
    }

    #[test]
    fn areas_are_kept() {
        let cases: [(&[[f64; 2]], f64); 9] = [
            (&[[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0]], 1.0),
            (&[[4.0, 0.0], [1.0, 1.0], [0.0, 4.0], [0.0, 0.0]], 4.0),
            (&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 1.0),
            // An L, a comb, a square with straight corners, one with repeated corners.
            (&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]], 3.0),
            (
                &[
                    [0.0, 0.0],
                    [5.0, 0.0],
                    [5.0, 3.0],
                    [4.0, 3.0],
                    [4.0, 1.0],
                    [3.0, 1.0],
                    [3.0, 3.0],
                    [2.0, 3.0],
                    [2.0, 1.0],
                    [1.0, 1.0],
                    [1.0, 3.0],
                    [0.0, 3.0],
                ],
                11.0,
            ),
            (&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0]], 4.0),
            (&[[0.0, 0.0], [0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [3.0, 1.0], [0.0, 1.0]], 3.0),
            // A ring: the square (0 … 3)² with the hole (1 … 2)², joined by a bridge.
            (
                &[
                    [0.0, 0.0],
                    [3.0, 0.0],
                    [3.0, 3.0],
                    [0.0, 3.0],
                    [0.0, 0.0],
                    [1.0, 1.0],
                    [1.0, 2.0],
                    [2.0, 2.0],
                    [2.0, 1.0],
                    [1.0, 1.0],
                ],
                8.0,
            ),
            // An arrow with a spike of no area.
            (&[[0.0, 0.0], [4.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5], [0.0, 2.0]], 2.5),
        ];
        for (corners, expected) in cases {
            for pose in poses(&polygon(corners)) {
                let (area, defects) = cut(&pose);
                assert!((area - expected).abs() < 1e-12, "{area} for {expected}: {pose:?}");
                assert_eq!(defects, Defects::default(), "{pose:?}");
            }
        }
        // The naive fan, which this test must be able to tell from the truth.
        assert_eq!(fan_area(&polygon(cases[0].0)), 3.0);
        assert_eq!(fan_area(&polygon(cases[1].0)), 12.0);
    }

    /// Twice the area of the triangle a b c in the integer grid.
    fn turn([a, b, c]: [[i64; 2]; 3]) -> i64 {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    /// Whether two segments may have a point in common.
    fn meet([p, q]: [[i64; 2]; 2], [r, s]: [[i64; 2]; 2]) -> bool {
        let differ = |a: i64, b: i64| a.signum() * b.signum() <= 0;
        differ(turn([p, q, r]), turn([p, q, s])) && differ(turn([r, s, p]), turn([r, s, q]))
    }

    /// A simple polygon in the integer grid, without straight corners: it grows from a triangle, as
    /// a random edge gives way to two over a random point near it that meet no other edge.
    fn grown(count: usize, random: &mut Uniform) -> Vec<[i64; 2]> {
        const SIZE: i64 = 1 << 20;
        let mut polygon = vec![[0, 0], [SIZE, 0], [SIZE / 2, SIZE]];
        while polygon.len() < count {
            let n = polygon.len();
            let edge = (random.number() * n as f64) as usize;
            let at = |i: usize| polygon[(edge + i) % n];
            let [a, b] = [at(0), at(1)];
            let length = (b[0] - a[0]).abs().max((b[1] - a[1]).abs()) as f64;
            let mut near =
                |k: usize| (a[k] + b[k]) / 2 + (2.0 * length * (random.number() - 0.5)) as i64;
            let x = [near(0), near(1)];
            let bends =
                [[a, b, x], [at(n - 1), a, x], [x, b, at(2)]].into_iter().all(|t| turn(t) != 0);
            let free = (1..n).all(|i| {
                let other = [at(i), at(i + 1)];
                (i == n - 1 || !meet([a, x], other)) && (i == 1 || !meet([x, b], other))
            });
            if bends && free {
                polygon.insert(edge + 1, x);
            }
        }
        polygon
    }

    /// Polygons whose corners are whole numbers, in planes of whole numbers: everything about them is
    /// exact, up to a million times their size away.
    #[test]
    fn areas_of_random_polygons_are_exact() {
        let mut random = Uniform::new(10, 0, 0);
        for case in 0..400 {
            let polygon = grown(4 + case % 30 + case % 7 * (case % 40), &mut random);
            let twice: i64 = (1..polygon.len() - 1)
                .map(|i| turn([polygon[0], polygon[i], polygon[i + 1]]))
                .sum();
            let mut integer = || (16.0 * random.number() - 8.0).round();
            let [u, v] = [(); 2].map(|()| dvec3(integer(), integer(), integer()));
            let far = [0.0, 1e3, 1e6][case % 3] * f64::from(1 << 20);
            let offset = (far * dvec3(1.0, -0.7, 0.3)).round();
            let corners: Vec<DVec3> =
                polygon.iter().map(|&[x, y]| offset + x as f64 * u + y as f64 * v).collect();
            let expected = 0.5 * twice.abs() as f64 * u.cross(v).length();
            let (sum, defects) = cut(&corners);
            assert!(
                (sum - expected).abs() <= 1e-12 * expected,
                "{sum} for {expected}: {polygon:?}"
            );
            assert_eq!(defects, Defects::default(), "{polygon:?}");
        }
    }

    /// The same polygons in any plane: rounding takes their corners out of it by up to 1e-10 of their
    /// size when they are a million times their size away, and of the areas it leaves 1e-12.
    #[test]
    fn areas_are_kept_in_any_plane_and_far_away() {
        let mut random = Uniform::new(11, 0, 0);
        for case in 0..400 {
            let polygon = grown(4 + case % 200, &mut random);
            let mut angle = || TAU * random.number();
            let tilt = DQuat::from_euler(glam::EulerRot::XYZ, angle(), angle(), angle());
            let offset = [0.0, 1e2, 1e4, 1e6][case % 4] * dvec3(1.0, -0.7, 0.3);
            let place = |&[x, y]: &[i64; 2]| dvec3(x as f64, y as f64, 0.0) / f64::from(1 << 20);
            let corners: Vec<DVec3> = polygon.iter().map(|p| tilt * place(p) + offset).collect();
            let ((sum, defects), whole) = (cut(&corners), area(&corners));
            assert!((sum - whole).abs() <= 1e-12 * whole, "{sum} for {whole}: {corners:?}");
            assert_eq!(defects, Defects::default());
        }
    }

    /// Star-shaped polygons of random radius, and spirals: simple, and hard on ears.
    #[test]
    fn areas_of_random_polygons_are_kept() {
        let mut numbers = Uniform::new(12, 0, 0);
        let mut random = || numbers.number();
        for case in 0..2000 {
            let count = 5 + case % 60;
            let tilt = DQuat::from_euler(glam::EulerRot::XYZ, random(), random(), random());
            let star = |i: usize, r: f64| {
                let angle = TAU * i as f64 / count as f64;
                r * dvec3(angle.cos(), angle.sin(), 0.0)
            };
            let spiral = |i: usize| {
                let (turn, r) = if i < count { (i, 1.0) } else { (2 * count - 1 - i, 1.2) };
                let angle = 0.3 * turn as f64;
                (r + 0.1 * angle) * dvec3(angle.cos(), angle.sin(), 0.0)
            };
            let corners: Vec<DVec3> = if case % 2 == 0 {
                (0..count).map(|i| tilt * star(i, 0.05 + random())).collect()
            } else {
                (0..2 * count).map(|i| tilt * spiral(i)).collect()
            };
            let (sum, defects) = cut(&corners);
            let whole = area(&corners);
            assert!((sum - whole).abs() <= 1e-12 * whole, "{sum} for {whole}: {corners:?}");
            assert_eq!(defects, Defects::default());
        }
    }

    #[test]
    fn defects_are_seen() {
        let crossing: [&[[f64; 2]]; 4] = [
            // A bow-tie, one with lobes of the same area, a bow-tie with a tail, a pentagram.
            &[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 3.0]],
            &[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]],
            &[[0.0, 0.0], [2.0, 2.0], [3.0, 1.0], [2.0, 0.0], [0.0, 3.0]],
            &[[0.0, 1.0], [0.6, -0.8], [-1.0, 0.3], [1.0, 0.3], [-0.6, -0.8]],
        ];
        for corners in crossing {
            assert!(cut(&polygon(corners)).1.self_intersecting, "{corners:?}");
        }
        let lifted = |height| [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, height], [0.0, 1.0, 0.0]];
        assert!(cut(&lifted(0.1).map(DVec3::from)).1.non_planar);
        assert!(!cut(&lifted(1e-6).map(DVec3::from)).1.non_planar);
    }

    #[test]
    fn polygons_of_no_area_give_triangles_of_no_area() {
        for corners in [&[[1.0, 1.0]; 6][..], &[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]] {
            assert_eq!(cut(&polygon(corners)), (0.0, Defects::default()));
        }
    }

    /// Convex, and with every second corner reflex.
    #[test]
    fn large_polygons_are_cut_as_well() {
        for (count, depth) in [(100_000, 0.0), (20_000, 0.5)] {
            let corners: Vec<DVec3> = (0..count)
                .map(|i| {
                    let angle = TAU * f64::from(i) / f64::from(count);
                    (1.0 - depth * f64::from(i % 2)) * dvec3(angle.cos(), angle.sin(), 0.0)
                })
                .collect();
            let (sum, defects) = cut(&corners);
            assert!((sum - area(&corners)).abs() < 1e-12 * sum);
            assert_eq!(defects, Defects::default());
        }
    }
}
