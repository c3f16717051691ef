//! 1.5: the law of refraction, its critical angle, and what is left of it in 32 bits.

use glam::{DVec3, Vec3};
use lancer_core::optics::{reflect, refract};
use lancer_figure::{
    Axis, Chart, Drawing, Effort, Finished, INK, LABEL, MUTED, Pen, Plate, Row, Series, Stroke,
    Table, Text, category_color, number,
};

/// Pairs of refractive indices (n₁, n₂) and their names.
const MEDIA: [(f64, f64, &str); 5] = [
    (1.0, 1.5, "air to glass"),
    (1.0, 4.0 / 3.0, "air to water"),
    (1.0, 2.42, "air to diamond"),
    (4.0 / 3.0, 1.0, "water to air"),
    (1.5, 1.0, "glass to air"),
];

pub fn make(effort: Effort) -> Finished {
    let steps = effort.pick(90, 900);
    let mut data =
        Table::new(["n1", "n2", "degrees_in", "degrees_out", "law_error_f64", "law_error_f32"]);
    let mut curves = Chart::new(
        Axis::linear("angle in, θ₁ (degrees)").between(0.0, 90.0),
        Axis::linear("angle out, θ₂ (degrees)").between(0.0, 90.0),
    )
    .title("n₁ sin θ₁ = n₂ sin θ₂")
    .height(560.0);
    let mut largest = 0.0_f64;
    let mut total_is_right = true;
    for (k, &(n1, n2, name)) in MEDIA.iter().enumerate() {
        let mut points = Vec::new();
        for step in 0..steps {
            let degrees = 90.0 * f64::from(step) / f64::from(steps);
            let incident = arriving(degrees);
            let sine = incident.x;
            let out = refract(incident, DVec3::Y, n1, n2);
            total_is_right &= out.is_none() == (n1 * sine > n2);
            let errors = out.map(|t| {
                points.push((degrees, angle(t)));
                (law_error(incident, t, n1, n2), f32_law_error(incident, n1, n2))
            });
            largest = largest.max(errors.map_or(0.0, |(f64_error, _)| f64_error));
            let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN).into();
            data.push([
                n1.into(),
                n2.into(),
                degrees.into(),
                or_nan(out.map(angle)),
                or_nan(errors.map(|(f64_error, _)| f64_error)),
                or_nan(errors.map(|(_, f32_error)| f32_error)),
            ]);
        }
        curves = curves.series(Series::new(name, category_color(k)).points(points).curve());
        if n1 > n2 {
            let critical = (n2 / n1).asin().to_degrees();
            curves = curves.vertical(critical, format!("critical {critical:.2}°"));
        }
    }
    let (near, near_data_holds) = near_critical();

    let holds = largest <= 4.0 * f64::EPSILON && total_is_right && near_data_holds;
    let claim = format!(
        "n₁ sin θ₁ = n₂ sin θ₂ to {} at every angle, and beyond the critical angle there is \
         no refracted ray: all of it is reflected.",
        number(largest)
    );
    let plate = Plate::new("1.5", "Descartes' law and total reflection", claim, holds)
        .panel(Row::new().panel(1.0, interface()).panel(1.0, curves))
        .panel(near)
        .note("Method", "eq:descartes and eq:reflected-ray on unit vectors; sin θ is read off the directions")
        .note("Near the critical angle", "cos θ₂ = √(1 − (n₁/n₂)² sin² θ₁) is infinitely sensitive there: no \
             formula helps, only digits do. The error is that of the direction against asin in f64 of \
             the exact angle; f32 is the same formula in 32 bits, from the rounded incident direction")
        .note("Reference", "Descartes' law itself; the critical angles are asin(n₂/n₁)");
    Finished { plate, data }
}

/// A unit direction that comes down onto a surface with normal +y.
fn arriving(degrees: f64) -> DVec3 {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    DVec3::new(sine, -cosine, 0.0)
}

/// The angle of a direction from −y, in degrees.
fn angle(direction: DVec3) -> f64 {
    direction.x.atan2(-direction.y).to_degrees()
}

/// |n₁ sin θ₁ − n₂ sin θ₂|.
fn law_error(incident: DVec3, transmitted: DVec3, n1: f64, n2: f64) -> f64 {
    (n1 * incident.x - n2 * transmitted.x).abs()
}

/// The refracted direction in 32 bits.
fn refract_f32(incident: Vec3, n1: f32, n2: f32) -> Option<Vec3> {
    let eta = n1 / n2;
    let cos1 = -incident.y;
    let cos2_squared = 1.0 - eta * eta * (1.0 - cos1) * (1.0 + cos1);
    (cos2_squared >= 0.0).then(|| eta * incident + (eta * cos1 - cos2_squared.sqrt()) * Vec3::Y)
}

