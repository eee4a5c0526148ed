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

/// Count, mean, squared deviations and range of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moments {
    count: u64,
    mean: f64,
    /// `Σ (v − mean)²`
    squares: f64,
    min: f32,
    max: f32,
}

impl Moments {
    /// Of no values.
    pub(crate) const NONE: Self = Self {
        count: 0,
        mean: 0.0,
        squares: 0.0,
        min: f32::INFINITY,
        max: f32::NEG_INFINITY,
    };

    /// Of the values at `rows`, in 64 bits and two passes: depths around 1e9 would lose their deviation otherwise.
    pub(crate) fn over(values: &[f32], rows: &[u32]) -> Self {
        let at = || rows.iter().map(|&row| values[row as usize]);
        let mean = at().map(f64::from).sum::<f64>() / rows.len().max(1) as f64;
        let (min, max) = at().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        Self {
            count: rows.len() as u64,
            mean,
            squares: at().map(|v| (f64::from(v) - mean).powi(2)).sum(),
            min,
            max,
        }
    }

    /// Of the values of both (Chan, Golub and LeVeque, "Updating formulae and a pairwise algorithm for computing sample variances",
    /// 1979). The last bits depend on the order in which blocks of values are merged.
    pub(crate) fn merge(self, other: Self) -> Self {
        if self.count == 0 || other.count == 0 {
            return if self.count == 0 { other } else { self };
        }
        let count = self.count + other.count;
        let share = other.count as f64 / count as f64;
        let difference = other.mean - self.mean;
        Self {
            count,
            mean: self.mean + difference * share,
            squares: self.squares
                + other.squares
                + difference * difference * (self.count as f64 * share),
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }
}

impl Normalisation {
    /// From the values at `rows`.
    pub(crate) fn over(values: &[f32], rows: &[u32]) -> Self {
        Self::of(&Moments::over(values, rows))
    }

    /// From the moments of the values.
    ///
    /// A column counts as constant when it has one value, or when its deviation is so small or large that the inverse is
    /// not a normal number. Rounding the mean to 32 bits does no harm even where neighbouring values differ in the last
    /// bit: it errs by no more than one deviation. A constant column trains as zero, and the model has zero weights for it: the network never saw it vary, so it must not react when
    /// it does. Its scale is 1, because a model file wants an invertible one.
    pub(crate) fn of(moments: &Moments) -> Self {
        let Moments { min, max, .. } = *moments;
        let deviation = (moments.squares / moments.count.max(1) as f64).sqrt();
        let scale = (1.0 / deviation) as f32;
        let constant = min == max || !scale.is_normal();
        Self {
            offset: moments.mean as f32,
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

    /// Merging blocks of any size gives the moments of all values. Both ways round each of n sums of terms of one sign in 64 bits: the
    /// relative error is at most n ε, and that of the mean n ε times the mean magnitude of the values.
    #[test]
    fn merged_blocks_have_the_moments_of_all_values() {
        let mut random = crate::sampler::Stream::Weights.of(5);
        for (n, offset) in [(1u32, 0.0), (7, 3.0), (5000, 1e4), (20_000, -40.0)] {
            let values: Vec<f32> = (0..n).map(|_| offset + 8.0 * random.unit()).collect();
            let rows: Vec<u32> = (0..n).collect();
            let all = Moments::over(&values, &rows);
            for size in [1, 3, 1024] {
                let merged = rows
                    .chunks(size)
                    .map(|block| Moments::over(&values, block))
                    .fold(Moments::NONE, Moments::merge);
                let rounding = f64::from(n) * f64::EPSILON;
                let magnitude = f64::from(offset.abs()) + 8.0;
                assert!((merged.mean - all.mean).abs() <= rounding * magnitude);
                // The deviations carry the error of the mean, too.
                let squares = rounding * (all.squares + f64::from(n) * magnitude);
                assert!((merged.squares - all.squares).abs() <= squares);
                assert_eq!(
                    (merged.count, merged.min, merged.max),
                    (u64::from(n), all.min, all.max)
                );
            }
        }
    }
}
