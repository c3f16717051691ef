//! 1.3: the exponent of the highlight: its width, and the light in it.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use glam::DVec3;
use lancer_core::Rgb;
use lancer_core::geometry::Sphere;
use lancer_core::illumination::{Reflectance, local};
use lancer_core::image::ImageSize;
use lancer_core::optics::reflect;
use lancer_core::scene::{Camera, Material, MaterialId, Mesh, PointLight, Scene, SphereObject};
use lancer_figure::{
    Axis, Chart, Drawing, Effort, Finished, INK, LABEL, MUTED, Montage, Pen, Picture, Plate, Row,
    Series, Spread, Stroke, Table, Text, Tile, category_color, decimals, method_color, number,
};
use lancer_lesson::judge::fitted_exponent;
use lancer_lesson::picture::shown;
use lancer_whitted::Settings;

use super::whitted_picture;

const EXPONENTS: [f64; 7] = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0];
/// ρ_s of the spheres shown; the normalised ones are equal to the others at this exponent.
const RHO_S: f64 = 0.6;
const ALIKE_AT: f64 = 10.0;

/// A ball of radius 1 at the origin, seen from +z.
fn ball(material: Material, distance: f64, fov: f64, light: PointLight) -> Scene {
    let eye = DVec3::Z * distance;
    Scene {
        camera: Camera { eye, look_at: DVec3::ZERO, up: DVec3::Y, fov, lens: None },
        mesh: Mesh::default(),
        spheres: vec![SphereObject {
            shape: Sphere { center: DVec3::ZERO, radius: 1.0 },
            material: MaterialId(0),
        }],
        motions: Vec::new(),
        materials: vec![material],
        lights: vec![light],
        ambient: Rgb::splat(0.15),
        background: Rgb::splat(0.03),
    }
}

/// A ball of paint and varnish, lit from the upper left.
fn painted(rho_s: f64, shininess: f64, size: ImageSize) -> Picture {
    let paint = Material::matte(Rgb::new(0.32, 0.09, 0.07));
    let material = Material { rho_s: Rgb::splat(rho_s), shininess, ..paint };
    let position = DVec3::new(-6.0, 7.0, 12.0);
    let light = PointLight { position, intensity: Rgb::splat(position.length_squared()) };
    let scene = ball(material, 8.0, 15.5, light);
    shown(&whitted_picture(&scene, Settings::default(), size).image)
}

/// How far the eye and the light are from the ball that is measured: at infinity, nearly.
const FAR: f64 = 1e4;
/// Half the side of the picture that is measured, in radii of the ball.
const REACH: f64 = 0.55;

/// The highlight's half-width at half maximum as a picture of `side` pixels shows it, in radians, with
/// the least and the greatest that the picture allows.
///
/// Eye and light are at the same place, so that R and V are 2φ apart where N is φ off that direction, at
/// the distance sin φ from the middle of the picture. The pixels at least half as bright as the brightest
/// are those whose centres lie in the disc of the half-width; so many unit squares tell its radius to
/// within half their diagonal (Gauss).
fn measured_width(shininess: f64, side: u32) -> Spread {
    let material = Material { rho_s: Rgb::ONE, shininess, ..Material::matte(Rgb::ZERO) };
    let intensity = Rgb::splat(FAR * FAR);
    let light = PointLight { position: DVec3::Z * FAR, intensity };
    let fov = 2.0 * (REACH / FAR).atan().to_degrees();
    let image = whitted_picture(
        &ball(material, FAR, fov, light),
        Settings::default(),
        ImageSize::new(side, side),
    )
    .image;
    let levels = || image.pixels().iter().map(|pixel| pixel[0]);
    let brightest = levels().fold(0.0, f32::max);
    let bright = levels().filter(|level| *level >= 0.5 * brightest).count();
    let pixel = 2.0 * REACH / f64::from(side);
    let radius = (bright as f64 / PI).sqrt();
    let half_width = |radius: f64| 2.0 * (radius * pixel).asin();
    Spread {
        low: half_width(radius - FRAC_1_SQRT_2),
        mid: half_width(radius),
        high: half_width(radius + FRAC_1_SQRT_2),
    }
}

