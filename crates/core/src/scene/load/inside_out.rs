use glam::{DVec2, DVec3};

use crate::geometry::Sphere;

/// The most steps that are spent on surfaces of negative volume: some seconds. Beyond, none of them is judged.
pub(super) const BUDGET: usize = 1 << 27;

/// The closed surfaces that enclose a negative volume and are no hole in another one: their roots, and how many
/// triangles they have. A surface is named by one of its triangles, the root of each.
///
/// What is ahead of an open surface, or of one with joints, is not judged: it may be in any of the spaces there.
/// Nothing is judged where that takes more than `budget` steps, as of thousands of surfaces one in another.
pub(super) fn inside_out(
    corners: &[[DVec3; 3]],
    roots: &[u32],
    is_closed: &[bool],
    spheres: &[Sphere],
    budget: usize,
) -> Vec<(u32, usize)> {
    // Six times the volume, the sum of its terms' absolute values, and their number.
    let mut volumes = vec![(0.0, 0.0, 0); corners.len()];
    for (&root, triangle) in roots.iter().zip(corners) {
        let origin = corners[root as usize][0];
        let [a, b, c] = triangle.map(|corner| corner - origin);
        let volume = a.dot(b.cross(c));
        let (sum, size, count) = &mut volumes[root as usize];
        *sum += volume;
        *size += f64::abs(volume);
        *count += 1;
    }
    let is_negative = |&root: &usize| {
        let (sum, size, _) = volumes[root];
        // What encloses nothing, such as a sheet with two sides, sums to rounding errors.
        is_closed[root] && sum < -1e-9 * size
    };
    let plane = Plane::new(corners);
    let list = (0..corners.len()).filter(is_negative).map(|root| {
        let point = corners[root].iter().sum::<DVec3>() / 3.0;
        Suspect { root: root as u32, point, across: plane.project(point), winding: 0 }
    });
    let mut suspects = Suspects::new(list.collect(), budget);
    for (&root, triangle) in roots.iter().zip(corners) {
        let shadow = Shadow::new(&plane, triangle);
        let is_closed = is_closed[root as usize];
        suspects.visit(&|area| shadow.may_meet(area), &mut |suspect| {
            if suspect.root != root {
                let turns = crossing(suspect.point, triangle);
                suspect.winding += if is_closed { turns } else { turns.abs() };
            }
        });
    }
    for sphere in spheres {
        let (center, radius) = (plane.project(sphere.center), sphere.radius);
        let reach = radius + plane.rounding + ROUNDING * (sphere.center.length() + radius);
        let may_meet = |[min, max]: [DVec2; 2]| center.max(min).min(max).distance(center) <= reach;
        suspects.visit(&may_meet, &mut |suspect| {
            let is_inside = suspect.point.distance(sphere.center) < radius;
            suspect.winding += i32::from(is_inside);
        });
    }
    if suspects.budget == 0 {
        return Vec::new();
    }
    let guilty = suspects.list.iter().filter(|suspect| suspect.winding <= 0);
    guilty.map(|suspect| (suspect.root, volumes[suspect.root as usize].2)).collect()
}

/// A direction in which no author aligns edges.
const UP: DVec3 = DVec3::new(0.371_390_676, 0.557_086_015, 0.742_781_353);

/// A bound of the relative rounding error of what is projected.
const ROUNDING: f64 = 1e-13;

/// The plane across [`UP`].
struct Plane {
    axes: [DVec3; 2],
    /// How far rounding may move a projected corner.
    rounding: f64,
}

impl Plane {
    fn new(corners: &[[DVec3; 3]]) -> Self {
        let u = UP.cross(DVec3::X).normalize();
        let farthest = corners.iter().flatten().fold(0.0, |far, p| p.abs().max_element().max(far));
        Self { axes: [u, UP.cross(u).normalize()], rounding: ROUNDING * farthest }
    }

    fn project(&self, point: DVec3) -> DVec2 {
        DVec2::from_array(self.axes.map(|axis| point.dot(axis)))
    }
}

/// A closed surface of negative volume, asked how often the others wind around it.
struct Suspect {
    root: u32,
    point: DVec3,
    /// The point's projection.
    across: DVec2,
    winding: i32,
}

