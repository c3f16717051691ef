//! The regular grid, and its walks by rays; those by beams are in [`beam`].

mod beam;

use glam::{DVec3, IVec3, UVec3};
use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};
use lancer_core::intersector::{BeamIndex, Hit, Observer, Probe, Query, Traversal};
use lancer_core::scene::{PrimitiveId, Scene, Subset};

use crate::cells::{Cell, CellEntry, RayCells, search, visited};
use crate::margins::{regular_slack, rounding};
use crate::touching::{Footprint, overlap, surface_points};

/// The slides' regular subdivision of space, « subdivision spatiale régulière »: a box around the scene
/// cut into equal cells, each with a list of what comes near it.
///
/// *Built* in O(n): every primitive is put into the cells that its surface touches, grown by more than
/// planes and rays can err. The number of cells is in proportion to the number of primitives, their
/// shape near a cube.
///
/// *Walked* by the three-dimensional digital differential analyser ([`Grid::cells`]): from cell to cell
/// through the plane that the ray meets next, O(∛n) cells for n evenly spread primitives, until the
/// closest hit is nearer than the next cell. A ray that starts so far away that its own rounding exceeds
/// what the primitives were grown by is walked slice by slice, with the neighbours that it might touch.
///
/// *Wins* where primitives of one size fill the space evenly, so that a ray soon hits one: a step costs
/// less than a node of a tree, the build next to nothing. *Loses* where there is much empty space, which
/// it crosses cell by cell, and in the « théière dans un stade » (teapot in a stadium): cells that suit
/// the large are full of the small.
///
/// *Sources:* Fujimoto, Tanaka, Iwata, *ARTS: Accelerated Ray-Tracing System*, IEEE CG&A 6(4), 1986;
/// Amanatides and Woo, *A Fast Voxel Traversal Algorithm for Ray Tracing*, Eurographics 1987.
#[doc(alias = "subdivision spatiale régulière")]
#[doc(alias = "grille régulière")]
#[doc(alias = "3D-DDA")]
pub struct Grid<'s> {
    scene: &'s Scene,
    bounds: Bounds3,
    slack: f64,
    lattice: Lattice,
    /// Compressed rows: the primitives of cell c are those from `first[c]` to `first[c + 1]`.
    first: Vec<u32>,
    primitives: Vec<PrimitiveId>,
    mailboxing: bool,
}

/// How a [`Grid`] is built and walked.
#[derive(Clone, Copy, Debug)]
pub struct GridBuilder {
    /// Cells per primitive: more of them cost steps and memory, fewer cost primitive tests.
    pub density: f64,
    /// Whether a ray remembers what it was tested against last. The answers are the same.
    pub mailboxing: bool,
}

impl Default for GridBuilder {
    fn default() -> Self {
        Self { density: 1.0, mailboxing: true }
    }
}

/// Cells per axis at most: a ray crosses no more than three times as many.
const MAX_RESOLUTION: f64 = 1024.0;

/// Cells in all at most: their rows take 1 GiB.
const MAX_CELLS: f64 = (1_u32 << 28) as f64;

/// Cells per primitive at most, on average, in the primitives' own boxes. If large primitives lie in
/// more, the cells are made larger: the lists would outgrow the memory.
const MAX_REFERENCES: f64 = 64.0;

