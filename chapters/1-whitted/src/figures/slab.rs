//! 0.4: rays that touch a box, and the well-known forms of the box test that miss it.

use std::f64::consts::SQRT_2;

use glam::{DVec3, swizzles::Vec3Swizzles};
use lancer_core::geometry::{Bounds3, Interval, Ray, Slabs};
use lancer_core::sampling::Uniform;
use lancer_figure::{
    Anchor, Axis, CAPTION, Chart, Color, Drawing, Effort, Finished, HEADING, INK, Montage, Pen,
    Picture, Plate, Row, Series, Style, Table, Text, Tile, category_color, heat_color,
    method_color, number,
};

use lancer_lesson::hard_boxes::{Class, HardBox};
use lancer_lesson::naive::{min_max_box, padded_box, sign_picked_box, sse_box, swapped_box};

/// Where a ray enters a box, if it does.
type Form = fn(&Bounds3, &Ray) -> Option<f64>;

const FORMS: [(&str, Form); 6] = [
    ("min/max", |bounds, ray| min_max_box(bounds, ray.origin, inverse(ray))),
    ("SSE min/max", |bounds, ray| sse_box(bounds, ray.origin, inverse(ray))),
    ("swap", |bounds, ray| swapped_box(bounds, ray.origin, inverse(ray))),
    ("swap + pad", |bounds, ray| padded_box(bounds, ray.origin, inverse(ray))),
    ("sign-picked", |bounds, ray| sign_picked_box(bounds, ray.origin, inverse(ray))),
    ("ours", |bounds, ray| Slabs::new(ray).enter(bounds.min, bounds.max, Interval::POSITIVE)),
];
const OURS: usize = FORMS.len() - 1;

fn inverse(ray: &Ray) -> DVec3 {
    DVec3::ONE / ray.direction
}

fn color(form: usize) -> Color {
    match form {
        0 => method_color("naive"),
        OURS => category_color(2),
        1 | 2 => category_color(form - 1),
        _ => category_color(form + 1),
    }
}

pub fn make(effort: Effort) -> Finished {
    let count = effort.pick(5_000, 100_000);
    let mut data = Table::new(["question", "class", "form", "rays", "wrong"]);
    let missed: Vec<[usize; FORMS.len()]> = Class::ALL
        .iter()
        .map(|&(class, name)| {
            let missed = misses(class, count);
            for ((form, _), missed) in FORMS.iter().zip(missed) {
                let form = (*form).into();
                data.push(["false miss".into(), name.into(), form, count.into(), missed.into()]);
            }
            missed
        })
        .collect();
    let worst = |form: usize| {
        let of_class = |missed: &[usize; FORMS.len()]| 100.0 * missed[form] as f64 / count as f64;
        missed.iter().map(of_class).fold(0.0, f64::max)
    };
    let ours: usize = missed.iter().map(|missed| missed[OURS]).sum();
    let mildest = (0..OURS).map(worst).fold(f64::INFINITY, f64::min);
    let holds = ours == 0 && mildest > 0.0;
    let claim = format!(
        "Of {} rays that touch their box ours misses {ours}; each of five well-known forms misses at \
         least {mildest:.0} % of some class, min/max {:.0} %.",
        number((count * Class::ALL.len()) as f64),
        worst(0),
    );

    let side = effort.pick(5, 8);
    let views: Vec<(Picture, usize)> = FORMS.iter().map(|(_, form)| towers(side, *form)).collect();
    let mut pictures = Montage::new().columns(3);
    for (i, (picture, wrong)) in views.into_iter().enumerate() {
        let pixels = (picture.width() * picture.height()) as usize;
        data.push([
            "wrong pixel".into(),
            "towers".into(),
            FORMS[i].0.into(),
            pixels.into(),
            wrong.into(),
        ]);
        let share = 100.0 * wrong as f64 / pixels as f64;
        let title = format!("{}: {share:.1} % wrong", FORMS[i].0);
        pictures = pictures.tile(Tile::new(title, picture).color(color(i)));
    }

    let mut let_in = Chart::new(
        Axis::log("gap between ray and edge / distance travelled"),
        Axis::linear("boxes entered though missed (%)"),
    )
    .title("The price: rays let in that pass outside an edge")
    .height(430.0);
    let spurious = passing(effort.pick(1_000, 20_000));
    let mut widest = 0.0_f64;
    for (i, (form, _)) in FORMS.iter().enumerate() {
        let mut series = Series::new(*form, color(i));
        for (gap, rays, entered) in &spurious {
            series = series.point(*gap, 100.0 * entered[i] as f64 / *rays as f64);
            if i == OURS && entered[i] > 0 {
                // A gap stands for those up to its half octave.
                widest = widest.max(*gap * SQRT_2);
            }
            let class = format!("gap {gap:.1e}").into();
            data.push([
                "false hit".into(),
                class,
                (*form).into(),
                (*rays).into(),
                entered[i].into(),
            ]);
        }
        let_in = let_in.series(series);
    }

    let rates = missed.iter().map(|row| row.map(|n| 100.0 * n as f64 / count as f64)).collect();
    let plate = Plate::new("0.4", "A box that is touched is entered", claim, holds)
        .panel(pictures)
        .panel(rates_table(rates))
        .panel(Row::new().panel(1.0, let_in))
        .note("Pictures", "block towers seen straight from above along D = (0, −0, −1), every pixel's ray on a grid \
             that also holds the walls, so that there (plane − o) · 1/D is 0 · ∞ = NaN; black is a ray that \
             entered no box, a wrong colour one that entered a box which it misses")
        .note("Forms", "min/max: IEEE minNum as in f64::min; SSE: the second operand when one is NaN; swap: \
             planes put in order, « replace if better »; + pad and sign-picked: the two forms of pbrt 4; \
             ours (core::geometry::Slabs): planes by sign, « replace if better » on all three axes, far · (1 + 4 ε)")
        .note("Limits", format!(
            "the rays of « corner » and of « corner at 10⁶ » differ by a shift alone, which is exact here and changes \
             nothing. Our test lets in rays that pass an edge at less than \
             about {} of their way: visits too many, never one too few",
            number(widest)
        ))
        .note("Reference", "exact: dyadic coordinates, so that each ray passes through the chosen point of its \
             box, or outside its edge, without any rounding");
    Finished { plate, data }
}

