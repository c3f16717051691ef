//! Draws one of each: `cargo run -p lancer-figure --example gallery -- FOLDER`.
//!
//! The numbers are invented; what is looked at is the drawing.

use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

use lancer_figure::{
    ACCENT, Axis, BarChart, Chart, CurvePoint, Drawing, Entry, FAINT, HeatScale, INK, Inset, LABEL,
    METHODS, MUTED, MethodCurve, Montage, Pen, Picture, Plate, Row, Series, SpeedError, Spread,
    Stroke, Style, Table, Text, Tile, Tree, category_color, index_html, method_color,
};

fn main() -> std::io::Result<()> {
    let Some(folder) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("usage: gallery FOLDER");
        std::process::exit(2);
    };
    std::fs::create_dir_all(&folder)?;
    let plates =
        [montage(), speed_error(), crowded(), optics(), ray_tree(), bars(), scatter(), palette()];
    let mut entries = Vec::new();
    for (i, plate) in plates.iter().enumerate() {
        let canvas = plate.canvas();
        for fault in canvas.faults() {
            eprintln!("{}: {fault:?}", plate.id());
        }
        let png = canvas.to_png(1.0);
        write(&folder, &format!("{}.png", plate.id()), &png)?;
        write(&folder, &format!("{}.svg", plate.id()), canvas.to_svg().as_bytes())?;
        let chapter = if i < 3 { "Pictures and charts" } else { "Diagrams and the rest" };
        entries.push(Entry::of(plate, chapter, 0.1, png).file("data.csv"));
    }
    let mut table = Table::new(["method", "samples", "rmse"]);
    for curve in curves() {
        for point in curve.points {
            table.push([curve.label.as_str().into(), point.knob.into(), point.error.into()]);
        }
    }
    write(&folder, "data.csv", table.to_csv().as_bytes())?;
    write(&folder, "index.html", index_html("Lancer: a gallery of plates", &entries).as_bytes())
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> std::io::Result<()> {
    std::fs::write(folder.join(name), bytes)
}

/// A ball's soft shadow on a checker, with noise of the given strength.
fn picture(noise: f64) -> Picture {
    let mut state = 1_u32;
    Picture::from_fn(240, 160, move |x, y| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let random = f64::from(state >> 8) / f64::from(1 << 24) - 0.5;
        let (u, v) = (f64::from(x) - 120.0, f64::from(y) - 62.0);
        let checker = if (x / 20 + y / 20) % 2 == 0 { 0.85 } else { 0.6 };
        let shadow = ((u * u + 4.0 * (v - 48.0).powi(2)).sqrt() / 75.0 - 0.35).clamp(0.12, 1.0);
        let facing = 1.0 - (u * u + v * v) / 1600.0;
        let grain = noise * random * (1.0 - shadow);
        let light =
            if facing > 0.0 { 0.15 + 0.8 * facing.sqrt() } else { checker * shadow + grain };
        [light, light * 0.96, light * 0.88].map(|c| (c.clamp(0.0, 1.0).sqrt() * 255.0) as u8)
    })
}

fn error_map(scale: &HeatScale, noise: f64) -> Picture {
    let (noisy, clean) = (picture(noise), picture(0.0));
    let pixels = (0..160).flat_map(|y| (0..240).map(move |x| (x, y)));
    let error =
        |(x, y)| (f64::from(noisy.get(x, y)[1]) - f64::from(clean.get(x, y)[1])).abs() / 255.0;
    scale.paint(240, 160, &pixels.map(error).collect::<Vec<_>>())
}

