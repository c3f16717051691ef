use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use lancer_accel::ObvhsBvh2;
use lancer_accel::structures::STRUCTURES;
use lancer_core::image::{ImageSize, check_writable, write_atomically};
use lancer_core::scene::load::Loaded;
use lancer_figure::Walk;
use lancer_whitted::Settings;

use crate::arguments::whole;
use crate::names::named;
use crate::scene;

type Algorithm = fn(&Args, &Loaded) -> Result<Walk>;

const ALGORITHMS: [(&str, Algorithm); 2] = [("whitted", whitted), ("accel", accel)];

/// The most steps of a page: its drawing has all of them.
const MOST_STEPS: usize = 5000;

/// Walks through an algorithm for one pixel, step by step.
///
/// whitted is the slides' algorithm LR: each call with its ray, what it meets, the terms of the local model
/// lamp by lamp, the rays that it spawns, and the sum that comes back up.
///
/// accel is the search for what the pixel's ray meets, through one index after the other: each box and cell
/// on its way, each primitive that is tested, and a table of what all of them did.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  cargo xtask step whitted --scene whitted --pixel 246,157
  cargo xtask step whitted --scene room --pixel 200,300 --depth 2
  cargo xtask step whitted --scene whitted --pixel 246,157 --out step.html   a page with a slider
  cargo xtask step accel --scene stadium:20000 --pixel 256,256 --out step.html
  cargo xtask step accel --scene town:2000 --pixel 256,300 --index kd")]
pub struct Args {
    /// whitted or accel
    algorithm: String,
    /// A .toml or .obj file, or a scene of the course
    #[arg(long)]
    scene: String,
    /// Column and row of the pixel; 0,0 is the upper left one
    #[arg(long, value_name = "X,Y", value_parser = pixel, allow_hyphen_values = true)]
    pixel: [u32; 2],
    /// Pixels of the whole picture across and down
    #[arg(long, default_value = "512x512", value_name = "WxH", allow_hyphen_values = true)]
    size: ImageSize,
    /// Largest number of bounces between the eye and a surface (whitted)
    #[arg(long, default_value_t = 5, value_parser = whole::<u32>(0, 16), allow_negative_numbers = true)]
    depth: u32,
    /// Only this index: linear, wide, bvh, obvhs-bvh2, obvhs-cwbvh, grid, octree, kd or bsp (accel)
    #[arg(long)]
    index: Option<String>,
    /// Writes a page instead of the text: a slider over the steps, with the rays in a drawing of the scene
    /// beside the tree of the calls
    #[arg(long, value_name = "FILE.html")]
    out: Option<PathBuf>,
}

fn pixel(text: &str) -> Result<[u32; 2], String> {
    let numbers = text
        .split_once(',')
        .and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
    numbers.ok_or_else(|| "write column and row as two whole numbers, such as 120,80".to_owned())
}

pub fn run(args: &Args) -> Result<()> {
    let algorithm = named("algorithm", &args.algorithm, &ALGORITHMS)?;
    let (size, [x, y]) = (args.size, args.pixel);
    ensure!(
        x < size.width && y < size.height,
        "--pixel {x},{y} lies outside of the picture of {size}: columns are 0 to {}, rows 0 to {}",
        size.width - 1,
        size.height - 1
    );
    if let Some(out) = &args.out {
        check_page(out).context("--out")?;
    }
    let loaded = scene::open(&args.scene)?;
    for warning in &loaded.warnings {
        eprintln!("warning: {warning}");
    }
    let walk = algorithm(args, &loaded)?;
    match &args.out {
        None => say!("{}", walk.to_text().trim_end()),
        Some(out) => {
            let count = walk.steps.len();
            ensure!(
                count <= MOST_STEPS,
                "--out: {count} steps are too many for a page; take a smaller --depth, or one --index"
            );
            write_atomically(out, walk.to_html().as_bytes())?;
            say!("page    {}   {count} steps", out.display());
        }
    }
    Ok(())
}

fn whitted(args: &Args, loaded: &Loaded) -> Result<Walk> {
    ensure!(
        args.index.is_none(),
        "--index: whitted's walk is the same with every index; leave it out"
    );
    let index = ObvhsBvh2::build(&loaded.scene);
    Ok(chapter_1::step::walk(&chapter_1::step::Request {
        name: &args.scene,
        loaded,
        index: &index,
        size: args.size,
        pixel: args.pixel,
        settings: Settings { max_depth: args.depth, ..Settings::default() },
    }))
}

fn accel(args: &Args, loaded: &Loaded) -> Result<Walk> {
    let known = STRUCTURES.map(|structure| (structure.name, structure));
    let one = args.index.as_ref().map(|name| named("index", name, &known)).transpose()?;
    Ok(chapter_4::step::walk(&chapter_4::step::Request {
        name: &args.scene,
        loaded,
        size: args.size,
        pixel: args.pixel,
        structures: one.as_ref().map_or(&STRUCTURES, std::slice::from_ref),
    }))
}

/// Refuses what cannot be written as a page, before the work.
fn check_page(out: &Path) -> Result<()> {
    let is_page = out.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("html"));
    ensure!(is_page, "what kind of file is `{}`? Its name must end in .html", out.display());
    Ok(check_writable(out)?)
}
