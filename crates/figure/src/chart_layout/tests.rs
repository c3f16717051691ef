use super::*;
use crate::axis::Axis;
use crate::canvas::Canvas;
use crate::plate::Panel;
use crate::{Series, category_color};

/// A small generator, so that the charts are many and always the same.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn crowd(seed: u64, series: usize) -> Chart {
    let mut numbers = Numbers(seed);
    let axes = (Axis::log("counted work (rays)"), Axis::log("relMSE"));
    let mut chart = Chart::new(axes.0, axes.1).title("Crowded").height(420.0).better_lower_left();
    for i in 0..series {
        let mut one = Series::new(format!("a long name, number {i}"), category_color(i));
        for k in 0..5 {
            let x = 10f64.powf(3.0 + f64::from(k) * 0.4 + 0.3 * numbers.next());
            let y = 10f64.powf(-2.0 - f64::from(k) * 0.3 * numbers.next());
            let spread = Spread { low: 0.8 * x, mid: x, high: 1.3 * x };
            one = one.noted(spread, y, format!("{}", 4_u32.pow(k)));
        }
        chart = chart.series(one);
    }
    chart.slope(-0.5, "slope −1/2").horizontal(2e-4, "reference").vertical(1e4, "the knee")
}

fn drawn(chart: &Chart) -> (Canvas, Rect) {
    let rect = Rect::new(0.0, 0.0, 640.0, chart.height(640.0));
    let mut canvas = Canvas::new(rect.width, rect.height);
    chart.draw(&mut canvas, rect);
    (canvas, rect)
}

#[test]
fn labels_overlap_nothing_in_crowded_charts() {
    for seed in 0..60 {
        let chart = crowd(seed, 2 + seed as usize % 9);
        let (canvas, rect) = drawn(&chart);
        assert_eq!(canvas.faults(), [], "chart {seed}");
        let layout = Layout::of(&chart, rect);
        let inside = layout.room(&chart);
        for (at, text) in &layout.labels {
            // The height of what is read: capitals, not the room for accents.
            let read = text.rect(*at).grown(-3.0);
            assert!(rect.contains(&read), "chart {seed}: {} leaves the chart", text.content);
            let in_gutter = read.x > layout.frame.right();
            assert!(
                in_gutter || inside.fits(&read),
                "chart {seed}: {} lies over data",
                text.content
            );
        }
        let named =
            |label: &str| layout.labels.iter().filter(|(_, text)| text.content == label).count();
        for series in &chart.series {
            assert_eq!(named(&series.label), 1, "chart {seed}: {}", series.label);
        }
        assert_eq!(named("reference") + named("the knee"), 2);
    }
}

#[test]
fn the_check_above_can_fail() {
    let chart = crowd(1, 4);
    let (_, rect) = drawn(&chart);
    let layout = Layout::framed(&chart, rect, 0.0);
    let room = layout.room(&chart);
    let on_a_point = layout.place(&chart.series[0].data[2]);
    assert!(!room.fits(&Rect::around(on_a_point, 40.0, 20.0)));
}

#[test]
fn a_lone_line_is_named_at_its_right_end() {
    let series = Series::new("path", category_color(0)).points([(1.0, 1.0), (2.0, 3.0)]);
    let chart = Chart::new(Axis::linear("x").between(0.0, 4.0), Axis::linear("y")).series(series);
    let (_, rect) = drawn(&chart);
    let layout = Layout::of(&chart, rect);
    let end = layout.place(&chart.series[0].data[1]);
    let [(at, _)] = layout.labels.as_slice() else { panic!("one label") };
    assert!(at[0] > end[0] && (at[1] - end[1]).abs() < LABEL, "{at:?} is beside {end:?}");
}

#[test]
fn a_slope_guide_has_its_slope() {
    let chart = Chart::new(Axis::log("n"), Axis::log("error"))
        .series(Series::new("random", category_color(0)).points([(1.0, 1.0), (1e4, 1e-2)]))
        .slope(-0.5, "slope −1/2");
    let (_, rect) = drawn(&chart);
    let layout = Layout::of(&chart, rect);
    let [(from, to)] = layout.guides.as_slice() else { panic!("one guide") };
    let [a, b] = [0, 1].map(|i| layout.place(&chart.series[0].data[i]));
    let [guide, line] = [(from, to), (&a, &b)].map(|(a, b)| (b[1] - a[1]) / (b[0] - a[0]));
    assert!((guide / line - 1.0).abs() < 1e-9, "parallel to a line of that slope");
}

#[test]
fn odd_data_still_make_a_chart() {
    let one = |points: Vec<(f64, f64)>| {
        Chart::new(Axis::log("x"), Axis::log("y"))
            .series(Series::new("odd", category_color(0)).points(points))
    };
    let odd = [
        Chart::new(Axis::linear("x"), Axis::log("y")).slope(1.0, "slope 1").better_lower_left(),
        one(vec![]),
        one(vec![(0.0, 0.0), (0.0, 0.0)]),
        one(vec![(5.0, 5.0)]),
        one(vec![(-1.0, 2.0), (3.0, -4.0)]),
        one(vec![(1e-300, 1e300), (1e300, 5e-324)]),
        one(vec![(f64::NAN, 1.0), (f64::INFINITY, 2.0), (1.0, 1.0)]),
        Chart::new(Axis::linear("x"), Axis::linear("y")).series(
            Series::new("far and near", category_color(0))
                .points([(1e9, 1e9), (1e9 + 1.0, 1e9 + 1e-3)]),
        ),
        Chart::new(Axis::linear("x"), Axis::linear("y")).series(
            Series::new("huge and tiny", category_color(0)).points([
                (-1e299, -5e-324),
                (f64::MAX, 1.0),
                (1e299, 0.0),
            ]),
        ),
    ];
    for (i, chart) in odd.iter().enumerate() {
        let (canvas, _) = drawn(chart);
        assert_eq!(canvas.faults(), [], "chart {i}");
        assert!(!canvas.to_svg().contains("NaN"), "chart {i}");
    }
}

#[test]
fn what_is_not_shown_is_counted() {
    let points = [(f64::NAN, 1.0), (1.0, f64::INFINITY), (1.0, 1.0)];
    let series = Series::new("odd", category_color(0)).points(points);
    let (canvas, _) = drawn(&Chart::new(Axis::log("x"), Axis::log("y")).series(series));
    assert!(canvas.to_svg().contains("not shown: 2 without a finite value"));
}
