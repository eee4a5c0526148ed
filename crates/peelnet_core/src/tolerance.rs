//! The error bounds that tests and checks may use: each has a name, a formula and a reason.

/// Unit roundoff of 32-bit floats, `2⁻²⁴`.
pub const UNIT_ROUNDOFF: f64 = 1.0 / 16_777_216.0;

/// Bound on `|T̂ − T|` when a product of `n` factors in 0 … 1 is formed in 32 bits: each of the `n`
/// multiplications and `n` subtractions `1 − α` errs by at most one unit roundoff of a value ≤ 1.
pub fn transmittance(n: usize) -> f64 {
    2.0 * n as f64 * UNIT_ROUNDOFF
}

/// Bound on the absolute error of a colour composited in 32 bits from `n` fragments whose radiance is at most
/// `peak`: every term carries the error of its transmittance and three roundings (premultiply, multiply, add), and
/// the partial sums stay below `peak`.
pub fn composite(n: usize, peak: f64) -> f64 {
    peak * (n as f64 + 1.0) * (3.0 * UNIT_ROUNDOFF + transmittance(n).min(UNIT_ROUNDOFF * 8.0))
}

/// Agreement that the specification asks of exact methods with a 64-bit composite, linear light.
pub const EXACT: f64 = 1e-5;

/// Agreement of an exported 32-bit function with the 64-bit forward pass, relative to the last layer's `Σ|w||x| + |b|`,
/// which is what a dot product's rounding error is a multiple of (its result may be a cancelled remainder of that). A
/// 3-10-8-1 network is about 120 rounded operations, whose errors partly cancel; the specification fixes the bound.
pub const EXPORT_F32: f64 = 1e-5;

/// The same for 16-bit functions: half floats round at `2⁻¹¹ ≈ 4.9e-4`.
pub const EXPORT_F16: f64 = 2e-3;
