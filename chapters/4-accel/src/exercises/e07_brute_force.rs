//! E4.7: the same answer as brute force.

use glam::{DAffine3, DVec3};
use lancer_accel::{Cell, Grid};
use lancer_core::Rgb;
use lancer_core::geometry::{Bounds3, Interval, Shear, intersect_triangle};
use lancer_core::image::{Image, ImageSize};
use lancer_core::scene::{PrimitiveId, Scene};
use lancer_exercise::{Card, Check, Exercise, Mismatch, Solution, Verdict, ensure, slips};
use lancer_lesson::picture::painted;

use super::reference::search_cells;
use super::{Met, Subject, Test, color_of};
use crate::scenes;

pub const EXERCISE: Exercise<Subject> = Exercise {
    card: Card {
        id: "E4.7",
        name: "brute-force",
        title: "The same answer as brute force",
        slide: "Subdivision spatiale régulière et irrégulière",
        stub: include_str!("../../stubs/e07_brute_force.rs"),
        functions: &["search_cells"],
        minutes: 20,
        predict: "every triangle of the picture is there twice, in the same place, and its colour is that of the \
                  one that is hit: how many colours do you see on one triangle if ties are left to chance?",
        vary: "stop at the first cell in which anything is hit, and draw again: which triangles go wrong, the \
               small or the large?",
        hints: [
            "A primitive reaches into several cells, so a hit may lie far behind the cell in which the primitive \
             was found. Such a hit counts, but other cells come first.",
            "Keep the least pair (t, id). Stop when the next cell is entered behind the closest hit, \
             cell.enter > t; a cell entered just at t may hold the smaller id.",
            "`if best.is_some_and(|(t, _)| cell.enter > t) { break; }`, then for each primitive not yet in \
             `tested`: `let Some(t) = test(primitive) else { continue };` and keep `(t, primitive)` if it is less \
             than `best`; pairs compare by t first.",
        ],
        solution: Solution {
            answer: include_str!("../../solutions/e07_brute_force.rs"),
            file: "crates/accel/src/cells.rs",
            item: "pub(crate) fn search",
            notice: "the mailbox has eight places only, which is as good as a list and costs nothing to search; \
                     the tie rule stands once for all indexes, in `Probe::test`",
        },
    },
    checks: &[
        Check { name: "one cell, the closest of three", run: one_cell },
        Check { name: "nothing is hit", run: nothing },
        Check { name: "a hit outside the cell", run: outside },
        Check { name: "a tie in one cell", run: tie },
        Check { name: "a tie across two cells", run: tie_across },
        Check { name: "cells behind the hit", run: behind },
        Check { name: "no primitive twice", run: mailbox },
    ],
    slips: slips! {
        search_cells(cells, test):
        "the search ends in the first cell with a hit: the hit may lie behind the cell, and others in front of it":
            "a hit outside the cell" catches
                cells.chunks(1).find_map(|cell| search_cells(cell, test));
        "a hit outside the cell is thrown away; but the primitive is not tested again later":
            "a hit outside the cell" catches search_cells(cells, &mut |primitive| {
                let first = cells.iter().position(|cell| cell.primitives.contains(&primitive))?;
                let end = cells.get(first + 1).map_or(f64::INFINITY, |next| next.enter);
                test(primitive).filter(|t| *t <= end)
            });
        "of a tie the first one found wins: it must be the smaller id, or the answer depends on the index":
            "a tie in one cell" catches keep(cells, test, |(t, _), (best, _)| t < best);
        "of a tie the last one found wins":
            "a tie in one cell" catches keep(cells, test, |(t, _), (best, _)| t <= best);
        "a cell that is entered just at the closest hit is left out: it may hold the smaller id":
            "a tie across two cells" catches {
                let mut best: Option<Met> = None;
                for (k, cell) in cells.iter().enumerate() {
                    if best.is_some_and(|(t, _)| cell.enter >= t) {
                        break;
                    }
                    best = search_cells(&cells[..=k], test);
                }
                best
            };
        "all cells are searched: stop when the next is entered behind the closest hit":
            "cells behind the hit" catches {
                let all = cells.iter().map(|cell| Cell { enter: 0.0, ..*cell });
                search_cells(&all.collect::<Vec<_>>(), test)
            };
        "a primitive in several cells is tested in each: remember what was tested (a mailbox)":
            "no primitive twice" catches keep(cells, test, |met, best| met < best);
        "the first hit of a cell is taken, not the closest":
            "one cell, the closest of three" catches {
                let mut all = cells.iter().flat_map(|cell| cell.primitives);
                all.find_map(|&primitive| test(primitive).map(|t| (t, primitive)))
            };
    },
    draw,
    explain: None,
};

/// A search that tests whatever a cell holds, with another rule for which hit wins.
fn keep(cells: &[Cell], test: &mut Test, wins: impl Fn(Met, Met) -> bool) -> Option<Met> {
    let mut best: Option<Met> = None;
    for cell in cells {
        if best.is_some_and(|(t, _)| cell.enter > t) {
            break;
        }
        for &primitive in cell.primitives {
            let Some(t) = test(primitive) else { continue };
            if best.is_none_or(|best| wins((t, primitive), best)) {
                best = Some((t, primitive));
            }
        }
    }
    best
}