impl GridBuilder {
    /// Builds the grid.
    pub fn build<'s>(self, primitives: impl Into<Subset<'s>>) -> Grid<'s> {
        let all = primitives.into();
        let (scene, bounds) = (all.scene(), all.bounds());
        let slack = regular_slack(bounds);
        let bounds = bounds.grown(slack);
        let boxes: Vec<Bounds3> =
            all.iter().map(|primitive| scene.primitive_bounds(primitive).grown(slack)).collect();
        let lattice = Lattice::suited(bounds, slack, &boxes, self.density);
        let touched = |place: usize| {
            let primitive = all.get(place);
            let range = lattice.range(boxes[place]);
            // Most primitives are small: what has one cell only need not be looked at closely.
            let footprint = (range[0] != range[1]).then(|| Footprint::new(scene, primitive, slack));
            let touches = move |cell: &IVec3| {
                footprint.as_ref().is_none_or(|surface| surface.touches(lattice.bounds(*cell)))
            };
            cells_between(range).filter(touches).map(move |cell| lattice.index(cell))
        };

        let mut first = vec![0; lattice.cells() + 1];
        for place in 0..all.len() {
            touched(place).for_each(|cell| first[cell] += 1);
        }
        let mut end = 0;
        for row in &mut first {
            end += *row;
            *row = end;
        }
        // Filled from the back, so that every row ends up in order, and begins where its first entry is.
        let mut primitives = vec![PrimitiveId(0); end as usize];
        for place in (0..all.len()).rev() {
            for cell in touched(place) {
                first[cell] -= 1;
                primitives[first[cell] as usize] = all.get(place);
            }
        }
        Grid { scene, bounds, slack, lattice, first, primitives, mailboxing: self.mailboxing }
    }
}

impl<'s> Grid<'s> {
    /// Builds the grid with the default parameters.
    pub fn build(primitives: impl Into<Subset<'s>>) -> Self {
        GridBuilder::default().build(primitives)
    }

    /// Bytes held by the index, without the scene it borrows.
    pub fn memory(&self) -> usize {
        size_of_val(self.first.as_slice()) + size_of_val(self.primitives.as_slice())
    }

    /// Cells along each axis.
    pub fn resolution(&self) -> UVec3 {
        self.lattice.resolution.as_uvec3()
    }

    /// The cells that a ray visits in `range`, near ones first, whether or not it hits anything in them.
    pub fn cells(&self, ray: &Ray, range: Interval) -> impl Iterator<Item = Cell<'_>> {
        visited(self.path(ray, range), range.max)
    }

    #[inline]
    fn path(&self, ray: &Ray, range: Interval) -> Option<Path<'_>> {
        let rounding = rounding(ray, self.bounds)?;
        if rounding > self.slack {
            let Bounds3 { min, max } = self.bounds.grown(rounding);
            Slabs::new(ray).enter(min, max, range)?;
            let cells = Box::new(self.slices(*ray, rounding));
            return Some(Path::Slices(Slices { cells, bounds: Bounds3::EMPTY }));
        }
        let enter = Slabs::new(ray).enter(self.bounds.min, self.bounds.max, range)?;
        Some(Path::Line(Line {
            grid: self,
            dda: Dda::new(self.lattice, ray, enter),
            at: IVec3::ZERO,
        }))
    }

    /// The cells that a ray might visit which errs by up to `rounding`: slice by slice along its longest
    /// component, in each slice all cells next to its way through.
    #[cold]
    fn slices(&self, ray: Ray, rounding: f64) -> impl Iterator<Item = Cell<'_>> {
        let axis = ray.direction.abs().max_position();
        let count = self.lattice.resolution[axis];
        let backwards = ray.direction[axis] < 0.0;
        (0..count).flat_map(move |step| {
            let slice = if backwards { count - 1 - step } else { step };
            let t =
                |plane| (self.lattice.plane(axis, plane) - ray.origin[axis]) / ray.direction[axis];
            let (enter, exit) = (t(slice + i32::from(backwards)), t(slice + i32::from(!backwards)));
            let way = Bounds3::of_points([ray.at(enter), ray.at(exit)]);
            // Once for the planes of the slice, and once for the ray beside them.
            let [mut low, mut high] = self.lattice.range(way.grown(2.0 * rounding));
            (low[axis], high[axis]) = (slice, slice);
            cells_between([low, high]).map(move |cell| Cell {
                bounds: self.lattice.bounds(cell),
                enter,
                primitives: self.row(cell),
            })
        })
    }

    /// What comes near a cell.
    #[inline(always)]
    fn row(&self, cell: IVec3) -> &[PrimitiveId] {
        let index = self.lattice.index(cell);
        &self.primitives[self.first[index] as usize..self.first[index + 1] as usize]
    }

    /// Checks that the rows are in order, that every one of these primitives lies in the cells of its
    /// corners, and that no cell holds what does not come near it.
    pub fn validate<'p>(&self, all: impl Into<Subset<'p>>) -> Result<(), String> {
        let Self { scene, lattice, first, primitives, .. } = self;
        if first.len() != lattice.cells() + 1 || first[0] != 0 || !first.is_sorted() {
            return Err("the rows are out of order".into());
        }
        if first[lattice.cells()] as usize != primitives.len() {
            return Err("the last row does not end with the list".into());
        }
        let everywhere = [IVec3::ZERO, lattice.resolution - 1];
        for at in cells_between(everywhere) {
            let (bounds, row) = (lattice.bounds(at), self.row(at));
            if !row.is_sorted_by(|a, b| a < b) {
                return Err(format!("cell {at} holds a primitive twice"));
            }
            let near = |&primitive: &PrimitiveId| {
                let reach = scene.primitive_bounds(primitive).grown(2.0 * self.slack);
                overlap(reach, bounds)
            };
            if !row.iter().all(near) {
                return Err(format!("cell {at} holds a primitive that lies elsewhere"));
            }
        }
        for primitive in all.into().iter() {
            for point in surface_points(scene, primitive) {
                let at = lattice.cell_of(point);
                if self.row(at).binary_search(&primitive).is_err() {
                    return Err(format!("{primitive:?} is missing from cell {at}"));
                }
            }
        }
        Ok(())
    }
}

