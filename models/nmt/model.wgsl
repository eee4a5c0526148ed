// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Network: 7-32-16-1 (Relu hidden, Sigmoid last), 801 parameters, 752 multiply-adds. Recipe nmt, seed 1, 10 epochs.
// Answers: transmittance in front, kept in 0.000061035156 .. 1.0.
// Input 0: depth (exponentially, 0 .. 1 from the pixel's nearest to its farthest fragment), 0.0 .. 1.0 in training.
// Input 1: fragment_count (1), 1.0 .. 160.0 in training.
// Input 2: absorbance (1), 0.0010004875 .. 455.74112 in training.
// Input 3: moment_one (1), -80.85934 .. 150.97789 in training.
// Input 4: moment_two (1), 3.7754373e-11 .. 193.24498 in training.
// Input 5: moment_three (1), -57.520317 .. 95.6431 in training.
// Input 6: moment_four (1), 3.5329184e-20 .. 145.62552 in training.
// Trained on 21531714 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset b7ad9cb0d2c09dc1638bcd9266d352a93f8e00bc73cd1e178a68bf55c7773289+ea59181067487e28a3ecbe45990ec58875bfc5212a817cbef25c5c9618a9c370).
// Loss: training 0.013332, validation 0.013416, test 0.013574.
// Held-out error, mean |T - T_exact|: boxes-held 0.13977, cups-held 0.07611, foliage-held 0.09781, panes-held 0.05362, sixteen-held 0.09084, smoke-held 0.05804.
// Self-test: peelnet_weight(0.0, 1.0, 0.0010004875, -80.85934, 3.7754373e-11, -57.520317, 3.5329184e-20) = 0.97961056
// Self-test: peelnet_weight(0.5, 80.5, 227.87106, 35.059273, 96.62249, 19.061394, 72.81276) = 0.000061035156
// Self-test: peelnet_weight(1.0, 160.0, 455.74112, 150.97787, 193.24498, 95.643105, 145.62552) = 0.000061035156
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. A tight range matters more than anything else you choose. Compute zeta with this function in both passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.
// 1. Pass "statistics": draw all transparent surfaces, in any order. let s = peelnet_statistics(alpha, zeta);
//    totals: rgba32float, cleared to 0, blending ADD, from s.totals
//    moments: rgba32float, cleared to 0, blending ADD, from s.moments
//    extent: rg32float, cleared to -65504, blending MAX, from s.extent
// 2. Pass "weights": draw all transparent surfaces, in any order. let w = peelnet_fragment(zeta, totals, moments, extent);
//    sums: rgba32float, cleared to 0, blending ADD, from vec4f(alpha * rgb, alpha) * w
// 3. Resolve: peelnet_resolve(sums, totals.x, background) is the colour of the pixel, and its coverage in alpha.
// - alpha is opacity, rgb the linear colour that is not multiplied by it. Resolve before tone mapping and encoding.
// - Test depth against the opaque surfaces, do not write it: a depth prepass with transparent surfaces in it hides what lies behind.
// - z grows with distance, also where depth buffers are reversed.
// - With multisampling, gather and resolve the statistics per sample: averaged samples of them mean nothing.

// A range of depths: 1 / near, 0 where depths are on a linear scale; near; 2 / its extent on the scale, 0 for a flat range.
struct PeelnetRange {
    inverse_near: f32,
    near: f32,
    scale: f32,
}

// near, far: the nearest and the farthest z that transparent surfaces have in this frame. The same for all fragments: it may be
// computed once a frame and passed in.
fn peelnet_range(near: f32, far: f32) -> PeelnetRange {
    let linear = near <= 0.0;
    let inverse_near = select(1.0 / max(near, 1.17549435e-38), 0.0, linear);
    let extent = select(log(max(far * inverse_near, 1.0)), far - near, linear);
    // Closer than that, depths hardly differ.
    let flat = extent <= select(1e-6, 0.0, linear);
    return PeelnetRange(inverse_near, near, select(2.0 / max(extent, 1e-30), 0.0, flat));
}

