//! A few primitives, without a tree: four at a time in `f64`.

use glam::DVec3;
use lancer_core::geometry::{
    Axis, Interval, Ray, Real, Shear, intersect_spheres, intersect_triangles,
};
use lancer_core::intersector::{Hit, Observer};
use lancer_core::scene::{PrimitiveId, Shape, Subset};

use smallvec::SmallVec;

use super::lanes::{Lanes, difference};

/// So many primitives are asked one and all: a tree would cost more.
pub(super) const FEW: usize = 16;

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
    /// How many places of each group are taken.
    counts: Vec<usize>,
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
        let mut few = Self {
            triangles: Vec::new(),
            spheres: Vec::new(),
            ids: Vec::new(),
            counts: Vec::new(),
        };
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
        few.counts.extend(few.ids.iter().map(|group| group.iter().flatten().count()));
        few
    }

    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        size_of_val(self.triangles.as_slice())
            + size_of_val(self.spheres.as_slice())
            + size_of_val(self.ids.as_slice())
            + size_of_val(self.counts.as_slice())
    }

    /// All of them, in order.
    #[inline(always)]
    pub(super) fn primitives(&self) -> impl Iterator<Item = PrimitiveId> {
        self.ids.iter().flatten().flatten().copied()
    }

    /// Asks a ray in all lanes about four primitives at a time, or four rays about one at a time if they are `apart`.
    /// `found` is told what is met in any lane, until it says that it is enough.
    #[inline(always)]
    fn ask<L: Lanes>(
        &self,
        lanes: L,
        rays: &Rays<L>,
        apart: bool,
        range: Interval,
        mut found: impl FnMut(Met<L>) -> bool,
    ) {
        let all = Everywhere { lanes, apart };
        let [min, max] = [all.number(range.min), all.number(range.max)];
        for Sheared { shear, along } in &rays.shears {
            for (group, (corners, &count)) in self.triangles.iter().zip(&self.counts).enumerate() {
                for place in 0..if apart { count } else { 1 } {
                    let corners = [
                        difference(all.at(&corners[0], place), rays.origin),
                        difference(all.at(&corners[1], place), rays.origin),
                        difference(all.at(&corners[2], place), rays.origin),
                    ];
                    let met = intersect_triangles(corners, shear, [min, max]);
                    if let Some((t, weights, met)) = met {
                        let met = met & t.below(max) & *along;
                        let place = group * FOUR + place;
                        if L::D::bits(met) != 0 && found(Met { place, t, weights, met }) {
                            return;
                        }
                    }
                }
            }
        }
        // The far point of a sphere is no hit where the near one lies beyond the range.
        let endless = [min, all.number(f64::INFINITY)];
        let weights = all.vector([0.0; 3]);
        let first = self.triangles.len();
        for (group, ((centers, radii), &count)) in
            (first..).zip(self.spheres.iter().zip(&self.counts[first..]))
        {
            for place in 0..if apart { count } else { 1 } {
                let f = difference(rays.origin, all.at(centers, place));
                let radius = all.of(radii, place);
                if let Some((t, met)) = intersect_spheres(f, radius, rays.direction, endless) {
                    let met = met & t.below(max);
                    let place = group * FOUR + place;
                    if L::D::bits(met) != 0 && found(Met { place, t, weights, met }) {
                        return;
                    }
                }
            }
        }
    }

    /// What is nearest in each lane.
    #[inline(always)]
    fn nearest<L: Lanes>(&self, lanes: L, rays: &Rays<L>, apart: bool, range: Interval) -> Nearest {
        let all = Everywhere { lanes, apart };
        let mut nearest = all.number(f64::INFINITY);
        let mut place = all.number(-1.0);
        let mut weights = all.vector([0.0; 3]);
        self.ask(
            lanes,
            rays,
            apart,
            range,
            #[inline(always)]
            |met| {
                // Of equal ones the first has the smaller id.
                let nearer = met.met & met.t.below(nearest);
                nearest = L::D::select(nearer, met.t, nearest);
                place = L::D::select(nearer, all.number(met.place as f64), place);
                weights = [
                    L::D::select(nearer, met.weights[0], weights[0]),
                    L::D::select(nearer, met.weights[1], weights[1]),
                    L::D::select(nearer, met.weights[2], weights[2]),
                ];
                false
            },
        );
        let [u, v, w] = weights;
        Nearest {
            t: lanes.numbers(nearest),
            place: lanes.numbers(place),
            weights: [lanes.numbers(u), lanes.numbers(v), lanes.numbers(w)],
        }
    }

    /// The hit of a lane whose places stand so far behind those of the first lane.
    #[inline(always)]
    fn hit(&self, nearest: &Nearest, lane: usize, behind: usize) -> Option<Hit> {
        let place = nearest.place[lane];
        if place < 0.0 {
            return None;
        }
        let [u, v, w] = &nearest.weights;
        let place = place as usize + behind;
        Some(Hit {
            t: nearest.t[lane],
            primitive: self.ids[place / FOUR][place % FOUR]?,
            barycentric: DVec3::new(u[lane], v[lane], w[lane]),
        })
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
        let nearest = self.nearest(lanes, &Rays::same(lanes, ray), false, range);
        // (t, id), whose order is that of their lanes within a group.
        let key = |lane: usize| (nearest.t[lane], nearest.place[lane]);
        let mut first = 0;
        for lane in 1..FOUR {
            if key(lane) < key(first) {
                first = lane;
            }
        }
        self.hit(&nearest, first, first)
    }

    /// The closest hits of many rays.
    #[inline(always)]
    pub(super) fn closest_hits<L: Lanes>(
        &self,
        lanes: L,
        rays: &[Ray],
        range: Interval,
        hits: &mut [Option<Hit>],
    ) {
        for (rays, hits) in rays.chunks(FOUR).zip(hits.chunks_mut(FOUR)) {
            if let [ray] = rays {
                hits[0] = self.closest(lanes, ray, range, &mut ());
                continue;
            }
            let nearest = self.nearest(lanes, &Rays::four(lanes, rays), true, range);
            for (lane, hit) in hits.iter_mut().enumerate() {
                *hit = self.hit(&nearest, lane, 0);
            }
        }
    }

    /// Whether many rays meet anything.
    #[inline(always)]
    pub(super) fn occluded_all<L: Lanes>(
        &self,
        lanes: L,
        rays: &[Ray],
        range: Interval,
        occluded: &mut [bool],
    ) {
        for (rays, occluded) in rays.chunks(FOUR).zip(occluded.chunks_mut(FOUR)) {
            if let [ray] = rays {
                occluded[0] = self.any(lanes, ray, range, &mut ()).is_some();
                continue;
            }
            let mut any = 0;
            self.ask(
                lanes,
                &Rays::four(lanes, rays),
                true,
                range,
                #[inline(always)]
                |met| {
                    any |= L::D::bits(met.met);
                    any == (1 << FOUR) - 1
                },
            );
            for (lane, occluded) in occluded.iter_mut().enumerate() {
                *occluded = any >> lane & 1 != 0;
            }
        }
    }

    /// One that the ray meets. Observers are told of all primitives, whichever is met first.
    #[inline(always)]
    pub(super) fn any<L: Lanes, O: Observer>(
        &self,
        lanes: L,
        ray: &Ray,
        range: Interval,
        observer: &mut O,
    ) -> Option<PrimitiveId> {
        self.primitives().for_each(|primitive| observer.primitive_test(primitive));
        let mut any = None;
        self.ask(
            lanes,
            &Rays::same(lanes, ray),
            false,
            range,
            #[inline(always)]
            |met| {
                any = self.ids[met.place / FOUR]
                    [L::D::bits(met.met).trailing_zeros() as usize % FOUR];
                true
            },
        );
        any
    }
}

