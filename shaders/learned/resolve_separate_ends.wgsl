// The colour and coverage of a pixel. sums, ends: alpha * rgb * w and alpha * w of the fragments between the pixel's ends and at
// them, finite. transmittance: of red, green and blue light; coverage: 1 less their mean. Where nothing is covered the background
// stays as it is.
fn peelnet_composite(sums: vec4f, ends: vec4f, coverage: f32, transmittance: vec3f, background: vec3f) -> vec4f {
    // The ends never take more than the coverage, and what lies between no more than it can fill, 16 times its sum. Both then fill
    // what is missing.
    let own = min(ends.a, coverage);
    let left = min(coverage - own, 16.0 * sums.a);
    let fill = coverage / max(own + left, 1.17549435e-38);
    let shares = fill * vec2f(own / max(ends.a, 1.17549435e-38), left / max(sums.a, 1.17549435e-38));
    return vec4f(ends.rgb * shares.x + sums.rgb * shares.y + background * transmittance, coverage);
}

// The same with 16-bit sums, which may become infinite. absorbance: the pixel's total, moments.x.
fn peelnet_resolve(sums: vec4f, ends: vec4f, absorbance: f32, background: vec3f) -> vec4f {
    let transmittance = exp(-absorbance);
    let most = vec4f(65504.0);
    return peelnet_composite(min(sums, most), min(ends, most), 1.0 - transmittance, vec3f(transmittance), background);
}
