// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Network: 7-32-16-1 (Relu hidden, Sigmoid last), 801 parameters, 752 multiply-adds. Recipe nmt, seed 1, 24 epochs.
// Answers: transmittance in front, kept in 0.000061035156 .. 1.0.
// Input 0: depth (warped, -1 .. 1 over the frame's transparent depth range), -1.0 .. 1.0 in training.
// Input 1: fragment_count (1), 1.0 .. 160.0 in training.
// Input 2: absorbance (1), 0.0010004875 .. 470.25098 in training.
// Input 3: moment_one (1), -1.0 .. 1.0 in training.
// Input 4: moment_two (1), 1.7592255e-10 .. 1.0 in training.
// Input 5: moment_three (1), -1.0 .. 1.0 in training.
// Input 6: moment_four (1), 3.0948746e-20 .. 1.0 in training.
// Trained on 21531714 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset b7ad9cb0d2c09dc1638bcd9266d352a93f8e00bc73cd1e178a68bf55c7773289+ea59181067487e28a3ecbe45990ec58875bfc5212a817cbef25c5c9618a9c370).
// Loss: training 0.007334, validation 0.007230, test 0.007183.
// Held-out error, mean |T - T_exact|: boxes-held 0.06719, cups-held 0.05741, foliage-held 0.06296, panes-held 0.03324, sixteen-held 0.04243, smoke-held 0.04802.
// Self-test: peelnet_weight(-1.0, 1.0, 0.0010004875, -1.0, 1.7592255e-10, -1.0, 3.0948746e-20) = 1.0
// Self-test: peelnet_weight(0.0, 80.5, 235.12599, 0.0, 0.5, 0.0, 0.5) = 0.000061035156
// Self-test: peelnet_weight(1.0, 160.0, 470.25098, 1.0, 1.0, 1.0, 1.0) = 0.000061035156
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. A tight range matters more than anything else you choose. Compute zeta with this function in both passes. Its range is the same for the whole frame: peelnet_zeta_in(z, peelnet_range(near, far)) is the same value, and the range may be passed in.
// 1. Pass "statistics": draw all transparent surfaces, in any order. let s = peelnet_statistics(alpha, zeta);
//    absorbance: rg32float, cleared to 0, blending ADD, from s.absorbance
//    moments: rgba32float, cleared to 0, blending ADD, from s.moments
// 2. Pass "weights": draw all transparent surfaces, in any order. let w = peelnet_fragment(zeta, absorbance, moments);
//    sums: rgba16float, cleared to 0, blending ADD, from vec4f(alpha * rgb, alpha) * w
// 3. Resolve: peelnet_resolve(sums, absorbance.x, background) is the colour of the pixel, and its coverage in alpha.
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
    // Absorbance and 1: their sums are b_0 and the number of fragments.
    absorbance: vec2f,
    // b zeta .. b zeta^4.
    moments: vec4f,
}

// What a fragment adds to its pixel's statistics.
fn peelnet_statistics(alpha: f32, zeta: f32) -> PeelnetStatistics {
    let b = peelnet_absorbance(alpha);
    let square = zeta * zeta;
    return PeelnetStatistics(vec2f(b, 1.0), b * vec4f(zeta, square, square * zeta, square * square));
}

