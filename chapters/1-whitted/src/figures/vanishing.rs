//! 1.12: a sphere smaller than a pixel, sliding: seen in some frames, gone in the others.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use lancer_core::Rgb;
use lancer_core::geometry::Sphere;
use lancer_core::image::{Image, ImageSize};
use lancer_core::sampling::{Pattern, PixelSampling};
use lancer_core::scene::{Camera, Material, MaterialId, Mesh, Scene, SphereObject};
use lancer_figure::{
    Axis, Chart, Contender, Effort, Finished, Montage, Plate, Row, Series, Study, Tile,
    category_color, method_color,
};
use lancer_lesson::picture::shown;
use lancer_whitted::{RayCounts, Settings};

use super::trace_picture;

/// A pixel at the sphere's distance is a unit wide, and far away: the sphere's outline on the picture is
/// an ellipse, wider than a disc by less than 1 / cos³ of the angle to the picture's corner.
const DISTANCE: f64 = 1e4;

/// A glowing sphere whose centre stands over `at` on the picture, both in pixels.
fn frame(at: DVec2, diameter: f64, size: ImageSize, sampling: PixelSampling) -> Image {
    let middle = DVec2::new(f64::from(size.width), f64::from(size.height)) / 2.0;
    let center = DVec3::new(at.x - middle.x, middle.y - at.y, -DISTANCE);
    let fov = 2.0 * (middle.y / DISTANCE).atan().to_degrees();
    // The outline on the plane of the centre is that of the tangent cone.
    let slope = 0.5 * diameter / DISTANCE;
    let radius = DISTANCE * slope / slope.hypot(1.0);
    let scene = Scene {
        camera: Camera { eye: DVec3::ZERO, look_at: DVec3::NEG_Z, up: DVec3::Y, fov, lens: None },
        mesh: Mesh::default(),
        spheres: vec![SphereObject { shape: Sphere { center, radius }, material: MaterialId(0) }],
        motions: Vec::new(),
        materials: vec![Material { emission: Rgb::ONE, ..Material::matte(Rgb::ZERO) }],
        lights: Vec::new(),
        ambient: Rgb::ZERO,
        background: Rgb::ZERO,
    };
    trace_picture::<RayCounts>(&scene, Settings::default(), size, sampling).image
}

/// How much of the picture the sphere takes, in pixels: each is as bright as its share of it.
fn area(image: &Image) -> f64 {
    image.pixels().iter().map(|&[r, ..]| f64::from(r)).sum()
}

/// What a frame shows around the pixel that holds the sphere's centre; a sphere of 2 pixels fits.
const WINDOW: ImageSize = ImageSize::new(3, 3);

/// The areas seen while a sphere slides over a pixel, to and fro, on `steps` lines by one `steps`-th of a
/// pixel a frame. Random samples are drawn anew in each frame.
fn slide(diameter: f64, steps: u32, pattern: Pattern, samples: u32) -> Vec<f64> {
    (0..steps * steps)
        .map(|index| {
            let (line, step) = (index / steps, index % steps);
            let step = if line % 2 == 0 { step } else { steps - 1 - step };
            let at = DVec2::new(f64::from(step), f64::from(line)) + DVec2::new(0.37, 0.71);
            let sampling = PixelSampling { pattern, samples, seed: u64::from(index) };
            area(&frame(1.0 + at / f64::from(steps), diameter, WINDOW, sampling))
        })
        .collect()
}

fn disc(diameter: f64) -> f64 {
    PI * diameter * diameter / 4.0
}

/// The share of frames in which the centre of a pixel, or one of a grid of `across`² samples in it, lies in
/// the sphere's disc: what discs around all of them cover. From a diameter of one spacing on they overlap,
/// in lenses over the sides of the cells.
fn seen_share(diameter: f64, across: f64) -> f64 {
    let r = across * diameter / 2.0;
    let h = r.min(0.5);
    if r * r >= 0.5 {
        return 1.0;
    }
    PI * r * r - 4.0 * (r * r * (h / r).acos() - h * (r * r - h * h).sqrt())
}

/// The share of each pixel that a disc covers, by 400 chords: exact to 1e-4 of a pixel.
fn coverage(at: DVec2, diameter: f64, size: ImageSize) -> Image {
    const CHORDS: u32 = 400;
    let chord = |x: f64, y: f64| {
        let half = (diameter * diameter / 4.0 - (x - at.x).powi(2)).max(0.0).sqrt();
        ((at.y + half).min(y + 1.0) - (at.y - half).max(y)).max(0.0)
    };
    let pixel = |index: u32| {
        let (x, y) = (f64::from(index % size.width), f64::from(index / size.width));
        let chords = (0..CHORDS).map(|k| chord(x + (f64::from(k) + 0.5) / f64::from(CHORDS), y));
        [(chords.sum::<f64>() / f64::from(CHORDS)) as f32; 3]
    };
    Image::from_pixels(size, (0..size.pixels() as u32).map(pixel).collect())
}

