/// The mean of samples and how far it may be from what they estimate.
///
/// ```text
/// eq:monte-carlo          ⟨F⟩ = 1/N Σ f(xᵢ) / p(xᵢ)
///                         SE  = s / √N,   s² = 1/(N−1) Σ ( f(xᵢ)/p(xᵢ) − ⟨F⟩ )²
/// ```
///
/// | formula      | here                           |                                                 |
/// |--------------|--------------------------------|-------------------------------------------------|
/// | f(xᵢ)/p(xᵢ)  | what [`Estimate::add`] is told | the integrand at a sample over its density      |
/// | N            | [`Estimate::count`]            |                                                 |
/// | ⟨F⟩          | [`Estimate::mean`]             | its expectation is the integral F               |
/// | s²           | [`Estimate::variance`]         | of one sample; N − 1 makes it unbiased          |
/// | SE           | [`Estimate::standard_error`]   | of the mean, if the samples are independent     |
///
/// The samples of one pixel stratify each other, so their mean is nearer than SE says. What is independent, and gives
/// an honest SE, are the means of several seeds.
///
/// Source: Welford, *Note on a Method for Calculating Corrected Sums of Squares and Products*, Technometrics 4(3),
/// 1962: the sum of squares minus the square of the sum would cancel where the mean is large.
#[doc(alias = "eq:monte-carlo")]
#[doc(alias = "intégration de Monte Carlo")]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    count: u64,
    mean: f64,
    /// Σ (x − mean)².
    squares: f64,
}

impl Estimate {
    /// Takes in a sample.
    #[inline]
    pub fn add(&mut self, x: f64) {
        self.count += 1;
        let off = x - self.mean;
        self.mean += off / self.count as f64;
        self.squares += off * (x - self.mean);
    }

    /// The estimate from the samples of both (Chan, Golub, LeVeque, *Updating Formulae and a Pairwise Algorithm for
    /// Computing Sample Variances*, 1979).
    #[must_use]
    #[inline]
    pub fn merge(self, other: Self) -> Self {
        if self.count == 0 || other.count == 0 {
            return if self.count == 0 { other } else { self };
        }
        let count = self.count + other.count;
        let (n, m) = (self.count as f64, other.count as f64);
        let off = other.mean - self.mean;
        Self {
            count,
            mean: self.mean + off * (m / count as f64),
            squares: self.squares + other.squares + off * off * (n * (m / count as f64)),
        }
    }

    /// How many samples there were.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Their mean; 0 of none.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// The variance of one sample; NaN below two samples, which say nothing of it.
    pub fn variance(&self) -> f64 {
        if self.count < 2 { f64::NAN } else { self.squares / (self.count - 1) as f64 }
    }

    /// The standard deviation of the mean; NaN below two samples.
    pub fn standard_error(&self) -> f64 {
        (self.variance() / self.count as f64).sqrt()
    }
}

impl Extend<f64> for Estimate {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, samples: I) {
        for x in samples {
            self.add(x);
        }
    }
}

impl FromIterator<f64> for Estimate {
    fn from_iter<I: IntoIterator<Item = f64>>(samples: I) -> Self {
        let mut estimate = Self::default();
        estimate.extend(samples);
        estimate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `eq:monte-carlo`, by hand: 2, 4, 4, 4, 5, 5, 7, 9 have the mean 5 and Σ (x − 5)² = 32.
    #[test]
    fn mean_variance_and_error_by_hand() {
        let estimate: Estimate = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0].into_iter().collect();
        assert_eq!(estimate.count(), 8);
        assert!((estimate.mean() - 5.0).abs() < 1e-15);
        assert!((estimate.variance() - 32.0 / 7.0).abs() < 1e-14);
        assert!((estimate.standard_error() - (4.0_f64 / 7.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn few_samples_say_little() {
        let none = Estimate::default();
        assert_eq!((none.count(), none.mean()), (0, 0.0));
        assert!(none.variance().is_nan() && none.standard_error().is_nan());
        let one: Estimate = [3.0].into_iter().collect();
        assert!(one.mean() == 3.0 && one.variance().is_nan());
        let two: Estimate = [3.0, 5.0].into_iter().collect();
        assert_eq!((two.mean(), two.variance(), two.standard_error()), (4.0, 2.0, 1.0));
    }

    /// Squares cancel: 10⁹ + {4, 7, 13, 16} has the variance 30, of which the naive form knows nothing.
    #[test]
    fn a_large_mean_does_not_hide_the_variance() {
        let samples = [4.0, 7.0, 13.0, 16.0].map(|x| 1e9 + x);
        let estimate: Estimate = samples.into_iter().collect();
        assert!((estimate.variance() - 30.0).abs() < 1e-9, "{}", estimate.variance());
        let sum = |power| samples.iter().map(|x: &f64| x.powi(power)).sum::<f64>();
        let naive = (sum(2) - sum(1).powi(2) / 4.0) / 3.0;
        assert!((naive - 30.0).abs() > 1.0, "{naive}");
    }

    #[test]
    fn merged_parts_are_the_whole() {
        let samples: Vec<f64> = (0..100).map(|k| f64::from(k * k % 37) + 1e3).collect();
        let whole: Estimate = samples.iter().copied().collect();
        for cut in [0, 1, 13, 50, 99, 100] {
            let (a, b) = samples.split_at(cut);
            let [a, b] = [a, b].map(|part| part.iter().copied().collect::<Estimate>());
            let merged = a.merge(b);
            assert_eq!(merged.count(), 100);
            assert!((merged.mean() - whole.mean()).abs() < 1e-12, "{cut}");
            let off = merged.variance() / whole.variance() - 1.0;
            assert!(off.abs() < 1e-13, "{cut}: {off}");
        }
    }

    #[test]
    fn a_sample_that_is_no_number_is_not_averaged_away() {
        let estimate: Estimate = [1.0, f64::NAN, 2.0].into_iter().collect();
        assert!(estimate.mean().is_nan() && estimate.variance().is_nan());
    }
}
