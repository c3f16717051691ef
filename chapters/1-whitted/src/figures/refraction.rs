//! 1.18: the refracted ray from the parts of D, where there is none, and one material inside another.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use lancer_core::optics::{reflect, refract};
use lancer_figure::{
    Drawing, Effort, Finished, HEADING, INK, LABEL, MUTED, Pen, Plate, Row, Stroke, Style, Table,
    Text, category_color, number,
};

use super::{flat, turned};

const N: DVec3 = DVec3::Y;
/// τ, along the surface in the plane of D and N.
const TANGENT: DVec3 = DVec3::X;
const GLASS: f64 = 1.5;
const WATER: f64 = 1.33;
/// θ₁ of the three drawings, in degrees.
const ENTERING: f64 = 50.0;
const LEAVING: f64 = 55.0;

pub fn make(_: Effort) -> Finished {
    let mut data =
        Table::new(["from", "to", "relative_index", "degrees_in", "degrees_out", "error"]);
    let (mut largest, mut agree) = (0.0_f64, true);
    let mut bent = |[from, to]: [&str; 2], [n1, n2]: [f64; 2], incident: DVec3| {
        let t = parted(incident, n1 / n2);
        // A scene knows one index of a material and takes 1 for what is outside of it.
        let relative = refract(incident, N, 1.0, n2 / n1);
        let degrees = |v: Option<DVec3>| v.map_or(f64::NAN, |v| v.dot(TANGENT).asin().to_degrees());
        let error = t.zip(relative).map_or(0.0, |(t, relative)| {
            let law = (n1 * incident.dot(TANGENT) - n2 * t.dot(TANGENT)).abs();
            law.max((t - relative).length()).max((t.length() - 1.0).abs())
        });
        largest = largest.max(error);
        data.push([
            from.into(),
            to.into(),
            (n2 / n1).into(),
            degrees(Some(incident)).into(),
            degrees(t).into(),
            error.into(),
        ]);
        agree &= t.is_some() == relative.is_some();
        t
    };
    let entering = bent(["air", "glass"], [1.0, GLASS], arriving(ENTERING));
    let leaving = bent(["glass", "air"], [GLASS, 1.0], arriving(LEAVING));
    let in_water = entering.and_then(|t| bent(["glass", "water"], [GLASS, WATER], t));
    let straight = bent(["air", "water"], [1.0, WATER], arriving(ENTERING));
    let apart = in_water
        .zip(straight)
        .map_or(f64::INFINITY, |(layered, straight)| (layered - straight).length());
    largest = largest.max(apart);
    let holds = largest <= 8.0 * f64::EPSILON && agree && leaving.is_none();
    let claim = format!(
        "T from the parts of D is a unit vector with n₁ sin θ₁ = n₂ sin θ₂, to {}; beyond the critical angle \
         there is none; water behind glass, of index 1.33 / 1.5 there, bends the ray as water alone does.",
        number(largest)
    );
    let low = [-1.3, -1.2];
    let high = [1.3, 1.5];
    let plate = Plate::new("1.18", "The refracted ray, part by part", claim, holds)
        .panel(
            Row::new()
                .panel(1.0, Drawing::new(low, high, 460.0, into_glass))
                .panel(1.0, Drawing::new(low, high, 460.0, out_of_glass))
                .panel(1.0, Drawing::new(low, high, 460.0, layers)),
        )
        .note("Parts", "D = sin θ₁ τ − cos θ₁ N, with τ along the surface; the law scales the first by η = n₁ / n₂, and \
             length 1 gives the second: T = η sin θ₁ τ − cos θ₂ N")
        .note("No T", "where η sin θ₁ > 1; in glass that is beyond θc = asin(1 / 1.5) = 41.8°")
        .note("Indices", "a material's index is relative to what is outside of it: water in glass has 1.33 / 1.5 = 0.887")
        .note("Method", "eq:descartes");
    Finished { plate, data }
}

/// A unit direction that comes down onto the surface, `degrees` from its normal.
fn arriving(degrees: f64) -> DVec3 {
    -turned(N, degrees)
}

/// The refracted ray from the parts of D along the surface and across it.
fn parted(incident: DVec3, eta: f64) -> Option<DVec3> {
    let sine = eta * incident.dot(TANGENT);
    (sine.abs() <= 1.0).then(|| sine * TANGENT - (1.0 - sine * sine).sqrt() * N)
}

const O: [f64; 2] = [0.0, 0.0];
const WIDE: f64 = 1.25;

/// Matter from one height to another.
fn matter(pen: &mut Pen<'_>, from: f64, to: f64, strength: u8) {
    let corners = [[-WIDE, from], [WIDE, from], [WIDE, to], [-WIDE, to]];
    pen.polygon(&corners, Style::fill(category_color(4).with_alpha(strength)));
}

fn border(pen: &mut Pen<'_>, height: f64) {
    pen.line(&[[-WIDE, height], [WIDE, height]], Stroke::new(INK, 2.5));
}

fn thin() -> Stroke {
    Stroke::new(MUTED, 1.8).dashed(7.0, 6.0)
}

fn heading(pen: &mut Pen<'_>, title: &str) {
    pen.label([0.0, 1.4], [0.0, 0.0], Text::new(title, HEADING).bold());
}

fn note(pen: &mut Pen<'_>, at: [f64; 2], text: String) {
    pen.label(at, [0.0, 0.0], Text::new(text, LABEL));
}

/// The angle of a direction away from the surface.
fn polar(v: DVec3) -> f64 {
    v.y.atan2(v.x)
}