// The depth z on the scale of a range, -1 at near and 1 at far.
fn peelnet_zeta_in(z: f32, range: PeelnetRange) -> f32 {
    // The logarithm of a ratio: the difference of two would depend on the scene's unit by their rounding.
    let logarithmic = log(max(z * range.inverse_near, 1.0));
    let from_near = select(logarithmic, z - range.near, range.inverse_near == 0.0);
    return clamp(from_near * range.scale - 1.0, -1.0, 1.0);
}

// Depth on a logarithmic scale, -1 at near and 1 at far. z: distance along the view axis. Where near is not above 0 the scale is
// linear: with an orthographic camera call peelnet_zeta(z - near, 0.0, far - near). A flat range has one value, -1.
fn peelnet_zeta(z: f32, near: f32, far: f32) -> f32 {
    return peelnet_zeta_in(z, peelnet_range(near, far));
}

// -log(1 - alpha), at most 16: opaque, but finite.
fn peelnet_absorbance(alpha: f32) -> f32 {
    return -log(max(1.0 - alpha, 1.1253517e-7));
}

struct PeelnetStatistics {
    // Absorbance and 1: their sums are b_0 and the number of fragments. The published layout has four channels.
    totals: vec4f,
    // b zeta .. b zeta^4.
    moments: vec4f,
    // -zeta and zeta: their maxima are the nearest, negated, and the farthest.
    extent: vec2f,
}

// What a fragment adds to its pixel's statistics.
fn peelnet_statistics(alpha: f32, zeta: f32) -> PeelnetStatistics {
    let b = min(peelnet_absorbance(alpha), 10.0);
    let square = zeta * zeta;
    return PeelnetStatistics(
        vec4f(b, 1.0, 0.0, 0.0),
        b * vec4f(zeta, square, square * zeta, square * square),
        vec2f(-zeta, zeta),
    );
}

// Exponential depth, 0 at the pixel's nearest and 1 at its farthest fragment; 0 in a pixel without an extent.
fn peelnet_depth(zeta: f32, extent: vec2f) -> f32 {
    let beyond = exp(0.5 * (vec2f(zeta, extent.y) + extent.x)) - 1.0;
    return clamp(beyond.x / max(beyond.y, 1.52587890625e-5), 0.0, 1.0);
}

// The weight of a fragment: the network's transmittance.
fn peelnet_fragment(zeta: f32, totals: vec4f, moments: vec4f, extent: vec2f) -> f32 {
    return peelnet_network(zeta, extent, totals, moments);
}

// The colour and coverage of a pixel with 16-bit sums, which may become infinite. absorbance: the pixel's total.
fn peelnet_resolve(sums: vec4f, absorbance: f32, background: vec3f) -> vec4f {
    let transmittance = exp(-absorbance);
    return peelnet_composite(min(sums, vec4f(65504.0)), 1.0 - transmittance, vec3f(transmittance), background);
}

// The colour and coverage of a pixel. sums: alpha * rgb * w and alpha * w of all fragments, finite. transmittance: of red, green
// and blue light; coverage: 1 less their mean. Where nothing is covered the background stays as it is.
fn peelnet_composite(sums: vec4f, coverage: f32, transmittance: vec3f, background: vec3f) -> vec4f {
    let average = select(vec3f(0.0), sums.rgb / max(sums.a, 1.17549435e-38), sums.a > 0.0 && coverage > 0.0);
    return vec4f(average * coverage + background * transmittance, coverage);
}

// The network's answer for what is known of a fragment.
fn peelnet_network(zeta: f32, extent: vec2f, totals: vec4f, moments: vec4f) -> f32 {
    return peelnet_weight(
        peelnet_depth(zeta, extent), totals.y, totals.x, moments.x, moments.y, moments.z, moments.w);
}

