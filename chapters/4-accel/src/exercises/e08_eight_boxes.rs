//! E4.8: eight boxes at once.

use glam::{DVec3, Vec3};
use lancer_core::Rgb;
use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};
use lancer_core::image::{Image, ImageSize};
use lancer_core::sampling::Uniform;
use lancer_exercise::{
    Card, Check, Exercise, Mismatch, Shown, Solution, Verdict, ensure, same, slips,
};
use lancer_lesson::picture::painted;

use super::reference::{eight_boxes, near_to_far};
use super::{Lanes, PreparedRay, Subject};

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E4.8",
        name: "eight-boxes",
        title: "Eight boxes at once",
        slide: "Accélération matérielle",
        stub: include_str!("../../stubs/e08_eight_boxes.rs"),
        functions: &["eight_boxes", "near_to_far"],
        minutes: 25,
        predict: "left the picture shows boxes by their distance, right how many nodes of eight boxes each ray \
                  tests: which rays are the costly ones, those that hit a near box or those that pass between \
                  boxes?",
        vary: "give back the lanes in the order of their numbers, and draw again: the left picture stays; where \
               does the right one change, and why not where a ray hits nothing?",
        hints: [
            "It is E4.1 with eight answers: every lane has its own near and far, and all lanes do the same \
             steps. What depends on the ray alone, such as which row comes first, is decided outside the loop \
             over the lanes.",
            "near = max(0, t of the three first planes, by the near offsets), far = min(max, t of the three last \
             planes, by the far offsets); a box is met if near ≤ far. The row that comes first on axis k is 2k, \
             or 2k + 1 if the inverse is negative.",
            "For each axis: `let first = 2 * axis + usize::from(inverse < 0.0);` with the last row at `first ^ 1`, \
             and for each lane `near[lane] = near[lane].max(planes[first][lane] * inverse + \
             ray.near_offset[axis]);`. A bit is `u32::from(near[lane] <= far[lane]) << lane`. Then collect the \
             lanes with `met >> lane & 1 == 1` and sort them by `near[a].total_cmp(&near[b])`; `sort_by` keeps \
             equal ones in order.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e08_eight_boxes.rs"),
            file: "crates/accel/src/wide/ray.rs",
            item: "pub(super) fn enter",
            notice: "which row comes first is a bit per axis, known when the ray is prepared; and push_but_nearest, in \
                     walk.rs, sorts integers, since the bits of numbers that are not negative are in the order of \
                     the numbers",
        },
    },
    checks: &[
        Check { name: "forwards", run: forwards },
        Check { name: "backwards along each axis", run: backwards },
        Check { name: "empty lanes", run: empty },
        Check { name: "behind the origin, and around it", run: behind },
        Check { name: "up to max, and beyond it", run: beyond },
        Check { name: "in a face", run: in_a_face },
        Check { name: "by a hair past the boxes, or into them", run: by_a_hair },
        Check { name: "a corner that eight boxes share", run: corner },
        Check { name: "as one box after the other", run: one_by_one },
        Check { name: "near to far", run: order },
        Check { name: "only the lanes that are met", run: only_met },
        Check { name: "entered at the same t", run: ties },
        Check { name: "every ray of the picture", run: two_levels },
    ],
    slips: slips! {
        eight_boxes(planes, ray, max):
        "the lowest planes are taken as first, the highest as last: where the inverse is negative a ray meets the \
         highest first":
            "backwards along each axis" catches
                clip(planes, ray, [0.0, max], |low, high, _| [low, high]);
        "the two planes are sorted by their t: in an empty lane, lowest ∞ and highest −∞, that makes a box of \
         everything. The sign of the inverse says which comes first":
            "empty lanes" catches
                clip(planes, ray, [0.0, max], |low, high, _| [low.min(high), low.max(high)]);
        "the rows are read in another order: they are lowest x, highest x, lowest y, highest y, lowest z, highest z":
            "forwards" catches {
                let [a, b, c, d, e, f] = *planes;
                eight_boxes(&[a, d, b, e, c, f], ray, max)
            };
        "the bits are in the opposite order: lane 0 is the lowest bit, 1 << 0":
            "forwards" catches {
                let (near, met) = eight_boxes(planes, ray, max);
                (near, met.reverse_bits() >> 24)
            };
        "a box that is met at one t only is left out: compare near with far by ≤, not by <":
            "behind the origin, and around it" catches {
                let ranges = clipped(planes, ray, [0.0, max], in_order);
                answer(ranges, |near, far| near < far)
            };
        "something fixed is added to the far t: the offsets hold all that rounding needs, and boxes that are missed by \
         less than that count now":
            "by a hair past the boxes, or into them" catches {
                let ranges = clipped(planes, ray, [0.0, max], in_order);
                answer(ranges, |near, far| near <= far + 1e-3 && near <= max)
            };
        "the range does not begin at 0: boxes behind the origin count":
            "behind the origin, and around it" catches
                clip(planes, ray, [f32::NEG_INFINITY, max], in_order);
        "`max` is not looked at: boxes beyond the closest hit count":
            "up to max, and beyond it" catches eight_boxes(planes, ray, f32::INFINITY);
        "the near offset is taken for the last planes: a box that is only touched may, once rounded, be left \
         before it is entered":
            "a corner that eight boxes share" catches
                eight_boxes(planes, &PreparedRay { far_offset: ray.near_offset, ..*ray }, max);
        "the far offset is taken for the first planes: boxes are entered too late, and one that begins at max is \
         lost":
            "up to max, and beyond it" catches
                eight_boxes(planes, &PreparedRay { near_offset: ray.far_offset, ..*ray }, max);

        near_to_far(near, met):
        "all eight lanes are put in order, whether their bit is set or not":
            "only the lanes that are met" catches near_to_far(near, 0xff);
        "the lanes are in the order of their numbers: sort them by the t at which they are entered":
            "near to far" catches (0..8).filter(|lane| met >> lane & 1 == 1).collect();
        "the farthest comes first: what is near often makes the rest superfluous":
            "near to far" catches {
                let mut lanes = near_to_far(near, met);
                lanes.sort_by(|&a, &b| near[b].total_cmp(&near[a]));
                lanes
            };
        "t is cut to a whole number before it is compared: 0.25 and 0.5 become equal. Floats compare by `total_cmp`":
            "near to far" catches {
                let mut lanes = near_to_far(near, met);
                lanes.sort();
                lanes.sort_by_key(|&lane| near[lane] as i32);
                lanes
            };
        "of lanes at the same t the larger number comes first: sort near to far, from the lower lanes on, by a \
         sort that keeps equal ones in order":
            "entered at the same t" catches {
                let mut lanes = near_to_far(near, met);
                lanes.reverse();
                lanes.sort_by(|&a, &b| near[a].total_cmp(&near[b]));
                lanes
            };
    },
    own: |yours, reference| Subject {
        eight_boxes: yours.eight_boxes,
        near_to_far: yours.near_to_far,
        ..reference
    },
    draw,
    explain: None,
};

