//! Pictures in rows, with the same details of each enlarged.

use crate::canvas::Canvas;
use crate::geometry::Rect;
use crate::heat::HeatScale;
use crate::picture::Picture;
use crate::plate::Panel;
use crate::shape::{Color, Style, Text};
use crate::style::{FAINT, HEADING, MUTED, TICK};
use crate::wrap::Paragraph;

/// A picture of a montage.
#[derive(Clone, Debug)]
pub struct Tile {
    picture: Picture,
    title: String,
    subtitle: String,
    color: Option<Color>,
}

impl Tile {
    /// A picture with its title. It is drawn as wide as its column: enlarged in crisp pixels, or shrunk.
    pub fn new(title: impl Into<String>, picture: Picture) -> Self {
        Self { picture, title: title.into(), subtitle: String::new(), color: None }
    }

    /// With text below the picture, such as its error and cost.
    pub fn subtitle(self, subtitle: impl Into<String>) -> Self {
        Self { subtitle: subtitle.into(), ..self }
    }

    /// With a bar of its method's colour over the picture.
    pub fn color(self, color: Color) -> Self {
        Self { color: Some(color), ..self }
    }

    fn title_block(&self, width: f64) -> Paragraph {
        Paragraph::new(Text::new(&self.title, HEADING).bold(), width)
    }

    fn subtitle_block(&self, width: f64) -> Paragraph {
        Paragraph::new(Text::new(&self.subtitle, TICK).color(MUTED), width)
    }
}

/// A rectangle of pixels to be enlarged.
#[derive(Clone, Copy, Debug)]
pub struct Inset {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

impl Inset {
    /// The part of `width` × `height` pixels whose upper left pixel is (`x`, `y`).
    pub const fn new(x: u32, y: u32, width: u32, height: u32) -> Self {
        Self { x, y, width, height }
    }

    fn aspect(self) -> f64 {
        f64::from(self.height) / f64::from(self.width)
    }
}

/// The frames of the insets, in order: bright, to be seen on pictures.
const FRAMES: [Color; 4] = [
    Color::rgb(0xff, 0x8c, 0x1a),
    Color::rgb(0x2f, 0xb5, 0xff),
    Color::rgb(0xf0, 0xe4, 0x42),
    Color::rgb(0xe0, 0x6f, 0xb8),
];

/// Pictures of one size in rows, each with the same details enlarged.
#[derive(Clone, Debug, Default)]
pub struct Montage {
    tiles: Vec<Tile>,
    columns: Option<usize>,
    insets: Vec<Inset>,
    insets_right: bool,
    scale: Option<HeatScale>,
}

const GAP: f64 = 20.0;
const ROW_GAP: f64 = 28.0;
const COLOR_BAR: f64 = 7.0;

impl Montage {
    /// A montage without pictures.
    pub fn new() -> Self {
        Self::default()
    }

    /// With one more picture.
    pub fn tile(mut self, tile: Tile) -> Self {
        self.tiles.push(tile);
        self
    }

    /// With `columns` pictures in a row (at least 1) instead of up to four.
    pub fn columns(self, columns: usize) -> Self {
        Self { columns: Some(columns.max(1)), ..self }
    }

    /// With one more detail enlarged in every picture; it must lie within each.
    pub fn inset(mut self, inset: Inset) -> Self {
        self.insets.push(inset);
        self
    }

    /// With the details at the right of the pictures instead of below.
    pub fn insets_right(self) -> Self {
        Self { insets_right: true, ..self }
    }

    /// With the colour bar of the heat maps among the pictures, at the right.
    pub fn color_bar(self, scale: &HeatScale) -> Self {
        Self { scale: Some(scale.clone()), ..self }
    }

    fn column_count(&self) -> usize {
        self.columns.unwrap_or(4).min(self.tiles.len()).max(1)
    }

    fn column_width(&self, width: f64) -> f64 {
        let bar = self.scale.as_ref().map_or(0.0, |scale| scale.bar_width() + GAP);
        let columns = self.column_count() as f64;
        (width - bar - (columns - 1.0) * GAP) / columns
    }

    /// The rows of a montage `width` px wide.
    fn rows(&self, width: f64) -> Vec<RowLayout<'_>> {
        let column = self.column_width(width);
        self.tiles
            .chunks(self.column_count())
            .map(|tiles| RowLayout::new(self, tiles, column))
            .collect()
    }

