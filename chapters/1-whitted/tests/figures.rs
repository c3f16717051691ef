//! Every figure of the chapter at its quick size: the claim holds, and the plate is legible.
//!
//! What the claims rest on (counts and errors) is the same on every machine; seconds are not looked at.

use chapter_1::figures::FIGURES;
use lancer_figure::{Figure, Finished, Record};

fn made(id: &str) -> Finished {
    Figure::proved(FIGURES, id)
}

/// The rows of a figure's data.
fn rows(finished: &Finished) -> Vec<Record> {
    finished.data.records()
}

#[test]
fn ids_and_names_are_unique() {
    Figure::prove_names(FIGURES);
}

/// 0.1, eq:ray-sphere: the stable form loses no sphere in 64 bits, the textbook's does in 32.
#[test]
fn quadratic() {
    let rows = rows(&made("0.1"));
    let lost = |name: &str| -> f64 {
        assert!(rows.iter().any(|row| row.text("solver") == name));
        rows.iter()
            .filter(|row| row.text("solver") == name)
            .map(|row| row.number("lost_of_96"))
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
            let here = row.number("scale") == 10.0_f64.powi(exponent);
            row.text("offset") == offset && row.number("sizes_away") == away && here
        });
        let row = row.unwrap_or_else(|| panic!("no row {offset} {away} {exponent}"));
        ["wrongly_dark", "wrongly_bright"].map(|column| row.number(column))
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
        let leaks = row.number("leaking rays (%)");
        match (row.text("method"), row.text("knob")) {
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
            ["question", "class", "form"].map(|c| row.text(c)) == [question, class, form]
        });
        let row = row.unwrap_or_else(|| panic!("no row {question} {class} {form}"));
        row.number("wrong") / row.number("rays")
    };
    for row in rows.iter().filter(|row| row.text("form") == "ours") {
        assert!(row.text("question") == "false hit" || row.number("wrong") == 0.0, "{row:?}");
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
        rows.iter().map(|row| (row.text("knob"), row.number("wrong per million"))).collect();
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
        let wrong = row.number("wrong_pixels_percent");
        assert_eq!(row.text("method").starts_with("rays"), wrong == 0.0, "{row:?}");
    }
    // A crossing of two strips is a parallelogram: the product of their widths over the sine between them.
    let percent_of_picture = 100.0 / 8.0;
    let crossing = 0.34 * 0.34 / (std::f64::consts::TAU / 6.0).sin() * percent_of_picture;
    let sheets = 0.5 * 0.72 * 0.72 / 1.4_f64.sin() * percent_of_picture;
    let with_crossings = |count: f64| {
        let orders = rows.iter().filter(|row| row.text("method") == "an order");
        let near = |wrong: f64| (wrong - count * crossing - sheets).abs() < 0.3;
        orders.filter(|row| near(row.number("wrong_pixels_percent"))).count()
    };
    assert_eq!((with_crossings(1.0), with_crossings(2.0)), (60, 60));
    // The painter looks only where its polygons are.
    let tests = |method: &str| -> Vec<f64> {
        let rows = rows.iter().filter(|row| row.text("method") == method);
        rows.map(|row| row.number("tests")).collect()
    };
    let (painter, tree) = (tests("painter: centroid"), tests("rays: tree"));
    assert!(painter.iter().zip(&tree).all(|(painter, tree)| painter < tree));
}

/// 1.2, eq:local and eq:ambient: every term has its sign, and shadows take no more than the lights gave.
#[test]
fn local_model() {
    let means: Vec<f64> =
        rows(&made("1.2")).iter().map(|row| row.number("mean_radiance")).collect();
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
            (row.text("lamp"), row.number("distance"), row.number("points"))
                == (lamp, distance, points)
        });
        found.expect("a row")
    };
    assert!((at("point", 64.0, 1.0).number("radiance") * 4096.0 - 1.0).abs() < 1e-13);
    let square = at("square", 1.0, 1.0);
    let exact = 0.752274688454107 / std::f64::consts::PI;
    assert!((square.number("exact") / exact - 1.0).abs() < 1e-13);
    assert!((square.number("radiance") * std::f64::consts::PI - 1.0).abs() < 1e-12);
    assert!(at("square", 1.0, 4.0).number("error") < 0.3 * square.number("error"));
}

