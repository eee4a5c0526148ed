// What a fragment adds to its pixel's statistics: the sum of alpha, and the number of fragments.
fn peelnet_statistics(alpha: f32) -> vec2f {
    return vec2f(alpha, 1.0);
}

// The weight of a fragment: the network's transmittance. linear_depth: distance along the view axis in scene units.
fn peelnet_fragment(linear_depth: f32, statistics: vec2f) -> f32 {
    return peelnet_network(linear_depth, statistics);
}

// The colour and coverage of a pixel with 16-bit sums, which may become infinite. transmittance: the product of 1 - alpha.
fn peelnet_resolve(sums: vec4f, transmittance: f32, background: vec3f) -> vec4f {
    return peelnet_composite(min(sums, vec4f(65504.0)), 1.0 - transmittance, vec3f(transmittance), background);
}
