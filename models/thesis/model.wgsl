// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Network: 3-10-8-1 (Relu hidden, Identity last), 137 parameters, 118 multiply-adds. Recipe thesis, seed 1, 150 epochs.
// Answers: transmittance in front, kept in 0.000061035156 .. 1.0.
// Input 0: linear_depth in scene units, valid range 3.3629863 .. 8.697592 (what training saw).
// Input 1: alpha_sum in 1, valid range 0.29130277 .. 15.300003 (what training saw).
// Input 2: fragment_count in 1, valid range 2.0 .. 20.0 (what training saw).
// Trained on 1517158 rows of sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color (dataset 10f3224746d53e667f997d7c7927674d61723d14cb3f1374d399906b129d5078).
// Loss: training 0.042680, test 0.042516.
// Held-out error, mean |T - T_exact|: sixteen-held 0.14665.
// Self-test: peelnet_weight(3.3629863, 0.29130277, 2.0) = 0.98380315
// Self-test: peelnet_weight(6.0302887, 7.795653, 11.0) = 0.000061035156
// Self-test: peelnet_weight(8.697592, 15.300003, 20.0) = 0.000061035156
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
    let input_a = (clamp(vec4f(linear_depth, alpha_sum, fragment_count, 0.0), vec4f(-9943.6045, -23356.857, -32186.193, 0.0), vec4f(9955.231, 23364.354, 32198.97, 0.0)) - vec4f(5.8136473, 3.748504, 6.387818, 0.0)) * vec4f(1.0050839, 0.4280711, 0.31063056, 0.0);
    let layer_a_a = max(vec4f(0.3442368, 0.76329476, 0.6132797, -0.078043275)
        + mat4x4f(vec4f(-0.18181959, 0.47372678, 0.16791762, -0.07376755), vec4f(0.022905013, 0.112480715, -0.22468871, 0.63020086), vec4f(0.243702, 0.048745416, 0.003561412, -0.4948662), vec4f(0.0, 0.0, 0.0, 0.0)) * input_a, vec4f(0.0));
    let layer_a_b = max(vec4f(-0.5138696, 0.040032458, -0.36219233, 0.2672583)
        + mat4x4f(vec4f(-0.039044335, -0.49055704, 0.55461687, 0.47033188), vec4f(-0.735712, -0.21533465, 0.53235304, 0.13269444), vec4f(0.30972007, 0.31443647, 0.044717688, 0.036701526), vec4f(0.0, 0.0, 0.0, 0.0)) * input_a, vec4f(0.0));
    let layer_a_c = max(vec4f(-0.4444015, 0.28210238, 0.0, 0.0)
        + mat4x4f(vec4f(0.29715592, -0.40094212, 0.0, 0.0), vec4f(-0.9361036, 0.47060266, 0.0, 0.0), vec4f(0.18279779, -0.8715562, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * input_a, vec4f(0.0));
    let layer_b_a = max(vec4f(0.2976173, 0.13210505, -0.0061572115, -0.10242198)
        + mat4x4f(vec4f(0.08643325, 0.16000038, -0.15606257, 0.37049568), vec4f(0.41520482, -0.30805242, 0.5072062, -0.40749514), vec4f(-0.23100552, 0.40770972, -0.21945977, 0.4521951), vec4f(-0.4153671, 0.27096748, 0.1682209, 0.51941943)) * layer_a_a
        + mat4x4f(vec4f(0.6589614, -0.3320055, -0.24401791, -0.7371049), vec4f(-0.24964917, -0.08816351, 0.07382438, 0.10082812), vec4f(0.07535553, -0.07142643, -0.15700427, -0.24070731), vec4f(-0.40789515, -0.074669234, -0.3069622, -0.2783018)) * layer_a_b
        + mat4x4f(vec4f(-0.19463441, 0.4297127, 0.28904358, 0.7209721), vec4f(-0.018153155, 0.07102231, -0.29774708, -0.07974274), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * layer_a_c, vec4f(0.0));
    let layer_b_b = max(vec4f(-0.15951762, -0.2462195, 0.13422671, -0.30846193)
        + mat4x4f(vec4f(-0.2804497, 0.013882248, 0.13710356, -0.039359372), vec4f(-0.29305816, -0.43331385, -0.49647373, 0.7242439), vec4f(-0.094089, 0.37938005, -0.13339183, -0.2191287), vec4f(0.31545463, 0.1745345, -0.18258995, 0.081792615)) * layer_a_a
        + mat4x4f(vec4f(-0.2299657, 0.25416237, -0.14815147, -3.560528), vec4f(-0.12468521, 0.42887226, -0.13057628, 0.0076381904), vec4f(0.08413597, -0.032384377, 0.8992764, -0.16057025), vec4f(0.026566258, -0.20930964, -0.9100427, -0.46587583)) * layer_a_b
        + mat4x4f(vec4f(-0.04442938, 0.6149162, 1.0296427, -0.020320589), vec4f(-0.012686946, 0.4746485, 0.4430752, 0.25322354), vec4f(0.0, 0.0, 0.0, 0.0), vec4f(0.0, 0.0, 0.0, 0.0)) * layer_a_c, vec4f(0.0));
    let layer_c_a = 0.43207386
        + dot(vec4f(-0.66111547, 0.45794997, -0.8323004, 0.52919376), layer_b_a)
        + dot(vec4f(0.3193331, 0.59153414, -0.5768846, -1.3821356), layer_b_b);
    return clamp(layer_c_a, 0.000061035156, 1.0);
}
