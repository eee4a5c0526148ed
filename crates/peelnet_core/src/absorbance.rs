//! Absorbance, and the warped depth that its moments are taken of. The shader twin is `helpers/absorbance.wgsl`.

/// The largest absorbance of one fragment: `e⁻¹⁶ ≈ 1e−7` is opaque to any display, and sums of it stay small enough for
/// accumulators.
pub const ABSORBANCE_MAX: f64 = 16.0;

/// `b = −ln(1 − α)`, at most [`ABSORBANCE_MAX`], never infinite.
///
/// ```
/// # use peelnet_core::absorbance::absorbance;
/// assert_eq!(absorbance(0.0), 0.0);
/// assert!((absorbance(0.5) - 0.5f64.ln().abs()).abs() < 1e-12);
/// assert_eq!(absorbance(1.0), 16.0);
/// ```
pub fn absorbance(alpha: f32) -> f64 {
    (-f64::from((1.0 - alpha).max(0.0)).ln()).min(ABSORBANCE_MAX)
}

/// Maps depth to −1 … 1 by its logarithm over a range (Münstermann et al. 2018, §3.1): ratios of depth become
/// differences, so that near and far layers are told apart alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthWarp {
    /// `ln` of the range's near end.
    pub log_near: f64,
    /// `2 / (ln far − ln near)`; 0 for a range without extent.
    pub scale: f64,
}

impl DepthWarp {
    /// The warp of a depth range, scene units, `0 < near ≤ far`.
    ///
    /// ```
    /// # use peelnet_core::absorbance::DepthWarp;
    /// let w = DepthWarp::new(1.0, 100.0);
    /// assert!(w.apply(10.0).abs() < 1e-12 && (w.apply(100.0) - 1.0).abs() < 1e-12);
    /// assert_eq!(DepthWarp::new(3.0, 3.0).apply(3.0), -1.0);
    /// ```
    pub fn new(near: f64, far: f64) -> Self {
        let extent = far.ln() - near.ln();
        Self {
            log_near: near.ln(),
            // Closer than that, 32-bit depths hardly differ.
            scale: if extent > 1e-6 { 2.0 / extent } else { 0.0 },
        }
    }

    /// The warped depth ζ.
    pub fn apply(&self, depth: f64) -> f64 {
        ((depth.ln() - self.log_near) * self.scale - 1.0).clamp(-1.0, 1.0)
    }
}