/// What eight boxes leave of a range, by which of a slab's planes is taken for the first and the last: from the
/// products of the lowest and the highest with the inverse, and whether that is negative.
fn clipped(
    planes: &[Lanes; 6],
    ray: &PreparedRay,
    range: [f32; 2],
    slab: impl Fn(f32, f32, bool) -> [f32; 2],
) -> [[f32; 2]; 8] {
    std::array::from_fn(|lane| {
        (0..3).fold(range, |[near, far], k| {
            let [low, high] = [2 * k, 2 * k + 1].map(|row| planes[row][lane] * ray.inverse[k]);
            let [first, last] = slab(low, high, ray.inverse[k] < 0.0);
            [near.max(first + ray.near_offset[k]), far.min(last + ray.far_offset[k])]
        })
    })
}

fn in_order(low: f32, high: f32, turned: bool) -> [f32; 2] {
    if turned { [high, low] } else { [low, high] }
}

/// Where ranges begin, and the bits of those that are met.
fn answer(ranges: [[f32; 2]; 8], is_met: impl Fn(f32, f32) -> bool) -> (Lanes, u32) {
    let bit = |lane: usize| u32::from(is_met(ranges[lane][0], ranges[lane][1])) << lane;
    (ranges.map(|[near, _]| near), (0..8).map(bit).sum())
}

