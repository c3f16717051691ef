//! Axes: what they show, where a value lies on them, and their ticks.

use crate::font::{Weight, text_width};
use crate::number::{decimals, number, power_of_ten};
use crate::style::TICK;

/// One axis of a chart. It reaches over the data, plus what is asked for here.
#[derive(Clone, Debug)]
pub struct Axis {
    pub(crate) title: String,
    log: bool,
    include: Vec<f64>,
    exact: Option<(f64, f64)>,
}

impl Axis {
    /// A linear axis; the title names the quantity and its unit.
    pub fn linear(title: impl Into<String>) -> Self {
        Self { title: title.into(), log: false, include: Vec::new(), exact: None }
    }

    /// A logarithmic axis. Values of 0 and below get a place of their own, marked 0, at its lower end.
    pub fn log(title: impl Into<String>) -> Self {
        Self { log: true, ..Self::linear(title) }
    }

    /// Also reaches over `value`.
    pub fn include(mut self, value: f64) -> Self {
        self.include.push(value);
        self
    }

    /// Begins at `low` and ends at `high`, without a margin, unless the data reach further.
    pub fn between(self, low: f64, high: f64) -> Self {
        Self { exact: Some((low, high)), ..self }
    }

    /// The axis over `data`, drawn from the canvas coordinate `from` to `to`.
    pub(crate) fn scale(&self, data: impl IntoIterator<Item = f64>, from: f64, to: f64) -> Scale {
        let asked =
            self.include.iter().copied().chain(self.exact.into_iter().flat_map(|(a, b)| [a, b]));
        let finite: Vec<f64> = data.into_iter().chain(asked).filter(|&v| has_place(v)).collect();
        let zero = self.log && finite.iter().any(|&value| value <= 0.0);
        let shown = finite.iter().copied().filter(|&value| !self.log || value > 0.0);
        let (low, high) = shown
            .fold(None, |range, value| match range {
                None => Some((value, value)),
                Some((low, high)) => Some((value.min(low), value.max(high))),
            })
            .unwrap_or((1.0, 1.0));
        let (low, high) = self.with_margin(low, high);
        Scale { log: self.log, low, high, zero, from, to }
    }

    /// The range in the scale's own measure (decades on a log axis), with room around the data.
    fn with_margin(&self, low: f64, high: f64) -> (f64, f64) {
        let measure = |value: f64| if self.log { value.log10() } else { value };
        let (mut a, mut b) = (measure(low), measure(high));
        // Ends that rounding cannot tell apart are one value.
        let least: f64 = if self.log { 1e-9 } else { 1e-290 };
        if b - a <= least.max(1e-12 * a.abs().max(b.abs())) {
            let half = if self.log || a.abs() < 1e-280 { 0.5 } else { a.abs() / 2.0 };
            return (a - half, a + half);
        }
        let margin = 0.05 * (b - a);
        let keeps = |end: f64| {
            self.exact.is_some_and(|(x, y)| end == x || end == y) || (!self.log && end == 0.0)
        };
        if !keeps(low) {
            a -= margin;
        }
        if !keeps(high) {
            b += margin;
        }
        (a, b)
    }
}

/// Whether a chart can show `value`: it is a number, and not so large that differences overflow.
pub(crate) fn has_place(value: f64) -> bool {
    value.abs() <= 1e300
}

/// A labelled tick.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub(crate) value: f64,
    pub(crate) label: String,
}

/// The width of the widest label of some ticks.
pub(crate) fn widest(ticks: &[Tick]) -> f64 {
    ticks.iter().map(|tick| text_width(&tick.label, TICK, Weight::Regular)).fold(0.0, f64::max)
}

/// An axis laid along a stretch of the canvas.
#[derive(Clone, Debug)]
pub(crate) struct Scale {
    log: bool,
    /// The ends in the scale's own measure: the value, or its decimal logarithm.
    low: f64,
    high: f64,
    zero: bool,
    from: f64,
    to: f64,
}

/// The part of a log axis kept for the value 0.
const ZERO_BAND: f64 = 0.1;

impl Scale {
    /// The scale of a log or linear axis from exactly `low` to `high`.
    pub(crate) fn exactly(log: bool, low: f64, high: f64, from: f64, to: f64) -> Self {
        let axis = if log { Axis::log("") } else { Axis::linear("") };
        axis.between(low, high).scale([], from, to)
    }

    /// Where `value` lies on the canvas.
    pub(crate) fn at(&self, value: f64) -> f64 {
        if !self.log {
            self.place(value)
        } else if value > 0.0 {
            self.place(value.log10())
        } else {
            self.from + 0.4 * ZERO_BAND * (self.to - self.from)
        }
    }

    fn place(&self, measure: f64) -> f64 {
        self.first() + (measure - self.low) * self.per_unit()
    }

