//! What a chapter hands over for each of its figures.

use crate::data::Table;
use crate::plate::{Plate, Verdict};

/// How much work goes into a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Small pictures and few points, for tests.
    Quick,
    /// The size to be shown.
    Full,
}

impl Effort {
    /// One of two settings.
    pub fn pick<T>(self, quick: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Full => full,
        }
    }

    /// How often a study runs its contenders: `full` times, but once where nobody looks at seconds.
    pub fn runs(self, full: usize) -> usize {
        self.pick(1, full)
    }
}

/// A figure of the course: a plate that a function makes, with the numbers behind it.
#[derive(Clone, Copy, Debug)]
pub struct Figure {
    /// Its number, `1.7`.
    pub id: &'static str,
    /// Its short name, `depth`, which ends up in file names.
    pub name: &'static str,
    /// Makes it.
    pub make: fn(Effort) -> Finished,
}

impl Figure {
    /// For tests: no two figures share a number or a name, by either of which they are asked for.
    ///
    /// # Panics
    /// If two do.
    pub fn prove_names(figures: &[Self]) {
        let mut names: Vec<&str> =
            figures.iter().flat_map(|figure| [figure.id, figure.name]).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), 2 * figures.len());
    }

    /// For tests: the figure of that id, made at its quick size, whose claim holds on a legible plate.
    ///
    /// # Panics
    /// If there is none, or its claim fails, or text overlaps or leaves the plate.
    pub fn proved(figures: &[Self], id: &str) -> Finished {
        let figure = figures.iter().find(|figure| figure.id == id);
        let finished = (figure.unwrap_or_else(|| panic!("no figure {id}")).make)(Effort::Quick);
        assert_eq!(finished.plate.id(), id);
        assert_eq!(finished.plate.verdict(), Verdict::Holds, "{}", finished.plate.claim());
        assert_eq!(finished.plate.canvas().faults(), [], "{id}: text overlaps or leaves the plate");
        finished
    }
}

/// A figure that has been made.
pub struct Finished {
    /// What is shown.
    pub plate: Plate,
    /// The numbers behind it, one observation a row. Whatever the claim rests on is in here.
    pub data: Table,
}