/// A test of eight boxes by another range, or other planes.
fn clip(
    planes: &[Lanes; 6],
    ray: &PreparedRay,
    range: [f32; 2],
    slab: impl Fn(f32, f32, bool) -> [f32; 2],
) -> (Lanes, u32) {
    answer(clipped(planes, ray, range, slab), |near, far| near <= far)
}

/// A box in each lane, or none.
type Boxes = [Option<Bounds3>; 8];

/// Boxes whose coordinates are exact in `f32`.
fn rows(boxes: &Boxes) -> [Lanes; 6] {
    std::array::from_fn(|row| {
        boxes.map(|bounds| {
            let Bounds3 { min, max } = bounds.unwrap_or(Bounds3::EMPTY);
            [min, max][row % 2][row / 2] as f32
        })
    })
}

/// The way from a point into the octant of a lane, a bit for each axis.
fn octant(lane: usize, size: f64) -> DVec3 {
    let side = |axis: usize| if lane >> axis & 1 == 1 { size } else { -size };
    DVec3::new(side(0), side(1), side(2))
}

fn bounds(min: [f64; 3], max: [f64; 3]) -> Option<Bounds3> {
    Some(Bounds3 { min: min.into(), max: max.into() })
}

fn case(lane: usize, boxes: &Boxes, ray: &Ray, max: f32) -> String {
    let place = boxes[lane]
        .map_or("empty, from ∞ to −∞".to_owned(), |Bounds3 { min, max }| {
            format!("box {} to {}", min.shown(), max.shown())
        });
    format!("lane {lane}: {place}; {}, max {max}", ray.shown())
}

fn judge_met(case: impl Fn() -> String, met: u32, lane: usize, wanted: bool) -> Verdict {
    let shown = |bit| if bit { "met" } else { "not met" };
    let got = met >> lane & 1 == 1;
    ensure(got == wanted, || Mismatch::new(case(), shown(got), shown(wanted)))
}

/// The pad of no ray of the checks moves a t by more than this.
const SLACK: f64 = 1e-4;

/// A ray may enter a box too early by the pad, but never too late, since the box might then be skipped.
fn judge_near(case: impl Fn() -> String, got: f32, wanted: f64) -> Verdict {
    if ((wanted - SLACK).max(0.0)..=wanted).contains(&f64::from(got)) {
        return Ok(());
    }
    let (got, mut text) = (f64::from(got), wanted.shown());
    if wanted > 0.0 {
        text += ", or up to 0.0001 less";
    }
    if (0.0..SLACK).contains(&(got - wanted)) {
        text += &format!("; this is {} too late", (got - wanted).shown());
    }
    Err(Mismatch::new(case() + ": t", got.shown(), text))
}

/// Where each box is entered, if it is.
type Entries = [Option<f64>; 8];

fn compare(subject: &Subject, boxes: &Boxes, ray: &Ray, max: f32, wanted: Entries) -> Verdict {
    let (near, met) = (subject.eight_boxes)(&rows(boxes), &PreparedRay::new(ray), max);
    (0..8).try_for_each(|lane| {
        let case = || case(lane, boxes, ray, max);
        judge_met(case, met, lane, wanted[lane].is_some())?;
        wanted[lane].map_or(Ok(()), |wanted| judge_near(case, near[lane], wanted))
    })
}

