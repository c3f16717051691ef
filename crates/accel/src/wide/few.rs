//! A few primitives, without a tree: four at a time in `f64`.

use lancer_core::geometry::{
    Axis, Interval, Ray, Real, Shear, intersect_spheres, intersect_triangles,
};
use lancer_core::intersector::{Hit, Observer};
use lancer_core::scene::{PrimitiveId, Shape, Subset};

use super::lanes::Lanes;

/// So many primitives are asked one and all: a tree would cost more.
pub(super) const FEW: usize = 64;

/// What is asked at once.
const FOUR: usize = 4;

/// Primitives in order of their ids, each kind in groups of four. A place that nobody has is met by no ray.
#[derive(Debug)]
pub(super) struct Few {
    /// Corners, coordinates, places.
    triangles: Vec<[[[f64; FOUR]; 3]; 3]>,
    /// Coordinates of the centres and radii, places.
    spheres: Vec<([[f64; FOUR]; 3], [f64; FOUR])>,
    /// Of all places, the triangles' first.
    ids: Vec<[Option<PrimitiveId>; FOUR]>,
}

impl Few {
    pub(super) fn new(primitives: &Subset) -> Self {
        let scene = primitives.scene();
        let is_triangle = |id: &PrimitiveId| matches!(scene.shape(*id), Shape::Triangle(_));
        let (triangles, spheres): (Vec<_>, Vec<_>) = primitives.iter().partition(is_triangle);
        let groups = |ids: &[PrimitiveId]| -> Vec<[Option<PrimitiveId>; FOUR]> {
            let group = |ids: &[PrimitiveId]| std::array::from_fn(|place| ids.get(place).copied());
            ids.chunks(FOUR).map(group).collect()
        };
        let (triangles, spheres) = (groups(&triangles), groups(&spheres));
        let mut few = Self { triangles: Vec::new(), spheres: Vec::new(), ids: Vec::new() };
        for group in &triangles {
            let mut corners = [[[f64::NAN; FOUR]; 3]; 3];
            for (place, id) in group.iter().enumerate() {
                let Some(id) = id else { continue };
                let of = scene.mesh.corners(id.0 as usize).map(|corner| corner.to_array());
                for (corner, axis) in (0..9).map(|k| (k / 3, k % 3)) {
                    corners[corner][axis][place] = of[corner][axis];
                }
            }
            few.triangles.push(corners);
        }
        for group in &spheres {
            let (mut centers, mut radii) = ([[0.0; FOUR]; 3], [0.0; FOUR]);
            for (place, id) in group.iter().enumerate() {
                let Some(Shape::Sphere(index)) = id.map(|id| scene.shape(id)) else { continue };
                let sphere = scene.spheres[index].shape;
                for (axis, x) in sphere.center.to_array().into_iter().enumerate() {
                    centers[axis][place] = x;
                }
                radii[place] = sphere.radius;
            }
            few.spheres.push((centers, radii));
        }
        few.ids.extend(triangles.into_iter().chain(spheres));
        few
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        size_of_val(self.triangles.as_slice())
            + size_of_val(self.spheres.as_slice())
            + size_of_val(self.ids.as_slice())
    }

    /// All of them, in order.
    #[inline(always)]
    pub(super) fn primitives(&self) -> impl Iterator<Item = PrimitiveId> {
        self.ids.iter().flatten().flatten().copied()
    }

