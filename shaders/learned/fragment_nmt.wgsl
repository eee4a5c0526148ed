// The weight of a fragment: the network's transmittance.
fn peelnet_fragment(zeta: f32, absorbance: vec2f, moments: vec4f) -> f32 {
    let m = moments / max(absorbance.x, 1e-6);
    return peelnet_weight(zeta, absorbance.y, absorbance.x, m.x, m.y, m.z, m.w);
}