fn montage() -> Plate {
    let scale = HeatScale::log("|error|", 1e-3, 1.0);
    let pictures = Montage::new()
        .tile(
            Tile::new("Reference", picture(0.0))
                .subtitle("closed form")
                .color(method_color("reference")),
        )
        .tile(
            Tile::new("Distributed, 16 rays", picture(0.9))
                .subtitle("relMSE 2.1×10⁻², 6.1 M rays, 3.2 s")
                .color(method_color("distributed")),
        )
        .tile(
            Tile::new("Shadow beams", picture(0.03))
                .subtitle("relMSE 4.0×10⁻⁶, 0.7 M tests, 0.4 s")
                .color(method_color("precise")),
        )
        .inset(Inset::new(40, 70, 36, 24))
        .inset(Inset::new(150, 90, 36, 24));
    let maps = Montage::new()
        .tile(
            Tile::new("Distributed: where the error is", error_map(&scale, 0.9))
                .color(method_color("distributed")),
        )
        .tile(
            Tile::new("Shadow beams: where the error is", error_map(&scale, 0.03))
                .color(method_color("precise")),
        )
        .color_bar(&scale);
    described(
        Plate::new(
            "2.9",
            "Penumbra: rays against shadow beams",
            "Shadow beams show no noise: at equal time \
            their error is 5000 times below that of 16 distributed rays.",
            true,
        )
        .panel(pictures)
        .panel(maps),
    )
}

fn described(plate: Plate) -> Plate {
    plate
        .note("Method", "eq:local, eq:attenuation; the area light is a square of side 1, the receiver a plane. \
            Every picture is exposed alike; difference pictures share the printed scale.")
        .note("Settings", "240×160, 1 sample a pixel for visibility, n = 1, 4, 16, 64, 256 light samples, seed 1999")
        .note("Reference", "closed form of the polygon’s irradiance; residual error 3×10⁻¹²")
        .note("Machine", "2 cores, AVX2; median of 5 runs, bars from least to greatest")
        .note("Command", "cargo xtask figures 2.9")
}

fn curves() -> Vec<MethodCurve> {
    let curve =
        |method: &str, label: &str, cost: f64, error: f64, slope: f64, knobs: &[u32]| MethodCurve {
            color: method_color(method),
            label: label.into(),
            points: knobs
                .iter()
                .map(|&knob| {
                    let n = f64::from(knob);
                    let seconds = cost * n * 2e-6;
                    CurvePoint {
                        knob: knob.to_string(),
                        seconds: Spread { low: seconds * 0.9, mid: seconds, high: seconds * 1.25 },
                        work: (cost * n) as u64,
                        error: error * n.powf(slope),
                    }
                })
                .collect(),
        };
    vec![
        curve("distributed", "distributed", 4e4, 0.3, -0.5, &[1, 4, 16, 64, 256]),
        curve("path", "path tracing", 9e4, 0.5, -0.5, &[1, 4, 16, 64, 256]),
        curve("cones", "cones", 6e4, 0.08, -0.2, &[1, 2, 4, 8]),
        curve("pyramids", "pyramids", 7e4, 0.05, -0.6, &[1, 2, 4, 8, 16]),
        curve("precise", "precise beams", 2e5, 0.002, -1.0, &[1, 2, 4, 8, 16]),
    ]
}

fn speed_error() -> Plate {
    let chart =
        curves().into_iter().fold(SpeedError::new("intersection tests", "RMSE"), SpeedError::curve);
    let chart = chart.slope(-0.5, "slope −1/2").reference_error(3e-5);
    described(
        Plate::new(
            "2.12",
            "Speed against error",
            "Beams reach the error of 256 distributed rays in 1/9 of \
            the counted tests, but lose above 100 000 triangles.",
            false,
        )
        .panel(chart),
    )
}

fn crowded() -> Plate {
    let names =
        ["linear", "grid", "octree", "kd", "bsp", "bvh", "obvhs-bvh2", "obvhs-cwbvh", "wide"];
    let sizes = [1e2, 1e3, 1e4, 1e5, 1e6];
    let chart = names.iter().enumerate().fold(
        Chart::new(Axis::log("triangles"), Axis::log("tests per ray"))
            .title("Nine indexes, nearly equal"),
        |chart, (i, name)| {
            let grows = if i == 0 { 1.0 } else { 0.12 + 0.004 * i as f64 };
            let points = sizes.map(|n: f64| (n, (1.0 + 0.03 * i as f64) * n.powf(grows)));
            chart.series(Series::new(*name, method_color(name)).points(points))
        },
    );
    let zero = Chart::new(Axis::log("scene scale"), Axis::log("share of wrong shadows"))
        .title("A zero on a log axis")
        .series(Series::new("fixed ε", method_color("naive")).points((-3..=6).map(|k| {
            let scale = 10f64.powi(k);
            (scale, (0.002 * (f64::from(k) - 1.0).powi(2) - 0.003).max(0.0))
        })))
        .series(
            Series::new("bounded offset", category_color(0))
                .points((-3..=6).map(|k| (10f64.powi(k), 0.0))),
        )
        .vertical(1.0, "ε chosen here");
    described(
        Plate::new(
            "4.7",
            "All structures",
            "Every structure needs fewer than 12 tests per ray at a million \
            triangles.",
            true,
        )
        .panel(Row::new().panel(1.0, chart).panel(1.0, zero)),
    )
}