/// Eight boxes and a ray; it enters them by x, y or z, or leaves one slab before it is in another.
fn scattered() -> (Boxes, Ray, Entries) {
    let boxes = [
        bounds([0.0, -0.75, -1.0], [0.25, 0.0, 1.0]),
        bounds([-1.0, -0.25, -1.0], [1.0, 0.5, 1.0]),
        bounds([-1.0, -1.0, -0.5625], [1.0, 1.0, 1.0]),
        bounds([0.5, -1.0, -1.0], [0.75, -0.5, 1.0]),
        bounds([-0.25, -0.5, -0.875], [0.25, 0.0, 0.0]),
        bounds([0.5, -0.5, -1.0], [1.0, 0.0, 0.0]),
        bounds([-0.5, -1.0, -0.5], [0.0, 1.0, 0.0]),
        bounds([0.625, -0.25, -0.75], [1.0, 0.25, 0.0]),
    ];
    let t = [Some(1.0), Some(1.5), Some(1.75), None, Some(1.0), Some(1.5), None, Some(1.625)];
    (boxes, Ray::new(DVec3::NEG_ONE, DVec3::new(1.0, 0.5, 0.25)), t)
}

fn forwards(subject: &Subject) -> Verdict {
    let (boxes, ray, t) = scattered();
    compare(subject, &boxes, &ray, 8.0, t)
}

/// The same in a mirror, which turns one direction, and then all of them.
fn backwards(subject: &Subject) -> Verdict {
    let (boxes, ray, t) = scattered();
    [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE].into_iter().try_for_each(|turned| {
        let mirror = 1.0 - 2.0 * turned;
        let boxes = boxes.map(|bounds| {
            bounds.map(|Bounds3 { min, max }| {
                let (a, b) = (min * mirror, max * mirror);
                Bounds3 { min: a.min(b), max: a.max(b) }
            })
        });
        let ray = Ray::new(ray.origin * mirror, ray.direction * mirror);
        compare(subject, &boxes, &ray, 8.0, t)
    })
}

fn empty(subject: &Subject) -> Verdict {
    let (mut boxes, ray, mut t) = scattered();
    for lane in [0, 5, 7] {
        (boxes[lane], t[lane]) = (None, None);
    }
    compare(subject, &boxes, &ray, 8.0, t)?;
    for direction in [DVec3::ONE, DVec3::NEG_ONE, DVec3::X, DVec3::NEG_Y] {
        for max in [8.0, f32::INFINITY] {
            let ray = Ray::new(DVec3::ZERO, direction);
            compare(subject, &[None; 8], &ray, max, [None; 8])?;
        }
    }
    Ok(())
}

fn behind(subject: &Subject) -> Verdict {
    let boxes = [
        bounds([-0.5, -0.5, -0.5], [-0.25, 0.5, 0.5]),
        bounds([-0.5, -0.75, -0.5], [0.5, -0.25, 0.5]),
        bounds([-0.5, -0.5, -0.5], [0.5, 0.5, -0.25]),
        bounds([0.5, 0.0, 0.0], [0.75, 0.5, 0.5]),
        bounds([-0.25, -0.25, -0.25], [0.25, 0.25, 0.25]),
        // The origin is in the first face of this one, and in the last face of the next.
        bounds([0.0, -0.5, -0.5], [0.5, 0.5, 0.5]),
        bounds([-0.5, -0.5, -0.5], [0.0, 0.5, 0.5]),
        None,
    ];
    let ray = Ray::new(DVec3::ZERO, DVec3::new(1.0, 0.5, 0.25));
    let mut t = [None, None, None, Some(0.5), Some(0.0), Some(0.0), Some(0.0), None];
    compare(subject, &boxes, &ray, 8.0, t)?;
    // Up to t = 0 the ray is its origin only.
    t[3] = None;
    compare(subject, &boxes, &ray, 0.0, t)
}

