//! What is known of a fragment's weight before a network is asked.

/// What the last pass knows of a fragment; `U` is what a network reads of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownFragment<U> {
    /// Absorbance that is known to lie in front.
    pub front: f64,
    /// Absorbance of which an unknown fraction lies in front, the least and the most of it.
    pub absorbance: f64,
    pub bounds: [f64; 2],
    /// None where the weight is known.
    pub unknown: Option<U>,
}

impl<U> KnownFragment<U> {
    pub const fn known(front: f64) -> Self {
        Self {
            front,
            absorbance: 0.0,
            bounds: [0.0, 1.0],
            unknown: None,
        }
    }

    /// The weight, given where between its bounds the fraction lies that is in front, 0 … 1.
    pub fn weight(&self, guess: impl FnOnce(&U) -> f64) -> f64 {
        let [low, high] = self.bounds;
        let unknown = self.unknown.as_ref();
        let unknown = unknown.map_or(0.0, |u| self.absorbance * (low + (high - low) * guess(u)));
        (-(self.front + unknown)).exp()
    }

    /// The same, of which a network reads something else.
    pub fn map<V>(self, read: impl FnOnce(&U) -> V) -> KnownFragment<V> {
        KnownFragment {
            front: self.front,
            absorbance: self.absorbance,
            bounds: self.bounds,
            unknown: self.unknown.as_ref().map(read),
        }
    }
}
