//! The one routine that measures speed against error.

use std::fmt::Display;
use std::time::Instant;

use crate::chart::Spread;
use crate::data::{Table, Value};
use crate::number::number;
use crate::shape::Color;
use crate::speed_error::{CurvePoint, MethodCurve, SpeedError};

/// A method at one setting of its knob, ready to be run.
pub struct Contender<'a, K, T> {
    /// The curve it belongs to: the name of the method, or of its variant.
    pub curve: String,
    /// The curve's colour.
    pub color: Color,
    /// The setting, written beside its point.
    pub knob: K,
    /// One run: its outcome and the counted work, both the same every time.
    pub run: Box<dyn Fn() -> (T, u64) + 'a>,
}

/// One contender's measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial<K, T> {
    /// The curve it belongs to.
    pub curve: String,
    /// The curve's colour.
    pub color: Color,
    /// The setting.
    pub knob: K,
    /// The seconds of its runs.
    pub seconds: Spread,
    /// The counted work.
    pub work: u64,
    /// What a run gave, such as its picture.
    pub outcome: T,
    errors: Vec<(&'static str, f64)>,
}

/// How fast and how wrong several methods are, each at several settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Study<K, T> {
    work_unit: String,
    trials: Vec<Trial<K, T>>,
}

/// Runs all `runs` times in turn (A B C A B C), so that a machine that slows down slows all of them. Returns
/// the seconds of each and what it returned last.
///
/// # Panics
/// If `runs` is 0.
pub fn time_in_turn<F: Fn() -> T, T>(
    runs: usize,
    all: impl IntoIterator<Item = F>,
) -> Vec<(Spread, T)> {
    let all: Vec<F> = all.into_iter().collect();
    let mut seconds = vec![Vec::new(); all.len()];
    let mut outcomes = Vec::new();
    for _ in 0..runs {
        outcomes.clear();
        for (run, seconds) in all.iter().zip(&mut seconds) {
            let start = Instant::now();
            outcomes.push(run());
            seconds.push(start.elapsed().as_secs_f64());
        }
    }
    seconds.iter().map(|seconds| Spread::of_runs(seconds)).zip(outcomes).collect()
}

impl<K: Display + PartialEq, T> Study<K, T> {
    /// Measures: runs all contenders `runs` times in turn (A B C A B C), so that a machine that slows
    /// down slows all of them, and judges each outcome by named errors, at least 0, against the
    /// reference.
    ///
    /// Contenders of one curve must follow each other in the knob's order; `work_unit` names the counted
    /// work.
    ///
    /// # Panics
    /// If `runs` is 0.
    pub fn measure<'a>(
        work_unit: impl Into<String>,
        runs: usize,
        contenders: impl IntoIterator<Item = Contender<'a, K, T>>,
        judge: impl Fn(&T) -> Vec<(&'static str, f64)>,
    ) -> Self
    where
        K: 'a,
        T: 'a,
    {
        let contenders: Vec<_> = contenders.into_iter().collect();
        let timed = time_in_turn(runs, contenders.iter().map(|contender| &*contender.run));
        let trials =
            contenders.into_iter().zip(timed).map(|(contender, (seconds, (outcome, work)))| {
                let Contender { curve, color, knob, .. } = contender;
                let errors = judge(&outcome);
                Trial { curve, color, knob, seconds, work, outcome, errors }
            });
        Self { work_unit: work_unit.into(), trials: trials.collect() }
    }

    /// All trials in the contenders' order, which is that of the table's rows.
    pub fn trials(&self) -> &[Trial<K, T>] {
        &self.trials
    }

    /// The trial of a curve at a setting.
    ///
    /// # Panics
    /// If there is none: a figure asks for what it has measured.
    pub fn at(&self, curve: &str, knob: K) -> &Trial<K, T> {
        let found = self.trials.iter().find(|trial| trial.curve == curve && trial.knob == knob);
        found.unwrap_or_else(|| panic!("no contender {curve:?} at {knob}"))
    }

    /// The counted work at which a curve first comes down to an error: between two of its points by a
    /// straight line in the logarithmic chart. `None` if it never does.
    ///
    /// # Panics
    /// If there is no such curve or error.
    pub fn work_at_error(&self, curve: &str, name: &str, level: f64) -> Option<f64> {
        let trials = self.trials.iter().filter(|trial| trial.curve == curve);
        let trials: Vec<&Trial<K, T>> = trials.collect();
        assert!(!trials.is_empty(), "no contender {curve:?}");
        if trials[0].error(name) <= level {
            return Some(trials[0].work as f64);
        }
        let [above, below] = trials.windows(2).find_map(|pair| {
            let pair: [&Trial<K, T>; 2] = pair.try_into().ok()?;
            (pair[1].error(name) <= level).then_some(pair)
        })?;
        if below.error(name) <= 0.0 {
            return Some(below.work as f64);
        }
        let part = (above.error(name) / level).ln() / (above.error(name) / below.error(name)).ln();
        Some(above.work as f64 * (below.work as f64 / above.work as f64).powf(part))
    }