/// 1.3, eq:local: the widths of the closed form, (cos θ)ⁿ = ½, are within what the pictures allow, and the
/// light in the highlight is 2π/(n + 1).
#[test]
fn exponent() {
    let rows = rows(&made("1.3"));
    assert_eq!(rows.len(), 7);
    for row in &rows {
        let n = row.number("n");
        let within = |angle: &str| row.number(angle).cos().powf(n);
        // The wider the angle the less is left there.
        assert!(within("greatest") <= 0.5 && 0.5 <= within("least"), "{row:?}");
        let light = std::f64::consts::TAU / (n + 1.0);
        assert!((row.number("integral") / light - 1.0).abs() < 1e-4, "{row:?}");
    }
    // 60 degrees, the one half-width that everybody knows, to a hundredth.
    let first = rows[0].number("half_width").to_degrees();
    assert_eq!(rows[0].number("n"), 1.0);
    assert!((first - 60.0).abs() < 0.6, "{first}");
}

/// 1.5, eq:descartes at the table's own angles.
#[test]
fn descartes() {
    let finished = made("1.5");
    let out = |n1: f64, n2: f64, degrees: f64| {
        let rows = rows(&finished);
        let row = rows.iter().find(|row| {
            (row.number("n1"), row.number("n2"), row.number("degrees_in")) == (n1, n2, degrees)
        });
        row.expect("a row").number("degrees_out")
    };
    assert!((out(1.0, 1.5, 30.0) - 19.4712206344907).abs() < 1e-12);
    assert!((out(1.0, 1.5, 60.0) - 35.2643896827547).abs() < 1e-12);
    assert!(out(1.5, 1.0, 41.0) > 79.0 && out(1.5, 1.0, 42.0).is_nan());
}

/// 1.6, fig:ray-tree: each node's weight is its parent's times the share on the edge.
#[test]
fn ray_tree() {
    let rows = rows(&made("1.6"));
    assert!(rows.len() >= 8 && rows[0].text("kind") == "primary");
    for row in &rows[1..] {
        let parent = &rows[row.number("parent") as usize];
        assert_eq!(row.number("depth"), parent.number("depth") + 1.0);
        assert!(row.number("weight") < parent.number("weight"));
        let share = row.number("weight") / parent.number("weight");
        let of_glass = if row.text("kind") == "refracted" { 0.9 } else { 0.1 };
        if parent.text("end") == "glass" {
            assert!((share - of_glass).abs() < 1e-12);
        }
    }
    let ends: Vec<&str> = rows.iter().map(|row| row.text("end")).collect();
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
        |name: &str| -> Vec<_> { rows.iter().filter(|row| row.text("method") == name).collect() };
    let (black, background) = (curve("black"), curve("background"));
    for pair in black.windows(2) {
        assert!(pair[1].number("rays") > pair[0].number("rays"));
        assert!(pair[1].number("mean_abs") < pair[0].number("mean_abs"));
    }
    for (a, b) in black.iter().zip(&background) {
        assert_eq!(a.text("rays"), b.text("rays"));
        assert_eq!(a.text("weight_left"), b.text("weight_left"));
    }
}

