use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use lancer_core::image::{ImageSize, check_writable, write_atomically};
use lancer_core::method::Setting;
use lancer_lesson::chapter::WalkOrder;

use crate::arguments::{indexes, structure, warn_of_unused, whole};
use crate::chapters::{list, walks};
use crate::names::named;
use crate::scene;

/// The most steps of a page: its drawing has all of them.
const MOST_STEPS: usize = 5000;

/// Walks through an algorithm for one pixel, step by step.
#[derive(clap::Args)]
#[command(long_about = about(), after_help = "Examples:
  cargo xtask step whitted --scene whitted --pixel 246,157
  cargo xtask step whitted --scene room --pixel 200,300 --depth 2
  cargo xtask step whitted --scene whitted --pixel 246,157 --out step.html   a page with a slider
  cargo xtask step accel --scene stadium:20000 --pixel 256,256 --out step.html
  cargo xtask step accel --scene town:2000 --pixel 256,300 --index kd")]
pub struct Args {
    #[arg(help = algorithms())]
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
    /// Largest number of bounces between the eye and a surface (whitted); 5 unless given
    #[arg(long, value_parser = whole::<u32>(0, 16), allow_negative_numbers = true)]
    depth: Option<u32>,
    #[arg(long, help = format!("Only this index: {} (accel)", indexes()))]
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
    let algorithm = named("algorithm", &args.algorithm, walks(), |walk| walk.name)?;
    let index = args.index.as_ref();
    let index = index.map(|index| structure(index)).transpose()?.map(|structure| structure.name);
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
    let flags = [
        ("--depth", Setting::MaxDepth, args.depth.is_some()),
        ("--index", Setting::Index, index.is_some()),
    ];
    warn_of_unused(flags, algorithm.uses, algorithm.name);
    let walk = (algorithm.walk)(&WalkOrder {
        name: &args.scene,
        loaded: &loaded,
        size,
        pixel: args.pixel,
        max_depth: args.depth,
        index,
    })?;
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

fn algorithms() -> String {
    let names: Vec<&str> = walks().map(|walk| walk.name).collect();
    list(&names, "or")
}

fn about() -> String {
    let walks: Vec<String> = walks().map(|walk| format!("{} {}.", walk.name, walk.about)).collect();
    format!("Walks through an algorithm for one pixel, step by step.\n\n{}", walks.join("\n\n"))
}

/// Refuses what cannot be written as a page, before the work.
fn check_page(out: &Path) -> Result<()> {
    let is_page = out.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("html"));
    ensure!(is_page, "what kind of file is `{}`? Its name must end in .html", out.display());
    Ok(check_writable(out)?)
}