    /// A sentence on what each curve takes to come down to an error, in the counted work per item
    /// (`per` says of what: `"rays per pixel"`): the fair comparison of methods that differ in both.
    ///
    /// # Panics
    /// If there is no such error.
    pub fn at_equal_error(&self, name: &str, level: f64, items: f64, per: &str) -> String {
        let curves = self.curves().map(|trials| {
            let curve = &trials[0].curve;
            let work = self.work_at_error(curve, name, level).map(|work| number(work / items));
            format!("{curve} {}", work.as_deref().unwrap_or("never"))
        });
        let curves: Vec<String> = curves.collect();
        format!("{name} {} takes, in {per}: {}", number(level), curves.join(", "))
    }

    /// The trials curve by curve.
    fn curves(&self) -> impl Iterator<Item = &[Trial<K, T>]> {
        self.trials.chunk_by(|a, b| a.curve == b.curve)
    }

    /// The chart of the error of that name.
    ///
    /// # Panics
    /// If the errors have no such name.
    pub fn chart(&self, error: &str) -> SpeedError {
        self.curves().fold(SpeedError::new(&self.work_unit, error), |chart, trials| {
            chart.curve(MethodCurve {
                label: trials[0].curve.clone(),
                color: trials[0].color,
                points: trials.iter().map(|trial| trial.point(error)).collect(),
            })
        })
    }

    /// All measurements, one contender a row.
    pub fn table(&self) -> Table {
        let seconds = ["seconds_min", "seconds_median", "seconds_max"];
        let errors = self.trials.first().map_or(&[][..], |trial| &trial.errors);
        let columns = ["method", "knob", self.work_unit.as_str()].into_iter().chain(seconds);
        let mut table = Table::new(columns.chain(errors.iter().map(|(name, _)| *name)));
        for trial in &self.trials {
            let Spread { low, mid, high } = trial.seconds;
            let knob = trial.knob.to_string();
            let names = [trial.curve.as_str(), &knob].map(Value::from);
            let numbers = [trial.work.into(), low.into(), mid.into(), high.into()];
            let errors = trial.errors.iter().map(|(_, error)| Value::from(*error));
            table.push(names.into_iter().chain(numbers).chain(errors));
        }
        table
    }
}

impl<K: Display, T> Trial<K, T> {
    /// The error of that name.
    ///
    /// # Panics
    /// If there is none: a figure asks for what it has measured.
    pub fn error(&self, name: &str) -> f64 {
        let found = self.errors.iter().find(|(known, _)| *known == name);
        found.unwrap_or_else(|| panic!("no error {name:?}")).1
    }

    fn point(&self, error: &str) -> CurvePoint {
        CurvePoint {
            knob: self.knob.to_string(),
            seconds: self.seconds,
            work: self.work,
            error: self.error(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;
    use crate::palette::category_color;

    #[test]
    fn contenders_run_in_turn_and_are_judged_by_their_outcome() {
        let order = RefCell::new(String::new());
        let contender = |curve: &str, knob: u64, outcome: f64| Contender {
            curve: curve.to_owned(),
            color: category_color(0),
            knob,
            run: {
                let (name, order) = (format!("{curve}{knob} "), &order);
                Box::new(move || {
                    order.borrow_mut().push_str(&name);
                    (outcome, 10 * knob)
                })
            },
        };
        let contenders =
            vec![contender("a", 1, 3.0), contender("a", 2, 2.5), contender("b", 1, 2.0)];
        let study = Study::measure("tests", 3, contenders, |&outcome: &f64| {
            vec![("error", outcome - 2.0), ("square", (outcome - 2.0).powi(2))]
        });
        assert_eq!(*order.borrow(), "a1 a2 b1 ".repeat(3));
        assert_eq!([study.at("a", 1).outcome, study.trials()[1].outcome], [3.0, 2.5]);
        assert_eq!(study.at("a", 2).error("square"), 0.25);
        assert_eq!(study.at("b", 1).work, 10);
        let Spread { low, mid, high } = study.at("b", 1).seconds;
        assert!(0.0 <= low && low <= mid && mid <= high);
        // From (10, 1) to (20, 1/2) the line has the slope −1: (40 / 3, 3 / 4) lies on it.
        let at = |label: &str, level: f64| study.work_at_error(label, "error", level);
        assert!((at("a", 0.75).unwrap() - 40.0 / 3.0).abs() < 1e-12);
        assert_eq!((at("a", 2.0), at("a", 0.1), at("b", 0.0)), (Some(10.0), None, Some(10.0)));
        let sentence = study.at_equal_error("error", 0.75, 2.0, "tests per ray");
        assert_eq!(sentence, "error 0.75 takes, in tests per ray: a 6.67, b 5");
        let csv = study.table().to_csv();
        let header = "method,knob,tests,seconds_min,seconds_median,seconds_max,error,square";
        assert_eq!(csv.lines().next(), Some(header));
        assert!(csv.lines().nth(2).is_some_and(|row| row.starts_with("a,2,20,")));
        assert!(csv.lines().nth(2).is_some_and(|row| row.ends_with(",0.5,0.25")));
        assert_eq!(csv.lines().count(), 4);
    }
}
