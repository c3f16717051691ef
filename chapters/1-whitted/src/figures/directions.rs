//! 1.17: the five directions of the local model, how R is made, and a lamp behind the surface.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::illumination::{Reflectance, local};
use lancer_core::optics::reflect;
use lancer_figure::{
    Color, Drawing, Effort, Finished, HEADING, INK, LABEL, MUTED, Pen, Plate, Row, Stroke, Table,
    Text, category_color, number,
};

use super::{flat, turned};

/// From N to L and to R, and from R on to V, in degrees.
const THETA: f64 = 35.0;
const ALPHA: f64 = 38.0;

const N: DVec3 = DVec3::Y;
/// A lamp behind the surface for which R·V is positive nevertheless.
const BEHIND: [DVec3; 2] = [DVec3::new(0.6, -0.8, 0.0), DVec3::new(-0.96, 0.28, 0.0)];

pub fn make(_: Effort) -> Finished {
    let [to_light, to_eye] = drawn();
    let mut data = Table::new(["lamp", "n_l", "r_v", "n_h", "half_angle_error", "radiance"]);
    let mut seen = |lamp: &str, to_light: DVec3, to_eye: DVec3| {
        let mirror = reflect(-to_light, N);
        let h = (to_light + to_eye).normalize();
        let (n_l, r_v, n_h) = (N.dot(to_light), mirror.dot(to_eye), N.dot(h));
        let reflectance =
            Reflectance { diffuse: Rgb::splat(0.5), specular: Rgb::splat(0.5), shininess: 10.0 };
        let radiance = local(&reflectance, N, to_light, to_eye).x;
        // cos α = 2 cos² (α/2) − 1 where the four lie in a plane.
        let error = (r_v - (2.0 * n_h * n_h - 1.0)).abs();
        data.push([lamp.into(), n_l.into(), r_v.into(), n_h.into(), error.into(), radiance.into()]);
        (n_l, r_v, error, radiance)
    };
    let front = seen("in front", to_light, to_eye);
    let behind = seen("behind", BEHIND[0], BEHIND[1]);
    let parts = 0.5 * front.0 + 0.5 * front.1.powi(10);
    let holds = front.2 <= 4.0 * f64::EPSILON
        && (front.3 - parts).abs() <= 4.0 * f64::EPSILON
        && behind.0 < 0.0
        && behind.1 > 0.0
        && behind.3 == 0.0;
    let claim = format!(
        "In the plane of N and L the angle between N and H is half the angle α between R and V; behind the \
         surface there is no light, though R·V is {} there.",
        number(behind.1)
    );
    let plate = Plate::new("1.17", "The directions of the local model", claim, holds)
        .panel(
            Row::new()
                .panel(1.3, Drawing::new([-1.15, -0.5], [1.42, 1.95], 440.0, five))
                .panel(1.0, Drawing::new([-0.95, -0.45], [0.95, 1.98], 440.0, mirror))
                .panel(1.15, Drawing::new([-1.2, -1.1], [1.15, 1.48], 440.0, behind_it)),
        )
        .note("Directions", "all unit, all away from the surface: N normal, L to the lamp, V to the eye, R the mirror \
             direction of the light, H = (L + V) / |L + V|")
        .note("Mirror", "L = (N·L) N + the part along the surface; R keeps the first and turns the second round: \
             R = 2 (N·L) N − L")
        .note("Settings", format!("θ = {THETA}°, α = {ALPHA}°; on the right N·L = −0.8"))
        .note("Method", "eq:local; (R·V)ⁿ after Phong 1975, (N·H)ⁿ after Blinn 1977");
    Finished { plate, data }
}

/// L and V of the first two drawings.
fn drawn() -> [DVec3; 2] {
    [THETA, -THETA - ALPHA].map(|degrees| turned(N, degrees))
}

const LAMP: usize = 1;
const MIRROR: usize = 3;
const HALF: usize = 5;

fn stroke(color: Color) -> Stroke {
    Stroke::new(color, 4.0)
}

