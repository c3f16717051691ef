//! `cargo xtask`: the course's command line. It parses, calls and reports; the algorithms are in
//! `crates/`, the figures in `chapters/`.

/// Prints a line. Unlike `println!` it does not panic when nobody reads on, as in `… | head`, and it leaves
/// out colours where there are none, or `NO_COLOR` forbids them.
macro_rules! say {
    ($($text:tt)*) => {{
        use std::io::Write;
        let _ = writeln!(anstream::stdout(), $($text)*);
    }};
}

mod arguments;
mod chapters;
mod compare;
mod eq;
mod exercise;
mod figures;
mod labels;
mod names;
mod progress;
mod render;
mod repository;
mod scene;
mod step;
mod tidy;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// The ray-tracing course one can run.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Figures(figures::Args),
    Render(render::Args),
    Step(step::Args),
    Compare(compare::Args),
    Eq(eq::Args),
    Exercise(exercise::Args),
    /// Checks the rules of the house: labels, dependencies, documentation, links, sizes.
    Tidy,
}

fn main() -> ExitCode {
    let done = |()| ExitCode::SUCCESS;
    let result = match Cli::parse().command {
        Command::Figures(args) => figures::run(&args).map(done),
        Command::Render(args) => render::run(&args).map(done),
        Command::Step(args) => step::run(&args).map(done),
        Command::Compare(args) => compare::run(&args).map(done),
        Command::Eq(args) => eq::run(&args).map(done),
        Command::Exercise(args) => exercise::run(&args),
        Command::Tidy => tidy::run().map(done),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