/// A row of boxes that begin at t = 1, 1.25, 1.5 and so on.
fn beyond(subject: &Subject) -> Verdict {
    let boxes = [0.0, 0.25, 0.5, 0.515625, 0.75, -0.25, 0.625, 0.875]
        .map(|x| bounds([x, -0.5, -0.5], [x + 0.125, 0.5, 0.5]));
    let ray = Ray::new(DVec3::NEG_X, DVec3::new(1.0, 0.125, -0.125));
    let t = [Some(1.0), Some(1.25), Some(1.5), None, None, Some(0.75), None, None];
    compare(subject, &boxes, &ray, 1.5, t)
}

/// Along each axis in turn the ray does not move, at 0.25 from the middle, where boxes begin or end.
fn in_a_face(subject: &Subject) -> Verdict {
    let slabs = [
        [0.25, 0.5],
        [0.0, 0.25],
        [0.25, 0.25],
        [0.0, 0.5],
        [0.5, 0.75],
        [-0.5, 0.0],
        [0.375, 0.5],
        [0.0, 0.125],
    ];
    let t = [Some(0.75), Some(0.75), Some(0.75), Some(0.75), None, None, None, None];
    for axis in 0..3 {
        let turned = |x: f64, y: f64, z: f64| {
            let mut v = [x, y, z];
            v.rotate_right(axis);
            v
        };
        let boxes =
            slabs.map(|[low, high]| bounds(turned(low, -0.25, -0.25), turned(high, 0.25, 0.5)));
        for zero in [0.0, -0.0] {
            let (origin, direction) = (turned(0.25, -0.5, -1.0), turned(zero, 0.5, 1.0));
            compare(subject, &boxes, &Ray::new(origin.into(), direction.into()), 8.0, t)?;
        }
    }
    Ok(())
}

/// x is left at t = 1, and z reached so much later in four lanes, so much earlier in the others; the pads are less.
fn by_a_hair(subject: &Subject) -> Verdict {
    let late = [6, 8, 10, 12].map(|bits| 2.0_f64.powi(-bits));
    let late: [f64; 8] =
        std::array::from_fn(|lane| if lane < 4 { late[lane] } else { -late[lane - 4] });
    let boxes = late.map(|z| bounds([-0.5, -1.0, z], [0.0, 1.0, 0.5]));
    let t = late.map(|late| (late < 0.0).then_some(1.0 + late));
    compare(subject, &boxes, &Ray::new(DVec3::NEG_ONE, DVec3::ONE), 8.0, t)
}

/// The point, the direction and t are dyadic, so the origin is exact and the ray passes through the point:
/// it meets all boxes around it, and each of them no later than there.
fn corner(subject: &Subject) -> Verdict {
    let mut random = Uniform::new(48, 0, 0);
    let mut whole = |from: f64, to: f64| (from + random.number() * (to - from)).round();
    for _ in 0..2000 {
        let [point, direction] = [512.0, 255.0]
            .map(|most| DVec3::from_array(std::array::from_fn(|_| whole(-most, most))));
        let (point, direction) = (point / 1024.0, direction / 256.0);
        let t = whole(1.0, 48.0) / 32.0;
        if direction == DVec3::ZERO {
            continue;
        }
        let ray = Ray::new(point - t * direction, direction);
        let boxes: Boxes = std::array::from_fn(|lane| {
            let far = point + octant(lane, 0.25);
            Some(Bounds3 { min: point.min(far), max: point.max(far) })
        });
        let max = t as f32;
        let (near, met) = (subject.eight_boxes)(&rows(&boxes), &PreparedRay::new(&ray), max);
        for (lane, near) in near.into_iter().enumerate() {
            let case =
                || case(lane, &boxes, &ray, max) + ", where it is in the corner " + &point.shown();
            judge_met(case, met, lane, true)?;
            if near > max {
                let late = f64::from(near - max).shown();
                let wanted = format!("no more than max; this is {late} too late");
                return Err(Mismatch::new(case() + ": t", f64::from(near).shown(), wanted));
            }
        }
    }
    Ok(())
}

/// Nor does it move a plane by more than this.
const PAD: f64 = 1e-5;

