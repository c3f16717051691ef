//! Whole plates, seen as a figure's author sees them.

use lancer_figure::{
    Axis, BarChart, Canvas, Chart, Drawing, INK, Montage, Picture, Plate, Row, Series, Stroke,
    Tile, Tree, WIDTH, category_color,
};

fn full() -> Canvas {
    let chart = || {
        Chart::new(Axis::linear("angle (°)").between(0.0, 90.0), Axis::log("error")).series(
            Series::new("f32", category_color(0))
                .points((0..=9).map(|k| (10.0 * f64::from(k), 1e-6))),
        )
    };
    let picture = Picture::from_fn(50, 30, |x, y| [x as u8 * 5, y as u8 * 8, 0]);
    Plate::new("1.5", "A title", "A claim.", false)
        .panel(
            Montage::new()
                .tile(Tile::new("left", picture.clone()))
                .tile(Tile::new("right", picture)),
        )
        .panel(Row::new().panel(2.0, chart()).panel(1.0, chart()))
        .panel(BarChart::new("rays", ["a", "b"]).series("one", INK, [1.0, 2.0]))
        .panel(Tree::new("eye", INK).child("R", Tree::new("sky", INK)))
        .panel(Drawing::new([0.0, 0.0], [2.0, 1.0], 200.0, |pen| {
            pen.arrow([0.0, 0.0], [1.0, 1.0], Stroke::new(INK, 2.0));
        }))
        .note("Method", "all of them")
        .canvas()
}

#[test]
fn every_panel_fits_in_one_plate() {
    let canvas = full();
    assert_eq!(canvas.faults(), []);
    assert_eq!(canvas.width(), WIDTH);
}

#[test]
fn the_png_has_the_size_asked_for() {
    let canvas = full();
    for scale in [0.25, 1.0, 1.5] {
        let png = canvas.to_png(scale);
        let read = image::load_from_memory(&png).unwrap();
        let size = [canvas.width(), canvas.height()].map(|side| (side * scale).ceil() as u32);
        assert_eq!([read.width(), read.height()], size);
    }
}

#[test]
fn png_and_svg_are_the_same_on_every_run() {
    assert_eq!(full().to_png(0.5), full().to_png(0.5));
    assert_eq!(full().to_svg(), full().to_svg());
}

#[test]
fn empty_panels_leave_a_plate() {
    let canvas = Plate::new("", "", "", true)
        .panel(Montage::new())
        .panel(Row::new())
        .panel(BarChart::new("", Vec::<String>::new()))
        .panel(Tree::new("", INK))
        .panel(Chart::new(Axis::linear(""), Axis::log("")))
        .canvas();
    assert_eq!(canvas.faults(), []);
    assert!(!canvas.to_svg().contains("NaN") && !canvas.to_svg().contains("inf"));
}

#[test]
#[should_panic(expected = "lies outside the picture")]
fn a_detail_outside_its_picture_is_refused() {
    let picture = Picture::new(4, 4, vec![[0; 3]; 16]);
    let montage =
        Montage::new().tile(Tile::new("", picture)).inset(lancer_figure::Inset::new(2, 2, 4, 4));
    Plate::new("", "", "", true).panel(montage).canvas();
}
