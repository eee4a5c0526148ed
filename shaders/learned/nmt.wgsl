struct PeelnetStatistics {
    // Absorbance and 1: their sums are b_0 and the number of fragments.
    absorbance: vec2f,
    // b zeta .. b zeta^4.
    moments: vec4f,
}

// What a fragment adds to its pixel's statistics.
fn peelnet_statistics(alpha: f32, zeta: f32) -> PeelnetStatistics {
    let b = peelnet_absorbance(alpha);
    let square = zeta * zeta;
    return PeelnetStatistics(vec2f(b, 1.0), b * vec4f(zeta, square, square * zeta, square * square));
}

// The weight of a fragment: the network's transmittance.
fn peelnet_fragment(zeta: f32, absorbance: vec2f, moments: vec4f) -> f32 {
    return peelnet_network(zeta, absorbance, moments);
}