/// What `f64` meets must be met, and nothing that it misses by more than the pad.
fn one_by_one(subject: &Subject) -> Verdict {
    let mut random = Uniform::new(49, 0, 0);
    // Exact in `f32`.
    let mut point = || DVec3::from_array(std::array::from_fn(|_| random.number() - 0.5)).as_vec3();
    for _ in 0..500 {
        let boxes: Boxes = std::array::from_fn(|_| {
            let (a, b) = (2.0 * point(), point());
            let b = (a + b).clamp(Vec3::NEG_ONE, Vec3::ONE);
            Some(Bounds3 { min: a.min(b).as_dvec3(), max: a.max(b).as_dvec3() })
        });
        let origin = 3.0 * point().as_dvec3();
        let direction = (1.5 * point().as_dvec3() - origin).normalize();
        let direction = direction.abs().max(DVec3::splat(0.125)).copysign(direction);
        let ray = Ray::new(origin, direction);
        let slabs = Slabs::new(&ray);
        let (near, met) = (subject.eight_boxes)(&rows(&boxes), &PreparedRay::new(&ray), 2.0);
        for lane in 0..8 {
            let case = || case(lane, &boxes, &ray, 2.0);
            let Some(Bounds3 { min, max }) = boxes[lane] else { continue };
            let grown = Bounds3 { min: min - PAD, max: max + PAD };
            let enter = |bounds: Bounds3, end| {
                slabs.enter(bounds.min, bounds.max, Interval { min: 0.0, max: end })
            };
            if let Some(t) = enter(Bounds3 { min, max }, 2.0) {
                judge_met(case, met, lane, true)?;
                judge_near(case, near[lane], t)?;
            } else if enter(grown, 2.0 + SLACK).is_none() {
                judge_met(case, met, lane, false)?;
            }
        }
    }
    Ok(())
}

fn compare_order(subject: &Subject, near: Lanes, met: u32, wanted: &[usize]) -> Verdict {
    let got = (subject.near_to_far)(&near, met);
    let case = format!("near {near:?}, met {met:#010b}: the order of the lanes");
    ensure(got == wanted, || Mismatch::new(case, format!("{got:?}"), format!("{wanted:?}")))
}

const NEAR: Lanes = [0.5, 0.125, 9.0, 0.25, 7.0, 0.0, 8.0, 4.0];

fn order(subject: &Subject) -> Verdict {
    compare_order(subject, NEAR, 0xff, &[5, 1, 3, 0, 7, 4, 6, 2])
}

fn only_met(subject: &Subject) -> Verdict {
    compare_order(subject, NEAR, 0b1101_0101, &[0, 7, 4, 6, 2])?;
    compare_order(subject, NEAR, 0b1000_0000, &[7])?;
    compare_order(subject, NEAR, 0, &[])
}

fn ties(subject: &Subject) -> Verdict {
    let near = [2.0, 1.0, 2.0, 0.0, 1.0, 0.0, 2.0, 0.5];
    compare_order(subject, near, 0xff, &[3, 5, 7, 1, 4, 0, 2, 6])?;
    compare_order(subject, [0.0; 8], 0b0110_1100, &[2, 3, 5, 6])
}

/// Nodes of two levels: the first holds eight others, one in each octant, and these the boxes.
struct Nodes {
    boxes: [Boxes; 8],
    root: [Lanes; 6],
    below: [[Lanes; 6]; 8],
}

impl Nodes {
    /// Boxes of many sizes in a grid of 4³ places, one in four of which is empty.
    fn new() -> Self {
        let mut random = Uniform::new(50, 0, 0);
        let boxes: [Boxes; 8] = std::array::from_fn(|outer| {
            std::array::from_fn(|inner| {
                let center = octant(outer, 0.5) + octant(inner, 0.25);
                let size = DVec3::from_array(std::array::from_fn(|_| {
                    (4.0 + 10.0 * random.number()).round() / 64.0
                }));
                (random.number() < 0.75)
                    .then_some(Bounds3 { min: center - size, max: center + size })
            })
        });
        let around =
            |boxes: &Boxes| boxes.iter().flatten().copied().fold(Bounds3::EMPTY, Bounds3::union);
        let root = rows(&boxes.map(|boxes| Some(around(&boxes))));
        Self { root, below: boxes.map(|boxes| rows(&boxes)), boxes }
    }