fn heading(pen: &mut Pen<'_>, at: [f64; 2], title: &str) {
    pen.label(at, [0.0, 0.0], Text::new(title, HEADING).bold());
}

fn five(pen: &mut Pen<'_>) {
    const O: [f64; 2] = [0.0, 0.0];
    let [to_light, to_eye] = drawn();
    let mirror = reflect(-to_light, N);
    let h = (to_light + to_eye).normalize();
    let length = 1.25;
    pen.surface([-1.1, 0.0], [1.38, 0.0]);
    let angle = |v: DVec3| v.y.atan2(v.x);
    let (lamp, r, half) = (category_color(LAMP), category_color(MIRROR), category_color(HALF));
    pen.angle(O, FRAC_PI_2, angle(to_light), 92.0, "θ", lamp);
    pen.angle(O, angle(mirror), FRAC_PI_2, 72.0, "θ", r);
    pen.angle(O, angle(to_eye), angle(mirror), 118.0, "α", INK);
    pen.angle(O, angle(h), FRAC_PI_2, 182.0, "α/2", half);
    pen.vector(O, flat(length * N), "N", stroke(MUTED));
    pen.vector(O, flat(length * to_light), "L", stroke(lamp));
    pen.vector(O, flat(length * mirror), "R", stroke(r));
    pen.vector(O, flat(length * to_eye), "V", stroke(INK));
    pen.vector(O, flat(length * h), "H", Stroke::new(half, 3.0).dashed(9.0, 6.0));
    pen.dot(O, 6.0, INK);
    heading(pen, [0.0, 1.83], "From a lit point");
}

fn mirror(pen: &mut Pen<'_>) {
    const O: [f64; 2] = [0.0, 0.0];
    let [to_light, _] = drawn();
    let r = reflect(-to_light, N);
    let foot = N.dot(to_light) * N;
    let color = category_color(MIRROR);
    pen.surface([-0.95, 0.0], [0.95, 0.0]);
    let thin = Stroke::new(MUTED, 2.0).dashed(8.0, 6.0);
    pen.line(&[flat(to_light), flat(r)], thin);
    pen.line(&[O, flat(2.0 * foot)], Stroke::new(MUTED, 2.0));
    pen.right_angle(flat(foot), [flat(2.0 * foot), flat(to_light)], 13.0, MUTED);
    pen.arrow(flat(2.0 * foot), flat(r), Stroke::new(category_color(LAMP), 3.0).dashed(9.0, 6.0));
    let middle = flat(0.5 * (2.0 * foot + r));
    let minus = Text::new("−L", LABEL).bold().color(category_color(LAMP).for_text());
    pen.label(middle, [22.0, 10.0], minus);
    pen.vector(O, flat(to_light), "L", stroke(category_color(LAMP)));
    pen.vector(O, flat(r), "R", stroke(color));
    pen.arrow(O, flat(foot), Stroke::new(MUTED, 4.0));
    pen.label(flat(0.72 * foot), [0.0, 0.0], Text::new("(N·L) N", LABEL));
    pen.point(flat(2.0 * foot), PI, "2 (N·L) N", INK);
    pen.dot(O, 6.0, INK);
    heading(pen, [0.0, 1.86], "R = 2 (N·L) N − L");
}

fn behind_it(pen: &mut Pen<'_>) {
    const O: [f64; 2] = [0.0, 0.0];
    let [to_light, to_eye] = BEHIND;
    pen.surface([-1.15, 0.0], [1.1, 0.0]);
    pen.vector(O, flat(N), "N", stroke(MUTED));
    pen.vector(O, flat(to_light), "L", stroke(category_color(LAMP)));
    pen.vector(O, flat(reflect(-to_light, N)), "R", stroke(category_color(MIRROR)));
    pen.vector(O, flat(to_eye), "V", stroke(INK));
    pen.dot(O, 6.0, INK);
    pen.label([0.62, 0.5], [0.0, 0.0], Text::new("N·L < 0: no light", LABEL));
    pen.label([0.62, 0.5], [0.0, -26.0], Text::new("whatever R·V is", LABEL));
    heading(pen, [0.0, 1.36], "A lamp behind it");
}
