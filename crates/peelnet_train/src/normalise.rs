//! Mean and deviation of each input over the training rows.

/// `normalised = (raw − offset) · scale`, and the range of the raw values it was made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Normalisation {
    pub(crate) offset: f32,
    pub(crate) scale: f32,
    pub(crate) min: f32,
    pub(crate) max: f32,
    /// The training rows do not vary in this input.
    pub(crate) constant: bool,
}

impl Normalisation {
    /// From the values at `rows`, in 64 bits and two passes: depths around 1e9 would lose their deviation otherwise.
    ///
    /// A column counts as constant when it has one value, or when its deviation is so small or large that the inverse is
    /// not a normal number. Rounding the mean to 32 bits does no harm even where neighbouring values differ in the last
    /// bit: it errs by no more than one deviation. A constant column trains as zero, and the model has zero weights for it: the network never saw it vary, so it must not react when
    /// it does. Its scale is 1, because a model file wants an invertible one.
    pub(crate) fn over(values: &[f32], rows: &[u32]) -> Self {
        let at = || rows.iter().map(|&row| values[row as usize]);
        let n = rows.len().max(1) as f64;
        let mean = at().map(f64::from).sum::<f64>() / n;
        let variance = at().map(|v| (f64::from(v) - mean).powi(2)).sum::<f64>() / n;
        let deviation = variance.sqrt();
        let (min, max) = at().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        let scale = (1.0 / deviation) as f32;
        let constant = min == max || !scale.is_normal();
        Self {
            offset: mean as f32,
            scale: if constant { 1.0 } else { scale },
            min,
            max,
            constant,
        }
    }

    /// Appends the values at `rows`, normalised exactly as evaluation does it; zero for a constant column.
    pub(crate) fn append(self, values: &[f32], rows: &[u32], to: &mut Vec<f32>) {
        let normalised = |&row: &u32| (values[row as usize] - self.offset) * self.scale;
        if self.constant {
            to.resize(to.len() + rows.len(), 0.0);
        } else {
            to.extend(rows.iter().map(normalised));
        }
    }

    /// The values at `rows`, normalised.
    #[cfg(test)]
    fn apply(self, values: &[f32], rows: &[u32]) -> Vec<f32> {
        let mut to = Vec::new();
        self.append(values, rows, &mut to);
        to
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_values_become_minus_one_and_one() {
        let n = Normalisation::over(&[2.0, 100.0, 6.0], &[0, 2]);
        assert_eq!((n.offset, n.scale, n.min, n.max), (4.0, 0.5, 2.0, 6.0));
        assert_eq!(n.apply(&[2.0, 100.0, 6.0], &[0, 2]), [-1.0, 1.0]);
    }

    #[test]
    fn a_constant_column_is_ignored() {
        let n = Normalisation::over(&[0.1; 7], &[0, 1, 2, 3, 4, 5, 6]);
        assert!(n.constant);
        assert_eq!((n.offset, n.scale), (0.1, 1.0));
        assert_eq!(n.apply(&[0.1, 1e30], &[0, 1]), [0.0, 0.0]);
    }

    /// Around 1e9 neighbouring floats are 64 apart, and a sum of squares in 32 bits would hold nothing of that.
    #[test]
    fn depths_of_a_thousand_million_keep_their_deviation() {
        let values: Vec<f32> = (0..1000).map(|i| 1e9 + 64.0 * (i % 2) as f32).collect();
        let rows: Vec<u32> = (0..1000).collect();
        let n = Normalisation::over(&values, &rows);
        assert_eq!(n.scale, 1.0 / 32.0);
        assert!(n.apply(&values, &rows).iter().all(|v| v.abs() <= 2.0));
    }

    #[test]
    fn the_largest_floats_do_not_overflow() {
        let n = Normalisation::over(&[-3e38, 3e38], &[0, 1]);
        assert_eq!(n.offset, 0.0);
        // 1 / 3e38 is below the normal range.
        assert!(n.constant);
        assert!(
            n.apply(&[-3e38, 3e38], &[0, 1])
                .iter()
                .all(|v| v.is_finite())
        );
    }
}
