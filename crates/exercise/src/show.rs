//! The picture of a student's functions beside the reference's.

use lancer_core::image::{Image, ImageSize};
use lancer_core::metric::absolute_error_map;
use lancer_figure::{HeatScale, Inset, Montage, Picture, Plate, Tile, method_color, number};

use crate::Exercise;

/// Differences below are rounding.
const VISIBLE: f64 = 1e-4;

/// A plate that compares two subjects' pictures of an exercise, and the first wrong pixel in reading
/// order.
pub(crate) struct Comparison {
    pub(crate) plate: Plate,
    pub(crate) first_wrong: Option<[u32; 2]>,
}

pub(crate) fn compare<S>(exercise: &Exercise<S>, yours: &Image, reference: &Image) -> Comparison {
    let card = exercise.card;
    let (width, height) = (reference.size().width, reference.size().height);
    let map = absolute_error_map(reference, yours)
        .unwrap_or_else(|_| vec![f64::NAN; reference.size().pixels()]);
    // A NaN is wrong too.
    let is_wrong = |error: &f64| error.is_nan() || *error > VISIBLE;
    let wrong = map.iter().filter(|error| is_wrong(error)).count();
    let first_wrong = map.iter().position(is_wrong).map(|index| {
        let index = index as u32;
        [index % width, index / width]
    });
    let claim = match first_wrong {
        None => "Your picture is the reference's.".to_owned(),
        Some([x, y]) => format!(
            "{wrong} of {} pixels differ; the first is in column {x} of row {y}.",
            map.len()
        ),
    };
    let largest = map.iter().copied().filter(|error| error.is_finite()).fold(1e-3, f64::max);
    let scale = HeatScale::log("|difference|", VISIBLE, largest.max(2.0 * VISIBLE));
    let mut montage = Montage::new()
        .tile(Tile::new("reference", shown(reference)).color(method_color("reference")))
        .tile(Tile::new("yours", shown(yours)).color(method_color("whitted")))
        .tile(Tile::new("difference", scale.paint(width, height, &map)))
        .color_bar(&scale);
    if let Some([x, y]) = first_wrong {
        montage = montage.inset(around(x, y, reference.size()));
    }
    let plate = Plate::new(card.id, card.title, claim, first_wrong.is_none())
        .panel(montage)
        .note("Slide", card.slide)
        .note("Predict", card.predict)
        .note("Then", card.vary)
        .note("Difference", format!("less than {} counts as rounding", number(VISIBLE)));
    Comparison { plate, first_wrong }
}

fn shown(image: &Image) -> Picture {
    let ImageSize { width, height, .. } = image.size();
    Picture::new(width, height, image.to_srgb8(0.0))
}

/// The part of the picture around a pixel, an eighth of its width wide.
fn around(x: u32, y: u32, size: ImageSize) -> Inset {
    let wide = (size.width / 8).clamp(1, size.width);
    let tall = (wide * 3 / 4).clamp(1, size.height);
    let left = x.saturating_sub(wide / 2).min(size.width - wide);
    let top = y.saturating_sub(tall / 2).min(size.height - tall);
    Inset::new(left, top, wide, tall)
}
