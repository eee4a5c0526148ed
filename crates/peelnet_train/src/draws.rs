//! What is drawn from the seed: streams of random numbers, and the pixels that are used of large datasets.

use peelnet_core::random::Random;

use crate::error::TrainError;

/// What a stream of random numbers is for: streams of one seed must not overlap.
#[derive(Clone, Copy)]
pub(crate) enum Stream {
    Weights,
    Split,
    /// The order of examples in an epoch.
    Order(u32),
    /// Whether a pixel is used: its view, and its place in it.
    Sample(u64, u64),
    /// The order of blocks in an epoch of streamed examples.
    Blocks(u32),
    /// The order of examples in a window of an epoch.
    Window(u32, u64),
}

impl Stream {
    pub(crate) fn random(self, seed: u64) -> Random {
        match self {
            Self::Weights => Random::new(seed, &[1, 0]),
            Self::Split => Random::new(seed, &[2, 0]),
            Self::Order(epoch) => Random::new(seed, &[3, epoch.into()]),
            Self::Sample(view, place) => Random::new(seed, &[4, view, place]),
            Self::Blocks(epoch) => Random::new(seed, &[5, epoch.into()]),
            Self::Window(epoch, window) => Random::new(seed, &[6, epoch.into(), window]),
        }
    }

    pub(crate) fn permuted<T: Copy>(self, seed: u64, items: &[T]) -> Vec<T> {
        let order = self.random(seed).permutation(items.len() as u32);
        order.into_iter().map(|i| items[i as usize]).collect()
    }
}

/// Fraction of the limit that the draw aims at, so that chance hardly ever reaches the limit itself.
const AIM: f64 = 0.99;

/// Draws whole pixels where datasets have more rows than a training may hold in memory: the same fraction of every view, from the seed. The
/// draw of a pixel depends on nothing but the seed, the view and the pixel's place. At most `most` rows of `total` are kept.
pub(crate) struct Sample {
    seed: u64,
    most: u64,
    total: u64,
    fraction: f64,
    /// Number of the view, rows of the views up to and with it.
    view: u64,
    seen: u64,
    kept: u64,
}

impl Sample {
    /// Of so many rows in all views.
    pub(crate) fn new(seed: u64, most: u64, total: u64) -> Self {
        let is_part = total > most;
        Self {
            seed,
            most,
            total,
            fraction: if is_part {
                AIM * most as f64 / total as f64
            } else {
                1.0
            },
            view: 0,
            seen: 0,
            kept: 0,
        }
    }

    /// The next view begins, of so many rows.
    pub(crate) fn begin(&mut self, rows: u64) {
        self.view += 1;
        self.seen = self.seen.saturating_add(rows);
    }

    pub(crate) fn keep(&mut self, [x, y]: [u32; 2], rows: usize) -> bool {
        if self.fraction < 1.0 {
            let place = u64::from(x) << 32 | u64::from(y);
            if f64::from(Stream::Sample(self.view, place).random(self.seed).unit()) >= self.fraction
            {
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
    pub(crate) fn rows_kept(&self) -> Result<u64, TrainError> {
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

    /// Frozen, because released weights can only be made again if this never changes.
    #[test]
    fn the_stream_never_changes() {
        let order = |epoch| Stream::Order(epoch).random(42).permutation(8);
        assert_eq!(order(3), [1, 2, 7, 4, 6, 3, 0, 5]);
        assert_ne!(order(1), order(2));
    }

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
                let pixels = (0..pixels(view)).filter(|&x| sample.keep([x, view], rows(x)));
                kept += pixels.map(rows).sum::<usize>() as u64;
                let fraction = (kept - before) as f64 / of_view(view) as f64;
                let expected = (most as f64 / total as f64).min(1.0);
                // Six standard deviations of pixels of up to twelve rows, and the aim below the limit.
                let spread = 6.0 * (12.0 * expected / of_view(view) as f64).sqrt();
                assert!(
                    (fraction - expected).abs() <= spread + 0.02 * expected,
                    "{most}, {view}: {fraction}"
                );
            }
            assert!(kept <= most, "{kept} of {most}");
            assert!(
                kept as f64 >= 0.8 * most.min(total) as f64,
                "{kept} of {most}"
            );
            assert_eq!(sample.rows_kept().ok(), Some(kept));
        }
    }
}