// The weight of a fragment: the network's transmittance.
fn peelnet_fragment(zeta: f32, absorbance: vec2f, moments: vec4f) -> f32 {
    return peelnet_network(zeta, absorbance, moments);
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
fn peelnet_network(zeta: f32, absorbance: vec2f, moments: vec4f) -> f32 {
    let means = moments / max(absorbance.x, 1e-6);
    return peelnet_weight(
        zeta, absorbance.y, absorbance.x, means.x, means.y, means.z, means.w);
}

fn peelnet_weight(depth: f32, fragment_count: f32, absorbance: f32, moment_one: f32, moment_two: f32, moment_three: f32, moment_four: f32) -> f32 {
    // The limits never bind on real data and keep everything finite.
    let input_a = (clamp(vec4f(depth, fragment_count, absorbance, moment_one), vec4f(-5579.0728, -493388.62, -878283.06, -2444.8394), vec4f(5579.0923, 493514.88, 878415.3, 2444.8506)) - vec4f(0.009689871, 63.133278, 66.110115, 0.0057341196)) * vec4f(1.7924094, 0.020265406, 0.011384994, 4.090239);
    let input_b = (clamp(vec4f(moment_two, moment_three, moment_four, 0.0), vec4f(-1365.1066, -1509.5377, -1230.2281, 0.0), vec4f(1365.7289, 1509.5494, 1230.5883, 0.0)) - vec4f(0.3111101, 0.005896911, 0.18008584, 0.0)) * vec4f(7.3237658, 6.624519, 8.127384, 0.0);
    let layer_a_a = max(vec4f(-0.3037866, -1.408853, -1.2787248, -1.0175995)
        + mat4x4f(vec4f(-0.10050407, 0.115528286, 0.5663227, -0.4358702), vec4f(0.41980734, -0.16031872, -0.2214389, -0.70788056), vec4f(-2.11962, -1.8033577, -1.4953544, -0.76664644), vec4f(0.22870348, -0.12010488, -0.11073604, 0.5030681)) * input_a
        + mat4x4f(vec4f(-0.03640837, -0.100981146, -0.018260157, 0.18621944), vec4f(-0.122175984, 0.08783444, -0.38840613, -0.2708578), vec4f(-0.12391121, 0.18598942, -0.08841045, -0.28355178), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_b = max(vec4f(-1.3649553, -0.8980769, -0.5892341, 0.32125863)
        + mat4x4f(vec4f(-0.074318476, -1.021609, 0.36711407, 1.0887713), vec4f(-1.3571732, -0.3674531, 0.21361889, -0.09410717), vec4f(0.24522835, -0.58375555, 2.0029764, 0.32368153), vec4f(-0.0350619, -0.36670458, 0.2843486, -0.5569303)) * input_a
        + mat4x4f(vec4f(-0.20942725, -0.491732, 0.43117368, 0.30784798), vec4f(0.02341517, 0.2714892, 0.36636487, 0.5578404), vec4f(0.056840613, 0.12914157, -0.2573967, -0.4622501), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_c = max(vec4f(-1.5138983, 0.044072937, 0.50669473, -0.92391837)
        + mat4x4f(vec4f(-1.0306034, 1.3749757, 0.6937147, 0.8043127), vec4f(-0.04695073, 0.7542876, 0.09696046, -0.21494152), vec4f(0.03127011, 0.9536069, -1.5301739, -1.7837718), vec4f(-0.28173992, 0.16865198, -0.57034945, -0.026687464)) * input_a
        + mat4x4f(vec4f(0.37073562, -0.26845223, -0.3200851, 0.31527838), vec4f(0.14493342, -0.14060594, 0.0022169692, -0.098117925), vec4f(-0.34087637, 0.107178695, 0.17097825, -0.117430374), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_d = max(vec4f(1.1680957, -1.1465068, 1.1893629, -0.3790845)
        + mat4x4f(vec4f(0.023191193, -0.13529277, 0.6473751, -0.82842606), vec4f(0.42180523, -0.7316431, 0.3981056, 0.06806125), vec4f(0.90099496, -0.5558637, 0.95627606, 0.74769914), vec4f(0.1227227, -0.22434768, -0.27022022, -0.56283486)) * input_a
        + mat4x4f(vec4f(-0.23395284, 0.105075486, 0.12084328, 0.11505259), vec4f(-0.4124714, 0.67424166, -0.18668355, 1.1212461), vec4f(0.03701145, -0.03098851, -0.27609137, -0.7298853), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_e = max(vec4f(-0.39184254, 0.7355829, -0.81774586, 1.321724)
        + mat4x4f(vec4f(1.2865338, 1.000269, 0.3376901, -0.0053975494), vec4f(0.624332, -0.2146249, -0.04633022, 0.22799946), vec4f(0.55311126, 1.1905848, 0.18734035, 1.2667346), vec4f(0.1330038, -0.4293764, 0.48961246, 0.048793167)) * input_a
        + mat4x4f(vec4f(-0.7132906, -0.05052522, -1.1159682, 0.16999754), vec4f(0.19009073, 0.005994367, 0.83847994, 0.0031088134), vec4f(0.30439028, 0.16818371, 0.047073264, -0.14896017), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_f = max(vec4f(1.1894326, 1.3396096, -1.377248, -0.56882143)
        + mat4x4f(vec4f(0.018570108, 0.46125028, -1.099135, -0.1651484), vec4f(-0.06946364, -0.11943346, 0.6228915, 0.005605614), vec4f(1.4912355, 1.3394547, 0.42432255, -1.8893882), vec4f(0.086048, -0.24910764, 0.10993928, 0.1998754)) * input_a
        + mat4x4f(vec4f(-0.15252016, -0.1358432, 0.07108177, -0.014033737), vec4f(-0.052433122, -0.00023640899, -0.24479985, -0.015722495), vec4f(0.103938244, 0.06890369, 0.21199065, 0.014021784), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_g = max(vec4f(1.4443306, 0.08153948, -1.1386081, 0.44433054)
        + mat4x4f(vec4f(0.05025595, 1.7058774, -0.15156744, 0.47073936), vec4f(0.7634989, 0.36953124, -0.7561123, -0.40536162), vec4f(0.32896885, 0.31952465, -0.22618157, 1.7100465), vec4f(-0.015214887, -0.72920394, -0.31877664, 0.98158693)) * input_a
        + mat4x4f(vec4f(-0.2818626, -0.13738966, 0.3954978, -0.15315847), vec4f(-0.046679717, 0.40413073, 0.32825398, -0.6558076), vec4f(0.33625528, -0.21616276, -0.35294956, 0.3017168), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_h = max(vec4f(-1.0274618, -1.6490014, 1.2809861, 1.1806016)
        + mat4x4f(vec4f(0.04584164, -0.7233053, 0.6923254, 0.5541247), vec4f(0.24440584, -0.5811853, 0.16963182, -0.15092602), vec4f(-0.0047008554, -0.34301192, 0.42745516, 1.0478094), vec4f(0.4295962, -0.13429493, 0.091630064, -0.15211788)) * input_a
        + mat4x4f(vec4f(-0.21130513, -0.070020944, 0.31345943, 0.22623403), vec4f(-0.2792387, -0.08540267, -0.17533383, 0.09567718), vec4f(0.55703855, 0.18319461, -0.14638036, -0.012042129), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_b_a = max(vec4f(0.5771321, 0.40301767, -0.6041264, 0.51426435)
        + mat4x4f(vec4f(-0.9263341, -0.8404348, 0.39554387, -0.36339986), vec4f(-0.06972255, -0.9522711, 0.17881297, -0.20819205), vec4f(0.16093522, -0.11655872, 0.7576578, 0.21024805), vec4f(-0.48801255, -0.148313, 0.7920823, -0.0935488)) * layer_a_a
        + mat4x4f(vec4f(0.5189622, -0.16621453, 1.4354701, 0.13832235), vec4f(-0.7001249, -0.4511647, -0.9165317, -0.73827434), vec4f(0.014599726, -0.013844059, 0.35406575, 0.16324812), vec4f(0.36888885, 0.33892798, 0.15611261, 0.4930204)) * layer_a_b
        + mat4x4f(vec4f(-1.403851, -0.8786158, 1.1635195, -1.5877166), vec4f(1.0226622, 0.6277638, -0.83359855, 0.5464919), vec4f(0.2247352, 0.22201778, 0.084606364, 0.32315016), vec4f(-0.04516867, -0.44675976, -0.23549506, 0.1301992)) * layer_a_c
        + mat4x4f(vec4f(-0.4634802, 0.18184237, -0.476334, -0.08706758), vec4f(0.6351167, 0.34353402, 0.5426859, 0.11939129), vec4f(-0.33573073, -0.5628649, 0.3596362, -0.30225685), vec4f(-0.598956, -0.7143985, -0.33107477, -0.7266416)) * layer_a_d
        + mat4x4f(vec4f(0.44029343, -0.30317482, -0.13161343, 0.19430971), vec4f(0.4062741, 0.05968486, -0.7003029, 0.095056474), vec4f(-0.10447847, -0.14751509, -0.24669427, -0.5030265), vec4f(-0.21977344, -0.32561758, -0.48665512, 0.38250762)) * layer_a_e
        + mat4x4f(vec4f(-0.10846043, 0.21890596, -0.10914914, 0.05085918), vec4f(1.019035, 1.1900474, -0.7602212, 0.75843394), vec4f(-0.23692024, -0.4400801, 0.5091659, -0.20875052), vec4f(0.036457643, -0.004341309, 0.5270928, 0.048300575)) * layer_a_f
        + mat4x4f(vec4f(-0.23489028, -0.47053197, 0.36660728, -0.0862904), vec4f(0.2273456, -0.22827971, 0.15935718, -0.08949233), vec4f(0.6366064, 0.760198, -0.30983022, 0.45466667), vec4f(0.06996048, 0.07827771, 0.020856166, 0.8390961)) * layer_a_g
        + mat4x4f(vec4f(0.5167854, -0.4409094, -0.33460027, 0.32553026), vec4f(-0.18522933, 0.2734917, 0.49576414, -0.18480891), vec4f(0.24173206, 0.021333355, 0.0340548, 0.040927578), vec4f(0.7161117, 0.30558568, 0.12336311, 0.49470106)) * layer_a_h, vec4f(0.0));
    let layer_b_b = max(vec4f(-0.59038603, -1.2380818, 0.6141714, -0.7220479)
        + mat4x4f(vec4f(0.2717173, -0.56997776, -0.4811086, 0.6317752), vec4f(1.2772515, 0.11601286, -1.1205006, -0.7175928), vec4f(0.80410033, 1.1579, 0.2426847, -0.3483209), vec4f(0.2402292, 1.078736, 0.04062345, 0.37588626)) * layer_a_a
        + mat4x4f(vec4f(0.4114971, 1.9291457, 0.6975043, 0.019480562), vec4f(-0.07973359, 0.5609428, 0.26949054, 0.4395357), vec4f(-0.17822534, 0.48059633, 0.52936584, 1.1211222), vec4f(0.60919774, 0.49669713, 0.054760892, -0.71277964)) * layer_a_b
        + mat4x4f(vec4f(-0.5611266, 0.62197953, 0.017322881, 1.0859272), vec4f(-1.3304298, 0.5506346, -1.8921309, -0.15308212), vec4f(0.81080574, -0.2555648, -0.17229949, -0.4332928), vec4f(1.1439984, 0.14969571, -0.50893354, -0.5527297)) * layer_a_c
        + mat4x4f(vec4f(0.12813817, -0.015247997, 0.7271428, 0.7156412), vec4f(0.2729332, 0.39576948, -1.5522468, 0.5956559), vec4f(-0.41414216, -1.4614924, 0.33205292, 0.19614753), vec4f(-1.0959247, 0.82196766, -0.5232178, 0.9125319)) * layer_a_d
        + mat4x4f(vec4f(-0.1290623, -3.7615342, 0.69671607, -3.4465988), vec4f(-0.096809484, -1.5622762, 0.4266498, -0.23519675), vec4f(-0.8148547, 0.5679272, -0.011348227, 0.20578599), vec4f(-0.4939484, -0.12131577, 0.09106571, 0.45421603)) * layer_a_e
        + mat4x4f(vec4f(-0.38889527, 0.22623779, 0.79059565, 0.88757855), vec4f(-0.82258433, 0.056882337, 0.41101292, 0.46227077), vec4f(-0.39451686, -0.10893214, 0.18797053, 0.37140578), vec4f(0.37345695, -0.1923873, -0.8414183, -0.013556667)) * layer_a_f
        + mat4x4f(vec4f(-0.36581045, -1.3203506, 0.5070365, 0.2507829), vec4f(0.18459827, -1.964432, 0.8193901, -4.439285), vec4f(0.028246397, 0.5478438, -0.8966013, 0.23192306), vec4f(-0.11556906, 0.29787883, 0.76793545, 0.75263464)) * layer_a_g
        + mat4x4f(vec4f(0.1601814, 0.3612248, 0.27000237, 0.27976367), vec4f(0.14679067, 0.84633255, 0.6657737, 0.1234419), vec4f(0.20488855, -0.22577706, 0.27876785, 0.07296042), vec4f(-0.08139652, -0.16387929, -0.26452097, 0.30270505)) * layer_a_h, vec4f(0.0));
    let layer_b_c = max(vec4f(-1.3127556, 0.7657603, 0.07948007, 0.8189478)
        + mat4x4f(vec4f(-0.5601114, -0.70101696, 0.4689559, -0.058881424), vec4f(0.6958628, -0.7745541, 1.6855261, -0.3805276), vec4f(0.7138354, -0.17427485, 1.1731641, 0.31259716), vec4f(1.223261, 0.3876889, -0.07937026, 0.5467611)) * layer_a_a
        + mat4x4f(vec4f(2.5686831, 0.31147242, -0.04890389, -0.37613964), vec4f(0.57767236, -0.081723295, -0.036833655, 0.15530522), vec4f(0.45559132, -0.18134786, -0.71902955, -0.087040186), vec4f(-0.10767082, 0.24185126, -0.26913014, -0.07810307)) * layer_a_b
        + mat4x4f(vec4f(1.0429655, -0.8603809, -1.5431275, -0.63871974), vec4f(-1.2721086, 0.44186577, 3.0974267, 0.9566078), vec4f(-0.19138373, 0.07537007, 0.41721633, -0.008141293), vec4f(-0.04931158, -0.22644415, 0.17168087, -0.27985543)) * layer_a_c
        + mat4x4f(vec4f(-0.41283542, -0.02716791, 0.17169449, 0.7228263), vec4f(0.42488548, 0.0516912, 0.3000308, 0.32097718), vec4f(-0.6951492, -0.39056832, -0.38168514, 0.031393904), vec4f(0.44234192, -1.1693974, -1.3738679, -0.063657)) * layer_a_d
        + mat4x4f(vec4f(-2.7537134, 0.23703074, 1.5600957, -0.17491063), vec4f(-0.19311275, 0.3585196, -0.14781636, 0.3838271), vec4f(0.6959298, -0.33237872, 0.26577595, -1.6038978), vec4f(-0.47015223, 0.028255379, -1.1395847, 0.31034848)) * layer_a_e
        + mat4x4f(vec4f(-0.0045123757, 0.28886592, -0.35049832, 0.33478197), vec4f(-0.55585617, 1.0295193, -0.42280295, 0.3610042), vec4f(0.24043196, -0.25832897, -0.96171755, -0.006727967), vec4f(-0.06970984, -0.04242701, 0.6925638, -0.32709774)) * layer_a_f
        + mat4x4f(vec4f(-0.89919794, -0.7469395, 0.6014375, 0.5209332), vec4f(-2.272272, -0.097382426, 0.80152136, 1.1696888), vec4f(0.6724399, -0.73713225, -0.2089341, -0.1861452), vec4f(0.42553213, 0.08688637, -0.22893563, 0.18776584)) * layer_a_g
        + mat4x4f(vec4f(0.27301174, 0.073484756, -0.6893474, -0.13158777), vec4f(0.7510898, 0.35235482, -0.24608955, 0.17494437), vec4f(-0.14960904, 0.24254999, -0.7200347, 0.3175468), vec4f(0.050741933, 0.11215909, -0.4254779, 0.13839366)) * layer_a_h, vec4f(0.0));
    let layer_b_d = max(vec4f(0.7889884, -1.0587924, 0.73778933, -1.0252867)
        + mat4x4f(vec4f(0.3502873, -0.1342102, -0.50468445, 0.3524739), vec4f(-0.78099924, 0.1561254, -0.55284053, 0.11372156), vec4f(0.12439983, 0.057211336, -0.1121259, -0.21448639), vec4f(0.26924717, 0.5126321, 0.24228425, 0.15989)) * layer_a_a
        + mat4x4f(vec4f(-0.014320077, 0.7037642, 0.12247693, 0.12646444), vec4f(-1.0166297, 0.6829745, 0.19980492, 0.8375752), vec4f(-0.5362347, -0.50147736, -0.21203181, -1.2769631), vec4f(-0.13803837, -0.84300137, 0.1570208, -0.95614195)) * layer_a_b
        + mat4x4f(vec4f(-1.4345037, 1.8210303, -0.3051038, 1.6746933), vec4f(0.5210284, -0.7759368, 0.305497, 0.72989005), vec4f(0.20406456, -0.25321066, -0.1128131, -0.47853056), vec4f(-0.77164245, -0.2779358, -0.70534617, -0.282635)) * layer_a_c
        + mat4x4f(vec4f(0.13335404, 0.06840895, 0.6952355, 0.37690836), vec4f(0.24740952, 0.1406139, 0.26520228, 0.37825906), vec4f(0.3447255, -0.06936628, -0.112081714, 0.16739698), vec4f(-0.39196706, -0.87551326, -0.07483277, 1.6321907)) * layer_a_d
        + mat4x4f(vec4f(0.58982015, -1.8300757, 0.13037796, 1.9315865), vec4f(0.24396983, -0.12573914, 0.26714867, 0.028695017), vec4f(0.27778718, 0.92837703, -0.44584, 1.1438612), vec4f(-0.13232026, 0.2703709, 0.35940182, 0.263185)) * layer_a_e
        + mat4x4f(vec4f(-0.42309767, 0.57573044, 0.84616286, -0.37864658), vec4f(0.54735464, -0.617619, 0.7757221, -0.13772689), vec4f(-0.35069984, 0.9033821, 0.15595219, 0.66227907), vec4f(0.111151695, -0.19734024, -0.26860443, -0.27985576)) * layer_a_f
        + mat4x4f(vec4f(0.036548052, -0.018563638, 0.56828386, -0.3003046), vec4f(-0.5807395, -6.8092403, 0.77791333, -6.704162), vec4f(0.15213445, 0.6191208, -0.26592648, 0.6834016), vec4f(-0.67347515, 0.8104031, -0.6111151, 0.8946856)) * layer_a_g
        + mat4x4f(vec4f(-0.06482509, 0.20078796, -0.08333836, 0.26992825), vec4f(-0.12067844, 0.09326198, 0.4486293, 0.4593091), vec4f(0.42914823, -0.09034896, 0.21843031, -0.36548623), vec4f(0.30557805, -0.33422825, 0.27498466, -0.217954)) * layer_a_h, vec4f(0.0));
    let layer_c_a = 1.0 / (1.0 + exp(min(-(-0.837835
        + dot(vec4f(-0.77881765, -0.5489451, 0.88812244, -0.5408466), layer_b_a)
        + dot(vec4f(2.405879, 6.189557, -0.9287474, 1.178861), layer_b_b)
        + dot(vec4f(5.363236, -0.4159005, 1.2125381, -0.4390997), layer_b_c)
        + dot(vec4f(-0.65876985, 2.7491534, -0.8290179, 1.8536469), layer_b_d)), 80.0)));
    return clamp(layer_c_a, 0.000061035156, 1.0);
}