fn peelnet_weight(depth: f32, fragment_count: f32, absorbance: f32, moment_one: f32, moment_two: f32, moment_three: f32, moment_four: f32) -> f32 {
    // The limits never bind on real data and keep everything finite.
    let input_a = (clamp(vec4f(depth, fragment_count, absorbance, moment_one), vec4f(-3180.9434, -493630.25, -887504.1, -204468.97), vec4f(3181.8262, 493757.06, 887637.9, 204473.94)) - vec4f(0.44144282, 63.420273, 66.88538, 2.4847147)) * vec4f(3.1432853, 0.020255476, 0.011266705, 0.048906583);
    let input_b = (clamp(vec4f(moment_two, moment_three, moment_four, 0.0), vec4f(-291612.7, -121588.53, -186638.84, 0.0), vec4f(291654.44, 121591.47, 186662.88, 0.0)) - vec4f(20.862373, 1.4707205, 12.009837, 0.0)) * vec4f(0.034289606, 0.08224361, 0.053575967, 0.0);
    let layer_a_a = max(vec4f(-0.04807804, 0.06827727, -0.055480424, -0.63767046)
        + mat4x4f(vec4f(-0.3497349, -0.49371696, 0.2603365, -0.91317624), vec4f(-0.34951648, 0.20093645, 0.16775674, -0.06665354), vec4f(-0.10762099, 0.35890466, 0.49125493, 0.47366267), vec4f(0.24483225, -0.10137707, 0.11973832, 0.27850258)) * input_a
        + mat4x4f(vec4f(-0.072384745, 0.2795201, -0.1862629, 0.55563885), vec4f(-0.35731018, 0.34509358, -0.85027605, -0.3196803), vec4f(-0.1744642, 0.13735966, -0.48929814, -0.06927184), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_b = max(vec4f(-0.79596674, -0.40890488, 0.2250157, 0.36264262)
        + mat4x4f(vec4f(-0.20516086, -0.7073706, -0.09328094, 0.34674323), vec4f(-0.3536898, 0.018873414, 0.49079275, -0.108097844), vec4f(-0.44739348, -0.45401245, -0.2438024, -0.44705817), vec4f(0.05617406, -0.16239552, -0.331193, -0.083058335)) * input_a
        + mat4x4f(vec4f(-0.5348724, -0.55546457, 0.4027874, 0.14560227), vec4f(0.06865329, 0.038689584, 0.2942687, 0.18140204), vec4f(-0.41668588, -0.089780845, 0.77365094, -0.31381446), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_c = max(vec4f(-0.47068894, 0.50946516, 0.35030934, -0.33821002)
        + mat4x4f(vec4f(0.09567088, 0.43065858, 0.4995566, 0.84274024), vec4f(0.0732043, 0.24861406, -0.2955898, -0.48823923), vec4f(0.18253045, -0.34296754, -0.39781168, -0.8923007), vec4f(-0.16509102, -0.087933585, -0.1880337, -0.30167583)) * input_a
        + mat4x4f(vec4f(0.014167196, -0.47406283, -0.38133305, -0.19106701), vec4f(0.15460408, 0.43974155, 0.21402073, -0.22813715), vec4f(-0.31146044, -0.32232878, 0.003619165, -0.15843095), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_d = max(vec4f(0.61936295, 0.3336504, 0.73549795, -0.33002716)
        + mat4x4f(vec4f(0.07721699, 0.035523906, 0.30598202, -0.6648685), vec4f(0.06616041, -0.2602533, 0.20015171, 0.19194505), vec4f(0.591256, -0.0860967, -0.030841975, 0.19940744), vec4f(0.01596718, -0.12359417, 0.06520758, -0.28214782)) * input_a
        + mat4x4f(vec4f(-0.020572366, 0.3315522, -0.07777475, -0.16909277), vec4f(-0.49043787, 0.4933925, -0.16093288, -0.032940485), vec4f(0.21874808, 0.29400316, -0.30985954, 0.18316223), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_e = max(vec4f(-0.14401028, -0.09446248, -0.13747767, 0.5726252)
        + mat4x4f(vec4f(0.36694545, 0.51392436, -0.25018576, -0.33383068), vec4f(0.44178006, -0.12944682, 0.061397996, -0.38362217), vec4f(0.107886784, 1.0359826, -0.77619255, 0.45539007), vec4f(0.74778324, 0.38789228, 0.31726387, -0.124553554)) * input_a
        + mat4x4f(vec4f(-0.2164175, 0.05824361, -0.58737177, 0.32149476), vec4f(-0.3317513, -0.53768665, 0.08836378, -0.16939168), vec4f(-0.038976505, 0.25465417, -0.4462792, -0.20799993), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_f = max(vec4f(-0.528119, 0.68956506, 0.6665402, 0.47076568)
        + mat4x4f(vec4f(-0.036756944, 0.15952265, -0.183189, -0.06149526), vec4f(-0.17684567, -0.25246856, 0.10993326, -0.14864406), vec4f(-0.3407272, 0.831034, 0.17987032, 0.06538117), vec4f(0.5766475, -0.13052657, -0.7636582, 0.27121958)) * input_a
        + mat4x4f(vec4f(-0.6405617, -0.019723143, -0.13207652, 0.23050909), vec4f(-0.10048499, -0.20293243, -0.53354645, 0.044508904), vec4f(-0.18582973, -0.12500851, 0.18732628, 0.0534769), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_g = max(vec4f(0.6659307, 0.40749317, -0.59337413, 0.48420513)
        + mat4x4f(vec4f(-0.055916015, 0.4244265, -0.58030903, 0.42569348), vec4f(0.048116714, 0.51097167, 0.046341237, -0.104337096), vec4f(0.20721878, 0.5756649, 0.06764995, -0.20988877), vec4f(0.07994501, 0.48519245, -0.06848484, 0.2243143)) * input_a
        + mat4x4f(vec4f(-0.10725156, 0.22524227, 0.21867521, -0.34034958), vec4f(-0.06710737, -0.11969305, 0.07149385, -0.1381382), vec4f(0.43246722, -0.19142999, -0.12709934, 0.11218613), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_h = max(vec4f(-0.11093844, -0.85344535, 0.8341744, 0.93396646)
        + mat4x4f(vec4f(0.5035023, -0.7468352, 0.23506866, 0.22383644), vec4f(0.301351, -0.1334081, -0.07495802, -0.20781511), vec4f(0.5149827, 0.11615574, 0.12605436, 0.2610113), vec4f(0.4414424, -0.037663363, 0.21420544, 0.16504392)) * input_a
        + mat4x4f(vec4f(-0.0858687, -0.043007605, 0.45992026, 0.47530285), vec4f(-0.32432336, -0.37726223, -0.352172, 0.29517803), vec4f(0.09063989, 0.3408103, -0.22698511, 0.117440194), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_b_a = max(vec4f(0.28228456, 0.13095056, -0.14883338, 0.09998144)
        + mat4x4f(vec4f(0.10370276, 0.02854514, 0.03641079, 0.017567504), vec4f(-0.6442179, -0.25256485, 0.63831556, -0.35295483), vec4f(0.6644848, 0.23314592, -0.061525986, 0.19271246), vec4f(-1.3217088, -0.6389635, 0.54685277, -0.7432478)) * layer_a_a
        + mat4x4f(vec4f(-0.41927633, -0.11851143, 0.48008165, -0.33597833), vec4f(-0.21208517, -0.2998985, 0.3909879, -0.21022862), vec4f(0.24593908, 0.34650034, -0.048832223, 0.23409665), vec4f(-0.133052, 0.14752147, 0.1660831, 0.1660066)) * layer_a_b
        + mat4x4f(vec4f(0.15625516, 0.18690449, -0.037305664, -0.06242057), vec4f(-0.07558191, 0.028776934, 0.024739379, -0.011110034), vec4f(0.090618834, 0.15615311, 0.11908543, 0.19689648), vec4f(-0.8186687, -0.2849472, 0.16400002, -0.27285838)) * layer_a_c
        + mat4x4f(vec4f(0.82036054, 0.62729204, -0.55129373, 0.5874358), vec4f(0.15192252, -0.10192294, 0.0708911, -0.06391294), vec4f(0.10961215, 0.06730534, 0.096223384, 0.14207776), vec4f(-0.6208742, -0.46522993, 0.48291543, -0.1588667)) * layer_a_d
        + mat4x4f(vec4f(0.33307046, 0.00912409, -0.23954818, 0.22831397), vec4f(1.1318815, 0.16505167, -0.35022387, 0.31347233), vec4f(-0.28304923, -0.10579594, 0.37022915, -0.1505413), vec4f(0.26077145, 0.07385607, -0.110248104, 0.17230043)) * layer_a_e
        + mat4x4f(vec4f(-0.48308885, -0.24376866, 0.6882273, -0.22093354), vec4f(0.48359534, 0.24645206, -0.21813528, 0.2404319), vec4f(0.312935, 0.23664296, -0.084847696, 0.3216464), vec4f(0.0969097, 0.27803552, 0.15976852, -0.017722474)) * layer_a_f
        + mat4x4f(vec4f(0.32174096, 0.15043268, 0.024656558, 0.3377208), vec4f(0.77103645, 0.23265205, -0.2790166, 0.25391105), vec4f(-0.9621078, -0.54027134, 0.600486, -0.66207486), vec4f(0.15673009, -0.0013725318, 0.1879272, 0.12160882)) * layer_a_g
        + mat4x4f(vec4f(0.56952935, 0.20226172, -0.19331004, 0.35458058), vec4f(-0.764006, -0.24360071, 0.42729563, -0.42094168), vec4f(0.6143829, 0.23463123, 0.012759718, 0.14250498), vec4f(0.6318287, 0.25394264, -0.12305001, 0.3116784)) * layer_a_h, vec4f(0.0));
    let layer_b_b = max(vec4f(-0.051103912, 0.00040562305, 0.4231153, -0.10413823)
        + mat4x4f(vec4f(0.12422655, -0.18377751, 0.10550616, 0.36415938), vec4f(0.25880715, 0.12709314, -0.57439476, 0.5780184), vec4f(-0.17809385, 0.57194334, 0.39410397, -0.37956357), vec4f(-0.040289786, 0.13209504, -1.1152533, 1.0528296)) * layer_a_a
        + mat4x4f(vec4f(0.02996932, -0.07617283, -0.35955164, 0.3714256), vec4f(-0.009526943, 0.38477066, -0.3873307, 0.42170754), vec4f(-0.13989232, 0.1362565, 0.1340911, -0.09071024), vec4f(-0.01214652, -0.12413633, -0.14786287, 0.08777342)) * layer_a_b
        + mat4x4f(vec4f(-0.095793486, -0.11289483, -0.0653169, -0.121312164), vec4f(-0.12119581, 0.049400393, -0.22321995, 0.17247547), vec4f(0.14876568, 0.1541366, -0.11860504, 0.22161418), vec4f(-0.037570395, -0.14893982, -0.55831444, 0.51633096)) * layer_a_c
        + mat4x4f(vec4f(-0.005433281, -0.10759716, 0.97847223, -0.9905621), vec4f(0.111723684, 0.098961055, 0.12269521, -0.037261385), vec4f(-0.034256417, -0.028158374, 0.17320323, -0.08557561), vec4f(-0.098170534, -0.13303407, -0.5603012, 0.78573495)) * layer_a_d
        + mat4x4f(vec4f(0.027206887, -0.021829823, 0.42413938, -0.6316141), vec4f(0.085016966, -0.047701918, 1.0870467, -1.2618467), vec4f(-0.16300303, 0.13874476, -0.038674798, 0.6230233), vec4f(-0.08526056, -0.1562488, 0.12164406, -0.19409198)) * layer_a_e
        + mat4x4f(vec4f(0.1732456, 0.11329357, -0.47977015, 0.6905897), vec4f(-0.060645238, -0.19495857, 0.42570817, -0.33596012), vec4f(-0.09769417, -0.037983913, 0.26784366, -0.25969335), vec4f(0.15466812, 0.09272621, 0.11150623, 0.02389588)) * layer_a_f
        + mat4x4f(vec4f(-0.11698809, -0.016657809, 0.5442633, -0.1078125), vec4f(0.1780145, 0.054271307, 0.66198313, -1.3924626), vec4f(-0.025193766, 0.11287692, -0.9510928, 0.9069998), vec4f(-0.14504574, -0.013180094, 0.1821812, -0.05011391)) * layer_a_g
        + mat4x4f(vec4f(0.17479157, -0.06851321, 0.5431071, -0.5430359), vec4f(-0.015602438, 0.29052985, -0.4768155, 0.6875319), vec4f(-0.08345866, -0.20522591, 0.5248937, -0.15710288), vec4f(-0.09025225, -0.026718482, 0.38263583, -0.3414853)) * layer_a_h, vec4f(0.0));
    let layer_b_c = max(vec4f(-0.09207605, 0.3194374, 0.030509224, 0.36047596)
        + mat4x4f(vec4f(0.08789093, -0.116369955, 0.2984496, -0.010648789), vec4f(1.3155439, -0.16724738, 0.35165942, -0.30162802), vec4f(1.13393, -0.01210349, -0.13555473, 0.18970172), vec4f(1.5498424, -0.20735376, 0.3192687, -0.58707774)) * layer_a_a
        + mat4x4f(vec4f(0.37483305, -0.2830195, 0.33060157, -0.4094316), vec4f(0.4785458, -0.11755617, 0.16436103, -0.005856693), vec4f(0.062359415, 0.18982607, 0.091409765, 0.11517121), vec4f(-0.97214216, 0.1803772, 0.08952923, -0.019070072)) * layer_a_b
        + mat4x4f(vec4f(0.008878647, -0.049568173, 0.08576626, -0.12551387), vec4f(-1.2477837, -0.19821654, -0.013371257, -0.053066082), vec4f(-0.33534858, 0.08855059, 0.15172425, 0.033239987), vec4f(0.044536915, -0.070297986, 0.14997087, -0.39953256)) * layer_a_c
        + mat4x4f(vec4f(0.11317274, 0.66500247, -0.457967, 0.7154932), vec4f(0.1427681, 0.05517727, 0.04125858, 0.11986354), vec4f(-0.6939758, 0.2527629, -0.17606765, 0.25033566), vec4f(0.8093423, -0.30429304, 0.5101216, -0.36025757)) * layer_a_d
        + mat4x4f(vec4f(0.7359682, 0.091297805, -0.0839017, -0.05227592), vec4f(0.9823829, 0.2860234, -0.19635369, 0.35808158), vec4f(-0.03717214, -0.23004635, 0.38859892, -0.2669871), vec4f(0.1678502, 0.179122, -0.071149684, 0.31086522)) * layer_a_e
        + mat4x4f(vec4f(0.72530353, -0.2792498, 0.6647462, -0.5482924), vec4f(0.08772326, 0.28252828, -0.17475383, 0.3553731), vec4f(0.06863499, 0.19964756, -0.2256594, 0.19921619), vec4f(-0.029758567, 0.18317245, 0.12479064, -0.0921241)) * layer_a_f
        + mat4x4f(vec4f(-0.03988511, 0.10239599, 0.0010252858, 0.34092674), vec4f(0.8483366, 0.25306186, -0.18978193, 0.3886288), vec4f(1.3239787, -0.5353289, 0.5633013, -0.48340532), vec4f(-1.1791193, 0.084707566, 0.159784, 0.056179993)) * layer_a_g
        + mat4x4f(vec4f(0.95682585, 0.23557886, -0.25766534, 0.0537925), vec4f(0.8820469, -0.2670861, 0.2086115, -0.44577792), vec4f(-0.1829384, 0.19746251, 0.03784424, 0.075931735), vec4f(-0.09428918, 0.07378495, -0.04625721, 0.20848061)) * layer_a_h, vec4f(0.0));
    let layer_b_d = max(vec4f(0.30228233, -0.3460795, 0.20553431, -0.180953)
        + mat4x4f(vec4f(0.14329731, 0.379446, -0.08319836, 0.40180865), vec4f(-0.29868704, 0.24198791, -0.3719685, 0.33527514), vec4f(0.35534856, 0.627319, 0.2554056, 2.381345), vec4f(-0.46606964, 1.5517105, -0.981655, 1.6104913)) * layer_a_a
        + mat4x4f(vec4f(-0.3565309, 0.48776242, -0.38369173, 0.45870462), vec4f(-0.24462965, 0.27375653, -0.1736196, 0.60022664), vec4f(0.15650834, -0.8426804, 0.12819976, -0.96222526), vec4f(-0.025864834, -0.9134632, 0.100773595, -1.4233236)) * layer_a_b
        + mat4x4f(vec4f(0.07402514, -0.06311267, 0.0776072, 0.3034923), vec4f(-0.22890982, -1.484944, -0.059968047, -2.0234177), vec4f(0.12341162, -0.30603278, -0.108395524, -0.62083876), vec4f(-0.39041966, 0.093740694, -0.59735864, -0.51839197)) * layer_a_c
        + mat4x4f(vec4f(0.77275264, -0.07970609, 0.8272011, -0.015538824), vec4f(-0.030993544, -0.28304547, 0.029678121, -0.36839032), vec4f(0.19270962, -0.55942345, 0.24899855, -0.8581428), vec4f(-0.5619731, 0.94208604, -0.48931745, 0.71343577)) * layer_a_d
        + mat4x4f(vec4f(0.23513213, 0.41064215, 0.21566962, -0.087188564), vec4f(0.4215446, 0.83715916, 0.636083, 2.2110994), vec4f(-0.059732698, 0.25665814, -0.24014467, 0.2606992), vec4f(0.18208773, 0.3618445, 0.26223233, 0.61304927)) * layer_a_e
        + mat4x4f(vec4f(-0.42305234, 0.3558261, -0.2626196, 0.36156872), vec4f(0.30286956, -0.08330171, 0.60519266, -0.07489425), vec4f(0.115849145, 0.24342196, 0.3590627, 0.1450464), vec4f(0.12482316, 0.076865114, 0.10971448, -0.03649224)) * layer_a_f
        + mat4x4f(vec4f(0.34992197, -0.08151338, 0.3823126, -0.052073807), vec4f(0.18130748, 0.5970075, 0.4195512, 0.64930207), vec4f(-0.48176432, 0.93099356, -0.59094334, 1.0649458), vec4f(-0.11584047, -1.4255781, -0.019958992, -1.5749073)) * layer_a_g
        + mat4x4f(vec4f(0.28864464, 1.2956977, 0.25667167, 0.9259653), vec4f(-0.46962002, 0.7141611, -0.40531123, 0.89448106), vec4f(0.34962624, -0.35336465, 0.32086906, -0.4750575), vec4f(0.26149985, -0.6265434, 0.48867908, -0.6722255)) * layer_a_h, vec4f(0.0));
    let layer_c_a = 1.0 / (1.0 + exp(min(-(-0.25112376
        + dot(vec4f(-1.3562567, -0.51506555, 0.69786185, -0.6203041), layer_b_a)
        + dot(vec4f(0.25103346, 0.15712531, -1.4435575, 0.7044778), layer_b_b)
        + dot(vec4f(0.69796413, -0.42565805, 0.30189767, -0.6627302), layer_b_c)
        + dot(vec4f(-0.52825016, 0.9570288, -1.3431787, 0.884605), layer_b_d)), 80.0)));
    return clamp(layer_c_a, 0.000061035156, 1.0);
}
