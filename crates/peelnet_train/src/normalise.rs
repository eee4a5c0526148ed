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
        let fraction = other.count as f64 / count as f64;
        let difference = other.mean - self.mean;
        Self {
            count,
            mean: self.mean + difference * fraction,
            squares: self.squares
                + other.squares
                + difference * difference * (self.count as f64 * fraction),
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }
}

impl Normalisation {
    /// From the moments of the values.
    ///
    /// A column counts as constant when it has one value, or when its deviation is so small or large that the inverse is
    /// not a normal number. Rounding the mean to 32 bits does no harm even where neighbouring values differ in the last
    /// bit: it errs by no more than one deviation. A constant column trains as zero, and the model has zero weights for it: the network never saw it vary, so it must not react when
    /// it does. Its scale is 1, because a model file wants an invertible one.
    pub(crate) fn from_moments(moments: &Moments) -> Self {
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

    /// A raw value, normalised exactly as evaluation does it; zero for a constant column.
    pub(crate) fn apply(self, value: f32) -> f32 {
        if self.constant {
            return 0.0;
        }
        (value - self.offset) * self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The normalisation of all values, and what it makes of values.
    fn normalised(values: &[f32], raw: &[f32]) -> (Normalisation, Vec<f32>) {
        let all = |values: &[f32]| (0..values.len() as u32).collect::<Vec<_>>();
        let n = Normalisation::from_moments(&Moments::over(values, &all(values)));
        (n, raw.iter().map(|&value| n.apply(value)).collect())
    }

    #[test]
    fn values_get_mean_0_and_deviation_1() {
        let (n, to) = normalised(&[2.0, 6.0], &[2.0, 100.0]);
        assert_eq!((n.offset, n.scale, n.min, n.max), (4.0, 0.5, 2.0, 6.0));
        assert_eq!(to, [-1.0, 48.0]);
        // Around 1e9 neighbouring floats are 64 apart, and a sum of squares in 32 bits would hold nothing of that.
        let values: Vec<f32> = (0..1000).map(|i| 1e9 + 64.0 * (i % 2) as f32).collect();
        let (n, to) = normalised(&values, &values);
        assert_eq!(n.scale, 1.0 / 32.0);
        assert!(to.iter().all(|v| v.abs() <= 2.0));
    }

    /// One value, or values so large that 1 / 3e38 is below the normal range.
    #[test]
    fn a_constant_column_is_ignored() {
        for (values, offset) in [([0.1; 2], 0.1), ([-3e38, 3e38], 0.0)] {
            let (n, to) = normalised(&values, &[0.1, 3e38]);
            assert_eq!((n.constant, n.offset, n.scale), (true, offset, 1.0));
            assert_eq!(to, [0.0, 0.0]);
        }
    }
}