fn refraction(pen: &mut Pen<'_>) {
    pen.polygon(
        &[[-2.2, 0.0], [2.2, 0.0], [2.2, -1.4], [-2.2, -1.4]],
        Style::fill(FAINT.with_alpha(110)),
    );
    pen.surface([-2.2, 0.0], [2.2, 0.0]);
    pen.line(&[[0.0, -1.3], [0.0, 1.5]], Stroke::new(MUTED, 1.5).dashed(7.0, 5.0));
    let (incident, refracted) = (0.8_f64, (0.8_f64.sin() / 1.5).asin());
    let whitted = method_color("whitted");
    pen.arrow([-1.7 * incident.sin(), 1.7 * incident.cos()], [0.0, 0.0], Stroke::new(whitted, 3.5));
    pen.arrow(
        [0.0, 0.0],
        [1.4 * incident.sin(), 1.4 * incident.cos()],
        Stroke::new(category_color(4), 3.5),
    );
    pen.arrow(
        [0.0, 0.0],
        [1.4 * refracted.sin(), -1.4 * refracted.cos()],
        Stroke::new(category_color(3), 3.5),
    );
    pen.angle([0.0, 0.0], FRAC_PI_2, FRAC_PI_2 + incident, 74.0, "θ₁", whitted);
    pen.angle([0.0, 0.0], FRAC_PI_2 - incident, FRAC_PI_2, 60.0, "θ₁", category_color(4));
    pen.angle([0.0, 0.0], -FRAC_PI_2, -FRAC_PI_2 + refracted, 78.0, "θ₂", category_color(3));
    pen.dot([0.0, 0.0], 5.0, INK);
    pen.label([0.0, 1.5], [22.0, -4.0], Text::new("n", LABEL).bold());
    pen.label([-1.9, 0.0], [0.0, 22.0], Text::new("n₁ = 1", LABEL));
    pen.label([-1.9, 0.0], [0.0, -36.0], Text::new("n₂ = 1.5", LABEL));
    pen.label(
        [-1.7 * incident.sin(), 1.7 * incident.cos()],
        [-10.0, 16.0],
        Text::new("rayon incident", LABEL),
    );
}

fn optics() -> Plate {
    let reflectance = |n: f64| {
        move |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let inner = (1.0 - (sin / n).powi(2)).max(0.0).sqrt();
            let (s, p) =
                ((cos - n * inner) / (cos + n * inner), (n * cos - inner) / (n * cos + inner));
            (degrees, (s * s + p * p) / 2.0)
        }
    };
    let curve = |label: &str, color: usize, n: f64| {
        Series::new(label, category_color(color))
            .points((0..=90).map(|d| reflectance(n)(f64::from(d))))
            .curve()
    };
    let chart = Chart::new(
        Axis::linear("θ₁ (degrees)").between(0.0, 90.0),
        Axis::linear("reflected share").between(0.0, 1.0),
    )
    .title("How much is reflected")
    .series(curve("n = 1.33", 0, 1.33))
    .series(curve("n = 2.4", 3, 2.4))
    .vertical(56.3, "Brewster, n = 1.5");
    described(
        Plate::new(
            "1.5",
            "Descartes: le rayon réfracté",
            "n₁ sin θ₁ = n₂ sin θ₂ to rounding, and total \
            reflection gives no ray.",
            true,
        )
        .panel(
            Row::new()
                .panel(1.2, Drawing::new([-2.2, -1.4], [2.2, 1.6], 520.0, refraction))
                .panel(1.0, chart),
        ),
    )
}