/// Suspects as a tree (k-d tree): the middle one of a list parts it in two, by x and y in turn.
struct Suspects {
    list: Vec<Suspect>,
    /// The box around their projections.
    area: [DVec2; 2],
    /// The steps left; at 0 nothing more is done.
    budget: usize,
}

impl Suspects {
    fn new(mut list: Vec<Suspect>, budget: usize) -> Self {
        sort(&mut list, 0);
        let far = DVec2::INFINITY;
        let around = |[min, max]: [DVec2; 2], s: &Suspect| [min.min(s.across), max.max(s.across)];
        let area = list.iter().fold([far, -far], around);
        Self { list, area, budget }
    }

    /// Shows `see` all suspects in the areas, given by two corners, that something `may_meet`.
    fn visit(
        &mut self,
        may_meet: &impl Fn([DVec2; 2]) -> bool,
        see: &mut impl FnMut(&mut Suspect),
    ) {
        visit(&mut self.list, 0, self.area, may_meet, see, &mut self.budget);
    }
}

fn sort(list: &mut [Suspect], axis: usize) {
    if list.len() > 1 {
        let by_axis = |a: &Suspect, b: &Suspect| a.across[axis].total_cmp(&b.across[axis]);
        let (low, _, high) = list.select_nth_unstable_by(list.len() / 2, by_axis);
        sort(low, 1 - axis);
        sort(high, 1 - axis);
    }
}

fn visit(
    list: &mut [Suspect],
    axis: usize,
    [min, max]: [DVec2; 2],
    may_meet: &impl Fn([DVec2; 2]) -> bool,
    see: &mut impl FnMut(&mut Suspect),
    budget: &mut usize,
) {
    if list.is_empty() || *budget == 0 {
        return;
    }
    *budget -= 1;
    if !may_meet([min, max]) {
        return;
    }
    let (low, rest) = list.split_at_mut(list.len() / 2);
    let Some((middle, high)) = rest.split_first_mut() else { return };
    see(middle);
    let (mut low_max, mut high_min) = (max, min);
    low_max[axis] = middle.across[axis];
    high_min[axis] = middle.across[axis];
    visit(low, 1 - axis, [min, low_max], may_meet, see, budget);
    visit(high, 1 - axis, [high_min, max], may_meet, see, budget);
}

/// The projection of a triangle, between two parallels to each axis and to each of its sides.
struct Shadow {
    /// A normal of the parallels, and where along it they are.
    strips: [(DVec2, f64, f64); 5],
}

impl Shadow {
    fn new(plane: &Plane, triangle: &[DVec3; 3]) -> Self {
        let [a, b, c] = triangle.map(|corner| plane.project(corner));
        let normal = |side: DVec2| side.perp().normalize_or_zero();
        let normals = [DVec2::X, DVec2::Y, normal(b - a), normal(c - b), normal(a - c)];
        let strips = normals.map(|normal| {
            let [a, b, c] = [a, b, c].map(|corner| corner.dot(normal));
            let margin = 4.0 * plane.rounding;
            (normal, a.min(b).min(c) - margin, a.max(b).max(c) + margin)
        });
        Self { strips }
    }

    fn may_meet(&self, [min, max]: [DVec2; 2]) -> bool {
        let (center, half) = (0.5 * (min + max), 0.5 * (max - min));
        self.strips.iter().all(|&(normal, low, high)| {
            let (at, reach) = (center.dot(normal), half.dot(normal.abs()));
            at + reach >= low && at - reach <= high
        })
    }
}

/// Whether the ray from `point` along [`UP`] leaves through the triangle, 1, or enters, −1. Around a closed surface
/// these sum to how often it winds around the point.
fn crossing(point: DVec3, triangle: &[DVec3; 3]) -> i32 {
    let [a, b, c] = triangle.map(|corner| corner - point);
    let sides = [a.cross(b), b.cross(c), c.cross(a)].map(|side| side.dot(UP));
    let is_ahead = a.dot(b.cross(c));
    if sides.iter().all(|&side| side > 0.0) && is_ahead > 0.0 {
        1
    } else if sides.iter().all(|&side| side < 0.0) && is_ahead < 0.0 {
        -1
    } else {
        0
    }
}