/// A ray in each lane.
struct Rays<L: Lanes> {
    origin: [L::D; 3],
    direction: [L::D; 3],
    /// For each axis along which rays go most.
    shears: SmallVec<[Sheared<L::D>; 3]>,
}

impl<L: Lanes> Rays<L> {
    /// The same in all lanes.
    #[inline(always)]
    fn same(lanes: L, ray: &Ray) -> Self {
        let all = Everywhere { lanes, apart: false };
        let origin = all.vector([ray.origin.x, ray.origin.y, ray.origin.z]);
        let direction = all.vector([ray.direction.x, ray.direction.y, ray.direction.z]);
        let shear = Shear::along(Axis::longest(ray.direction), direction);
        let along = all.number(0.0).at_most(all.number(0.0));
        Self { origin, direction, shears: SmallVec::from_iter([Sheared { shear, along }]) }
    }

    /// Up to four, the last one in all lanes that are left.
    #[inline(always)]
    fn four(lanes: L, rays: &[Ray]) -> Self {
        let last = rays.len() - 1;
        let [a, b, c, d] = [&rays[0], &rays[last.min(1)], &rays[last.min(2)], &rays[last.min(3)]];
        let origin = lanes.vectors([a.origin, b.origin, c.origin, d.origin]).0;
        let direction = lanes.vectors([a.direction, b.direction, c.direction, d.direction]).0;
        let longest = [
            Axis::longest(a.direction),
            Axis::longest(b.direction),
            Axis::longest(c.direction),
            Axis::longest(d.direction),
        ];
        let mut shears = SmallVec::new();
        for axis in [Axis::X, Axis::Y, Axis::Z] {
            if longest.contains(&axis) {
                let of = |lane: usize| f64::from(u8::from(longest[lane] != axis));
                let along = lanes.four([of(0), of(1), of(2), of(3)]).at_most(lanes.four([0.0; 4]));
                shears.push(Sheared { shear: Shear::along(axis, direction), along });
            }
        }
        Self { origin, direction, shears }
    }
}

