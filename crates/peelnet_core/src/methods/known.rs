//! What is known of a fragment's weight before a network is asked.

/// Absorbance of which an unknown fraction lies in front of a fragment.
pub trait Unknown {
    fn absorbance(&self) -> f64;

    /// The least and the most of the fraction.
    fn bounds(&self) -> [f64; 2] {
        [0.0, 1.0]
    }
}

/// What the last pass knows of a fragment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownFragment<U> {
    /// Absorbance that is known to lie in front.
    pub front: f64,
    /// What else may; none where the weight is known.
    pub unknown: Option<U>,
}

impl<U: Unknown> KnownFragment<U> {
    /// The weight, given where between its bounds the fraction lies that is in front, 0 … 1.
    pub fn weight(&self, guess: impl FnOnce(&U) -> f64) -> f64 {
        let unknown = self.unknown.as_ref().map_or(0.0, |unknown| {
            let [low, high] = unknown.bounds();
            unknown.absorbance() * (low + (high - low) * guess(unknown))
        });
        (-(self.front + unknown)).exp()
    }
}
