use crate::judge::{Outcome, outcomes};
use crate::{Exercise, Failure};

/// The proof that an exercise's checks accept the right answer and catch every known slip.
#[derive(Clone, Debug)]
pub struct Verified {
    /// The exercise's number and name.
    pub id: &'static str,
    /// Its short name.
    pub name: &'static str,
    /// The names of its checks.
    pub checks: Vec<&'static str>,
    /// Which of them the reference fails; there should be none.
    pub reference_fails: Vec<&'static str>,
    /// The slips.
    pub proofs: Vec<Proof>,
}

/// What the checks say of one slip.
#[derive(Clone, Debug)]
pub struct Proof {
    /// The slip in words.
    pub says: &'static str,
    /// The check that must catch it.
    pub caught_by: &'static str,
    /// For each check whether it caught it.
    pub caught: Vec<bool>,
    /// Another slip that every check answers in the same way, so that the two cannot be told apart.
    pub twin: Option<&'static str>,
}

impl Proof {
    /// Whether the check that should catch the slip does, and no other slip looks the same.
    pub fn holds(&self, checks: &[&str]) -> bool {
        let caught = checks.iter().zip(&self.caught);
        self.twin.is_none()
            && caught.into_iter().any(|(name, caught)| *caught && *name == self.caught_by)
    }
}

impl Verified {
    /// Runs all checks on the reference, without a slip and with each.
    pub fn of<S: Copy + Send>(exercise: &Exercise<S>, reference: S) -> Self {
        let failing = |outcome: &Outcome| matches!(outcome, Outcome::Failed(_));
        let checks = exercise.checks.iter().map(|check| check.name).collect();
        let of_reference = outcomes(exercise, reference);
        let slips = exercise.slips;
        let of_slips: Vec<_> =
            slips.iter().map(|slip| outcomes(exercise, slip.made_in(reference))).collect();
        let proofs = slips.iter().zip(&of_slips).enumerate().map(|(k, (slip, own))| {
            let twin = of_slips[..k].iter().position(|other| other == own);
            Proof {
                says: slip.says,
                caught_by: slip.caught_by,
                caught: own.iter().map(|(_, outcome)| failing(outcome)).collect(),
                twin: twin.map(|index| slips[index].says),
            }
        });
        Self {
            id: exercise.card.id,
            name: exercise.card.name,
            checks,
            reference_fails: of_reference
                .iter()
                .filter(|(_, outcome)| failing(outcome))
                .map(|(name, _)| *name)
                .collect(),
            proofs: proofs.collect(),
        }
    }

    /// Whether everything that is to be proved is.
    pub fn holds(&self) -> bool {
        self.reference_fails.is_empty() && self.proofs.iter().all(|proof| proof.holds(&self.checks))
    }
}

/// Which checks do not notice that nothing has been written.
pub fn passed_by_stub<S: Copy + Send>(exercise: &Exercise<S>, stub: S) -> Vec<&'static str> {
    outcomes(exercise, stub)
        .into_iter()
        .filter(|(_, outcome)| *outcome != Outcome::Failed(Failure::Unwritten))
        .map(|(name, _)| name)
        .collect()
}
