//! 1.15: the frame at the eye, the film before it, and the ray through a pixel's centre.

use glam::DVec3;
use lancer_core::image::ImageSize;
use lancer_core::scene::Camera;
use lancer_figure::{
    Color, Drawing, Effort, Finished, HEADING, INK, LABEL, MUTED, Pen, Plate, Point, Row, Stroke,
    Style, Table, Text, category_color, number,
};

/// Its `up` is not perpendicular to the view axis.
const CAMERA: Camera = Camera {
    eye: DVec3::ZERO,
    look_at: DVec3::new(0.0, 0.0, -1.9),
    up: DVec3::new(0.0, 0.6, 0.35),
    fov: 50.0,
    lens: None,
};
const SIZE: ImageSize = ImageSize::new(9, 6);
/// The pixel whose ray is drawn.
const PIXEL: (u32, u32) = (2, 1);

pub fn make(_: Effort) -> Finished {
    let frame = Frame::new(&CAMERA, SIZE);
    let rays = CAMERA.primary_rays(SIZE);
    let mut data = Table::new(["x", "y", "u", "v", "w", "error"]);
    let mut largest = 0.0_f64;
    for row in 0..SIZE.height {
        for column in 0..SIZE.width {
            let (x, y) = center((column, row));
            let direction = frame.film(x, y).normalize();
            let error = (direction - rays.through(x, y).direction).length();
            largest = largest.max(error);
            let along = |axis: DVec3| frame.film(x, y).dot(axis).into();
            data.push([
                x.into(),
                y.into(),
                along(frame.u),
                along(frame.v),
                along(frame.w),
                error.into(),
            ]);
        }
    }
    let [u, v, w] = [frame.u, frame.v, frame.w];
    let skew = [u.dot(v), v.dot(w), w.dot(u)].into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let claim = format!(
        "u, v and w are perpendicular though up leans, and the ray through each pixel's centre is the code's, \
         to {}.",
        number(largest.max(skew))
    );
    let holds = largest <= 4.0 * f64::EPSILON && skew <= 2.0 * f64::EPSILON;
    let plate = Plate::new("1.15", "The frame at the eye and the film", claim, holds)
        .panel(
            Row::new()
                .panel(1.35, Drawing::new([-0.42, -0.58], [1.96, 1.39], 600.0, in_space))
                .panel(1.0, Drawing::new([-0.22, -1.0], [1.6, 1.03], 600.0, from_the_side)),
        )
        .note(
            "Frame",
            "w = (look_at − eye) / |look_at − eye|, u = w × up / |w × up|, v = u × w",
        )
        .note(
            "Pixel",
            "of side p = 2 tan(fov/2) / height; the film point (x, y) lies at w + (x − width/2) p u − (y − height/2) p v",
        )
        .note(
            "Settings",
            format!(
                "{SIZE} pixels, fov {}°; the ray is that of pixel ({}, {}), through ({}, {})",
                CAMERA.fov,
                PIXEL.0,
                PIXEL.1,
                center(PIXEL).0,
                center(PIXEL).1
            ),
        );
    Finished { plate, data }
}

fn center((column, row): (u32, u32)) -> (f64, f64) {
    (f64::from(column) + 0.5, f64::from(row) + 0.5)
}

/// The lesson's formulas.
struct Frame {
    u: DVec3,
    v: DVec3,
    w: DVec3,
    /// Half of the width and the height, in pixels.
    half: (f64, f64),
    /// p, the side of a pixel on the film at distance 1.
    pixel: f64,
}

impl Frame {
    fn new(camera: &Camera, size: ImageSize) -> Self {
        let w = (camera.look_at - camera.eye).normalize();
        let u = w.cross(camera.up).normalize();
        let pixel = 2.0 * (0.5 * camera.fov.to_radians()).tan() / f64::from(size.height);
        let half = (0.5 * f64::from(size.width), 0.5 * f64::from(size.height));
        Self { u, v: u.cross(w), w, half, pixel }
    }

    /// From the eye to a point of the film.
    fn film(&self, x: f64, y: f64) -> DVec3 {
        let across = (x - self.half.0) * self.pixel * self.u;
        let up = (self.half.1 - y) * self.pixel * self.v;
        self.w + across + up
    }
}

const RAY: Color = INK;

fn thin() -> Stroke {
    Stroke::new(MUTED, 1.4)
}

fn axis(k: usize) -> Stroke {
    Stroke::new(category_color(k), 4.0)
}