    /// The rectangles of a tile's picture and of its enlarged details, in a column at the origin.
    fn pictures(&self, tile: &Tile, column: f64) -> (Rect, Vec<Rect>) {
        let aspect = tile.picture.aspect();
        let count = self.insets.len() as f64;
        if self.insets.is_empty() {
            return (Rect::new(0.0, 0.0, column, column * aspect), Vec::new());
        }
        let gaps = (count - 1.0) * INSET_GAP;
        if self.insets_right {
            // The details, stacked, are as tall as the picture: solve for its width.
            let widest = self.insets.iter().map(|inset| 1.0 / inset.aspect()).fold(0.0, f64::max);
            let width =
                (column - INSET_GAP + gaps * widest / count) / (1.0 + aspect * widest / count);
            let picture = Rect::new(0.0, 0.0, width, width * aspect);
            let height = (picture.height - gaps) / count;
            let zooms = self.insets.iter().enumerate().map(|(i, inset)| {
                Rect::new(
                    width + INSET_GAP,
                    i as f64 * (height + INSET_GAP),
                    height / inset.aspect(),
                    height,
                )
            });
            (picture, zooms.collect())
        } else {
            let picture = Rect::new(0.0, 0.0, column, column * aspect);
            let width = (column - gaps) / count;
            let zooms = self.insets.iter().enumerate().map(|(i, inset)| {
                let left = i as f64 * (width + INSET_GAP);
                Rect::new(left, picture.height + INSET_GAP, width, width * inset.aspect())
            });
            (picture, zooms.collect())
        }
    }
}

const INSET_GAP: f64 = 10.0;

/// The parts of one row, from its top: titles, colour bars, pictures with details, subtitles.
struct RowLayout<'a> {
    tiles: &'a [Tile],
    titles: Vec<Paragraph>,
    subtitles: Vec<Paragraph>,
    /// The height of the colour bars, if any tile has one: titles stand level.
    bar: f64,
    title_height: f64,
    pictures_height: f64,
    main_height: f64,
    subtitle_height: f64,
}

impl<'a> RowLayout<'a> {
    fn new(montage: &Montage, tiles: &'a [Tile], column: f64) -> Self {
        let titles: Vec<Paragraph> = tiles.iter().map(|tile| tile.title_block(column)).collect();
        let subtitles: Vec<Paragraph> =
            tiles.iter().map(|tile| tile.subtitle_block(column)).collect();
        let tallest =
            |blocks: &[Paragraph]| blocks.iter().map(Paragraph::height).fold(0.0, f64::max);
        let bar = if tiles.iter().any(|tile| tile.color.is_some()) { COLOR_BAR } else { 0.0 };
        let (mut main_height, mut pictures_height) = (0.0_f64, 0.0_f64);
        for tile in tiles {
            let (picture, zooms) = montage.pictures(tile, column);
            main_height = main_height.max(picture.height);
            pictures_height =
                zooms.iter().map(Rect::bottom).fold(pictures_height.max(picture.height), f64::max);
        }
        let (title_height, subtitle_height) = (tallest(&titles) + 8.0 + bar, tallest(&subtitles));
        Self {
            tiles,
            titles,
            subtitles,
            bar,
            title_height,
            pictures_height,
            main_height,
            subtitle_height,
        }
    }

    fn height(&self) -> f64 {
        self.title_height + self.pictures_height + 4.0 + self.subtitle_height
    }

    fn draw(&self, montage: &Montage, canvas: &mut Canvas, rect: Rect, column: f64) {
        let (mut x, top) = (rect.x, rect.y + self.title_height);
        for ((tile, title), subtitle) in self.tiles.iter().zip(&self.titles).zip(&self.subtitles) {
            // Titles stand on their pictures, whatever their number of lines.
            title.draw(canvas, [x, top - self.bar - 8.0 - title.height()]);
            let (picture, zooms) = montage.pictures(tile, column);
            if let Some(color) = tile.color {
                let bar = Rect::new(x, top - self.bar, picture.width, self.bar);
                canvas.rect(bar, Style::fill(color));
            }
            let moved = |rect: Rect| Rect::new(rect.x + x, rect.y + top, rect.width, rect.height);
            draw_pictures(
                canvas,
                &tile.picture,
                moved(picture),
                &montage.insets,
                zooms.into_iter().map(moved),
            );
            subtitle.draw(canvas, [x, top + self.pictures_height + 4.0]);
            x += column + GAP;
        }
    }
}

