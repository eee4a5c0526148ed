struct PeelnetStatistics {
    // Absorbance and 1: their sums are b_0 and the number of fragments. The published layout has four channels.
    totals: vec4f,
    // b zeta .. b zeta^4.
    moments: vec4f,
    // -zeta and zeta: their maxima are the nearest, negated, and the farthest.
    extent: vec2f,
}

// What a fragment adds to its pixel's statistics.
fn peelnet_statistics(alpha: f32, zeta: f32) -> PeelnetStatistics {
    let b = min(peelnet_absorbance(alpha), 10.0);
    let square = zeta * zeta;
    return PeelnetStatistics(
        vec4f(b, 1.0, 0.0, 0.0),
        b * vec4f(zeta, square, square * zeta, square * square),
        vec2f(-zeta, zeta),
    );
}

// Exponential depth, 0 at the pixel's nearest and 1 at its farthest fragment; 0 in a pixel without an extent.
fn peelnet_depth(zeta: f32, extent: vec2f) -> f32 {
    let beyond = exp(0.5 * (vec2f(zeta, extent.y) + extent.x)) - 1.0;
    return clamp(beyond.x / max(beyond.y, 1.52587890625e-5), 0.0, 1.0);
}

// The weight of a fragment: the network's transmittance.
fn peelnet_fragment(zeta: f32, totals: vec4f, moments: vec4f, extent: vec2f) -> f32 {
    return peelnet_network(zeta, extent, totals, moments);
}
