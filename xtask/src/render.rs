use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Instant;

use anyhow::{Context, Result, anyhow, bail, ensure};
use glam::DVec3;
use lancer_accel::structures::Structure;
use lancer_core::Rgb;
use lancer_core::image::{Image, ImageSize, check_target, save};
use lancer_core::method::{
    Branching, BuildIndex, ByProduct, Effect, Method, Order, Outcome, Setting, Strategy, WorkKind,
};
use lancer_core::render::Control;
use lancer_core::sampling::{Pattern, PixelSampling};
use lancer_core::scene::load::{MAX_COORDINATE, MAX_RADIANCE, WarningKind};
use lancer_core::scene::{Camera, PointLight, Scene};

use crate::arguments::{indexes, structure, warn_of_unused, whole};
use crate::chapters::{list, methods, scenes_in_words};
use crate::names::named;
use crate::{progress, scene};

/// Renders a scene by any method of the course.
#[derive(clap::Args)]
#[command(long_about = about(), after_help = "Examples:
  cargo xtask render whitted --out whitted.png
  cargo xtask render bunny.obj --method appel --size 1024x1024 --spp 16 --out bunny.png
  cargo xtask render whitted --spp 16 --adaptive 0.02 --out smooth.png
  cargo xtask render house.obj --up 0,0,1 --out house.png
  cargo xtask render room --depth 8 --eye 0.3,1.6,4 --exposure 0.5 --out room.exr")]
pub struct Args {
    /// A .toml or .obj file, or a scene of the course
    scene: String,
    #[arg(long, default_value = "whitted", help = methods_in_words())]
    method: String,
    #[arg(long, default_value = "wide", help = format!("{} (linear asks every primitive for every ray): the same picture in another time", indexes()))]
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
    /// Largest number of bounces between the eye and a surface; 5 unless given, and without end for path
    #[arg(long, value_parser = whole::<u32>(0, 1000), allow_negative_numbers = true)]
    depth: Option<u32>,
    /// Which rays go on where a surface both reflects and refracts (distributed): both, or one at random; both
    /// unless given
    #[arg(long, value_name = "BRANCHES", value_parser = one_of(&Branching::ALL))]
    branches: Option<Branching>,
    /// How lamps are found (path): lamp, by points drawn on them; lobe, by directions drawn from what a surface
    /// reflects; mis, by both, weighted. All find the same picture; mis unless given
    #[arg(long, value_name = "STRATEGY", value_parser = one_of(&Strategy::ALL))]
    estimator: Option<Strategy>,
    /// Picks the positions and the random numbers of samples; 0 unless given
    #[arg(long, value_parser = whole::<u64>(0, u64::MAX), allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Threads; 0 takes all processors. The picture does not depend on it
    #[arg(long, default_value_t = 0, value_parser = whole::<u16>(0, 1024), allow_negative_numbers = true)]
    threads: u16,
    /// Moves the eye
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    eye: Option<Numbers<3>>,
    /// Moves the point in the middle of the picture
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    look_at: Option<Numbers<3>>,
    /// The direction that points up in the picture, such as 0,0,1 for a model whose z does; y, or the
    /// scene's own, unless given. A scene without a camera is seen from the front all the same
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    up: Option<Numbers<3>>,
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
    #[arg(long, value_name = "NAME=FILE", value_parser = by_product, help = by_products_in_words())]
    also: Vec<(String, PathBuf)>,
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

/// Reads one of some names.
fn one_of<T: Copy + Send + Sync>(
    known: &'static [(&'static str, T)],
) -> impl Fn(&str) -> Result<T, String> + Clone {
    |text| {
        let value = known.iter().find(|(name, _)| *name == text).map(|(_, value)| *value);
        let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
        value.ok_or_else(|| format!("write {}", list(&names, "or")))
    }
}

