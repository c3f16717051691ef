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

/// 0.2: the error bound is right at all twenty sites. What leaks near the origin follows from ε over the scale
/// alone, and nothing leaks where that is less than the lowest sheet's 3·10⁻⁶.
#[test]
fn acne() {
    let rows = rows(&made("0.2"));
    let site = |offset: &str, away: f64, exponent: i32| -> [f64; 2] {
        let row = rows.iter().find(|row| {
            let here = value(row, "scale") == 10.0_f64.powi(exponent);
            field(row, "offset") == offset && value(row, "sizes_away") == away && here
        });
        let row = row.unwrap_or_else(|| panic!("no row {offset} {away} {exponent}"));
        ["wrongly_dark", "wrongly_bright"].map(|column| value(row, column))
    };
    for away in [0.0, 1e6] {
        assert!((-3..=6).all(|exponent| site("error bound", away, exponent) == [0.0; 2]));
    }
    // From all sheets leaking to none.
    for part in -7..=0 {
        let [_, bright] = site("ε = 10⁻²", 0.0, -2 - part);
        let alike = [("ε = 10⁻⁴", -4 - part), ("ε = 10⁻⁶", -6 - part)];
        for (offset, exponent) in alike.into_iter().filter(|(_, e)| (-3..=6).contains(e)) {
            assert_eq!(site(offset, 0.0, exponent)[1], bright, "{offset} at 10^{exponent}");
        }
        assert_eq!(bright == 0.0, part < -5, "ε 10^{part} of the scene");
    }
    // 6·10⁵ units from the origin a coordinate is rounded by 10⁻¹⁰ at most: far less than ε. At 10¹²
    // it is by 10⁻⁴: ε = 10⁻⁶ is lost in it.
    assert_eq!(site("ε = 10⁻⁶", 1e6, 0)[0], 0.0);
    assert_eq!(site("ε = 10⁻⁶", 1e6, 6), site("none", 1e6, 6));
    assert!(site("none (textbook hits)", 0.0, 0)[0] > 500.0);
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

/// 0.4: our box test misses no box and draws every tower. A min/max test loses every ray in a face plane, a
/// swap those where −0 turns the planes' order, the sign-picked form those where the plane is the first axis's:
/// one in three.
#[test]
fn slab() {
    let rows = rows(&made("0.4"));
    let share = |question: &str, class: &str, form: &str| {
        let row = rows.iter().find(|row| {
            ["question", "class", "form"].map(|c| field(row, c)) == [question, class, form]
        });
        let row = row.unwrap_or_else(|| panic!("no row {question} {class} {form}"));
        value(row, "wrong") / value(row, "rays")
    };
    for row in rows.iter().filter(|row| field(row, "form") == "ours") {
        assert!(field(row, "question") == "false hit" || value(row, "wrong") == 0.0, "{row:?}");
    }
    for class in ["in a face plane +0", "in a face plane −0"] {
        assert_eq!(share("false miss", class, "min/max"), 1.0);
        // Five standard deviations of 5000 draws are 0.033.
        assert!((share("false miss", class, "sign-picked") - 1.0 / 3.0).abs() < 0.034);
    }
    for form in ["swap", "swap + pad"] {
        assert_eq!(share("false miss", "in a face plane +0", form), 0.0);
        assert_eq!(share("false miss", "in a face plane −0", form), 1.0);
    }
    // The price: rays beside an edge by 10⁻¹⁵ of their way are let in, by 10⁻¹³ none.
    assert!(share("false hit", "gap 1.3e-15", "ours") > 0.5);
    assert_eq!(share("false hit", "gap 1.6e-13", "ours"), 0.0);
}

/// 0.5, eq:ray-triangle and eq:ray-sphere: the robust kernels are never wrong, each textbook form is. Three of
/// the thirteen classes of boxes run in a face plane, where min/max loses all.
#[test]
fn safety() {
    let rows = rows(&made("0.5"));
    let forms: Vec<(&str, f64)> =
        rows.iter().map(|row| (field(row, "knob"), value(row, "wrong per million"))).collect();
    let wrong = |form: &str| forms.iter().find(|(name, _)| *name == form).expect("a form").1;
    for robust in ["watertight", "stable", "slabs", "error bound"] {
        assert_eq!(wrong(robust), 0.0, "{robust}");
    }
    assert!(wrong("Möller-Trumbore") > 2e4 && wrong("fused edges") > 0.0);
    // 3·10⁵ radii away the rounding of the discriminant is 10⁻⁵ radii, ten times what counts as wrong.
    assert!(wrong("b² − 4ac") > 5e5);
    // The last rays of the last round have no window of their own: half of a class in thirteen.
    assert!(wrong("min/max") > 2.9 / 13.0 * 1e6);
    assert!(wrong("ε = 10⁻⁴") > 0.0);
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

/// 1.4, eq:attenuation: 1 / d² for a point, and for a square lamp 1 away its midpoint in place of Lambert's
/// 0.752274688454107 / π; four midpoints err less.
#[test]
fn inverse_square() {
    let rows = rows(&made("1.4"));
    let at = |lamp: &str, distance: f64, points: f64| {
        let found = rows.iter().find(|row| {
            (field(row, "lamp"), value(row, "distance"), value(row, "points"))
                == (lamp, distance, points)
        });
        found.expect("a row")
    };
    assert!((value(at("point", 64.0, 1.0), "radiance") * 4096.0 - 1.0).abs() < 1e-13);
    let square = at("square", 1.0, 1.0);
    let exact = 0.752274688454107 / std::f64::consts::PI;
    assert!((value(square, "exact") / exact - 1.0).abs() < 1e-13);
    assert!((value(square, "radiance") * std::f64::consts::PI - 1.0).abs() < 1e-12);
    assert!(value(at("square", 1.0, 4.0), "error") < 0.3 * value(square, "error"));
}

/// 1.3, eq:local: the widths of the closed form, (cos θ)ⁿ = ½, are within what the pictures allow, and the
/// light in the highlight is 2π/(n + 1).
#[test]
fn exponent() {
    let rows = rows(&made("1.3"));
    assert_eq!(rows.len(), 7);
    for row in &rows {
        let n = value(row, "n");
        let within = |angle: &str| value(row, angle).cos().powf(n);
        // The wider the angle the less is left there.
        assert!(within("greatest") <= 0.5 && 0.5 <= within("least"), "{row:?}");
        let light = std::f64::consts::TAU / (n + 1.0);
        assert!((value(row, "integral") / light - 1.0).abs() < 1e-4, "{row:?}");
    }
    // 60 degrees, the one half-width that everybody knows, to a hundredth.
    let first = value(&rows[0], "half_width").to_degrees();
    assert_eq!(value(&rows[0], "n"), 1.0);
    assert!((first - 60.0).abs() < 0.6, "{first}");
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

/// 1.9: Whitted has none of the mirrored light; rays from the lamp, which know nothing of its image, bring
/// all of it, and find the mirror as large as it is seen from the lamp.
#[test]
fn indirect() {
    let rows = rows(&made("1.9"));
    let last = rows.last().expect("the most light rays");
    for row in &rows {
        if field(row, "method") == "Whitted" {
            assert_eq!(value(row, "mirrored_light"), 0.0);
        }
    }
    // A rectangle's solid angle, from its corners seen along its normal, 1.9 away.
    let corner = |x: f64, y: f64| (x * y / (1.9 * (x * x + y * y + 1.9 * 1.9).sqrt())).atan();
    let (x, y) = ([-0.1, 1.9], [-2.25, -0.85]);
    let exact = corner(x[1], y[1]) - corner(x[0], y[1]) - corner(x[1], y[0]) + corner(x[0], y[0]);
    // Means of 65536 light rays, whose standard deviations are below their means and below twice their
    // means: 5 deviations are a false alarm in a million.
    assert!((value(last, "solid_angle") / exact - 1.0).abs() < 5.0 / 256.0);
    assert!((value(last, "mirrored_light") - 1.0).abs() < 5.0 * 2.0 / 256.0);
}

/// 1.10, eq:ambient: in a sphere of reflectance ρ with its lamp in the centre, all light is 1 / (1 − ρ) times
/// the direct light; the constant and the paths know it each in its own way.
#[test]
fn diffuse() {
    let rows = rows(&made("1.10"));
    for (rho, total) in [("sphere 0.1", 10.0 / 9.0), ("sphere 0.5", 2.0), ("sphere 0.9", 10.0)] {
        let method = |name: &str| {
            let found = rows.iter().rfind(|row| field(row, "method") == name);
            value(found.expect("a method"), rho)
        };
        assert!((method("Whitted without I_a") - 1.0).abs() < 1e-7);
        assert!((method("Whitted with the best I_a") / total - 1.0).abs() < 1e-7);
        // 65536 paths whose numbers of surfaces have a relative deviation below 1.
        assert!((method("random paths") / total - 1.0).abs() < 5.0 / 256.0);
    }
}

/// 1.8, algo:lr and eq:recursion: a ray that is not followed only takes light, so that depth and weight
/// approach the whole tree from below and at a growing price; roulette's mean is right, with a false alarm in
/// a million by Student's t of 31 degrees of freedom.
#[test]
fn pruning() {
    let rows = rows(&made("1.8"));
    for curve in rows.chunk_by(|a, b| field(a, "method") == field(b, "method")) {
        let rule = field(&curve[0], "method");
        for pair in curve.windows(2) {
            assert!(value(&pair[1], "rays") >= value(&pair[0], "rays"), "{pair:?}");
            if rule != "roulette" {
                assert!(value(&pair[1], "RMSE") <= value(&pair[0], "RMSE"), "{pair:?}");
                let (before, after) = (value(&pair[0], "bias"), value(&pair[1], "bias"));
                // The reference itself lacks the rays of weights below 10⁻⁶, which a deep tree has.
                assert!(before <= after && after < 1e-6, "{pair:?}");
            }
        }
        if rule == "roulette" {
            assert!(value(&curve[0], "z").abs() < 6.08);
        }
    }
    // 14 rays of the weight are worth more than the depth's 16 among the glass balls.
    let error = |method: &str, knob: &str| {
        let row = rows.iter().find(|row| {
            [field(row, "scene"), field(row, "method"), field(row, "knob")]
                == ["27 glass balls", method, knob]
        });
        let row = row.expect("a row");
        (value(row, "rays"), value(row, "RMSE"))
    };
    let (depth, weight) = (error("depth", "4"), error("weight", "0.05"));
    assert!(weight.0 < depth.0 && weight.1 < 0.2 * depth.1);
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

/// 1.13: both indexes answer the same rays; brute force tests every primitive for a ray that nothing stops,
/// and the hierarchy far fewer where there are many.
#[test]
fn where_time_goes() {
    let rows = rows(&made("1.13"));
    let linear: Vec<_> = rows.iter().filter(|row| field(row, "index") == "linear").collect();
    assert!(linear.len() >= 6);
    for brute in linear {
        let tree = rows.iter().find(|row| {
            field(row, "index") == "obvhs-bvh2"
                && field(row, "scene") == field(brute, "scene")
                && field(row, "primitives") == field(brute, "primitives")
        });
        let tree = tree.expect("the same picture by the hierarchy");
        assert_eq!(field(tree, "rays"), field(brute, "rays"));
        let (n, rays) = (value(brute, "primitives"), value(brute, "rays"));
        let tests = value(brute, "primitive_tests");
        // Of a picture's rays a half at most are shadow rays that something stops before the last primitive.
        assert!(0.5 * n * rays <= tests && tests <= n * rays, "{brute:?}");
        assert_eq!(field(brute, "box_tests"), "0");
        if n > 500.0 {
            let work = value(tree, "box_tests") + value(tree, "primitive_tests");
            assert!(work < 0.1 * tests, "{tree:?}");
        }
    }
}

/// 1.14, algo:lr, eq:ambient and eq:local: from where the camera stood all is known, and less the farther it
/// moves; diffuse light does not depend on the eye; every pixel's ray is traced all the same.
#[test]
fn image_space() {
    let rows = rows(&made("1.14"));
    let (width, pixels) = (64.0, 64.0 * 48.0);
    for motion in ["to the side", "turned"] {
        let rows: Vec<_> = rows.iter().filter(|row| field(row, "motion") == motion).collect();
        // From where the camera stood everything is held, and its own rays are all there are.
        for whole in ["seen", "held"] {
            assert_eq!(value(rows[0], whole), value(rows[0], "points"));
        }
        assert_eq!(value(rows[0], "shadow_rays_held"), value(rows[0], "shadow_rays"));
        for row in &rows {
            // The room is closed: a pixel's ray meets a matte surface or the mirror.
            assert!(value(row, "points") < pixels && value(row, "points") > 0.8 * pixels);
            assert!(value(row, "held") <= value(row, "seen"));
            assert!(value(row, "rays") >= pixels + value(row, "shadow_rays"), "{row:?}");
        }
        // At least a column comes into the picture for each pixel of the step.
        for row in &rows[1..] {
            let share = value(row, "seen") / value(row, "points");
            assert!(share <= 1.0 - 0.9 * value(row, "pixels") / width, "{row:?}");
        }
    }
}