/// Successive frames side by side, with blue between them.
fn strip(frames: &[Image]) -> Image {
    let size = frames[0].size();
    let wide = size.width + 1;
    let count = frames.len() as u32;
    let whole = ImageSize::new(wide * count - 1, size.height);
    let pixel = |index: u32| {
        let (x, y) = (index % whole.width, index / whole.width);
        if x % wide == size.width {
            return [0.0, 0.03, 0.2];
        }
        frames[(x / wide) as usize].get(x % wide, y).as_vec3().to_array()
    };
    Image::from_pixels(whole, (0..whole.pixels() as u32).map(pixel).collect())
}

const CURVES: [(Pattern, &str, usize); 3] = [
    (Pattern::Regular, "regular", 3),
    (Pattern::Jittered, "jittered", 0),
    (Pattern::Owen, "Owen", 2),
];
const SAMPLES: [u32; 4] = [1, 4, 16, 64];
/// The diameter of the sphere in all but one of the charts, in pixels.
const HALF: f64 = 0.5;

/// Where the sphere of the film strips stands, in pixels: it moves by a third of a pixel a frame.
fn on_its_way(index: u32) -> DVec2 {
    DVec2::new(1.12, 1.2) + f64::from(index) * DVec2::new(0.29, 0.17)
}

/// The film strips, from the exact coverage to many samples, and the brightness along the way.
fn strips() -> (Montage, Chart) {
    const STRIP: ImageSize = ImageSize::new(5, 4);
    let exact = (0..10).map(|k| coverage(on_its_way(k), HALF, STRIP)).collect::<Vec<_>>();
    let mut montage = Montage::new().columns(1).tile(
        Tile::new(
            "exact, ten frames: the share of each pixel that the disc covers",
            shown(&strip(&exact)),
        )
        .color(method_color("reference")),
    );
    let mut chart = Chart::new(
        Axis::linear("frame").between(0.0, 25.0),
        Axis::linear("brightness of the sphere (pixels)").between(0.0, 1.05),
    )
    .title("The sphere blinks")
    .horizontal(disc(HALF), "exact");
    for (samples, pattern, title, color) in [
        (1, Pattern::Regular, "1 sample", category_color(3)),
        (16, Pattern::Owen, "16 samples", category_color(2)),
    ] {
        let sampled = |index: u32, at: DVec2, size: ImageSize| {
            let sampling = PixelSampling { pattern, samples, seed: u64::from(index) };
            frame(at, HALF, size, sampling)
        };
        let frames: Vec<Image> = (0..10).map(|k| sampled(k, on_its_way(k), STRIP)).collect();
        montage = montage
            .tile(Tile::new(format!("{title} per pixel"), shown(&strip(&frames))).color(color));
        let brightness = (0..=25).map(|k| {
            let at = 1.0 + on_its_way(k).fract();
            (f64::from(k), area(&sampled(k, at, WINDOW)))
        });
        chart = chart.series(Series::new(title, color).points(brightness));
    }
    (montage, chart)
}

/// The share of frames in which anything is seen, against the sphere's diameter: measured and in closed form.
/// Also the largest difference of the two, in units of what so many frames can differ by. With an odd
/// number of steps the frames' centres are a grid in the cell of a sample as well as in the pixel, and a
/// circle of radius r holds π r² points of a grid up to π (√2 r + ½), the area of the cells it may cut.
fn seen_against_diameter(steps: u32) -> (Chart, f64) {
    const DIAMETERS: [f64; 11] = [0.05, 0.07, 0.1, 0.14, 0.2, 0.28, 0.4, 0.56, 0.8, 1.12, 1.6];
    let mut chart =
        Chart::new(Axis::log("diameter (pixels)"), Axis::linear("frames it is seen in (%)"))
            .title("Seen at all");
    let mut worst = 0.0_f64;
    let color = category_color(3);
    for (samples, across) in [(1, 1.0), (16, 4.0), (64, 8.0)] {
        let mut seen = Series::new("", color).scatter();
        for diameter in DIAMETERS {
            let areas = slide(diameter, steps, Pattern::Regular, samples);
            let share =
                areas.iter().filter(|area| **area > 0.0).count() as f64 / areas.len() as f64;
            seen = seen.point(diameter, 100.0 * share);
            let r = f64::from(steps) * across * diameter / 2.0;
            let off = (share - seen_share(diameter, across)).abs() * f64::from(steps * steps);
            let bound = PI * (2.0_f64.sqrt() * r + 0.5);
            worst = worst.max(off / bound);
        }
        let closed = (0..=120).map(|k| {
            let diameter = 0.05 * 32.0_f64.powf(f64::from(k) / 120.0);
            (diameter, 100.0 * seen_share(diameter, across))
        });
        let label =
            if samples == 1 { "1 sample".to_owned() } else { format!("{samples}, regular") };
        chart = chart.series(Series::new(label, color).points(closed).curve()).series(seen);
    }
    (chart, worst)
}

