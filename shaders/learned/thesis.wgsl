// Statistics pass: draw all transparent surfaces, in any order, into one target
//     format rg16float (rg32float for more than 2048 layers), cleared to 0, blending ONE, ONE, ADD,
//     each fragment writing (alpha, 1): the pixel's sum of alpha and its number of fragments.
// Weight pass: draw them again; each fragment reads its pixel's statistics and calls
//     let f = peelnet_features(linear_depth, statistics);
//     let w = peelnet_weight(f.x, f.y, f.z);
// and writes (alpha * rgb * w, alpha * w) to an rgba16float target (cleared to 0, ONE, ONE, ADD) and alpha to an
// r16float target (cleared to 1, ZERO, ONE_MINUS_SRC): T. Resolve over the background C_0, where T is not 1:
//     sums.rgb / sums.a * (1 - T) + C_0 * T

// linear_depth: distance along the view axis in scene units. statistics: sum of alpha, number of fragments.
fn peelnet_features(linear_depth: f32, statistics: vec2f) -> vec3f {
    return vec3f(linear_depth, statistics.x, statistics.y);
}