impl Traversal for Grid<'_> {
    /// Visits the primitives of cell after cell along the ray, until any hit will do or the closest is
    /// nearer than the next cell.
    #[inline]
    fn walk<O: Observer>(&self, query: Query<&Ray>, observer: &mut O) -> Option<Hit> {
        let Query { ray, range, wanted } = query;
        let probe = Probe::new(self.scene, ray, range);
        match self.path(ray, range)? {
            Path::Line(line) => search(line, probe, self.mailboxing, wanted, observer),
            Path::Slices(slices) => search(slices, probe, self.mailboxing, wanted, observer),
        }
    }

    fn beams(&self) -> Option<&dyn BeamIndex> {
        Some(self)
    }
}

/// How a ray finds its cells.
enum Path<'g> {
    Line(Line<'g>),
    Slices(Slices<'g>),
}

impl<'g> RayCells<'g> for Path<'g> {
    fn next<O: Observer>(&mut self, max: f64, observer: &mut O) -> Option<CellEntry<'g>> {
        match self {
            Self::Line(line) => line.next(max, observer),
            Self::Slices(slices) => slices.next(max, observer),
        }
    }

    fn bounds(&self) -> Bounds3 {
        match self {
            Self::Line(line) => line.bounds(),
            Self::Slices(slices) => slices.bounds(),
        }
    }
}

/// The cells along the ray's line.
struct Line<'g> {
    grid: &'g Grid<'g>,
    dda: Dda,
    /// The cell that came last.
    at: IVec3,
}

impl<'g> RayCells<'g> for Line<'g> {
    #[inline(always)]
    fn next<O: Observer>(&mut self, max: f64, observer: &mut O) -> Option<CellEntry<'g>> {
        let enter = self.dda.enter;
        if enter * Slabs::NEAR > max {
            return None;
        }
        let cell = self.dda.next()?;
        self.at = cell;
        observer.region(&|| self.grid.lattice.bounds(cell));
        observer.cell_visit();
        Some((enter, self.grid.row(cell)))
    }

    fn bounds(&self) -> Bounds3 {
        self.grid.lattice.bounds(self.at)
    }
}

/// The cells that a ray from far away might visit.
struct Slices<'g> {
    cells: Box<dyn Iterator<Item = Cell<'g>> + 'g>,
    /// The box of the cell that came last.
    bounds: Bounds3,
}

