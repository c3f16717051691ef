//! Figure 4.12 at its quick size: the claim, and the counts that it rests on.

use chapter_4::figures::FIGURES;
use lancer_figure::{Effort, Verdict};

#[test]
fn beams() {
    let figure =
        FIGURES.iter().find(|figure| figure.id == "4.12").expect("a figure of the chapter");
    let finished = (figure.make)(Effort::Quick);
    assert_eq!(finished.plate.verdict(), Verdict::Holds, "{}", finished.plate.claim());
    assert_eq!(finished.plate.canvas().faults(), []);

    let csv = finished.data.to_csv();
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    let column = |name: &str| header.iter().position(|column| *column == name).expect("a column");
    let rows: Vec<Vec<&str>> = lines.collect();
    assert_eq!(rows.len(), 3 * 2 * 3 * 5);
    for group in rows.chunks(5) {
        let names = group.iter().map(|row| (row[column("index")], row[column("bound")]));
        let wanted = [
            ("linear", "none"),
            ("bvh", "none"),
            ("grid", "none"),
            ("bvh", "seen"),
            ("grid", "seen"),
        ];
        assert_eq!(names.collect::<Vec<_>>(), wanted);
        let value =
            |k: usize, name: &str| -> f64 { group[k][column(name)].parse().expect("a number") };
        assert_eq!(value(0, "tests"), value(0, "triangles"));
        assert_eq!(value(1, "met"), value(0, "met"));
        assert!(value(2, "met") <= value(0, "met"));
        for index in 1..5 {
            assert_eq!(value(index, "hits_lost"), 0.0);
            // Of a thousand polygons as well, an index tests fewer than brute force by far.
            assert!(4.0 * value(index, "tests") < value(0, "tests"), "{group:?}");
        }
        for bounded in [0, 2] {
            let [bvh, grid] = [1 + bounded, 2 + bounded];
            assert_eq!(value(bvh, "unlike_linear"), 0.0);
            assert!(value(bvh, "tests") <= value(grid, "tests"), "{group:?}");
            assert!(value(bvh, "tests") <= value(1, "tests"), "{group:?}");
        }
    }
}
