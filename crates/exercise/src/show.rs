//! The picture of a student's functions beside the reference's.

use lancer_core::image::{Image, ImageSize};
use lancer_core::metric::absolute_error_map;
use lancer_figure::{HeatScale, Inset, Montage, Picture, Plate, Tile, method_color, number};

use crate::Exercise;

/// Differences below are rounding.
const VISIBLE: f64 = 1e-4;

/// A plate that compares two subjects' pictures of an exercise, and the most wrong pixel of where most is wrong.
pub(crate) struct Comparison {
    pub(crate) plate: Plate,
    pub(crate) worst: Option<[u32; 2]>,
}

pub(crate) fn compare<S>(exercise: &Exercise<S>, yours: &Image, reference: &Image) -> Comparison {
    let card = exercise.card;
    let size = reference.size();
    let (width, height) = (size.width, size.height);
    let map =
        absolute_error_map(reference, yours).unwrap_or_else(|_| vec![f64::NAN; size.pixels()]);
    let wrong = map.iter().filter(|error| weight(**error) > 0).count();
    let place = most_wrong(&map, size);
    let worst = place.map(|(_, worst)| worst);
    let claim = match worst {
        None => "Your picture is the reference's.".to_owned(),
        Some([x, y]) => format!(
            "{wrong} of {} pixels differ, most of all around column {x} of row {y}.",
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
    if let Some(([left, top], _)) = place {
        let [wide, tall] = window(size);
        montage = montage.inset(Inset::new(left, top, wide, tall));
    }
    let plate = Plate::new(card.id, card.title, claim, worst.is_none())
        .panel(montage)
        .note("Slide", card.slide)
        .note("Predict", plain(card.predict))
        .note("Then", plain(card.vary))
        .note("Difference", format!("less than {} counts as rounding", number(VISIBLE)));
    Comparison { plate, worst }
}

fn shown(image: &Image) -> Picture {
    let ImageSize { width, height, .. } = image.size();
    Picture::new(width, height, image.to_srgb8(0.0))
}

/// How much a difference counts, in millionths; it is seen as white at the most, and a NaN is as wrong as can be.
/// Whole numbers add up without rounding.
fn weight(error: f64) -> u64 {
    if error <= VISIBLE {
        0
    } else if error < 1.0 {
        (1e6 * error) as u64
    } else {
        1_000_000
    }
}

/// The width and height of what is magnified, an eighth of the picture's width.
fn window(size: ImageSize) -> [u32; 2] {
    let wide = (size.width / 8).clamp(1, size.width);
    [wide, (wide * 3 / 4).clamp(1, size.height)]
}

/// The upper left corner of the window with the most difference, and the most wrong pixel in it. Of equal windows
/// one that has a wrong pixel in its middle is taken, then the first in reading order.
fn most_wrong(map: &[f64], size: ImageSize) -> Option<([u32; 2], [u32; 2])> {
    let (width, [wide, tall]) = (size.width as usize, window(size));
    let at = |x: u32, y: u32| weight(map[y as usize * width + x as usize]);
    // Above and to the left of each corner of a pixel.
    let mut sums = vec![0_u64; (width + 1) * (size.height as usize + 1)];
    let corner = |x: u32, y: u32| y as usize * (width + 1) + x as usize;
    for y in 0..size.height {
        let mut row = 0;
        for x in 0..size.width {
            row += at(x, y);
            sums[corner(x + 1, y + 1)] = sums[corner(x + 1, y)] + row;
        }
    }
    let mut best = (0, 0);
    let mut place = None;
    for top in 0..=size.height - tall {
        for left in 0..=size.width - wide {
            let (right, bottom) = (left + wide, top + tall);
            let inside = sums[corner(left, top)] + sums[corner(right, bottom)]
                - sums[corner(right, top)]
                - sums[corner(left, bottom)];
            let found = (inside, at(left + wide / 2, top + tall / 2));
            if found > best {
                (best, place) = (found, Some([left, top]));
            }
        }
    }
    let [left, top] = place?;
    let pixels = (top..top + tall).flat_map(|y| (left..left + wide).map(move |x| [x, y]));
    let worst = pixels.rev().max_by_key(|&[x, y]| at(x, y))?;
    Some(([left, top], worst))
}

/// A text as it is read: code without its backticks, and words without the asterisks that stress them.
fn plain(text: &str) -> String {
    let mut is_code = false;
    let is_read = |c: &char| {
        is_code ^= *c == '`';
        *c != '`' && (*c != '*' || is_code)
    };
    text.chars().filter(is_read).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: ImageSize = ImageSize::new(64, 48);

    /// A map of no differences but some.
    fn map(errors: &[([u32; 2], f64)]) -> Vec<f64> {
        let mut map = vec![0.0; SIZE.pixels()];
        for ([x, y], error) in errors {
            map[(y * SIZE.width + x) as usize] = *error;
        }
        map
    }

    /// The window is 8 × 6.
    #[test]
    fn the_window_is_where_most_is_wrong() {
        assert_eq!(window(SIZE), [8, 6]);
        assert_eq!(most_wrong(&map(&[]), SIZE), None);
        // A lone pixel is in the middle, as far as the picture's edges let it.
        assert_eq!(most_wrong(&map(&[([30, 20], 0.5)]), SIZE), Some(([26, 17], [30, 20])));
        assert_eq!(most_wrong(&map(&[([63, 0], f64::NAN)]), SIZE), Some(([56, 0], [63, 0])));
        // A faint sky is wrong first, in reading order; what is seen is the ball below it.
        let sky = (0..64).map(|x| ([x, 0], 0.01));
        let ball = (40..44).flat_map(|x| (30..34).map(move |y| ([x, y], 0.3)));
        let errors: Vec<_> = sky.chain(ball).chain([([41, 31], 0.9)]).collect();
        let ([left, top], worst) = most_wrong(&map(&errors), SIZE).unwrap();
        assert!((36..=40).contains(&left) && (28..=30).contains(&top), "{left} {top}");
        assert_eq!(worst, [41, 31]);
    }

    #[test]
    fn marks_of_code_and_stress_are_not_read() {
        let text = "is *not* `0.5 * camera.fov`, and `*a - *b` *is*";
        assert_eq!(plain(text), "is not 0.5 * camera.fov, and *a - *b is");
    }
}
