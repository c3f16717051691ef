//! MTL's highlight, (N·H)^Ns, drawn by the slides' (R·V)ⁿ: measured against the closed form.

use glam::dvec3;

use super::*;
use crate::geometry::Ray;
use crate::illumination::{Arriving, Reflectance};

/// The exponent of the highlight of a plane with this `Ns`, as the scene file draws it.
fn exponent(ns: f64) -> f64 {
    let plane = b"mtllib plane.mtl\nv -3 -3 0\nv 3 -3 0\nv 3 3 0\nv -3 3 0\nusemtl m\nf 1 2 3 4\n";
    let library = format!("newmtl m\nKd 0 0 0\nKs 1 1 1\nNs {ns}\nillum 2\n");
    let scene = b"[[light]]\nposition = [0, 0, 3]\nintensity = 9\n[[mesh]]\nobj = 'plane.obj'\n";
    let files: [(&str, &[u8]); 3] =
        [("s.toml", scene), ("plane.obj", plane), ("plane.mtl", library.as_bytes())];
    load_from(&files, "s.toml").expect("fine").scene.materials[0].shininess
}

/// What a plane sends back to the eye at (0, 0, 3), of a light of intensity 9 there, at the point that both see under
/// this angle.
fn drawn(shininess: f64, degrees: f64) -> f64 {
    let reflectance = Reflectance { diffuse: Rgb::ZERO, specular: Rgb::ONE, shininess };
    let to_light = dvec3(-3.0 * degrees.to_radians().tan(), 0.0, 3.0);
    let shadow_ray = Ray::new(-to_light + 3.0 * DVec3::Z, to_light);
    let light = Arriving { shadow_ray, intensity: |_| Rgb::splat(9.0) };
    light.unshadowed(&reflectance, DVec3::Z, to_light.normalize()).x
}

/// MTL's: H = N·L = N·V = cos θ here, and 9/d² = cos² θ.
fn closed_form(ns: f64, degrees: f64) -> f64 {
    let cos = degrees.to_radians().cos();
    cos * cos * cos.powf(ns)
}

/// The largest difference up to 20°; the peak is 1.
fn largest_error(ns: f64) -> f64 {
    let n = exponent(ns);
    let error = |i| {
        let degrees = f64::from(i) / 100.0;
        let cos = degrees.to_radians().cos();
        // The light's own fall is no part of the highlight.
        (drawn(n, degrees) - closed_form(ns, degrees)).abs() / (cos * cos)
    };
    (0..=2000).map(error).fold(0.0, f64::max)
}

/// The plane of the report that was drawn with 0.0238 where (N·H)⁴⁰ has 0.388.
#[test]
fn a_plane_has_the_highlight_of_its_file() {
    let expected = closed_form(40.0, 12.1);
    assert!((expected - 0.3887).abs() < 1e-3, "{expected}");
    let found = drawn(exponent(40.0), 12.1);
    assert!((found - expected).abs() < 0.01, "{found} for {expected}");
    // cos² 12.1° · cos¹⁰ 24.2°
    assert!((found - 0.3812).abs() < 1e-3, "{found}");
}

/// The numbers of the documentation: 2.6 % of the peak from `Ns` 4 on, 0.54/Ns where it is large, 23 % at 0.
#[test]
fn the_error_of_the_mapping_is_as_documented() {
    let errors: Vec<f64> =
        (16..1600).map(|quarters| largest_error(f64::from(quarters) / 4.0)).collect();
    let largest = errors.iter().fold(0.0, |a: f64, &b| a.max(b));
    assert!((0.0252..0.0254).contains(&largest), "{largest}");
    for ns in [100.0, 400.0, 1000.0] {
        let scaled = ns * largest_error(ns);
        assert!((0.541..0.553).contains(&scaled), "{ns}: {scaled}");
    }
    let widest = largest_error(0.0);
    assert!((0.2339..0.2340).contains(&widest), "{widest}");
}

/// From 44° to 46° the light's mirror direction leaves the eye's half-space: no file's highlight ends in a step
/// there, nor in a fall that is steeper than a matte surface's.
#[test]
fn no_highlight_of_a_file_ends_in_an_edge() {
    for ns in [0.0, 0.001, 1.0, 3.9, 4.0, 10.0, 1000.0] {
        let n = exponent(ns);
        let values: Vec<f64> = (4400..4600).map(|i| drawn(n, f64::from(i) / 100.0)).collect();
        let steepest = values.windows(2).map(|pair| (pair[0] - pair[1]).abs()).fold(0.0, f64::max);
        // d/dθ of cos 2θ cos² θ is −1.07 at 44°.
        assert!(steepest < 1.07 * 0.01_f64.to_radians(), "{ns}: {steepest}");
    }
    // The naive n = Ns: a step of cos² 45°.
    assert!(drawn(0.0, 44.99) - drawn(0.0, 45.01) > 0.49);
}

/// A scene file names the slides' own exponent.
#[test]
fn scene_files_keep_their_exponent() {
    for n in [0.0, 0.5, 40.0] {
        let text = format!(
            "ambient = 1\nmaterial.m = {{ rho_s = 0.1, shininess = {n:?} }}\n\
             [[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'm'\n"
        );
        let loaded = parse_scene(&text, "s.toml", Path::new("")).expect("fine");
        assert_eq!(loaded.scene.materials[0].shininess, n);
    }
}
