use std::path::PathBuf;

use anyhow::{Result, anyhow};
use lancer_core::image::load;
use lancer_core::metric::{compare, psnr_srgb8};

/// The errors of one picture against another.
///
/// PNG files are read as sRGB, EXR files as linear radiances; RMSE, relMSE, maximum and 99th percentile are of
/// linear values, PSNR and FLIP of what a display shows.
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