/// How many boxes of a class each form misses.
fn misses(class: Class, count: usize) -> [usize; FORMS.len()] {
    let mut random = Uniform::new(4, 0, 0);
    let mut missed = [0; FORMS.len()];
    for _ in 0..count {
        let hard = HardBox::new(class, &mut random);
        for (missed, (_, form)) in missed.iter_mut().zip(FORMS) {
            *missed += usize::from(form(&hard.bounds, &hard.ray()).is_none());
        }
    }
    missed
}

/// For gaps of 2^-k of the distance travelled: that gap, the rays that pass an edge at it, and how many of
/// them each form lets in.
fn passing(count: usize) -> Vec<(f64, usize, [usize; FORMS.len()])> {
    let mut bins = vec![(0, [0; FORMS.len()]); 52];
    let mut random = Uniform::new(4, 1, 0);
    for exponent in 32..=40 {
        for _ in 0..count {
            let mut hard = HardBox::new(Class::Edge, &mut random);
            let gap = beside(&mut hard, 2.0_f64.powi(-exponent));
            let (rays, entered) = &mut bins[(-gap.log2()) as usize];
            *rays += 1;
            for (entered, (_, form)) in entered.iter_mut().zip(FORMS) {
                *entered += usize::from(form(&hard.bounds, &hard.ray()).is_some());
            }
        }
    }
    let bins = bins.into_iter().enumerate().filter(|(_, (rays, _))| 8 * *rays >= count);
    bins.map(|(k, (rays, entered))| (2.0_f64.powf(-0.5 - k as f64), rays, entered)).collect()
}

/// Moves a ray that touches an edge off the box by `distance` along both axes, where it comes in through
/// one of the planes only after it has left through the other. Returns the gap as a part of the way.
fn beside(hard: &mut HardBox, distance: f64) -> f64 {
    let Bounds3 { min, max } = hard.bounds;
    let on_plane =
        |axis: &usize| hard.point[*axis] == min[*axis] || hard.point[*axis] == max[*axis];
    let axes: Vec<usize> = (0..3).filter(on_plane).collect();
    for (axis, turn) in axes.into_iter().zip([-1.0, 1.0]) {
        let outwards = if hard.point[axis] == max[axis] { 1.0 } else { -1.0 };
        hard.point[axis] += outwards * distance;
        hard.direction[axis] = turn * outwards * hard.direction[axis].abs();
    }
    distance / (hard.t * hard.direction.length())
}

