//! E4.7 The same answer as brute force. Slide « Subdivision spatiale régulière et irrégulière ».

use chapter_4::exercises::prelude::*;

/// The closest hit of a ray among the primitives of the cells that it visits.
pub fn search_cells(cells: &[Cell], test: &mut Test) -> Option<Met> {
    let mut best: Option<Met> = None;
    let mut tested = Vec::new();
    for cell in cells {
        if best.is_some_and(|(t, _)| cell.enter > t) {
            break;
        }
        for &primitive in cell.primitives {
            if tested.contains(&primitive) {
                continue;
            }
            tested.push(primitive);
            let Some(t) = test(primitive) else { continue };
            // Pairs are compared by their first numbers, and where these are equal by the second.
            if best.is_none_or(|best| (t, primitive) < best) {
                best = Some((t, primitive));
            }
        }
    }
    best
}
