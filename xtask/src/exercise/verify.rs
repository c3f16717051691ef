//! The table check × slip.

use std::fmt::Write;
use std::panic::set_hook;
use std::time::Instant;

use anyhow::{Result, bail};
use lancer_exercise::Verified;

use crate::chapters::CHAPTERS;

/// Proves every exercise's checks and prints the proofs.
///
/// # Errors
/// If one does not hold.
pub fn verify() -> Result<()> {
    // With a slip a function may panic; that is an outcome like others.
    set_hook(Box::new(|_| ()));
    let start = Instant::now();
    let proved: Vec<Verified> =
        CHAPTERS.iter().flat_map(|chapter| chapter.course.verify()).collect();
    for verified in &proved {
        say!("{}", table(verified));
    }
    let slips: usize = proved.iter().map(|verified| verified.proofs.len()).sum();
    say!("{} exercises, {slips} slips, {:.1} s", proved.len(), start.elapsed().as_secs_f64());
    let failed: Vec<&str> =
        proved.iter().filter(|verified| !verified.holds()).map(|verified| verified.id).collect();
    if !failed.is_empty() {
        bail!("the proof does not hold for {}; see FAILS above", failed.join(", "));
    }
    Ok(())
}

/// An exercise's checks, and a row for each slip: ● the check that must catch it does, ○ another one does.
fn table(verified: &Verified) -> String {
    let mut text = format!("{} {}\n", verified.id, verified.name);
    for (number, check) in verified.checks.iter().enumerate() {
        let verdict = if verified.reference_fails.contains(check) {
            "  FAILS: the right answer does not pass"
        } else {
            ""
        };
        let _ = writeln!(text, "  {:>2} {check}{verdict}", number + 1);
    }
    for proof in &verified.proofs {
        let marks: String = verified
            .checks
            .iter()
            .zip(&proof.caught)
            .map(|(check, caught)| match (*check == proof.caught_by, caught) {
                (true, true) => " ●",
                (false, true) => " ○",
                (_, false) => " ·",
            })
            .collect();
        let _ = write!(text, "  {marks}  {}", proof.says);
        if let Some(twin) = proof.twin {
            let _ = write!(text, "  FAILS: looks like « {twin} »");
        } else if !proof.holds(&verified.checks) {
            let _ = write!(text, "  FAILS: « {} » does not catch it", proof.caught_by);
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use insta::assert_snapshot;
    use lancer_exercise::Proof;

    use super::*;

    #[test]
    fn the_table_says_what_fails() {
        let proof = |says, caught_by, caught: [bool; 2], twin| Proof {
            says,
            caught_by,
            caught: caught.to_vec(),
            twin,
        };
        let verified = Verified {
            id: "E1.1",
            name: "a",
            checks: vec!["near", "far"],
            reference_fails: vec!["far"],
            proofs: vec![
                proof("halved", "near", [true, true], None),
                proof("doubled", "far", [true, false], None),
                proof("twice", "near", [true, true], Some("halved")),
            ],
        };
        assert_snapshot!(table(&verified), @r"
        E1.1 a
           1 near
           2 far  FAILS: the right answer does not pass
           ● ○  halved
           ○ ·  doubled  FAILS: « far » does not catch it
           ● ○  twice  FAILS: looks like « halved »
        ");
    }
}