fn ray_tree() -> Plate {
    let (eye, reflected, refracted, shadow) =
        (ACCENT, method_color("whitted"), method_color("distributed"), method_color("naive"));
    let glass = Tree::new("glass back", refracted)
        .child("T  0.72", Tree::new("floor", refracted).child("S", Tree::new("light", shadow)))
        .child("R  0.03", Tree::new("pruned", shadow));
    let mirror = Tree::new("mirror", reflected)
        .child("R  0.08", Tree::new("sky", reflected))
        .child("S", Tree::new("blocked", shadow));
    let tree = Tree::new("eye ray: glass front", eye)
        .child("R  0.08", mirror)
        .child("T  0.90", glass)
        .child("S", Tree::new("light", shadow));
    described(
        Plate::new(
            "1.6",
            "The tree of one pixel’s rays",
            "The tree has exactly as many nodes as rays were \
            traced: 9.",
            true,
        )
        .panel(tree),
    )
}

fn bars() -> Plate {
    let scenes = ["stadium with teapot", "hall of mirrors", "plaster room"];
    let grouped = BarChart::new("tests per ray", scenes)
        .title("Grouped")
        .series("grid", method_color("grid"), [310.0, 64.5, 22.1])
        .series("kd-tree", method_color("kd"), [17.2, 21.0, 11.9])
        .series("bounding volumes", method_color("bvh"), [14.3, 19.5, 12.6]);
    let stacked = BarChart::new("share of the time (%)", scenes)
        .title("Stacked")
        .series("intersection", category_color(0), [91.0, 84.0, 77.0])
        .series("shading", category_color(1), [6.0, 11.0, 15.0])
        .series("the rest", category_color(2), [3.0, 5.0, 8.0])
        .stacked();
    described(
        Plate::new(
            "1.13",
            "Where time goes",
            "At least 75 % of the time goes into intersections (Whitted’s \
            own claim).",
            true,
        )
        .panel(Row::new().panel(1.0, grouped).panel(1.0, stacked)),
    )
}

fn scatter() -> Plate {
    let cloud = |label: &str, color: usize, slope: f64| {
        (0..40).fold(Series::new(label, category_color(color)).scatter(), |series, i| {
            let x = 10.0 + f64::from(i * 7 % 40);
            let y = slope * x + 6.0 * f64::from(i * 13 % 17) / 17.0;
            let spread = Spread { low: y - 1.5, mid: y, high: y + 2.0 };
            if i % 8 == 0 { series.point(x, spread) } else { series.point(x, y) }
        })
    };
    let chart = Chart::new(
        Axis::linear("predicted cost (SAH)").include(0.0),
        Axis::linear("measured tests per ray"),
    )
    .series(cloud("middle split", 1, 1.2))
    .series(cloud("surface area split", 0, 0.7))
    .horizontal(40.0, "brute force on the small scene")
    .slope(1.0, "slope 1");
    let map = Montage::new()
        .tile(Tile::new("One large picture", picture(0.4)).subtitle("details at the right"))
        .inset(Inset::new(60, 85, 32, 22))
        .inset(Inset::new(130, 85, 32, 22))
        .inset(Inset::new(105, 40, 32, 22))
        .insets_right();
    described(
        Plate::new(
            "4.4",
            "What the heuristic predicts",
            "Predicted and measured cost correlate above 0.9 on \
            every scene.",
            true,
        )
        .panel(Row::new().panel(1.0, chart).panel(1.1, map)),
    )
}

fn palette() -> Plate {
    let drawing = Drawing::new([0.0, 0.0], [14.0, 4.4], 400.0, |pen| {
        for (i, (name, color)) in METHODS.iter().enumerate() {
            let (x, y) = (0.2 + 3.5 * (i % 4) as f64, 4.0 - 0.8 * (i / 4) as f64);
            pen.line(&[[x, y], [x + 1.0, y]], Stroke::new(*color, 8.0));
            let at = pen.at([x + 1.2, y]);
            pen.canvas()
                .text([at[0], at[1] + 7.0], Text::new(*name, LABEL).bold().color(color.for_text()));
        }
    });
    Plate::new(
        "0.0",
        "One colour per method in the whole course",
        "No two methods shown together look alike, \
        to the colour-blind neither.",
        true,
    )
    .panel(drawing)
    .note("Palette", "Okabe and Ito 2008, and an indigo")
}
