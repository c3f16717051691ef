use std::path::{Path, PathBuf};

use glam::DVec3;

use super::{MAX_COORDINATE, MAX_RADIANCE};

/// What is wrong, and what to do about it.
pub(super) type Problem = (String, &'static str);

/// The values a number may take.
#[derive(Clone, Copy)]
pub(super) enum Range {
    /// From 0 to 1: the share of the light that goes on.
    Share,
    NotNegative,
    Positive,
    /// Exponents of gloss.
    Gloss,
    /// Radiances and intensities: not negative, up to [`MAX_RADIANCE`].
    Radiance,
    /// Refractive indices: those that the MTL specification has, and their reciprocals. Beyond, the
    /// refracted direction would be a difference of huge numbers.
    Index,
    /// The kinds of material that an MTL file numbers.
    Illum,
}

/// `value`, named `name`, if it is in `range`; NaN and the infinities never are.
pub(super) fn in_range(name: &str, value: f64, range: Range) -> Result<f64, Problem> {
    let (holds, cure) = match range {
        Range::Share => ((0.0..=1.0).contains(&value), "it must be between 0 and 1"),
        Range::NotNegative => (value >= 0.0, "it must be finite and not negative"),
        Range::Positive => (value > 0.0, "it must be finite and positive"),
        Range::Gloss => {
            (value > 0.0, "it must be finite and positive; leave it out for a smooth surface")
        }
        Range::Radiance => ((0.0..=MAX_RADIANCE).contains(&value), "it must be between 0 and 1e30"),
        Range::Index => ((1e-3..=1e3).contains(&value), "it must be between 0.001 and 1000"),
        Range::Illum => (
            value.fract() == 0.0 && (0.0..=10.0).contains(&value),
            "it must be a whole number from 0 to 10",
        ),
    };
    if holds && value.is_finite() { Ok(value) } else { Err((format!("{name} is {value:?}"), cure)) }
}

/// Refuses a `count` of `what` beyond `limit`.
pub(super) fn within_limit(
    count: usize,
    what: &str,
    limit: usize,
    cure: &'static str,
) -> Result<(), Problem> {
    if count <= limit {
        Ok(())
    } else {
        Err((format!("{count} {what}, the maximum is {limit}"), cure))
    }
}

/// The path of a file that another one, in `folder`, names: in that folder or below it, and nowhere
/// else, so that files from a stranger cannot make us read others. A `\` separates folders, too. Links are
/// followed, and refused if they lead out, when the file is opened.
pub(super) fn beside(folder: &Path, what: &str, name: &str) -> Result<PathBuf, Problem> {
    let name = name.replace('\\', "/");
    let has_drive = name.as_bytes().get(1) == Some(&b':');
    if name.starts_with('/') || has_drive || name.split('/').any(|part| part == "..") {
        let problem = format!("{what} `{}` is outside this file's folder", excerpt(&name));
        return Err((
            problem,
            "put it beside this file or in a folder below, and name it from here",
        ));
    }
    Ok(folder.join(name))
}

/// The start of a text, short enough for a message.
pub(super) fn excerpt(text: &str) -> String {
    let text = text.trim();
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// Whether a point is finite and not so far that lengths and areas overflow.
pub(super) fn is_in_space(point: DVec3) -> bool {
    point.is_finite() && point.abs().max_element() <= MAX_COORDINATE
}
