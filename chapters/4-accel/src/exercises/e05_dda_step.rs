//! E4.5: a step through the grid.

use glam::{DVec3, IVec3};
use lancer_accel::Lattice;
use lancer_core::Rgb;
use lancer_core::geometry::Ray;
use lancer_core::image::{Image, ImageSize};
use lancer_exercise::{Card, Check, Exercise, Shown, Solution, Verdict, slips, within};
use lancer_lesson::picture::painted;

use super::Subject;
use super::reference::next_cell;

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E4.5",
        name: "dda-step",
        title: "A step through the grid",
        slide: "Subdivision spatiale régulière et irrégulière",
        stub: include_str!("../../stubs/e05_dda_step.rs"),
        functions: &["next_cell"],
        minutes: 20,
        predict: "rays leave one corner region in a fan, and the cells that they visit are coloured by the step \
                  at which they are reached: how many steps does a diagonal take, compared with a ray along an \
                  axis?",
        vary: "take the axis of the *largest* direction component at each step, as when drawing a line of \
               pixels: which cells are left out, and what would hide in them?",
        hints: [
            "On each axis only one plane is ahead: the upper one of the cell, or the lower one if the direction \
             is negative. The ray leaves the cell through the plane that it meets first.",
            "t_k = (min_k + i · width_k − o_k) / d_k, where i is the cell's index, or one more for a positive \
             direction. A direction of 0 meets no plane: t_k = ∞, not a quotient.",
            "`let ahead = i32::from(d > 0.0); let t = if d == 0.0 { f64::INFINITY } else { (min + \
             f64::from(cell[k] + ahead) * width - o) / d };` and step by 1 or −1 along the axis of the smallest \
             t; outside 0 to `resolution[k] - 1` the answer is None.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e05_dda_step.rs"),
            file: "crates/accel/src/grid.rs",
            item: "fn look_ahead",
            notice: "each t is computed anew from the index: adding a constant at each step adds up its rounding",
        },
    },
    checks: &[
        Check { name: "forwards along each axis", run: forwards },
        Check { name: "backwards along each axis", run: backwards },
        Check { name: "a direction of 0", run: zero },
        Check { name: "out of the grid, at its upper ends", run: out_above },
        Check { name: "out of the grid, at index 0", run: out_below },
        Check { name: "two planes at once", run: tie },
        Check { name: "after a thousand cells", run: far },
        Check { name: "every step of the picture", run: fan_of_the_picture },
    ],
    slips: slips! {
        next_cell(lattice, ray, cell):
        "the plane ahead is always the upper one: a negative direction meets the lower one":
            "backwards along each axis" catches step(lattice, ray, cell, Rule { ahead: |_| 1, ..RIGHT });
        "the plane behind is taken: a positive direction meets the upper one, index i + 1":
            "forwards along each axis" catches
                step(lattice, ray, cell, Rule { ahead: |d| i32::from(d < 0.0), ..RIGHT });
        "the step always goes upwards: a negative direction leads to the smaller index":
            "backwards along each axis" catches step(lattice, ray, cell, Rule { sign: |_| 1, ..RIGHT });
        "the answer is the cell that is left, not the one that is entered":
            "forwards along each axis" catches next_cell(lattice, ray, cell).map(|(_, t)| (cell, t));
        "the grid's origin is left out: planes are at min + i · width":
            "forwards along each axis" catches
                next_cell(&Lattice { min: DVec3::ZERO, ..*lattice }, ray, cell);
        "the cells' width is left out: planes are at min + i · width":
            "forwards along each axis" catches
                next_cell(&Lattice { width: DVec3::ONE, ..*lattice }, ray, cell);
        "the distance of the plane is not divided by the direction: that is no t":
            "forwards along each axis" catches
                step(lattice, ray, cell, Rule { crossing: |way, d| crossing(way, d.signum()), ..RIGHT });
        "a direction of 0 is divided by: a ray in a plane gets 0 / 0, one outside it −∞ or ∞":
            "a direction of 0" catches
                step(lattice, ray, cell, Rule { crossing: |way, d| way / d, ..RIGHT });
        "the axis of the longest direction component is taken: cells between are left out":
            "forwards along each axis" catches {
                let axis = ray.direction.abs().max_position();
                let only = DVec3::AXES[axis] * ray.direction;
                next_cell(lattice, &Ray::new(ray.origin, only), cell)
            };
        "of two planes met at once the larger axis is taken: replace the best t only by a smaller one":
            "two planes at once" catches step(lattice, ray, cell, Rule { is_better: |t, best| t <= best, ..RIGHT });
        "where two planes are met at once the step goes along both axes: go along one, the other follows":
            "two planes at once" catches {
                let (mut next, t) = next_cell(lattice, ray, cell)?;
                let later = step(lattice, ray, cell, Rule { is_better: |t, best| t <= best, ..RIGHT })?.0;
                for axis in 0..3 {
                    if later[axis] != cell[axis] {
                        next[axis] = later[axis];
                    }
                }
                Some((next, t))
            };
        "the end of the grid is not looked for: an index must be from 0 to resolution − 1":
            "out of the grid, at its upper ends" catches within_more(lattice, ray, cell, [1, 1]);
        "an index equal to the resolution counts as inside: the last one is resolution − 1":
            "out of the grid, at its upper ends" catches within_more(lattice, ray, cell, [0, 1]);
        "the lower end of the grid is not looked for: −1 is no index":
            "out of the grid, at index 0" catches within_more(lattice, ray, cell, [1, 0]);
        "t is computed in `f32`: a thousand cells away it is off by more than its seventh digit. Keep to `f64`":
            "after a thousand cells" catches step_in_32_bits(lattice, ray, cell);
        "the answer is a length, t times that of the direction: t itself is wanted":
            "forwards along each axis" catches
                next_cell(lattice, ray, cell).map(|(cell, t)| (cell, t * ray.direction.length()));
    },
    own: |yours, reference| Subject { next_cell: yours.next_cell, ..reference },
    draw,
    explain: None,
};