    /// Where a ray meets the first box, infinite if it meets none, and how many nodes it tests.
    fn look(&self, subject: &Subject, ray: &Ray) -> (f32, u32) {
        let ray = PreparedRay::new(ray);
        let (mut closest, mut tested) = (f32::INFINITY, 1);
        let (near, met) = (subject.eight_boxes)(&self.root, &ray, closest);
        for lane in (subject.near_to_far)(&near, met) {
            if near[lane] > closest {
                continue;
            }
            tested += 1;
            let (near, met) = (subject.eight_boxes)(&self.below[lane], &ray, closest);
            for lane in (subject.near_to_far)(&near, met) {
                closest = closest.min(near[lane]);
            }
        }
        (closest, tested)
    }
}

/// The side of the picture's left half, and of its right one.
const SIDE: u32 = 160;

/// The ray of a pixel of the picture's left half.
fn ahead(x: f64, y: f64) -> Ray {
    let half = f64::from(SIDE / 2);
    let eye = DVec3::new(1.3, 1.7, 2.6);
    let ahead = -eye.normalize();
    let right = ahead.cross(DVec3::Y).normalize();
    let at = right * (x - half) + right.cross(ahead) * (half - y);
    Ray::new(eye, ahead + at / 175.0)
}

/// The rule lane by lane: met where the range is not empty, in the order of t and then of the numbers.
fn by_lanes(subject: &Subject) -> Subject {
    Subject {
        eight_boxes: |planes, ray, max| clip(planes, ray, [0.0, max], in_order),
        near_to_far: |near, met| {
            let mut lanes: Vec<usize> = (0..8).filter(|lane| met & (1 << lane) != 0).collect();
            lanes.sort_unstable_by(|a, b| near[*a].total_cmp(&near[*b]).then(a.cmp(b)));
            lanes
        },
        ..*subject
    }
}

/// The first of all boxes in `f64`, and the nodes that the rule tests lane by lane.
fn two_levels(subject: &Subject) -> Verdict {
    let nodes = Nodes::new();
    let fair = by_lanes(subject);
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        let ray = ahead(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let case = || format!("the picture's boxes, pixel {x} of row {y}; {}", ray.shown());
        let (t, tested) = nodes.look(subject, &ray);
        let slabs = Slabs::new(&ray);
        let all = nodes.boxes.iter().flatten().flatten();
        let entered = all.filter_map(|b| slabs.enter(b.min, b.max, Interval::POSITIVE));
        let first = entered.fold(f64::INFINITY, f64::min);
        // Where a box is just missed, its pad may be met.
        let (fair_t, fair_tested) = nodes.look(&fair, &ray);
        if fair_t.is_finite() && t.is_finite() && first.is_finite() {
            judge_near(case, t, first)?;
        } else {
            same(|| case() + ": t", &f64::from(t), &f64::from(fair_t))?;
        }
        same(|| case() + ": nodes tested", &tested, &fair_tested)?;
    }
    Ok(())
}

/// Left the distance of the boxes, right the number of nodes tested, red from 5 on.
fn draw(subject: &Subject) -> Image {
    let nodes = Nodes::new();
    let half = f64::from(SIDE);
    painted(ImageSize::new(2 * SIDE, SIDE), |x, y| {
        let (t, tested) = nodes.look(subject, &ahead(x % half, y));
        if x < half {
            return Rgb::splat(((4.4 - f64::from(t)) / 3.0).max(0.0));
        }
        let part = (f64::from(tested - 1) / 4.0).min(1.0);
        Rgb::new(part, 0.7 * part * (1.0 - part), 0.5 * (1.0 - part))
    })
}
