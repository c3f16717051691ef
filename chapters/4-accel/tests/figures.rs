//! Every figure of the chapter at its quick size: the claim holds, and the plate is legible.
//!
//! What the claims rest on (counts and errors) is the same on every machine; seconds are not looked at.

use chapter_4::aimed::CLASSES;
use chapter_4::figures::FIGURES;
use lancer_accel::structures::STRUCTURES;
use lancer_figure::{Figure, Record};

/// The data of a figure whose claim holds on a legible plate.
fn rows(id: &str) -> Vec<Record> {
    Figure::proved(FIGURES, id).data.records()
}

#[test]
fn ids_and_names_are_unique() {
    Figure::prove_names(FIGURES);
}

/// 4.1: brute force tests every triangle, whatever it is asked.
#[test]
fn nothing() {
    let rows = rows("4.1");
    let linear: Vec<_> = rows.iter().filter(|row| row.text("index") == "linear").collect();
    assert_eq!(linear.len(), 6);
    assert!(linear.iter().all(|row| row.number("triangles") == row.number("tests_per_ray")));
}

/// 4.2: a ball fills its sphere and a rod along an axis its box; a slanted rod needs a turned one. An
/// icosphere is within 2 % of its sphere.
#[test]
fn volumes() {
    let rows = rows("4.2");
    let fits = |object: &str, volume: &str| {
        let is_it = |row: &&Record| row.text("object") == object && row.text("volume") == volume;
        rows.iter().find(is_it).expect("a case").number("lines_per_hit")
    };
    assert!(fits("ball", "sphere") < 1.02);
    assert!(fits("rod", "box") < 2.0 && fits("rod", "sphere") > 20.0);
    assert!(fits("slanted rod", "oriented box") < 2.0 && fits("slanted rod", "box") > 10.0);
}

/// 4.3: each builder's tree meets the same rays on each kind of scene, and where sizes differ most ours asks
/// fewer tests than the library's.
#[test]
fn builders() {
    let rows = rows("4.3");
    assert_eq!(rows.len(), 12);
    for trees in rows.chunks(3) {
        let key = |tree: &Record| (tree.text("family").to_owned(), tree.text("hits").to_owned());
        assert!(trees.iter().all(|tree| key(tree) == key(&trees[0])));
        assert!(trees[0].number("hits") > 100.0);
        // A large floor under small things, which cuts by size part.
        if ["town", "stadium"].contains(&trees[0].text("family")) {
            let [sah, obvhs] = [1, 2].map(|k| trees[k].number("tests_per_ray"));
            assert!(sah < obvhs, "{trees:?}");
        }
    }
}

/// 4.4: lines that nothing stops cost what the areas say, and the heuristic's tree is cheaper than the
/// median's for all of them.
#[test]
fn sah() {
    let rows = rows("4.4");
    for row in &rows {
        let ratio = row.number("lines_measured") / row.number("predicted");
        assert!((ratio - 1.0).abs() < 0.05, "{row:?}");
    }
    for trees in rows.chunks(2) {
        let [median, sah] = [0, 1].map(|k| trees[k].number("lines_measured"));
        assert!(sah < median, "{trees:?}");
    }
}

/// The counts of plates 4.5, 4.6 and 4.8 are worth something because no answer is wrong.
fn right_rows(id: &str) -> Vec<Record> {
    let rows = rows(id);
    assert!(rows.iter().all(|row| row.text("wrong") == "0"), "answers differ from brute force's");
    rows
}

/// 4.5: between the extremes lies a density that costs least, and in the stadium none is good.
#[test]
fn grid() {
    let rows = right_rows("4.5");
    let is_grid = |row: &Record| row.text("index") == "grid";
    let sums = |scene: &str, grid: bool| -> Vec<f64> {
        let of = rows.iter().filter(|row| row.text("scene") == scene && is_grid(row) == grid);
        of.map(|row| row.number("cells_or_boxes") + row.number("tests")).collect()
    };
    let least = |sums: &[f64]| sums.iter().copied().fold(f64::INFINITY, f64::min);
    let soup = sums("soup", true);
    assert_eq!(soup.len(), 10);
    assert!(soup[0] > 1.5 * least(&soup) && soup[9] > 1.5 * least(&soup));
    let (grids, others) = (sums("stadium", true), sums("stadium", false));
    assert_eq!((grids.len(), others.len()), (10, 4));
    assert!(others.iter().all(|other| least(&grids) > 5.0 * other));
    let spared = |row: &Record| row.number("tests") <= row.number("tests_no_mailbox");
    assert!(rows.iter().filter(|row| is_grid(row)).all(spared), "a mailbox adds no test");
}

