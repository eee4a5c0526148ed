struct PeelnetStatistics {
    // Premultiplied colour and alpha.
    tail: vec4f,
    // Absorbance and 1.
    sums: vec2f,
}

// What a fragment behind its pixel's two nearest adds to the statistics. color: premultiplied, with alpha.
fn peelnet_statistics(color: vec4f) -> PeelnetStatistics {
    return PeelnetStatistics(color, vec2f(peelnet_absorbance(color.a), 1.0));
}

// The tail's mean colour, weighted by opacity.
fn peelnet_average(tail: vec4f) -> vec3f {
    return tail.rgb / max(tail.a, 1e-6);
}

// The colour and coverage of a pixel. front: premultiplied colour and transmittance of the two nearest fragments. tail, sums: the
// statistics of the others.
fn peelnet_resolve(front: vec4f, tail: vec4f, sums: vec2f, background: vec3f) -> vec4f {
    // A tail of one fragment is its colour, and none is no colour.
    let color = select(peelnet_network(front, tail, sums), peelnet_average(tail), sums.y < 1.5);
    let transmittance = exp(-sums.x);
    let behind = select(mix(color, background, transmittance), background, sums.y == 0.0);
    return vec4f(front.rgb + front.a * behind, 1.0 - front.a * transmittance);
}
