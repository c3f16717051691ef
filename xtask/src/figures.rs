use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use lancer_core::image::write_atomically;
use lancer_figure::{Effort, Entry, Figure, Verdict, index_html};
use lancer_lesson::Chapter;

use crate::chapters::{CHAPTERS, figures};
use crate::names::choose;
use crate::progress;
use crate::repository::root;

/// Draws the course's figures, each with its data, and a page of all of them.
///
/// Every figure states a claim; whether it holds is computed from the figure's data and printed. Without
/// a selection all figures are drawn.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  cargo xtask figures                 all figures, into target/figures, with index.html
  cargo xtask figures 1.7 --quick     one figure, small
  cargo xtask figures 1 --out plates  the figures of chapter 1 into the folder plates
  cargo xtask figures --list")]
pub struct Args {
    /// Chapters (1, 4) and figures (1.7, or by name: depth)
    #[arg(value_name = "CHAPTER|FIGURE")]
    selection: Vec<String>,
    /// Only names the figures
    #[arg(long)]
    list: bool,
    /// Small pictures and few points
    #[arg(long)]
    quick: bool,
    /// The folder to draw into
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn run(args: &Args) -> Result<()> {
    let selected = select(&args.selection)?;
    if args.list {
        for (chapter, figure) in selected {
            say!("{:<5} {:<14} {}", figure.id, figure.name, heading(chapter));
        }
        return Ok(());
    }
    let out = args.out.clone().unwrap_or_else(|| root().join("target").join("figures"));
    let effort = if args.quick { Effort::Quick } else { Effort::Full };
    progress::watch_for_interrupt()?;
    let bar = progress::bar(selected.len() as u64, "drawing");

    let mut entries = Vec::new();
    let mut failed = Vec::new();
    for (chapter, figure) in selected {
        if progress::INTERRUPTED.load(std::sync::atomic::Ordering::Relaxed) {
            bail!("interrupted; the figures drawn so far are in {}", out.display());
        }
        bar.set_message(format!("{} {}", figure.id, figure.name));
        let entry = draw(chapter, figure, effort, &out)?;
        let verdict = match entry.verdict {
            Verdict::Holds => "holds",
            Verdict::Fails => {
                failed.push(figure.id);
                "FAILS"
            }
        };
        bar.suspend(|| {
            say!(
                "{:<5} {:<14} {:5.1} s  {verdict}: {}",
                figure.id,
                figure.name,
                entry.seconds,
                entry.claim
            );
        });
        bar.inc(1);
        entries.push(entry);
    }
    bar.finish_and_clear();
    let page = out.join("index.html");
    write_atomically(&page, index_html("Lancer: the plates", &entries).as_bytes())?;
    say!("{} figures in {}", entries.len(), page.display());
    if !failed.is_empty() {
        say!("claims that do not hold here: {}", failed.join(", "));
    }
    Ok(())
}

/// The figures that the words choose, in the course's order.
fn select(words: &[String]) -> Result<Vec<(&'static Chapter, &'static Figure)>> {
    let all: Vec<(&Chapter, &Figure)> = figures().collect();
    if words.is_empty() {
        return Ok(all);
    }
    let mut names: Vec<&str> =
        all.iter().flat_map(|(_, figure)| [figure.id, figure.name]).collect();
    names.extend(CHAPTERS.iter().map(|chapter| chapter.number));
    let chosen: Vec<&str> = words
        .iter()
        .map(|word| Ok(names[choose("figure or chapter", word, &names)?]))
        .collect::<Result<_>>()?;
    let is_chosen = |(chapter, figure): &(&Chapter, &Figure)| {
        chosen.iter().any(|name| [chapter.number, figure.id, figure.name].contains(name))
    };
    let selected: Vec<_> = all.into_iter().filter(is_chosen).collect();
    if selected.is_empty() {
        let chapters = chosen.join(" and ");
        bail!(
            "chapter {chapters} has no figures; `cargo xtask figures --list` lists those that there are"
        );
    }
    Ok(selected)
}

/// A chapter's number and title.
fn heading(chapter: &Chapter) -> String {
    format!("{} {}", chapter.number, chapter.title)
}

/// Makes one figure and writes its files.
fn draw(chapter: &Chapter, figure: &Figure, effort: Effort, out: &Path) -> Result<Entry> {
    let start = Instant::now();
    let finished = (figure.make)(effort);
    let command = match effort {
        Effort::Quick => format!("cargo xtask figures {} --quick", figure.id),
        Effort::Full => format!("cargo xtask figures {}", figure.id),
    };
    let machine = machine();
    let plate = finished.plate.note("Machine", machine.as_str()).note("Command", command.as_str());
    let canvas = plate.canvas();
    let (png, svg) = (canvas.to_png(1.0), canvas.to_svg());
    let seconds = start.elapsed().as_secs_f64();

    let name = format!("{}-{}", figure.id, figure.name);
    let folder = out.join(chapter.folder).join(&name);
    fs::create_dir_all(&folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let meta = serde_json::json!({
        "id": figure.id,
        "name": figure.name,
        "title": plate.title(),
        "claim": plate.claim(),
        "holds": plate.verdict() == Verdict::Holds,
        "caption": plate.caption().lines().collect::<Vec<_>>(),
        "command": command,
        "machine": machine,
        "version": env!("CARGO_PKG_VERSION"),
        "seconds": seconds,
    });
    let files = [
        ("figure.png", png.clone()),
        ("figure.svg", svg.into_bytes()),
        ("data.csv", finished.data.to_csv().into_bytes()),
        ("meta.json", (serde_json::to_string_pretty(&meta)? + "\n").into_bytes()),
    ];
    let mut entry = Entry::of(&plate, heading(chapter), seconds, png);
    for (file, bytes) in files {
        write_atomically(folder.join(file), &bytes)?;
        entry = entry.file(format!("{}/{name}/{file}", chapter.folder));
    }
    Ok(entry)
}

/// The processor, as far as the system tells, and the threads in use.
fn machine() -> String {
    let model = fs::read_to_string("/proc/cpuinfo").ok().and_then(|info| {
        let line = info.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    format!(
        "{}, {} threads, {} {}",
        model.as_deref().unwrap_or("unknown processor"),
        rayon::current_num_threads(),
        std::env::consts::ARCH,
        std::env::consts::OS,
    )
}