/// The shear of rays that go along one axis most, and the lanes with such a ray.
struct Sheared<T: Real> {
    shear: Shear<T>,
    along: T::Mask,
}

/// What is met in some lanes.
struct Met<L: Lanes> {
    /// Among all; if each lane has its own, that of the first.
    place: usize,
    t: L::D,
    weights: [L::D; 3],
    met: <L::D as Real>::Mask,
}

/// The nearest in each lane so far.
struct Nearest {
    t: [f64; FOUR],
    /// Its place among all, for lanes with places of their own that of the first lane; −1 if nothing is met.
    place: [f64; FOUR],
    weights: [[f64; FOUR]; 3],
}

/// Fills lanes.
#[derive(Clone, Copy)]
struct Everywhere<L> {
    lanes: L,
    apart: bool,
}

impl<L: Lanes> Everywhere<L> {
    #[inline(always)]
    fn number(self, x: f64) -> L::D {
        self.lanes.four([x; FOUR])
    }

    #[inline(always)]
    fn vector(self, [x, y, z]: [f64; 3]) -> [L::D; 3] {
        [self.number(x), self.number(y), self.number(z)]
    }

    /// The number of one place, or those of all.
    #[inline(always)]
    fn of(self, places: &[f64; FOUR], place: usize) -> L::D {
        if self.apart { self.number(places[place]) } else { self.lanes.four(*places) }
    }