/// Searches cells, each entered at a t and with some primitives, where primitive k is met at `met[k]`, and
/// compares the answer and the primitives that are tested, in any order.
fn compare(
    subject: &Subject,
    cells: &[(f64, &[u32])],
    met: &[Option<f64>],
    wanted: Option<(f64, u32)>,
    wanted_tests: Option<&[u32]>,
) -> Verdict {
    let lists: Vec<Vec<PrimitiveId>> =
        cells.iter().map(|(_, ids)| ids.iter().map(|&id| PrimitiveId(id)).collect()).collect();
    let given: Vec<Cell> = cells
        .iter()
        .zip(&lists)
        .map(|(&(enter, _), list)| Cell { bounds: Bounds3::EMPTY, enter, primitives: list })
        .collect();
    let mut tested = Vec::new();
    let got = (subject.search_cells)(&given, &mut |primitive| {
        tested.push(primitive.0);
        met[primitive.0 as usize]
    });
    let got = got.map(|(t, primitive)| (t, primitive.0));
    let cells = cells.iter().map(|(enter, ids)| format!("entered at {enter}: {ids:?}"));
    let hits = met.iter().enumerate().map(|(id, t)| match t {
        Some(t) => format!("{id} is met at {t}"),
        None => format!("{id} is missed"),
    });
    let [cells, hits] = [cells.collect::<Vec<_>>(), hits.collect()].map(|list| list.join(", "));
    let case = format!("cells {cells}; {hits}");
    ensure(got == wanted, || Mismatch::new(&case, format!("{got:?}"), format!("{wanted:?}")))?;
    tested.sort_unstable();
    wanted_tests.map_or(Ok(()), |wanted| {
        let [got, wanted] = [&*tested, wanted].map(|ids| format!("tests of {ids:?}"));
        ensure(got == wanted, || Mismatch::new(case, got, wanted))
    })
}

fn one_cell(subject: &Subject) -> Verdict {
    let met = [Some(3.5), Some(1.5), None, Some(2.5)];
    compare(subject, &[(1.0, &[0, 2, 3, 1])], &met, Some((1.5, 1)), None)
}

fn nothing(subject: &Subject) -> Verdict {
    compare(subject, &[], &[], None, Some(&[]))?;
    compare(subject, &[(1.0, &[0]), (2.0, &[]), (3.0, &[1])], &[None, None], None, Some(&[0, 1]))
}

/// Primitive 0 reaches into the first cell, and is met in the third, behind primitive 1, or in front of
/// nothing at all.
fn outside(subject: &Subject) -> Verdict {
    let cells: [(f64, &[u32]); 3] = [(1.0, &[0]), (2.0, &[1]), (3.0, &[0])];
    compare(subject, &cells, &[Some(3.5), Some(2.5)], Some((2.5, 1)), None)?;
    compare(subject, &cells, &[Some(3.5), None], Some((3.5, 0)), None)
}

fn tie(subject: &Subject) -> Verdict {
    let met = [None, Some(1.5), Some(1.5), Some(1.5)];
    compare(subject, &[(1.0, &[2, 1, 3])], &met, Some((1.5, 1)), None)?;
    compare(subject, &[(1.0, &[1, 3, 2])], &met, Some((1.5, 1)), None)
}

/// Both are met just where the second cell begins.
fn tie_across(subject: &Subject) -> Verdict {
    let met = [Some(2.0), Some(2.0)];
    compare(subject, &[(1.0, &[1]), (2.0, &[0])], &met, Some((2.0, 0)), None)
}

fn behind(subject: &Subject) -> Verdict {
    let met = [Some(1.5), Some(2.5), Some(3.5)];
    let cells: [(f64, &[u32]); 3] = [(1.0, &[0]), (2.0, &[1]), (3.0, &[2])];
    compare(subject, &cells, &met, Some((1.5, 0)), Some(&[0]))
}

fn mailbox(subject: &Subject) -> Verdict {
    let met = [None, None, Some(3.5)];
    let cells: [(f64, &[u32]); 4] =
        [(1.0, &[0, 1]), (2.0, &[1, 0]), (3.0, &[1, 2]), (3.25, &[0, 2])];
    compare(subject, &cells, &met, Some((3.5, 2)), Some(&[0, 1, 2]))
}

/// A town whose faces are all there twice, in the colours of the triangles that are hit.
fn draw(subject: &Subject) -> Image {
    let mut scene = scenes::family("town").scene(300);
    let single = Scene::of_mesh(scene.mesh.clone());
    scene.mesh.append(&single.mesh, DAffine3::IDENTITY, 0);
    let grid = Grid::build(&scene);
    let size = ImageSize::new(160, 120);
    let rays = scene.camera.primary_rays(size);
    painted(size, |x, y| {
        let ray = rays.through(x, y);
        let shear = Shear::new(ray.direction);
        let cells: Vec<Cell> = grid.cells(&ray, Interval::POSITIVE).collect();
        let mut test = |primitive: PrimitiveId| {
            let corners: [DVec3; 3] = scene.mesh.corners(primitive.0 as usize);
            intersect_triangle(corners, &ray, &shear).map(|hit| hit.t)
        };
        let met = (subject.search_cells)(&cells, &mut test);
        met.map_or(Rgb::splat(0.02), |(_, primitive)| color_of(primitive.0 as usize))
    })
}
