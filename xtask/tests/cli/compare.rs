//! `compare`: one picture measured against another.

use insta::assert_snapshot;
use lancer_core::image::{Image, ImageSize, save};

use super::{accepted, folder, refusals, text};

#[test]
fn pictures_that_cannot_be_compared_are_refused() {
    let folder = folder(&[("noise.exr", b"no picture")]);
    for (name, size) in [("a.png", "8x8"), ("b.exr", "8x4")] {
        accepted(&folder, &["render", "whitted", "--size", size, "--out", name]);
    }
    let pairs = [
        ["a.png", "b.exr"],
        ["a.png", "missing.png"],
        ["noise.exr", "a.png"],
        ["old.png", "a.png"],
        ["a.jpg", "a.png"],
    ];
    let line = |[reference, image]: [&'static str; 2]| vec!["compare", reference, image];
    assert_snapshot!(refusals(&folder, pairs.map(line)), @r"
    error: b.exr: cannot compare a picture of 8x4 with a reference of 8x8 pixels; make both of one size
    error: there is no picture `missing.png`; check its name and the current folder
    error: cannot decode `noise.exr`: it is damaged, or of another format than its name tells: invalid: file identifier missing; make it anew
    error: cannot decode `old.png`: it is damaged, or of another format than its name tells: unexpected end of file; make it anew
    error: what kind of picture is `a.jpg`? Its name must end in .png (sRGB) or .exr (linear)
    ");
    // A NaN in the last column of the second row, and another infinity.
    let size = ImageSize::new(3, 2);
    let finite = [[0.5; 3]; 6];
    let (mut one, mut two) = (finite, finite);
    one[5][1] = f32::NAN;
    (two[1][0], two[4][2]) = (f32::INFINITY, f32::NAN);
    for (name, pixels) in [("finite", finite), ("one", one), ("two", two)] {
        let image = Image::from_pixels(size, pixels.to_vec());
        save(folder.path().join(name).with_extension("exr"), &image, 0.0).unwrap();
    }
    let pairs = [["finite.exr", "one.exr"], ["two.exr", "finite.exr"], ["one.exr", "two.exr"]];
    assert_snapshot!(refusals(&folder, pairs.map(line)), @r"
    error: one.exr: 1 pixel is not finite, the first in column 2 of row 1: no error has a value; make it anew, or mend these pixels
    error: two.exr: 2 pixels are not finite, the first in column 1 of row 0: no error has a value; make it anew, or mend these pixels
    error: one.exr: 1 pixel is not finite, the first in column 2 of row 1; two.exr: 2 pixels are not finite, the first in column 1 of row 0: no error has a value; make it anew, or mend these pixels
    ");
    let same = accepted(&folder, &["compare", "a.png", "a.png"]);
    assert_snapshot!(text(&same.stdout), @r"
    RMSE       0.000000e0
    relMSE     0.000000e0
    maximum    0.000000e0
    99th perc. 0.000000e0
    PSNR       inf dB (8-bit sRGB)
    FLIP       0.000000
    ");
}
