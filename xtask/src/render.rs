use std::path::PathBuf;
use std::str::FromStr;
use std::time::Instant;

use anyhow::{Context, Result, anyhow, bail, ensure};
use glam::DVec3;
use lancer_accel::structures::STRUCTURES;
use lancer_core::Rgb;
use lancer_core::image::{ImageSize, check_target, save};
use lancer_core::intersector::Intersector;
use lancer_core::render::{Control, Film, Rendering, Seen, render_adaptive, render_pixels};
use lancer_core::sampling::{Pattern, PixelSampling};
use lancer_core::scene::load::WarningKind;
use lancer_core::scene::{PointLight, Scene};
use lancer_core::world::World;
use lancer_whitted::{Appel, RayCounts, Settings, Whitted};

use crate::arguments::whole;
use crate::names::named;
use crate::{progress, scene};

#[derive(Clone, Copy)]
enum Method {
    Appel,
    Whitted,
}

const METHODS: [(&str, Method); 2] = [("appel", Method::Appel), ("whitted", Method::Whitted)];
/// Renders a scene by any method of the course.
///
/// SCENE is a .toml file, an .obj file (framed automatically, and lit by a lamp beside the camera if
/// it has none), or a scene of the course: whitted, room, horizon, one of flake, tetrahedra and gears
/// with a level of detail, such as flake:4, or one of soup, scan, town and stadium with a number of
/// triangles, such as stadium:100000.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  cargo xtask render whitted --out whitted.png
  cargo xtask render bunny.obj --method appel --size 1024x1024 --spp 16 --out bunny.png
  cargo xtask render whitted --spp 16 --adaptive 0.02 --out smooth.png
  cargo xtask render room --depth 8 --eye 0.3,1.6,4 --exposure 0.5 --out room.exr")]
pub struct Args {
    /// A .toml or .obj file, or a scene of the course
    scene: String,
    /// appel (visibility and shadows) or whitted (mirrors and glass as well)
    #[arg(long, default_value = "whitted")]
    method: String,
    /// linear (every primitive for every ray), wide, bvh, obvhs-bvh2, obvhs-cwbvh, grid, octree, kd or bsp:
    /// the same picture in another time
    #[arg(long, default_value = "wide")]
    index: String,
    /// Pixels across and down
    #[arg(long, default_value = "512x512", value_name = "WxH", allow_hyphen_values = true)]
    size: ImageSize,
    /// Samples per pixel: 1 is the pixel's centre, more are a scrambled Sobol sequence
    #[arg(long, default_value_t = 1, value_parser = whole::<u32>(1, 1 << 20), allow_negative_numbers = true)]
    spp: u32,
    /// Takes --spp samples only in pixels that differ from a neighbour by more than this part of the
    /// display's range, and one in the others
    #[arg(long, value_name = "CONTRAST", value_parser = part, allow_hyphen_values = true)]
    adaptive: Option<f64>,
    /// Largest number of bounces between the eye and a surface (whitted)
    #[arg(long, default_value_t = 5, value_parser = whole::<u32>(0, 1000), allow_negative_numbers = true)]
    depth: u32,
    /// Picks the sample positions
    #[arg(long, default_value_t = 0, value_parser = whole::<u64>(0, u64::MAX), allow_negative_numbers = true)]
    seed: u64,
    /// Threads; 0 takes all processors. The picture does not depend on it
    #[arg(long, default_value_t = 0, value_parser = whole::<u16>(0, 1024), allow_negative_numbers = true)]
    threads: u16,
    /// Moves the eye
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    eye: Option<Numbers<3>>,
    /// Moves the point in the middle of the picture
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    look_at: Option<Numbers<3>>,
    /// Vertical opening angle in degrees
    #[arg(long, value_name = "DEG", value_parser = finite, allow_hyphen_values = true)]
    fov: Option<f64>,
    /// A point light instead of the scene's point lights; may be given several times
    #[arg(long, value_name = "X,Y,Z,INTENSITY", allow_hyphen_values = true)]
    light: Vec<Numbers<4>>,
    /// Brightens a PNG by this many stops; an EXR keeps the radiances
    #[arg(long, default_value_t = 0.0, value_name = "EV", value_parser = finite, allow_hyphen_values = true)]
    exposure: f64,
    /// The picture: .png is sRGB, .exr is linear
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Numbers separated by commas.
#[derive(Clone, Copy)]
struct Numbers<const N: usize>([f64; N]);

impl<const N: usize> FromStr for Numbers<N> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Vec<f64> = text.split(',').map(finite).collect::<Result<_, _>>()?;
        let count = numbers.len();
        <[f64; N]>::try_from(numbers)
            .map(Self)
            .map_err(|_| format!("{N} numbers separated by commas are wanted, {count} are given"))
    }
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| format!("`{text}` is not a number; write one such as -1.5"))
}

/// Reads a part of a whole.
fn part(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|number| (0.0..=1.0).contains(number));
    number.ok_or_else(|| "write a number from 0 to 1".to_owned())
}