pub fn make(effort: Effort) -> Finished {
    let steps = effort.pick(15, 47);
    let frames = f64::from(steps * steps);
    let contenders = CURVES.iter().flat_map(|&(pattern, name, color)| {
        SAMPLES.map(|samples| Contender {
            curve: name.to_owned(),
            color: category_color(color),
            knob: samples,
            run: Box::new(move || {
                let work = u64::from(steps * steps * samples) * WINDOW.pixels() as u64;
                (slide(HALF, steps, pattern, samples), work)
            }),
        })
    });
    let exact = disc(HALF);
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / frames;
    let study = Study::measure("samples", effort.runs(3), contenders, |areas: &Vec<f64>| {
        let squares = mean(&mut areas.iter().map(|area| (area / exact - 1.0).powi(2)));
        let gone = mean(&mut areas.iter().map(|area| f64::from(*area == 0.0)));
        vec![("relative RMS error of the area", squares.sqrt()), ("gone (%)", 100.0 * gone)]
    });
    // How far the mean brightness of random samples is from the exact one, in its standard errors.
    let off = |areas: &Vec<f64>| {
        let m = mean(&mut areas.iter().copied());
        let variance = mean(&mut areas.iter().map(|area| (area - m).powi(2)));
        (m - exact).abs() / (variance / frames).sqrt()
    };
    let random = study.trials().iter().filter(|trial| trial.curve != CURVES[0].1);
    let farthest = random.map(|trial| off(&trial.outcome)).fold(0.0, f64::max);

    let (montage, blinking) = strips();
    let (seen, worst) = seen_against_diameter(steps);
    let (at_center, finest) = (&study.at(CURVES[0].1, 1).outcome, study.at("Owen", 64));
    let share = mean(&mut at_center.iter().map(|area| f64::from(*area > 0.0)));
    let holds = worst <= 1.0
        && at_center.iter().all(|area| *area == 0.0 || *area == 1.0)
        && finest.error("gone (%)") == 0.0
        && farthest < FALSE_ALARM;
    let claim = format!(
        "With one sample per pixel a sphere half a pixel wide is seen in {:.1} % of the frames, the share of \
         a pixel that it covers ({:.1} %), each time as a whole pixel; with 64 Owen samples it never vanishes, but its \
         brightness still errs by {:.0} %.",
        100.0 * share,
        100.0 * exact,
        100.0 * finest.error("relative RMS error of the area")
    );
    let plate = Plate::new("1.12", "Vanishing small objects", claim, holds)
        .panel(montage)
        .panel(Row::new().panel(1.1, blinking).panel(1.0, seen))
        .panel(study.chart("relative RMS error of the area").slope(-0.5, "slope −1/2, random"))
        .note("Frames", format!(
            "strips and « blinks »: a sphere {HALF} pixels wide moves by a third of a pixel a frame; the other \
             charts: it slides over a pixel on {steps} lines in as many steps. Every frame is rendered by \
             algo:lr; the sphere glows with radiance 1 before black"
        ))
        .note("Limits", "more samples only move the limit: a regular grid of n × n loses spheres below 1/n of a \
             pixel as one sample does below a pixel. One disc on black flatters the regular grid, \
             whose error here is the least; plate 1.11 shows its price")
        .note("Equal error", study.at_equal_error(
            "relative RMS error of the area", 0.2, frames * WINDOW.pixels() as f64, "samples per pixel"
        ))
        .note("Statistics", format!(
            "the mean brightness of jittered and Owen samples is right: it lies within {farthest:.1} of its \
             standard errors at all eight points, where {FALSE_ALARM} would be a false alarm in a million"
        ))
        .note("Reference", format!(
            "closed form: π d²/4, less the lenses in which the discs around neighbouring samples overlap; the \
             outline is a disc up to 10⁻⁷. The marks stay within {worst:.2} of what so many frames on a grid \
             can differ from it"
        ));
    Finished { plate, data: study.table() }
}

/// Standard errors that a family of ten normal means exceeds once in a million times.
const FALSE_ALARM: f64 = 5.33;
