// Statistics pass: draw all transparent surfaces, in any order, into
//     absorbance  rg32float, cleared to 0, blending ONE, ONE, ADD: peelnet_statistics(..).absorbance
//     moments     rgba32float, the same: peelnet_statistics(..).moments
// zeta is depth on a logarithmic scale over the range of the frame's transparent objects, -1 .. 1.
// Weight pass: draw them again; each fragment calls peelnet_fragment(zeta, absorbance, moments) for its weight w and
// writes (alpha * rgb * w, alpha * w) to an rgba16float target (cleared to 0, ONE, ONE, ADD). Resolve over the background
// C_0 with T = exp(-absorbance.x), where T is not 1:  sums.rgb / sums.a * (1 - T) + C_0 * T

struct PeelnetStatistics {
    // Absorbance and 1: their sums are b_0 and the number of fragments.
    absorbance: vec2f,
    // b zeta .. b zeta^4.
    moments: vec4f,
}

fn peelnet_statistics(alpha: f32, zeta: f32) -> PeelnetStatistics {
    let b = -log(max(1.0 - alpha, 1.1253517e-7));
    let z2 = zeta * zeta;
    return PeelnetStatistics(vec2f(b, 1.0), b * vec4f(zeta, z2, z2 * zeta, z2 * z2));
}