/// 4.6: the grid's fullest cell is fuller than any other's, and each drawn ray visits several cells.
#[test]
fn irregular() {
    let rows = right_rows("4.6");
    let (grid, trees) = rows.split_first().expect("four structures");
    assert!(grid.text("index") == "grid" && trees.len() == 3);
    assert!(trees.iter().all(|tree| grid.number("fullest") >= 1.5 * tree.number("fullest")));
    for row in &rows {
        let leaves_visited = row.number("leaves_visited");
        assert!((3.0..10.0).contains(&leaves_visited), "{leaves_visited} numbers to be drawn");
        assert!(leaves_visited <= row.number("cells_visited"), "a leaf drawn is a node visited");
    }
}

/// 4.7: every index of the list is there, on the same rays with the same hits.
#[test]
fn structures() {
    let rows = rows("4.7");
    for structure in STRUCTURES {
        assert!(rows.iter().any(|row| row.text("index") == structure.name), "{}", structure.name);
    }
    for row in &rows {
        let scene = |row: &Record| ["family", "triangles"].map(|name| row.text(name).to_owned());
        let asked = |row: &Record| ["rays", "hits"].map(|name| row.text(name).to_owned());
        let mut of_scene = rows.iter().filter(|other| scene(other) == scene(row));
        assert!(of_scene.all(|other| asked(other) == asked(row)), "{row:?}");
        assert!(row.number("hits") > 0.0, "a scene that no ray hits");
    }
}

/// 4.8: hierarchies visit more and test less than subdivisions, each of them.
#[test]
fn heat() {
    let rows = right_rows("4.8");
    assert_eq!(rows.len(), STRUCTURES.len() - 1);
    let cuts_space = |row: &&Record| ["grid", "octree", "kd", "bsp"].contains(&row.text("index"));
    let (subdivisions, hierarchies): (Vec<_>, Vec<_>) = rows.iter().partition(cuts_space);
    for subdivision in &subdivisions {
        for hierarchy in &hierarchies {
            assert!(hierarchy.number("visits") > subdivision.number("visits"), "visits");
            assert!(hierarchy.number("tests") < subdivision.number("tests"), "tests");
        }
    }
}

/// 4.9: a group of rays asks no fewer boxes than one of its rays and no more than all of them, and groups
/// of diffuse rays share least.
#[test]
fn coherence() {
    let rows = rows("4.9");
    let boxes = |family: &str, kind: &str| -> Vec<(f64, f64)> {
        let of = rows.iter().filter(|row| row.text("family") == family && row.text("kind") == kind);
        let of = of.filter(|row| !row.text("group").is_empty());
        of.map(|row| (row.number("group"), row.number("boxes_per_ray"))).collect()
    };
    for family in ["scan", "town"] {
        let [primary, shadow, diffuse] =
            ["primary", "shadow", "diffuse"].map(|kind| boxes(family, kind));
        for cases in [&primary, &shadow, &diffuse] {
            let (one, alone) = cases[0];
            assert_eq!((one, cases.len()), (1.0, 5));
            for pair in cases.windows(2) {
                assert!(pair[1].1 < pair[0].1, "{family}: {cases:?}");
            }
            assert!(
                cases.iter().all(|(group, boxes)| boxes * group >= alone),
                "{family}: {cases:?}"
            );
        }
        assert!((0..2).all(|k| [&primary, &shadow][k][3].1 < diffuse[3].1));
    }
}

/// 4.10: neither lanes nor threads change an answer; 32 bits do.
#[test]
fn hardware() {
    let rows = rows("4.10");
    assert_eq!(rows.len(), 2 * 5);
    for ways in rows.chunks(5) {
        assert!(ways[0].text("way").starts_with("obvhs") && ways[0].number("wrong") > 0.0);
        assert!(ways[1..].iter().all(|row| row.text("way").starts_with("wide")));
        assert!(ways[1..].iter().all(|row| row.text("wrong") == "0"), "{ways:?}");
    }
}

