//! The figures that compare all indexes, at their quick size.

use chapter_4::figures::FIGURES;
use chapter_4::structures::STRUCTURES;
use lancer_figure::{Effort, Verdict};

/// 4.7: every index of the list is there, on the same rays with the same hits.
#[test]
fn structures() {
    let figure = FIGURES.iter().find(|figure| figure.id == "4.7").expect("a figure of the chapter");
    let finished = (figure.make)(Effort::Quick);
    assert_eq!(finished.plate.verdict(), Verdict::Holds, "{}", finished.plate.claim());
    assert_eq!(finished.plate.canvas().faults(), []);
    let csv = finished.data.to_csv();
    let rows: Vec<Vec<&str>> = csv.lines().skip(1).map(|row| row.split(',').collect()).collect();
    for structure in STRUCTURES {
        assert!(rows.iter().any(|row| row[2] == structure.name), "{}", structure.name);
    }
    for row in &rows {
        // Family and triangles say which scene: its rays and hits are the same for all.
        let of_scene = rows.iter().filter(|other| other[..2] == row[..2]);
        assert!(of_scene.clone().all(|other| other[3..5] == row[3..5]), "{row:?}");
        assert_ne!(row[4], "0", "a scene that no ray hits");
    }
}
