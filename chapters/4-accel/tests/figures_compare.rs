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

/// 4.11: none of the indexes errs for any class of rays, on any of the three scenes; each of the naive ones does.
#[test]
fn agreement() {
    let figure = FIGURES.iter().find(|figure| figure.id == "4.11").expect("a figure");
    let finished = (figure.make)(Effort::Quick);
    assert_eq!(finished.plate.verdict(), Verdict::Holds, "{}", finished.plate.claim());
    assert_eq!(finished.plate.canvas().faults(), []);
    let csv = finished.data.to_csv();
    let rows: Vec<Vec<&str>> = csv.lines().skip(1).map(|row| row.split(',').collect()).collect();
    let ours = |row: &&Vec<&str>| STRUCTURES.iter().any(|structure| row[0] == structure.name);
    let (ours, naive): (Vec<_>, Vec<_>) = rows.iter().partition(ours);
    assert_eq!(ours.len(), 3 * 8 * (STRUCTURES.len() - 1));
    assert!(ours.iter().all(|row| row[3] == "0"), "{ours:?}");
    for name in ["boxes without a pad", "first hit in a cell wins", "obvhs' own f32 walk"] {
        assert!(naive.iter().any(|row| row[0] == name && row[3] != "0"), "{name}");
    }
}
