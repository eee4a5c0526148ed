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
    /// Two stretches of warped depth, in order, in which nothing lies; methods that cut depth into slabs leave them out ([`Self::cut`]).
    pub gaps: [[f64; 2]; 2],
}

/// What is left of a gap, of a warped range of 2: a gap that opens or closes changes nothing at once.
const LEFT_OF_GAP: f64 = 0.125;

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
            gaps: [[1.0; 2]; 2],
        }
    }

    /// The same with the two longest gaps between these spans of depth, nearest and farthest.
    pub fn with_spans(self, spans: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let mut spans: Vec<_> = (spans.into_iter())
            .map(|span| span.map(|depth| self.apply(depth)))
            .collect();
        spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut gaps = Vec::new();
        let mut reached = spans.first().map_or(1.0, |span| span[0]);
        for [from, to] in spans {
            let gap = [reached + LEFT_OF_GAP / 2.0, from - LEFT_OF_GAP / 2.0];
            if gap[0] < gap[1] {
                gaps.push(gap);
            }
            reached = reached.max(to);
        }
        gaps.sort_by(|a, b| (b[1] - b[0]).total_cmp(&(a[1] - a[0])));
        gaps.resize(2, [1.0; 2]);
        gaps.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Self {
            gaps: [gaps[0], gaps[1]],
            ..self
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

    /// The same with the gaps left out, −1 … 1 again.
    ///
    /// ```
    /// # use peelnet_core::absorbance::DepthWarp;
    /// let w = DepthWarp::new(1.0, 100.0).with_spans([[1.0, 2.0], [50.0, 100.0]]);
    /// let gap = w.cut(50.0) - w.cut(2.0);
    /// assert!(gap > 0.2 && gap < 0.4 && w.apply(50.0) - w.apply(2.0) > 1.3);
    /// assert!((w.cut(1.0) + 1.0).abs() < 1e-12 && (w.cut(100.0) - 1.0).abs() < 1e-12);
    /// ```
    pub fn cut(&self, depth: f64) -> f64 {
        let zeta = self.apply(depth);
        let length = |[from, to]: [f64; 2]| to - from;
        let passed = self.gaps.map(|gap| (zeta - gap[0]).clamp(0.0, length(gap)));
        let lengths = self.gaps.map(length);
        let kept = zeta + 1.0 - passed[0] - passed[1];
        2.0 * kept / (2.0 - lengths[0] - lengths[1]) - 1.0
    }
}