    /// Where the scale proper begins, after the place of the 0 if there is one.
    fn first(&self) -> f64 {
        let band = if self.zero { ZERO_BAND } else { 0.0 };
        self.from + band * (self.to - self.from)
    }

    /// The stretch kept for the value 0, on a log axis that shows one.
    pub(crate) fn zero_band(&self) -> Option<(f64, f64)> {
        self.zero.then(|| (self.from, self.first()))
    }

    /// Canvas px (signed) of one unit, or of one decade.
    pub(crate) fn per_unit(&self) -> f64 {
        (self.to - self.first()) / (self.high - self.low)
    }

    fn shows(&self, value: f64) -> bool {
        let measure = if self.log { value.log10() } else { value };
        let slack = 1e-9 * (self.high - self.low);
        measure >= self.low - slack && measure <= self.high + slack
    }

    /// The labelled ticks, about `apart` px or more from each other.
    pub(crate) fn ticks(&self, apart: f64) -> Vec<Tick> {
        let most = ((self.to - self.first()).abs() / apart).max(1.0);
        if !self.log {
            return linear_ticks(self.low, self.high, most);
        }
        let mut ticks = self.log_ticks(apart, most);
        if self.zero {
            ticks.insert(0, Tick { value: 0.0, label: "0".to_owned() });
        }
        ticks
    }

    /// The labelled ticks of a level axis, whose labels stand side by side.
    pub(crate) fn level_ticks(&self) -> Vec<Tick> {
        let mut apart = 4.2 * TICK;
        loop {
            let ticks = self.ticks(apart);
            let needed = widest(&ticks) + 0.8 * TICK;
            if needed <= apart {
                return ticks;
            }
            apart = needed;
        }
    }

    fn log_ticks(&self, apart: f64, most: f64) -> Vec<Tick> {
        let decades = self.decades();
        let inside = decades.clone().filter(|&k| self.shows(power(k))).count();
        // 1, 2, 5: the closest pair, 1 and 2, lies 0.3 decades apart.
        let mantissas: &[u32] =
            if self.per_unit().abs() * 0.3 >= apart && inside < 4 { &[1, 2, 5] } else { &[1] };
        let stride = (inside as f64 / most).ceil().max(1.0) as i32;
        let values: Vec<(u32, i32)> = decades
            .filter(|k| k % stride == 0)
            .flat_map(|k| mantissas.iter().map(move |&m| (m, k)))
            .filter(|&(m, k)| self.shows(f64::from(m) * power(k)))
            .collect();
        if values.len() < 2 {
            return self.equal_steps(apart, most);
        }
        let plain = values.iter().all(|(_, k)| (-2..=3).contains(k));
        let label = |m: u32, k: i32| match (plain, m) {
            (true, _) => number(f64::from(m) * power(k)),
            (false, 1) => power_of_ten(k),
            (false, _) => format!("{m}×{}", power_of_ten(k)),
        };
        values
            .into_iter()
            .map(|(m, k)| Tick { value: f64::from(m) * power(k), label: label(m, k) })
            .collect()
    }

    /// The ticks of a log axis of less than a decade: equal steps, so large that even the upper ones, which
    /// are closest together, have their room.
    fn equal_steps(&self, apart: f64, mut most: f64) -> Vec<Tick> {
        loop {
            let ticks = linear_ticks(10f64.powf(self.low), 10f64.powf(self.high), most);
            let room = |pair: &[Tick]| (self.at(pair[1].value) - self.at(pair[0].value)).abs();
            if most <= 1.0 || ticks.windows(2).all(|pair| room(pair) >= apart) {
                return ticks;
            }
            most /= 1.5;
        }
    }

    /// The unlabelled grid lines of a log axis: 2 to 9 in each decade, or the decades when they are many.
    pub(crate) fn minor(&self) -> Vec<f64> {
        if !self.log {
            return Vec::new();
        }
        let roomy = self.per_unit().abs() >= 60.0;
        self.decades()
            .flat_map(|k| (1..if roomy { 10 } else { 2 }).map(move |m| f64::from(m) * power(k)))
            .filter(|&value| self.shows(value))
            .collect()
    }

    fn decades(&self) -> std::ops::RangeInclusive<i32> {
        self.low.floor() as i32..=self.high.ceil() as i32
    }
}

/// Ten to the power `k`, correctly rounded.
fn power(k: i32) -> f64 {
    format!("1e{k}").parse().expect("a number")
}

