//! Loads a scene and reports its size, its warnings and the time taken:
//! `cargo run --release -p lancer-core --example load -- model.obj`

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use lancer_core::scene::load::load;

fn main() -> ExitCode {
    let Some(path) = std::env::args_os().nth(1) else {
        eprintln!("usage: load SCENE.{{toml,obj}}");
        return ExitCode::FAILURE;
    };
    let start = Instant::now();
    match load(Path::new(&path)) {
        Ok(loaded) => {
            println!("{:.3} s, {:?}", start.elapsed().as_secs_f64(), loaded.scene.counts());
            println!("{:?}", loaded.scene.camera);
            for warning in &loaded.warnings {
                println!("warning: {warning}");
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
