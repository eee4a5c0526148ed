//! The range of depths that a method with few intervals of depth spreads them over: the view's, or a pixel's own. The shader is
//! `helpers/range_of_pixel.wgsl`.

/// Whose depths the range spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bounds {
    /// The transparent objects of the view, as the depth warp has it.
    Frame,
    /// The pixel's own fragments, which takes a pass of its own.
    Pixel,
}

/// Ranges of warped depth below this are one depth: 32-bit floats near 1 have 17 values in it.
pub const LEAST_EXTENT: f64 = 1e-6;

/// Where in the range each of a pixel's fragments lies, given by their warped depths: 0 at its near end, 1 at its far end; 0 in a range that
/// is one depth.
pub fn places(bounds: Bounds, zetas: &[f64]) -> Vec<f64> {
    let [near, far] = match bounds {
        Bounds::Frame => [-1.0, 1.0],
        Bounds::Pixel => [
            zetas.iter().copied().fold(f64::INFINITY, f64::min),
            zetas.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        ],
    };
    let extent = far - near;
    let place = |zeta: &f64| match extent < LEAST_EXTENT {
        true => 0.0,
        false => ((zeta - near) / extent).clamp(0.0, 1.0),
    };
    zetas.iter().map(place).collect()
}