    /// Tells which of each group the ray meets, where, and with what weights, until `found` says that it is enough.
    #[inline(always)]
    fn ask<L: Lanes>(
        &self,
        lanes: L,
        ray: &Ray,
        range: Interval,
        mut found: impl FnMut(Met<L>) -> bool,
    ) {
        let all = Everywhere(lanes);
        let [o, d] = [ray.origin, ray.direction].map(|v| v.to_array());
        let (o, d) = (all.vector(o), all.vector(d));
        let [min, max] = [all.number(range.min), all.number(range.max)];
        if !self.triangles.is_empty() {
            let shear = Shear::along(Axis::longest(ray.direction), d);
            for (group, [a, b, c]) in self.triangles.iter().enumerate() {
                let corners = [
                    difference(all.places(a), o),
                    difference(all.places(b), o),
                    difference(all.places(c), o),
                ];
                if let Some((t, weights, met)) = intersect_triangles(corners, &shear) {
                    let met = met & min.below(t) & t.below(max);
                    if L::D::bits(met) != 0 && found(Met { group, t, weights, met }) {
                        return;
                    }
                }
            }
        }
        let none = all.vector([0.0; 3]);
        for (group, (centers, radii)) in (self.triangles.len()..).zip(&self.spheres) {
            let f = difference(o, all.places(centers));
            // The sphere's own range test would take the far point for a near one beyond the range.
            let endless = [min, all.number(f64::INFINITY)];
            if let Some((t, met)) = intersect_spheres(f, lanes.four(*radii), d, endless) {
                let met = met & t.below(max);
                if L::D::bits(met) != 0 && found(Met { group, t, weights: none, met }) {
                    return;
                }
            }
        }
    }

    /// The closest hit.
    #[inline(always)]
    pub(super) fn closest<L: Lanes, O: Observer>(
        &self,
        lanes: L,
        ray: &Ray,
        range: Interval,
        observer: &mut O,
    ) -> Option<Hit> {
        self.primitives().for_each(|primitive| observer.primitive_test(primitive));
        let all = Everywhere(lanes);
        let mut nearest = all.number(f64::INFINITY);
        let mut groups = all.number(-1.0);
        let mut weights = all.vector([0.0; 3]);
        self.ask(
            lanes,
            ray,
            range,
            #[inline(always)]
            |met| {
                // In one place the first group has the smaller id.
                let nearer = met.met & met.t.below(nearest);
                nearest = L::D::select(nearer, met.t, nearest);
                groups = L::D::select(nearer, all.number(met.group as f64), groups);
                weights = [
                    L::D::select(nearer, met.weights[0], weights[0]),
                    L::D::select(nearer, met.weights[1], weights[1]),
                    L::D::select(nearer, met.weights[2], weights[2]),
                ];
                false
            },
        );
        let (nearest, groups) = (lanes.numbers(nearest), lanes.numbers(groups));
        let order = |&a: &usize, &b: &usize| {
            nearest[a].total_cmp(&nearest[b]).then(groups[a].total_cmp(&groups[b]))
        };
        let place = (0..FOUR).min_by(order)?;
        // Nothing is met in a place whose group is −1.
        let primitive = self.ids.get(groups[place] as usize)?[place]?;
        (groups[place] >= 0.0).then(|| Hit {
            t: nearest[place],
            primitive,
            barycentric: weights.map(|w| lanes.numbers(w)[place]).into(),
        })
    }

    /// One that the ray meets.
    #[inline(always)]
    pub(super) fn any<L: Lanes, O: Observer>(
        &self,
        lanes: L,
        ray: &Ray,
        range: Interval,
        observer: &mut O,
    ) -> Option<PrimitiveId> {
        let mut any = None;
        self.primitives().for_each(|primitive| observer.primitive_test(primitive));
        self.ask(
            lanes,
            ray,
            range,
            #[inline(always)]
            |met| {
                any = self.ids[met.group][L::D::bits(met.met).trailing_zeros() as usize % FOUR];
                true
            },
        );
        any
    }
}

/// What is met of a group.
struct Met<L: Lanes> {
    group: usize,
    t: L::D,
    weights: [L::D; 3],
    met: <L::D as Real>::Mask,
}

/// Numbers that are the same in all places, or not.
#[derive(Clone, Copy)]
struct Everywhere<L>(L);

impl<L: Lanes> Everywhere<L> {
    #[inline(always)]
    fn number(self, x: f64) -> L::D {
        self.0.four([x; FOUR])
    }

    #[inline(always)]
    fn vector(self, [x, y, z]: [f64; 3]) -> [L::D; 3] {
        [self.number(x), self.number(y), self.number(z)]
    }

    #[inline(always)]
    fn places(self, [x, y, z]: &[[f64; FOUR]; 3]) -> [L::D; 3] {
        [self.0.four(*x), self.0.four(*y), self.0.four(*z)]
    }
}

#[inline(always)]
fn difference<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
