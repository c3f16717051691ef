use rayon::prelude::*;

/// One channel of a picture, row by row.
pub(super) struct Plane {
    width: usize,
    values: Vec<f64>,
}

impl Plane {
    /// A plane from its values, row by row.
    pub(super) fn new(width: usize, values: Vec<f64>) -> Self {
        Self { width, values }
    }

    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Weighs the neighbours of each value in its row. The middle one of an odd number of `weights`
    /// is that of the value itself; beyond the border its last value repeats.
    pub(super) fn filter_rows(&self, weights: &[f64]) -> Self {
        let radius = weights.len() / 2;
        self.by_rows(|y, sums| {
            let row = self.row(y);
            let mut padded = vec![row[0]; self.width + 2 * radius];
            padded[radius..][..self.width].copy_from_slice(row);
            padded[radius + self.width..].fill(row[self.width - 1]);
            for (i, &weight) in weights.iter().enumerate() {
                add_weighted(sums, weight, &padded[i..]);
            }
        })
    }

    /// The same as [`Plane::filter_rows`] in columns.
    pub(super) fn filter_columns(&self, weights: &[f64]) -> Self {
        let radius = weights.len() / 2;
        let last = self.values.len() / self.width - 1;
        self.by_rows(|y, sums| {
            for (i, &weight) in weights.iter().enumerate() {
                let neighbour = (y + i).saturating_sub(radius).min(last);
                add_weighted(sums, weight, self.row(neighbour));
            }
        })
    }

    /// This plane plus `weight` times `other`, value by value.
    pub(super) fn plus(mut self, weight: f64, other: &Self) -> Self {
        add_weighted(&mut self.values, weight, &other.values);
        self
    }

    /// A plane of the same size.
    pub(super) fn zeros(&self) -> Self {
        Self::new(self.width, vec![0.0; self.values.len()])
    }

    fn row(&self, y: usize) -> &[f64] {
        &self.values[y * self.width..][..self.width]
    }

    /// A plane of the same size from a function that adds row `y` to zeros.
    fn by_rows(&self, add_row: impl Fn(usize, &mut [f64]) + Sync) -> Self {
        let mut plane = self.zeros();
        let rows = plane.values.par_chunks_exact_mut(self.width);
        rows.enumerate().for_each(|(y, row)| add_row(y, row));
        plane
    }
}

fn add_weighted(sums: &mut [f64], weight: f64, values: &[f64]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_columns_are_weighed_and_borders_repeat() {
        let plane = Plane::new(3, vec![1.0, 2.0, 4.0, 8.0, 16.0, 32.0]);
        let weights = [100.0, 10.0, 1.0];
        let rows = [112.0, 124.0, 244.0, 896.0, 992.0, 1952.0];
        assert_eq!(plane.filter_rows(&weights).values(), rows);
        let columns = [118.0, 236.0, 472.0, 188.0, 376.0, 752.0];
        assert_eq!(plane.filter_columns(&weights).values(), columns);
        // A filter wider than the picture.
        assert_eq!(Plane::new(1, vec![3.0]).filter_rows(&[1.0; 9]).values(), [27.0]);
    }

    #[test]
    fn a_weight_of_zero_does_not_hide_a_nan() {
        let plane = Plane::new(2, vec![f64::NAN, 1.0]);
        assert!(plane.filter_rows(&[0.0; 3]).values().iter().all(|value| value.is_nan()));
    }
}
