//! The figures of subdivisions of space at their quick size: the claims hold, and the plates are legible.

use chapter_4::figures::FIGURES;
use lancer_figure::{Effort, Value, Verdict};

/// The rows of a figure whose claim holds on a legible plate.
fn rows(id: &str) -> Vec<Vec<Value>> {
    let figure = FIGURES.iter().find(|figure| figure.id == id).expect("a figure of the chapter");
    let finished = (figure.make)(Effort::Quick);
    assert_eq!(finished.plate.id(), id);
    assert_eq!(finished.plate.verdict(), Verdict::Holds, "{}", finished.plate.claim());
    assert_eq!(finished.plate.canvas().faults(), [], "{id}: text overlaps or leaves the plate");
    let wrong = finished.data.columns().iter().position(|column| column == "wrong");
    let wrong = wrong.expect("a column that says whether answers differ from brute force's");
    assert!(finished.data.rows().iter().all(|row| row[wrong] == Value::Integer(0)));
    finished.data.rows().to_vec()
}

fn number(value: &Value) -> f64 {
    match value {
        Value::Number(number) => *number,
        Value::Integer(integer) => *integer as f64,
        Value::Text(text) => panic!("{text:?} is not a number"),
    }
}

fn is(value: &Value, name: &str) -> bool {
    *value == Value::from(name)
}

/// 4.5: between the extremes lies a density that costs least, and in the stadium none is good.
#[test]
fn grid() {
    let rows = rows("4.5");
    let sums = |scene: &str, grid: bool| -> Vec<f64> {
        let of = rows.iter().filter(|row| is(&row[0], scene) && is(&row[1], "grid") == grid);
        of.map(|row| number(&row[4]) + number(&row[5])).collect()
    };
    let least = |sums: &[f64]| sums.iter().copied().fold(f64::INFINITY, f64::min);
    let soup = sums("soup", true);
    assert_eq!(soup.len(), 10);
    assert!(soup[0] > 1.5 * least(&soup) && soup[9] > 1.5 * least(&soup));
    let (grids, others) = (sums("stadium", true), sums("stadium", false));
    assert_eq!((grids.len(), others.len()), (10, 4));
    assert!(others.iter().all(|other| least(&grids) > 5.0 * other));
    let spared = |row: &Vec<Value>| number(&row[5]) <= number(&row[6]);
    assert!(rows.iter().filter(|row| is(&row[1], "grid")).all(spared), "a mailbox adds no test");
}

/// 4.8: hierarchies visit more and test less than subdivisions, each of them.
#[test]
fn heat() {
    let rows = rows("4.8");
    assert_eq!(rows.len(), 8);
    let cuts_space =
        |row: &&Vec<Value>| ["grid", "octree", "kd", "bsp"].iter().any(|name| is(&row[0], name));
    let (subdivisions, hierarchies): (Vec<_>, Vec<_>) = rows.iter().partition(cuts_space);
    for subdivision in &subdivisions {
        for hierarchy in &hierarchies {
            assert!(number(&hierarchy[1]) > number(&subdivision[1]), "visits");
            assert!(number(&hierarchy[2]) < number(&subdivision[2]), "tests");
        }
    }
}

/// 4.6: the grid's fullest cell is fuller than any other's, and each drawn ray visits several cells.
#[test]
fn irregular() {
    let rows = rows("4.6");
    let (grid, trees) = rows.split_first().expect("four structures");
    assert!(is(&grid[0], "grid") && trees.len() == 3);
    assert!(trees.iter().all(|tree| number(&grid[3]) >= 1.5 * number(&tree[3])));
    for row in &rows {
        let leaves_visited = number(&row[4]);
        assert!((3.0..10.0).contains(&leaves_visited), "{leaves_visited} numbers to be drawn");
        assert!(leaves_visited <= number(&row[5]), "a leaf drawn is a node visited");
    }
}