/// Reads what is wanted beside the picture.
fn by_product(text: &str) -> Result<(String, PathBuf), String> {
    let parts = text.split_once('=').filter(|(name, file)| !name.is_empty() && !file.is_empty());
    let (name, file) =
        parts.ok_or_else(|| "write NAME=FILE, such as samples=samples.exr".to_owned())?;
    Ok((name.to_owned(), file.into()))
}

fn about() -> String {
    format!(
        "Renders a scene by any method of the course.\n\n\
         SCENE is a .toml file, an .obj file (framed automatically, and lit by a lamp beside the camera if it has \
         none), or a scene of the course: {}.",
        scenes_in_words()
    )
}

fn methods_in_words() -> String {
    let methods: Vec<String> =
        methods().map(|method| format!("{} ({})", method.name, method.about)).collect();
    let methods: Vec<&str> = methods.iter().map(String::as_str).collect();
    list(&methods, "or")
}

fn by_products_in_words() -> String {
    let mut known: Vec<ByProduct> = Vec::new();
    for by_product in methods().flat_map(|method| method.by_products) {
        if !known.contains(by_product) {
            known.push(*by_product);
        }
    }
    let known = known.iter().map(|ByProduct { name, about }| format!("{name}: {about}"));
    let known: Vec<String> = known.collect();
    format!(
        "A second picture ({}); an .exr keeps the numbers, a .png shows the largest as white",
        known.join("; ")
    )
}

pub fn run(args: &Args) -> Result<()> {
    let method = named("method", &args.method, methods(), |method| method.name)?;
    let structure = structure(&args.index)?;
    let by_products = args
        .also
        .iter()
        .map(|(name, _)| {
            let what = format!("by-product of {}", method.name);
            named(&what, name, method.by_products, |known| known.name).map(|known| known.name)
        })
        .collect::<Result<Vec<_>>>()?;
    if method.uses.contains(&Setting::Beams) {
        structure.check_beams().context("--index")?;
    }
    check_target(&args.out).context("--out")?;
    for (k, (_, file)) in args.also.iter().enumerate() {
        check_target(file).context("--also")?;
        let mut others = args.also[..k].iter().map(|(_, other)| other).chain([&args.out]);
        ensure!(others.all(|other| other != file), "--also: {} is written twice", file.display());
    }
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
    warn(method, &scene, args);
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
    let outcome = pool.install(|| trace(method, &scene, structure, &by_products, args))?;
    let beside = outcome.by_products.iter().zip(&args.also);
    for ((_, image), (_, file)) in beside {
        save(file, &if is_png(file) { scaled(image) } else { image.clone() }, 0.0)?;
    }
    let defects = outcome.image.defects();
    save(&args.out, &outcome.image, args.exposure)?;
    say!("picture {}", args.out.display());
    for (name, file) in &args.also {
        say!("{name} {}", file.display());
    }
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
    if let Some(up) = args.up.map(point) {
        let framing = scene.bounding_sphere().map(Camera::framing);
        scene.camera = match framing {
            Some(framing) if framing == scene.camera => framing.turned_to(up),
            _ => Camera { up, ..scene.camera },
        };
    }
    if let Some(eye) = args.eye {
        scene.camera.eye = point(eye);
    }
    if let Some(look_at) = args.look_at {
        scene.camera.look_at = point(look_at);
    }
    if let Some(fov) = args.fov {
        scene.camera.fov = fov;
    }
    scene.camera.check().context("--eye, --look-at, --up, --fov")?;
    if headlight {
        scene.lights = vec![PointLight::beside(&scene.camera)];
    }
    if !args.light.is_empty() {
        scene.lights = args.light.iter().map(point_light).collect::<Result<_>>()?;
    }
    Ok(())
}

/// A light of the command line, within the limits of scene files.
fn point_light(&Numbers([x, y, z, intensity]): &Numbers<4>) -> Result<PointLight> {
    let position = DVec3::new(x, y, z);
    ensure!(
        position.abs().max_element() <= MAX_COORDINATE,
        "--light: position is {:?}; coordinates must be finite and below {MAX_COORDINATE:e}",
        position.to_array()
    );
    ensure!(
        (0.0..=MAX_RADIANCE).contains(&intensity),
        "--light: intensity is {intensity:?}; it must be between 0 and {MAX_RADIANCE:e}"
    );
    Ok(PointLight { position, intensity: Rgb::splat(intensity) })
}

