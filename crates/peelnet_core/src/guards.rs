//! Constants that keep results finite, each with its reason. They are compared with those of the shaders by a test.

/// The smallest weight a learned transmittance may become: `2⁻¹⁴`, the smallest normal half float.
///
/// The thesis's network may answer with zero or below, and then the sum of weights of a pixel is zero or
/// negative: its "black artifacts". With this floor the sum is positive as soon as one fragment has α > 0, and a
/// 16-bit target can still hold it.
pub const WEIGHT_FLOOR: f32 = 1.0 / 16384.0;

/// The divisor's floor in the resolve of weighted methods with 16-bit targets. With 32-bit ones, and in the CPU references, it is the
/// smallest normal number.
///
/// `2⁻²⁴` is the smallest positive half float: a sum of weights that a 16-bit target can distinguish from zero is never
/// changed by the floor, and zero over the floor stays zero.
pub const SUM_FLOOR: f32 = 1.0 / 16_777_216.0;

/// With separate ends: what lies between them is scaled by no more than this to fill what they leave of the coverage. The ends fall
/// short where coincident fragments share one, and a faint fragment between must not be given what they miss.
pub const FILL_MAX: f32 = 16.0;

/// The least opacity of a surface that emits, below half a step of an 8-bit display. Weighted sums know what a fragment adds only in
/// proportion to what it covers, and a pixel of which nothing is covered keeps its background.
pub const EMISSIVE_ALPHA: f32 = 1.0 / 1024.0;

/// The largest finite half float, where 16-bit accumulators end.
pub const HALF_MAX: f32 = 65504.0;

/// Raw inputs of a network are cut off at ± this before they are normalised: beyond any scene's lengths, and small
/// enough that its product with any sensible scale is finite.
pub const RAW_LIMIT: f32 = 1e18;

/// Normalised inputs are cut off at ± this. Real data stay within tens of standard deviations; products of it with
/// weights stay finite by twenty orders of magnitude, so that no finite input makes an exported function answer NaN.
pub const INPUT_LIMIT: f32 = 1e4;

/// `√m_0` is cut off here: 65,536 of absorbance is more than 16-bit sums hold, and its square is finite.
pub const ROOT_ABSORBANCE_LIMIT: f32 = 256.0;
