//! What the subdivisions of space share: the search through the cells that a ray visits.

use lancer_core::geometry::Bounds3;
use lancer_core::intersector::{Hit, Observer, Probe, Wanted};
use lancer_core::scene::PrimitiveId;

/// A cell of a spatial subdivision, visited by a ray.
#[derive(Clone, Copy, Debug)]
pub struct Cell<'i> {
    /// Where the cell is.
    pub bounds: Bounds3,
    /// The parameter at which the ray enters it, up to rounding.
    pub enter: f64,
    /// What comes near the cell.
    pub primitives: &'i [PrimitiveId],
}

/// Where a ray enters a cell, up to rounding, and what comes near the cell.
pub(crate) type CellEntry<'i> = (f64, &'i [PrimitiveId]);

/// The cells that a ray visits, near ones first.
pub(crate) trait RayCells<'i> {
    /// The next cell that the ray enters before `max`.
    fn next<O: Observer>(&mut self, max: f64, observer: &mut O) -> Option<CellEntry<'i>>;

    /// Where the cell is that came last, for who looks inside: a search does not ask.
    fn bounds(&self) -> Bounds3;
}

/// The cells up to `max`, whether or not the ray hits anything in them.
pub(crate) fn visited<'i>(
    mut cells: Option<impl RayCells<'i>>,
    max: f64,
) -> impl Iterator<Item = Cell<'i>> {
    std::iter::from_fn(move || {
        let cells = cells.as_mut()?;
        let (enter, primitives) = cells.next(max, &mut ())?;
        Some(Cell { bounds: cells.bounds(), enter, primitives })
    })
}

/// Tests the primitives of cell after cell until any hit will do or no cell can hold a better hit.
///
/// A primitive may be hit outside the cell in which it is found. Such a hit counts at once, since it is
/// no less a hit; but it ends the search only when the cells in front of it are done: [`RayCells::next`]
/// is asked for cells up to the closest hit so far.
#[inline]
pub(crate) fn search<'i, O: Observer>(
    mut cells: impl RayCells<'i>,
    mut probe: Probe,
    mailboxing: bool,
    wanted: Wanted,
    observer: &mut O,
) -> Option<Hit> {
    let mut mailbox = Mailbox::new();
    while let Some((_, primitives)) = cells.next(probe.range().max, observer) {
        for &primitive in primitives {
            if mailboxing && mailbox.replace(primitive) {
                continue;
            }
            observer.primitive_test(primitive);
            if probe.test(primitive) && wanted == Wanted::Any {
                return probe.best();
            }
        }
    }
    probe.best()
}

/// The primitives that a ray was tested against last: what lies in several cells need not be tested in
/// each of them.
///
/// The textbook's mailbox is a mark on the primitive, with the number of the ray that left it: shared
/// between threads, and wrong once that number wraps around. Here it belongs to the ray: a few places,
/// and one primitive pushes another out of its own. A primitive forgotten is tested again, in vain but
/// without harm. In a soup it spares a sixth of the tests, and hardly any time: most tests that fail
/// are short. Sources: Amanatides and Woo, *A Fast Voxel Traversal Algorithm for Ray Tracing*,
/// Eurographics 1987; the hashed form: Lagae and Dutré, *Compact, Fast and Robust Grids for Ray Tracing*,
/// Computer Graphics Forum 27(4), 2008.
struct Mailbox([PrimitiveId; 8]);

impl Mailbox {
    /// No scene has as many primitives as this number says.
    const NONE: PrimitiveId = PrimitiveId(u32::MAX);

    #[inline]
    fn new() -> Self {
        Self([Self::NONE; 8])
    }

    /// Puts the primitive into its place, and says whether it was there before.
    #[inline]
    fn replace(&mut self, primitive: PrimitiveId) -> bool {
        let place = &mut self.0[primitive.0 as usize % 8];
        std::mem::replace(place, primitive) == primitive
    }
}
