// The resolve of every normalised method: (sum C w / sum alpha w)(1 - T) + C_0 T.
// Twin of peelnet_core::methods::wboit::normalised.
import package::helpers::guards::{SUM_FLOOR, HALF_MAX};

// `sums` holds sum C w and sum alpha w, `transmittance` T of the whole pixel. Returns colour and coverage.
fn normalised(sums: vec4f, transmittance: f32, background: vec3f) -> vec4f {
    // A pixel that nothing covers keeps C_0 bit for bit.
    if transmittance == 1.0 {
        return vec4f(background, 0.0);
    }
    // Where a 16-bit target overflowed every component is at its ceiling at best: grey of the average is the best
    // guess left. Some GPUs give infinity there, some the largest half.
    let finite = min(sums, vec4f(HALF_MAX));
    let average = finite.rgb / max(finite.a, SUM_FLOOR);
    return vec4f(average * (1.0 - transmittance) + background * transmittance, 1.0 - transmittance);
}
