//! One colour per method in the whole course, from the colour-blind-safe palette of Okabe and Ito.

use crate::Color;

const GREY: Color = Color::rgb(0x50, 0x50, 0x50);
const ORANGE: Color = Color::rgb(0xe6, 0x9f, 0x00);
const SKY: Color = Color::rgb(0x56, 0xb4, 0xe9);
pub(crate) const GREEN: Color = Color::rgb(0x00, 0x9e, 0x73);
const BLUE: Color = Color::rgb(0x00, 0x72, 0xb2);
pub(crate) const VERMILION: Color = Color::rgb(0xd5, 0x5e, 0x00);
const PURPLE: Color = Color::rgb(0xcc, 0x79, 0xa7);
/// Okabe and Ito's yellow, a little darker: darker still and it would be orange to the green-blind.
const YELLOW: Color = Color::rgb(0xe5, 0xd5, 0x1a);
/// Not of Okabe and Ito: an eighth hue, darker than all of theirs but black.
const INDIGO: Color = Color::rgb(0x33, 0x22, 0x88);

/// Every method with its colour. Methods that share one are never shown together.
pub const METHODS: [(&str, Color); 20] = [
    ("reference", Color::rgb(0x00, 0x00, 0x00)),
    // Chapters 1 to 3: ways to make a picture.
    ("naive", GREY),
    ("appel", YELLOW),
    ("whitted", BLUE),
    ("cones", YELLOW),
    ("pencils", INDIGO),
    ("pyramids", SKY),
    ("hybrid", ORANGE),
    ("precise", GREEN),
    ("distributed", VERMILION),
    ("path", PURPLE),
    // Chapter 4: indexes. They are compared with each other, not with the methods above.
    ("linear", GREY),
    ("grid", ORANGE),
    ("octree", SKY),
    ("kd", GREEN),
    ("bsp", YELLOW),
    ("bvh", BLUE),
    ("obvhs-bvh2", PURPLE),
    ("obvhs-cwbvh", INDIGO),
    ("wide", VERMILION),
];

/// The colour of a method or index of [`METHODS`].
///
/// # Panics
/// If the course has no method of that name: each needs its colour in the table.
pub fn method_color(name: &str) -> Color {
    let known = METHODS.iter().find(|(method, _)| *method == name);
    let names = || METHODS.map(|(method, _)| method).join(", ");
    known
        .map(|(_, color)| *color)
        .unwrap_or_else(|| panic!("no colour for {name:?}; known: {}", names()))
}

/// The `index`-th of eight colours, for things that are not methods (terms of an equation, scenes).
pub fn category_color(index: usize) -> Color {
    [BLUE, ORANGE, GREEN, VERMILION, SKY, PURPLE, INDIGO, YELLOW][index % 8]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::linear_light;

    /// What is seen of linear light: all, without red cones, without green cones (Machado, Oliveira and
    /// Fernandes 2009, full severity).
    const EYES: [[[f64; 3]; 3]; 3] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ],
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ],
    ];

    fn times(matrix: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
        matrix.map(|row| row.iter().zip(v).map(|(m, v)| m * v).sum())
    }

    /// The colour as an eye sees it, in Ottosson's Oklab, where distances are differences seen.
    fn seen(color: Color, eye: [[f64; 3]; 3]) -> [f64; 3] {
        let light = color.rgb.map(|byte| linear_light()[byte as usize]);
        let cones = times(
            [
                [0.4122214708, 0.5363325363, 0.0514459929],
                [0.2119034982, 0.6806995451, 0.1073969566],
                [0.0883024619, 0.2817188376, 0.6299787005],
            ],
            times(eye, light).map(|c| c.clamp(0.0, 1.0)),
        );
        times(
            [
                [0.2104542553, 0.7936177850, -0.0040720468],
                [1.9779984951, -2.4285922050, 0.4505937099],
                [0.0259040371, 0.7827717662, -0.8086757660],
            ],
            cones.map(f64::cbrt),
        )
    }

    #[test]
    fn methods_shown_together_differ_for_the_colour_blind_too() {
        // The closest pair of Okabe and Ito's own palette (green and purple) is 0.076 apart.
        const APART: f64 = 0.075;
        let (reference, rest) = (METHODS[0], &METHODS[1..]);
        let (pictures, indexes) = rest.split_at(10);
        let with_beams = pictures.iter().filter(|(name, _)| *name != "appel");
        let first_chapter = pictures.iter().filter(|(name, _)| *name != "cones");
        let groups =
            [with_beams.collect(), first_chapter.collect(), indexes.iter().collect::<Vec<_>>()];
        for mut group in groups {
            group.push(&reference);
            for (i, a) in group.iter().enumerate() {
                for b in &group[..i] {
                    for eye in EYES {
                        let (seen_a, seen_b) = (seen(a.1, eye), seen(b.1, eye));
                        let square: f64 = (0..3).map(|c| (seen_a[c] - seen_b[c]).powi(2)).sum();
                        assert!(square.sqrt() > APART, "{} and {}: {}", a.0, b.0, square.sqrt());
                    }
                }
            }
        }
    }

    #[test]
    #[should_panic(expected = "no colour for \"witted\"; known: reference, naive")]
    fn an_unknown_method_is_named() {
        method_color("witted");
    }
}
