//! E4.7: the same answer as brute force.

use glam::{DAffine3, DVec3};
use lancer_accel::{Bvh, Cell, Grid};
use lancer_core::Rgb;
use lancer_core::geometry::{Bounds3, Interval, Ray, Shear, intersect_triangle};
use lancer_core::image::{Image, ImageSize};
use lancer_core::intersector::Intersector;
use lancer_core::scene::{PrimaryRays, PrimitiveId, Scene};
use lancer_exercise::{
    Card, Check, Exercise, Mismatch, Shown, Solution, Verdict, ensure, same, slips,
};
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
        Check { name: "almost a tie", run: almost },
        Check { name: "cells behind the hit", run: behind },
        Check { name: "no primitive twice", run: mailbox },
        Check { name: "every ray of the picture", run: town },
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
            "a tie in one cell" catches keep(cells, test, Memory::Tested, |(t, _), (best, _)| t < best);
        "of a tie the last one found wins":
            "a tie in one cell" catches keep(cells, test, Memory::Tested, |(t, _), (best, _)| t <= best);
        "hits that differ by little count as a tie: only equal t are one":
            "almost a tie" catches keep(cells, test, Memory::Tested, |(t, id), (best, best_id)| {
                if (t - best).abs() < 1e-6 { id < best_id } else { t < best }
            });
        "the hits are compared in `f32`, which makes ties where there are none: keep to `f64`":
            "almost a tie" catches keep(cells, test, Memory::Tested, |(t, id), (best, best_id)| {
                (t as f32, id) < (best as f32, best_id)
            });
        "the smallest id wins, however far away: compare t first, and the ids of equal t":
            "one cell, the closest of three" catches
                keep(cells, test, Memory::Tested, |(_, id), (_, best)| id < best);
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
            "no primitive twice" catches keep(cells, test, Memory::Nothing, |met, best| met < best);
        "only the primitive tested last is remembered: the next cell may hold others that were tested":
            "no primitive twice" catches keep(cells, test, Memory::Last, |met, best| met < best);
        "only hits are remembered: a primitive that was missed is missed again in the next cell, at the same cost":
            "no primitive twice" catches keep(cells, test, Memory::Hits, |met, best| met < best);
        "the first hit of a cell is taken, not the closest":
            "one cell, the closest of three" catches {
                let mut all = cells.iter().flat_map(|cell| cell.primitives);
                all.find_map(|&primitive| test(primitive).map(|t| (t, primitive)))
            };
    },
    own: |yours, reference| Subject { search_cells: yours.search_cells, ..reference },
    draw,
    explain: None,
};

/// Which primitives are not tested again.
#[derive(Clone, Copy, PartialEq)]
enum Memory {
    Tested,
    Hits,
    Last,
    Nothing,
}

/// A search with another memory, or another rule for which hit wins.
fn keep(
    cells: &[Cell],
    test: &mut Test,
    memory: Memory,
    wins: impl Fn(Met, Met) -> bool,
) -> Option<Met> {
    let (mut best, mut known): (Option<Met>, Vec<PrimitiveId>) = (None, Vec::new());
    for cell in cells {
        if best.is_some_and(|(t, _)| cell.enter > t) {
            break;
        }
        for &primitive in cell.primitives {
            if known.contains(&primitive) {
                continue;
            }
            let t = test(primitive);
            if memory == Memory::Last {
                known.clear();
            }
            if memory != Memory::Nothing && (memory != Memory::Hits || t.is_some()) {
                known.push(primitive);
            }
            let Some(t) = t else { continue };
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

/// Primitive 1 is closer by less than `f32` can tell.
fn almost(subject: &Subject) -> Verdict {
    for gap in [10, 30, 40].map(|bits| 2.0_f64.powi(-bits)) {
        let met = [Some(1.5 + gap), Some(1.5)];
        compare(subject, &[(1.0, &[0, 1])], &met, Some((1.5, 1)), None)?;
        compare(subject, &[(1.0, &[1, 0])], &met, Some((1.5, 1)), None)?;
    }
    Ok(())
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

/// A town whose faces are all there twice, and the rays of the picture.
struct Town {
    scene: Scene,
    rays: PrimaryRays,
}

impl Town {
    const SIZE: ImageSize = ImageSize::new(160, 120);

    fn new() -> Self {
        let mut scene = scenes::family("town").scene(300);
        let single = Scene::of_mesh(scene.mesh.clone());
        scene.mesh.append(&single.mesh, DAffine3::IDENTITY, 0);
        let rays = scene.camera.primary_rays(Self::SIZE);
        Self { scene, rays }
    }

    /// What the subject finds in the cells of a grid.
    fn search(&self, subject: &Subject, grid: &Grid, ray: &Ray) -> Option<Met> {
        let shear = Shear::new(ray.direction);
        let cells: Vec<Cell> = grid.cells(ray, Interval::POSITIVE).collect();
        let mut test = |primitive: PrimitiveId| {
            let corners: [DVec3; 3] = self.scene.mesh.corners(primitive.0 as usize);
            intersect_triangle(corners, ray, &shear).map(|hit| hit.t)
        };
        (subject.search_cells)(&cells, &mut test)
    }
}

/// A hierarchy finds the same: it has no cells.
fn town(subject: &Subject) -> Verdict {
    let town = Town::new();
    let (grid, tree) = (Grid::build(&town.scene), Bvh::build(&town.scene));
    let ImageSize { width, height, .. } = Town::SIZE;
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let ray = town.rays.through(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let got = town.search(subject, &grid, &ray).map(|(t, id)| (t, id.0));
        let wanted = tree.closest_hit(&ray, Interval::POSITIVE);
        let wanted = wanted.map(|hit| (hit.t, hit.primitive.0));
        let case =
            || format!("the picture's town, pixel {x} of row {y}; {}: t and id", ray.shown());
        same(case, &got, &wanted)?;
    }
    Ok(())
}

/// The town in the colours of the triangles that are hit.
fn draw(subject: &Subject) -> Image {
    let town = Town::new();
    let grid = Grid::build(&town.scene);
    painted(Town::SIZE, |x, y| {
        let met = town.search(subject, &grid, &town.rays.through(x, y));
        met.map_or(Rgb::splat(0.02), |(_, primitive)| color_of(primitive.0 as usize))
    })
}
