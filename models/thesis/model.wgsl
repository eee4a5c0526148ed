// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// WGSL, plain WebGPU. Compiled by naga, and run on a GPU against the network at every export.
// Network: 3-10-8-1 (Relu hidden, Identity last), 137 parameters, 118 multiply-adds. Recipe thesis, seed 1, 80 epochs.
// Answers: transmittance in front, kept in 0.000061035156 .. 1.0.
// Input 0: linear_depth (scene units), 0.0024710565 .. 104389.4 in training.
// Input 1: alpha_sum (1), 0.001 .. 148.23732 in training.
// Input 2: fragment_count (1), 1.0 .. 160.0 in training.
// Trained on 21531714 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset b7ad9cb0d2c09dc1638bcd9266d352a93f8e00bc73cd1e178a68bf55c7773289+ea59181067487e28a3ecbe45990ec58875bfc5212a817cbef25c5c9618a9c370).
// Loss: training 0.047925, test 0.047930.
// Held-out error, mean |T - T_exact|: boxes-held 0.23040, cups-held 0.18727, foliage-held 0.26137, panes-held 0.20116, sixteen-held 0.26588, smoke-held 0.15981.
//
// Self-tests, to some roundings of 32 bits; weights and colours also to those of 16-bit targets.
// peelnet_weight(83258.75, 11.463098, 5.8220344) = 0.4349108
// peelnet_weight(86725.37, 9.456088, 3.9939797) = 0.6371832
// peelnet_weight(10160.313, 2.612433, 13.811376) = 0.05943969
// Four fragments of a pixel, near 1.0, far 8.0, background 0.25, 0.5, 0.75:
//    z 1.0, alpha 0.5, rgb 1.0, 0.0, 0.0: zeta -1.0, weight 0.39276522
//    z 2.0, alpha 0.5, rgb 0.0, 1.0, 0.0: zeta -0.33333334, weight 0.39227504
//    z 4.0, alpha 0.5, rgb 0.0, 0.0, 1.0: zeta 0.33333334, weight 0.39129454
//    z 8.0, alpha 0.9, rgb 1.0, 1.0, 1.0: zeta 1.0, weight 0.38933375
//    colour of the pixel: 0.5784145, 0.58128166, 0.58389086
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
    let input_a = (clamp(vec4f(linear_depth, alpha_sum, fragment_count, 0.0), vec4f(-8567924.0, -290573.7, -492219.72, 0.0), vec4f(8568066.0, 290628.7, 492345.84, 0.0)) - vec4f(71.45296, 27.498259, 63.067303, 0.0)) * vec4f(0.0011671341, 0.034411423, 0.020313527, 0.0);
    let layer_a_a = max(vec4f(0.4973871, -0.18383166, -0.71877104, -0.12825711)
        + mat4x4f(vec4f(-0.78370047, 0.6205775, -0.003954968, -0.37307307), vec4f(-0.5196288, 0.061829817, -0.9281555, -0.51721966), vec4f(0.0041941553, -0.18512522, -0.0021559806, -0.04850462), vec4f(0.0, 0.0, 0.0, 0.0)) * input_a, vec4f(0.0));
    let layer_a_b = max(vec4f(0.39596623, -0.30338848, -0.12199432, -0.80655134)
        + mat4x4f(vec4f(0.19959602, 0.41043675, -0.09600277, -0.0002739593), vec4f(0.7463571, 0.1485918, -0.39474097, -0.9037138), vec4f(0.011577774, -0.10882486, -0.1395308, -0.021387914), vec4f(0.0, 0.0, 0.0, 0.0)) * input_a, vec4f(0.0));
    let layer_a_c = max(vec4f(-1.0460495, -0.84688985, 0.0, 0.0)
        + mat4x4f(vec4f(0.12967265, 0.0028717753, 0.0, 0.0), vec4f(0.32754216, -0.39824575, 0.0, 0.0), vec4f(-0.041158725, -0.40692556, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * input_a, vec4f(0.0));
    let layer_b_a = max(vec4f(-0.08231666, 0.39161515, -0.39847076, -0.2586611)
        + mat4x4f(vec4f(-0.054397807, 0.27504426, 0.03171749, 0.1925935), vec4f(0.56053203, 0.09120928, 0.1293203, -0.24980919), vec4f(-0.3677577, 0.62620455, -0.36173207, -0.27773124), vec4f(-0.30019107, 0.438429, 0.15569568, -0.2830279)) * layer_a_a
        + mat4x4f(vec4f(0.46410975, 0.3095634, 0.32290855, -0.26679063), vec4f(0.0044022393, -0.24063738, -0.23294453, 0.017381579), vec4f(0.09654181, 0.02100783, 0.20205164, -0.04296967), vec4f(-1.9870306, 1.7613828, 0.3189615, 0.25198883)) * layer_a_b
        + mat4x4f(vec4f(0.09651597, 0.26637653, -0.087246776, -0.26905248), vec4f(-0.1632681, 0.2668042, 0.17437035, -0.13056067), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * layer_a_c, vec4f(0.0));
    let layer_b_b = max(vec4f(0.398644, 0.28430215, -0.073437445, 0.12316476)
        + mat4x4f(vec4f(0.066359155, -0.07905399, -0.0941368, 0.5711753), vec4f(-0.2618054, -0.12227219, 0.06978265, 0.6191949), vec4f(-0.935394, -0.35125834, -0.059331723, 0.97910684), vec4f(0.039827105, -0.41136774, -0.20125546, 0.47933728)) * layer_a_a
        + mat4x4f(vec4f(-0.121855184, -0.24745506, -0.26192462, -0.039048668), vec4f(0.4997284, 0.35406867, -0.10526723, 0.10086258), vec4f(0.044730585, 0.19158448, 0.0835788, 0.0018736554), vec4f(-2.1149383, -0.91982514, -0.016961027, 2.2564716)) * layer_a_b
        + mat4x4f(vec4f(-0.019038832, 0.22892612, -0.22381483, 0.09413314), vec4f(-2.3891594, -0.42583513, -0.2030369, 1.2670388), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * layer_a_c, vec4f(0.0));
    let layer_c_a = 0.13036826
        + dot(vec4f(-0.3485119, 0.42931017, -0.34767643, 0.035356548), layer_b_a)
        + dot(vec4f(-1.2394289, -0.34298563, -0.136315, 0.42961746), layer_b_b);
    return clamp(layer_c_a, 0.000061035156, 1.0);
}