/// From behind the eye, its right and above, by parallel lines.
fn in_space(pen: &mut Pen<'_>) {
    let frame = Frame::new(&CAMERA, SIZE);
    let towards = DVec3::new(0.75, 0.42, 0.55).normalize();
    let right = DVec3::Y.cross(towards).normalize();
    let up = towards.cross(right);
    let flat = |p: DVec3| -> Point { [p.dot(right), p.dot(up)] };
    let film = |x: f64, y: f64| flat(frame.film(x, y));
    let (width, height) = (f64::from(SIZE.width), f64::from(SIZE.height));
    let eye = flat(CAMERA.eye);

    let (x, y) = center(PIXEL);
    let through = frame.film(x, y);
    const RADIUS: f64 = 0.24;
    let met = 1.6 * through;
    let ball = met + RADIUS * through.normalize();
    let color = category_color(5);
    pen.circle(flat(ball), RADIUS, Style::fill(color.with_alpha(90)).outlined(color, 2.0));
    pen.line(&[film(x, y), flat(met)], Stroke::new(RAY, 3.0));
    let dashes = thin().dashed(9.0, 7.0);
    pen.line(&[flat(frame.w), flat(CAMERA.look_at)], dashes);

    let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)];
    let corners = corners.map(|(x, y)| film(x, y));
    pen.polygon(&corners, Style::fill(category_color(4).with_alpha(60)).outlined(INK, 2.5));
    let (c, r) = (f64::from(PIXEL.0), f64::from(PIXEL.1));
    let cell = [film(c, r), film(c + 1.0, r), film(c + 1.0, r + 1.0), film(c, r + 1.0)];
    pen.polygon(&cell, Style::fill(category_color(1)));
    for column in 1..SIZE.width {
        pen.line(&[film(f64::from(column), 0.0), film(f64::from(column), height)], thin());
    }
    for row in 1..SIZE.height {
        pen.line(&[film(0.0, f64::from(row)), film(width, f64::from(row))], thin());
    }
    for corner in corners {
        pen.line(&[eye, corner], thin());
    }
    pen.line(&[eye, flat(frame.w)], dashes);
    pen.arrow(eye, film(x, y), Stroke::new(RAY, 3.0));

    let short = 0.42;
    pen.vector(eye, flat(short * CAMERA.up.normalize()), "up", Stroke::new(MUTED, 3.0));
    for (k, (letter, direction)) in
        [("u", frame.u), ("v", frame.v), ("w", frame.w)].into_iter().enumerate()
    {
        pen.vector(eye, flat(short * direction), letter, axis([0, 2, 3][k]));
    }
    pen.point(eye, 3.6, "eye", INK);
    pen.point(flat(CAMERA.look_at), -0.6, "look_at", MUTED);
    pen.dot(film(x, y), 4.5, INK);

    let rule = Stroke::new(INK, 2.5);
    pen.vector(film(0.0, -0.5), film(3.0, -0.5), "x", rule);
    pen.vector(film(-0.5, 0.0), film(-0.5, 2.5), "y", rule);
    pen.label(film(0.0, 0.0), [-34.0, 26.0], Text::new("(0, 0)", LABEL));
    pen.label(film(width, height), [0.0, -22.0], Text::new("(width, height)", LABEL));
    pen.label(film(width, 0.6 * height), [30.0, 0.0], Text::new("film", LABEL));
    pen.label(flat(ball), [0.0, 0.0], Text::new("object", LABEL));
    pen.label([-0.2, 1.3], [0.0, 0.0], Text::new("In space", HEADING).bold());
}

/// Along u: w to the right and v upwards.
fn from_the_side(pen: &mut Pen<'_>) {
    let frame = Frame::new(&CAMERA, SIZE);
    let flat = |p: DVec3| -> Point { [p.dot(frame.w), p.dot(frame.v)] };
    let film = |y: f64| flat(frame.film(center(PIXEL).0, y));
    let height = f64::from(SIZE.height);
    let half = 0.5 * CAMERA.fov.to_radians();
    let (x, y) = center(PIXEL);
    let through = frame.film(x, y);
    pen.line(&[[0.0, 0.0], film(0.0)], thin());
    pen.line(&[[0.0, 0.0], film(height)], thin());
    pen.line(&[[0.0, 0.0], [1.0, 0.0]], thin().dashed(9.0, 7.0));
    pen.line(&[film(0.0), film(height)], Stroke::new(INK, 2.5));
    for row in 0..=SIZE.height {
        let at = film(f64::from(row));
        pen.line(&[[at[0] - 0.02, at[1]], [at[0] + 0.02, at[1]]], Stroke::new(INK, 2.0));
    }
    let row = f64::from(PIXEL.1);
    pen.line(&[film(row), film(row + 1.0)], Stroke::new(category_color(1), 8.0));
    pen.arrow([0.0, 0.0], flat(through), Stroke::new(RAY, 3.0));
    pen.angle([0.0, 0.0], -half, half, 84.0, "", INK);
    pen.label([0.0, 0.0], [112.0, -22.0], Text::new("fov", LABEL));
    pen.vector([0.0, 0.0], [0.0, 0.4], "v", axis(2));
    pen.vector([0.0, 0.0], [0.4, 0.0], "w", axis(3));
    pen.point([0.0, 0.0], 3.6, "eye", INK);
    pen.span(film(0.5 * height), film(height), 20.0, "tan(fov/2)", INK);
    pen.span(film(row), film(row + 1.0), 20.0, "p", INK);
    pen.span([0.0, film(height)[1]], film(height), -48.0, "1", INK);
    pen.label(film(0.0), [0.0, 20.0], Text::new("y = 0", LABEL));
    pen.label(film(height), [0.0, -20.0], Text::new("y = height", LABEL));
    pen.label([0.1, 0.94], [0.0, 0.0], Text::new("From the side", HEADING).bold());
}
