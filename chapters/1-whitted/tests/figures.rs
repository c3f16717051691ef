//! Every figure of the chapter at its quick size: the claim holds, and the plate is legible.
//!
//! What the claims rest on (counts and errors) is the same on every machine; seconds are not looked at.

use chapter_1::figures::FIGURES;
use lancer_figure::{Effort, Finished, Verdict};

fn made(id: &str) -> Finished {
    let figure = FIGURES.iter().find(|figure| figure.id == id).expect("a figure of the chapter");
    let finished = (figure.make)(Effort::Quick);
    assert_eq!(finished.plate.id(), id);
    assert_eq!(finished.plate.verdict(), Verdict::Holds, "{}", finished.plate.claim());
    assert_eq!(finished.plate.canvas().faults(), [], "{id}: text overlaps or leaves the plate");
    finished
}

/// The rows of a figure's data as (column, value) pairs; no cell of the chapter holds a comma.
fn rows(finished: &Finished) -> Vec<Vec<(String, String)>> {
    let csv = finished.data.to_csv();
    assert!(!csv.contains('"'), "a quoted cell");
    let mut lines = csv.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    lines.map(|row| header.iter().cloned().zip(row).collect()).collect()
}

fn field<'a>(row: &'a [(String, String)], column: &str) -> &'a str {
    let found = row.iter().find(|(name, _)| name == column);
    &found.unwrap_or_else(|| panic!("no column {column}")).1
}

fn value(row: &[(String, String)], column: &str) -> f64 {
    field(row, column).parse().expect("a number")
}

#[test]
fn ids_and_names_are_unique() {
    let mut names: Vec<&str> = FIGURES.iter().flat_map(|figure| [figure.id, figure.name]).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), 2 * FIGURES.len());
}

/// 0.1, eq:ray-sphere: the stable form loses no sphere in 64 bits, the textbook's does in 32.
#[test]
fn quadratic() {
    let rows = rows(&made("0.1"));
    let lost = |name: &str| -> f64 {
        assert!(rows.iter().any(|row| field(row, "solver") == name));
        rows.iter()
            .filter(|row| field(row, "solver") == name)
            .map(|row| value(row, "lost_of_96"))
            .sum()
    };
    assert_eq!(lost("stable f64"), 0.0);
    assert!(lost("textbook f32") > 0.0);
}

/// 0.3, eq:ray-triangle: our test never leaks, Möller-Trumbore does at edges and at vertices.
#[test]
fn watertight() {
    let finished = made("0.3");
    for row in rows(&finished) {
        let leaks = value(&row, "leaking rays (%)");
        match (field(&row, "method"), field(&row, "knob")) {
            ("watertight", _) | (_, "random directions") => assert_eq!(leaks, 0.0),
            ("Möller-Trumbore", _) => assert!(leaks > 2.0, "{row:?}"),
            _ => (),
        }
    }
}

/// 1.1, algo:appel and eq:ray-triangle: rays err nowhere; of a cycle of three bars an order gets one
/// crossing wrong or two, and of two sheets that pass through each other half of what they share.
#[test]
fn visible() {
    let rows = rows(&made("1.1"));
    for row in &rows {
        let wrong = value(row, "wrong_pixels_percent");
        assert_eq!(field(row, "method").starts_with("rays"), wrong == 0.0, "{row:?}");
    }
    // A crossing of two strips is a parallelogram: the product of their widths over the sine between them.
    let percent_of_picture = 100.0 / 8.0;
    let crossing = 0.34 * 0.34 / (std::f64::consts::TAU / 6.0).sin() * percent_of_picture;
    let sheets = 0.5 * 0.72 * 0.72 / 1.4_f64.sin() * percent_of_picture;
    let with_crossings = |count: f64| {
        let orders = rows.iter().filter(|row| field(row, "method") == "an order");
        let near = |wrong: f64| (wrong - count * crossing - sheets).abs() < 0.3;
        orders.filter(|row| near(value(row, "wrong_pixels_percent"))).count()
    };
    assert_eq!((with_crossings(1.0), with_crossings(2.0)), (60, 60));
    // The painter looks only where its polygons are.
    let tests = |method: &str| -> Vec<f64> {
        let rows = rows.iter().filter(|row| field(row, "method") == method);
        rows.map(|row| value(row, "tests")).collect()
    };
    let (painter, tree) = (tests("painter: centroid"), tests("rays: tree"));
    assert!(painter.iter().zip(&tree).all(|(painter, tree)| painter < tree));
}

/// 1.2, eq:local and eq:ambient: every term has its sign, and shadows take no more than the lights gave.
#[test]
fn local_model() {
    let means: Vec<f64> =
        rows(&made("1.2")).iter().map(|row| value(row, "mean_radiance")).collect();
    let [ambient, diffuse, specular, shadows, reflection, refraction] = means[..] else {
        panic!("six terms")
    };
    assert!([ambient, diffuse, specular, reflection, refraction].iter().all(|&mean| mean > 0.0));
    assert!(shadows < 0.0 && -shadows < diffuse + specular);
}

/// 1.5, eq:descartes at the table's own angles.
#[test]
fn descartes() {
    let finished = made("1.5");
    let out = |n1: f64, n2: f64, degrees: f64| {
        let rows = rows(&finished);
        let row = rows.iter().find(|row| {
            (value(row, "n1"), value(row, "n2"), value(row, "degrees_in")) == (n1, n2, degrees)
        });
        value(row.expect("a row"), "degrees_out")
    };
    assert!((out(1.0, 1.5, 30.0) - 19.4712206344907).abs() < 1e-12);
    assert!((out(1.0, 1.5, 60.0) - 35.2643896827547).abs() < 1e-12);
    assert!(out(1.5, 1.0, 41.0) > 79.0 && out(1.5, 1.0, 42.0).is_nan());
}

