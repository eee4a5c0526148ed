// A learned weight for order-independent transparency. Exported by peelnet 0.1.0.
// Licence of this generated text: MIT OR Apache-2.0.
// Network: 7-32-16-1 (Relu hidden, Sigmoid last), 801 parameters, 752 multiply-adds. Recipe nmt, seed 1, 24 epochs.
// Answers: transmittance in front, kept in 0.000061035156 .. 1.0.
// Input 0: depth in warped, -1 .. 1 over the frame's transparent depth range, valid range -1.0 .. 1.0 (what training saw).
// Input 1: fragment_count in 1, valid range 1.0 .. 160.0 (what training saw).
// Input 2: absorbance in 1, valid range 0.0010004875 .. 505.2036 (what training saw).
// Input 3: moment_one in 1, valid range -1.0 .. 1.0 (what training saw).
// Input 4: moment_two in 1, valid range 6.278935e-10 .. 1.0 (what training saw).
// Input 5: moment_three in 1, valid range -1.0 .. 1.0 (what training saw).
// Input 6: moment_four in 1, valid range 3.9425028e-19 .. 1.0 (what training saw).
// Trained on 20038556 rows of boxes, cups, foliage, intersecting, opaque-mix, panes, sixteen-025, sixteen-050, sixteen-075, sixteen-085, sixteen-random-alpha, sixteen-random-color, smoke-100, smoke-30, synthetic (dataset 0599362acca622793292093ff63ae72863fd302015bdf7c35303dc4c52e527db+f44d32a5ff14ca4bf843253253d7571da2829a9e36c000d5dd700fd1b1454788).
// Loss: training 0.008242, validation 0.008272, test 0.008323.
// Held-out error, mean |T - T_exact|: boxes-held 0.05173, cups-held 0.06135, foliage-held 0.05527, panes-held 0.02940, sixteen-held 0.06058, smoke-held 0.05517.
// Self-test: peelnet_weight(-1.0, 1.0, 0.0010004875, -1.0, 6.278935e-10, -1.0, 3.9425028e-19) = 1.0
// Self-test: peelnet_weight(0.0, 80.5, 252.60231, 0.0, 0.5, 0.0, 0.5) = 0.000061035156
// Self-test: peelnet_weight(1.0, 160.0, 505.2036, 1.0, 1.0, 1.0, 1.0) = 0.000061035156
//
// How to draw with it. Targets may have 32 bits a channel wherever 16 are named.
// 0. zeta = peelnet_zeta(z, near, far): z is the distance along the view axis, near and far the range of z that the bounding boxes of the transparent objects in view span, clipped to the camera's. A tight range matters more than anything else you choose. Compute zeta with this function in both passes.
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

