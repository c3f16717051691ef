//! Files that are large without being models.

use std::fmt::Write;

use super::*;

#[test]
fn large_files_are_read_and_limits_named() {
    let mut text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned() + &"f 1 2 3\n".repeat(200_000);
    assert_eq!(obj(&text).expect("fine").scene.counts().triangles, 200_000);
    let polygon = |count: usize| {
        let mut text = String::new();
        let mut face = "f".to_owned();
        for i in 0..count {
            let angle = std::f64::consts::TAU * i as f64 / count as f64;
            writeln!(text, "v {} {} 0", angle.cos(), angle.sin()).expect("memory");
            write!(face, " {}", i + 1).expect("memory");
        }
        text + &face
    };
    let loaded = obj(polygon(100_000)).expect("fine");
    assert_eq!((loaded.scene.counts().faces, loaded.scene.counts().triangles), (1, 99_998));
    text = polygon(100_001);
    assert_refused(
        obj(text),
        "a.obj:100002: 100001 corners in one face, the maximum is 100000; split the face",
    );
}

#[test]
fn scene_files_are_limited() {
    let scene = |text: &[u8]| load_from(&[("s.toml", text)], "s.toml");
    assert_refused(
        scene(&vec![b'#'; MAX_BYTES + 1]),
        "s.toml: 67108865 or more bytes, the maximum is 67108864; move large meshes to OBJ files",
    );
    let corners = "[0, 0, 0],".repeat(100_001);
    let polygon = format!("[[polygon]]\nmaterial = 'm'\nvertices = [{corners}]\n");
    assert_refused(
        scene(format!("material.m.rho_d = 1\n{polygon}").as_bytes()),
        "s.toml:4: 100001 corners in one polygon, the maximum is 100000; split it",
    );
    // Brackets in brackets, and numbers beyond any type.
    for (text, place) in [
        (format!("ambient = {}", "[".repeat(100_000)), "1:"),
        (format!("\nambient{} = 1", ".a".repeat(100_000)), ""),
        (format!("\n\nambient = {}", "{ a = ".repeat(100_000)), "3:"),
        (format!("ambient = {}", "9".repeat(100_000)), "1:"),
        (format!("ambient = {}", "9".repeat(25)), "1:"),
        (format!("{} = 1", "a".repeat(100_000)), "1:"),
    ] {
        let message = scene(text.as_bytes()).expect_err("refused").to_string();
        assert!(message.starts_with(&format!("s.toml:{place} ")), "{message}");
        assert!(message.len() < 500 && message.contains("; "), "{message}");
    }
}

/// Many names cost no more than looking them up, and a wrong one no more than a line.
#[test]
fn many_and_long_names_are_found() {
    let mut text = "ambient = 1\n".to_owned();
    for i in 0..20_000 {
        writeln!(text, "material.m{i}.rho_d = 1").expect("memory");
    }
    for i in 0..20_000 {
        let sphere = format!("[[sphere]]\ncenter = [{i}, 0, 0]\nradius = 1\nmaterial = 'm{i}'");
        writeln!(text, "{sphere}").expect("memory");
    }
    let scene = |text: &str| load_from(&[("s.toml", text.as_bytes())], "s.toml");
    assert_eq!(scene(&text).expect("fine").scene.spheres.len(), 20_000);
    // As many ways to go.
    let moving = text.replace("center = [", "move = [1, 2, 3]\ncenter = [");
    assert_eq!(scene(&moving).expect("fine").scene.motions.len(), 1);
    let moving: String = text
        .lines()
        .enumerate()
        .map(|(i, line)| match line {
            "radius = 1" => format!("radius = 1\nmove = [0, {i}, 0]\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    assert_eq!(scene(&moving).expect("fine").scene.motions.len(), 20_000);
    let last = text.replace("'m19999'", "'m1999x'");
    assert_refused(
        scene(&last),
        "s.toml:100001: unknown material `m1999x`; of 20000 known ones the nearest are \
         m1999, m19990, m19991, m19992, m19993, m19994, m19995, m19996, m19997, m19998",
    );
    let long = text.replace("'m19999'", &format!("'{}'", "\u{e9}".repeat(1 << 20)));
    let message = scene(&long).expect_err("refused").to_string();
    assert!(message.starts_with("s.toml:100001: unknown material `") && message.len() < 500);
}