fn crossing(way: f64, d: f64) -> f64 {
    if d == 0.0 { f64::INFINITY } else { way / d }
}

/// What a step is made of.
#[derive(Clone, Copy)]
struct Rule {
    /// By how much the index of the plane ahead exceeds the cell's.
    ahead: fn(f64) -> i32,
    /// The way to the next cell.
    sign: fn(f64) -> i32,
    /// When a plane is met, by its distance along the axis and the direction.
    crossing: fn(f64, f64) -> f64,
    /// Whether a t replaces the best one.
    is_better: fn(f64, f64) -> bool,
}

const RIGHT: Rule = Rule {
    ahead: |d| i32::from(d >= 0.0),
    sign: |d| if d < 0.0 { -1 } else { 1 },
    crossing,
    is_better: |t, best| t < best,
};

fn step(lattice: &Lattice, ray: &Ray, cell: IVec3, rule: Rule) -> Option<(IVec3, f64)> {
    let t = [0, 1, 2].map(|k| {
        let d = ray.direction[k];
        let plane = lattice.min[k] + f64::from(cell[k] + (rule.ahead)(d)) * lattice.width[k];
        (rule.crossing)(plane - ray.origin[k], d)
    });
    let axis = (1..3).fold(0, |best, k| if (rule.is_better)(t[k], t[best]) { k } else { best });
    let mut next = cell;
    next[axis] += (rule.sign)(ray.direction[axis]);
    (0..lattice.resolution[axis]).contains(&next[axis]).then_some((next, t[axis]))
}

fn step_in_32_bits(lattice: &Lattice, ray: &Ray, cell: IVec3) -> Option<(IVec3, f64)> {
    let t = [0, 1, 2].map(|k| {
        let [min, width, o, d] =
            [lattice.min, lattice.width, ray.origin, ray.direction].map(|v| v[k] as f32);
        let plane = min + (cell[k] + i32::from(d > 0.0)) as f32 * width;
        if d == 0.0 { f32::INFINITY } else { (plane - o) / d }
    });
    let axis = (1..3).fold(0, |best, k| if t[k] < t[best] { k } else { best });
    let mut next = cell;
    next[axis] += if ray.direction[axis] < 0.0 { -1 } else { 1 };
    (0..lattice.resolution[axis]).contains(&next[axis]).then_some((next, f64::from(t[axis])))
}

/// A right step in a grid with so many more cells below index 0 and above the last.
fn within_more(
    lattice: &Lattice,
    ray: &Ray,
    cell: IVec3,
    [below, above]: [i32; 2],
) -> Option<(IVec3, f64)> {
    let min = lattice.min - f64::from(below) * lattice.width;
    let more = Lattice { min, resolution: lattice.resolution + below + above, ..*lattice };
    next_cell(&more, ray, cell + below).map(|(cell, t)| (cell - below, t))
}