fn f32_law_error(incident: DVec3, n1: f64, n2: f64) -> f64 {
    refract_f32(incident.as_vec3(), n1 as f32, n2 as f32)
        .map_or(f64::NAN, |t| (n1 * incident.x - n2 * f64::from(t.x)).abs())
}

/// The error of cos θ₂ from glass to air, by the distance from the critical angle; and whether `f64`
/// keeps at least six digits down to a nanoradian.
fn near_critical() -> (Chart, bool) {
    let (n1, n2) = (1.5_f64, 1.0);
    let critical = (n2 / n1).asin();
    let mut wide = Series::new("f64", category_color(2));
    let mut narrow = Series::new("f32", category_color(3));
    let mut holds = true;
    for k in 4..=36 {
        let before = 10.0_f64.powf(-0.25 * f64::from(k));
        // cos θ₂ without cancellation: n₁² (sin² θc − sin² θ₁) = n₁² sin(θc + θ₁) sin(θc − θ₁).
        let exact = n1 * ((2.0 * critical - before).sin() * before.sin()).sqrt();
        let incident = arriving((critical - before).to_degrees());
        let relative = |cosine: f64| (cosine / exact - 1.0).abs();
        if let Some(t) = refract(incident, DVec3::Y, n1, n2) {
            wide = wide.point(before, relative(-t.y));
            holds &= before < 1e-9 || relative(-t.y) < 1e-6;
        }
        if let Some(t) = refract_f32(incident.as_vec3(), n1 as f32, n2 as f32) {
            narrow = narrow.point(before, relative(f64::from(-t.y)));
        }
    }
    let chart = Chart::new(
        Axis::log("before the critical angle (radians)"),
        Axis::log("relative error of cos θ₂"),
    )
    .title("Glass to air, towards the critical angle")
    .height(420.0)
    .series(narrow)
    .series(wide);
    (chart, holds)
}

/// Rays from a point in glass to its surface: some pass, the others are all reflected.
fn interface() -> Drawing {
    let draw = |pen: &mut Pen<'_>| {
        let (n1, n2) = (1.5, 1.0);
        let glass = category_color(4).with_alpha(70);
        pen.polygon(
            &[[-1.6, 0.0], [3.4, 0.0], [3.4, -1.6], [-1.6, -1.6]],
            lancer_figure::Style::fill(glass),
        );
        pen.line(&[[-1.6, 0.0], [3.4, 0.0]], Stroke::new(INK, 2.5));
        let source = [-1.0, -1.3];
        for (degrees, label) in
            [(0.0, ""), (20.0, "20°"), (35.0, "35°"), (50.0, "50°"), (62.0, "62°")]
        {
            let up = DVec3::new(arriving(degrees).x, -arriving(degrees).y, 0.0);
            let foot = [source[0] + up.x / up.y * 1.3, 0.0];
            let stroke = |color| Stroke::new(color, 3.0);
            pen.line(&[source, foot], stroke(MUTED));
            let along = |d: DVec3, length: f64| [foot[0] + length * d.x, foot[1] + length * d.y];
            match refract(up, DVec3::NEG_Y, n1, n2) {
                Some(t) => pen.arrow(foot, along(t, 1.2), stroke(category_color(0))),
                None => {
                    let mirror = reflect(up, DVec3::NEG_Y);
                    pen.arrow(foot, along(mirror, 1.15), stroke(category_color(3)));
                }
            }
            if !label.is_empty() {
                let near_foot = [0.2 * source[0] + 0.8 * foot[0], 0.2 * source[1]];
                pen.label(near_foot, [0.0, 0.0], Text::new(label, LABEL));
            }
        }
        pen.dot(source, 7.0, INK);
        pen.label([2.7, 0.55], [0.0, 0.0], Text::new("air, n = 1", LABEL));
        pen.label([2.65, -1.35], [0.0, 0.0], Text::new("glass, n = 1.5", LABEL));
        pen.label(
            [0.35, 1.15],
            [0.0, 0.0],
            Text::new("refracted", LABEL).color(category_color(0).for_text()),
        );
        pen.label(
            [2.55, -0.3],
            [0.0, 0.0],
            Text::new("totally reflected", LABEL).color(category_color(3).for_text()),
        );
    };
    Drawing::new([-1.6, -1.6], [3.4, 1.4], 560.0, draw)
}