fn into_glass(pen: &mut Pen<'_>) {
    let v = arriving(ENTERING);
    let Some(t) = parted(v, 1.0 / GLASS) else { return };
    let (from, blue) = (-v, category_color(0));
    matter(pen, 0.0, -1.15, 70);
    border(pen, 0.0);
    pen.circle(O, 1.0, Style { fill: None, stroke: Some(thin()) });
    pen.line(&[O, [0.0, -1.0]], thin());
    // The parts along the surface.
    pen.line(&[flat(from), [0.0, from.y]], Stroke::new(INK, 2.0));
    pen.line(&[flat(t), [0.0, t.y]], Stroke::new(blue, 2.0));
    pen.label([0.5 * from.x, from.y], [0.0, 18.0], Text::new("sin θ₁", LABEL));
    pen.label([0.5 * t.x, t.y], [4.0, -18.0], Text::new("sin θ₂", LABEL).color(blue.for_text()));
    pen.angle(O, FRAC_PI_2, polar(from), 62.0, "θ₁", INK);
    pen.angle(O, -FRAC_PI_2, polar(t), 72.0, "θ₂", blue);
    pen.vector(O, [0.0, 1.12], "N", Stroke::new(MUTED, 4.0));
    pen.vector(O, [0.5, 0.0], "τ", Stroke::new(MUTED, 4.0));
    pen.arrow(flat(from), O, Stroke::new(INK, 4.0));
    pen.label(flat(from), [-16.0, 12.0], Text::new("D", LABEL).bold());
    pen.vector(O, flat(t), "T", Stroke::new(blue, 4.0));
    note(pen, [0.62, 0.24], "n₁ = 1".to_owned());
    note(pen, [-0.75, -0.95], format!("n₂ = {GLASS}"));
    heading(pen, "Into glass");
}

fn out_of_glass(pen: &mut Pen<'_>) {
    let v = arriving(LEAVING);
    let (from, red) = (-v, category_color(3));
    matter(pen, 0.0, 1.15, 70);
    border(pen, 0.0);
    pen.circle(O, 1.0, Style { fill: None, stroke: Some(thin()) });
    let critical = turned(N, (1.0 / GLASS).asin().to_degrees());
    pen.line(&[flat(critical), O], Stroke::new(MUTED, 2.5));
    pen.label(flat(critical), [-6.0, 14.0], Text::new("θc", LABEL).color(MUTED));
    pen.angle(O, FRAC_PI_2, polar(from), 62.0, "θ₁", INK);
    pen.vector(O, [0.0, 1.12], "N", Stroke::new(MUTED, 4.0));
    pen.arrow(flat(from), O, Stroke::new(INK, 4.0));
    pen.label(flat(from), [-18.0, 6.0], Text::new("D", LABEL).bold());
    pen.vector(O, flat(reflect(v, N)), "R", Stroke::new(red, 4.0));
    let sine = GLASS * v.dot(TANGENT);
    pen.span([0.0, -0.3], [1.0, -0.3], 0.0, "", MUTED);
    note(pen, [0.5, -0.42], "1".to_owned());
    pen.span([0.0, -0.72], [sine, -0.72], 0.0, "", red);
    let text = format!("η sin θ₁ = {sine:.2}");
    pen.label([0.5 * sine, -0.72], [0.0, -22.0], Text::new(text, LABEL).color(red.for_text()));
    note(pen, [-0.55, -0.25], "n₂ = 1".to_owned());
    note(pen, [0.64, 0.13], format!("n₁ = {GLASS}"));
    heading(pen, "Out of glass: no T");
}

fn layers(pen: &mut Pen<'_>) {
    let v = arriving(ENTERING);
    let Some(t) = parted(v, 1.0 / GLASS) else { return };
    let Some(w) = parted(t, GLASS / WATER) else { return };
    let (top, bottom) = (0.35, -0.35);
    matter(pen, top, bottom, 70);
    matter(pen, bottom, -1.15, 130);
    border(pen, top);
    border(pen, bottom);
    let foot = |from: [f64; 2], along: DVec3, height: f64| {
        [from[0] + along.x / along.y * (height - from[1]), height]
    };
    let first = [-0.25, top];
    let start = foot(first, v, 1.15);
    let second = foot(first, t, bottom);
    let end = foot(second, w, -1.15);
    for at in [first, second] {
        pen.line(&[[at[0], at[1] - 0.42], [at[0], at[1] + 0.42]], thin());
    }
    let blue = category_color(0);
    pen.angle(first, FRAC_PI_2, polar(-v), 44.0, "", INK);
    pen.angle(first, -FRAC_PI_2, polar(t), 50.0, "", blue);
    pen.angle(second, -FRAC_PI_2, polar(w), 50.0, "", blue);
    pen.arrow(start, first, Stroke::new(INK, 4.0));
    pen.arrow(first, second, Stroke::new(blue, 4.0));
    pen.arrow(second, end, Stroke::new(blue, 4.0));
    let degrees = |v: DVec3| v.dot(TANGENT).asin().to_degrees();
    note(pen, [-0.47, 0.86], format!("{:.1}°", degrees(v)));
    note(pen, [0.24, 0.2], format!("{:.1}°", degrees(t)));
    note(pen, [0.7, -0.6], format!("{:.1}°", degrees(w)));
    note(pen, [0.8, 1.0], "air, 1".to_owned());
    note(pen, [0.85, 0.2], format!("glass, {GLASS}"));
    note(pen, [-0.6, -0.62], format!("water, {WATER}"));
    note(pen, [-0.6, -0.84], format!("in glass {WATER} / {GLASS}"));
    heading(pen, "Water behind glass");
}