/// (R·V)ⁿ by the code's own eq:local.
fn lobe(shininess: f64, n: DVec3, to_light: DVec3, to_eye: DVec3) -> f64 {
    let reflectance = Reflectance { diffuse: Rgb::ZERO, specular: Rgb::ONE, shininess };
    local(&reflectance, n, to_light, to_eye).x
}

/// The lobe's integral over the hemisphere around R, by a spiral of points of equal solid angle.
fn integral(shininess: f64, count: u32) -> f64 {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let points = (0..count).map(|i| {
        let z = (f64::from(i) + 0.5) / f64::from(count);
        let (sin, cos) = (golden * f64::from(i)).sin_cos();
        let r = (1.0 - z * z).sqrt();
        lobe(shininess, DVec3::Z, DVec3::Z, DVec3::new(r * cos, r * sin, z))
    });
    points.sum::<f64>() * TAU / f64::from(count)
}

pub fn make(effort: Effort) -> Finished {
    let side = effort.pick(400, 1200);
    let count = effort.pick(100_000, 1_000_000);
    let mut data =
        Table::new(["n", "half_width", "least", "greatest", "exact_half_width", "integral"]);
    let mut widths = Series::new("measured", method_color("whitted")).scatter();
    let mut energies = Series::new("(R·V)ⁿ, measured", method_color("whitted")).scatter();
    let mut kept = Series::new("normalised, measured", category_color(2)).scatter();
    let (mut within, mut asymptote, mut integral_error) = (true, Vec::new(), 0.0_f64);
    let mut measured = Vec::new();
    for n in EXPONENTS {
        let (width, exact) = (measured_width(n, side), exact_width(n));
        let energy = integral(n, count);
        within &= width.low <= exact && exact <= width.high;
        integral_error = integral_error.max((energy * (n + 1.0) / TAU - 1.0).abs());
        if n >= 10.0 {
            asymptote.push((n, width.mid));
        }
        measured.push(width.mid);
        let degrees = Spread {
            low: width.low.to_degrees(),
            mid: width.mid.to_degrees(),
            high: width.high.to_degrees(),
        };
        widths = widths.point(n, degrees);
        energies = energies.point(n, energy);
        kept = kept.point(n, energy * (n + 1.0) / TAU);
        data.push([n, width.mid, width.low, width.high, exact, energy].map(Into::into));
    }
    let p = fitted_exponent(&asymptote);
    let holds = within && (p + 0.5).abs() < 0.02 && integral_error < 1e-3;
    let last = EXPONENTS.len() - 1;
    let claim = format!(
        "The highlight's half-width is acos(2^(−1/n)), within the resolution of the picture: {}° at n = 1, {}° \
         at n = 1000, falling as n^{}; its light falls as 1/(n + 1), {}-fold, at the same peak.",
        decimals(measured[0].to_degrees(), 1),
        decimals(measured[last].to_degrees(), 2),
        decimals(p, 2),
        number(integral(EXPONENTS[0], count) / integral(EXPONENTS[last], count)),
    );

    let size = effort.pick(ImageSize::new(60, 60), ImageSize::new(180, 180));
    let row = |normalised: bool| {
        let tiles = EXPONENTS.iter().enumerate().map(|(k, &n)| {
            let kept = RHO_S * (n + 1.0) / (ALIKE_AT + 1.0);
            let (rho_s, title, subtitle) = match normalised {
                false => (RHO_S, format!("n = {n}"), "same peak"),
                true => (kept, format!("ρ_s {}", number(kept)), "same light"),
            };
            Tile::new(title, painted(rho_s, n, size)).subtitle(subtitle).color(category_color(k))
        });
        tiles.fold(Montage::new().columns(EXPONENTS.len()), Montage::tile)
    };
    let fine = (0..=60).map(|k| 10.0_f64.powf(f64::from(k) / 20.0));
    let closed = |label: &str| Series::new(label, method_color("reference")).curve();
    let width_chart =
        Chart::new(Axis::log("exponent n"), Axis::log("half-width at half maximum (degrees)"))
            .title("Width of the highlight")
            .series(
                closed("acos(2^(−1/n))")
                    .points(fine.clone().map(|n| (n, exact_width(n).to_degrees()))),
            )
            .series(widths)
            .slope(-0.5, "slope −1/2");
    let energy_chart =
        Chart::new(Axis::log("exponent n"), Axis::log("integral over the hemisphere"))
            .title("Light in the highlight")
            .series(closed("2π/(n + 1)").points(fine.map(|n| (n, TAU / (n + 1.0)))))
            .series(energies)
            .series(kept)
            .slope(-1.0, "slope −1");
    let plate = Plate::new("1.3", "The exponent of the highlight", claim, holds)
        .panel(row(false))
        .panel(row(true))
        .panel(Row::new().panel(1.0, lobes()))
        .panel(Row::new().panel(1.0, width_chart).panel(1.0, energy_chart))
        .note("Pictures", format!(
            "lobes in the colours of the balls. Above the slides' model, ρ_s {RHO_S} for every n; below, ρ_s grows with n + 1, so that every \
             highlight holds the same light. Same lamp and exposure; white is 1 and more"
        ))
        .note("Method", format!(
            "eq:local by algo:lr. Width: the number of pixels at least half as bright as the brightest, in \
             pictures of {side}x{side} of a ball lit from the eye; error bars are what half a pixel's \
             diagonal allows. Light: (R·V)ⁿ of the code over {} directions",
            number(f64::from(count))
        ))
        .note("Reference", format!(
            "closed forms: (cos θ)ⁿ = 1/2 at θ = acos(2^(−1/n)) ≈ √(2 ln 2 / n); ∫ (cos θ)ⁿ dω = 2π / (n + 1), \
             from which the quadrature differs by {} at most",
            number(integral_error)
        ))
        .note("Limits", "the slope is fitted from n = 10 on: the law is a power only for narrow lobes. The \
             integral counts directions around R, without what a slanted surface cuts off and without a cosine, \
             which the slides' term has not either");
    Finished { plate, data }
}

