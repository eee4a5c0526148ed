// Weight pass: draw all transparent surfaces again; each fragment reads its pixel's statistics and writes
// (alpha * rgb * w, alpha * w) with w = peelnet_fragment(..).x to an rgba16float target cleared to 0, blending ONE, ONE,
// ADD. Resolve over the background C_0 with T = exp(-moments.x), where T is not 1:
//     sums.rgb / sums.a * (1 - T) + C_0 * T

// The weight of a fragment, and its end (see PeelnetPlace). The ends are known and do without the network.
fn peelnet_fragment(alpha: f32, zeta: f32, moments: vec4f, extent: vec4f) -> vec2f {
    let place = peelnet_place(alpha, zeta, moments, extent);
    if place.end > 0.0 {
        return vec2f(place.known, place.end);
    }
    let f = peelnet_features(place, moments, extent);
    let rest = peelnet_weight(
        f.log_absorbance, f.depth_fraction, f.mean_fraction, f.depth_deviation, f.skewness,
        f.share_low, f.share_high);
    return vec2f(place.known * rest, 0.0);
}
