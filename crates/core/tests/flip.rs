//! FLIP against closed forms and against NVIDIA's own implementation, the Python package
//! flip-evaluator 1.7, on the pairs of pictures in `flip/`, made by `flip/make.py`.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use lancer_core::image::{Image, ImageSize, load};
use lancer_core::metric::{flip, flip_map};
use rayon::ThreadPoolBuilder;
use serde::Deserialize;

#[derive(Deserialize)]
struct Expected {
    mean: f64,
    /// Column, row and value of entries of the map.
    pixels: Vec<(usize, usize, f64)>,
}

fn pair(name: &str) -> [Image; 2] {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/flip");
    ["reference", "estimate"].map(|role| load(folder.join(format!("{name}-{role}.png"))).unwrap())
}

fn constant(pixel: [f32; 3]) -> Image {
    let size = ImageSize::new(9, 4);
    Image::from_pixels(size, vec![pixel; size.pixels()])
}

#[test]
fn means_and_pixels_agree_with_flip_evaluator() {
    let expected = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/flip/expected.toml");
    let expected: BTreeMap<String, Expected> =
        toml::from_str(&fs::read_to_string(expected).unwrap()).unwrap();
    assert_eq!(expected.len(), 8);
    for (name, expected) in expected {
        // NVIDIA computes in single precision. Where features or colours are nearly equal, as
        // beside an edge that both pictures have, the roots of the formulas turn a rounding of
        // 2e-8 into 1e-4: there its own results for a picture and its mirror image differ by 2e-4.
        let (mean_tolerance, tolerance) = match name.as_str() {
            "colour" | "edge" | "points" => (2e-5, 1e-4),
            _ => (1e-6, 2e-6),
        };
        let [reference, estimate] = pair(&name);
        let mean = flip(&reference, &estimate).unwrap();
        assert!((mean - expected.mean).abs() < mean_tolerance, "{name}: {mean}");
        let map = flip_map(&reference, &estimate).unwrap();
        for (x, y, value) in expected.pixels {
            let ours = map[y * reference.size().width as usize + x];
            assert!((ours - value).abs() < tolerance, "{name} ({x}, {y}): {ours} not {value}");
        }
    }
}

#[test]
fn pictures_of_one_colour_have_a_closed_form() {
    // By mpmath to 30 digits from L*a*b* by hand; green and blue are the paper's largest error.
    let (black, white) = ([0.0; 3], [1.0; 3]);
    let (green, blue) = ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    for (a, b, expected) in [
        (green, blue, 1.0),
        (black, white, 0.967_379_761_492_132),
        ([0.25; 3], [0.5; 3], 0.451_849_617_846_755),
        ([1.0, 0.0, 0.0], black, 0.970_497_336_561_987),
        (green, green, 0.0),
    ] {
        for (a, b) in [(a, b), (b, a)] {
            for value in flip_map(&constant(a), &constant(b)).unwrap() {
                // The square root of the feature difference turns a rounding of 1e-17 into 4e-9.
                assert!((value - expected).abs() < 1e-8, "{a:?} {b:?}: {value} not {expected}");
            }
        }
    }
}

#[test]
fn only_what_a_display_shows_counts() {
    let bright = [[f32::INFINITY; 3], [1e30, 7.0, 1.0]];
    for bright in bright {
        assert_eq!(flip(&constant([1.0; 3]), &constant(bright)), Ok(0.0));
    }
    assert_eq!(flip(&constant([0.0; 3]), &constant([-1.0, f32::NEG_INFINITY, -0.0])), Ok(0.0));
}

#[test]
fn a_nan_stains_the_pixels_that_the_filters_join_to_it() {
    let size = ImageSize::new(40, 30);
    let clean = Image::new(size);
    let mut pixels = clean.pixels().to_vec();
    pixels[4 * 40 + 20][1] = f32::NAN;
    let stained = Image::from_pixels(size, pixels);
    for (reference, estimate) in [(&clean, &stained), (&stained, &clean)] {
        assert!(flip(reference, estimate).unwrap().is_nan());
        let map = flip_map(reference, estimate).unwrap();
        let stains = |i: usize| (i / 40).abs_diff(4) <= 10 && (i % 40).abs_diff(20) <= 10;
        assert!(map.iter().enumerate().all(|(i, value)| value.is_nan() == stains(i)));
    }
}

#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    let [reference, estimate] = pair("noise");
    let bits = |threads| -> Vec<u64> {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let map = pool.install(|| flip_map(&reference, &estimate)).unwrap();
        map.into_iter().map(f64::to_bits).collect()
    };
    let single = bits(1);
    for threads in [2, 3, 7] {
        assert_eq!(bits(threads), single);
    }
}
