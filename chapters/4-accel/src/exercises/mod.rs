//! The chapter's exercises, one file each, in the slides' order. A student writes the functions of
//! [`Subject`]; the stubs they start from are in `stubs/`.

mod e01_slab_test;
mod e02_median_split;
mod e03_sah_cost;
mod e04_ordered_walk;
mod e05_dda_step;
mod e06_kd_plane;
mod e07_brute_force;
mod e08_eight_boxes;
mod walk;

pub mod prelude;
pub mod reference;

use glam::{DVec3, IVec3};
use lancer_accel::{Cell, FourSlabs, Frame, Lattice, Sides};
use lancer_core::Rgb;
use lancer_core::geometry::{Bounds3, Interval, Ray};
use lancer_core::scene::PrimitiveId;
use lancer_exercise::Course;

pub use walk::Walk;

/// What is divided between the children of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Item {
    /// The centre of its box.
    pub center: DVec3,
    /// Which primitive it is.
    pub id: PrimitiveId,
}

/// t and the primitive that is met there.
pub type Met = (f64, PrimitiveId);

/// Tests a primitive: t, if the ray meets it.
pub type Test<'a> = dyn FnMut(PrimitiveId) -> Option<f64> + 'a;

/// A number for each of eight boxes.
pub type Lanes = [f32; 8];

/// A ray prepared for `f32` tests of boxes within [−1, 1]³: on an axis, a plane is at
/// `t = plane · inverse + offset`. A direction of ±0 counts as a tiny one of its sign, so no t is NaN.
#[derive(Clone, Copy, Debug)]
pub struct PreparedRay {
    /// 1 / direction: negative where the ray travels towards smaller coordinates.
    pub inverse: [f32; 3],
    /// For planes through which the ray enters a box: less, by all that rounding can add to t.
    pub near_offset: [f32; 3],
    /// For planes through which it leaves: more, by all that rounding can take from t.
    pub far_offset: [f32; 3],
}

impl PreparedRay {
    /// Prepares a ray whose origin is no farther than 4 from the boxes' centre: t stays the ray's own.
    fn new(ray: &Ray) -> Self {
        let frame = Frame::of(Bounds3 { min: DVec3::NEG_ONE, max: DVec3::ONE });
        let slabs = FourSlabs::new(ray, &frame);
        Self {
            inverse: slabs.inverse.to_array(),
            near_offset: slabs.near_offset.to_array(),
            far_offset: slabs.far_offset.to_array(),
        }
    }
}

/// The functions that a student writes, as pointers.
#[derive(Clone, Copy)]
pub struct Subject {
    /// Where a ray enters a box.
    pub slab_test: fn(&Bounds3, &Ray, Interval) -> Option<f64>,
    /// Sorts the lower half of some items to the front; returns how many that are.
    pub median_split: fn(&mut [Item]) -> usize,
    /// What a split costs: the node's box, the parts' boxes, the primitives in them.
    pub sah_cost: fn(&Bounds3, [&Bounds3; 2], [usize; 2]) -> f64,
    /// How many boxes of a row go to the left child, if a split pays.
    pub best_split: fn(&[Bounds3]) -> Option<usize>,
    /// Visits a node whose box the ray meets, and what is below.
    pub visit: fn(&mut Walk, usize),
    /// The cell that a ray in a cell enters next, and where.
    pub next_cell: fn(&Lattice, &Ray, IVec3) -> Option<(IVec3, f64)>,
    /// The sides of a plane that a part of a ray visits: plane, origin, direction, part.
    pub plane_sides: fn(f64, f64, f64, Interval) -> Sides,
    /// The closest hit in a ray's cells.
    pub search_cells: fn(&[Cell], &mut Test) -> Option<Met>,
    /// Where a ray enters eight boxes, and which of them it meets before a t, a bit for each.
    pub eight_boxes: fn(&[Lanes; 6], &PreparedRay, f32) -> (Lanes, u32),
    /// The lanes that are met, in the order in which they are entered.
    pub near_to_far: fn(&Lanes, u32) -> Vec<usize>,
}

/// The chapter's exercises.
pub static COURSE: Course<Subject> = Course {
    package: "chapter-4",
    exercises: &[
        e01_slab_test::EXERCISE,
        e02_median_split::EXERCISE,
        e03_sah_cost::EXERCISE,
        e04_ordered_walk::EXERCISE,
        e05_dda_step::EXERCISE,
        e06_kd_plane::EXERCISE,
        e07_brute_force::EXERCISE,
        e08_eight_boxes::EXERCISE,
    ],
    reference: reference::SUBJECT,
};

/// A colour for each number, neighbours unlike each other.
fn color_of(number: usize) -> Rgb {
    let part = |share: f64| 0.15 + 0.8 * (number as f64 * share).fract();
    Rgb::new(part(0.618), part(0.382), part(0.755))
}
