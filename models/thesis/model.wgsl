// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Network: 3-10-8-1 (Relu hidden, Identity last), 137 parameters, 118 multiply-adds. Recipe thesis, seed 1, 150 epochs.
// Answers: transmittance in front, kept in 0.000061035156 .. 1.0.
// Input 0: linear_depth (scene units), 3.2974603 .. 8.639711 in training.
// Input 1: alpha_sum (1), 0.31566986 .. 15.300003 in training.
// Input 2: fragment_count (1), 2.0 .. 18.0 in training.
// Trained on 1486634 rows of sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color (dataset c67399899c9e18435cd5e4030d65e52fcd26bd3f40cfdb81c0ce663fd9a948e7).
// Loss: training 0.039518, test 0.039575.
// Held-out error, mean |T - T_exact|: sixteen-held 0.15695.
// Self-test: peelnet_weight(3.2974603, 0.31566986, 2.0) = 1.0
// Self-test: peelnet_weight(5.968586, 7.8078365, 10.0) = 0.0074955523
// Self-test: peelnet_weight(8.639711, 15.300003, 18.0) = 0.0018507838
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. z is the distance along the view axis, in the unit of the scenes that the network was trained on.
// 1. Pass "statistics": draw all transparent surfaces, in any order.
//    statistics: rg16float, cleared to 0, blending ADD, from peelnet_statistics(alpha)
// 2. Pass "weights": draw all transparent surfaces, in any order. let w = peelnet_fragment(z, statistics);
//    sums: rgba16float, cleared to 0, blending ADD, from vec4f(alpha * rgb, alpha) * w
//    transmittance: r16float, cleared to 1, blending dst * (1 - src), from alpha
// 3. Resolve: peelnet_resolve(sums, transmittance, background) is the colour of the pixel, and its coverage in alpha.
// - alpha is opacity, rgb the linear colour that is not multiplied by it. Resolve before tone mapping and encoding.
// - Test depth against the opaque surfaces, do not write it: a depth prepass with transparent surfaces in it hides what lies behind.
// - z grows with distance, also where depth buffers are reversed.
// - With multisampling, gather and resolve the statistics per sample: averaged samples of them mean nothing.

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

// The colour and coverage of a pixel. sums: alpha * rgb * w and alpha * w of all fragments, finite. transmittance: of red, green
// and blue light; coverage: 1 less their mean. Where nothing is covered the background stays as it is.
fn peelnet_composite(sums: vec4f, coverage: f32, transmittance: vec3f, background: vec3f) -> vec4f {
    let average = select(vec3f(0.0), sums.rgb / max(sums.a, 1.17549435e-38), sums.a > 0.0 && coverage > 0.0);
    return vec4f(average * coverage + background * transmittance, coverage);
}

// The network's answer for what is known of a fragment.
fn peelnet_network(linear_depth: f32, statistics: vec2f) -> f32 {
    return peelnet_weight(
        linear_depth, statistics.x, statistics.y);
}

fn peelnet_weight(linear_depth: f32, alpha_sum: f32, fragment_count: f32) -> f32 {
    // The limits never bind on real data and keep everything finite.
    let input_a = (clamp(vec4f(linear_depth, alpha_sum, fragment_count, 0.0), vec4f(-9827.978, -24527.951, -33051.6, 0.0), vec4f(9839.63, 24535.576, 33064.977, 0.0)) - vec4f(5.8257895, 3.8117707, 6.687116, 0.0)) * vec4f(1.0169005, 0.40763476, 0.302496, 0.0);
    let layer_a_a = max(vec4f(0.36699107, 0.08934866, 0.00896923, -0.11790975)
        + mat4x4f(vec4f(-0.2812561, 0.64096993, 0.06787622, -0.68828315), vec4f(-0.3098096, 0.4272569, -0.3371418, -0.053377435), vec4f(0.09141302, 0.10455541, -0.20767322, -0.0920681), vec4f(0.0, 0.0, 0.0, 0.0)) * input_a, vec4f(0.0));
    let layer_a_b = max(vec4f(-0.039280873, -0.7146161, -0.0331927, -0.34618753)
        + mat4x4f(vec4f(0.44337016, 0.2976149, -0.027582714, -0.6649315), vec4f(-0.27960423, -0.4409853, -0.92668635, 0.07451342), vec4f(0.2867233, -0.23364359, 0.5077004, -0.26255772), vec4f(0.0, 0.0, 0.0, 0.0)) * input_a, vec4f(0.0));
    let layer_a_c = max(vec4f(-0.6614406, -0.3494121, 0.0, 0.0)
        + mat4x4f(vec4f(0.36193842, -0.7488481, 0.0, 0.0), vec4f(0.5197745, -0.010447316, 0.0, 0.0), vec4f(0.1393111, -0.4346878, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * input_a, vec4f(0.0));
    let layer_b_a = max(vec4f(-0.10622626, 0.6193619, -0.18782492, -0.12640396)
        + mat4x4f(vec4f(0.114012845, 0.100573614, 0.33218676, 0.32587504), vec4f(0.16265583, 0.4138547, 0.19847082, -1.0758089), vec4f(0.03371681, 0.22705649, -0.35465276, 0.26409212), vec4f(-0.07486669, 0.27673584, -0.10097588, -0.12957513)) * layer_a_a
        + mat4x4f(vec4f(0.14228338, 0.17368762, -0.05453906, -0.54372406), vec4f(0.20591262, 0.1585577, -0.10391535, 1.4567384), vec4f(0.5090055, -0.11129799, 0.24975888, 0.18883176), vec4f(-0.3091256, 0.23783901, -0.607346, 0.5801437)) * layer_a_b
        + mat4x4f(vec4f(-0.011063324, 0.193202, -0.23163852, 1.1547408), vec4f(0.4252104, -0.43409795, 0.13768198, -0.16968009), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * layer_a_c, vec4f(0.0));
    let layer_b_b = max(vec4f(0.55025023, 0.33959898, -0.073437445, 0.37119347)
        + mat4x4f(vec4f(-0.16147524, 0.10646641, -0.0941368, 0.15536848), vec4f(-0.08503808, 0.7807747, 0.06978265, -0.6305696), vec4f(0.16265361, -0.35345033, -0.059331723, 0.35344076), vec4f(-0.27043462, -0.14663135, -0.20125546, 0.29453507)) * layer_a_a
        + mat4x4f(vec4f(0.0034286727, -0.02229752, -0.26192462, -0.44584095), vec4f(0.02490851, -0.75053, -0.10526723, 1.0509604), vec4f(-0.38304287, -0.25729075, 0.0835788, 0.46614712), vec4f(-0.15137082, 0.15515333, -0.016961027, 0.2647595)) * layer_a_b
        + mat4x4f(vec4f(0.01130996, 0.2628703, -0.22381483, 0.16553323), vec4f(-0.12194285, 0.32740307, -0.2030369, 0.06303128), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * layer_a_c, vec4f(0.0));
    let layer_c_a = 0.3612041
        + dot(vec4f(-0.5152144, 0.45085847, -0.45944244, 0.57288843), layer_b_a)
        + dot(vec4f(-1.0696906, -0.26527217, -0.136315, 0.21176621), layer_b_b);
    return clamp(layer_c_a, 0.000061035156, 1.0);
}
