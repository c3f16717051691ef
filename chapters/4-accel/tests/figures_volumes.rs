//! Plates 4.1 to 4.4 at their quick size: the claims hold, and what they rest on. Seconds are not looked at.

use chapter_4::figures::FIGURES;
use lancer_figure::{Effort, Finished, Verdict};

fn made(id: &str) -> Finished {
    let figure = FIGURES.iter().find(|figure| figure.id == id).expect("a figure of the chapter");
    let finished = (figure.make)(Effort::Quick);
    assert_eq!(finished.plate.verdict(), Verdict::Holds, "{}", finished.plate.claim());
    assert_eq!(finished.plate.canvas().faults(), [], "{id}: text overlaps or leaves the plate");
    finished
}

/// The columns of a figure's data, by name, row by row.
fn columns<const N: usize>(finished: &Finished, names: [&str; N]) -> Vec<[String; N]> {
    let csv = finished.data.to_csv();
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    let places = names.map(|name| header.iter().position(|known| *known == name).expect(name));
    lines.map(|row| places.map(|place| row[place].to_owned())).collect()
}

fn number(text: &str) -> f64 {
    text.parse().expect("a number")
}

/// 4.1: brute force tests every triangle, whatever it is asked.
#[test]
fn nothing() {
    let finished = made("4.1");
    let rows = columns(&finished, ["index", "triangles", "tests_per_ray"]);
    let linear: Vec<_> = rows.iter().filter(|[index, ..]| index == "linear").collect();
    assert_eq!(linear.len(), 6);
    assert!(linear.iter().all(|[_, triangles, tests]| number(triangles) == number(tests)));
}

/// 4.2: a ball fills its sphere and a rod along an axis its box; a slanted rod needs a turned one. An icosphere is
/// within 2 % of its sphere.
#[test]
fn volumes() {
    let finished = made("4.2");
    let rows = columns(&finished, ["object", "volume", "lines_per_hit"]);
    let fits = |object: &str, volume: &str| {
        let row = rows.iter().find(|row| row[0] == object && row[1] == volume);
        number(&row.expect("a case")[2])
    };
    assert!(fits("ball", "sphere") < 1.02);
    assert!(fits("rod", "box") < 2.0 && fits("rod", "sphere") > 20.0);
    assert!(fits("slanted rod", "oriented box") < 2.0 && fits("slanted rod", "box") > 10.0);
}

/// 4.3: each builder's tree meets the same rays on each kind of scene.
#[test]
fn builders() {
    let finished = made("4.3");
    let rows = columns(&finished, ["family", "hits"]);
    assert_eq!(rows.len(), 12);
    for trees in rows.chunks(3) {
        assert!(trees.iter().all(|tree| tree == &trees[0]) && number(&trees[0][1]) > 100.0);
    }
}

/// 4.4: lines that nothing stops cost what the areas say, and the heuristic's tree is cheaper than the
/// median's for all of them.
#[test]
fn sah() {
    let finished = made("4.4");
    let rows = columns(&finished, ["split", "predicted", "lines_measured"]);
    for [split, predicted, measured] in &rows {
        let ratio = number(measured) / number(predicted);
        assert!((ratio - 1.0).abs() < 0.05, "{split}: {ratio}");
    }
    for trees in rows.chunks(2) {
        assert!(number(&trees[1][2]) < number(&trees[0][2]), "{trees:?}");
    }
}