// Depth on a logarithmic scale, -1 at near and 1 at far. z: distance along the view axis. near, far: the nearest and the
// farthest z that transparent surfaces have in this frame. Where near is not above 0 the scale is linear: with an orthographic
// camera call peelnet_zeta(z - near, 0.0, far - near). A flat range has one value, -1.
fn peelnet_zeta(z: f32, near: f32, far: f32) -> f32 {
    let linear = near <= 0.0;
    // The logarithm of a ratio: the difference of two would depend on the scene's unit by their rounding.
    let start = max(near, 1.17549435e-38);
    let depth = select(log(max(z / start, 1.0)), z - near, linear);
    let range = select(log(max(far / start, 1.0)), far - near, linear);
    // Closer than that, depths hardly differ.
    let flat = range <= select(1e-6, 0.0, linear);
    let scaled = select(depth * (2.0 / max(range, 1e-30)), 0.0, flat);
    return clamp(scaled - 1.0, -1.0, 1.0);
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
    let input_a = (clamp(vec4f(depth, fragment_count, absorbance, moment_one), vec4f(-5649.16, -491410.12, -828529.1, -2593.504), vec4f(5649.207, 491527.7, 828649.0, 2593.5547)) - vec4f(0.02337453, 58.78114, 59.93421, 0.025494931)) * vec4f(1.7701674, 0.020347167, 0.012068708, 3.8557498);
    let input_b = (clamp(vec4f(moment_two, moment_three, moment_four, 0.0), vec4f(-1455.6799, -1610.5352, -1301.5748, 0.0), vec4f(1456.3132, 1610.571, 1301.9457, 0.0)) - vec4f(0.3166807, 0.017944615, 0.18536648, 0.0)) * vec4f(6.868148, 6.209047, 7.681906, 0.0);
    let layer_a_a = max(vec4f(1.416101, -0.34846324, -1.0572891, -0.022436691)
        + mat4x4f(vec4f(0.01634761, -0.24414857, 0.5613708, 0.010835083), vec4f(0.2285345, -0.030227063, -0.10619448, -0.734262), vec4f(1.263998, -0.5919599, 0.2810009, 2.188969), vec4f(0.09924436, -0.54585904, 0.730805, 0.013057112)) * input_a
        + mat4x4f(vec4f(0.09984264, -0.4754873, 0.52233493, -0.7315595), vec4f(-0.037156817, 1.233557, -0.0127153285, 1.0439079), vec4f(-0.08540402, -0.58188194, -0.2992791, -0.3532431), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_b = max(vec4f(-0.5952376, -0.82986915, -0.47097462, -0.26092094)
        + mat4x4f(vec4f(0.26001468, -0.10220525, -0.81871796, 0.1611351), vec4f(-1.2125484, -0.8745193, -0.12394374, -0.090960786), vec4f(-0.15984699, -0.23493296, -0.98410577, -1.0621029), vec4f(0.16422106, -0.5228997, 0.4754251, 0.50284106)) * input_a
        + mat4x4f(vec4f(0.43189156, 0.3315574, -0.07600226, -0.58974975), vec4f(-0.20146492, 0.2591773, -0.21793127, 0.4555398), vec4f(-0.5211112, -0.157441, 0.22938216, 0.3191432), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_c = max(vec4f(0.7337473, -0.055731636, 0.9452697, -0.8457951)
        + mat4x4f(vec4f(1.06667, 1.1478204, 0.674591, -0.88336575), vec4f(0.28202522, 0.5595545, -0.28329667, -0.20698868), vec4f(1.0153635, 0.9088632, 0.8088907, -0.3980289), vec4f(-0.1909911, -0.311929, -0.001641407, -0.2622631)) * input_a
        + mat4x4f(vec4f(-0.21791317, -0.5229338, 0.18036126, -0.5691646), vec4f(0.09800365, 0.72636294, -0.10506256, 0.16980709), vec4f(-0.10135253, -0.16351512, 0.05980467, 0.3032681), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_d = max(vec4f(-0.14371376, -0.7096563, 0.8328476, -0.8028979)
        + mat4x4f(vec4f(0.28315616, -0.83460575, -0.036968067, 0.54491925), vec4f(-1.8935198, -0.3085426, 0.60439676, -0.05385993), vec4f(1.5383666, 0.47986555, 0.91970444, -1.6511239), vec4f(-0.18437575, -0.7445861, -0.5077715, -0.2520369)) * input_a
        + mat4x4f(vec4f(0.20403987, 0.3359624, -0.045434337, 0.35440072), vec4f(0.1626644, 0.71719927, 0.26115125, -0.030519957), vec4f(-0.27584058, -0.46687278, 0.058252003, -0.061985385), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_e = max(vec4f(-1.2507297, 0.50037235, -0.18054718, 1.1795928)
        + mat4x4f(vec4f(0.59465235, 1.5564787, 0.86491567, 0.44356313), vec4f(1.1914322, 0.19250198, -0.29150763, -0.12830098), vec4f(0.39907297, 0.43275592, -2.5745077, 0.057324696), vec4f(0.19918215, -0.7270424, 0.06764162, -0.18669741)) * input_a
        + mat4x4f(vec4f(0.18347766, -0.012611049, -0.43934453, 0.09094281), vec4f(-0.08098659, 0.012398311, -0.025049139, 0.31429434), vec4f(0.41515025, 0.017136062, 0.2739933, 0.054396767), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_f = max(vec4f(-1.1129816, -0.8488002, -0.12732938, 1.0126129)
        + mat4x4f(vec4f(-1.0014175, -0.23629738, 0.3730453, -0.27111876), vec4f(-0.15082654, -0.92406696, 0.41071352, 0.71787286), vec4f(-0.06630574, 0.15472454, 0.46823418, 0.3088928), vec4f(-0.5153406, -0.55978537, 0.92123944, 0.26391155)) * input_a
        + mat4x4f(vec4f(0.49716422, 0.13999672, -0.3917205, 0.4864269), vec4f(-0.05354089, 0.2843043, -1.1454177, -0.0008299461), vec4f(-0.3178363, -0.10231217, 0.040451385, -0.7331184), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_g = max(vec4f(1.2428051, 1.0639681, 0.9767659, 1.2193711)
        + mat4x4f(vec4f(0.3720631, -0.09681538, 0.63970727, 0.09962915), vec4f(0.20378083, -0.6190476, -0.12486558, 0.22332639), vec4f(-0.09464446, 1.5565279, -0.63050896, 0.7265932), vec4f(-0.3194745, 0.00621379, -0.29435408, -0.04589039)) * input_a
        + mat4x4f(vec4f(-0.17594664, -0.26520532, 0.009356984, 0.12527245), vec4f(0.34323412, 0.06474598, -0.12036716, 0.05866539), vec4f(0.22812715, 0.13763304, -0.039133128, -0.11136568), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_a_h = max(vec4f(-0.6429493, -0.6631853, -0.8977201, 1.337894)
        + mat4x4f(vec4f(-0.12421136, -0.8435936, -0.7533704, 0.5449838), vec4f(-0.21638013, -0.76564974, -0.6578715, 0.027456462), vec4f(-1.872489, 0.15927298, -0.1988447, 0.55565584), vec4f(-0.36766598, 0.4977012, 0.385335, -0.44056958)) * input_a
        + mat4x4f(vec4f(0.38878638, 0.14375529, -0.22008753, -0.17491943), vec4f(0.30945498, 0.008684384, 0.097622514, -0.060200825), vec4f(-0.44921768, 0.08759233, -0.25045094, 0.17038453), vec4f(0.0, 0.0, 0.0, 0.0)) * input_b, vec4f(0.0));
    let layer_b_a = max(vec4f(-1.0412767, 0.3257082, -1.1339492, 0.6270217)
        + mat4x4f(vec4f(0.5603547, 0.22831441, 0.07400713, 0.14323264), vec4f(0.90454394, 0.43324578, 0.4754828, 0.008673854), vec4f(0.78028566, 0.52152413, -0.43059376, -0.02468749), vec4f(1.0814494, 0.19016865, 1.0560704, 0.54755676)) * layer_a_a
        + mat4x4f(vec4f(-0.1562768, 0.4173307, 0.118110634, 0.03856539), vec4f(0.19813938, -0.16821158, 0.3980783, 0.11781587), vec4f(0.04868524, -1.8025893, 0.11189687, -0.41437954), vec4f(0.540895, 0.024344778, 0.70449626, 0.11499485)) * layer_a_b
        + mat4x4f(vec4f(0.26073608, 0.57983226, -0.0013282483, 0.90536267), vec4f(-0.25448543, 0.80791193, -1.9199932, 0.3652699), vec4f(-0.28917673, 0.3118828, -0.2682984, 0.33486173), vec4f(0.46956778, -0.6019518, 0.4713193, -0.63278973)) * layer_a_c
        + mat4x4f(vec4f(0.11639783, 1.0389049, 0.5644187, 0.6740118), vec4f(1.3918875, -0.28352737, -0.7569001, -0.598831), vec4f(0.1405073, -1.0111916, 0.019350259, -0.54199654), vec4f(0.15711303, -1.0136665, -0.0898713, -0.30547345)) * layer_a_d
        + mat4x4f(vec4f(0.3064301, 0.5347258, 1.0380006, -0.1073475), vec4f(-10.27381, 0.19687696, -6.001879, -0.051203318), vec4f(0.004970458, -0.48203266, 0.20375724, -0.57683444), vec4f(-0.6122755, 0.30806896, -0.7632619, 0.29087064)) * layer_a_e
        + mat4x4f(vec4f(0.7813131, 0.6896709, 0.8351454, -0.020497158), vec4f(0.41195217, -0.12912117, 0.24733785, 0.42476487), vec4f(0.92961776, -0.3953404, -0.38171333, 0.2850584), vec4f(0.55185336, -1.5655551, -1.2111188, -2.0206614)) * layer_a_f
        + mat4x4f(vec4f(-0.60057473, 0.120899186, -0.45891517, 0.19101886), vec4f(0.10609101, 0.23515752, 0.38720068, 0.05086064), vec4f(-0.64802027, -0.019026054, -0.8374669, 0.09085738), vec4f(0.18560462, 0.06101544, -0.1302014, -0.005399869)) * layer_a_g
        + mat4x4f(vec4f(-0.07054193, 0.41662472, -0.18437439, -0.46686745), vec4f(0.3172265, -0.76650107, 0.31579825, -0.036238547), vec4f(-0.12879935, -0.76738715, 0.0011027326, -0.8521029), vec4f(-0.48488683, 0.36650258, -0.32053953, 0.39747435)) * layer_a_h, vec4f(0.0));
    let layer_b_b = max(vec4f(-0.23977962, -1.0369557, -1.0499089, 0.5344267)
        + mat4x4f(vec4f(-0.04058974, -0.3502422, -4.047574, 0.74217844), vec4f(-0.027667733, 0.82526743, 0.03451743, 0.4088419), vec4f(0.15456022, 0.5220023, -0.32861894, 0.23808512), vec4f(0.0893142, 0.3039246, -0.45126137, 0.29051283)) * layer_a_a
        + mat4x4f(vec4f(-0.13520236, 0.41028354, 0.67337036, 0.104624964), vec4f(0.010042853, 0.61553836, 0.09827492, -0.1456149), vec4f(-0.034175634, -0.5052918, 0.36210763, -0.44604835), vec4f(-0.17268054, 0.44488555, 0.15346248, -0.25409237)) * layer_a_b
        + mat4x4f(vec4f(-0.049190555, 0.027822474, 0.5105603, 0.9685426), vec4f(0.11053086, -2.523165, 0.07712214, 0.83324873), vec4f(-0.0916009, 0.07300342, -0.16409783, 0.621644), vec4f(-0.13735466, 0.31568968, -0.06956227, -1.0186743)) * layer_a_c
        + mat4x4f(vec4f(-0.13904947, 0.5368562, -0.22574466, 0.66543025), vec4f(-0.022275338, 0.5344275, -0.31325883, -2.0355544), vec4f(-0.15979023, -0.4315687, -0.28288007, -0.7649322), vec4f(-0.20798795, 0.1801751, 0.4286067, -0.6632377)) * layer_a_d
        + mat4x4f(vec4f(-0.10094886, 0.48526615, -0.19703297, 0.14640702), vec4f(0.022148522, -7.4146953, -0.036169898, -0.12937595), vec4f(0.14218836, 0.050184377, 1.0794395, -0.9424387), vec4f(-0.22409254, -0.30369088, 0.054169223, 0.28182647)) * layer_a_e
        + mat4x4f(vec4f(-0.090797305, 0.5564833, 0.13623844, -0.1123207), vec4f(-0.22771151, 0.66606104, -0.041801624, -0.22761768), vec4f(-0.16115725, 1.2207919, -0.13749374, 0.3521143), vec4f(-0.044187933, 0.36923057, -0.49848074, -0.16021392)) * layer_a_f
        + mat4x4f(vec4f(-0.0989386, -0.48464143, 0.047049068, -0.11361712), vec4f(-0.089460954, 0.14190656, -0.94455934, 0.37128365), vec4f(-0.08236358, -0.439784, 0.3605849, 0.1260752), vec4f(-0.095314994, -0.26606297, -0.773905, 0.46122202)) * layer_a_g
        + mat4x4f(vec4f(-0.19699557, -0.5639293, 1.1083847, 0.23301427), vec4f(0.051278178, 0.6649485, 0.40798542, 0.29050836), vec4f(-0.022926614, 0.11772987, -0.06770564, -0.3286981), vec4f(-0.18146065, -0.6057553, -0.4115288, 0.19352902)) * layer_a_h, vec4f(0.0));
    let layer_b_c = max(vec4f(-0.059614222, -1.2318434, 0.8530962, 0.38510743)
        + mat4x4f(vec4f(0.075140215, -1.789988, 0.3832679, 0.4335207), vec4f(0.040828507, 0.14783886, 0.1370688, -0.8107153), vec4f(-0.047048062, 0.49067178, -1.2635385, -0.015129833), vec4f(-0.069175586, 0.46997273, -1.4578118, -0.35286984)) * layer_a_a
        + mat4x4f(vec4f(-0.22014387, 0.7437889, 0.18260978, -0.21684873), vec4f(0.0822013, 0.4923973, 0.38423544, -0.379524), vec4f(-0.092631824, 0.060969986, -0.30486774, -0.18423064), vec4f(0.02534318, 0.43185928, 0.4264745, 0.09864316)) * layer_a_b
        + mat4x4f(vec4f(-0.038706385, -0.13323028, 0.104722366, 1.6341434), vec4f(0.07904696, -0.507966, -0.8780806, -0.9522999), vec4f(-0.034756165, 0.06976636, 0.45917788, 0.32212833), vec4f(0.029829295, 0.5673848, -0.6709749, 0.48577842)) * layer_a_c
        + mat4x4f(vec4f(-0.16839902, 1.3061363, -0.30522808, 0.7311039), vec4f(-0.05866846, 0.40295747, -1.1446011, -1.2107049), vec4f(-0.045094974, -1.2403396, -0.7494332, -0.30142692), vec4f(0.061385628, -0.10414634, -0.13099891, -0.82951653)) * layer_a_d
        + mat4x4f(vec4f(-0.023407275, 0.40568843, -0.09837181, -0.10143865), vec4f(-0.22744301, -5.8772974, -0.07767066, 0.9370239), vec4f(-0.23320207, 0.17614569, -0.84609467, -0.94481516), vec4f(0.026489666, -0.5717026, 0.41679847, 0.12322221)) * layer_a_e
        + mat4x4f(vec4f(-0.09731557, 0.51684505, -0.20004901, -0.5316553), vec4f(0.04585916, 0.5634279, 0.57177556, -0.4436883), vec4f(-0.17708719, 0.23360237, -1.1783985, -0.31843886), vec4f(-0.1268914, -0.64001906, -0.49446487, -0.7129225)) * layer_a_f
        + mat4x4f(vec4f(-0.045563754, -0.66931933, 0.030059349, -0.14728446), vec4f(0.09837361, 0.44005466, 0.6219958, 0.40394264), vec4f(0.005125268, -0.33031008, 0.4333901, 0.03994279), vec4f(-0.2614114, -0.7302813, 0.37978107, -0.18101665)) * layer_a_g
        + mat4x4f(vec4f(-0.12188112, -0.31094125, -0.16351654, -0.13020006), vec4f(-0.082134835, 0.6218019, -0.36975312, 0.17664982), vec4f(0.22636016, 0.6545185, -0.9003418, 0.27277613), vec4f(0.02507974, -0.8157648, 0.60818607, 0.63206565)) * layer_a_h, vec4f(0.0));
    let layer_b_d = max(vec4f(0.634797, 0.79440224, 0.7697933, 0.11916498)
        + mat4x4f(vec4f(1.0275778, -0.00095521833, 0.27966216, 0.021503054), vec4f(0.40997574, -0.19961043, 0.16664933, -0.1944061), vec4f(-0.18735684, -0.1494306, -0.30439967, 0.14230469), vec4f(0.45583493, -0.453473, 0.46803296, 0.08937989)) * layer_a_a
        + mat4x4f(vec4f(0.09310465, 0.01427286, 0.15042716, 0.01917659), vec4f(-0.075890824, 0.1846945, -0.23739912, -0.12155172), vec4f(-0.42047262, -0.31695738, -0.27330744, -0.17778793), vec4f(-0.08238985, 0.33092386, -0.53948516, 0.009153606)) * layer_a_b
        + mat4x4f(vec4f(0.99104536, 1.1601192, 0.09343011, 0.04059838), vec4f(0.5173318, -0.70203745, -1.8778281, -0.09280296), vec4f(0.3063586, 0.22405478, 0.30250186, 0.10122403), vec4f(-0.08557106, 0.5669781, -0.1546924, -0.021530649)) * layer_a_c
        + mat4x4f(vec4f(0.103564665, -0.42850757, 0.6695233, -0.101370394), vec4f(0.13806224, 0.1536524, 0.37561926, -0.033432454), vec4f(-0.0760003, -0.011726471, 0.38958213, -0.11610276), vec4f(-0.40379813, -0.42295226, -0.30605662, -0.16307051)) * layer_a_d
        + mat4x4f(vec4f(-0.34221318, -0.6500133, 1.0421474, -0.15364134), vec4f(0.252974, 0.095915824, 0.24360563, 0.009580827), vec4f(-1.327998, -0.5127182, -1.3514687, -0.065802045), vec4f(0.38458252, 0.20135127, 0.116885655, -0.16181569)) * layer_a_e
        + mat4x4f(vec4f(-0.12919284, -0.16671714, -0.16771299, 0.07425597), vec4f(0.16103669, 0.32893112, 0.03795524, 0.12638), vec4f(0.58940136, 0.8852932, 0.1294565, -0.11187196), vec4f(0.27254573, -0.6017624, 0.20350817, 0.02881874)) * layer_a_f
        + mat4x4f(vec4f(0.01861636, 0.29087752, 0.108149454, -0.06481418), vec4f(0.63707083, 0.42145094, 0.9362744, -0.15586095), vec4f(0.0652713, -0.0047198795, 0.0036662347, -0.13052335), vec4f(0.42652526, -0.08785607, -0.013319273, -0.09105423)) * layer_a_g
        + mat4x4f(vec4f(-0.5404657, -1.0456492, -0.3657747, -0.07875392), vec4f(-0.033733044, -0.4959863, 0.27659684, -0.017325558), vec4f(0.073599204, -1.7084218, 0.18852744, -0.13753828), vec4f(0.42145345, 0.6027333, 0.34817183, 0.08362906)) * layer_a_h, vec4f(0.0));
    let layer_c_a = 1.0 / (1.0 + exp(min(-(0.76327187
        + dot(vec4f(2.2280853, -0.6698281, 3.443837, -0.3528664), layer_b_a)
        + dot(vec4f(0.03721141, 3.2716265, 2.7473059, -0.6972352), layer_b_b)
        + dot(vec4f(0.090644866, 6.532563, -0.84164757, -0.7676575), layer_b_c)
        + dot(vec4f(-0.7857493, -0.73552835, -0.70950186, 0.15437862), layer_b_d)), 80.0)));
    return clamp(layer_c_a, 0.000061035156, 1.0);
}
