//! Which pixels are used where a dataset has more rows than a training may hold in memory.

use crate::error::TrainError;
use crate::streams::Stream;

/// Share of the limit that the draw aims at, so that chance hardly ever reaches the limit itself.
const AIM: f64 = 0.99;

/// Draws whole pixels, the same share of every view, from the seed. The draw of a pixel depends on nothing but the seed, the view and the
/// pixel's place. At most the asked number of rows are kept.
pub(crate) struct Sample {
    seed: u64,
    /// Rows to keep at most, and rows of all views.
    most: u64,
    total: u64,
    share: f64,
    /// Number of the view, rows of the views up to and with it.
    view: u64,
    seen: u64,
    /// Rows kept so far.
    kept: u64,
}

impl Sample {
    /// Of so many rows in all views.
    pub(crate) fn new(seed: u64, most: u64, total: u64) -> Self {
        Self {
            seed,
            most,
            total,
            share: if total > most {
                AIM * most as f64 / total as f64
            } else {
                1.0
            },
            view: 0,
            seen: 0,
            kept: 0,
        }
    }

    /// Every pixel.
    pub(crate) fn all() -> Self {
        Self::new(0, u64::MAX, 0)
    }

    /// The next view begins, of so many rows.
    pub(crate) fn begin(&mut self, rows: u64) {
        self.view += 1;
        self.seen = self.seen.saturating_add(rows);
    }

    /// Whether a pixel of the view is kept.
    pub(crate) fn keep(&mut self, [x, y]: [u32; 2], rows: usize) -> bool {
        if self.share < 1.0 {
            let place = u64::from(x) << 32 | u64::from(y);
            if f64::from(Stream::Sample(self.view, place).of(self.seed).unit()) >= self.share {
                return false;
            }
            // The views so far may hold their share of the limit, rounded down, so the last ones have theirs.
            let room = u128::from(self.most) * u128::from(self.seen) / u128::from(self.total);
            if u128::from(self.kept) + rows as u128 > room {
                return false;
            }
        }
        self.kept += rows as u64;
        true
    }

    /// Rows that were kept.
    ///
    /// # Errors
    /// None was, though there are some.
    pub(crate) fn kept(&self) -> Result<u64, TrainError> {
        if self.kept == 0 && self.total > 0 {
            return Err(TrainError::Config {
                setting: "max_rows",
                value: self.most.to_string(),
                hint: "give more: not one whole pixel fits",
            });
        }
        Ok(self.kept)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 40 views of very different sizes: each gives its share, and all together not more than the limit.
    #[test]
    fn every_view_gives_its_share_and_all_together_keep_the_limit() {
        let pixels = |view: u32| 500 * (1 + view % 7);
        let rows = |x: u32| 1 + (x % 12) as usize;
        let of_view = |view| (0..pixels(view)).map(rows).sum::<usize>() as u64;
        let total: u64 = (0..40).map(of_view).sum();
        for most in [100, 5_000, 100_000, total - 1, total, total + 1] {
            let mut sample = Sample::new(3, most, total);
            let mut kept = 0;
            for view in 0..40 {
                let before = kept;
                sample.begin(of_view(view));
                for x in 0..pixels(view) {
                    if sample.keep([x, view], rows(x)) {
                        kept += rows(x) as u64;
                    }
                }
                let share = (kept - before) as f64 / of_view(view) as f64;
                let asked = (most as f64 / total as f64).min(1.0);
                // Six standard deviations of pixels of up to twelve rows, and the aim below the limit.
                let spread = 6.0 * (12.0 * asked / of_view(view) as f64).sqrt();
                assert!(
                    (share - asked).abs() <= spread + 0.02 * asked,
                    "{most}, {view}: {share}"
                );
            }
            assert!(kept <= most, "{kept} of {most}");
            assert!(
                kept as f64 >= 0.8 * most.min(total) as f64,
                "{kept} of {most}"
            );
            assert_eq!(sample.kept().ok(), Some(kept));
        }
        assert!(Sample::new(3, 1, 9).kept().is_err());
    }
}
