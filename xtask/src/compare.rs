use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow, ensure};
use lancer_core::image::{Image, load};
use lancer_core::metric::{compare, psnr_srgb8};

/// The errors of one picture against another.
///
/// PNG files are read as sRGB, EXR files as linear radiances; RMSE, relMSE, maximum and 99th percentile are of
/// linear values, PSNR and FLIP of what a display shows. A picture with a pixel that is not finite has no error, and
/// is refused.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  cargo xtask compare reference.exr estimate.png")]
pub struct Args {
    /// The picture that counts as right
    reference: PathBuf,
    /// The picture to be judged
    image: PathBuf,
}

pub fn run(args: &Args) -> Result<()> {
    let (reference, image) = (load(&args.reference)?, load(&args.image)?);
    let defects = [(&args.reference, &reference), (&args.image, &image)];
    let defects: Vec<String> =
        defects.into_iter().filter_map(|(file, image)| not_finite(file, image)).collect();
    ensure!(
        defects.is_empty(),
        "{}: no error has a value; make it anew, or mend these pixels",
        defects.join("; ")
    );
    let errors = compare(&reference, &image)
        .map_err(|error| anyhow!("{}: {error}; make both of one size", args.image.display()))?;
    say!("RMSE       {:.6e}", errors.rmse);
    say!("relMSE     {:.6e}", errors.rel_mse);
    say!("maximum    {:.6e}", errors.max);
    say!("99th perc. {:.6e}", errors.p99);
    say!("PSNR       {:.2} dB (8-bit sRGB)", psnr_srgb8(&reference, &image)?);
    say!("FLIP       {:.6}", errors.flip);
    Ok(())
}

/// How many pixels of a picture are not finite, and where the first one is.
fn not_finite(file: &Path, image: &Image) -> Option<String> {
    let mut places = image.not_finite();
    let [x, y] = places.next()?;
    let count = 1 + places.count();
    let are = if count == 1 { "pixel is" } else { "pixels are" };
    Some(format!(
        "{}: {count} {are} not finite, the first in column {x} of row {y}",
        file.display()
    ))
}