/// 1.6, fig:ray-tree: each node's weight is its parent's times the share on the edge.
#[test]
fn ray_tree() {
    let rows = rows(&made("1.6"));
    assert!(rows.len() >= 8 && field(&rows[0], "kind") == "primary");
    for row in &rows[1..] {
        let parent = &rows[value(row, "parent") as usize];
        assert_eq!(value(row, "depth"), value(parent, "depth") + 1.0);
        assert!(value(row, "weight") < value(parent, "weight"));
        let share = value(row, "weight") / value(parent, "weight");
        let of_glass = if field(row, "kind") == "refracted" { 0.9 } else { 0.1 };
        if field(parent, "end") == "glass" {
            assert!((share - of_glass).abs() < 1e-12);
        }
    }
    let ends: Vec<&str> = rows.iter().map(|row| field(row, "end")).collect();
    for wanted in ["glass", "mirror", "plastic", "floor", "background", "cut"] {
        assert!(ends.contains(&wanted), "no ray ends at {wanted}");
    }
}

/// 1.7, algo:lr and eq:recursion: each bounce costs rays and leaves less error; the three colours at the
/// limit cost the same.
#[test]
fn depth() {
    let rows = rows(&made("1.7"));
    let curve =
        |name: &str| -> Vec<_> { rows.iter().filter(|row| field(row, "method") == name).collect() };
    let (black, background) = (curve("black"), curve("background"));
    for pair in black.windows(2) {
        assert!(value(pair[1], "rays") > value(pair[0], "rays"));
        assert!(value(pair[1], "mean_abs") < value(pair[0], "mean_abs"));
    }
    for (a, b) in black.iter().zip(&background) {
        assert_eq!(field(a, "rays"), field(b, "rays"));
        assert_eq!(field(a, "weight_left"), field(b, "weight_left"));
    }
}

/// 1.11: a pixel's samples cost what they cost in any layout, and more samples err less in each.
#[test]
fn aliasing() {
    let rows = rows(&made("1.11"));
    for curve in rows.chunks(4) {
        for pair in curve.windows(2) {
            assert_eq!(value(&pair[1], "samples"), 4.0 * value(&pair[0], "samples"));
            assert!(value(&pair[1], "RMSE") < value(&pair[0], "RMSE"));
        }
    }
}

/// 1.12, eq:ray-sphere and algo:lr: a frame with one sample per pixel shows nothing or a whole pixel, so that
/// its errors are those of a coin of p = π d² / 4. 64 samples miss no sphere of half a pixel in any layout:
/// each has a sample in every cell of 1/8, and the disc holds the cell that its centre lies in.
#[test]
fn vanishing() {
    let rows = rows(&made("1.12"));
    let of = |method: &str, knob: &str, column: &str| {
        let row =
            rows.iter().find(|row| field(row, "method") == method && field(row, "knob") == knob);
        value(row.expect("a row"), column)
    };
    let error = "relative RMS error of the area";
    let p = std::f64::consts::PI / 16.0;
    // Of 15² frames the disc, 7.5 of their steps wide, holds 225 p = 44 up to π (√2 · 3.75 + ½) = 18.
    let seen = 225.0 * (1.0 - of("regular", "1", "gone (%)") / 100.0);
    assert!((seen - 225.0 * p).abs() < 18.0, "{seen}");
    let coin = (seen / 225.0 * (1.0 / p - 1.0).powi(2) + 1.0 - seen / 225.0).sqrt();
    assert!((of("regular", "1", error) - coin).abs() < 1e-9);
    for method in ["regular", "jittered", "Owen"] {
        assert_eq!(of(method, "64", "gone (%)"), 0.0);
        for [fewer, more] in [["1", "4"], ["4", "16"], ["16", "64"]] {
            assert!(of(method, more, error) < of(method, fewer, error), "{method} {more}");
        }
    }
    // The discs around the samples of a grid of 2 by 2 touch: four times as many, up to π (√2 · 7.5 + ½) = 34.
    let seen = 225.0 * (1.0 - of("regular", "4", "gone (%)") / 100.0);
    assert!((seen - 4.0 * 225.0 * p).abs() < 34.0, "{seen}");
}

/// 1.14, algo:lr, eq:ambient and eq:local: from where the camera stood all is known, and less the farther it
/// moves; diffuse light does not depend on the eye; every pixel's ray is traced all the same.
#[test]
fn image_space() {
    let rows = rows(&made("1.14"));
    let (width, pixels) = (64.0, 64.0 * 48.0);
    for motion in ["to the side", "turned"] {
        let rows: Vec<_> = rows.iter().filter(|row| field(row, "motion") == motion).collect();
        assert_eq!(value(rows[0], "same_light"), pixels);
        assert_eq!(value(rows[0], "shadow_rays_same"), value(rows[0], "shadow_rays"));
        for row in &rows {
            // The room is closed: each primary ray meets it, and each mirror ray again.
            assert_eq!((value(row, "points"), value(row, "primary_rays")), (pixels, pixels));
            assert_eq!(value(row, "same_light"), value(row, "seen"));
            let first_rays = pixels + value(row, "shadow_rays") + value(row, "mirror_rays");
            assert!(value(row, "rays") >= first_rays, "{row:?}");
        }
        for pair in rows.windows(2) {
            assert!(value(pair[1], "seen") < value(pair[0], "seen"));
        }
        // At least a column comes into the picture for each pixel of the step.
        for row in &rows[1..] {
            assert!(value(row, "seen") <= pixels * (1.0 - value(row, "pixels") / width), "{row:?}");
        }
    }
}