/// 4.11: none of the indexes errs for any class of rays, on any of the three scenes; each of the naive ones
/// does.
#[test]
fn agreement() {
    let rows = rows("4.11");
    let is_ours =
        |row: &&Record| STRUCTURES.iter().any(|structure| row.text("contender") == structure.name);
    let (ours, naive): (Vec<_>, Vec<_>) = rows.iter().partition(is_ours);
    assert_eq!(ours.len(), 3 * CLASSES.len() * (STRUCTURES.len() - 1));
    assert!(ours.iter().all(|row| row.text("wrong") == "0"), "{ours:?}");
    for name in ["boxes without a pad", "first hit in a cell wins", "obvhs' own f32 walk"] {
        let mut of_name = naive.iter().filter(|row| row.text("contender") == name);
        assert!(of_name.any(|row| row.number("wrong") > 0.0), "{name}");
    }
}

/// 4.12: no hit is lost, the hierarchy visits what brute force does, and each index tests far less.
#[test]
fn beams() {
    let rows = rows("4.12");
    assert_eq!(rows.len(), 3 * 2 * 3 * 5);
    for group in rows.chunks(5) {
        let names: Vec<_> =
            group.iter().map(|row| (row.text("index"), row.text("bound"))).collect();
        let wanted = [
            ("linear", "none"),
            ("bvh", "none"),
            ("grid", "none"),
            ("bvh", "seen"),
            ("grid", "seen"),
        ];
        assert_eq!(names, wanted);
        let value = |k: usize, name: &str| group[k].number(name);
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

/// 4.13: of the ray that is met the slabs leave t = 2 to 4.5, by hand; of the other nothing, for it is in y until
/// 3.2 / 1.2 = 2.67, and in x from 1.8 / 0.6 = 3 on.
#[test]
fn slab_test() {
    let rows = rows("4.13");
    let part = |ray: &str, slab: &str| {
        let is_it = |row: &&Record| row.text("ray") == ray && row.text("slab") == slab;
        let row = rows.iter().find(is_it).expect("a slab of a ray");
        ["enter", "leave"].map(|name| (1e9 * row.number(name)).round() / 1e9)
    };
    let met = ["x", "y", "all"].map(|slab| part("meets the box", slab));
    assert_eq!(met, [[1.5, 4.5], [2.0, 5.333_333_333], [2.0, 4.5]]);
    let missed = ["x", "y", "all"].map(|slab| part("misses the box", slab));
    assert_eq!(missed, [[3.0, 8.0], [1.0, 2.666_666_667], [3.0, 2.666_666_667]]);
    let wanted = [("meets the box", "2.00 to 4.50"), ("misses the box", "none")];
    for (row, (ray, part)) in rows.iter().filter(|row| row.text("slab") == "all").zip(wanted) {
        assert_eq!(["ray", "by_points", "by_course"].map(|name| row.text(name)), [ray, part, part]);
    }
}

/// 4.14: the costs by hand, from surfaces 8 e + 8 of boxes e wide: 1 + (16 · 1 + 84 · 4) / 96 and so on.
#[test]
fn split() {
    let rows = rows("4.14");
    let names = ["left_surface", "left", "right_surface", "right"];
    let got: Vec<_> = rows.iter().map(|row| names.map(|name| row.number(name))).collect();
    let wanted = [
        [16.0, 1.0, 84.0, 4.0],
        [28.0, 2.0, 72.0, 3.0],
        [40.0, 3.0, 28.0, 2.0],
        [84.0, 4.0, 16.0, 1.0],
    ];
    assert_eq!(got, wanted);
    for (row, [a, n, b, m]) in rows.iter().zip(wanted) {
        let cost = 1.0 + (a * n + b * m) / 96.0;
        assert!((row.number("cost") - cost).abs() < 1e-12, "{row:?}");
        assert!((row.number("counted") / cost - 1.0).abs() < 0.02, "{row:?}");
    }
}

/// 4.15: the walk by hand. The planes of x are met at t = 0.6, 1.6 and so on, those of y at (j − 0.5) / 0.6.
#[test]
fn walk() {
    let rows = rows("4.15");
    let cells: Vec<_> =
        rows.iter().map(|row| ["cell_x", "cell_y"].map(|name| row.number(name))).collect();
    let xs = [0, 1, 1, 2, 2, 3, 4, 4, 5, 6, 6, 7];
    let ys = [0, 0, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4];
    assert_eq!(
        cells,
        xs.into_iter().zip(ys).map(|(x, y)| [x, y].map(f64::from)).collect::<Vec<_>>()
    );
    let steps: String = rows.iter().map(|row| row.text("step")).collect();
    assert_eq!(steps, "xyxyxxyxxyxout");
    let t = |k: usize| rows[k].number("t");
    assert!(
        (t(0) - 0.6).abs() < 1e-12 && (t(3) - 2.5).abs() < 1e-12 && (t(11) - 7.5).abs() < 1e-12
    );
}
