// Weight pass: draw all transparent surfaces again into two rgba16float targets cleared to 0, blending ONE, ONE, ADD.
// Each fragment reads its pixel's statistics, calls w = peelnet_fragment(..), and writes (alpha * rgb * w.x, alpha * w.x)
// to the first target, `sums`, if w.y is 0 (it lies between the pixel's ends), else to the second, `ends`; zero to the
// other one. Resolve over the background C_0 with T = exp(-moments.x), where T is not 1:
//     k = (1 - T) / ends.a, at most 1 unless sums.a is 0
//     ends.rgb * k + sums.rgb / sums.a * max(1 - T - ends.a * k, 0) + C_0 * T

// The weight of a fragment, and its end (see PeelnetPlace). What the network says of the ends is not used: they are known.
// No branch around it: neighbouring fragments rarely all lie at an end, and then it only costs.
fn peelnet_fragment(alpha: f32, zeta: f32, moments: vec4f, extent: vec4f) -> vec2f {
    let place = peelnet_place(alpha, zeta, moments, extent);
    let f = peelnet_features(place, moments, extent);
    let x = 2.0 * f.depth_fraction - 1.0;
    let bounds = peelnet_interval_bounds(f.means, x);
    let shape = peelnet_shape(f.means, x);
    let share = peelnet_share(
        f.root_absorbance, f.depth_fraction, f.mean_fraction, f.share_low, f.share_high,
        bounds.x, bounds.y, shape.x, shape.y);
    let between = select(f.root_absorbance * f.root_absorbance * share, 0.0, place.end > 0.0);
    return vec2f(exp(-(place.in_front + between)), place.end);
}