pub fn run(args: &Args) -> Result<()> {
    let method = named("method", &args.method, &METHODS)?;
    let structures = STRUCTURES.map(|structure| (structure.name, structure));
    let structure = named("index", &args.index, &structures)?;
    check_target(&args.out).context("--out")?;
    progress::watch_for_interrupt()?;

    let start = Instant::now();
    let loaded = scene::open(&args.scene)?;
    let lit_here = !args.light.is_empty();
    for warning in &loaded.warnings {
        if !(lit_here && warning.kind == WarningKind::NoLight) {
            eprintln!("warning: {warning}");
        }
    }
    let mut scene = loaded.scene;
    place(&mut scene, loaded.headlight, args)?;
    let counts = scene.counts();
    say!(
        "scene   {:7.3} s   {} triangles in {} faces, {} spheres, {} lights",
        start.elapsed().as_secs_f64(),
        counts.triangles,
        counts.faces,
        counts.spheres,
        scene.point_sources().len(),
    );

    let expected = structure.expected_bytes(scene.primitives().len()) as f64 / f64::from(1 << 30);
    if expected > 1.0 {
        eprintln!("note: the index {} may take about {expected:.1} GiB", structure.name);
    }

    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads.into())
        .build()
        .context("cannot start the threads")?;
    let rendering = pool.install(|| {
        let start = Instant::now();
        let built = structure.build(&scene);
        let mib = built.bytes as f64 / f64::from(1 << 20);
        say!("index   {:7.3} s   {}, {mib:.1} MiB", start.elapsed().as_secs_f64(), args.index);
        trace(method, &scene, &*built.index, args)
    })?;

    let defects = rendering.image.defects();
    save(&args.out, &rendering.image, args.exposure)?;
    say!("picture {}", args.out.display());
    if defects.not_finite + defects.negative > 0 {
        bail!(
            "{} pixels are not finite and {} are negative: please report the scene",
            defects.not_finite,
            defects.negative
        );
    }
    Ok(())
}

/// Applies the camera and the lights of the command line.
fn place(scene: &mut Scene, headlight: bool, args: &Args) -> Result<()> {
    let point = |numbers: Numbers<3>| DVec3::from(numbers.0);
    if let Some(eye) = args.eye {
        scene.camera.eye = point(eye);
    }
    if let Some(look_at) = args.look_at {
        scene.camera.look_at = point(look_at);
    }
    if let Some(fov) = args.fov {
        scene.camera.fov = fov;
    }
    scene.camera.check().context("--eye, --look-at, --fov")?;
    if headlight {
        scene.lights = vec![PointLight::beside(&scene.camera)];
    }
    if !args.light.is_empty() {
        scene.lights = args
            .light
            .iter()
            .map(|&Numbers([x, y, z, intensity])| PointLight {
                position: DVec3::new(x, y, z),
                intensity: Rgb::splat(intensity),
            })
            .collect();
        ensure!(
            scene.lights.iter().all(|light| light.intensity.x >= 0.0),
            "--light: an intensity is negative; the fourth number must be at least 0"
        );
    }
    Ok(())
}

fn trace(
    method: Method,
    scene: &Scene,
    index: &dyn Intersector,
    args: &Args,
) -> Result<Rendering<RayCounts>> {
    let world = World { scene, index };
    match method {
        Method::Appel => {
            let appel = Appel::new(world);
            picture(
                args,
                Seen::new(world, args.size, |ray, hit, counts| appel.shade(ray, hit, counts)),
            )
        }
        Method::Whitted => {
            let settings = Settings { max_depth: args.depth, ..Settings::default() };
            let whitted = Whitted::new(world, settings);
            picture(
                args,
                Seen::new(world, args.size, |ray, hit, counts| whitted.shade(ray, hit, counts)),
            )
        }
    }
}

fn picture(args: &Args, film: impl Film<RayCounts>) -> Result<Rendering<RayCounts>> {
    let pattern = if args.spp == 1 { Pattern::Regular } else { Pattern::Owen };
    let sampling = PixelSampling { pattern, samples: args.spp, seed: args.seed };
    let bar = progress::bar(args.size.pixels() as u64, "tracing");
    let control = Control {
        progress: &|pixels| bar.set_position(pixels),
        cancelled: &progress::INTERRUPTED,
        ..Control::default()
    };
    let start = Instant::now();
    let rendering = match args.adaptive {
        Some(contrast) => render_adaptive(args.size, sampling, contrast, control, film),
        None => render_pixels(args.size, sampling, control, film),
    };
    let rendering = rendering.map_err(|_| anyhow!("interrupted; no file was written"));
    let seconds = start.elapsed().as_secs_f64();
    bar.finish_and_clear();
    let rendering = rendering?;
    let counts = rendering.counts;
    say!(
        "trace   {seconds:7.3} s   {} rays: {} primary, {} mirror, {} refracted, {} shadow; {:.2} M/s",
        counts.total(),
        counts.primary,
        counts.mirror,
        counts.refracted,
        counts.shadow,
        counts.total() as f64 / seconds * 1e-6,
    );
    Ok(rendering)
}
