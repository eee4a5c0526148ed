// Weight pass: draw all transparent surfaces again into two rgba16float targets cleared to 0, blending ONE, ONE, ADD.
// Each fragment reads its pixel's statistics, calls w = peelnet_fragment(..), and writes (alpha * rgb * w.x, alpha * w.x)
// to the first target, `sums`, if w.y is 0 (it lies between the pixel's ends), else to the second, `ends`; zero to the
// other one. Resolve over the background C_0 with T = exp(-moments.x), where T is not 1:
//     k = (1 - T) / ends.a, at most 1 unless sums.a is 0
//     ends.rgb * k + sums.rgb / sums.a * max(1 - T - ends.a * k, 0) + C_0 * T

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
