//! Absorbance, and the warped depth that its moments are taken of. The shader is `helpers/absorbance.wgsl`.

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
/// differences, so that near and far layers are resolved equally well. A range whose near end is not above 0, as orthographic
/// cameras may have, is mapped linearly. The same for networks is `learned/zeta.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthWarp {
    pub near: f64,
    log_near: f64,
    /// `2 / (ln far − ln near)`; 0 for a range without extent.
    pub scale: f64,
}

impl DepthWarp {
    /// The warp of a depth range, scene units, `near ≤ far`.
    ///
    /// ```
    /// # use peelnet_core::absorbance::DepthWarp;
    /// let w = DepthWarp::new(1.0, 100.0);
    /// assert!(w.apply(10.0).abs() < 1e-12 && (w.apply(100.0) - 1.0).abs() < 1e-12);
    /// assert_eq!(DepthWarp::new(3.0, 3.0).apply(3.0), -1.0);
    /// assert_eq!(DepthWarp::new(-2.0, 6.0).apply(2.0), 0.0);
    /// ```
    pub fn new(near: f64, far: f64) -> Self {
        // Closer than that, 32-bit depths hardly differ.
        let (extent, least) = if near > 0.0 {
            (far.ln() - near.ln(), 1e-6)
        } else {
            (far - near, 0.0)
        };
        Self {
            near,
            log_near: near.ln(),
            scale: if extent > least { 2.0 / extent } else { 0.0 },
        }
    }

    pub fn apply(&self, depth: f64) -> f64 {
        let from_near = if self.near > 0.0 {
            depth.ln() - self.log_near
        } else {
            depth - self.near
        };
        (from_near * self.scale - 1.0).clamp(-1.0, 1.0)
    }
}
