//! `nmt`: a network reads the moments of a pixel (Tsopouridis, Vasilakos & Fudos 2024).

use super::mboit4::Moments;

/// What the network reads of a fragment at warped depth `zeta`: ζ, the number of the pixel's fragments, `b_0`, and
/// `b_1 … b_4` over it.
pub fn inputs(moments: &Moments, n: usize, zeta: f64) -> [f64; 7] {
    let [b0, b1, b2, b3, b4] = moments.0;
    let total = b0.max(1e-6);
    [
        zeta,
        n as f64,
        b0,
        b1 / total,
        b2 / total,
        b3 / total,
        b4 / total,
    ]
}