/// 1.9: Whitted has none of the mirrored light; rays from the lamp, which know nothing of its image, bring
/// all of it, and find the mirror as large as it is seen from the lamp.
#[test]
fn indirect() {
    let rows = rows(&made("1.9"));
    let last = rows.last().expect("the most light rays");
    for row in &rows {
        if row.text("method") == "Whitted" {
            assert_eq!(row.number("mirrored_light"), 0.0);
        }
    }
    // A rectangle's solid angle, from its corners seen along its normal, 1.9 away.
    let corner = |x: f64, y: f64| (x * y / (1.9 * (x * x + y * y + 1.9 * 1.9).sqrt())).atan();
    let (x, y) = ([-0.1, 1.9], [-2.25, -0.85]);
    let exact = corner(x[1], y[1]) - corner(x[0], y[1]) - corner(x[1], y[0]) + corner(x[0], y[0]);
    // Means of 65536 light rays, whose standard deviations are below their means and below twice their
    // means: 5 deviations are a false alarm in a million.
    assert!((last.number("solid_angle") / exact - 1.0).abs() < 5.0 / 256.0);
    assert!((last.number("mirrored_light") - 1.0).abs() < 5.0 * 2.0 / 256.0);
}

/// 1.10, eq:ambient: in a sphere of reflectance ρ with its lamp in the centre, all light is 1 / (1 − ρ) times
/// the direct light; the constant and the paths know it each in its own way.
#[test]
fn diffuse() {
    let rows = rows(&made("1.10"));
    for (rho, total) in [("sphere 0.1", 10.0 / 9.0), ("sphere 0.5", 2.0), ("sphere 0.9", 10.0)] {
        let method = |name: &str| {
            let found = rows.iter().rfind(|row| row.text("method") == name);
            found.expect("a method").number(rho)
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
    for curve in rows.chunk_by(|a, b| a.text("method") == b.text("method")) {
        let rule = curve[0].text("method");
        for pair in curve.windows(2) {
            assert!(pair[1].number("rays") >= pair[0].number("rays"), "{pair:?}");
            if rule != "roulette" {
                assert!(pair[1].number("RMSE") <= pair[0].number("RMSE"), "{pair:?}");
                let (before, after) = (pair[0].number("bias"), pair[1].number("bias"));
                // The reference itself lacks the rays of weights below 10⁻⁶, which a deep tree has.
                assert!(before <= after && after < 1e-6, "{pair:?}");
            }
        }
        if rule == "roulette" {
            assert!(curve[0].number("z").abs() < 6.08);
        }
    }
    // 14 rays of the weight are worth more than the depth's 16 among the glass balls.
    let error = |method: &str, knob: &str| {
        let row = rows.iter().find(|row| {
            [row.text("scene"), row.text("method"), row.text("knob")]
                == ["27 glass balls", method, knob]
        });
        let row = row.expect("a row");
        (row.number("rays"), row.number("RMSE"))
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
            assert_eq!(pair[1].number("samples"), 4.0 * pair[0].number("samples"));
            assert!(pair[1].number("RMSE") < pair[0].number("RMSE"));
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
        let row = rows.iter().find(|row| row.text("method") == method && row.text("knob") == knob);
        row.expect("a row").number(column)
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
    let linear: Vec<_> = rows.iter().filter(|row| row.text("index") == "linear").collect();
    assert!(linear.len() >= 6);
    for brute in linear {
        let tree = rows.iter().find(|row| {
            row.text("index") == "obvhs-bvh2"
                && row.text("scene") == brute.text("scene")
                && row.text("primitives") == brute.text("primitives")
        });
        let tree = tree.expect("the same picture by the hierarchy");
        assert_eq!(tree.text("rays"), brute.text("rays"));
        let (n, rays) = (brute.number("primitives"), brute.number("rays"));
        let tests = brute.number("primitive_tests");
        // Of a picture's rays a half at most are shadow rays that something stops before the last primitive.
        assert!(0.5 * n * rays <= tests && tests <= n * rays, "{brute:?}");
        assert_eq!(brute.text("box_tests"), "0");
        if n > 500.0 {
            let work = tree.number("box_tests") + tree.number("primitive_tests");
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
        let rows: Vec<_> = rows.iter().filter(|row| row.text("motion") == motion).collect();
        // From where the camera stood everything is held, and its own rays are all there are.
        for whole in ["seen", "held"] {
            assert_eq!(rows[0].number(whole), rows[0].number("points"));
        }
        assert_eq!(rows[0].number("shadow_rays_held"), rows[0].number("shadow_rays"));
        for row in &rows {
            // The room is closed: a pixel's ray meets a matte surface or the mirror.
            assert!(row.number("points") < pixels && row.number("points") > 0.8 * pixels);
            assert!(row.number("held") <= row.number("seen"));
            assert!(row.number("rays") >= pixels + row.number("shadow_rays"), "{row:?}");
        }
        // At least a column comes into the picture for each pixel of the step.
        for row in &rows[1..] {
            let share = row.number("seen") / row.number("points");
            assert!(share <= 1.0 - 0.9 * row.number("pixels") / width, "{row:?}");
        }
    }
}

/// 1.15: by hand, the pixel (2, 1) of 9 × 6 is 2 pixels left of the middle of the film and 1.5 above it, and
/// a pixel is a sixth of 2 tan 25°.
#[test]
fn camera_frame() {
    let rows = rows(&made("1.15"));
    assert_eq!(rows.len(), 54);
    let row = rows.iter().find(|row| (row.number("x"), row.number("y")) == (2.5, 1.5));
    let pixel = 2.0 * 0.466307658154999 / 6.0;
    for (axis, wanted) in [("u", -2.0 * pixel), ("v", 1.5 * pixel), ("w", 1.0)] {
        assert!((row.expect("a row").number(axis) - wanted).abs() < 1e-14, "{axis}");
    }
}

/// 1.16, eq:ray-triangle: by hand, the sheared corners are (−1, −0.7), (−0.1, 1) and (1, −0.4), and the other ray
/// starts (0.8, 0.75) from there.
#[test]
fn edge_functions() {
    let rows = rows(&made("1.16"));
    let wanted = [("inside", [0.96, 1.1, 1.07]), ("outside", [-0.985, 2.36, 1.755])];
    for (row, (ray, areas)) in rows.iter().zip(wanted) {
        assert_eq!(row.text("ray"), ray);
        for (name, area) in ["e_a", "e_b", "e_c"].into_iter().zip(areas) {
            assert!((row.number(name) - area).abs() < 1e-14, "{ray} {name}");
        }
    }
    assert!((rows[0].number("t") - 5.46 / 3.13).abs() < 1e-14);
}

/// 1.17, eq:local: the cosines of the angles drawn, and no light from behind.
#[test]
fn directions() {
    let rows = rows(&made("1.17"));
    let cosine = |degrees: f64| degrees.to_radians().cos();
    let radiance = 0.5 * cosine(35.0) + 0.5 * cosine(38.0).powi(10);
    let wanted =
        [[cosine(35.0), cosine(38.0), cosine(19.0), radiance], [-0.8, 0.352, f64::NAN, 0.0]];
    for (row, wanted) in rows.iter().zip(wanted) {
        for (name, wanted) in ["n_l", "r_v", "n_h", "radiance"].into_iter().zip(wanted) {
            let apart = (row.number(name) - wanted).abs();
            assert!(wanted.is_nan() || apart < 1e-14, "{row:?} {name}");
        }
    }
    assert_eq!(rows.len(), 2);
}

/// 1.18, eq:descartes: n sin θ is the same in air, glass and water; none leaves glass at 55°.
#[test]
fn refraction() {
    let rows = rows(&made("1.18"));
    let sine = 50.0_f64.to_radians().sin();
    let wanted = [
        ("air", "glass", 1.5, sine / 1.5),
        ("glass", "air", 1.0 / 1.5, f64::NAN),
        ("glass", "water", 1.33 / 1.5, sine / 1.33),
        ("air", "water", 1.33, sine / 1.33),
    ];
    assert_eq!(rows.len(), wanted.len());
    for (row, (from, to, index, sine)) in rows.iter().zip(wanted) {
        assert_eq!((row.text("from"), row.text("to")), (from, to));
        assert!((row.number("relative_index") - index).abs() < 1e-15);
        let out = row.number("degrees_out").to_radians().sin();
        assert!((out - sine).abs() < 1e-14 || out.is_nan() && sine.is_nan(), "{row:?}");
    }
}