impl<'g> RayCells<'g> for Slices<'g> {
    fn next<O: Observer>(&mut self, max: f64, observer: &mut O) -> Option<CellEntry<'g>> {
        let Cell { bounds, enter, primitives } =
            self.cells.next().filter(|cell| cell.enter * Slabs::NEAR <= max)?;
        self.bounds = bounds;
        observer.region(&|| bounds);
        observer.cell_visit();
        Some((enter, primitives))
    }

    fn bounds(&self) -> Bounds3 {
        self.bounds
    }
}

/// The planes between the cells: plane i of an axis is at min + i · width.
#[derive(Clone, Copy, Debug)]
pub struct Lattice {
    /// The lower corner of cell (0, 0, 0).
    pub min: DVec3,
    /// The size of a cell.
    pub width: DVec3,
    /// Cells along each axis.
    pub resolution: IVec3,
}

impl Lattice {
    /// A lattice of about `density` cells per box, fewer if the boxes would lie in too many of them.
    fn suited(bounds: Bounds3, slack: f64, boxes: &[Bounds3], density: f64) -> Self {
        let mut cells = (density * boxes.len() as f64).min(MAX_CELLS);
        loop {
            let lattice = Self::of(bounds, slack, cells);
            let in_cells = |&bounds: &Bounds3| {
                let [low, high] = lattice.range(bounds);
                (high - low + 1).as_dvec3().element_product()
            };
            let references: f64 = boxes.iter().map(in_cells).sum();
            if references <= MAX_REFERENCES * boxes.len() as f64 {
                return lattice;
            }
            cells *= 0.5;
        }
    }

    /// A lattice of about `cells` cells, near cubes. An axis along which the scene is shorter than a cube
    /// gets one cell and takes no part in the division. No cell is so small that the slack matters.
    fn of(bounds: Bounds3, slack: f64, cells: f64) -> Self {
        let extent = bounds.max - bounds.min;
        let largest = extent.max_element();
        let mut sorted = (extent / largest).to_array();
        sorted.sort_by(|a, b| b.total_cmp(a));
        let side =
            |axes: usize| (sorted[..axes].iter().product::<f64>() / cells).powf(1.0 / axes as f64);
        let axes = (2..=3).rev().find(|&axes| side(axes) < sorted[axes - 1]).unwrap_or(1);
        let most = (extent / (16.0 * slack)).min(DVec3::splat(MAX_RESOLUTION));
        let resolution = if largest > 0.0 {
            (extent / (side(axes) * largest)).min(most).round().max(DVec3::ONE)
        } else {
            DVec3::ONE
        };
        Self { min: bounds.min, width: extent / resolution, resolution: resolution.as_ivec3() }
    }

    /// One step of the 3D-DDA: the cell that a ray in `cell` enters next, and at which parameter; none if it
    /// leaves the lattice.
    pub fn step(self, ray: &Ray, cell: IVec3) -> Option<(IVec3, f64)> {
        let mut dda = Dda::from_cell(self, ray, cell, f64::NAN);
        dda.next();
        let enter = dda.enter;
        dda.next().map(|next| (next, enter))
    }

    fn cells(&self) -> usize {
        self.resolution.as_u64vec3().element_product() as usize
    }

    #[inline]
    fn plane(&self, axis: usize, index: i32) -> f64 {
        self.min[axis] + f64::from(index) * self.width[axis]
    }

    /// The cell of a point, or the one next to it if the point is outside: one on the upper face of the
    /// last cell belongs to that.
    #[inline]
    fn cell_of(&self, point: DVec3) -> IVec3 {
        ((point - self.min) / self.width).as_ivec3().clamp(IVec3::ZERO, self.resolution - 1)
    }

    /// The first and the last cell of a box.
    fn range(&self, bounds: Bounds3) -> [IVec3; 2] {
        [self.cell_of(bounds.min), self.cell_of(bounds.max)]
    }

