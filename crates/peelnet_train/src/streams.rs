//! The streams of random numbers for initial weights, the split and the order of rows.

use peelnet_core::random::Random;

/// What a stream of numbers is for: streams of one seed must not overlap.
#[derive(Clone, Copy)]
pub(crate) enum Stream {
    Weights,
    Split,
    /// The order of rows in an epoch.
    Order(u32),
    /// Whether a pixel is used: its view, and its place in it.
    Sample(u64, u64),
    /// The order of blocks in an epoch of streamed examples.
    Blocks(u32),
    /// The order of examples in a window of an epoch.
    Window(u32, u64),
}

impl Stream {
    /// The stream of a seed.
    pub(crate) fn of(self, seed: u64) -> Random {
        let (kind, index) = match self {
            Self::Weights => (1, 0),
            Self::Split => (2, 0),
            Self::Order(epoch) => (3, u64::from(epoch)),
            Self::Sample(view, place) => return Random::new(seed, &[4, view, place]),
            Self::Blocks(epoch) => (5, u64::from(epoch)),
            Self::Window(epoch, window) => {
                return Random::new(seed, &[6, epoch.into(), window]);
            }
        };
        Random::new(seed, &[kind, index])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_depends_on_the_epoch() {
        let order = |epoch| Stream::Order(epoch).of(7).permutation(1000);
        assert_ne!(order(1), order(2));
        assert_eq!(order(1), order(1));
    }

    /// Frozen, because released weights can only be made again if this never changes.
    #[test]
    fn the_stream_never_changes() {
        assert_eq!(
            Stream::Order(3).of(42).permutation(8),
            [1, 2, 7, 4, 6, 3, 0, 5]
        );
    }
}
