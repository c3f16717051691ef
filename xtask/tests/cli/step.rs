//! `step`: a pixel walked through, as text or as a page.

use std::fs;

use insta::assert_snapshot;

use super::{CORNER, accepted, folder, refusal, refusals, text};

#[test]
fn steps_that_cannot_be_walked_are_refused() {
    let folder = folder(&[]);
    fs::create_dir(folder.path().join("folder.html")).unwrap();
    let cases: [&[&str]; 11] = [
        &["--pixel=8,0"],
        &["--pixel=0,8"],
        &["--pixel=-1,0"],
        &["--pixel=1"],
        &["--pixel=1,2,3"],
        &["--pixel=1,1", "--depth=17"],
        &["--pixel=1,1", "--scene=romo"],
        &["--pixel=1,1", "--scene=gone.toml"],
        &["--pixel=1,1", "--out=old.png"],
        &["--pixel=1,1", "--out=missing/new.html"],
        &["--pixel=1,1", "--out=folder.html"],
    ];
    let line = |case: &[&'static str]| {
        let mut line = vec!["step", "whitted", "--size=8x8"];
        line.extend(case);
        if !case.iter().any(|option| option.starts_with("--scene")) {
            line.push("--scene=whitted");
        }
        line
    };
    assert_snapshot!(refusals(&folder, cases.map(line)), @r"
    error: --pixel 8,0 lies outside of the picture of 8x8: columns are 0 to 7, rows 0 to 7
    error: --pixel 0,8 lies outside of the picture of 8x8: columns are 0 to 7, rows 0 to 7
    error: invalid value '-1,0' for '--pixel <X,Y>': write column and row as two whole numbers, such as 120,80
    error: invalid value '1' for '--pixel <X,Y>': write column and row as two whole numbers, such as 120,80
    error: invalid value '1,2,3' for '--pixel <X,Y>': write column and row as two whole numbers, such as 120,80
    error: invalid value '17' for '--depth <DEPTH>': write a whole number from 0 to 16
    error: unknown scene `romo`; known: room, soup, town, scan, horizon, flake, gears, atrium, cornell, whitted, effects, penumbra, stadium, kitchen, tetrahedra; or name a .toml or .obj file
    error: gone.toml: No such file or directory (os error 2); check the path and its permissions
    error: --out: what kind of file is `old.png`? Its name must end in .html
    error: --out: cannot write `missing/new.html`: there is no folder `missing`; create it first
    error: --out: cannot write `folder.html`: it is a folder; name a file in it
    ");
    let unknown = ["step", "witted", "--scene=whitted", "--pixel=1,1"];
    assert_snapshot!(refusal(&folder, &unknown), @"error: unknown algorithm `witted`; known: whitted, accel");
    let accel: [&[&str]; 4] = [
        &["accel", "--pixel=8,0"],
        &["accel", "--pixel=0,8", "--index=kd"],
        &["accel", "--pixel=1,1", "--index=dk"],
        &["accel", "--pixel=1,1", "--index="],
    ];
    let line = |case: &[&'static str]| {
        [&["step"], case, &["--scene=room", "--size=8x8", "--out=new.html"]].concat()
    };
    assert_snapshot!(refusals(&folder, accel.map(line)), @r"
    error: --pixel 8,0 lies outside of the picture of 8x8: columns are 0 to 7, rows 0 to 7
    error: --pixel 0,8 lies outside of the picture of 8x8: columns are 0 to 7, rows 0 to 7
    error: unknown index `dk`; known: kd, wide, bvh, bsp, grid, linear, octree, obvhs-bvh2, obvhs-cwbvh
    error: unknown index ``; known: kd, bvh, bsp, wide, grid, linear, octree, obvhs-bvh2, obvhs-cwbvh
    ");
}

#[test]
fn a_ray_walks_through_all_indexes_or_one() {
    let folder = folder(&[]);
    let line = ["step", "accel", "--scene=room", "--pixel=16,16", "--size=32x32"];
    let all = text(&accepted(&folder, &line).stdout);
    let one = text(&accepted(&folder, &[&line[..], &["--index=GRID"]].concat()).stdout);
    let begins = |walk: &str| walk.matches(" bytes beside the scene").count();
    assert_eq!((begins(&all), begins(&one)), (9, 1));
    assert!(one.contains("grid begins") && one.contains("    linear  "), "{one}");
    let page = |name: &str| {
        let output = accepted(&folder, &[&line[..], &["--out", name]].concat());
        assert!(text(&output.stdout).starts_with(&format!("page    {name}   ")));
        text(&fs::read(folder.path().join(name)).unwrap())
    };
    assert_eq!(page("a.html"), page("b.html"));
}

#[test]
fn a_walk_is_a_text_or_a_page() {
    let model = CORNER.replacen("f 1", "mtllib m.mtl\nusemtl <script>alert(1)</script>\nf 1", 1);
    let library = b"newmtl <script>alert(1)</script>\nKd 0.5 0.5 0.5\nillum 3\nKs 0.2 0.2 0.2\n";
    let folder = folder(&[("corner.obj", model.as_bytes()), ("m.mtl", library)]);
    let line = ["step", "whitted", "--scene=corner.obj", "--pixel=16,16", "--size=32x32"];
    let walked = accepted(&folder, &line);
    assert_eq!(text(&walked.stderr), "");
    let walked = text(&walked.stdout);
    assert!(walked.contains("call 1 meets <script>alert(1)</script> at t = "), "{walked}");
    let page = |name: &str| {
        let out = format!("--out={name}");
        let output = accepted(&folder, &[&line[..], &[&out]].concat());
        assert!(text(&output.stdout).starts_with(&format!("page    {name}   ")));
        text(&fs::read(folder.path().join(name)).unwrap())
    };
    let first = page("a.html");
    assert_eq!(first, page("b.HTML"));
    assert_eq!(first, page("a.html"), "an old page is replaced");
    assert!(first.contains("call 1 meets &lt;script&gt;alert(1)&lt;/script&gt; at t = "));
    assert!(!first.contains("<script>alert") && !first.contains("http"));
}
