//! What a search through an index does, written down.

use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};
use lancer_core::intersector::{Hit, Observer, Probe, TestCounts};
use lancer_core::scene::{PrimitiveId, Scene};

/// Something that a search does.
pub struct Event {
    /// What it is.
    pub kind: Kind,
    /// The closest hit after it.
    pub best: Option<Hit>,
}

/// What a search can do. Boxes and cells are counted from 1 in the order of the search.
pub enum Kind {
    /// A box is tested that the ray meets before the closest hit: where it is, and the ray's piece in it.
    BoxMet {
        /// Which one.
        number: u64,
        /// Where it is.
        bounds: Bounds3,
        /// The ray's piece in it.
        inside: Interval,
    },
    /// Boxes are tested one after the other, and none of them is met before the closest hit.
    BoxesMissed {
        /// The first of them.
        first: u64,
        /// Where they are.
        boxes: Vec<Bounds3>,
        /// How many are met behind the closest hit.
        behind: usize,
        /// How many have nothing in them: places of a node without a child.
        empty: usize,
    },
    /// A cell is visited.
    Cell {
        /// Which one.
        number: u64,
        /// Where it is; if it is no box, around the ray's piece in it.
        bounds: Bounds3,
        /// The ray's piece in it; none where it only comes near.
        inside: Option<Interval>,
    },
    /// A primitive is tested and met.
    PrimitiveMet {
        /// Which one.
        primitive: PrimitiveId,
        /// Where.
        t: f64,
        /// Whether it is the closest so far.
        wins: bool,
    },
    /// Primitives are tested one after the other, and none is met.
    PrimitivesMissed(Vec<PrimitiveId>),
}

/// Writes down a search for the closest hit, and decides each test once more to tell how it ends.
pub struct Recorder<'s> {
    /// What happened.
    pub events: Vec<Event>,
    /// How much of it.
    pub counts: TestCounts,
    scene: &'s Scene,
    ray: &'s Ray,
    range: Interval,
    slabs: Slabs,
    probe: Probe<'s>,
    region: Bounds3,
}

impl<'s> Recorder<'s> {
    /// Nothing has happened yet.
    pub fn new(scene: &'s Scene, ray: &'s Ray, range: Interval) -> Self {
        Self {
            events: Vec::new(),
            counts: TestCounts::default(),
            scene,
            ray,
            range,
            slabs: Slabs::new(ray),
            probe: Probe::new(scene, ray, range),
            region: Bounds3::EMPTY,
        }
    }

    fn push(&mut self, kind: Kind) {
        self.events.push(Event { kind, best: self.probe.best() });
    }

    /// The ray's piece in the region told last, of what is in `range`.
    fn inside(&self, range: Interval) -> Option<Interval> {
        let Bounds3 { min, max } = self.region;
        self.slabs.cross(min, max, range).filter(|_| !self.region.is_empty())
    }
}

impl Observer for Recorder<'_> {
    fn box_test(&mut self) {
        self.counts.box_test();
        let (number, bounds) = (self.counts.boxes, self.region);
        if let Some(inside) = self.inside(self.probe.range()) {
            return self.push(Kind::BoxMet { number, bounds, inside });
        }
        let is_empty = bounds.is_empty();
        let is_behind = self.inside(self.range).is_some();
        if !matches!(self.events.last(), Some(Event { kind: Kind::BoxesMissed { .. }, .. })) {
            let missed =
                Kind::BoxesMissed { first: number, boxes: Vec::new(), behind: 0, empty: 0 };
            self.push(missed);
        }
        if let Some(Event { kind: Kind::BoxesMissed { boxes, behind, empty, .. }, .. }) =
            self.events.last_mut()
        {
            boxes.push(bounds);
            *behind += usize::from(is_behind);
            *empty += usize::from(is_empty);
        }
    }

    fn cell_visit(&mut self) {
        self.counts.cell_visit();
        let inside = self.inside(self.range);
        self.push(Kind::Cell { number: self.counts.cells, bounds: self.region, inside });
    }

    fn primitive_test(&mut self, primitive: PrimitiveId) {
        self.counts.primitive_test(primitive);
        let mut alone = Probe::new(self.scene, self.ray, self.range);
        alone.test(primitive);
        if let Some(Hit { t, .. }) = alone.best() {
            let wins = self.probe.test(primitive);
            self.push(Kind::PrimitiveMet { primitive, t, wins });
        } else if let Some(Event { kind: Kind::PrimitivesMissed(missed), .. }) =
            self.events.last_mut()
        {
            missed.push(primitive);
        } else {
            self.push(Kind::PrimitivesMissed(vec![primitive]));
        }
    }

    fn region(&mut self, bounds: &dyn Fn() -> Bounds3) {
        self.region = bounds();
    }
}