/// Says what the method takes no notice of: flags, and what is in the scene.
fn warn(method: &Method, scene: &Scene, args: &Args) {
    let flags = [
        ("--spp", Setting::Sampling, args.spp != 1),
        ("--seed", Setting::Sampling, args.seed.is_some()),
        ("--adaptive", Setting::Adaptive, args.adaptive.is_some()),
        ("--depth", Setting::MaxDepth, args.depth.is_some()),
        ("--branches", Setting::Branching, args.branches.is_some()),
        ("--estimator", Setting::Strategy, args.estimator.is_some()),
    ];
    warn_of_unused(flags, method.uses, method.name);
    if args.spp == 1 && method.uses.contains(&Setting::Sampling) {
        let seed_is_idle = args.seed.is_some() && !method.uses.contains(&Setting::Numbers);
        let given = [("--seed", seed_is_idle), ("--adaptive", args.adaptive.is_some())];
        for (flag, _) in given.into_iter().filter(|(_, is_given)| *is_given) {
            eprintln!(
                "warning: {flag} changes nothing: the one sample of --spp 1 is the pixel's centre"
            );
        }
    }
    let ignored = method.ignores.iter().filter(|effect| effect.is_in(scene));
    let ignored: Vec<String> = ignored.map(Effect::to_string).collect();
    if !ignored.is_empty() {
        eprintln!("warning: {} leaves out what the scene has: {}", method.name, ignored.join(", "));
    }
}

fn trace(
    method: &Method,
    scene: &Scene,
    structure: Structure,
    by_products: &[&'static str],
    args: &Args,
) -> Result<Outcome> {
    let bar = progress::bar(args.size.pixels() as u64, "tracing");
    let (building, bytes) = (Cell::new(0.0), Cell::new(0));
    let index: &BuildIndex = &|primitives| {
        let start = Instant::now();
        let built = structure.build(primitives);
        building.set(building.get() + start.elapsed().as_secs_f64());
        bytes.set(bytes.get() + built.bytes);
        built.index
    };
    let pattern = if args.spp == 1 { Pattern::Regular } else { Pattern::Owen };
    let control = Control {
        progress: &|pixels| bar.set_position(pixels),
        cancelled: &progress::INTERRUPTED,
        ..Control::default()
    };
    let order = Order {
        sampling: PixelSampling { pattern, samples: args.spp, seed: args.seed.unwrap_or(0) },
        adaptive: args.adaptive,
        max_depth: args.depth,
        branching: args.branches,
        strategy: args.estimator,
        by_products,
        control,
        ..Order::new(scene, index, args.size)
    };
    let start = Instant::now();
    let outcome = (method.render)(&order);
    let seconds = start.elapsed().as_secs_f64() - building.get();
    bar.finish_and_clear();
    let outcome = outcome.map_err(|_| anyhow!("interrupted; no file was written"))?;
    // One for what stands still, and one for each way in which parts move.
    let mib = bytes.get() as f64 / f64::from(1 << 20);
    say!("index   {:7.3} s   {}, {mib:.1} MiB", building.get(), structure.name);
    let rate = match outcome.work.total(WorkKind::Rays) {
        0 => String::new(),
        rays => format!("; {:.2} M/s", rays as f64 / seconds * 1e-6),
    };
    say!("trace   {seconds:7.3} s   {}{rate}", outcome.work);
    Ok(outcome)
}

/// A picture whose largest value is white.
fn scaled(image: &Image) -> Image {
    let most = image.pixels().as_flattened().iter().copied().fold(0.0, f32::max);
    let part = |pixel: &[f32; 3]| pixel.map(|value| if most > 0.0 { value / most } else { 0.0 });
    Image::from_pixels(image.size(), image.pixels().iter().map(part).collect())
}

fn is_png(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
}
