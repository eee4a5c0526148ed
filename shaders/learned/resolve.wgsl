// The colour and coverage of a pixel with 16-bit sums, which may become infinite. absorbance: the pixel's total.
fn peelnet_resolve(sums: vec4f, absorbance: f32, background: vec3f) -> vec4f {
    let transmittance = exp(-absorbance);
    return peelnet_composite(min(sums, vec4f(65504.0)), 1.0 - transmittance, vec3f(transmittance), background);
}
