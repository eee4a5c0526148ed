// Weight pass: draw all transparent surfaces again; each fragment reads its pixel's statistics and writes
// (alpha * rgb * w, alpha * w) with w = peelnet_fragment(..).x to an rgba16float target cleared to 0, blending ONE, ONE,
// ADD. Resolve over the background C_0 with T = exp(-moments.x), where T is not 1:
//     sums.rgb / sums.a * (1 - T) + C_0 * T

// The weight of a fragment, and its end (see PeelnetPlace). What the network says of the ends is not used: they are known.
// No branch around it: neighbouring fragments rarely all lie at an end, and then it only costs.
fn peelnet_fragment(alpha: f32, zeta: f32, moments: vec4f, extent: vec4f) -> vec2f {
    let place = peelnet_place(alpha, zeta, moments, extent);
    let f = peelnet_features(place, moments, extent);
    let share = peelnet_share(
        f.root_absorbance, f.depth_fraction, f.mean_fraction, f.share_low, f.share_high);
    let between = select(f.root_absorbance * f.root_absorbance * share, 0.0, place.end > 0.0);
    return vec2f(exp(-(place.in_front + between)), place.end);
}