    #[inline(always)]
    fn at(self, [x, y, z]: &[[f64; FOUR]; 3], place: usize) -> [L::D; 3] {
        [self.of(x, place), self.of(y, place), self.of(z, place)]
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;
    use lancer_core::generate::cube;
    use lancer_core::geometry::Sphere;
    use lancer_core::intersector::{Intersector, LinearScan};
    use lancer_core::scene::{MaterialId, Mesh, Scene, SphereObject};
    use rand_pcg::Pcg64;
    use rand_pcg::rand_core::Rng;

    use super::super::Wide;
    use super::super::tests::kernels;
    use super::*;

    /// Triangles and spheres of which some are twice in one place, `offset` away.
    fn scene(triangles: bool, spheres: usize, offset: DVec3) -> Scene {
        let mut mesh = Mesh::default();
        if triangles {
            (0..2).for_each(|_| mesh.append(&cube(), DAffine3::from_translation(offset), 0));
        }
        let mut scene = Scene::of_mesh(mesh);
        for k in 0..spheres {
            let at = (k / 2) as f64;
            let center = offset + DVec3::new(at.sin(), at.cos(), 0.3 * at - 1.0);
            let shape = Sphere { center, radius: 0.3 + 0.1 * at };
            scene.spheres.push(SphereObject { shape, material: MaterialId(0) });
        }
        scene
    }

    /// The answers of brute force to rays at corners, edges and rims, in batches and alone, of few primitives and of
    /// many spheres in a tree.
    #[test]
    fn few_primitives_and_spheres_are_met_as_by_brute_force() {
        let mut random = Pcg64::new(7, 4);
        let mut number = move || f64::from(random.next_u32()) / f64::from(1 << 31) - 1.0;
        let (mut hits, mut ties) = (0, 0);
        for offset in [DVec3::ZERO, DVec3::new(148_376.0, 1234.0, -223_423.0)] {
            for (triangles, spheres) in
                [(true, 0), (false, 3), (false, 6), (true, 6), (false, 90), (true, 90)]
            {
                let scene = scene(triangles, spheres, offset);
                // Of each cube five triangles.
                let of_few = |id: &PrimitiveId| match scene.shape(*id) {
                    Shape::Triangle(index) => index % 12 < 5,
                    Shape::Sphere(_) => true,
                };
                let ids: Vec<PrimitiveId> = scene.primitives().filter(of_few).collect();
                let (count, primitives) = (ids.len(), scene.subset(ids));
                let oracle = LinearScan::new(primitives.clone());
                let rays: Vec<Ray> = (0..1200)
                    .map(|k: usize| {
                        let id = primitives.get(k * 7919 % count);
                        let mut vector = || DVec3::new(number(), number(), number());
                        let target = match scene.shape(id) {
                            Shape::Triangle(index) => {
                                let [a, b, c] = scene.mesh.corners(index);
                                [a, b, 0.5 * (b + c), (a + b + c) / 3.0][k % 4]
                            }
                            Shape::Sphere(index) => {
                                let Sphere { center, radius } = scene.spheres[index].shape;
                                center
                                    + radius * [1.0, 1.0 - 1e-15, 0.5][k % 3] * vector().normalize()
                            }
                        };
                        let origin = match k / 4 % 4 {
                            // Neighbours start in one point.
                            0 => offset + DVec3::new(0.1, 0.2, 5.0),
                            1 => target + [DVec3::X, -DVec3::Y, DVec3::Z][k % 3],
                            2 => offset + 0.2 * vector(),
                            _ => offset + 3.0 * vector(),
                        };
                        Ray::new(origin, target - origin)
                    })
                    .collect();
                for range in
                    [Interval::POSITIVE, Interval::up_to(1.0), Interval { min: 0.9, max: 1.5 }]
                {
                    let wanted: Vec<_> =
                        rays.iter().map(|ray| oracle.closest_hit(ray, range)).collect();
                    hits += wanted.iter().flatten().count();
                    ties += wanted.iter().flatten().filter(|hit| hit.primitive.0 % 2 == 0).count();
                    for kernel in kernels() {
                        let wide = Wide::with_kernel(primitives.clone(), kernel);
                        assert_eq!(wide.few.is_some(), count <= FEW);
                        let mut got = vec![None; rays.len()];
                        wide.closest_hits(&rays, range, &mut got);
                        assert_eq!(got, wanted, "{kernel:?} {range:?} {spheres}");
                        let mut occluded = vec![false; rays.len()];
                        wide.occluded_all(&rays, range, &mut occluded);
                        for ((ray, wanted), occluded) in rays.iter().zip(&wanted).zip(occluded) {
                            assert_eq!(
                                wide.closest_hit(ray, range),
                                *wanted,
                                "{kernel:?} {range:?}"
                            );
                            assert_eq!(occluded, wanted.is_some(), "{kernel:?} {range:?} {ray:?}");
                            assert_eq!(wide.occluded(ray, range), occluded);
                        }
                    }
                }
            }
        }
        assert!(hits > 20_000 && ties > 5_000, "{hits} {ties}");
    }
}
