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
    let mut data = Table::new(["n1", "n2", "degrees_in", "degrees_out", "error_f64", "error_f32"]);
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
            let out = refract(incident, NORMAL, n1, n2);
            total_is_right &= out.is_none() == (n1 * sine(incident) > n2);
            let error = out.map(|t| law_error(incident, t, n1, n2));
            largest = largest.max(error.unwrap_or(0.0));
            points.extend(out.map(|t| (degrees, angle(t))));
            let narrow = refract_f32(incident.as_vec3(), n1 as f32, n2 as f32)
                .map(|t| law_error(incident, t.as_dvec3(), n1, n2));
            let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN).into();
            data.push([
                n1.into(),
                n2.into(),
                degrees.into(),
                or_nan(out.map(angle)),
                or_nan(error),
                or_nan(narrow),
            ]);
        }
        curves = curves.series(Series::new(name, category_color(k)).points(points).curve());
        if n1 > n2 {
            let critical = (n2 / n1).asin().to_degrees();
            curves = curves.vertical(critical, format!("critical {critical:.2}°"));
        }
    }
    let holds = largest <= 8.0 * f64::EPSILON && total_is_right;
    let claim = format!(
        "T is a unit vector in the plane of D and N with n₁ sin θ₁ = n₂ sin θ₂, to {} at every angle, and \
         there is none beyond the critical angle.",
        number(largest)
    );
    let plate = Plate::new("1.5", "Descartes' law and total reflection", claim, holds)
        .panel(Row::new().panel(1.0, interface()).panel(1.0, curves))
        .panel(near_critical(&mut data))
        .note("Method", "eq:descartes and eq:reflected-ray about a normal along no axis. The error is the largest \
             of | |T| − 1 | and | n₁ N×D − n₂ N×T |, which is Descartes' law with its plane")
        .note("Near the critical angle", "cos θ₂ = √(1 − (n₁/n₂)² sin² θ₁) is infinitely sensitive there: no \
             formula helps, only digits do. f32 is the same formula in 32 bits, from the rounded incident \
             direction; where a point is missing it found total reflection already")
        .note("Reference", "Descartes' law itself; the critical angles are asin(n₂/n₁); near one, cos θ₂ = \
             n₁ √(sin(θc + θ₁) sin(θc − θ₁)), which does not cancel");
    Finished { plate, data }
}

/// The normal of the surface, (2, 3, 6) / 7, and a direction in the surface.
const NORMAL: DVec3 = DVec3::new(2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0);
const TANGENT: DVec3 = DVec3::new(3.0 / 7.0, -6.0 / 7.0, 2.0 / 7.0);

/// A unit direction that comes down onto the surface.
fn arriving(degrees: f64) -> DVec3 {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    sine * TANGENT - cosine * NORMAL
}

/// The sine of a direction's angle with the normal.
fn sine(direction: DVec3) -> f64 {
    NORMAL.cross(direction).length()
}

/// The angle of a direction from the inner normal, in degrees.
fn angle(direction: DVec3) -> f64 {
    sine(direction).atan2(-NORMAL.dot(direction)).to_degrees()
}

/// How far a transmitted direction is from a unit vector that follows Descartes' law.
fn law_error(incident: DVec3, transmitted: DVec3, n1: f64, n2: f64) -> f64 {
    let law = n1 * NORMAL.cross(incident) - n2 * NORMAL.cross(transmitted);
    law.length().max((transmitted.length() - 1.0).abs())
}

/// The refracted direction in 32 bits.
fn refract_f32(incident: Vec3, n1: f32, n2: f32) -> Option<Vec3> {
    let (eta, n) = (n1 / n2, NORMAL.as_vec3());
    let cos1 = -n.dot(incident);
    let cos2_squared = 1.0 - eta * eta * (1.0 - cos1) * (1.0 + cos1);
    (cos2_squared >= 0.0).then(|| eta * incident + (eta * cos1 - cos2_squared.sqrt()) * n)
}

/// The error of cos θ₂ from glass to air, by the distance from the critical angle.
fn near_critical(data: &mut Table) -> Chart {
    let (n1, n2) = (1.5_f64, 1.0);
    let critical = (n2 / n1).asin();
    let mut wide = Series::new("f64", category_color(2));
    let mut narrow = Series::new("f32", category_color(3));
    for k in 4..=36 {
        let before = 10.0_f64.powf(-0.25 * f64::from(k));
        let exact = n1 * ((2.0 * critical - before).sin() * before.sin()).sqrt();
        let incident = arriving((critical - before).to_degrees());
        let relative = |t: DVec3| (-NORMAL.dot(t) / exact - 1.0).abs();
        let f64_error = refract(incident, NORMAL, n1, n2).map(relative);
        let f32_error =
            refract_f32(incident.as_vec3(), n1 as f32, n2 as f32).map(|t| relative(t.as_dvec3()));
        wide = wide.points(f64_error.map(|error| (before, error)));
        narrow = narrow.points(f32_error.map(|error| (before, error)));
        data.push([
            n1.into(),
            n2.into(),
            (critical - before).to_degrees().into(),
            exact.acos().to_degrees().into(),
            f64_error.unwrap_or(f64::NAN).into(),
            f32_error.unwrap_or(f64::NAN).into(),
        ]);
    }
    Chart::new(
        Axis::log("before the critical angle (radians)"),
        Axis::log("relative error of cos θ₂"),
    )
    .title("Glass to air, towards the critical angle")
    .height(420.0)
    .series(narrow)
    .series(wide)
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
            [(0.0_f64, ""), (20.0, "20°"), (35.0, "35°"), (50.0, "50°"), (62.0, "62°")]
        {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let up = DVec3::new(sine, cosine, 0.0);
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