const GRID: Lattice = Lattice {
    min: DVec3::new(-3.0, 1.0, 2.0),
    width: DVec3::new(2.0, 0.5, 4.0),
    resolution: IVec3::new(4, 6, 5),
};

/// A cell as numbers that can be shown and compared.
fn numbers(answer: Option<(IVec3, f64)>) -> Option<(DVec3, f64)> {
    answer.map(|(cell, t)| (cell.as_dvec3(), t))
}

fn compare(
    subject: &Subject,
    lattice: &Lattice,
    ray: ([f64; 3], [f64; 3]),
    cell: [i32; 3],
    wanted: Option<([i32; 3], f64)>,
) -> Verdict {
    let (ray, cell) = (Ray::new(ray.0.into(), ray.1.into()), IVec3::from(cell));
    let got = (subject.next_cell)(lattice, &ray, cell);
    let wanted = wanted.map(|(cell, t)| (cell.into(), t));
    let case = || {
        format!(
            "grid from {}, cells of {}, {} of them; {}, in cell {cell}: the next cell and t",
            lattice.min.shown(),
            lattice.width.shown(),
            lattice.resolution,
            ray.shown()
        )
    };
    within(1e-12, case, &numbers(got), &numbers(wanted))
}

/// Cell (1, 2, 1) is from (−1, 2, 6) to (1, 2.5, 10).
const MIDDLE: [f64; 3] = [-0.5, 2.125, 7.0];

fn forwards(subject: &Subject) -> Verdict {
    let go = |direction, next, t| {
        compare(subject, &GRID, (MIDDLE, direction), [1, 2, 1], Some((next, t)))
    };
    // By the planes at x = 1, y = 2.5 and z = 10.
    go([2.0, 0.25, 3.0], [2, 2, 1], 0.75)?;
    go([0.5, 0.25, 0.5], [1, 3, 1], 1.5)?;
    go([0.5, 0.125, 4.0], [1, 2, 2], 0.75)
}

fn backwards(subject: &Subject) -> Verdict {
    let go = |direction, next, t| {
        compare(subject, &GRID, (MIDDLE, direction), [1, 2, 1], Some((next, t)))
    };
    // By the planes at x = −1, y = 2 and z = 6.
    go([-2.0, -0.25, -3.0], [0, 2, 1], 0.25)?;
    go([-0.25, -0.25, -0.5], [1, 1, 1], 0.5)?;
    go([0.5, -0.0625, -4.0], [1, 2, 0], 0.25)
}

fn zero(subject: &Subject) -> Verdict {
    for zero in [0.0, -0.0] {
        let wanted = Some(([1, 3, 1], 1.5));
        compare(subject, &GRID, (MIDDLE, [zero, 0.25, zero]), [1, 2, 1], wanted)?;
        // In the planes x = −1 and x = 1, between which the cell is.
        for x in [-1.0, 1.0] {
            let start = [x, 2.125, 7.0];
            compare(subject, &GRID, (start, [zero, 0.25, 0.5]), [1, 2, 1], wanted)?;
        }
    }
    Ok(())
}

fn out_above(subject: &Subject) -> Verdict {
    let last = [4.0, 3.75, 20.0];
    compare(subject, &GRID, (last, [1.0, 0.125, 0.5]), [3, 5, 4], None)?;
    compare(subject, &GRID, (last, [1.0, 0.5, 0.5]), [3, 5, 4], None)?;
    compare(subject, &GRID, (last, [0.25, 0.0625, 3.0]), [3, 5, 4], None)
}

fn out_below(subject: &Subject) -> Verdict {
    let first = [-2.0, 1.25, 4.0];
    compare(subject, &GRID, (first, [-1.0, 0.125, 0.5]), [0, 0, 0], None)?;
    compare(subject, &GRID, (first, [0.25, -0.5, -0.25]), [0, 0, 0], None)?;
    compare(subject, &GRID, (first, [0.25, 0.0625, -3.0]), [0, 0, 0], None)
}

/// y and z are met at t = 1, x at 1.5.
fn tie(subject: &Subject) -> Verdict {
    let wanted = Some(([1, 3, 1], 1.0));
    compare(subject, &GRID, (MIDDLE, [1.0, 0.375, 3.0]), [1, 2, 1], wanted)
}