/// Block towers on a plan of 12 × 8 units seen from above, `side` pixels to a unit, and how many pixels do not
/// show the tower that stands there.
fn towers(side: u32, form: Form) -> (Picture, usize) {
    /// The towers' plans, x and y from and to, which leave no gap.
    const PLANS: [[u32; 4]; 12] = [
        [0, 3, 0, 3],
        [3, 7, 0, 2],
        [7, 9, 0, 4],
        [9, 12, 0, 3],
        [3, 5, 2, 6],
        [5, 7, 2, 4],
        [0, 3, 3, 5],
        [0, 2, 5, 8],
        [2, 3, 5, 8],
        [3, 8, 6, 8],
        [5, 8, 4, 6],
        [8, 12, 4, 8],
    ];
    let boxes: Vec<Bounds3> = PLANS
        .iter()
        .chain(&[[9, 12, 3, 4]])
        .enumerate()
        .map(|(i, plan)| {
            let [x0, x1, y0, y1] = plan.map(f64::from);
            let height = f64::from(1 + 5 * i as u32 % 7);
            Bounds3 { min: DVec3::new(x0, y0, 0.0), max: DVec3::new(x1, y1, height) }
        })
        .collect();
    let mut wrong = 0;
    // The border of the plan stays outside, so that every wall has towers on both sides.
    let picture = Picture::from_fn(12 * side - 1, 8 * side - 1, |x, y| {
        let at = |pixel: u32| f64::from(pixel + 1) / f64::from(side);
        let ray = Ray::new(DVec3::new(at(x), at(y), 20.0), DVec3::new(0.0, -0.0, -1.0));
        let entered = boxes.iter().enumerate().filter_map(|(i, b)| Some((form(b, &ray)?, i)));
        let seen = entered.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, i)| i);
        // The highest of the towers whose plan holds the pixel, of equals the first.
        let stands = |b: &&Bounds3| {
            let p = ray.origin.min(b.max);
            p.xy() == ray.origin.xy() && p.cmpge(b.min).all()
        };
        let top = boxes.iter().filter(stands).map(|b| b.max.z).fold(0.0, f64::max);
        wrong += usize::from(seen != boxes.iter().position(|b| stands(&b) && b.max.z == top));
        let Some(i) = seen else { return [0; 3] };
        let [r, g, b] = category_color(i % 5).mix(Color::WHITE, 0.55).rgb.map(f64::from);
        [r, g, b].map(|channel| (channel * (0.51 + 0.07 * boxes[i].max.z)) as u8)
    });
    (picture, wrong)
}

/// The missed boxes of each class and form, as a table whose cells are the darker the more is missed.
fn rates_table(rates: Vec<[f64; FORMS.len()]>) -> Drawing {
    const CELL: [f64; 2] = [158.0, 32.0];
    const LEFT: f64 = 350.0;
    let high = [LEFT + CELL[0] * FORMS.len() as f64, CELL[1] * (rates.len() + 2) as f64];
    Drawing::new([0.0, 0.0], high, high[1], move |pen: &mut Pen<'_>| {
        let write = |pen: &mut Pen<'_>, x: f64, row: usize, text: Text| {
            let [x, y] = pen.at([x, high[1] - CELL[1] * (row as f64 + 0.5)]);
            pen.canvas().text([x, y + 0.36 * CAPTION], text);
        };
        let heading = Text::new("Boxes missed (%)", HEADING).bold();
        write(pen, 0.0, 0, heading);
        for (f, (form, _)) in FORMS.iter().enumerate() {
            let middle = LEFT + CELL[0] * (f as f64 + 0.5);
            let name = Text::new(*form, CAPTION).bold().color(color(f).for_text()).centered();
            write(pen, middle, 1, name);
            for (row, rates) in rates.iter().enumerate() {
                let rate = rates[f];
                let (x, y) = (LEFT + CELL[0] * f as f64, high[1] - CELL[1] * (row + 3) as f64);
                let [r, g, b] = heat_color(1.0 - (rate / 100.0).sqrt());
                let fill = if rate == 0.0 { Color::WHITE } else { Color::rgb(r, g, b) };
                let (right, top) = (x + CELL[0] - 2.0, y + CELL[1] - 2.0);
                pen.polygon(&[[x, y], [right, y], [right, top], [x, top]], Style::fill(fill));
                let ink = if fill.luminance() > 0.3 { INK } else { Color::WHITE };
                let text = if rate == 0.0 { "0".to_owned() } else { format!("{rate:.2}") };
                write(pen, middle, row + 2, Text::new(text, CAPTION).color(ink).centered());
            }
        }
        for (row, (_, name)) in Class::ALL.iter().enumerate() {
            write(pen, LEFT - 16.0, row + 2, Text::new(*name, CAPTION).anchor(Anchor::End));
        }
    })
}