fn draw_pictures(
    canvas: &mut Canvas,
    picture: &Picture,
    rect: Rect,
    insets: &[Inset],
    zooms: impl Iterator<Item = Rect>,
) {
    canvas.picture(rect, picture.clone());
    canvas.rect(rect, Style::outline(FAINT, 1.0));
    let pixel = rect.width / f64::from(picture.width());
    for ((inset, zoom), frame) in insets.iter().zip(zooms).zip(FRAMES.into_iter().cycle()) {
        let [x, y, width, height] =
            [inset.x, inset.y, inset.width, inset.height].map(|n| f64::from(n) * pixel);
        let mark = Rect::new(rect.x + x, rect.y + y, width, height).grown(2.0);
        // A dark rim keeps the frame visible on a bright picture.
        canvas.rect(mark, Style::outline(Color::rgb(0, 0, 0).with_alpha(150), 6.0));
        canvas.rect(mark, Style::outline(frame, 3.0));
        canvas.picture(zoom, picture.crop(inset.x, inset.y, inset.width, inset.height));
        // The frame reaches 1 px outwards, so that its round corners hide those of the picture.
        canvas.rect(zoom.grown(-1.5), Style::outline(frame, 5.0));
    }
}

impl Panel for Montage {
    fn height(&self, width: f64) -> f64 {
        let rows = self.rows(width);
        rows.iter().map(RowLayout::height).sum::<f64>()
            + ROW_GAP * rows.len().saturating_sub(1) as f64
    }

    fn draw(&self, canvas: &mut Canvas, rect: Rect) {
        let column = self.column_width(rect.width);
        let rows = self.rows(rect.width);
        let mut y = rect.y;
        for row in &rows {
            row.draw(self, canvas, Rect::new(rect.x, y, rect.width, row.height()), column);
            y += row.height() + ROW_GAP;
        }
        if let (Some(scale), Some(row)) = (&self.scale, rows.first()) {
            let right = rect.x + self.column_count() as f64 * (column + GAP);
            scale.draw_bar(
                canvas,
                Rect::new(right, rect.y + row.title_height, scale.bar_width(), row.main_height),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn montage() -> Montage {
        let picture = Picture::from_fn(64, 48, |x, y| [x as u8, y as u8, 0]);
        let tile =
            |title: &str| Tile::new(title, picture.clone()).subtitle("relMSE 2.1×10⁻⁴, 1.9 M rays");
        Montage::new()
            .tile(tile("a title so long that it must take two lines"))
            .tile(tile("short"))
            .tile(tile("third"))
            .inset(Inset::new(4, 4, 16, 12))
            .inset(Inset::new(30, 20, 8, 12))
            .color_bar(&HeatScale::log("error", 1e-4, 1.0))
    }

    #[test]
    fn everything_stays_in_the_rectangle() {
        for montage in
            [montage(), montage().insets_right(), montage().columns(2), montage().columns(1)]
        {
            let width = 900.0;
            let height = montage.height(width);
            let mut canvas = Canvas::new(width, height);
            montage.draw(&mut canvas, Rect::new(0.0, 0.0, width, height));
            assert_eq!(canvas.faults(), []);
            for tile in &montage.tiles {
                let column = montage.column_width(width);
                let (picture, zooms) = montage.pictures(tile, column);
                assert!(zooms.iter().all(|zoom| !zoom.overlaps(&picture)));
                assert!(zooms.iter().all(|zoom| zoom.right() <= column + 1e-9));
            }
        }
    }

    #[test]
    fn details_at_the_right_are_as_tall_as_the_picture() {
        let montage = montage().insets_right();
        let (picture, zooms) = montage.pictures(&montage.tiles[0], 800.0);
        assert!((zooms[1].bottom() - picture.height).abs() < 1e-9);
        let right = zooms.iter().map(Rect::right).fold(0.0, f64::max);
        assert!((right - 800.0).abs() < 1e-9, "the column is filled: {right}");
    }
}