/// Where (cos θ)ⁿ is ½, in radians.
fn exact_width(n: f64) -> f64 {
    0.5_f64.powf(n.recip()).acos()
}

/// The lobes over a surface: how far along each direction V the curve is from the point, is (R·V)ⁿ.
fn lobes() -> Drawing {
    let draw = |pen: &mut Pen<'_>| {
        let direction = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            DVec3::new(sin, cos, 0.0)
        };
        let to_light = direction(-30.0);
        let to_mirror = reflect(-to_light, DVec3::Y);
        let flat = |v: DVec3| [v.x, v.y];
        for (k, n) in EXPONENTS.into_iter().enumerate() {
            let value = |degrees: f64| lobe(n, DVec3::Y, to_light, direction(degrees));
            let points: Vec<_> = (-360..=360)
                .map(|quarter| f64::from(quarter) / 4.0)
                .map(|degrees| flat(value(degrees) * direction(degrees)))
                .collect();
            pen.line(&points, Stroke::new(category_color(k), 3.0));
            // Right of R, where there is room between the lobes.
            if let Some(&at) = [75.0, 60.0, 50.0].get(k) {
                let text = Text::new(format!("n = {n}"), LABEL).color(category_color(k).for_text());
                pen.label(flat(value(at) * direction(at)), [40.0, 0.0], text);
            }
        }
        pen.surface([-1.0, 0.0], [1.2, 0.0]);
        pen.arrow(flat(1.15 * to_light), flat(0.02 * to_light), Stroke::new(INK, 3.0));
        pen.arrow([0.0, 0.0], flat(1.15 * to_mirror), Stroke::new(INK, 3.0));
        pen.line(&[[0.0, 0.0], [0.0, 1.1]], Stroke::new(MUTED, 1.5).dashed(8.0, 6.0));
        pen.label(flat(1.15 * to_mirror), [16.0, 4.0], Text::new("R", LABEL));
        pen.label([0.0, 1.1], [0.0, 14.0], Text::new("N", LABEL));
        pen.label(flat(1.15 * to_light), [-40.0, 4.0], Text::new("light", LABEL));
    };
    Drawing::new([-1.3, -0.06], [1.5, 1.2], 560.0, draw)
}