    #[inline]
    fn index(&self, cell: IVec3) -> usize {
        let [x, y, z] = cell.to_array().map(|index| index as usize);
        let [nx, ny, _] = self.resolution.to_array().map(|count| count as usize);
        (z * ny + y) * nx + x
    }

    #[inline]
    fn bounds(&self, cell: IVec3) -> Bounds3 {
        let corner = |cell: IVec3| self.min + cell.as_dvec3() * self.width;
        Bounds3 { min: corner(cell), max: corner(cell + 1) }
    }
}

/// All cells from one to another, in rows.
fn cells_between([low, high]: [IVec3; 2]) -> impl Iterator<Item = IVec3> {
    (low.z..=high.z).flat_map(move |z| {
        (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| IVec3::new(x, y, z)))
    })
}

/// The three-dimensional digital differential analyser: the cells of a lattice along a ray.
///
/// ```text
/// 3D-DDA               t_k = (plane(i_k) − o_k) / d_k      for the plane ahead on each axis k
///                     step along the axis of the smallest t_k
/// ```
///
/// The original adds a constant to t_k at each step, and its rounding adds up: in `f32` it skips cells.
/// Here each t_k is computed anew.
#[doc(alias = "3D-DDA")]
struct Dda {
    /// The parameter at which the ray enters the next cell to be returned.
    enter: f64,
    axes: [Axis; 3],
    inside: bool,
}

/// A ray between the planes of one axis.
#[derive(Clone, Copy)]
struct Axis {
    min: f64,
    width: f64,
    origin: f64,
    direction: f64,
    /// The parameter at which the ray meets the plane ahead: never, if it runs along it.
    crossing: f64,
    cell: i32,
    /// What a step adds to the cell, and the last cell.
    step: i32,
    last: i32,
    /// What leads from a cell's number to that of the plane ahead.
    ahead: i32,
}

impl Dda {
    /// The walk of a ray that enters the lattice, or starts in it, at `enter`.
    #[inline]
    fn new(lattice: Lattice, ray: &Ray, enter: f64) -> Self {
        Self::from_cell(lattice, ray, lattice.cell_of(ray.at(enter)), enter)
    }

    #[inline]
    fn from_cell(lattice: Lattice, ray: &Ray, start: IVec3, enter: f64) -> Self {
        let axes = [0, 1, 2].map(|k| {
            let (min, width) = (lattice.min[k], lattice.width[k]);
            let (origin, direction, cell) = (ray.origin[k], ray.direction[k], start[k]);
            let (step, last, ahead) =
                if direction < 0.0 { (-1, 0, 0) } else { (1, lattice.resolution[k] - 1, 1) };
            let crossing = f64::INFINITY;
            let mut axis =
                Axis { min, width, origin, direction, crossing, cell, step, last, ahead };
            axis.look_ahead();
            axis
        });
        Self { enter, axes, inside: true }
    }
}

impl Axis {
    /// Finds where the ray meets the plane ahead.
    #[inline]
    fn look_ahead(&mut self) {
        // 0 and −0 meet no plane: the quotient would be NaN for a ray that runs in one.
        if self.direction != 0.0 {
            let plane = self.min + f64::from(self.cell + self.ahead) * self.width;
            self.crossing = (plane - self.origin) / self.direction;
        }
    }
}

impl Iterator for Dda {
    type Item = IVec3;

    #[inline(always)]
    fn next(&mut self) -> Option<IVec3> {
        if !self.inside {
            return None;
        }
        let [x, y, z] = &self.axes;
        let cell = IVec3::new(x.cell, y.cell, z.cell);
        let of_two = usize::from(y.crossing < x.crossing);
        let nearest = if z.crossing < self.axes[of_two].crossing { 2 } else { of_two };
        let axis = &mut self.axes[nearest];
        self.enter = axis.crossing;
        self.inside = axis.cell != axis.last;
        axis.cell += axis.step;
        axis.look_ahead();
        Some(cell)
    }
}

#[cfg(test)]
mod tests;