/// Ticks at multiples of 1, 2 or 5 times a power of ten, at most about `most` of them.
fn linear_ticks(low: f64, high: f64, most: f64) -> Vec<Tick> {
    let rough = (high - low) / most;
    let exponent = rough.log10().floor() as i32;
    let (mantissa, exponent) = [(1, exponent), (2, exponent), (5, exponent), (1, exponent + 1)]
        .into_iter()
        .find(|&(m, k)| f64::from(m) * power(k) >= rough * (1.0 - 1e-9))
        .expect("ten times the power of ten below is above");
    let step = f64::from(mantissa) * power(exponent);
    let places = (-exponent).max(0) as usize;
    // Three digits, all that `number` prints, tell ticks apart only when the steps are large.
    let largest = low.abs().max(high.abs());
    let plain = largest >= 1000.0 * step || (largest < 1e5 && places <= 4);
    let slack = 1e-9 * (high - low) / step;
    let (first, last) = ((low / step - slack).ceil() as i64, (high / step + slack).floor() as i64);
    (first..=last)
        .map(|i| {
            // Dividing by a whole power of ten, unlike multiplying by 0.1, gives the nearest number.
            let units = (i * i64::from(mantissa)) as f64;
            let value =
                if exponent < 0 { units / power(-exponent) } else { units * power(exponent) };
            Tick { value, label: if plain { decimals(value, places) } else { number(value) } }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().map(|tick| tick.label.as_str()).collect()
    }

    #[test]
    fn linear_ticks_by_hand() {
        assert_eq!(labels(&linear_ticks(0.0, 90.0, 5.0)), ["0", "20", "40", "60", "80"]);
        assert_eq!(
            labels(&linear_ticks(0.0, 1.0, 5.0)),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(labels(&linear_ticks(-1.0, 1.0, 2.0)), ["−1", "0", "1"]);
        assert_eq!(labels(&linear_ticks(0.0, 3e6, 3.0)), ["0", "10⁶", "2×10⁶", "3×10⁶"]);
        assert_eq!(
            labels(&linear_ticks(200_000.0, 200_010.0, 2.0)),
            ["200000", "200005", "200010"]
        );
        assert_eq!(linear_ticks(0.0, 1.0, 10.0)[3].value, 0.3);
    }

    #[test]
    fn log_ticks_by_hand() {
        let wide = Scale::exactly(true, 1e-5, 1.0, 0.0, 600.0);
        assert_eq!(labels(&wide.ticks(60.0)), ["10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "1"]);
        let narrow = Scale::exactly(true, 1.0, 20.0, 0.0, 400.0);
        assert_eq!(labels(&narrow.ticks(60.0)), ["1", "2", "5", "10", "20"]);
        let small = Scale::exactly(true, 1e-4, 1e-3, 0.0, 400.0);
        assert_eq!(labels(&small.ticks(60.0)), ["10⁻⁴", "2×10⁻⁴", "5×10⁻⁴", "10⁻³"]);
        let crowded = Scale::exactly(true, 1e-12, 1.0, 0.0, 240.0);
        assert_eq!(labels(&crowded.ticks(60.0)), ["10⁻¹²", "10⁻⁸", "10⁻⁴", "1"]);
        let within = Scale::exactly(true, 3.1, 4.9, 0.0, 240.0);
        assert_eq!(labels(&within.ticks(60.0)), ["3.5", "4.0", "4.5"]);
        // Of 4, 5, … 9 the first two would stand 57 px apart, but the last two 30.
        let rising = Scale::exactly(true, 3.7, 9.5, 0.0, 240.0);
        assert_eq!(labels(&rising.ticks(40.0)), ["4", "6", "8"]);
    }

    #[test]
    fn minor_lines_fill_the_decades() {
        let scale = Scale::exactly(true, 1.0, 100.0, 0.0, 400.0);
        assert_eq!(scale.minor().len(), 9 + 9 + 1);
        assert_eq!(Scale::exactly(true, 1.0, 1e9, 0.0, 90.0).minor().len(), 10, "decades only");
    }

    #[test]
    fn values_lie_where_the_axis_says() {
        let log = Scale::exactly(true, 1.0, 1e4, 100.0, 500.0);
        assert!((log.at(100.0) - 300.0).abs() < 1e-9);
        let down = Scale::exactly(false, 0.0, 10.0, 400.0, 0.0);
        assert!((down.at(2.5) - 300.0).abs() < 1e-9);
    }

    #[test]
    fn a_zero_on_a_log_axis_has_its_own_place() {
        let scale = Axis::log("error").scale([0.0, 1e-3, 1.0], 0.0, 1000.0);
        assert!(scale.at(0.0) < 100.0 && scale.at(1e-3) > 100.0);
        assert_eq!(scale.ticks(60.0)[0], Tick { value: 0.0, label: "0".into() });
    }

    #[test]
    fn an_axis_reaches_over_its_data() {
        let scale = Axis::linear("").scale([2.0, 8.0, f64::NAN], 0.0, 100.0);
        assert!(scale.at(2.0) > 0.0 && scale.at(8.0) < 100.0);
        let from_zero = Axis::linear("").include(0.0).scale([8.0], 0.0, 100.0);
        assert_eq!(from_zero.at(0.0), 0.0, "no margin below zero");
        let single = Axis::log("").scale([5.0], 0.0, 100.0);
        assert!((single.at(5.0) - 50.0).abs() < 1e-9);
    }
}