/// Where t has been added up step by step in `f32`, or the plane is a cell off, this is another cell.
fn far(subject: &Subject) -> Verdict {
    let lattice = Lattice {
        min: DVec3::splat(-0.1),
        width: DVec3::splat(0.1),
        resolution: IVec3::splat(1024),
    };
    let ray = ([0.05, 0.05, 0.05], [0.3, 0.29, 0.01]);
    let wanted = (-0.1 + 1001.0 * 0.1 - 0.05) / 0.3;
    compare(subject, &lattice, ray, [1000, 968, 34], Some(([1001, 968, 34], wanted)))
}

const SIDE: i32 = 16;
const PIXELS: u32 = 192;
const PLAN: Lattice =
    Lattice { min: DVec3::ZERO, width: DVec3::ONE, resolution: IVec3::new(SIDE, SIDE, 1) };

/// A fan of rays in the plan, and one that comes back.
fn rays() -> Vec<Ray> {
    let fan = [0.05_f64, 0.45, 0.785, 1.3].map(|angle| {
        Ray::new(DVec3::new(0.6, 0.3, 0.5), DVec3::new(angle.cos(), angle.sin(), 0.0))
    });
    let back = Ray::new(DVec3::new(15.3, 9.7, 0.5), DVec3::new(-1.0, 0.55, 0.0));
    fan.into_iter().chain([back]).collect()
}

/// The cells that a ray visits, each with the t at which it is entered. A wrong step may come back for ever.
fn visited(subject: &Subject, ray: &Ray) -> Vec<(IVec3, f64)> {
    let first = Some((ray.origin.as_ivec3(), 0.0));
    let next = |&(cell, _): &(IVec3, f64)| (subject.next_cell)(&PLAN, ray, cell);
    std::iter::successors(first, next).take(3 * SIDE as usize).collect()
}

/// All cells of the plan in which the ray has a part, in the order of their parts: each is clipped by itself.
fn clipped(ray: &Ray) -> Vec<(IVec3, f64)> {
    let inside = |cell: IVec3| {
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for axis in 0..2 {
            let planes = [cell[axis], cell[axis] + 1].map(f64::from);
            let [a, b] = planes.map(|plane| (plane - ray.origin[axis]) / ray.direction[axis]);
            (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
        }
        (enter < leave).then_some((cell, enter))
    };
    let cells = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| IVec3::new(x, y, 0)));
    let mut cells: Vec<_> = cells.filter_map(inside).collect();
    cells.sort_by(|a, b| a.1.total_cmp(&b.1));
    cells
}

fn fan_of_the_picture(subject: &Subject) -> Verdict {
    rays().iter().try_for_each(|ray| {
        let (got, wanted) = (visited(subject, ray), clipped(ray));
        for step in 1..=wanted.len() {
            let [got, wanted] = [&got, &wanted].map(|cells| numbers(cells.get(step).copied()));
            let case = || format!("{SIDE} × {SIDE} cells of 1; {}: step {step}", ray.shown());
            within(1e-9, case, &got, &wanted)?;
        }
        Ok(())
    })
}

/// A fan of rays; the cells that they visit, the redder the later, and the rays on top.
fn draw(subject: &Subject) -> Image {
    let rays = rays();
    let mut steps = [[None; SIDE as usize]; SIDE as usize];
    for ray in &rays {
        for (count, (at, _)) in (0_i32..).zip(visited(subject, ray)) {
            let row = steps.get_mut(at.y as usize);
            let Some(place) = row.and_then(|row| row.get_mut(at.x as usize)) else { break };
            *place = place.or(Some(count));
        }
    }
    painted(ImageSize::new(PIXELS, PIXELS), |x, y| {
        let scale = f64::from(SIDE) / f64::from(PIXELS);
        let at = DVec3::new(scale * x, scale * (f64::from(PIXELS) - y), 0.5);
        let on_ray = rays.iter().any(|ray| {
            let (way, d) = (at - ray.origin, ray.direction.normalize());
            way.dot(d) > 0.0 && way.cross(d).length() < 0.06
        });
        if on_ray {
            return Rgb::ZERO;
        }
        let edge = (at.x.fract() - 0.5).abs().max((at.y.fract() - 0.5).abs()) > 0.46;
        match steps[at.y as usize][at.x as usize] {
            _ if edge => Rgb::splat(0.6),
            None => Rgb::ONE,
            Some(count) => {
                let part = f64::from(count) / f64::from(2 * SIDE);
                Rgb::new(0.3 + 0.7 * part.min(1.0), 0.75 - 0.6 * part.min(1.0), 0.3)
            }
        }
    })
}
