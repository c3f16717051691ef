//! E4.7 The same answer as brute force. Slide « Subdivision spatiale régulière et irrégulière ».

use chapter_4::exercises::prelude::*;

/// The closest hit of a ray among the primitives of the cells that it visits, as if all primitives of the
/// scene had been tested: the smallest t, and of several primitives there the smallest id.
///
/// - `cells: &[Cell]` (crates/accel/src/cells.rs): near ones first; the ray enters a cell at `cell.enter`, and
///   what reaches into the cell is in `cell.primitives`. A primitive may be in several cells, and may be met
///   outside the cell.
/// - `test(primitive)`: a function that is given; `Some(t)` at which the ray meets a primitive, or `None`.
/// - The answer, `Met`, is a pair (t, id); a `PrimitiveId` compares like a number.
///
/// No primitive is tested twice, and cells that the ray enters behind the closest hit are left out.
pub fn search_cells(cells: &[Cell], test: &mut Test) -> Option<Met> {
    todo!("E4.7: cell after cell, until none can be better")
}
